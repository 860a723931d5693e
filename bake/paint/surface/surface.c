/* The surface that is painted on: a tessellation whose grids are sewn together along shared edges.
 */
#include "surface/surface_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <string.h>

/* From here on the sum of the angles around a vertex counts as more than the plane has. */
#define BENT_ANGLE 0.05

/* While it is made. */
typedef struct sewing {
    slv_paint_surface *s;
    const slv_tessellation *grids;
    uint32_t *root; /* per vertex of the grids: towards the vertex that stands for it */
} sewing;

static uint32_t find_root(uint32_t *root, uint32_t i) {
    while (root[i] != i)
        i = root[i] = root[root[i]];
    return i;
}

static void join(uint32_t *root, uint32_t a, uint32_t b) {
    a = find_root(root, a);
    b = find_root(root, b);
    root[a > b ? a : b] = a > b ? b : a;
}

static uint32_t grid_vertex(const sewing *w, uint32_t face, unsigned edge, uint32_t j) {
    int32_t x, y, side = w->s->segments[face] + 1;
    slvi_edge_texel(side, side, edge, (int32_t)j, 0, &x, &y);
    return w->grids->first[face] + (uint32_t)y * (uint32_t)side + (uint32_t)x;
}

static uint32_t edge_cell(const slv_paint_surface *s, uint32_t face, unsigned edge, uint32_t j) {
    int32_t x, y, side = s->segments[face];
    slvi_edge_texel(side, side, edge, (int32_t)j, 0, &x, &y);
    return s->first[face] + (uint32_t)y * (uint32_t)side + (uint32_t)x;
}

/* Sews the cells along an edge to those beyond it. */
static void sew_edge(sewing *w, uint32_t face, unsigned edge) {
    slv_paint_surface *s = w->s;
    slv_neighbour list[2];
    uint32_t count = slv_adjacency_neighbours(s->adjacency, (int32_t)face, edge, list);
    uint32_t n = s->segments[face];
    for (uint32_t k = 0; k < count; k++) {
        uint32_t to = (uint32_t)list[k].face, m = s->segments[to];
        uint32_t begin = (uint32_t)lroundf(list[k].t0 * (float)n),
                 end = (uint32_t)lroundf(list[k].t1 * (float)n);
        for (uint32_t j = begin; m && j < end; j++) {
            float u, v;
            slvi_edge_point(edge, ((float)j + 0.5f) / (float)n, &u, &v);
            slv_affine_apply(&list[k].map, u, v, &u, &v);
            float t = slvi_edge_t(list[k].edge, u, v) * (float)m;
            if (!(t > 0 && t < (float)m))
                continue;
            uint32_t i = (uint32_t)t;
            s->cells[edge_cell(s, face, edge, j)].across[edge] =
                4 * edge_cell(s, to, list[k].edge, i) + list[k].edge;
            join(w->root, grid_vertex(w, face, edge, j), grid_vertex(w, to, list[k].edge, i + 1));
            join(w->root, grid_vertex(w, face, edge, j + 1), grid_vertex(w, to, list[k].edge, i));
        }
    }
}

static void fill_face(sewing *w, uint32_t face) {
    slv_paint_surface *s = w->s;
    uint32_t n = s->segments[face];
    for (uint32_t y = 0; y < n; y++)
        for (uint32_t x = 0; x < n; x++) {
            uint32_t cell = s->first[face] + y * n + x;
            uint32_t v = w->grids->first[face] + y * (n + 1) + x;
            const uint32_t at[4] = {v, v + 1, v + n + 2, v + n + 1};
            const uint32_t beyond[4] = {
                y ? 4 * (cell - n) + 2 : SLVI_NONE, x + 1 < n ? 4 * (cell + 1) + 3 : SLVI_NONE,
                y + 1 < n ? 4 * (cell + n) : SLVI_NONE, x ? 4 * (cell - 1) + 1 : SLVI_NONE};
            memcpy(s->cells[cell].corners, at, sizeof at);
            memcpy(s->cells[cell].across, beyond, sizeof beyond);
            s->cells[cell].face = face;
        }
}

