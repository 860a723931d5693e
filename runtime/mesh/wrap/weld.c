/* Which vertices lie at one place and can be one: all but those that would make an edge of more
 * than two sides, or of two that run the same way. */
#include "mesh/wrap/weld.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

typedef struct place {
    uint32_t bits[3];
    int32_t vertex;
} place;

static int by_place(const void *a, const void *b) {
    const place *p = a, *q = b;
    int order = memcmp(p->bits, q->bits, sizeof p->bits);
    return order ? order : (p->vertex > q->vertex) - (p->vertex < q->vertex);
}

/* Per vertex the first one at its place. */
static slv_result find_roots(const slv_env *env, const slv_mesh_view *view, int32_t *root) {
    place *list = NULL;
    slv_result result = slvi_alloc_plain(env, "vertices", view->nverts, sizeof *list, &list);
    for (uint32_t v = 0; v < view->nverts && !result; v++) {
        for (int c = 0; c < 3; c++) {
            float x = view->positions[3 * (size_t)v + (size_t)c] + 0.0f; /* -0 is 0 */
            memcpy(&list[v].bits[c], &x, sizeof x);
        }
        list[v].vertex = (int32_t)v;
    }
    if (!result && view->nverts)
        qsort(list, view->nverts, sizeof *list, by_place);
    for (uint32_t i = 0; i < view->nverts && !result; i++) {
        bool again = i && memcmp(list[i].bits, list[i - 1].bits, sizeof list->bits) == 0;
        root[list[i].vertex] = again ? root[list[i - 1].vertex] : list[i].vertex;
    }
    slvi_free(list);
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
