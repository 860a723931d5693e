/* Which blocks can be found, and from where. */
#include "cache/cache_data.h"

static uint32_t block_offset(const slv_cache *cache, const cache_block *block) {
    size_t texels = (size_t)((const uint8_t *)block - cache->view.arena) + CACHE_HEADER;
    return (uint32_t)(texels / CACHE_UNIT);
}

static _Atomic(uint64_t) *bucket_of(const slv_cache *cache, uint64_t hash) {
    return cache->view.buckets + (hash & cache->view.bucket_mask) * CACHE_WAYS;
}

void slvi_cache_link(slv_cache *cache, cache_tables *tables, cache_block *block) {
    uint32_t at = block_offset(cache, block);
    if (block->direct) {
        atomic_store_explicit(&tables->faces[block->face].texels, at, memory_order_release);
        return;
    }
    if (block->tile & CACHE_APRON)
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
            (cache_block *)(void *)(cache->view.arena + (size_t)other * CACHE_UNIT - CACHE_HEADER);
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
    cache_file *file = cache_file_at(cache, block->place);
    cache_tables *tables = file ? cache_tables_of(file) : NULL;
    if (!tables || tables->serial != block->serial ||
        (!block->direct && !(block->tile & CACHE_APRON)))
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

void slvi_cache_unlink_tile(slv_cache *cache, cache_tables *tables, uint32_t face, slv_res res,
                            uint32_t tile) {
    uint64_t hash = cache_hash(tables->serial, face, res.u, res.v, tile);
    _Atomic(uint64_t) *bucket = bucket_of(cache, hash);
    for (int i = 0; i < CACHE_WAYS; i++) {
        uint64_t entry = atomic_load_explicit(&bucket[i], memory_order_relaxed);
        if (entry >> 32 != hash >> 32 || !(uint32_t)entry)
            continue;
        const cache_block *block =
            (const cache_block *)(const void *)(cache->view.arena +
                                                (entry & 0xffffffffu) * CACHE_UNIT - CACHE_HEADER);
        if (cache_block_is(block, tables->serial, face, res.u, res.v, tile))
            atomic_store_explicit(&bucket[i], 0, memory_order_seq_cst);
    }
}
