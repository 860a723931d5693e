/* Neighbours across edges, with the maps that lead there. */
#include "adjacency/adjacency_data.h"
#include "adjacency/edge.h"

slv_affine slv_orientation(unsigned edge, unsigned adjacent_edge) {
    return slvi_edge_map(edge, adjacent_edge, 1, 1);
}

static slv_neighbour neighbour(unsigned edge, slv_half_edge to, float t0, float t1, float scale,
                               float t_shift) {
    slv_neighbour n = {to.face, to.edge, t0,
                       t1,      scale,   slvi_edge_map(edge, to.edge, scale, t_shift)};
    return n;
}

uint32_t slv_adjacency_neighbours(const slv_adjacency *a, int32_t face, unsigned edge,
                                  slv_neighbour out[2]) {
    if (face < 0 || (uint32_t)face >= a->nfaces)
        return 0;
    slv_half_edge here = {face, (uint8_t)(edge & 3)};
    slv_half_edge to = {a->faces[face].face[here.edge], a->faces[face].edge[here.edge]};
    if (to.face == SLV_BOUNDARY)
        return 0;
    if (a->subface[face] == a->subface[to.face]) {
        out[0] = neighbour(here.edge, to, 0, 1, 1, 1);
        return 1;
    }
    if (a->subface[face]) {
        out[0] =
            neighbour(here.edge, to, 0, 1, 0.5f, slvi_adjacency_is_primary(a, here) ? 0.5f : 1.0f);
        return 1;
    }
    out[0] = neighbour(here.edge, to, 0, 0.5f, 2, 1);
    slv_half_edge secondary = slvi_adjacency_secondary(a, here, to);
    if (secondary.face == SLV_BOUNDARY)
        return 1;
    out[1] = neighbour(here.edge, secondary, 0.5f, 1, 2, 2);
    return 2;
}

bool slv_adjacency_is_t_corner(const slv_adjacency *a, int32_t face, unsigned corner) {
    if (face < 0 || (uint32_t)face >= a->nfaces || !a->subface[face])
        return false;
    for (unsigned side = 0; side < 2; side++) {
        unsigned edge = side ? slvi_edge_before(corner) : corner & 3;
        slv_half_edge h = {face, (uint8_t)edge};
        int32_t to = a->faces[face].face[h.edge];
        /* The first half of the quad's edge starts, the second half ends in its middle. */
        if (to != SLV_BOUNDARY && !a->subface[to] && slvi_adjacency_is_primary(a, h) == !side)
            return true;
    }
    return false;
}

static bool inside(float x) {
    return x >= 0 && x <= 1;
}

bool slv_adjacency_resolve(const slv_adjacency *a, bool v_first, int32_t *face, float *u,
                           float *v) {
    /* From a whole quad, a sub-face and the one behind it may have to be crossed, and as many
     * sideways. */
    enum { MOST_CROSSINGS = 6 };
    int32_t f = *face;
    float x = *u, y = *v;
    if (f < 0 || (uint32_t)f >= a->nfaces || !(x >= -1 && x <= 2 && y >= -1 && y <= 2))
        return false;
    for (int step = 0;; step++) {
        if (inside(x) && inside(y))
            break;
        if (step == MOST_CROSSINGS)
            return false;
        bool along_v = inside(x) || (v_first && !inside(y));
        unsigned edge = slvi_edge_at(along_v, !((along_v ? y : x) < 0));
        slv_neighbour next[2];
        uint32_t count = slv_adjacency_neighbours(a, f, edge, next);
        if (!count)
            return false;
        if (slvi_edge_t(edge, x, y) >= next[0].t1 && next[0].t1 < 1) {
            if (count < 2)
                return false;
            next[0] = next[1];
        }
        slv_affine_apply(&next[0].map, x, y, &x, &y);
        f = next[0].face;
        /* Keep going in the same direction before turning. */
        v_first = !slvi_edge_along_v(next[0].edge);
    }
    *face = f;
    *u = x;
    *v = y;
    return true;
}
