/* The points of one face: where the limit is, how a displacement moves them, and which way the
 * surface faces then. */
#include "mesh/face_grid.h"

#include "base/memory.h"

#include <string.h>

slv_result slvi_face_grid_make(const slv_env *env, uint64_t points, bool displaced,
                               slvi_face_grid *out) {
    float **lists[] = {
        &out->limit.positions, &out->limit.normals, &out->limit.du, &out->limit.dv, &out->uv,
        &out->values,          &out->offsets,       &out->facing,   &out->middles,  &out->along};
    slv_result result = SLV_OK;
    memset(out, 0, sizeof *out);
    for (size_t i = 0; i < (displaced ? sizeof lists / sizeof *lists : 2) && !result; i++)
        result = slvi_alloc(env, "tessellation", points * 3, sizeof(float), lists[i]);
    return result;
}

void slvi_face_grid_free(slvi_face_grid *grid) {
    float *lists[] = {
        grid->limit.positions, grid->limit.normals, grid->limit.du, grid->limit.dv, grid->uv,
        grid->values,          grid->offsets,       grid->facing,   grid->middles,  grid->along};
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

/* A face's values on the way to its normals: of its points, and of those in the middle between two
 * along an axis, row by row. */
typedef struct slopes {
    slv_displacement_space space;
    size_t width; /* floats a value */
    uint32_t n;
    const slvi_face_grid *grid;
} slopes;

/* How fast the moved surface goes along an axis at a vertex, in units of the face's side: the
 * limit, the change of the value over half a segment on both sides, and that of the frame in which
 * it moves from one neighbour to the other. `step` is how far apart vertices are along the axis,
 * `i` where this one is among them, `middle` the value behind it. */
static void slope(const slopes *s, size_t vertex, uint32_t i, size_t step, const float *limit,
                  const float *middle, size_t back, float out[3]) {
    const slv_surface_arrays *l = &s->grid->limit;
    const float *value = s->grid->values + s->width * vertex;
    const float *before = i > 0 ? middle - back : value, *after = i < s->n ? middle : value;
    const float ends = i > 0 && i < s->n ? 1 : 2, most = (float)s->n;
    const size_t left = 3 * (i > 0 ? vertex - step : vertex),
                 right = 3 * (i < s->n ? vertex + step : vertex), at = 3 * vertex;
    float change[3] = {0, 0, 0}, moved[3], from[3], to[3];
    for (size_t c = 0; c < s->width; c++)
        change[c] = (after[c] - before[c]) * most * ends;
    make_offset(s->space, change, l->normals + at, l->du + at, moved);
    make_offset(s->space, value, l->normals + left, l->du + left, from);
    make_offset(s->space, value, l->normals + right, l->du + right, to);
    for (size_t c = 0; c < 3; c++)
        out[c] = limit[at + c] + moved[c] + (to[c] - from[c]) * most * ends / 2;
}

/* The values in the middle of segments along u, or v. */
static slv_result look_between(const slvi_grid_job *job, uint32_t face, uint32_t n, bool along_v,
                               float spacing, slvi_face_grid *grid) {
    const slv_displacement *d = job->displacement;
    uint32_t row = along_v ? n + 1 : n, count = n * (n + 1);
    for (uint32_t i = 0; i < count; i++) {
        const float x = (float)(i % row) / (float)n, y = (float)(i / row) / (float)n,
                    half = 0.5f / (float)n;
        grid->uv[2 * i] = along_v ? x : x + half;
        grid->uv[2 * i + 1] = along_v ? y + half : y;
    }
    return d->evaluate(d->user, (int32_t)face, spacing, count, grid->uv, grid->middles);
}

static slv_result displace(const slvi_grid_job *job, uint32_t face, uint32_t n,
                           slvi_face_grid *grid) {
    const slv_displacement *d = job->displacement;
    const slv_surface_arrays *limit = &grid->limit;
    const slopes s = {d->space, d->space ? 3 : 1, n, grid};
    uint32_t side = n + 1, count = side * side;
    float spacing = job->spacing ? job->spacing[face] : 1 / (float)n;
    for (uint32_t i = 0; i < count; i++) {
        grid->uv[2 * i] = (float)(i % side) / (float)n;
        grid->uv[2 * i + 1] = (float)(i / side) / (float)n;
    }
    slv_result result = d->evaluate(d->user, (int32_t)face, spacing, count, grid->uv, grid->values);
    if (result || (result = look_between(job, face, n, false, spacing, grid)))
        return result;
    for (uint32_t i = 0; i < count; i++) {
        make_offset(d->space, grid->values + s.width * i, limit->normals + 3 * (size_t)i,
                    limit->du + 3 * (size_t)i, grid->offsets + 3 * (size_t)i);
        slope(&s, i, i % side, 1, limit->du,
              grid->middles + s.width * ((size_t)(i / side) * n + i % side), s.width,
              grid->along + 3 * (size_t)i);
    }
    if ((result = look_between(job, face, n, true, spacing, grid)))
        return result;
    for (uint32_t i = 0; i < count; i++) {
        size_t at = 3 * (size_t)i;
        float along_v[3], normal[3];
        slope(&s, i, i / side, side, limit->dv, grid->middles + s.width * (size_t)i, s.width * side,
              along_v);
        cross(grid->along + at, along_v, normal);
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

slv_result slvi_face_grids_evaluate(const slvi_grid_job *job, uint32_t unit, uint32_t n,
                                    slvi_face_grid grids[SLVI_UNIT_FACES]) {
    slv_surface_arrays limits[SLVI_UNIT_FACES];
    int32_t faces[SLVI_UNIT_FACES];
    uint32_t count = slvi_surface_unit(job->surface, unit, faces);
    for (uint32_t k = 0; k < count; k++)
        limits[k] = grids[k].limit;
    slv_result result = slvi_surface_evaluate_unit(job->surface, unit, n, limits);
    for (uint32_t k = 0; k < count && job->displacement && !result; k++)
        result = displace(job, (uint32_t)faces[k], n, &grids[k]);
    return result;
}
