/* Reading what lookups did not find. */
#include "cache/cache_data.h"

static uint32_t block_offset(const slv_cache *cache, const cache_block *block) {
    size_t texels = (size_t)((const uint8_t *)block - cache->arena) + CACHE_HEADER;
    return (uint32_t)(texels / CACHE_UNIT);
}

static _Atomic(uint64_t) *bucket_of(const slv_cache *cache, uint64_t hash) {
    return cache->buckets + (hash & cache->bucket_mask) * CACHE_WAYS;
}

static void link_block(slv_cache *cache, cache_tables *tables, cache_block *block) {
    uint32_t at = block_offset(cache, block);
    if (block->direct) {
        atomic_store_explicit(&tables->faces[block->face].texels, at, memory_order_release);
        return;
    }
    if (block->tile == CACHE_APRON)
        atomic_store_explicit(&tables->faces[block->face].apron, at, memory_order_release);
    uint64_t hash = cache_hash(block->serial, block->face, block->res_u, block->res_v, block->tile);
    _Atomic(uint64_t) *bucket = bucket_of(cache, hash);
    /* a full bucket loses what was not used, or what its hash picks */
    int way = (int)(hash >> 40) % CACHE_WAYS;
    for (int i = 0; i < CACHE_WAYS; i++) {
        uint32_t other = (uint32_t)atomic_load_explicit(&bucket[i], memory_order_relaxed);
        if (!other) {
            way = i;
            break;
        }
        cache_block *held =
            (cache_block *)(void *)(cache->arena + (size_t)other * CACHE_UNIT - CACHE_HEADER);
        if (!atomic_exchange_explicit(&held->used, 0, memory_order_relaxed))
            way = i;
    }
    if ((uint32_t)atomic_load_explicit(&bucket[way], memory_order_relaxed))
        cache->stats.evictions++;
    atomic_store_explicit(&bucket[way], hash >> 32 << 32 | at, memory_order_release);
}

/* Where a face points to a block, or NULL. */
static _Atomic(uint32_t) *face_entry(const slv_cache *cache, const cache_block *block,
                                     cache_face **out) {
    cache_file *file = atomic_load_explicit(&cache->files[block->place], memory_order_relaxed);
    cache_tables *tables = file ? atomic_load_explicit(&file->tables, memory_order_relaxed) : NULL;
    if (!tables || tables->serial != block->serial ||
        (!block->direct && block->tile != CACHE_APRON))
        return NULL;
    cache_face *face = &tables->faces[block->face];
    _Atomic(uint32_t) *entry = block->direct ? &face->texels : &face->apron;
    *out = face;
    return atomic_load_explicit(entry, memory_order_relaxed) == block_offset(cache, block) ? entry
                                                                                           : NULL;
}

static _Atomic(uint64_t) *hashed_entry(const slv_cache *cache, const cache_block *block) {
    uint64_t hash = cache_hash(block->serial, block->face, block->res_u, block->res_v, block->tile);
    _Atomic(uint64_t) *bucket = bucket_of(cache, hash);
    uint32_t at = block_offset(cache, block);
    for (int i = 0; i < CACHE_WAYS; i++)
        if ((uint32_t)atomic_load_explicit(&bucket[i], memory_order_relaxed) == at)
            return &bucket[i];
    return NULL;
}

bool slvi_cache_take_use(slv_cache *cache, cache_block *block) {
    cache_face *face;
    if (!block->serial)
        return false;
    _Atomic(uint32_t) *entry = face_entry(cache, block, &face);
    if (block->direct)
        return entry && atomic_exchange_explicit(&face->used, 0, memory_order_relaxed);
    return atomic_exchange_explicit(&block->used, 0, memory_order_relaxed) &&
           (entry || hashed_entry(cache, block));
}

void slvi_cache_unlink(slv_cache *cache, cache_block *block) {
    cache_face *face;
    if (!block->serial)
        return;
    _Atomic(uint32_t) *pointer = face_entry(cache, block, &face);
    _Atomic(uint64_t) *entry = block->direct ? NULL : hashed_entry(cache, block);
    if (pointer)
        atomic_store_explicit(pointer, 0, memory_order_seq_cst);
    if (entry)
        atomic_store_explicit(entry, 0, memory_order_seq_cst);
    cache->stats.evictions += pointer || entry;
}

