/* Grids of vertices on the limit surface, welded where faces meet. */
#include "mesh/cluster.h"
#include "mesh/displace.h"
#include "mesh/rates.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <selvage/half.h>

#include <math.h>
#include <string.h>

static float longest_edge_in_pixels(const slv_mesh_view *mesh, const slv_camera *camera,
                                    uint32_t width, uint32_t height) {
    const float *m = camera->world_to_camera;
    float scale_x = (float)width / (camera->window[1] - camera->window[0]);
    float scale_y = (float)height / (camera->window[3] - camera->window[2]);
    float longest = 0;
    const int32_t *verts = mesh->poly_verts;
    for (uint32_t p = 0; p < mesh->npolys; verts += mesh->poly_sizes[p++]) {
        float first[2] = {0}, before[2] = {0};
        bool behind = false;
        float here = 0;
        for (int32_t k = 0; k < mesh->poly_sizes[p]; k++) {
            const float *v = mesh->positions + 3 * (size_t)verts[k];
            float eye[3], at[2];
            for (int r = 0; r < 3; r++)
                eye[r] = m[4 * r] * v[0] + m[4 * r + 1] * v[1] + m[4 * r + 2] * v[2] + m[4 * r + 3];
            float depth = camera->perspective ? -eye[2] : 1;
            behind |= depth <= 1e-6f;
            at[0] = eye[0] / depth * scale_x;
            at[1] = eye[1] / depth * scale_y;
            if (k == 0)
                memcpy(first, at, sizeof first);
            else
                here = fmaxf(here, hypotf(at[0] - before[0], at[1] - before[1]));
            memcpy(before, at, sizeof before);
        }
        here = fmaxf(here, hypotf(first[0] - before[0], first[1] - before[1]));
        /* an edge seen from next to it is as long as the picture at most */
        here = behind || here > (float)(width + height) ? (float)(width + height) : here;
        longest = fmaxf(longest, here);
    }
    return longest;
}

uint32_t slv_tessellation_for(const slv_mesh *mesh, const slv_camera *camera, uint32_t width,
                              uint32_t height) {
    float wanted = longest_edge_in_pixels(slv_mesh_get_view(mesh), camera, width, height) / 3;
    uint64_t nfaces = slv_mesh_face_count(mesh), most = 2 * (uint64_t)width * height;
    uint32_t segments = 2;
    while (segments < 64 && (float)segments < wanted &&
           nfaces * segments * 2 * segments * 2 <= most)
        segments *= 2;
    return segments;
}

static void put_vertices(const slvi_grid_job *job, uint32_t face, const slv_surface_arrays *limit) {
    const slv_tessellation *out = job->out;
    const uint32_t n = out->segments[face];
    slv_vertex *vertex = out->vertices + out->first[face];
    uint16_t along[129]; /* segments are 128 at most */
    for (uint32_t x = 0; x <= n; x++)
        along[x] = slv_half_from_float((float)x / (float)n);
    for (uint32_t y = 0, i = 0; y <= n; y++)
        for (uint32_t x = 0; x <= n; x++, i++, vertex++) {
            memcpy(vertex->position, limit->positions + 3 * (size_t)i, sizeof vertex->position);
            memcpy(vertex->normal, limit->normals + 3 * (size_t)i, sizeof vertex->normal);
            vertex->uv[0] = along[x];
            vertex->uv[1] = along[y];
            vertex->face = (int32_t)face;
        }
}

/* Faces that are divided differently are evaluated one by one, though they be of one unit. */
static slv_result evaluate_unit(const slvi_grid_job *job, uint32_t unit, slvi_face_grid *grids) {
    const uint16_t *segments = job->out->segments;
    int32_t faces[SLVI_UNIT_FACES];
    uint32_t count = slvi_surface_unit(job->surface, unit, faces), n = segments[faces[0]];
    bool together = n > 0;
    for (uint32_t k = 1; k < count; k++)
        together = together && segments[faces[k]] == n;
    slv_result result = together ? slvi_face_grids_evaluate(job, unit, n, grids) : SLV_OK;
    for (uint32_t k = 0; k < count && !result; k++) {
        const uint32_t face = (uint32_t)faces[k];
        if (!segments[face] ||
            (!together && (result = slvi_face_grid_evaluate(job, face, segments[face], &grids[k]))))
            continue;
        put_vertices(job, face, &grids[k].limit);
        if (job->displacement)
            slvi_displace_face(job, face, &grids[k]);
    }
    return result;
}

