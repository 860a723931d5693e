/* A pattern in space as a source: the mean over a grid of samples on the limit surface. */
#include "procedural/pattern.h"
#include "source/source.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

enum { SIDE = 2, AT_ONCE = 1024 }; /* samples a texel along each axis; texels */

typedef struct pattern_source {
    slv_bake_source base;
    const slv_surface *surface;
    slv_procedural pattern;
} pattern_source;

static slv_result evaluate_some(const pattern_source *s, const slv_env *env, uint32_t face,
                                slv_res res, slv_rect rect, float *values) {
    enum { EACH = SIDE * SIDE };
    uint32_t n = s->base.desc.nchannels, count = rect.width * rect.height;
    struct {
        slv_surface_point points[AT_ONCE * EACH];
        float positions[AT_ONCE * EACH][3];
    } *work = NULL;
    slv_result result = slvi_alloc_plain(env, "bake: samples", 1, sizeof *work, &work);
    if (result)
        return result;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < EACH; k++) {
            float x = (float)(rect.x + i % rect.width) + ((float)(k % SIDE) + 0.5f) / SIDE;
            float y = (float)(rect.y + i / rect.width) + ((float)(k / SIDE) + 0.5f) / SIDE;
            work->points[i * EACH + k] = (slv_surface_point){
                (int32_t)face, x / (float)(1u << res.u), y / (float)(1u << res.v)};
        }
    const slv_surface_arrays arrays = {.positions = work->positions[0]};
    result = slv_surface_evaluate(s->surface, (size_t)count * EACH, work->points, &arrays);
    for (uint32_t i = 0; i < count && !result; i++) {
        float sum[4] = {0}, rgba[4];
        for (uint32_t k = 0; k < EACH; k++) {
            slvi_pattern_evaluate(&s->pattern, (int32_t)face, work->positions[i * EACH + k], rgba);
            for (int c = 0; c < 4; c++)
                sum[c] += rgba[c] * (c < 3 && n == 4 ? rgba[3] : 1);
        }
        for (uint32_t c = 0; c < n; c++)
            values[i * n + c] = sum[c] / EACH;
        for (uint32_t c = 0; n == 4 && c < 3 && sum[3] > 0; c++)
            values[i * n + c] = sum[c] / sum[3];
    }
    slvi_free(work);
    return result;
}

static slv_result evaluate(const slv_bake_source *source, const slv_env *env, uint32_t face,
                           slv_res res, slv_rect rect, float *values, uint8_t *misses) {
    const pattern_source *s = (const pattern_source *)source;
    uint32_t n = s->base.desc.nchannels;
    slv_result result = SLV_OK;
    for (uint32_t y = 0; y < rect.height && !result; y++)
        for (uint32_t x = 0; x < rect.width && !result; x += AT_ONCE) {
            slv_rect part = {rect.x + x, rect.y + y, rect.width - x, 1};
            part.width = part.width < AT_ONCE ? part.width : AT_ONCE;
            result =
                evaluate_some(s, env, face, res, part, values + ((size_t)y * rect.width + x) * n);
        }
    for (size_t i = 0; i < (size_t)rect.width * rect.height && !result; i++)
        for (uint32_t c = 0; c < n; c++)
            if (!isfinite(values[i * n + c])) {
                memset(values + i * n, 0, n * sizeof *values);
                misses[i] = SLV_BAKE_NAN;
            }
    return result;
}

static void destroy(slv_bake_source *source) {
    slvi_free(source);
}

slv_result slv_bake_from_pattern(const slv_env *env, const slv_surface *surface,
                                 const slv_procedural *pattern, slv_bake_source **out) {
    static const slvi_bake_fns fns = {evaluate, NULL, NULL, destroy};
    pattern_source *s = NULL;
    *out = NULL;
    slv_result result = slvi_alloc(env, "bake: pattern", 1, sizeof *s, &s);
    if (result)
        return result;
    s->surface = surface;
    s->pattern = slvi_pattern_resolve(pattern);
    bool alpha = s->pattern.color0[3] != 1 || s->pattern.color1[3] != 1;
    s->base = (slv_bake_source){
        .fns = &fns,
        .nfaces = slv_surface_face_count(surface),
        .desc = {SLV_TYPE_U8, alpha ? 4 : 3, alpha ? 3 : SLV_NO_ALPHA, SLV_TEXTURE_SRGB}};
    if (s->pattern.pattern == SLV_PATTERN_POSITION)
        s->base.desc = (slv_bake_source_desc){SLV_TYPE_FLOAT, 3, SLV_NO_ALPHA, SLV_TEXTURE_LINEAR};
    *out = &s->base;
    return SLV_OK;
}
