/* Which vertices lie at one place and can be one: all but those that would make an edge of more
 * than two sides, or of two that run the same way. */
#include "mesh/wrap/weld.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

/* Of the longest side of the box: what sines and cosines of a whole turn are off by in single
 * precision, what numbers with six digits behind the point are in small meshes, and what is still
 * looked at, to be named. */
#define NEAR 4.8e-7
#define ROUNDED 1e-5
#define CLOSE 1e-3
#define EXACT 1e-12 /* less than any two floats are apart */
/* Of the edges at a vertex: no more than that is rounding. */
#define OF_EDGE 0.02
#define OF_EDGE_CLOSE 0.1

/* The first vertices of places, by a hash of cells of grids. Vertices that reach about as far as
 * each other share a grid, whose cells are few of their edges wide: so that one holds few of them,
 * whatever else there is in the mesh. */
typedef struct places {
    const float *positions, *reach;
    double low[3], step; /* step: what vertices of grid 0 reach at most */
    uint32_t ngrids;
    uint64_t mask;
    int32_t *table; /* -1: empty */
} places;

enum { GRIDS = 16, GROWTH = 8, WIDTH = 4 }; /* EXACT to CLOSE in few steps; of cells */

static uint64_t slot_of(const places *p, uint32_t grid, const double cell[3]) {
    uint64_t hash = grid;
    for (int c = 0; c < 3; c++)
        hash = (hash ^ (uint64_t)(int64_t)cell[c]) * UINT64_C(0x9E3779B97F4A7C15) + 1;
    return (hash ^ hash >> 29) & p->mask;
}

/* The first of the vertices near a point that hash to a cell, or -1. */
static int32_t find_in(const places *p, int32_t vertex, uint64_t slot) {
    const float *at = p->positions + 3 * (size_t)vertex;
    int32_t first = -1;
    for (uint64_t s = slot; p->table[s] >= 0; s = (s + 1) & p->mask) {
        const float *other = p->positions + 3 * (size_t)p->table[s];
        double near = (double)fminf(p->reach[vertex], p->reach[p->table[s]]);
        bool same = true;
        for (int c = 0; c < 3; c++)
            same &= fabs((double)at[c] - (double)other[c]) <= near;
        if (same && (first < 0 || p->table[s] < first))
            first = p->table[s];
    }
    return first;
}

/* The first vertex at a place; `vertex` itself, which is then remembered, if it is. */
static int32_t find_root(places *p, int32_t vertex) {
    const float *at = p->positions + 3 * (size_t)vertex;
    const double reach = (double)p->reach[vertex];
    double low[3], high[3], cell[3], step = p->step;
    uint64_t own = 0;
    int32_t first = -1;
    bool placed = false;
    for (uint32_t grid = 0; grid < p->ngrids; grid++, step *= GROWTH) {
        double most = fmin(reach, step);
        for (int c = 0; c < 3; c++) {
            low[c] = floor(((double)at[c] - p->low[c] - most) / (WIDTH * step));
            high[c] = floor(((double)at[c] - p->low[c] + most) / (WIDTH * step));
        }
        for (cell[2] = low[2]; cell[2] <= high[2]; cell[2]++)
            for (cell[1] = low[1]; cell[1] <= high[1]; cell[1]++)
                for (cell[0] = low[0]; cell[0] <= high[0]; cell[0]++) {
                    int32_t found = find_in(p, vertex, slot_of(p, grid, cell));
                    first = found >= 0 && (first < 0 || found < first) ? found : first;
                }
        if (placed || (reach > step && grid + 1 < p->ngrids))
            continue;
        placed = true;
        for (int c = 0; c < 3; c++)
            cell[c] = floor(((double)at[c] - p->low[c]) / (WIDTH * step));
        own = slot_of(p, grid, cell);
    }
    if (first >= 0)
        return first;
    while (p->table[own] >= 0)
        own = (own + 1) & p->mask;
    return p->table[own] = vertex;
}

