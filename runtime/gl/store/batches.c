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
                                   slv_gl_batches *out) {
    uint32_t nfaces = 0, first = 0;
    slv_gl_batches batches = {0};
    for (uint32_t p = 0; p < pools->npools; p++)
        nfaces += pools->pools[p].nlayers;
    slv_result result = slvi_alloc(env, "batches", nfaces, sizeof *batches.faces, &batches.faces);
    for (uint32_t p = 0; !result && p < pools->npools; p++) {
        slv_gl_batch_range *range = NULL;
        if (!pools->pools[p].nlayers)
            continue;
        if ((result = slvi_gl_add_batch(env, &batches, &range)))
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

slv_result slvi_gl_batches_list(const slv_env *env, slv_gl_batches *batches, const uint32_t *order,
                                uint32_t nfaces, uint32_t *batch_of) {
    uint32_t first = 0, *place = NULL;
    slv_gl_batch_range *sorted = NULL;
    slv_result result = slvi_alloc(env, "batches", batches->count, sizeof *place, &place);
    if (result || (result = slvi_alloc(env, "batches", batches->count, sizeof *sorted, &sorted)))
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