static slv_result evaluate(void *user, uint64_t begin, uint64_t end) {
    const slvi_grid_job *job = user;
    slvi_face_grid grids[SLVI_UNIT_FACES] = {0};
    slv_result result = SLV_OK;
    uint64_t most = 1, points;
    uint32_t wide = 1;
    for (uint64_t unit = begin; unit < end; unit++) {
        int32_t faces[SLVI_UNIT_FACES];
        uint32_t count = slvi_surface_unit(job->surface, (uint32_t)unit, faces);
        wide = count > wide ? count : wide;
        for (uint32_t k = 0; k < count; k++)
            most = job->out->segments[faces[k]] > most ? job->out->segments[faces[k]] : most;
    }
    points = (most + 1) * (most + 1);
    for (uint32_t k = 0; k < wide && !result; k++)
        result = slvi_face_grid_make(&job->env, points, job->displacement != NULL, &grids[k]);
    for (uint64_t unit = begin; unit < end && !result; unit++)
        result = evaluate_unit(job, (uint32_t)unit, grids);
    for (uint32_t k = 0; k < wide; k++)
        slvi_face_grid_free(&grids[k]);
    return result;
}

/* Takes the positions along one edge from the face that owns them: the whole quad beside sub-faces,
 * else the lower id. Ends are left to weld_corner. */
static void weld_edge(const slvi_grid_job *job, uint32_t face, unsigned edge) {
    const slv_tessellation *t = job->out;
    slv_neighbour other[2];
    uint32_t n = t->segments[face], shared;
    if (slv_adjacency_neighbours(job->adjacency, (int32_t)face, edge, other) != 1)
        return;
    bool owns = other->scale > 1 || (other->scale == 1 && (int32_t)face <= other->face);
    if (owns || !t->segments[other->face])
        return;
    shared = slvi_edge_segments(job, face, edge);
    for (uint32_t k = n / shared; k < n; k += n / shared) {
        float u, v, ou, ov;
        slvi_edge_point(edge, (float)k / (float)n, &u, &v);
        slv_affine_apply(&other->map, u, v, &ou, &ov);
        memcpy(t->vertices[slvi_vertex_at(t, face, u, v)].position,
               t->vertices[slvi_vertex_at(t, (uint32_t)other->face, ou, ov)].position,
               3 * sizeof(float));
    }
}

static void weld_corner(const slvi_grid_job *job, uint32_t face, unsigned corner) {
    const slv_tessellation *t = job->out;
    uint32_t to = slvi_corner_vertex(t, face, corner), from = to;
    if (slv_adjacency_is_t_corner(job->adjacency, (int32_t)face, corner)) {
        slv_neighbour quad;
        float uv[2];
        if (slvi_t_corner_place(job, face, corner, &quad, uv))
            from = slvi_vertex_at(t, (uint32_t)quad.face, uv[0], uv[1]);
    } else {
        slv_ring ring = slv_adjacency_ring(job->adjacency, (int32_t)face, corner, NULL);
        slv_corner lowest = {(int32_t)face, (uint8_t)corner};
        for (uint32_t i = 0; i < ring.count; i++)
            if (ring.corners[i].face < lowest.face && t->segments[ring.corners[i].face])
                lowest = ring.corners[i];
        from = slvi_corner_vertex(t, (uint32_t)lowest.face, lowest.corner);
    }
    if (from != to)
        memcpy(t->vertices[to].position, t->vertices[from].position, 3 * sizeof(float));
}

/* Every position is read where its owner evaluated it and written elsewhere, so faces can be welded
 * in any order. */
static slv_result weld(void *user, uint64_t begin, uint64_t end) {
    const slvi_grid_job *job = user;
    for (uint64_t face = begin; face < end; face++) {
        if (!job->out->segments[face])
            continue;
        for (unsigned e = 0; e < 4; e++) {
            weld_edge(job, (uint32_t)face, e);
            weld_corner(job, (uint32_t)face, e);
        }
    }
    return SLV_OK;
}

/* The vertex of an edge that is drawn for the point k of n on it. */
static uint32_t snapped(uint32_t k, uint32_t n, uint32_t shared) {
    uint32_t step = n / shared;
    return (k + step / 2) / step * step;
}

/* What an edge has beyond its own segments goes to the next of its vertices, so that both sides
 * draw the same line. */
