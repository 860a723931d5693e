/* A pattern in space as a source: the mean over a grid of samples on the limit surface, which is
 * flat enough within a texel for places in it to follow from its corners. */
#include "procedural/row.h"
#include "source/source.h"

#include "base/memory.h"
#include "base/processor.h"

#include <float.h>
#include <math.h>
#include <string.h>

typedef struct pattern_source {
    slv_bake_source base;
    const slv_surface *surface;
    slv_procedural pattern;
    slvi_octave octaves[SLVI_MAX_OCTAVES];
    slvi_pattern_means *means; /* for this processor */
} pattern_source;

typedef struct pattern_work {
    slv_surface_point points[SLVI_ROW_TEXELS + 1];
    float positions[SLVI_ROW_TEXELS + 1][3];
    slvi_pattern_rows rows;
} pattern_work;

/* The corners below row y of texels. */
static slv_result find_corners(const pattern_source *s, uint32_t face, slv_res res, uint32_t x,
                               uint32_t y, uint32_t width, pattern_work *work, unsigned which) {
    const float du = 1 / (float)(1u << res.u), v = (float)y / (float)(1u << res.v);
    for (uint32_t i = 0; i <= width; i++)
        work->points[i] = (slv_surface_point){(int32_t)face, (float)(x + i) * du, v};
    const slv_surface_arrays arrays = {.positions = work->positions[0]};
    slv_result result = slv_surface_evaluate(s->surface, width + 1, work->points, &arrays);
    for (int axis = 0; axis < 3 && !result; axis++) {
        float *to = work->rows.corners[which][axis];
        for (uint32_t i = 0; i <= width; i++)
            to[i] = slvi_pattern_place(&s->pattern, work->positions[i][axis], axis);
        for (uint32_t i = width + 1; i < width + SLVI_ROW_AT_ONCE; i++)
            to[i] = to[width];
    }
    for (uint32_t i = 0; i < s->pattern.octaves; i++)
        work->rows.has_noise[i][which] = false;
    return result;
}

typedef float four __attribute__((vector_size(16)));

/* Two colours mixed by the value, alpha too: what is multiplied by it has the value's square. */
static void see_through_row(const float dark[4], const float light[4],
                            const slvi_pattern_rows *rows, uint32_t width, float *out) {
    four base = {0, 0, 0, dark[3]}, first = {0, 0, 0, light[3] - dark[3]}, second = {0};
    for (int c = 0; c < 3; c++) {
        base[c] = dark[c] * dark[3];
        first[c] = dark[c] * (light[3] - dark[3]) + (light[c] - dark[c]) * dark[3];
        second[c] = (light[c] - dark[c]) * (light[3] - dark[3]);
    }
    for (uint32_t i = 0; i < width; i++, out += 4) {
        four color = base + first * rows->means[i] + second * rows->squares[i];
        const float alpha = color[3];
        if (alpha > 0)
            color /= (four){alpha, alpha, alpha, 1};
        else
            for (int c = 0; c < 3; c++)
                color[c] = SLVI_MIX(dark[c], light[c], rows->means[i]);
        memcpy(out, &color, sizeof color);
    }
}

static void mixed_row(const pattern_source *s, uint32_t face, slvi_pattern_rows *rows,
                      uint32_t width, unsigned lower, float *out) {
    static const float unused[3];
    const uint32_t n = s->base.desc.nchannels;
    float dark[4], light[4];
    slvi_pattern_color(&s->pattern, (int32_t)face, unused, 0, dark);
    slvi_pattern_color(&s->pattern, (int32_t)face, unused, 1, light);
    s->means(&s->pattern, s->octaves, rows, lower, width);
    if (n == 4) {
        see_through_row(dark, light, rows, width, out);
        return;
    }
    for (uint32_t i = 0; i < width; i++, out += n)
        for (uint32_t c = 0; c < n; c++)
            out[c] = SLVI_MIX(dark[c], light[c], rows->means[i]);
}

