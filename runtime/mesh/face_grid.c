/* The points of one face: where the limit is, how a displacement moves them, and which way the
 * surface faces then. */
#include "mesh/face_grid.h"

#include "base/memory.h"

#include <string.h>

slv_result slvi_face_grid_make(const slv_env *env, uint64_t points, bool displaced,
                               slvi_face_grid *out) {
    float **lists[] = {
        &out->limit.positions, &out->limit.normals, &out->limit.du, &out->limit.dv, &out->uv,
        &out->values,          &out->offsets,       &out->facing};
    slv_result result = SLV_OK;
    memset(out, 0, sizeof *out);
    for (size_t i = 0; i < (displaced ? sizeof lists / sizeof *lists : 2) && !result; i++)
        result = slvi_alloc(env, "tessellation", points * 3, sizeof(float), lists[i]);
    return result;
}

void slvi_face_grid_free(slvi_face_grid *grid) {
    float *lists[] = {
        grid->limit.positions, grid->limit.normals, grid->limit.du, grid->limit.dv, grid->uv,
        grid->values,          grid->offsets,       grid->facing};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        slvi_free(lists[i]);
}

static void cross(const float a[3], const float b[3], float out[3]) {
    for (int c = 0; c < 3; c++)
        out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

/* The offset of a point in space. */
static void make_offset(slv_displacement_space space, const float *value, const float normal[3],
                        const float du[3], float out[3]) {
    float along[3] = {0, 0, 0}, across[3];
    switch (space) {
    case SLV_DISPLACE_OBJECT:
        memcpy(out, value, 3 * sizeof *out);
        return;
    case SLV_DISPLACE_TANGENT:
        (void)slvi_normalise(du, along); /* nothing moves along what has no direction */
        cross(normal, along, across);
        for (int c = 0; c < 3; c++)
            out[c] = value[0] * along[c] + value[1] * across[c] + value[2] * normal[c];
        return;
    case SLV_DISPLACE_NORMAL:
        for (int c = 0; c < 3; c++)
            out[c] = value[0] * normal[c];
    }
}

/* The change of the offsets from one end of a face to the other, along the axis on which
 * neighbouring points are `step` vertices apart, at point `i` of 0..n. */
static void slope(const float *offset, uint32_t i, uint32_t n, ptrdiff_t step, float out[3]) {
    const float *before = i > 0 ? offset - 3 * step : offset;
    const float *after = i < n ? offset + 3 * step : offset;
    float segments = (float)n / (i > 0 && i < n ? 2.0f : 1.0f);
    for (int c = 0; c < 3; c++)
        out[c] = (after[c] - before[c]) * segments;
}

static slv_result displace(const slvi_grid_job *job, uint32_t face, uint32_t n,
                           slvi_face_grid *grid) {
    const slv_displacement *d = job->displacement;
    const slv_surface_arrays *limit = &grid->limit;
    uint32_t side = n + 1, count = side * side;
    size_t width = d->space ? 3 : 1;
    float spacing = job->spacing ? job->spacing[face] : 1 / (float)n;
    for (uint32_t i = 0; i < count; i++) {
        grid->uv[2 * i] = (float)(i % side) / (float)n;
        grid->uv[2 * i + 1] = (float)(i / side) / (float)n;
    }
    slv_result result = d->evaluate(d->user, (int32_t)face, spacing, count, grid->uv, grid->values);
    if (result)
        return result;
    for (size_t i = 0; i < count; i++)
        make_offset(d->space, grid->values + width * i, limit->normals + 3 * i, limit->du + 3 * i,
                    grid->offsets + 3 * i);
    for (uint32_t i = 0; i < count; i++) {
        size_t at = 3 * (size_t)i;
        float along_u[3], along_v[3], normal[3];
        slope(grid->offsets + at, i % side, n, 1, along_u);
        slope(grid->offsets + at, i / side, n, side, along_v);
        for (size_t c = 0; c < 3; c++) {
            along_u[c] += limit->du[at + c];
            along_v[c] += limit->dv[at + c];
        }
        cross(along_u, along_v, normal);
        if (!slvi_normalise(normal, grid->facing + at))
            memcpy(grid->facing + at, limit->normals + at, sizeof normal);
    }
    return SLV_OK;
}

slv_result slvi_face_grid_evaluate(const slvi_grid_job *job, uint32_t face, uint32_t n,
                                   slvi_face_grid *grid) {
    slv_result result = slv_surface_evaluate_grid(job->surface, (int32_t)face, n, n, &grid->limit);
    return result || !job->displacement ? result : displace(job, face, n, grid);
}
