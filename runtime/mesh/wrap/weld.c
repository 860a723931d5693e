/* Which vertices lie at one place and can be one: all but those that would make an edge of more
 * than two sides, or of two that run the same way. */
#include "mesh/wrap/weld.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

/* Of the longest side of the box: more than what sines and cosines of a whole turn are off by in
 * single precision. */
#define NEAR 4.8e-7

/* The first vertices of places, in cells of a grid that is coarser than what is near, by a hash. */
typedef struct places {
    const float *positions;
    double low[3], near, cell;
    uint64_t mask;
    int32_t *table; /* -1: empty */
} places;

static uint64_t slot_of(const places *p, const double cell[3]) {
    uint64_t hash = 0;
    for (int c = 0; c < 3; c++)
        hash = (hash ^ (uint64_t)(int64_t)cell[c]) * UINT64_C(0x9E3779B97F4A7C15) + 1;
    return (hash ^ hash >> 29) & p->mask;
}

/* The first of the vertices near a point that hash to a cell, or -1. */
static int32_t find_in(const places *p, const float *at, const double cell[3]) {
    int32_t first = -1;
    for (uint64_t s = slot_of(p, cell); p->table[s] >= 0; s = (s + 1) & p->mask) {
        const float *other = p->positions + 3 * (size_t)p->table[s];
        bool same = true;
        for (int c = 0; c < 3; c++)
            same &= fabs((double)at[c] - (double)other[c]) <= p->near;
        if (same && (first < 0 || p->table[s] < first))
            first = p->table[s];
    }
    return first;
}

/* The first vertex at a place; `vertex` itself, which is then remembered, if it is. */
static int32_t find_root(places *p, int32_t vertex) {
    const float *at = p->positions + 3 * (size_t)vertex;
    double low[3], high[3], cell[3];
    int32_t first = -1;
    for (int c = 0; c < 3; c++) {
        low[c] = floor(((double)at[c] - p->low[c] - p->near) / p->cell);
        high[c] = floor(((double)at[c] - p->low[c] + p->near) / p->cell);
    }
    for (cell[2] = low[2]; cell[2] <= high[2]; cell[2]++)
        for (cell[1] = low[1]; cell[1] <= high[1]; cell[1]++)
            for (cell[0] = low[0]; cell[0] <= high[0]; cell[0]++) {
                int32_t found = find_in(p, at, cell);
                first = found >= 0 && (first < 0 || found < first) ? found : first;
            }
    if (first >= 0)
        return first;
    for (int c = 0; c < 3; c++)
        cell[c] = floor(((double)at[c] - p->low[c]) / p->cell);
    uint64_t s = slot_of(p, cell);
    while (p->table[s] >= 0)
        s = (s + 1) & p->mask;
    return p->table[s] = vertex;
}

/* Per vertex the first one at its place. */
static slv_result find_roots(const slv_env *env, const slv_mesh_view *view, int32_t *root) {
    places p = {.positions = view->positions, .mask = 1};
    double extent = 0;
    for (int c = 0; c < 3; c++) {
        double low = INFINITY, high = -INFINITY;
        for (uint32_t v = 0; v < view->nverts; v++) {
            double x = (double)view->positions[3 * (size_t)v + (size_t)c];
            low = fmin(low, x);
            high = fmax(high, x);
        }
        p.low[c] = low;
        extent = view->nverts ? fmax(extent, high - low) : 0;
    }
    p.near = extent * NEAR;
    p.cell = p.near > 0 ? 8 * p.near : 1;
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
        (result = find_roots(env, view, first)))
        goto done;
    for (uint32_t v = 0; v < view->nverts; v++)
        shared[first[v]] |= first[v] != (int32_t)v;
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
