/* Lists of batches, in the order in which they are drawn. */
#include "gl/store/batches.h"

#include "base/memory.h"

#include <string.h>

void slvi_gl_batches_free(slv_gl_batches *batches) {
    slvi_free(batches->ranges);
    if (!batches->of_pools)
        slvi_free(batches->faces);
    memset(batches, 0, sizeof *batches);
}

slv_result slvi_gl_add_batch(const slv_env *env, slv_gl_batches *batches,
                             slv_gl_batch_range **out) {
    if (batches->count == batches->capacity) {
        uint32_t capacity = batches->capacity ? batches->capacity * 2 : 16;
        slv_result result =
            slvi_grow(env, "batches", capacity, sizeof *batches->ranges, &batches->ranges);
        if (result)
            return result;
        batches->capacity = capacity;
    }
    *out = &batches->ranges[batches->count++];
    memset(*out, 0, sizeof **out);
    return SLV_OK;
}

/* The faces in a chunk of a pool and of those after it, as `next` says, if there are any. */
static slv_result add_some(const slv_env *env, const slv_gl_pools *pools, uint32_t p,
                           const uint32_t *next, slv_gl_chunks chunks, uint32_t chunk,
                           uint32_t *first, slv_gl_batches *out) {
    uint32_t end = *first;
    slv_gl_batch_range *range;
    for (uint32_t q = p + 1; q; q = next[q - 1]) {
        const slv_gl_pool *pool = &pools->pools[q - 1];
        if (out->of_pools) {
            end += pool->nlayers;
            continue;
        }
        for (uint32_t layer = 0; layer < pool->nlayers; layer++) {
            out->faces[end] = pool->items[layer]; /* which the next one goes over unless it stays */
            end += slv_gl_chunk_of(chunks, pool->items[layer]) == chunk;
        }
    }
    if (end == *first)
        return SLV_OK;
    slv_result result = slvi_gl_add_batch(env, out, &range);
    if (result)
        return result;
    *range = (slv_gl_batch_range){
        .first = *first, .count = end - *first, .chunk = chunk, .npools = 1, .pools = {p}};
    *first = end;
    return SLV_OK;
}

slv_result slvi_gl_batches_by_pool(const slv_env *env, const slv_gl_pools *pools,
                                   slv_gl_chunks chunks, slv_gl_batches *out) {
    uint32_t first = 0, *next = NULL, *of_sheet = NULL; /* one more than a pool's number */
    slv_result result;
    *out = (slv_gl_batches){0};
    if ((result = slvi_alloc(env, "batches", pools->npools, sizeof *next, &next)) ||
        (result = slvi_alloc(env, "batches", pools->nsheets, sizeof *of_sheet, &of_sheet)))
        goto done;
    if (chunks.count == 1 && !pools->nsheets) { /* they are listed that way already */
        out->of_pools = true;
        out->faces = pools->order;
    } else if ((result = slvi_alloc_plain(env, "batches", (uint64_t)pools->nitems + 1,
                                          sizeof *out->faces, &out->faces))) {
        goto done;
    }
    for (uint32_t p = pools->npools; p--;) { /* so that the first of a sheet's pools leads */
        const slv_gl_pool *pool = &pools->pools[p];
        if (!pool->columns || !pool->nlayers)
            continue;
        next[p] = of_sheet[pool->sheet];
        of_sheet[pool->sheet] = p + 1;
    }
    for (uint32_t chunk = 0; chunk < chunks.count; chunk++) {
        for (uint32_t p = 0; !result && p < pools->npools; p++) {
            const slv_gl_pool *pool = &pools->pools[p];
            if (pool->nlayers && (!pool->columns || of_sheet[pool->sheet] == p + 1))
                result = add_some(env, pools, p, next, chunks, chunk, &first, out);
        }
    }
done:
    slvi_free(next);
    slvi_free(of_sheet);
    if (result)
        slvi_gl_batches_free(out);
    return result;
}

uint32_t slvi_gl_add_pool(uint32_t *pools, uint32_t *npools, uint32_t pool) {
    for (uint32_t i = 0; i < *npools; i++)
        if (pools[i] == pool)
            return i;
    pools[*npools] = pool;
    return (*npools)++;
}