static slv_result snap(void *user, uint64_t begin, uint64_t end) {
    const slvi_grid_job *job = user;
    const slv_tessellation *t = job->out;
    for (uint64_t face = begin; face < end; face++) {
        uint32_t n = t->segments[face];
        for (unsigned e = 0; e < 4; e++) {
            uint32_t shared = n ? slvi_edge_segments(job, (uint32_t)face, e) : 0;
            t->edges[4 * face + e] = (uint16_t)shared;
            for (uint32_t k = 1; k < n && shared < n; k++) {
                float u, v, from_u, from_v;
                slvi_edge_point(e, (float)k / (float)n, &u, &v);
                slvi_edge_point(e, (float)snapped(k, n, shared) / (float)n, &from_u, &from_v);
                t->vertices[slvi_vertex_at(t, (uint32_t)face, u, v)] =
                    t->vertices[slvi_vertex_at(t, (uint32_t)face, from_u, from_v)];
            }
        }
    }
    return SLV_OK;
}

static void find_bounds(slv_tessellation *t) {
    for (int c = 0; c < 3; c++) {
        t->bounds_min[c] = INFINITY;
        t->bounds_max[c] = -INFINITY;
    }
    for (uint32_t i = 0; i < t->first[t->nfaces]; i++)
        for (int c = 0; c < 3; c++) { /* fminf would be a call */
            const float at = t->vertices[i].position[c];
            t->bounds_min[c] = at < t->bounds_min[c] ? at : t->bounds_min[c];
            t->bounds_max[c] = at > t->bounds_max[c] ? at : t->bounds_max[c];
        }
}

static slv_result check(const slv_env *env, const slv_mesh *mesh, const slv_surface *surface,
                        const slv_adjacency *adjacency, const slv_tessellation_params *params) {
    uint32_t nfaces = slv_mesh_face_count(mesh), segments = params->segments;
    if (segments && (segments < 2 || segments > 128 || (segments & (segments - 1))))
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "%u segments: a power of two from 2 to 128 is needed", segments);
    if (!segments && !(params->camera && params->width && params->height && params->pixels >= 0))
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "neither segments nor a picture for which faces are tessellated");
    if (slv_surface_face_count(surface) != nfaces || slv_adjacency_face_count(adjacency) != nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "the mesh has %u faces, its surface %u, the adjacency %u", nfaces,
                         slv_surface_face_count(surface), slv_adjacency_face_count(adjacency));
    return SLV_OK;
}

/* Says how many segments each face has. */
static slv_result divide(const slv_env *env, const slv_mesh *mesh, slvi_grid_job *job,
                         const slv_tessellation_params *params) {
    slv_tessellation *made = job->out;
    slv_result result;
    if ((result = slvi_alloc(env, "tessellation", (uint64_t)made->nfaces + 1, sizeof *made->first,
                             &made->first)) ||
        (result = slvi_alloc(env, "tessellation", made->nfaces, sizeof *made->segments,
                             &made->segments)) ||
        (result =
             slvi_alloc(env, "tessellation", made->nfaces, 4 * sizeof *made->edges, &made->edges)))
        return result;
    for (uint32_t f = 0; f < made->nfaces; f++) {
        bool half = slv_adjacency_is_subface(job->adjacency, (int32_t)f);
        uint32_t n = !params->segments ? 1 : half ? params->segments / 2 : params->segments;
        made->segments[f] = (uint16_t)(slv_mesh_face_is_hole(mesh, (int32_t)f) ? 0 : n);
    }
    if (params->segments)
        return SLV_OK;
    if ((result =
             slvi_alloc(env, "tessellation", made->nfaces, sizeof *job->spacing, &job->spacing)))
        return result;
    return slvi_choose_rates(env, job, params);
}

/* Gives each face its place among the vertices. */
static slv_result lay_out(const slv_env *env, slv_tessellation *made) {
    uint64_t count = 0;
    for (uint32_t f = 0; f < made->nfaces; f++) {
        uint32_t n = made->segments[f];
        made->first[f] = (uint32_t)count;
        count += n ? (uint64_t)(n + 1) * (n + 1) : 0;
        if (count > INT32_MAX)
            return slvi_fail(env, SLV_ERROR_LIMIT,
                             "%u faces with %u segments are too many vertices", made->nfaces, n);
    }
    made->first[made->nfaces] = (uint32_t)count;
    return slvi_alloc(env, "vertices", count, sizeof *made->vertices, &made->vertices);
}