/* Gives the vertices that stand for others their numbers, and puts them into the cells. */
static slv_result number_vertices(sewing *w) {
    slv_paint_surface *s = w->s;
    uint32_t total = w->grids->first[s->nfaces], count = 0;
    for (uint32_t i = 0; i < total; i++)
        w->root[i] = find_root(w->root, i);
    for (uint32_t i = 0; i < total; i++)
        count += w->root[i] == i;
    s->nverts = count;
    slv_result result =
        slvi_alloc(&s->env, "paint surface", 3 * (uint64_t)count, sizeof(float), &s->positions);
    if (result)
        return result;
    count = 0;
    /* a root comes before those that it stands for */
    for (uint32_t i = 0; i < total; i++) {
        if (w->root[i] == i) {
            memcpy(s->positions + 3 * (size_t)count, w->grids->vertices[i].position,
                   3 * sizeof(float));
            w->root[i] = count++;
        } else {
            w->root[i] = w->root[w->root[i]];
        }
    }
    for (uint32_t cell = 0; cell < s->ncells; cell++)
        for (unsigned k = 0; k < 4; k++)
            s->cells[cell].corners[k] = w->root[s->cells[cell].corners[k]];
    return SLV_OK;
}

static double angle_at(const slv_paint_surface *s, uint32_t tri, unsigned k) {
    const float *p = slvi_tri_point(s, tri, k), *q = slvi_tri_point(s, tri, (k + 1) % 3),
                *r = slvi_tri_point(s, tri, (k + 2) % 3);
    double a[3], b[3], c[3];
    for (int i = 0; i < 3; i++) {
        a[i] = (double)q[i] - (double)p[i];
        b[i] = (double)r[i] - (double)p[i];
    }
    slvi_cross(a, b, c);
    return atan2(sqrt(slvi_dot(c, c)), slvi_dot(a, b));
}

/* Vertices around which there is more angle than in the plane, or than beside a straight boundary:
 * what a straight line that passes them on one side reaches, none on the other does. */
static slv_result find_bent(slv_paint_surface *s) {
    double *angle = NULL;
    slv_result result = slvi_alloc(&s->env, "paint surface", s->nverts, sizeof *angle, &angle);
    if (!result)
        result = slvi_alloc(&s->env, "paint surface", s->nverts, 1, &s->bent);
    for (uint32_t tri = 0; !result && tri < 2 * s->ncells; tri++)
        for (unsigned k = 0; k < 3; k++) {
            uint32_t to, v = slvi_tri_vertex(s, tri, k);
            unsigned edge;
            angle[v] += angle_at(s, tri, k);
            if (!slvi_tri_across(s, tri, k, &to, &edge))
                s->bent[v] = s->bent[slvi_tri_vertex(s, tri, (k + 1) % 3)] = 1;
        }
    for (uint32_t v = 0; !result && v < s->nverts; v++)
        s->bent[v] = angle[v] > (s->bent[v] ? 1 : 2) * 3.14159265358979 + BENT_ANGLE;
    slvi_free(angle);
    return result;
}

static void measure_cell(slv_paint_surface *s, uint32_t cell) {
    const uint32_t *c = s->cells[cell].corners;
    for (unsigned k = 0; k < 5; k++)
        s->cells[cell].lengths[k] =
            (float)slvi_distance(s->positions + 3 * (size_t)c[k & 3],
                                 s->positions + 3 * (size_t)c[k < 4 ? slvi_edge_next(k) : 2]);
}

static void measure(slv_paint_surface *s, uint32_t face) {
    double u = 0, v = 0, area = 0, n = s->segments[face];
    for (uint32_t cell = s->first[face]; cell < s->first[face + 1]; cell++) {
        const float *p[4];
        for (unsigned k = 0; k < 4; k++)
            p[k] = s->positions + 3 * (size_t)s->cells[cell].corners[k];
        u += slvi_distance(p[0], p[1]) + slvi_distance(p[3], p[2]);
        v += slvi_distance(p[0], p[3]) + slvi_distance(p[1], p[2]);
        for (unsigned half = 0; half < 2; half++) {
            double a[3], b[3], c[3];
            for (int k = 0; k < 3; k++) {
                a[k] = (double)p[half + 1][k] - (double)p[0][k];
                b[k] = (double)p[half + 2][k] - (double)p[0][k];
            }
            slvi_cross(a, b, c);
            area += 0.5 * sqrt(slvi_dot(c, c));
        }
    }
    if (n > 0) {
        s->sides[3 * (size_t)face] = (float)(u / (2 * n));
        s->sides[3 * (size_t)face + 1] = (float)(v / (2 * n));
        s->sides[3 * (size_t)face + 2] = (float)area;
    }
}

