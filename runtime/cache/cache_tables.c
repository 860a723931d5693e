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
    if (tables->faces)
        munmap(tables->faces, faces_bytes(tables->nfaces));
    slv_ptx_close(tables->ptx);
    if (tables->handle)
        slvi_cache_handle_release(tables->handle);
    slvi_free(tables);
}

static void give_room(slv_cache *cache, uint64_t bytes) {
    cache->table_bytes -= bytes;
    pthread_cond_broadcast(&cache->changed);
}

void slvi_cache_drop_tables(slv_cache *cache, cache_file *file) {
    cache_tables *tables = atomic_load_explicit(&file->tables, memory_order_relaxed);
    if (!tables)
        return;
    atomic_store_explicit(&file->tables, NULL, memory_order_seq_cst);
    tables->dropped = true;
    slvi_cache_wait_for_readers(cache, slvi_cache_begin_epoch(cache));
    while (atomic_load_explicit(&tables->users, memory_order_acquire))
        pthread_cond_wait(&cache->changed, &cache->lock);
    cache->table_held -= tables->bytes;
    give_room(cache, tables->bytes);
    free_tables(tables);
}

/* Throws away the tables of a file that was not looked at since the hand last came by. False if
 * all are being read from. */
static bool drop_some(slv_cache *cache) {
    for (uint32_t left = 2 * cache->file_end; left; left--) {
        cache->file_hand = (cache->file_hand + 1) % cache->file_end;
        cache_file *file =
            atomic_load_explicit(&cache->files[cache->file_hand], memory_order_relaxed);
        cache_tables *tables =
            file ? atomic_load_explicit(&file->tables, memory_order_relaxed) : NULL;
        if (!tables || atomic_exchange_explicit(&tables->used, 0, memory_order_relaxed) ||
            atomic_load_explicit(&tables->users, memory_order_relaxed))
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

/* The caller lets go of t also when this fails. */
static slv_result fill_tables(slv_cache *cache, const char *path, const cache_identity *identity,
                              cache_tables *t) {
    slv_ptx_source source;
    slv_ptx_open_params params = {.premultiply = cache->premultiply, .source = &source};
    slv_result result = slvi_cache_handle_create(cache, path, identity, &source, &t->handle);
    if (result)
        return result;
    slv_env env = slvi_cache_handle_env(t->handle);
    if ((result = slv_ptx_open_with(&env, path, &params, &t->ptx)))
        return result;
    const slv_ptx_info *info = slv_ptx_get_info(t->ptx);
    t->nfaces = info->nfaces;
    t->nchannels = info->nchannels;
    t->type = info->type;
    t->pixel_size = (uint32_t)(info->nchannels * slv_type_size(info->type));
    t->border_u = info->border_u;
    t->border_v = info->border_v;
    t->tanvec = info->edge_filter == SLV_EDGE_FILTER_TANVEC && info->nchannels >= 2;
    t->triangle = info->mesh_type == SLV_PTX_TRIANGLE;
    t->one = info->type == SLV_TYPE_U8 ? 255 : info->type == SLV_TYPE_U16 ? 65535 : 1;
    t->simple = !t->triangle && !t->tanvec && t->nchannels <= 4;
    t->scale = 1 / t->one;
    /* tiles begin at 128 KiB */
    while ((uint64_t)t->pixel_size << (t->whole_log2 + 1) < 131072)
        t->whole_log2++;
    uint64_t bytes = slv_ptx_full_table_bytes(t->ptx) + faces_bytes(t->nfaces) + sizeof *t;
    if (bytes > cache->max_bytes / 2)
        return slvi_fail(&cache->env, SLV_ERROR_LIMIT,
                         "%s: its tables take %llu bytes, more than half of the cache's %llu", path,
                         (unsigned long long)bytes, (unsigned long long)cache->max_bytes);
    pthread_mutex_lock(&cache->lock);
    take_room(cache, bytes);
    pthread_mutex_unlock(&cache->lock);
    t->bytes = bytes;
    t->averages = slv_ptx_get_averages(t->ptx);
    if (!t->averages)
        return SLV_ERROR_FORMAT;
    slv_ptx_face face;
    if (t->nfaces && (result = slv_ptx_get_face(t->ptx, 0, &face)))
        return result;
    /* the operating system gives memory to those pages alone that are written to */
    t->faces = mmap(NULL, faces_bytes(t->nfaces), PROT_READ | PROT_WRITE,
                    MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (t->faces == MAP_FAILED) {
        t->faces = NULL;
        return slvi_fail(&cache->env, SLV_ERROR_MEMORY, "%s: no memory for %u faces", path,
                         t->nfaces);
    }
    return SLV_OK;
}

static slv_result make_tables(slv_cache *cache, const char *path, const cache_identity *identity,
                              cache_tables **out) {
    cache_tables *t = NULL;
    *out = NULL;
    slv_result result = slvi_alloc(&cache->env, path, 1, sizeof *t, &t);
    if (result)
        return result;
    result = fill_tables(cache, path, identity, t);
    if (result) {
        uint64_t bytes = t->bytes;
        result = t->handle ? slvi_cache_handle_result(t->handle, result) : result;
        free_tables(t);
        pthread_mutex_lock(&cache->lock);
        cache->table_held -= bytes;
        give_room(cache, bytes);
        pthread_mutex_unlock(&cache->lock);
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
    slv_result result =
        make_tables(cache, file->path, file->identified ? &file->identity : NULL, &tables);
    pthread_mutex_lock(&cache->lock);
    file->loading = false;
    pthread_cond_broadcast(&cache->changed);
    if (result)
        return result;
    tables->id = id;
    tables->place = id % CACHE_FILES;
    tables->serial = ++cache->next_serial;
    if (tables->serial == 0)
        tables->serial = ++cache->next_serial;
    cache->stats.reloaded += file->loaded_before;
    file->loaded_before = true;
    file->identity = tables->handle->identity;
    file->identified = true;
    file->info = *slv_ptx_get_info(tables->ptx);
    file->info.level_faces = NULL;
    file->info.level_bytes = NULL;
    atomic_store_explicit(&tables->used, 1, memory_order_relaxed);
    atomic_store_explicit(&file->tables, tables, memory_order_release);
    return SLV_OK;
}

slv_result slvi_cache_load_tables(slv_cache *cache, slv_file_id id) {
    slv_result result = SLV_OK;
    pthread_mutex_lock(&cache->lock);
    for (;;) {
        cache_file *file =
            atomic_load_explicit(&cache->files[id % CACHE_FILES], memory_order_relaxed);
        if (!id || !file || atomic_load_explicit(&file->id, memory_order_relaxed) != id) {
            result = SLV_ERROR_ARGUMENT;
            break;
        }
        if (atomic_load_explicit(&file->tables, memory_order_relaxed))
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
    slv_ptx_face face;
    if (slv_ptx_get_face(tables->ptx, index, &face))
        memset(&face, 0, sizeof face); /* cannot be: the face table is there */
    for (int e = 0; e < 4; e++) {
        bool there = face.adjacency.face[e] >= 0 &&
                     (uint32_t)face.adjacency.face[e] < tables->nfaces &&
                     (e < 3 || !tables->triangle);
        f->adjacent[e] = there ? face.adjacency.face[e] : SLV_BOUNDARY;
        f->edges |= (uint8_t)((face.adjacency.edge[e] & 3) << 2 * e);
    }
    f->flags = face.flags;
    f->plain =
        tables->simple &&
        !(face.flags & (SLV_FACE_CONSTANT | SLV_FACE_SUBFACE | SLV_FACE_NEIGHBOURS_CONSTANT));
    f->res_u = face.res.u;
    f->res_v = face.res.v;
    atomic_store_explicit(&f->state, CACHE_KNOWN, memory_order_release);
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