static double extent_of(const slv_mesh_view *view, double corner[3]) {
    double extent = 0;
    for (int c = 0; c < 3; c++) {
        double low = INFINITY, high = -INFINITY;
        for (uint32_t v = 0; v < view->nverts; v++) {
            double x = (double)view->positions[3 * (size_t)v + (size_t)c];
            low = fmin(low, x);
            high = fmax(high, x);
        }
        corner[c] = low;
        extent = view->nverts ? fmax(extent, high - low) : 0;
    }
    return extent;
}

/* Per vertex the first one within the reach of both. */
static slv_result find_roots(const slv_env *env, const slv_mesh_view *view, const float *reach,
                             int32_t *root) {
    places p = {.positions = view->positions, .reach = reach, .mask = 1};
    double extent = extent_of(view, p.low), least = INFINITY, most = 0;
    for (uint32_t v = 0; v < view->nverts; v++) {
        least = fmin(least, (double)reach[v]);
        most = fmax(most, (double)reach[v]);
    }
    p.step = extent > 0 ? fmax(least, extent * EXACT) : 1;
    for (double step = p.step; p.ngrids < GRIDS && (!p.ngrids || step < GROWTH * most);
         step *= GROWTH)
        p.ngrids++;
    while (p.mask < 2 * (uint64_t)view->nverts)
        p.mask = 2 * p.mask + 1;
    slv_result result = slvi_alloc_plain(env, "vertices", p.mask + 1, sizeof *p.table, &p.table);
    if (result)
        return result;
    memset(p.table, 0xff, (size_t)(p.mask + 1) * sizeof *p.table);
    for (uint32_t v = 0; v < view->nverts; v++)
        root[v] = find_root(&p, (int32_t)v);
    slvi_free(p.table);
    return SLV_OK;
}

/* How far a vertex may be from another to be `one` with it, and to be `close`. At open edges, where
 * the copies are of a map that ends, that is as far as rounded numbers make it, if edges are much
 * longer; elsewhere what arithmetic makes of one place. */
static slv_result find_reach(const slv_env *env, const slv_mesh *mesh, float *one, float *close) {
    const slv_mesh_view *view = &mesh->view;
    double corner[3];
    const double extent = extent_of(view, corner);
    float *shortest = NULL;
    uint8_t *open = NULL;
    slv_mesh_edges edges = {0};
    slv_result result;
    if ((result = slvi_alloc(env, "vertices", view->nverts, sizeof *shortest, &shortest)) ||
        (result = slvi_alloc(env, "vertices", view->nverts, 1, &open)) ||
        (result = slvi_mesh_edges_create(env, mesh, &edges)))
        goto done;
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t i = 0; i < edges.count; i++) {
            const slv_mesh_edge *edge = &edges.edges[i];
            const int32_t ends[2] = {edge->v0, edge->v1};
            const float *a = view->positions + 3 * (size_t)edge->v0,
                        *b = view->positions + 3 * (size_t)edge->v1;
            float length = hypotf(hypotf(b[0] - a[0], b[1] - a[1]), b[2] - a[2]);
            for (int k = 0; k < 2; k++) {
                float *shorter = &shortest[ends[k]], *longest = &close[ends[k]];
                open[ends[k]] |= edge->count == 1;
                if (!pass)
                    *longest = fmaxf(*longest, length);
                else if (length > one[ends[k]])
                    *shorter = fminf(*shorter, length);
            }
        }
        for (uint32_t v = 0; v < view->nverts && !pass; v++) {
            shortest[v] = close[v];
            one[v] = (float)fmax(extent * EXACT, fmin(extent * NEAR, (double)close[v] * OF_EDGE));
        }
    }
    for (uint32_t v = 0; v < view->nverts; v++) {
        double edge = (double)shortest[v];
        if (open[v])
            one[v] = fmaxf(one[v], (float)fmin(extent * ROUNDED, edge * OF_EDGE));
        close[v] =
            open[v] ? fmaxf(one[v], (float)fmin(extent * CLOSE, edge * OF_EDGE_CLOSE)) : one[v];
    }
done:
    slvi_mesh_edges_clear(&edges);
    slvi_free(shortest);
    slvi_free(open);
    return result;
}

/* Per vertex the first one at its place; those that are beside others are counted, unless both have
 * found their copies: thin bodies have sides that are near each other. */
