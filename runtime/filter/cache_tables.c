/* What is known of each file: made when a lookup first needs it, thrown away when files have not
 * been looked at for long and the limit asks for it. */
#include "filter/cache_data.h"

#include <stdlib.h>
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
    free(tables);
}

static slv_result make_tables(slv_cache *cache, const char *path, cache_tables **out) {
    cache_tables *t = NULL;
    slv_ptx_source source;
    slv_ptx_open_params params = {.premultiply = cache->premultiply, .source = &source};
    slv_result result = slv_alloc(&cache->env, path, 1, sizeof *t, &t);
    if (result || (result = cache_handle_create(cache, path, &source)))
        goto done;
    if ((result = slv_ptx_open_with(&cache->env, path, &params, &t->ptx)))
        goto done;
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
    t->averages = slv_ptx_get_averages(t->ptx);
    if (!t->averages) {
        result = SLV_ERROR_FORMAT;
        goto done;
    }
    slv_ptx_face face;
    if (t->nfaces && (result = slv_ptx_get_face(t->ptx, 0, &face)))
        goto done;
    t->bytes = slv_ptx_full_table_bytes(t->ptx) + faces_bytes(t->nfaces) + sizeof *t;
    if (t->bytes > cache->max_bytes / 2) {
        result = slv_fail(&cache->env, SLV_ERROR_LIMIT,
                          "%s: its tables take %llu bytes, more than half of the cache's %llu",
                          path, (unsigned long long)t->bytes, (unsigned long long)cache->max_bytes);
        goto done;
    }
    /* the operating system gives memory to those pages alone that are written to */
    t->faces = mmap(NULL, faces_bytes(t->nfaces), PROT_READ | PROT_WRITE,
                    MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (t->faces == MAP_FAILED) {
        t->faces = NULL;
        result =
            slv_fail(&cache->env, SLV_ERROR_MEMORY, "%s: no memory for %u faces", path, t->nfaces);
    }
done:
    if (result) {
        free_tables(t);
        t = NULL;
    }
    *out = t;
    return result;
}

void cache_drop_tables(slv_cache *cache, cache_file *file) {
    cache_tables *tables = atomic_load_explicit(&file->tables, memory_order_relaxed);
    if (!tables)
        return;
    atomic_store_explicit(&file->tables, NULL, memory_order_seq_cst);
    tables->dropped = true;
    cache_wait_for_readers(cache, cache_begin_epoch(cache));
    while (atomic_load_explicit(&tables->users, memory_order_acquire))
        pthread_cond_wait(&cache->changed, &cache->lock);
    cache->table_bytes -= tables->bytes;
    free_tables(tables);
}

/* Throws away the tables of files that were not looked at since the hand last came by. */
static void trim_tables(slv_cache *cache, const cache_file *keep) {
    for (uint32_t left = 2 * cache->file_end; left && cache->table_bytes > cache->max_bytes / 2;
         left--) {
        cache->file_hand = (cache->file_hand + 1) % cache->file_end;
        cache_file *file =
            atomic_load_explicit(&cache->files[cache->file_hand], memory_order_relaxed);
        cache_tables *tables =
            file ? atomic_load_explicit(&file->tables, memory_order_relaxed) : NULL;
        if (!tables || file == keep ||
            atomic_exchange_explicit(&tables->used, 0, memory_order_relaxed) ||
            atomic_load_explicit(&tables->users, memory_order_relaxed))
            continue;
        cache_drop_tables(cache, file);
    }
    cache_trim_slabs(cache);
}

slv_result cache_load_tables(slv_cache *cache, slv_file_id id) {
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
        if (file->loading) {
            pthread_cond_wait(&cache->changed, &cache->lock);
            continue;
        }
        cache_tables *tables = NULL;
        file->loading = true;
        pthread_mutex_unlock(&cache->lock);
        result = make_tables(cache, file->path, &tables);
        pthread_mutex_lock(&cache->lock);
        file->loading = false;
        pthread_cond_broadcast(&cache->changed);
        if (result)
            break;
        tables->place = id % CACHE_FILES;
        tables->serial = ++cache->next_serial;
        if (tables->serial == 0)
            tables->serial = ++cache->next_serial;
        cache->stats.reloaded += file->loaded_before;
        file->loaded_before = true;
        cache->table_bytes += tables->bytes;
        file->info = *slv_ptx_get_info(tables->ptx);
        file->info.level_faces = NULL;
        file->info.level_bytes = NULL;
        atomic_store_explicit(&tables->used, 1, memory_order_relaxed);
        atomic_store_explicit(&file->tables, tables, memory_order_release);
        trim_tables(cache, file);
        break;
    }
    pthread_mutex_unlock(&cache->lock);
    return result;
}

void cache_learn_face(cache_tables *tables, uint32_t index) {
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
    f->res_u = face.res.u;
    f->res_v = face.res.v;
    atomic_store_explicit(&f->state, CACHE_KNOWN, memory_order_release);
}

/* As .ptx files are tiled, so that a block is a tile of most files. */
slv_res cache_tile_res(const cache_tables *tables, int res_u, int res_v) {
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
