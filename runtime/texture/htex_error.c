#include "texture/htex.h"

#include "base/log.h"

#include <math.h>
#include <stdlib.h>

/* Points of a texel, of the face's or a square's: a lattice that has each coordinate once, for the
 * texels of squares lie at halves of the face's. */
enum { POINTS = 16, LATTICE_STEP = 7 };

/* Sums over one face; added up in the order of faces, so that threads do not matter. */
typedef struct face_error {
    double texel_sum, function_sum; /* of squares */
    double texel_max, function_max;
} face_error;

struct measure {
    const slv_htex *htex;
    const slv_levels *levels;
    const slv_adjacency *adjacency;
    slv_env env;
    face_error *faces;
};

/* Adds the difference at (u,v); `values` has room for both. */
static void add_point(const struct measure *measure, const slv_htex_source *source, uint32_t face,
                      float u, float v, float *values, double *sum, double *most) {
    size_t n = source->nchannels;
    slv_htex_lookup(measure->htex, face, u, v, 0, values);
    slv_htex_source_at(source, u, v, values + n);
    for (size_t c = 0; c < n; c++) {
        double lost = fabs((double)values[c] - (double)values[c + n]);
        *sum += lost * lost;
        *most = fmax(*most, lost);
    }
}

static void measure_face(const struct measure *measure, const slv_htex_source *source,
                         uint32_t face, float *values) {
    face_error *error = &measure->faces[face];
    const slv_htex_face *row = &measure->htex->faces[face];
    uint32_t width = 1u << source->res.u, height = 1u << source->res.v, finest = 1;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            add_point(measure, source, face, ((float)x + 0.5f) / (float)width,
                      ((float)y + 0.5f) / (float)height, values, &error->texel_sum,
                      &error->texel_max);
    for (uint32_t k = 0; k < 4; k++)
        if ((!row->part || k == 1 || k == 2) && 1u << measure->htex->log2[row->edge[k]] > finest)
            finest = 1u << measure->htex->log2[row->edge[k]];
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
    const struct measure *measure = user;
    const slv_texture_desc *desc = &measure->htex->desc;
    uint64_t texels = 0;
    float *bordered = NULL, *values = NULL;
    slv_result result;
    for (uint64_t face = first; face < end; face++) {
        uint64_t count =
            ((UINT64_C(1) << desc->res[face].u) + 2) * ((UINT64_C(1) << desc->res[face].v) + 2);
        texels = count > texels ? count : texels;
    }
    if ((result = slv_alloc(&measure->env, "border", texels * desc->nchannels, sizeof *bordered,
                            &bordered)) ||
        (result = slv_alloc(&measure->env, "values", 2 * (uint64_t)desc->nchannels, sizeof *values,
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
    free(bordered);
    free(values);
    return result;
}

slv_result slv_htex_measure(const slv_env *env, const slv_htex *htex, const slv_levels *levels,
                            const slv_adjacency *adjacency, slv_htex_error *out) {
    const slv_texture_desc *desc = &levels->desc;
    struct measure measure = {.htex = htex, .levels = levels, .adjacency = adjacency};
    slv_parallel_log *log = NULL;
    face_error sum = {0};
    double count = 0;
    slv_result result;
    if (!slv_texture_desc_same(desc, &htex->desc) || slv_adjacency_face_count(adjacency) != desc->nfaces)
        return slv_fail(env, SLV_ERROR_MISMATCH,
                        "half-edges: they were not made from these levels and this adjacency");
    if ((result = slv_parallel_env_begin(env, &log, &measure.env)))
        return result;
    if ((result = slv_alloc(&measure.env, "errors of faces", desc->nfaces, sizeof *measure.faces,
                            &measure.faces)) ||
        (result = slv_parallel_for(&measure.env, desc->nfaces, 16, measure_faces, &measure)))
        goto done;
    for (uint32_t face = 0; face < desc->nfaces; face++) {
        const face_error *from = &measure.faces[face];
        sum.texel_sum += from->texel_sum;
        sum.function_sum += from->function_sum;
        sum.texel_max = fmax(sum.texel_max, from->texel_max);
        sum.function_max = fmax(sum.function_max, from->function_max);
        count += (double)slv_res_texels(desc->res[face]) * desc->nchannels;
    }
    count = count > 0 ? count : 1;
    *out = (slv_htex_error){sqrt(sum.texel_sum / count), sum.texel_max,
                            sqrt(sum.function_sum / count), sum.function_max};
done:
    free(measure.faces);
    slv_parallel_env_end(log);
    return result;
}
