/* What could not be read is remembered, so that it is tried once and told once. */
#include "cache/cache_data.h"

#include "base/memory.h"

#define FIRST_CAPACITY 16
#define MOST_CAPACITY 65536 /* what fails beyond this many is tried each time */

/* Where something is, or the free slot where it would be. The table has one. */
static cache_failure *find(const cache_failures *failures, uint32_t face, slv_res res,
                           uint32_t tile) {
    uint64_t hash = cache_hash(0, face, res.u, res.v, tile);
    for (uint32_t i = (uint32_t)hash;; i++) {
        cache_failure *slot = &failures->slots[i & (failures->capacity - 1)];
        if (!slot->taken || (slot->face == face && slot->tile == tile && slot->res_u == res.u &&
                             slot->res_v == res.v))
            return slot;
    }
}

slv_result slvi_cache_failure_find(const cache_failures *failures, uint32_t face, slv_res res,
                                   uint32_t tile) {
    return failures->capacity ? find(failures, face, res, tile)->result : SLV_OK;
}

/* A table that is at most half full. False if there is no room for one. */
static bool make_room(const slv_env *env, cache_failures *failures) {
    cache_failures larger = {.capacity =
                                 failures->capacity ? 2 * failures->capacity : FIRST_CAPACITY};
    slv_env silent = *env;
    silent.log = NULL;
    if (2 * (failures->taken + 1) <= failures->capacity)
        return true;
    if (larger.capacity > MOST_CAPACITY ||
        slvi_alloc(&silent, "failures", larger.capacity, sizeof *larger.slots, &larger.slots))
        return false;
    for (uint32_t i = 0; i < failures->capacity; i++) {
        const cache_failure *old = &failures->slots[i];
        if (old->taken && old->result) {
            *find(&larger, old->face, (slv_res){old->res_u, old->res_v}, old->tile) = *old;
            larger.taken++;
        }
    }
    slvi_free(failures->slots);
    *failures = larger;
    return true;
}

void slvi_cache_failure_add(const slv_env *env, cache_failures *failures, uint32_t face,
                            slv_res res, uint32_t tile, slv_result failure) {
    if (!make_room(env, failures))
        return;
    cache_failure *slot = find(failures, face, res, tile);
    failures->taken += !slot->taken;
    *slot = (cache_failure){face, tile, res.u, res.v, true, failure};
}

void slvi_cache_failure_forget(cache_failures *failures, uint32_t face) {
    for (uint32_t i = 0; i < failures->capacity; i++)
        if (failures->slots[i].face == face)
            failures->slots[i].result = SLV_OK;
}

void slvi_cache_failure_forget_all(cache_failures *failures) {
    slvi_free(failures->slots);
    *failures = (cache_failures){0};
}