/* Places are their own colours. */
static void position_row(const pattern_source *s, uint32_t face, const slvi_pattern_rows *rows,
                         uint32_t width, unsigned lower, float *out) {
    static const float nowhere[3];
    float tint[4];
    slvi_pattern_color(&s->pattern, (int32_t)face, nowhere, 0, tint);
    for (int axis = 0; axis < 3; axis++) {
        const float *low = rows->corners[lower][axis], *high = rows->corners[!lower][axis];
        for (uint32_t i = 0; i < width; i++) {
            const float mean = 0.25f * ((low[i] + low[i + 1]) + (high[i] + high[i + 1]));
            out[(size_t)i * 3 + (size_t)axis] = mean * (1 - s->pattern.face_tint) + tint[axis];
        }
    }
}

/* One colour all over. */
static void face_color(const pattern_source *s, uint32_t face, size_t count, float *values) {
    static const float unused[3];
    const uint32_t n = s->base.desc.nchannels;
    float rgba[4];
    slvi_pattern_color(&s->pattern, (int32_t)face, unused, 0, rgba);
    for (size_t i = 0; i < count; i++)
        memcpy(values + i * n, rgba, n * sizeof *rgba);
}

static void find_senseless(uint32_t n, size_t count, float *values, uint8_t *misses) {
    bool all = true;
    for (size_t i = 0; i < count * n; i++)
        all &= fabsf(values[i]) <= FLT_MAX;
    for (size_t i = 0; i < count && !all; i++)
        for (uint32_t c = 0; c < n; c++)
            if (!isfinite(values[i * n + c])) {
                memset(values + i * n, 0, n * sizeof *values);
                misses[i] = SLV_BAKE_NAN;
            }
}

static slv_result evaluate(const slv_bake_source *source, const slv_env *env, uint32_t face,
                           slv_res res, slv_rect rect, float *values, uint8_t *misses) {
    const pattern_source *s = (const pattern_source *)source;
    uint32_t n = s->base.desc.nchannels;
    pattern_work *work = NULL;
    if (s->pattern.pattern == SLV_PATTERN_FACE_COLOR) {
        face_color(s, face, (size_t)rect.width * rect.height, values);
        return SLV_OK;
    }
    slv_result result = slvi_alloc_plain(env, "bake: samples", 1, sizeof *work, &work);
    for (uint32_t x = 0; x < rect.width && !result; x += SLVI_ROW_TEXELS) {
        uint32_t width = rect.width - x < SLVI_ROW_TEXELS ? rect.width - x : SLVI_ROW_TEXELS;
        unsigned lower = 0;
        result = find_corners(s, face, res, rect.x + x, rect.y, width, work, lower);
        for (uint32_t y = 0; y < rect.height && !result; y++, lower = !lower) {
            result = find_corners(s, face, res, rect.x + x, rect.y + y + 1, width, work, !lower);
            float *row = values + ((size_t)y * rect.width + x) * n;
            if (!result && s->pattern.pattern == SLV_PATTERN_POSITION)
                position_row(s, face, &work->rows, width, lower, row);
            else if (!result)
                mixed_row(s, face, &work->rows, width, lower, row);
        }
    }
    slvi_free(work);
    if (!result)
        find_senseless(n, (size_t)rect.width * rect.height, values, misses);
    return result;
}

static void destroy(slv_bake_source *source) {
    slvi_free(source);
}

static slvi_pattern_means *best_means(void) {
#define KIND_OR(KIND) slvi_has_##KIND() ? slvi_pattern_means_##KIND:
    return SLVI_ROW_PROCESSORS(KIND_OR) NULL;
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
    for (uint32_t i = 0; i < s->pattern.octaves; i++)
        s->octaves[i] = slvi_pattern_octave(s->pattern.seed, i);
    s->means = best_means();
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
