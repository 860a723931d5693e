/* A pattern in space as a source: the mean over a grid of samples on the limit surface, which is
 * flat enough within a texel for places in it to follow from its corners. */
#include "procedural/pattern.h"
#include "source/source.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

enum { SIDE = 2, EACH = SIDE * SIDE, AT_ONCE = 1024 }; /* samples a texel; texels of a row */

typedef struct pattern_source {
    slv_bake_source base;
    const slv_surface *surface;
    slv_procedural pattern;
} pattern_source;

/* Positions of the corners of a row of texels: two rows, of which the upper becomes the lower. */
typedef struct corners {
    slv_surface_point points[AT_ONCE + 1];
    float positions[2][AT_ONCE + 1][3];
    float at[3][AT_ONCE], values[AT_ONCE], sums[AT_ONCE]; /* of samples at one place of a texel */
} corners;

static slv_result find_row(const pattern_source *s, uint32_t face, slv_res res, uint32_t x,
                           uint32_t y, uint32_t width, corners *c, uint32_t row) {
    for (uint32_t i = 0; i <= width; i++)
        c->points[i] = (slv_surface_point){(int32_t)face, (float)(x + i) / (float)(1u << res.u),
                                           (float)y / (float)(1u << res.v)};
    const slv_surface_arrays arrays = {.positions = c->positions[row][0]};
    return slv_surface_evaluate(s->surface, width + 1, c->points, &arrays);
}

static void texel_mean(const pattern_source *s, uint32_t face, const corners *c, uint32_t i,
                       uint32_t lower, float *out) {
    uint32_t n = s->base.desc.nchannels;
    const float(*low)[3] = c->positions[lower] + i, (*high)[3] = c->positions[!lower] + i;
    float sum[4] = {0}, rgba[4], at[3];
    for (uint32_t k = 0; k < EACH; k++) {
        float u = ((float)(k % SIDE) + 0.5f) / SIDE, v = ((float)(k / SIDE) + 0.5f) / SIDE;
        for (int axis = 0; axis < 3; axis++) {
            float below = low[0][axis] + (low[1][axis] - low[0][axis]) * u;
            float above = high[0][axis] + (high[1][axis] - high[0][axis]) * u;
            at[axis] = below + (above - below) * v;
        }
        slvi_pattern_evaluate(&s->pattern, (int32_t)face, at, rgba);
        for (int channel = 0; channel < 4; channel++)
            sum[channel] += rgba[channel] * (channel < 3 && n == 4 ? rgba[3] : 1);
    }
    for (uint32_t channel = 0; channel < n; channel++)
        out[channel] = sum[channel] / EACH;
    for (uint32_t channel = 0; n == 4 && channel < 3 && sum[3] > 0; channel++)
        out[channel] = sum[channel] / sum[3];
}

/* Whether colours are linear in one value, so that the mean of these is enough. */
static bool is_linear(const pattern_source *s) {
    slv_pattern pattern = s->pattern.pattern;
    return s->base.desc.nchannels < 4 && pattern != SLV_PATTERN_FACE_COLOR &&
           pattern != SLV_PATTERN_POSITION;
}

/* A row of texels of such a pattern: all samples of one of the SIDE x SIDE places at a time. */
static void linear_row(const pattern_source *s, uint32_t face, corners *c, uint32_t width,
                       uint32_t lower, float *out) {
    static const float unused[3];
    uint32_t n = s->base.desc.nchannels;
    float *const at[3] = {c->at[0], c->at[1], c->at[2]}, rgba[4];
    memset(c->sums, 0, width * sizeof *c->sums);
    for (uint32_t k = 0; k < EACH; k++) {
        float u = ((float)(k % SIDE) + 0.5f) / SIDE, v = ((float)(k / SIDE) + 0.5f) / SIDE;
        for (uint32_t i = 0; i < width; i++) {
            float(*low)[3] = c->positions[lower] + i, (*high)[3] = c->positions[!lower] + i;
            for (int axis = 0; axis < 3; axis++) {
                float below = low[0][axis] + (low[1][axis] - low[0][axis]) * u;
                float above = high[0][axis] + (high[1][axis] - high[0][axis]) * u;
                c->at[axis][i] = below + (above - below) * v;
            }
        }
        slvi_pattern_values(&s->pattern, width, at, c->values);
        for (uint32_t i = 0; i < width; i++)
            c->sums[i] += c->values[i];
    }
    for (uint32_t i = 0; i < width; i++, out += n) {
        slvi_pattern_color(&s->pattern, (int32_t)face, unused, c->sums[i] / EACH, rgba);
        memcpy(out, rgba, n * sizeof *out);
    }
}

static slv_result evaluate(const slv_bake_source *source, const slv_env *env, uint32_t face,
                           slv_res res, slv_rect rect, float *values, uint8_t *misses) {
    const pattern_source *s = (const pattern_source *)source;
    uint32_t n = s->base.desc.nchannels;
    corners *c = NULL;
    slv_result result = slvi_alloc_plain(env, "bake: samples", 1, sizeof *c, &c);
    for (uint32_t x = 0; x < rect.width && !result; x += AT_ONCE) {
        uint32_t width = rect.width - x < AT_ONCE ? rect.width - x : AT_ONCE, lower = 0;
        result = find_row(s, face, res, rect.x + x, rect.y, width, c, lower);
        for (uint32_t y = 0; y < rect.height && !result; y++, lower = !lower) {
            result = find_row(s, face, res, rect.x + x, rect.y + y + 1, width, c, !lower);
            float *row = values + ((size_t)y * rect.width + x) * n;
            if (!result && is_linear(s))
                linear_row(s, face, c, width, lower, row);
            for (uint32_t i = 0; i < width && !result && !is_linear(s); i++)
                texel_mean(s, face, c, i, lower, row + (size_t)i * n);
        }
    }
    slvi_free(c);
    for (size_t i = 0; i < (size_t)rect.width * rect.height && !result; i++)
        for (uint32_t channel = 0; channel < n; channel++)
            if (!isfinite(values[i * n + channel])) {
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
    static const slvi_bake_fns fns = {evaluate, NULL, NULL, destroy, NULL};
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
        .apart = s->pattern.pattern == SLV_PATTERN_FACE_COLOR || s->pattern.face_tint != 0,
        .desc = {SLV_TYPE_U8, alpha ? 4 : 3, alpha ? 3 : SLV_NO_ALPHA, SLV_TEXTURE_SRGB}};
    if (s->pattern.pattern == SLV_PATTERN_POSITION)
        s->base.desc = (slv_bake_source_desc){SLV_TYPE_FLOAT, 3, SLV_NO_ALPHA, SLV_TEXTURE_LINEAR};
    *out = &s->base;
    return SLV_OK;
}
