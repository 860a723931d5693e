/* Reading what lookups did not find. */
#include "cache/cache_data.h"

static slv_result read_texels(const cache_tables *tables, uint32_t face, slv_res res,
                              slv_res tile_res, uint32_t tile, void *out) {
    const cache_origin *origin = tables->origin;
    uint32_t columns = 1u << (res.u - tile_res.u);
    slv_rect rect = {tile % columns << tile_res.u, tile / columns << tile_res.v, 1u << tile_res.u,
                     1u << tile_res.v};
    slv_result result = origin->source.fns->read(origin->source.user, face, res, rect, out);
    return origin->handle ? slvi_cache_handle_result(origin->handle, result) : result;
}

static bool is_loading(const slv_cache *cache, const cache_load *load) {
    for (const cache_load *l = cache->loads; l; l = l->next)
        if (l->tables == load->tables && l->face == load->face && l->tile == load->tile &&
            l->res_u == load->res_u && l->res_v == load->res_v)
            return true;
    return false;
}

static void end_load(slv_cache *cache, const cache_load *load) {
    cache_load **at = &cache->loads;
    while (*at != load)
        at = &(*at)->next;
    *at = load->next;
}

static size_t block_units(size_t bytes) {
    return (CACHE_HEADER + bytes + CACHE_PADDING + CACHE_UNIT - 1) / CACHE_UNIT;
}

/* Says what a block is, and lets it be found. */
static void identify(slv_cache *cache, cache_tables *tables, const cache_load *load, bool direct,
                     cache_block *block) {
    block->face = load->face;
    block->tile = load->tile;
    block->res_u = load->res_u;
    block->res_v = load->res_v;
    block->place = tables->origin->place;
    block->direct = direct;
    block->serial = tables->serial;
    atomic_store_explicit(&block->used, 1, memory_order_relaxed);
    slvi_cache_link(cache, tables, block);
}

/* A file that is not what it was fails as a whole. What there was no memory for is tried again. */
static void remember(slv_cache *cache, const cache_tables *tables, const cache_load *load,
                     slv_result failure) {
    cache_file *file = cache_file_at(cache, tables->origin->place);
    if (failure == SLV_ERROR_MISMATCH && tables->origin->handle)
        file->failure = failure;
    else if (failure != SLV_ERROR_MEMORY)
        slvi_cache_failure_add(&cache->env, &file->failures, load->face,
                               (slv_res){load->res_u, load->res_v}, load->tile, failure);
}

static slv_result find_failure(const slv_cache *cache, const cache_load *load) {
    const cache_file *file = cache_file_at(cache, load->tables->origin->place);
    if (file->failure)
        return file->failure;
    return slvi_cache_failure_find(&file->failures, load->face, (slv_res){load->res_u, load->res_v},
                                   load->tile);
}

/* Under the lock, which it lets go while it reads. */
static const uint8_t *load_block(slv_cache *cache, cache_tables *tables, cache_load *load,
                                 bool direct, slv_result *result) {
    slv_res res = {load->res_u, load->res_v};
    slv_res tile_res = slvi_cache_tile_res(tables, res.u, res.v);
    size_t bytes = ((size_t)tables->pixel_size << (tile_res.u + tile_res.v));
    size_t units = block_units(bytes);
    cache_block *block;
    load->next = cache->loads;
    cache->loads = load;
    block = slvi_cache_allocate(cache, (uint32_t)units);
    pthread_mutex_unlock(&cache->lock);

    uint8_t *texels = (uint8_t *)block + CACHE_HEADER;
    *result = read_texels(tables, load->face, res, tile_res, load->tile, texels);
    memset(texels + bytes, 0, units * CACHE_UNIT - CACHE_HEADER - bytes);

    pthread_mutex_lock(&cache->lock);
    end_load(cache, load);
    if (!load->stale && !tables->origin->dropped) {
        if (*result)
            remember(cache, tables, load, *result);
        else
            identify(cache, tables, load, direct, block);
    }
    slvi_cache_settle(cache, block);
    return *result ? NULL : texels;
}

const uint8_t *slvi_cache_load_block(cache_thread *thread, cache_tables *tables, uint32_t face,
                                     int res_u, int res_v, uint32_t tile, slv_result *result) {
    slv_cache *cache = thread->cache;
    cache_load load = {tables, face, tile, (int8_t)res_u, (int8_t)res_v, false, NULL};
    cache_face *f = &tables->faces[face];
    bool direct = res_u == f->res_u && res_v == f->res_v && res_u + res_v <= tables->whole_log2;
    const uint8_t *texels = NULL;
    *result = SLV_OK;
    atomic_fetch_add_explicit(&tables->origin->users, 1, memory_order_relaxed);
    cache_unpin(thread);
    thread->moves++;
    pthread_mutex_lock(&cache->lock);
    while (!tables->origin->dropped) {
        texels = direct ? cache_find_full(thread->view, f)
                        : cache_find_hashed(thread->view, tables, face, res_u, res_v, tile);
        if (texels)
            break;
        if (is_loading(cache, &load)) {
            pthread_cond_wait(&cache->changed, &cache->lock);
            continue;
        }
        if ((*result = find_failure(cache, &load)))
            break;
        cache_count(&thread->misses, 1);
        texels = load_block(cache, tables, &load, direct, result);
        break;
    }
    /* pinned under the lock: whoever evicts next will see it */
    cache_pin(thread);
    if (tables->origin->dropped)
        texels = NULL;
    atomic_fetch_sub_explicit(&tables->origin->users, 1, memory_order_release);
    if (tables->origin->dropped || cache->table_waiters)
        pthread_cond_broadcast(&cache->changed);
    pthread_mutex_unlock(&cache->lock);
    return texels;
}

/* Nine parameters, since a block is known by six, and each caller has them apart. */
const uint8_t *slvi_cache_publish(cache_thread *thread, cache_tables *tables, uint32_t face,
                                  int res_u, int res_v, uint32_t tile, const void *texels,
                                  size_t bytes, uint32_t note) {
    slv_cache *cache = thread->cache;
    cache_load load = {tables, face, tile, (int8_t)res_u, (int8_t)res_v, false, NULL};
    const uint8_t *found = NULL;
    size_t units = block_units(bytes);
    atomic_fetch_add_explicit(&tables->origin->users, 1, memory_order_relaxed);
    cache_unpin(thread);
    thread->moves++;
    pthread_mutex_lock(&cache->lock);
    cache_block *block =
        tables->origin->dropped ? NULL : slvi_cache_allocate(cache, (uint32_t)units);
    if (block) {
        uint8_t *to = (uint8_t *)block + CACHE_HEADER;
        /* allocating lets go of the lock at times */
        found = cache_find_hashed(thread->view, tables, face, res_u, res_v, tile);
        if (!found && !tables->origin->dropped) {
            memcpy(to, texels, bytes);
            memset(to + bytes, 0, units * CACHE_UNIT - CACHE_HEADER - bytes);
            block->note = note;
            identify(cache, tables, &load, false, block);
            found = to;
        }
        slvi_cache_settle(cache, block);
    }
    cache_pin(thread);
    if (tables->origin->dropped)
        found = NULL;
    atomic_fetch_sub_explicit(&tables->origin->users, 1, memory_order_release);
    if (tables->origin->dropped)
        pthread_cond_broadcast(&cache->changed);
    pthread_mutex_unlock(&cache->lock);
    return found;
}
