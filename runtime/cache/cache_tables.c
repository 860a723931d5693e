/* What is known of each file: made when a lookup first needs it, thrown away when files have not
 * been looked at for long and the limit asks for it. */
#include "cache/cache_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <sys/mman.h>

static size_t faces_bytes(uint32_t nfaces) {
    return ((size_t)nfaces + 1) * sizeof(cache_face);
}

static void free_tables(cache_tables *tables) {
    if (!tables)
        return;
    cache_origin *origin = tables->origin;
    if (tables->faces)
        munmap(tables->faces, faces_bytes(tables->nfaces));
    if (origin && origin->ptx) {
        slv_source_close(&origin->source);
        slv_ptx_close(origin->ptx);
    }
    if (origin && origin->handle)
        slvi_cache_handle_release(origin->handle);
    slvi_free(origin);
    slvi_free(tables);
}

static void give_room(slv_cache *cache, uint64_t bytes) {
    cache->table_bytes -= bytes;
    pthread_cond_broadcast(&cache->changed);
}

void slvi_cache_drop_tables(slv_cache *cache, cache_file *file) {
    cache_tables *tables = cache_tables_of(file);
    if (!tables)
        return;
    atomic_store_explicit(&file->place.tables, NULL, memory_order_seq_cst);
    tables->origin->dropped = true;
    slvi_cache_wait_for_readers(cache, slvi_cache_begin_epoch(cache));
    while (atomic_load_explicit(&tables->origin->users, memory_order_acquire))
        pthread_cond_wait(&cache->changed, &cache->lock);
    cache->table_held -= tables->origin->bytes;
    give_room(cache, tables->origin->bytes);
    free_tables(tables);
}

/* Throws away the tables of a file that was not looked at since the hand last came by. False if
 * all are being read from. */
static bool drop_some(slv_cache *cache) {
    for (uint32_t left = 2 * cache->file_end; left; left--) {
        cache->file_hand = (cache->file_hand + 1) % cache->file_end;
        cache_file *file = cache_file_at(cache, cache->file_hand);
        cache_tables *tables = file ? cache_tables_of(file) : NULL;
        if (!tables || atomic_exchange_explicit(&tables->used, 0, memory_order_relaxed) ||
            atomic_load_explicit(&tables->origin->users, memory_order_relaxed))
            continue;
        slvi_cache_drop_tables(cache, file);
        return true;
    }
    return false;
}

/* Promises room to tables, at most half of all to all of them. Whoever waits for it has been
 * promised none, so that those who have go on. */
static void take_room(slv_cache *cache, uint64_t bytes) {
    while (cache->table_bytes + bytes > cache->max_bytes / 2)
        if (!drop_some(cache)) {
            cache->table_waiters++;
            pthread_cond_wait(&cache->changed, &cache->lock);
            cache->table_waiters--;
        }
    cache->table_bytes += bytes;
    slvi_cache_trim_slabs(cache);
    cache->table_held += bytes;
    slvi_cache_note_peak(cache);
}

static void fill_from_desc(cache_tables *t, const slv_source_desc *desc) {
    t->nfaces = desc->nfaces;
    t->nchannels = desc->nchannels;
    t->type = desc->type;
    t->pixel_size = (uint32_t)(desc->nchannels * slv_type_size(desc->type));
    t->border_u = desc->border_u;
    t->border_v = desc->border_v;
    t->tanvec = desc->edge_filter == SLV_EDGE_FILTER_TANVEC && desc->nchannels >= 2;
    t->triangle = desc->triangles;
    t->one = desc->type == SLV_TYPE_U8 ? 255 : desc->type == SLV_TYPE_U16 ? 65535 : 1;
    t->simple = !t->triangle && !t->tanvec && t->nchannels <= 4;
    t->scale = 1 / t->one;
    atomic_init(&t->apron, CACHE_APRON);
    /* tiles begin at 128 KiB */
    while ((uint64_t)t->pixel_size << (t->whole_log2 + 1) < 131072)
        t->whole_log2++;
}

