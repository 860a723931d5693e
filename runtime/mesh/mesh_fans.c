/* A mesh pulled apart into fans around its vertices, so that it is manifold. */
#include "mesh/mesh_data.h"

#include "base/log.h"
#include "base/memory.h"

#define NO_SIDE UINT32_MAX

/* What is known of the fans around one vertex of the mesh so far. */
typedef struct vertex_fans {
    uint32_t nfans;
    uint32_t ends[2]; /* edges on which the first fan ends, the lower number first */
    bool differ;
} vertex_fans;

typedef struct builder {
    const slv_mesh *mesh;
    const slv_mesh_edges *edges;
    uint32_t *next; /* per side: the next corner counter-clockwise around the same vertex */
    uint8_t *entered;
    vertex_fans *places;
    slv_mesh_fans *out;
} builder;

static uint32_t previous_side(const builder *b, uint32_t side) {
    uint32_t poly = b->edges->side_poly[side];
    return side > b->mesh->poly_first[poly] ? side - 1 : b->mesh->poly_first[poly + 1] - 1;
}

static void find_next(builder *b, const uint8_t *left_out, uint32_t side) {
    uint32_t leave = previous_side(b, side), edge_id = b->edges->side_edge[leave];
    b->next[side] = NO_SIDE;
    if (edge_id == SLV_NO_EDGE || left_out[b->edges->side_poly[side]])
        return;
    const slv_mesh_edge *edge = &b->edges->edges[edge_id];
    if (edge->count != 2 || slvi_mesh_edge_is_flipped(b->mesh, edge))
        return;
    uint32_t mate = edge->side[edge->side[0] == leave];
    if (left_out[b->edges->side_poly[mate]])
        return;
    b->next[side] = mate;
    b->entered[mate] = 1;
}

static void number_fan(builder *b, uint32_t first, bool closed) {
    int32_t vertex = b->mesh->view.poly_verts[first];
    vertex_fans *place = &b->places[vertex];
    int32_t id = place->nfans ? (int32_t)b->out->nverts++ : vertex;
    uint32_t side = first, last = first;
    do {
        b->out->side_vert[side] = id;
        last = side;
        side = b->next[side];
    } while (side != NO_SIDE && side != first);
    b->out->origin[id] = vertex;
    uint32_t x = b->edges->side_edge[first], y = b->edges->side_edge[previous_side(b, last)];
    uint32_t low = x < y ? x : y, high = x < y ? y : x;
    if (!place->nfans++) {
        place->ends[0] = low;
        place->ends[1] = high;
    }
    place->differ |=
        closed || high == SLV_NO_EDGE || low != place->ends[0] || high != place->ends[1];
}

slv_result slvi_mesh_fans_create(const slv_env *env, const slv_mesh *mesh,
                                 const slv_mesh_edges *edges, const uint8_t *left_out,
                                 slv_mesh_fans *out) {
    uint32_t nsides = mesh->poly_first[mesh->view.npolys], nverts = mesh->view.nverts;
    /* every fan has a side of its own */
    uint64_t most = (uint64_t)nverts + nsides;
    slv_result result = SLV_OK;
    builder b = {.mesh = mesh, .edges = edges, .out = out};
    *out = (slv_mesh_fans){.nverts = nverts};
    if (most > INT32_MAX)
        return slvi_fail(env, SLV_ERROR_LIMIT, "mesh: %llu vertices and sides are too many",
                         (unsigned long long)most);
    if ((result = slvi_alloc(env, "mesh fans", nsides, sizeof *b.next, &b.next)) ||
        (result = slvi_alloc(env, "mesh fans", nsides, 1, &b.entered)) ||
        (result = slvi_alloc(env, "mesh fans", nverts, sizeof *b.places, &b.places)) ||
        (result = slvi_alloc(env, "mesh fans", nsides, sizeof *out->side_vert, &out->side_vert)) ||
        (result = slvi_alloc(env, "mesh fans", most, sizeof *out->origin, &out->origin)) ||
        (result = slvi_alloc(env, "mesh fans", most, 1, &out->sharp)))
        goto done;
    for (uint32_t v = 0; v < nverts; v++)
        out->origin[v] = (int32_t)v;
    for (uint32_t side = 0; side < nsides; side++)
        out->side_vert[side] = -1;
    for (uint32_t side = 0; side < nsides; side++)
        find_next(&b, left_out, side);
    for (uint32_t side = 0; side < nsides; side++)
        if (!b.entered[side] && !left_out[edges->side_poly[side]])
            number_fan(&b, side, false);
    for (uint32_t side = 0; side < nsides; side++)
        if (out->side_vert[side] < 0 && !left_out[edges->side_poly[side]])
            number_fan(&b, side, true);
    for (uint32_t v = 0; v < out->nverts; v++) {
        const vertex_fans *place = &b.places[out->origin[v]];
        out->sharp[v] = place->nfans > 1 && place->differ;
    }
done:
    slvi_free(b.next);
    slvi_free(b.entered);
    slvi_free(b.places);
    if (result)
        slvi_mesh_fans_clear(out);
    return result;
}

void slvi_mesh_fans_clear(slv_mesh_fans *fans) {
    slvi_free(fans->side_vert);
    slvi_free(fans->origin);
    slvi_free(fans->sharp);
    *fans = (slv_mesh_fans){0};
}