uint32_t slvi_gl_slot_of(const slv_gl_batch_range *range, uint32_t pool) {
    uint32_t slot = 0;
    while (slot < range->npools && range->pools[slot] != pool)
        slot++;
    return slot;
}

uint32_t slvi_gl_variant_for(uint32_t npools, bool subfaces) {
    uint32_t log2 = 0;
    while (1u << log2 < npools)
        log2++;
    return log2 << 1 | subfaces;
}

void slvi_gl_batches_unite(slv_gl_batches *batches) {
    uint32_t pools = 0, subfaces = 0;
    for (uint32_t b = 0; b < batches->count; b++) {
        uint32_t variant = batches->ranges[b].variant;
        pools = variant >> 1 > pools ? variant >> 1 : pools;
        subfaces |= variant & 1;
    }
    for (uint32_t b = 0; b < batches->count; b++)
        batches->ranges[b].variant = pools << 1 | subfaces;
}

/* The number of each batch of a chunk: *batches has the batches of all chunks afterwards, those
 * without faces left out. */
static slv_result split(const slv_env *env, slv_gl_chunks chunks, const uint32_t *order,
                        uint32_t nfaces, slv_gl_batches *batches, uint32_t *batch_of) {
    uint64_t whole = batches->count, all = whole * chunks.count;
    uint32_t *number = NULL;
    slv_gl_batch_range *range;
    slv_result result;
    if (chunks.count == 1)
        return SLV_OK;
    if ((result = slvi_alloc(env, "batches", all, sizeof *number, &number)))
        return result;
    for (uint32_t b = 0; b < whole; b++)
        batches->ranges[b].count = 0;
    for (uint32_t i = 0; !result && i < nfaces; i++) {
        uint32_t *batch = &batch_of[order[i]], chunk = slv_gl_chunk_of(chunks, order[i]);
        uint32_t *its = &number[*batch * (uint64_t)chunks.count + chunk];
        if (!*its) {
            if (batches->ranges[*batch].count && (result = slvi_gl_add_batch(env, batches, &range)))
                break;
            *its = batches->ranges[*batch].count ? batches->count : *batch + 1;
            if (*its > whole)
                batches->ranges[*its - 1] = batches->ranges[*batch];
            batches->ranges[*its - 1].count = 0;
            batches->ranges[*its - 1].chunk = chunk;
        }
        *batch = *its - 1;
        batches->ranges[*batch].count++;
    }
    slvi_free(number);
    return result;
}

slv_result slvi_gl_batches_list(const slv_env *env, slv_gl_batches *batches, const uint32_t *order,
                                uint32_t nfaces, slv_gl_chunks chunks, uint32_t *batch_of) {
    uint32_t first = 0, *place = NULL;
    slv_gl_batch_range *sorted = NULL;
    slv_result result = split(env, chunks, order, nfaces, batches, batch_of);
    if (result || (result = slvi_alloc(env, "batches", batches->count, sizeof *place, &place)) ||
        (result = slvi_alloc(env, "batches", batches->count, sizeof *sorted, &sorted)))
        goto done;
    for (uint32_t i = 0, at = 0; i < chunks.count * SLV_GL_MAX_VARIANTS; i++) {
        for (uint32_t b = 0; b < batches->count; b++) {
            const slv_gl_batch_range *range = &batches->ranges[b];
            if (range->chunk * SLV_GL_MAX_VARIANTS + range->variant != i)
                continue;
            place[b] = at;
            sorted[at] = batches->ranges[b];
            sorted[at].first = first;
            first += sorted[at].count;
            sorted[at++].count = 0;
        }
    }
    memcpy(batches->ranges, sorted, batches->count * sizeof *sorted);
    for (uint32_t i = 0; i < nfaces; i++) {
        uint32_t *batch = &batch_of[order[i]];
        *batch = place[*batch];
        slv_gl_batch_range *range = &batches->ranges[*batch];
        batches->faces[range->first + range->count++] = order[i];
    }
done:
    slvi_free(place);
    slvi_free(sorted);
    return result;
}
