/* What squares of edges lose against the texels that they were made of. */
#include "form/htex/htex_data.h"

#include "base/memory.h"
#include "form/resample_error.h"

#include <math.h>

/* Points of a texel, of the face's or a square's: a lattice that has each coordinate once, for the
 * texels of squares lie at halves of the face's. */
enum { POINTS = 16, LATTICE_STEP = 7 };

/* Adds the difference at (u,v); `values` has room for both. */
static void add_point(const slv_resample_measure *measure, const slv_htex_source *source,
                      uint32_t face, float u, float v, float *values, double *sum, double *most) {
    size_t n = source->nchannels;
    slv_htex_lookup(measure->resampled, face, u, v, 0, values);
    slvi_htex_source_at(source, u, v, values + n);
    for (size_t c = 0; c < n; c++) {
        double lost = fabs((double)values[c] - (double)values[c + n]);
        *sum += lost * lost;
        *most = fmax(*most, lost);
    }
}

static void measure_face(const slv_resample_measure *measure, const slv_htex_source *source,
                         uint32_t face, float *values) {
    slv_face_error *error = &measure->faces[face];
    const slv_htex *htex = measure->resampled;
    const slv_htex_face *row = &htex->faces[face];
    uint32_t width = 1u << source->res.u, height = 1u << source->res.v, finest = 1;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            add_point(measure, source, face, ((float)x + 0.5f) / (float)width,
                      ((float)y + 0.5f) / (float)height, values, &error->texel_sum,
                      &error->texel_max);
    for (uint32_t k = 0; k < 4; k++)
        if ((!row->part || k == 1 || k == 2) && 1u << htex->log2[row->edge[k]] > finest)
            finest = 1u << htex->log2[row->edge[k]];
    uint32_t across = width > finest ? width : finest, up = height > finest ? height : finest;
    for (uint32_t y = 0; y < up; y++) {
        for (uint32_t i = 0; i < POINTS * across; i++) {
            uint32_t turn = i * LATTICE_STEP % POINTS;
            add_point(measure, source, face, ((float)i + 0.5f) / (float)(POINTS * across),
                      ((float)y + ((float)turn + 0.5f) / POINTS) / (float)up, values,
                      &error->function_sum, &error->function_max);
        }
    }
    error->function_sum *= (double)width / across * height / up / POINTS;
}

static slv_result measure_faces(void *user, uint64_t first, uint64_t end) {
    const slv_resample_measure *measure = user;
    const slv_texture_desc *desc = &measure->levels->desc;
    uint64_t texels = 0;
    float *bordered = NULL, *values = NULL;
    slv_result result;
    for (uint64_t face = first; face < end; face++) {
        uint64_t count =
            ((UINT64_C(1) << desc->res[face].u) + 2) * ((UINT64_C(1) << desc->res[face].v) + 2);
        texels = count > texels ? count : texels;
    }
    if ((result = slvi_alloc(&measure->env, "border", texels * desc->nchannels, sizeof *bordered,
                             &bordered)) ||
        (result = slvi_alloc(&measure->env, "values", 2 * (uint64_t)desc->nchannels, sizeof *values,
                             &values)))
        goto done;
    for (uint32_t face = (uint32_t)first; face < end; face++) {
        slv_htex_source source = {desc->res[face], desc->nchannels, bordered};
        if ((result = slv_border_build(measure->levels, measure->adjacency, face, 0, 1, 1, bordered,
                                       NULL)))
            goto done;
        measure_face(measure, &source, face, values);
    }
done:
    slvi_free(bordered);
    slvi_free(values);
    return result;
}

slv_result slv_htex_measure(const slv_env *env, const slv_htex *htex, const slv_levels *levels,
                            const slv_adjacency *adjacency, slv_htex_error *out) {
    slv_resample_measure measure = {.resampled = htex, .levels = levels, .adjacency = adjacency};
    slv_face_error sum;
    slv_result result = slvi_resample_measure_all(env, &measure, &htex->desc,
                                                  "half-edges: they were", measure_faces, &sum);
    if (!result)
        *out = (slv_htex_error){.texel_rms = sum.texel_sum,
                                .texel_max = sum.texel_max,
                                .function_rms = sum.function_sum,
                                .function_max = sum.function_max};
    return result;
}