static slv_result find_places(const slv_env *env, const slv_mesh *mesh, int32_t *root,
                              slv_wrap_report *report) {
    const slv_mesh_view *view = &mesh->view;
    float *one = NULL, *close = NULL;
    int32_t *beside = NULL;
    uint8_t *joined = NULL;
    slv_result result;
    if ((result = slvi_alloc(env, "vertices", view->nverts, sizeof *one, &one)) ||
        (result = slvi_alloc(env, "vertices", view->nverts, 1, &joined)) ||
        (result = slvi_alloc(env, "vertices", view->nverts, sizeof *close, &close)) ||
        (result = slvi_alloc(env, "vertices", view->nverts, sizeof *beside, &beside)) ||
        (result = find_reach(env, mesh, one, close)) ||
        (result = find_roots(env, view, one, root)) ||
        (result = find_roots(env, view, close, beside)))
        goto done;
    for (uint32_t v = 0; v < view->nverts; v++)
        joined[root[v]] |= root[v] != (int32_t)v;
    for (uint32_t v = 0; v < view->nverts; v++) {
        int32_t other = beside[v];
        if (root[v] != (int32_t)v || other == (int32_t)v || root[other] == (int32_t)v ||
            (joined[v] && joined[root[other]]))
            continue;
        if (report->nclose++)
            continue;
        const float *a = view->positions + 3 * (size_t)v, *b = view->positions + 3 * (size_t)other;
        report->first_close = (int32_t)v;
        report->close_to = other;
        report->close_apart = hypotf(hypotf(b[0] - a[0], b[1] - a[1]), b[2] - a[2]);
    }
done:
    slvi_free(one);
    slvi_free(close);
    slvi_free(beside);
    slvi_free(joined);
    return result;
}

/* The polygons with `root` in place of vertices, of vertices that follow each other only one. */
static void list_polygons(const slv_mesh *mesh, const int32_t *root, slvi_weld *w,
                          slv_wrap_report *report) {
    const slv_mesh_view *view = &mesh->view;
    w->npolys = w->nsides = 0;
    report->ncollapsed = 0;
    report->first_collapsed = -1;
    for (uint32_t p = 0; p < view->npolys; p++) {
        uint32_t first = mesh->poly_first[p], size = (uint32_t)view->poly_sizes[p],
                 begin = w->nsides;
        w->poly[p] = (int32_t)w->npolys;
        for (uint32_t k = 0; k < size; k++) {
            int32_t own = view->poly_verts[first + k],
                    next = view->poly_verts[first + (k + 1) % size];
            /* who names a vertex twice has meant it */
            if (root[own] == root[next] && own != next)
                continue;
            w->verts[w->nsides] = root[own];
            w->side[w->nsides++] = first + k;
        }
        if (w->nsides - begin >= 3) {
            w->sizes[w->npolys++] = (int32_t)(w->nsides - begin);
            continue;
        }
        w->nsides = begin;
        if (!report->ncollapsed++)
            report->first_collapsed = (int32_t)p;
    }
}

/* Separates the vertices at the ends of edges that cannot be. False if there are none. */
static slv_result separate(const slv_env *env, const slv_mesh *mesh, const slvi_weld *w,
                           uint8_t *apart, const uint8_t *shared, bool *changed) {
    const slv_mesh_view view = {.nverts = mesh->view.nverts,
                                .positions = mesh->view.positions,
                                .npolys = w->npolys,
                                .poly_sizes = w->sizes,
                                .poly_verts = w->verts};
    slv_mesh *joined = NULL;
    slv_mesh_edges edges = {0};
    slv_result result = slv_mesh_create(env, &view, &joined);
    *changed = false;
    if (!result && !(result = slvi_mesh_edges_create(env, joined, &edges)))
        for (uint32_t i = 0; i < edges.count; i++) {
            const slv_mesh_edge *edge = &edges.edges[i];
            const int32_t ends[2] = {edge->v0, edge->v1};
            if (edge->count < 2 || (edge->count == 2 && !slvi_mesh_edge_is_flipped(joined, edge)))
                continue;
            for (int k = 0; k < 2; k++)
                if (shared[ends[k]] && !apart[ends[k]])
                    apart[ends[k]] = *changed = true;
        }
    slvi_mesh_edges_clear(&edges);
    slv_mesh_destroy(joined);
    return result;
}

