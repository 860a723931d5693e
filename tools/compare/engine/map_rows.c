/* Coordinates of maps, where these are cut, and how many vertices they take. */
#include "compare/engine/map_rows.h"

#include "command/output.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Floats of a vertex: position, normal, and texture coordinates. */
enum { BARE_BYTES = 6 * sizeof(float), VERTEX_BYTES = 8 * sizeof(float) };

#define SAME 1e-5f /* coordinates that are one, as `selvage wrap` has it */

/* A whole polygon is moved to where its least coordinate is in 0..1: beside the end of the map that
 * is where a program that duplicates vertices has it. */
static void settle(const slv_mesh_view *view, slv_wrap_round round, float *corners) {
    for (uint32_t poly = 0; poly < view->npolys; poly++) {
        uint32_t count = view->poly_sizes[poly] == 4 ? 1 : (uint32_t)view->poly_sizes[poly];
        for (int axis = 0; axis < 2; axis++) {
            float least = corners[axis];
            for (uint32_t i = 0; i < 4 * count; i++)
                least = fminf(least, corners[2 * i + (uint32_t)axis]);
            for (uint32_t i = 0; i < 4 * count && round >> axis & 1; i++)
                corners[2 * i + (uint32_t)axis] -= floorf(least + SAME);
        }
        corners += (size_t)8 * count;
    }
}

/* Coordinates as near as makes no difference are one, also across the end. */
static float once_of(float value) {
    float rest = value - floorf(value);
    return rest < 1 - SAME ? rest : 0;
}

static void find_cuts(const slv_adjacency *adjacency, slv_wrap_round round,
                      const map_coordinates *c) {
    for (uint32_t face = 0; face < c->nfaces; face++) {
        const float *own = c->twice + (size_t)8 * face, *once = c->once + (size_t)8 * face;
        for (unsigned edge = 0; edge < 4; edge++) {
            slv_neighbour next[2];
            uint32_t count = slv_adjacency_neighbours(adjacency, (int32_t)face, edge, next);
            for (uint32_t i = 0; i < count; i++)
                if (!slv_uv_continues(own, edge, &next[i], c->twice + (size_t)8 * next[i].face,
                                      false, false))
                    c->cut[face] |= (uint8_t)(1u << edge);
        }
        for (int i = 2; i < 8; i++)
            if (round >> (i & 1) & 1 &&
                fabsf((own[i] - own[i & 1]) - (once[i] - once[i & 1])) > 1e-4f)
                c->cut[face] |= MAP_OVER_END;
    }
}

slv_result map_coordinates_make(const slv_env *env, const slv_mesh *mesh,
                                const slv_adjacency *adjacency, slv_wrap_round round,
                                map_coordinates *out) {
    *out = (map_coordinates){.nfaces = slv_mesh_face_count(mesh)};
    size_t count = (size_t)8 * out->nfaces;
    slv_result result = slv_mesh_round_texcoords(env, mesh, round & 1, round >> 1 & 1, &out->twice);
    if (result)
        return result;
    out->once = malloc((count ? count : 1) * sizeof *out->once);
    out->cut = calloc(out->nfaces ? out->nfaces : 1, 1);
    if (!out->once || !out->cut)
        return output_fail(env, SLV_ERROR_MEMORY, "no memory for texture coordinates");
    settle(slv_mesh_get_view(mesh), round, out->twice);
    for (size_t i = 0; i < count; i++)
        out->once[i] = round >> (i & 1) & 1 ? once_of(out->twice[i]) : out->twice[i];
    find_cuts(adjacency, round, out);
    return SLV_OK;
}

void map_coordinates_free(map_coordinates *c) {
    slv_free(c->twice);
    free(c->once);
    free(c->cut);
    *c = (map_coordinates){0};
}

/* ---- vertices ---- */

enum { LISTED = 64 }; /* values of a vertex that are compared with another */

typedef struct vertex {
    int32_t position;
    float at[2];
} vertex;

static int by_vertex(const void *a, const void *b) {
    const vertex *p = a, *q = b;
    if (p->position != q->position)
        return p->position < q->position ? -1 : 1;
    for (int axis = 0; axis < 2; axis++)
        if (p->at[axis] != q->at[axis])
            return p->at[axis] < q->at[axis] ? -1 : 1;
    return 0;
}

/* Whether one of the values before `i` at its position is as near as makes no difference. They are
 * in the order of u, by which those of one u need not be side by side. */
static bool is_listed(const vertex *list, size_t i) {
    for (size_t k = i; k-- > 0 && i - k <= LISTED && list[k].position == list[i].position &&
                       list[i].at[0] - list[k].at[0] < SAME;)
        if (fabsf(list[i].at[1] - list[k].at[1]) < SAME)
            return true;
    return false;
}

