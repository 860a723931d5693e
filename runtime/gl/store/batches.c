/* Batches are made face by face: each joins one that has its pools, or makes a new one. */
#include "gl/store/batches.h"

#include "base/memory.h"

#include <string.h>

void slvi_gl_batches_free(slv_gl_batches *batches) {
    slvi_free(batches->ranges);
    slvi_free(batches->faces);
    memset(batches, 0, sizeof *batches);
}

static slv_result add_range(const slv_env *env, slv_gl_batches *batches, slv_gl_batch_range **out) {
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
                                   slv_gl_batches *out) {
    uint32_t nfaces = 0, first = 0;
    slv_gl_batches batches = {0};
    for (uint32_t p = 0; p < pools->npools; p++)
        nfaces += pools->pools[p].nlayers;
    slv_result result = slvi_alloc(env, "batches", nfaces, sizeof *batches.faces, &batches.faces);
    for (uint32_t p = 0; !result && p < pools->npools; p++) {
        slv_gl_batch_range *range = NULL;
        if ((result = add_range(env, &batches, &range)))
            break;
        range->first = first;
        range->count = pools->pools[p].nlayers;
        range->npools = 1;
        range->pools[0] = p;
        memcpy(batches.faces + first, pools->pools[p].items, range->count * sizeof *batches.faces);
        first += range->count;
    }
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

uint32_t slvi_gl_variant_for(uint32_t npools, bool two_subfaces) {
    uint32_t log2 = 0;
    while (1u << log2 < npools)
        log2++;
    return log2 << 1 | two_subfaces;
}

/* How many of `pools` a range lacks, or UINT32_MAX if it has no room for them. */
static uint32_t missing_pools(const slv_gl_batch_range *range, const uint32_t *pools,
                              uint32_t npools) {
    uint32_t missing = 0;
    for (uint32_t i = 0; i < npools; i++) {
        uint32_t k = 0;
        while (k < range->npools && range->pools[k] != pools[i])
            k++;
        missing += k == range->npools;
    }
    return range->npools + missing <= slv_gl_variant_pools(range->variant) ? missing : UINT32_MAX;
}

/* The batch that a face joins at the least cost: of its variant, among the newest of its own pool.
 * Where size classes alternate from face to face, neighbouring faces belong to different batches,
 * so that the newest alone would seldom fit. */
static slv_gl_batch_range *find_range(const slv_gl_batches *batches, uint32_t first,
                                      uint32_t variant, const uint32_t *pools, uint32_t npools) {
    enum { NEWEST = 64 };
    slv_gl_batch_range *best = NULL;
    uint32_t least = UINT32_MAX;
    for (uint32_t b = batches->count; b > first && b + NEWEST > batches->count && least > 0; b--) {
        slv_gl_batch_range *range = &batches->ranges[b - 1];
        uint32_t missing =
            range->variant == variant ? missing_pools(range, pools, npools) : UINT32_MAX;
        if (missing < least) {
            least = missing;
            best = range;
        }
    }
    return best;
}

slv_result slvi_gl_join_batch(const slv_env *env, slv_gl_batches *batches, uint32_t first,
                              uint32_t variant, const uint32_t *pools, uint32_t npools,
                              uint32_t *batch) {
    slv_gl_batch_range *range = find_range(batches, first, variant, pools, npools);
    if (!range) {
        slv_result result = add_range(env, batches, &range);
        if (result)
            return result;
        range->variant = variant;
    }
    for (uint32_t i = 0; i < npools; i++)
        slvi_gl_add_pool(range->pools, &range->npools, pools[i]);
    range->count++;
    *batch = (uint32_t)(range - batches->ranges);
    return SLV_OK;
}

void slvi_gl_batches_list(slv_gl_batches *batches, const uint32_t *order, uint32_t nfaces,
                          const uint32_t *batch_of) {
    uint32_t first = 0;
    for (uint32_t b = 0; b < batches->count; b++) {
        batches->ranges[b].first = first;
        first += batches->ranges[b].count;
        batches->ranges[b].count = 0;
    }
    for (uint32_t i = 0; i < nfaces; i++) {
        slv_gl_batch_range *range = &batches->ranges[batch_of[order[i]]];
        batches->faces[range->first + range->count++] = order[i];
    }
}