/* Numbers the vertices that are left. */
static void number(const slv_mesh_view *view, const int32_t *root, slvi_weld *w) {
    for (uint32_t v = 0; v < view->nverts; v++)
        if (root[v] == (int32_t)v) {
            w->from[w->nverts] = (int32_t)v;
            w->to[v] = (int32_t)w->nverts++;
        }
    for (uint32_t v = 0; v < view->nverts; v++)
        w->to[v] = w->to[root[v]];
    for (uint32_t s = 0; s < w->nsides; s++)
        w->verts[s] = w->to[w->verts[s]];
}

static slv_result join(const slv_env *env, const slv_mesh *mesh, bool wanted,
                       slv_wrap_report *report, slvi_weld *w) {
    const slv_mesh_view *view = &mesh->view;
    int32_t *root = NULL, *first = NULL;
    uint8_t *apart = NULL, *shared = NULL;
    bool changed = wanted;
    slv_result result;
    if ((result = slvi_alloc(env, "vertices", view->nverts, sizeof *root, &root)) ||
        (result = slvi_alloc(env, "vertices", view->nverts, sizeof *first, &first)) ||
        (result = slvi_alloc(env, "vertices", view->nverts, 1, &apart)) ||
        (result = slvi_alloc(env, "vertices", view->nverts, 1, &shared)) ||
        (wanted && (result = find_places(env, mesh, first, report))))
        goto done;
    for (uint32_t v = 0; v < view->nverts; v++) {
        first[v] = wanted ? first[v] : (int32_t)v;
        shared[first[v]] |= first[v] != (int32_t)v;
    }
    do {
        report->nkept = 0;
        report->first_kept = -1;
        for (uint32_t v = 0; v < view->nverts; v++) {
            bool keeps = !wanted || apart[first[v]];
            root[v] = keeps ? (int32_t)v : first[v];
            if (wanted && keeps && first[v] != (int32_t)v && !report->nkept++)
                report->first_kept = (int32_t)v;
        }
        list_polygons(mesh, root, w, report);
    } while (changed && !(result = separate(env, mesh, w, apart, shared, &changed)) && changed);
    if (!result)
        number(view, root, w);
done:
    slvi_free(root);
    slvi_free(first);
    slvi_free(apart);
    slvi_free(shared);
    return result;
}

slv_result slvi_weld_make(const slv_env *env, const slv_mesh *mesh, bool wanted,
                          slv_wrap_report *report, slvi_weld *out) {
    const slv_mesh_view *view = &mesh->view;
    uint64_t nsides = mesh->poly_first[view->npolys];
    slv_result result;
    *out = (slvi_weld){0};
    report->first_close = -1;
    if ((result = slvi_alloc(env, "vertices", view->nverts, sizeof *out->to, &out->to)) ||
        (result = slvi_alloc(env, "vertices", view->nverts, sizeof *out->from, &out->from)) ||
        (result = slvi_alloc(env, "polygons", view->npolys, sizeof *out->poly, &out->poly)) ||
        (result = slvi_alloc(env, "polygons", view->npolys, sizeof *out->sizes, &out->sizes)) ||
        (result = slvi_alloc(env, "polygons", nsides, sizeof *out->verts, &out->verts)) ||
        (result = slvi_alloc(env, "polygons", nsides, sizeof *out->side, &out->side)) ||
        (result = join(env, mesh, wanted, report, out)))
        slvi_weld_free(out);
    report->nverts = out->nverts;
    report->nwelded = view->nverts - out->nverts;
    return result;
}

void slvi_weld_free(slvi_weld *weld) {
    slvi_free(weld->to);
    slvi_free(weld->from);
    slvi_free(weld->poly);
    slvi_free(weld->sizes);
    slvi_free(weld->verts);
    slvi_free(weld->side);
    *weld = (slvi_weld){0};
}