static slv_result sew(slv_paint_surface *s, const slv_tessellation *grids) {
    sewing w = {.s = s, .grids = grids};
    uint32_t total = grids->first[s->nfaces];
    uint64_t cells = 0;
    slv_result result;
    for (uint32_t face = 0; face < s->nfaces; face++)
        cells += (uint64_t)grids->segments[face] * grids->segments[face];
    if (cells > UINT32_MAX / 4 - 1)
        return slvi_fail(&s->env, SLV_ERROR_LIMIT,
                         "paint surface: %llu cells are too many: fewer segments would do",
                         (unsigned long long)cells);
    s->ncells = (uint32_t)cells;
    if ((result = slvi_alloc(&s->env, "paint surface", (uint64_t)s->nfaces + 1, 4, &s->first)) ||
        (result = slvi_alloc(&s->env, "paint surface", cells, sizeof *s->cells, &s->cells)) ||
        (result = slvi_alloc(&s->env, "paint surface", s->nfaces, 1, &s->segments)) ||
        (result = slvi_alloc(&s->env, "paint surface", s->nfaces, 3 * sizeof(float), &s->sides)) ||
        (result = slvi_alloc(&s->env, "paint surface", total, 4, &w.root)))
        return result;
    for (uint32_t i = 0; i < total; i++)
        w.root[i] = i;
    for (uint32_t face = 0; face < s->nfaces; face++) {
        s->segments[face] = grids->segments[face];
        s->first[face + 1] =
            s->first[face] + (uint32_t)grids->segments[face] * grids->segments[face];
    }
    for (uint32_t face = 0; face < s->nfaces; face++)
        fill_face(&w, face);
    for (uint32_t face = 0; face < s->nfaces; face++)
        for (unsigned edge = 0; s->segments[face] && edge < 4; edge++)
            sew_edge(&w, face, edge);
    result = number_vertices(&w);
    slvi_free(w.root);
    for (uint32_t cell = 0; !result && cell < s->ncells; cell++)
        measure_cell(s, cell);
    for (uint32_t face = 0; !result && face < s->nfaces; face++)
        measure(s, face);
    return result ? result : find_bent(s);
}

static uint32_t choose_segments(uint32_t nfaces) {
    return nfaces <= 4096 ? 8 : nfaces <= 65536 ? 4 : 2;
}

static slv_result make(slv_paint_surface *s, const slv_mesh *mesh,
                       const slv_paint_surface_params *params) {
    slv_surface_params how = {.scheme = params->scheme, .boundary = params->boundary};
    slv_surface *surface = NULL;
    slv_tessellation grids = {0};
    slv_result result;
    s->nfaces = slv_mesh_face_count(mesh);
    const slv_tessellation_params tessellation = {
        .segments = params->segments ? params->segments : choose_segments(s->nfaces),
        .displacement = params->displacement};
    if (!(result = slv_mesh_adjacency(&s->env, mesh, &s->adjacency)) &&
        !(result = slv_surface_create(&s->env, mesh, &how, &surface)) &&
        !(result =
              slv_tessellate_with(&s->env, mesh, surface, s->adjacency, &tessellation, &grids))) {
        memcpy(s->low, grids.bounds_min, sizeof s->low);
        memcpy(s->high, grids.bounds_max, sizeof s->high);
        result = sew(s, &grids);
    }
    slv_surface_destroy(surface);
    slv_tessellation_free(&grids);
    return result ? result : slvi_rays_create(s, &s->rays);
}

slv_result slv_paint_surface_create(const slv_env *env, const slv_mesh *mesh,
                                    const slv_paint_surface_params *params,
                                    slv_paint_surface **out) {
    const slv_paint_surface_params none = {0};
    slv_paint_surface *s = NULL;
    slv_env budget = slvi_budget_begin(env);
    *out = NULL;
    slv_result result = slvi_alloc(&budget, "paint surface", 1, sizeof *s, &s);
    if (!result) {
        s->env = budget;
        result = make(s, mesh, params ? params : &none);
        s->env = slvi_env_or_default(env);
    }
    if (slvi_budget_end(&budget, result)) {
        slv_paint_surface_destroy(s);
        return result;
    }
    *out = s;
    return SLV_OK;
}

void slv_paint_surface_destroy(slv_paint_surface *s) {
    if (!s)
        return;
    slvi_rays_destroy(s->rays);
    slv_adjacency_destroy(s->adjacency);
    slvi_free(s->first);
    slvi_free(s->segments);
    slvi_free(s->sides);
    slvi_free(s->positions);
    slvi_free(s->bent);
    slvi_free(s->cells);
    slvi_free(s);
}