/* Opens a file, or looks at a source: how many bytes its tables will take. */
static slv_result begin_origin(slv_cache *cache, const cache_file *file, cache_origin *origin,
                               uint32_t *nfaces) {
    slv_result result;
    *nfaces = 0;
    if (!file->path) {
        origin->source = file->source;
        result = origin->source.fns->describe(origin->source.user, &origin->desc);
        *nfaces = origin->desc.nfaces;
    } else {
        slv_stream_in bytes;
        slv_ptx_open_params params = {.premultiply = cache->premultiply, .source = &bytes};
        const cache_identity *identity = file->identified ? &file->identity : NULL;
        result = slvi_cache_handle_create(cache, file->path, identity, &bytes, &origin->handle);
        if (result)
            return result;
        slv_env env = slvi_cache_handle_env(origin->handle);
        if (!(result = slv_ptx_open_with(&env, file->path, &params, &origin->ptx)))
            *nfaces = slv_ptx_get_info(origin->ptx)->nfaces;
    }
    return result;
}

/* The caller lets go of t also when this fails. */
static slv_result fill_tables(slv_cache *cache, const cache_file *file, cache_tables *t) {
    cache_origin *origin = t->origin;
    const char *name = file->path ? file->path : "source";
    uint32_t nfaces;
    slv_result result = begin_origin(cache, file, origin, &nfaces);
    if (result)
        return result;
    if (!file->path)
        name = origin->desc.name;
    uint64_t bytes = (origin->ptx ? slv_ptx_full_table_bytes(origin->ptx) : 0) +
                     faces_bytes(nfaces) + sizeof *t + sizeof *origin;
    if (bytes > cache->max_bytes / 2)
        return slvi_fail(&cache->env, SLV_ERROR_LIMIT,
                         "%s: its tables take %llu bytes, more than half of the cache's %llu", name,
                         (unsigned long long)bytes, (unsigned long long)cache->max_bytes);
    pthread_mutex_lock(&cache->lock);
    take_room(cache, bytes);
    pthread_mutex_unlock(&cache->lock);
    origin->bytes = bytes;
    if (origin->ptx) {
        slv_env env = slvi_cache_handle_env(origin->handle);
        const void *averages;
        if ((result = slv_ptx_load_averages(origin->ptx, &averages)))
            return result;
        t->averages = averages;
        if ((result = slv_ptx_as_source(&env, origin->ptx, &origin->source)) ||
            (result = origin->source.fns->describe(origin->source.user, &origin->desc)))
            return result;
    }
    fill_from_desc(t, &origin->desc);
    /* the operating system gives memory to those pages alone that are written to */
    t->faces = mmap(NULL, faces_bytes(t->nfaces), PROT_READ | PROT_WRITE,
                    MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (t->faces == MAP_FAILED) {
        t->faces = NULL;
        return slvi_fail(&cache->env, SLV_ERROR_MEMORY, "%s: no memory for %u faces", name,
                         t->nfaces);
    }
    return SLV_OK;
}

static slv_result make_tables(slv_cache *cache, const cache_file *file, cache_tables **out) {
    cache_tables *t = NULL;
    *out = NULL;
    slv_result result = slvi_alloc(&cache->env, "tables of a file", 1, sizeof *t, &t);
    if (!result)
        result = slvi_alloc(&cache->env, "tables of a file", 1, sizeof *t->origin, &t->origin);
    if (!result && (result = fill_tables(cache, file, t))) {
        uint64_t bytes = t->origin->bytes;
        if (t->origin->handle)
            result = slvi_cache_handle_result(t->origin->handle, result);
        pthread_mutex_lock(&cache->lock);
        cache->table_held -= bytes;
        give_room(cache, bytes);
        pthread_mutex_unlock(&cache->lock);
    }
    if (result) {
        free_tables(t);
        return result;
    }
    *out = t;
    return SLV_OK;
}

/* Under the lock, which it lets go while it reads. */
static slv_result load_file(slv_cache *cache, cache_file *file, slv_file_id id) {
    cache_tables *tables = NULL;
    file->loading = true;
    pthread_mutex_unlock(&cache->lock);
    slv_result result = make_tables(cache, file, &tables);
    pthread_mutex_lock(&cache->lock);
    file->loading = false;
    pthread_cond_broadcast(&cache->changed);
    if (result) {
        /* what there was no memory for is tried again */
        file->failure = result == SLV_ERROR_MEMORY ? SLV_OK : result;
        return result;
    }
    tables->id = id;
    tables->origin->place = id % CACHE_FILES;
    tables->origin->cap = file->cap;
    tables->serial = ++cache->next_serial;
    if (tables->serial == 0)
        tables->serial = ++cache->next_serial;
    cache->stats.reloaded += file->loaded_before;
    file->loaded_before = true;
    if (tables->origin->ptx) {
        file->identity = tables->origin->handle->identity;
        file->identified = true;
        file->info = *slv_ptx_get_info(tables->origin->ptx);
        file->info.level_faces = NULL;
        file->info.level_bytes = NULL;
    }
    atomic_store_explicit(&tables->used, 1, memory_order_relaxed);
    atomic_store_explicit(&file->place.tables, tables, memory_order_release);
    return SLV_OK;
}

slv_result slvi_cache_load_tables(slv_cache *cache, slv_file_id id) {
    slv_result result = SLV_OK;
    pthread_mutex_lock(&cache->lock);
    for (;;) {
        cache_file *file = cache_file_at(cache, id % CACHE_FILES);
        if (!id || !file || atomic_load_explicit(&file->id, memory_order_relaxed) != id) {
            result = SLV_ERROR_ARGUMENT;
            break;
        }
        if (cache_tables_of(file) || (result = file->failure))
            break;
        if (!file->loading) {
            result = load_file(cache, file, id);
            break;
        }
        pthread_cond_wait(&cache->changed, &cache->lock);
    }
    pthread_mutex_unlock(&cache->lock);
    return result;
}

void slvi_cache_learn_face(cache_tables *tables, uint32_t index) {
    cache_face *f = &tables->faces[index];
    uint8_t state = CACHE_UNKNOWN;
    if (!atomic_compare_exchange_strong(&f->state, &state, CACHE_BUSY)) {
        while (atomic_load_explicit(&f->state, memory_order_acquire) != CACHE_KNOWN)
            ;
        return;
    }
    const cache_origin *origin = tables->origin;
    slv_source_face face;
    if (origin->source.fns->face(origin->source.user, index, &face))
        memset(&face, 0, sizeof face); /* no source may: the face is there */
    for (int e = 0; e < 4; e++) {
        bool there = face.adjacency.face[e] >= 0 &&
                     (uint32_t)face.adjacency.face[e] < tables->nfaces &&
                     (e < 3 || !tables->triangle);
        f->adjacent[e] = there ? face.adjacency.face[e] : SLV_BOUNDARY;
        f->edges |= (uint8_t)((face.adjacency.edge[e] & 3) << 2 * e);
    }
    f->res_u = (int8_t)((uint32_t)face.res.u < origin->cap ? face.res.u : (int)origin->cap);
    f->res_v = (int8_t)((uint32_t)face.res.v < origin->cap ? face.res.v : (int)origin->cap);
    slvi_cache_set_flags(tables, f, face.flags);
    atomic_store_explicit(&f->state, CACHE_KNOWN, memory_order_release);
}

void slvi_cache_set_flags(const cache_tables *tables, cache_face *f, uint8_t flags) {
    atomic_store_explicit(&f->flags, flags, memory_order_relaxed);
    atomic_store_explicit(&f->plain,
                          tables->simple && !(flags & (SLV_FACE_CONSTANT | SLV_FACE_SUBFACE |
                                                       SLV_FACE_NEIGHBOURS_CONSTANT)),
                          memory_order_relaxed);
}

/* As .ptx files are tiled, so that a block is a tile of most files. */
slv_res slvi_cache_tile_res(const cache_tables *tables, int res_u, int res_v) {
    uint64_t pieces = ((uint64_t)tables->pixel_size << (res_u + res_v)) / 65536;
    int n = 0;
    while (pieces > 1) {
        pieces >>= 1;
        n++;
    }
    if (n == 0)
        return (slv_res){(int8_t)res_u, (int8_t)res_v};
    int total = res_u + res_v - n;
    total = total < 0 ? 0 : total;
    if (tables->triangle)
        return (slv_res){(int8_t)(total / 2), (int8_t)(total / 2)};
    int u = (total + 1) / 2 < res_u ? (total + 1) / 2 : res_u;
    int v = total - u < res_v ? total - u : res_v;
    return (slv_res){(int8_t)u, (int8_t)v};
}
