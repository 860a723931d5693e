/* What samples on edges lose against the texels that they were made of. */
#include "form/edge_aligned/edge_aligned_data.h"

#include "base/memory.h"
#include "form/resample_error.h"

#include <math.h>
#include <string.h>

/* Memory for the largest face of a range. */
typedef struct scratch {
    float *samples, *bordered, *texels, *back;
    double *rows[2];
} scratch;

static void scratch_free(scratch *s) {
    slvi_free(s->samples);
    slvi_free(s->bordered);
    slvi_free(s->texels);
    slvi_free(s->back);
    slvi_free(s->rows[0]);
    slvi_free(s->rows[1]);
}

static slv_result scratch_create(const slv_env *env, const slv_texture_desc *desc, uint64_t first,
                                 uint64_t end, scratch *out) {
    uint64_t bordered = 0, row = 0;
    slv_result result;
    for (uint64_t face = first; face < end; face++) {
        uint64_t width = UINT64_C(1) << desc->res[face].u, height = UINT64_C(1)
                                                                    << desc->res[face].v;
        uint64_t count = (width + 2) * (height + 2) * desc->nchannels;
        bordered = count > bordered ? count : bordered;
        count = (2 * width + 1) * desc->nchannels;
        row = count > row ? count : row;
    }
    memset(out, 0, sizeof *out);
    if ((result = slvi_alloc(env, "samples", bordered, sizeof(float), &out->samples)) ||
        (result = slvi_alloc(env, "border", bordered, sizeof(float), &out->bordered)) ||
        (result = slvi_alloc(env, "texels", bordered, sizeof(float), &out->texels)) ||
        (result = slvi_alloc(env, "texels", bordered, sizeof(float), &out->back)) ||
        (result = slvi_alloc(env, "row", row, sizeof(double), &out->rows[0])) ||
        (result = slvi_alloc(env, "row", row, sizeof(double), &out->rows[1])))
        scratch_free(out);
    return result;
}

/* Which two entries of a row meet at half texel i: of samples, which stand at even ones, or of
 * bordered texels, which stand at odd ones. */
static void halves(size_t i, bool texels, size_t at[2]) {
    size_t shifted = i + (texels ? 1 : 0);
    at[0] = shifted / 2;
    at[1] = (shifted + 1) / 2;
}

/* The difference of the two functions along row j of half texels. */
static void difference_row(const scratch *s, size_t width, size_t j, size_t n, double *out) {
    size_t sample_y[2], texel_y[2];
    halves(j, false, sample_y);
    halves(j, true, texel_y);
    for (size_t i = 0; i <= 2 * width; i++) {
        size_t sample_x[2], texel_x[2];
        halves(i, false, sample_x);
        halves(i, true, texel_x);
        for (size_t c = 0; c < n; c++, out++) {
            *out = 0;
            for (unsigned k = 0; k < 4; k++)
                *out +=
                    (double)s->samples[(sample_y[k / 2] * (width + 1) + sample_x[k % 2]) * n + c] -
                    (double)s->bordered[(texel_y[k / 2] * (width + 2) + texel_x[k % 2]) * n + c];
            *out *= 0.25;
        }
    }
}

/* Both functions are bilinear on every quarter of a texel, and so is their difference: it is
 * integrated exactly, and has its maximum at a corner of a quarter. */
static void function_error(scratch *s, slv_res res, size_t n, slv_face_error *out) {
    size_t width = (size_t)1 << res.u, height = (size_t)1 << res.v, length = (2 * width + 1) * n;
    for (size_t j = 0; j <= 2 * height; j++) {
        const double *low = s->rows[(j + 1) % 2];
        double *high = s->rows[j % 2];
        difference_row(s, width, j, n, high);
        for (size_t i = 0; i < length; i++)
            out->function_max = fmax(out->function_max, fabs(high[i]));
        for (size_t i = 0; j && i < length - n; i++) {
            double a = low[i], b = low[i + n], d = high[i], e = high[i + n];
            out->function_sum +=
                (2 * (a * a + b * b + d * d + e * e + a * b + d * e + a * d + b * e) + a * e +
                 b * d) /
                72;
        }
    }
}

static slv_result measure_faces(void *user, uint64_t first, uint64_t end) {
    const slv_resample_measure *measure = user;
    const slv_texture_desc *desc = &measure->levels->desc;
    scratch s;
    slv_result result = scratch_create(&measure->env, desc, first, end, &s);
    if (result)
        return result;
    for (uint32_t face = (uint32_t)first; face < end; face++) {
        slv_face_error *error = &measure->faces[face];
        size_t n = desc->nchannels, count = slv_res_texels(desc->res[face]) * n;
        slv_type_to_float(desc->type, slv_levels_texels(measure->levels, face, 0), count, s.texels);
        if ((result = slv_edge_aligned_centred(measure->resampled, face, 0, s.back)) ||
            (result = slv_border_build(measure->levels, measure->adjacency, face, 0, 1, 1,
                                       s.bordered, NULL)))
            break;
        slv_type_to_float(desc->type, slv_edge_aligned_samples(measure->resampled, face, 0),
                          (size_t)slv_edge_aligned_floats(desc, face), s.samples);
        for (size_t i = 0; i < count; i++) {
            double lost = fabs((double)s.back[i] - (double)s.texels[i]);
            error->texel_sum += lost * lost;
            error->texel_max = fmax(error->texel_max, lost);
        }
        function_error(&s, desc->res[face], n, error);
    }
    scratch_free(&s);
    return result;
}

slv_result slv_edge_aligned_measure(const slv_env *env, const slv_edge_aligned *aligned,
                                    const slv_levels *levels, const slv_adjacency *adjacency,
                                    slv_edge_aligned_error *out) {
    slv_resample_measure measure = {.resampled = aligned, .levels = levels, .adjacency = adjacency};
    slv_face_error sum;
    slv_result result = slvi_resample_measure_all(env, &measure, slv_edge_aligned_get_desc(aligned),
                                                  "edge-aligned: it was", measure_faces, &sum);
    if (!result)
        *out = (slv_edge_aligned_error){.round_trip_rms = sum.texel_sum,
                                        .round_trip_max = sum.texel_max,
                                        .function_rms = sum.function_sum,
                                        .function_max = sum.function_max};
    return result;
}
