/* Texels without a value take what is nearest, so that averages mix nothing in. */
#include "recipe/holes.h"

#include "base/memory.h"

#include <string.h>

/* A level: the mean of what is known of 2x2 of the one below, and whether anything is. */
static void pull(uint32_t n, slv_res res, const float *values, const uint8_t *known, slv_res to,
                 float *out, uint8_t *out_known) {
    uint32_t w = 1u << to.u, h = 1u << to.v;
    for (uint32_t i = 0; i < w * h; i++) {
        uint32_t x = i % w << (res.u - to.u), y = i / w << (res.v - to.v), count = 0;
        float sum[4] = {0};
        for (uint32_t k = 0; k < 4; k++) {
            if ((k & 1 && res.u == to.u) || (k & 2 && res.v == to.v))
                continue;
            size_t at = ((size_t)(y + (k >> 1)) << res.u) + x + (k & 1);
            for (uint32_t c = 0; known[at] && c < n; c++)
                sum[c] += values[at * n + c];
            count += known[at];
        }
        for (uint32_t c = 0; c < n; c++)
            out[i * n + c] = count ? sum[c] / (float)count : 0;
        out_known[i] = count > 0;
    }
}

/* Recursive, a level at a time: 17 at most. */
static slv_result fill(const slv_env *env, uint32_t n, slv_res res, float *values, uint8_t *known) {
    slv_res to = {(int8_t)(res.u - (res.u > 0)), (int8_t)(res.v - (res.v > 0))};
    uint64_t count = UINT64_C(1) << (to.u + to.v), own = UINT64_C(1) << (res.u + res.v);
    float *above = NULL;
    uint8_t *above_known = NULL;
    if (own == 1 || !memchr(known, 0, own))
        return SLV_OK;
    slv_result result = slvi_alloc_plain(env, "bake: fill", count, n * sizeof *above, &above);
    if (!result && !(result = slvi_alloc_plain(env, "bake: fill", count, 1, &above_known))) {
        pull(n, res, values, known, to, above, above_known);
        result = fill(env, n, to, above, above_known);
    }
    for (uint64_t i = 0; i < own && !result; i++) {
        uint64_t x = (i & ((UINT64_C(1) << res.u) - 1)) >> (res.u - to.u),
                 y = i >> res.u >> (res.v - to.v);
        if (!known[i])
            memcpy(values + i * n, above + ((y << to.u) + x) * n, n * sizeof *values);
    }
    slvi_free(above);
    slvi_free(above_known);
    return result;
}

slv_result slvi_holes_fill(const slv_env *env, uint32_t nchannels, slv_res res,
                           const uint8_t *missed, float *values) {
    uint64_t count = UINT64_C(1) << (res.u + res.v);
    uint8_t *known = NULL;
    slv_result result = slvi_alloc_plain(env, "bake: fill", count, 1, &known);
    if (result)
        return result;
    for (uint64_t i = 0; i < count; i++)
        known[i] = !missed[i];
    result = fill(env, nchannels, res, values, known);
    slvi_free(known);
    return result;
}
