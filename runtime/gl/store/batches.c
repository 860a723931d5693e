/* Lists of batches, in the order in which they are drawn. */
#include "gl/store/batches.h"

#include "base/memory.h"

#include <string.h>

void slvi_gl_batches_free(slv_gl_batches *batches) {
    slvi_free(batches->ranges);
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

slv_result slvi_gl_batches_by_pool(const slv_env *env, const slv_gl_pools *pools,
                                   slv_gl_chunks chunks, slv_gl_batches *out) {
    uint32_t *batch_of = NULL, *of_sheet = NULL; /* one more than its batch's number */
    slv_gl_batches batches = {0};
    slv_result result;
    if ((result =
             slvi_alloc(env, "batches", pools->nitems, sizeof *batches.faces, &batches.faces)) ||
        (result = slvi_alloc(env, "batches", pools->nsheets, sizeof *of_sheet, &of_sheet)) ||
        (result = slvi_alloc(env, "batches", pools->nitems, sizeof *batch_of, &batch_of)))
        goto done;
    for (uint32_t p = 0; !result && p < pools->npools; p++) {
        const slv_gl_pool *pool = &pools->pools[p];
        slv_gl_batch_range *range = NULL;
        uint32_t number = pool->columns ? of_sheet[pool->sheet] : 0;
        if (!pool->nlayers)
            continue;
        if (!number) {
            if ((result = slvi_gl_add_batch(env, &batches, &range)))
                goto done;
            range->npools = 1;
            range->pools[0] = p;
            number = batches.count;
            if (pool->columns)
                of_sheet[pool->sheet] = number;
        }
        batches.ranges[number - 1].count += pool->nlayers;
        for (uint32_t layer = 0; layer < pool->nlayers; layer++)
            batch_of[pool->items[layer]] = number - 1;
    }
    result = slvi_gl_batches_list(env, &batches, pools->order, pools->nitems, chunks, batch_of);
done:
    slvi_free(batch_of);
    slvi_free(of_sheet);
    if (result)
        slvi_gl_batches_free(&batches);
    *out = batches;
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
    for (uint32_t variant = 0, at = 0; variant < SLV_GL_MAX_VARIANTS; variant++) {
        for (uint32_t b = 0; b < batches->count; b++) {
            if (batches->ranges[b].variant != variant)
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