/* Different pairs of a position and coordinates; without any, positions that polygons have. */
static slv_result count_vertices(const slv_env *env, const slv_mesh_view *view,
                                 const float *corners, uint32_t *out) {
    size_t nsides = 0, at = 0;
    for (uint32_t poly = 0; poly < view->npolys; poly++)
        nsides += (size_t)view->poly_sizes[poly];
    vertex *list = calloc(nsides ? nsides : 1, sizeof *list);
    if (!list)
        return output_fail(env, SLV_ERROR_MEMORY, "no memory for %zu corners", nsides);
    for (uint32_t poly = 0; poly < view->npolys; poly++) {
        int32_t size = view->poly_sizes[poly];
        for (int32_t k = 0; k < size; k++, at++) {
            list[at].position = view->poly_verts[at];
            if (corners && !isnan(corners[0]))
                memcpy(list[at].at, corners + (size == 4 ? 2 : 8) * (size_t)k, sizeof list[at].at);
        }
        corners = corners ? corners + (size_t)8 * (size == 4 ? 1 : (size_t)size) : NULL;
    }
    qsort(list, nsides, sizeof *list, by_vertex);
    *out = 0;
    for (size_t i = 0; i < nsides; i++)
        *out += !is_listed(list, i);
    free(list);
    return SLV_OK;
}

/* ---- rows ---- */

/* Edges between faces at which lookups have to go on elsewhere; all of them if there is no map. */
static uint32_t count_edges(const slv_adjacency *adjacency, const float *corners,
                            slv_wrap_round round) {
    uint32_t sides = 0;
    for (uint32_t face = 0; face < slv_adjacency_face_count(adjacency); face++)
        for (unsigned edge = 0; edge < 4; edge++) {
            slv_neighbour next[2];
            uint32_t count = slv_adjacency_neighbours(adjacency, (int32_t)face, edge, next);
            for (uint32_t i = 0; i < count; i++)
                sides += !corners || !slv_uv_continues(corners + (size_t)8 * face, edge, &next[i],
                                                       corners + (size_t)8 * next[i].face,
                                                       round & 1, round >> 1 & 1);
        }
    return sides / 2; /* each is an edge of two */
}

slv_result map_rows_make(const slv_env *env, const slv_mesh *mesh, const slv_adjacency *adjacency,
                         const map_coordinates *c, report_data *report) {
    static const struct {
        const char *name, *title;
        bool round, once, short_way;
    } kinds[] = {
        {"uv", "the image, by the mesh's texture coordinates", false, false, false},
        {"uv-plain", "one coordinate a vertex, interpolated as it stands", true, true, false},
        {"uv-duplicated", "vertices twice where the map ends", true, false, false},
        {"uv-wrapped", "one coordinate a vertex, the short way (Tarini)", true, true, true},
    };
    report_maps *maps = &report->maps;
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    slv_result result = SLV_OK;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds && !result; i++) {
        if (kinds[i].round != (maps->round != SLV_WRAP_ROUND_NO))
            continue;
        report_map *row = &maps->rows[maps->nrows];
        *row = (report_map){.name = kinds[i].name,
                            .title = kinds[i].title,
                            .once = kinds[i].once,
                            .short_way = kinds[i].short_way,
                            .vertex_bytes = VERTEX_BYTES};
        const float *corners = row->once ? c->once : c->twice;
        row->cut =
            count_edges(adjacency, corners, row->short_way ? maps->round : SLV_WRAP_ROUND_NO);
        result = count_vertices(env, view, corners, &row->vertices);
        if (!kinds[i].once)
            maps->baseline = maps->nrows;
        maps->nrows++;
    }
    for (uint32_t k = 0; k < report->nstrategies && !result; k++) {
        report_map *row = &maps->rows[maps->nrows++];
        const slv_strategy *strategy = report->strategies[k].strategy;
        *row = (report_map){.name = strategy->name,
                            .title = strategy->title,
                            .strategy = strategy,
                            .cut = count_edges(adjacency, NULL, SLV_WRAP_ROUND_NO),
                            .vertex_bytes = BARE_BYTES};
        result = count_vertices(env, view, NULL, &row->vertices);
    }
    for (uint32_t face = 0; face < c->nfaces; face++)
        maps->over_end += (c->cut[face] & MAP_OVER_END) != 0;
    return result;
}

slv_uv_images map_row_images(const report_map *row, const slv_uv_images *given,
                             const map_coordinates *c) {
    slv_uv_images images = *given;
    images.texcoords = row->once ? c->once : c->twice;
    images.round_u = row->short_way && given->round_u;
    images.round_v = row->short_way && given->round_v;
    return images;
}