static slv_result read_texels(cache_thread *thread, const cache_tables *tables, uint32_t face,
                              slv_res res, slv_res tile_res, uint32_t tile, void *out) {
    if (thread->reader_serial != tables->serial) {
        slv_ptx_reader_destroy(thread->reader);
        thread->reader_serial = 0;
        slv_env env = slvi_cache_handle_env(tables->handle);
        slv_result result = slv_ptx_reader_create(&env, tables->ptx, &thread->reader);
        if (result)
            return result;
        thread->reader_serial = tables->serial;
    }
    uint32_t columns = 1u << (res.u - tile_res.u);
    slv_result result =
        slv_ptx_reader_read_tile(thread->reader, face, res, tile_res, tile % columns << tile_res.u,
                                 tile / columns << tile_res.v, out);
    return slvi_cache_handle_result(tables->handle, result);
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
    block->place = tables->place;
    block->direct = direct;
    block->serial = tables->serial;
    atomic_store_explicit(&block->used, 1, memory_order_relaxed);
    link_block(cache, tables, block);
}

/* Under the lock, which it lets go while it reads. */
static const uint8_t *load_block(cache_thread *thread, cache_tables *tables, cache_load *load,
                                 bool direct, slv_result *result) {
    slv_cache *cache = thread->cache;
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
    *result = read_texels(thread, tables, load->face, res, tile_res, load->tile, texels);
    memset(texels + bytes, 0, units * CACHE_UNIT - CACHE_HEADER - bytes);

    pthread_mutex_lock(&cache->lock);
    end_load(cache, load);
    if (!*result && !tables->dropped)
        identify(cache, tables, load, direct, block);
    slvi_cache_settle(cache, block);
    return *result ? NULL : texels;
}

const uint8_t *slvi_cache_load_block(cache_thread *thread, cache_tables *tables, uint32_t face,
                                     int res_u, int res_v, uint32_t tile, slv_result *result) {
    slv_cache *cache = thread->cache;
    cache_load load = {tables, face, tile, (int8_t)res_u, (int8_t)res_v, NULL};
    cache_face *f = &tables->faces[face];
    bool direct = res_u == f->res_u && res_v == f->res_v && res_u + res_v <= tables->whole_log2;
    const uint8_t *texels = NULL;
    *result = SLV_OK;
    atomic_fetch_add_explicit(&tables->users, 1, memory_order_relaxed);
    cache_unpin(thread);
    thread->moves++;
    pthread_mutex_lock(&cache->lock);
    while (!tables->dropped) {
        texels = direct ? cache_find_full(cache, f)
                        : cache_find_hashed(cache, tables, face, res_u, res_v, tile);
        if (texels)
            break;
        if (is_loading(cache, &load)) {
            pthread_cond_wait(&cache->changed, &cache->lock);
            continue;
        }
        cache_count(&thread->misses, 1);
        texels = load_block(thread, tables, &load, direct, result);
        break;
    }
    /* pinned under the lock: whoever evicts next will see it */
    cache_pin(thread);
    if (tables->dropped)
        texels = NULL;
    atomic_fetch_sub_explicit(&tables->users, 1, memory_order_release);
    if (tables->dropped || cache->table_waiters)
        pthread_cond_broadcast(&cache->changed);
    pthread_mutex_unlock(&cache->lock);
    return texels;
}

const uint8_t *slvi_cache_publish(cache_thread *thread, cache_tables *tables, uint32_t face,
                                  int res_u, int res_v, uint32_t tile, const void *texels,
                                  size_t bytes, uint32_t note) {
    slv_cache *cache = thread->cache;
    cache_load load = {tables, face, tile, (int8_t)res_u, (int8_t)res_v, NULL};
    const uint8_t *found = NULL;
    size_t units = block_units(bytes);
    atomic_fetch_add_explicit(&tables->users, 1, memory_order_relaxed);
    cache_unpin(thread);
    thread->moves++;
    pthread_mutex_lock(&cache->lock);
    cache_block *block = tables->dropped ? NULL : slvi_cache_allocate(cache, (uint32_t)units);
    if (block) {
        uint8_t *to = (uint8_t *)block + CACHE_HEADER;
        /* allocating lets go of the lock at times */
        found = cache_find_hashed(cache, tables, face, res_u, res_v, tile);
        if (!found && !tables->dropped) {
            memcpy(to, texels, bytes);
            memset(to + bytes, 0, units * CACHE_UNIT - CACHE_HEADER - bytes);
            block->note = note;
            identify(cache, tables, &load, false, block);
            found = to;
        }
        slvi_cache_settle(cache, block);
    }
    cache_pin(thread);
    if (tables->dropped)
        found = NULL;
    atomic_fetch_sub_explicit(&tables->users, 1, memory_order_release);
    if (tables->dropped)
        pthread_cond_broadcast(&cache->changed);
    pthread_mutex_unlock(&cache->lock);
    return found;
}