static slv_result tessellate(const slv_env *env, const slv_mesh *mesh, const slv_surface *surface,
                             const slv_adjacency *adjacency, const slv_tessellation_params *params,
                             slv_tessellation *out) {
    slv_tessellation made = {.nfaces = slv_mesh_face_count(mesh)};
    slvi_grid_job job = {.surface = surface,
                         .adjacency = adjacency,
                         .displacement = params->displacement,
                         .out = &made};
    slv_parallel_log *log = NULL;
    slv_result result;
    memset(out, 0, sizeof *out);
    if ((result = check(env, mesh, surface, adjacency, params)) ||
        (result = slvi_parallel_env_begin(env, &log, &job.env)) ||
        (result = divide(env, mesh, &job, params)) || (result = lay_out(env, &made)) ||
        (result = job.displacement ? slvi_displace_begin(env, &job) : SLV_OK) ||
        (result = slvi_parallel_for(env, slvi_surface_unit_count(surface), 16, evaluate, &job)) ||
        (result = slvi_parallel_for(env, made.nfaces, 256, weld, &job)) ||
        (result = job.displacement ? slvi_displace_end(env, &job) : SLV_OK) ||
        (result = slvi_parallel_for(env, made.nfaces, 256, snap, &job)) ||
        (result = params->segments ? SLV_OK : slvi_cluster(env, &made, params)))
        goto done;
    find_bounds(&made);
done:
    slvi_parallel_env_end(log);
    slvi_free(job.spacing);
    slvi_free(job.offsets);
    slvi_free(job.facing);
    if (result)
        slv_tessellation_free(&made);
    *out = made;
    return result;
}

slv_result slv_tessellate_with(const slv_env *env, const slv_mesh *mesh, const slv_surface *surface,
                               const slv_adjacency *adjacency,
                               const slv_tessellation_params *params, slv_tessellation *out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, tessellate(&own, mesh, surface, adjacency, params, out));
}

slv_result slv_tessellate(const slv_env *env, const slv_mesh *mesh, const slv_surface *surface,
                          const slv_adjacency *adjacency, uint32_t segments,
                          slv_tessellation *out) {
    const slv_tessellation_params params = {.segments = segments};
    return slv_tessellate_with(env, mesh, surface, adjacency, &params, out);
}

void slv_tessellation_free(slv_tessellation *tessellation) {
    slvi_free(tessellation->vertices);
    slvi_free(tessellation->first);
    slvi_free(tessellation->segments);
    slvi_free(tessellation->edges);
    memset(tessellation, 0, sizeof *tessellation);
}

/* The vertex of a face's grid that is drawn at (x,y). */
static uint32_t drawn(const slv_tessellation *t, uint32_t face, uint32_t x, uint32_t y) {
    const uint16_t *edges = t->edges + 4 * (size_t)face;
    uint32_t n = t->segments[face];
    if (n == 1)
        return t->first[face] + y * 2 + x;
    if (y == 0 || y == n) {
        uint32_t shared = edges[y ? 2 : 0];
        x = y ? n - snapped(n - x, n, shared) : snapped(x, n, shared);
    } else if (x == 0 || x == n) {
        uint32_t shared = edges[x ? 1 : 3];
        y = x ? snapped(y, n, shared) : n - snapped(n - y, n, shared);
    }
    return t->first[face] + y * (n + 1) + x;
}

/* Unless it has no area; returns how many indices that is. */
static uint32_t add_triangle(uint32_t a, uint32_t b, uint32_t c, uint32_t *out) {
    if (a == b || b == c || c == a)
        return 0;
    if (out) {
        out[0] = a;
        out[1] = b;
        out[2] = c;
    }
    return 3;
}

uint32_t slv_tessellation_indices(const slv_tessellation *tessellation, uint32_t face,
                                  uint32_t *out) {
    const uint16_t *edges = tessellation->edges + 4 * (size_t)face;
    uint32_t n = tessellation->segments[face], count = 0;
    /* of two triangles those with a side that is a point are gone */
    const bool lower = n > 1 || (edges[0] && edges[1]), upper = n > 1 || (edges[2] && edges[3]);
    for (uint32_t y = 0; y < n; y++)
        for (uint32_t x = 0; x < n; x++) {
            uint32_t a = drawn(tessellation, face, x, y), b = drawn(tessellation, face, x + 1, y);
            uint32_t c = drawn(tessellation, face, x, y + 1),
                     d = drawn(tessellation, face, x + 1, y + 1);
            if (lower)
                count += add_triangle(a, b, d, out ? out + count : NULL);
            if (upper)
                count += add_triangle(a, d, c, out ? out + count : NULL);
        }
    return count;
}
