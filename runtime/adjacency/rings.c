/* Rings. Leaving a corner counter-clockwise is a one-to-one partial map between corners because
 * links are mutual, so the corners fall into chains and cycles, whatever the tables say, and each
 * is visited once. */
#include "adjacency/adjacency_data.h"
#include "adjacency/edge.h"

#include "base/memory.h"

#define NO_CORNER UINT32_MAX

static uint32_t corner_id(int32_t face, unsigned corner) {
    return (uint32_t)face * 4 + (corner & 3);
}

static uint32_t counter_clockwise(const slv_adjacency *a, uint32_t corner) {
    slv_half_edge leave = {(int32_t)(corner / 4), (uint8_t)slvi_edge_before(corner)};
    int32_t to = a->faces[leave.face].face[leave.edge];
    uint8_t to_edge = a->faces[leave.face].edge[leave.edge];
    if (to == SLV_BOUNDARY)
        return NO_CORNER;
    if (a->subface[leave.face] == a->subface[to])
        return corner_id(to, to_edge);
    if (a->subface[leave.face])
        /* Of the two halves only the first ends where the whole quad's edge starts. */
        return slvi_adjacency_is_primary(a, leave) ? corner_id(to, to_edge) : NO_CORNER;
    slv_half_edge last = slvi_adjacency_secondary(a, leave, (slv_half_edge){to, to_edge});
    return last.face == SLV_BOUNDARY ? NO_CORNER : corner_id(last.face, last.edge);
}

static void collect_ring(slv_adjacency *a, const uint32_t *next, uint32_t start, bool closed,
                         uint32_t *nrings, uint32_t *filled) {
    uint32_t ring = (*nrings)++, corner = start;
    a->ring_first[ring] = *filled;
    a->ring_closed[ring] = closed;
    do {
        a->corner_ring[corner] = ring;
        a->corner_position[corner] = *filled;
        a->ring_corners[(*filled)++] = (slv_corner){(int32_t)(corner / 4), (uint8_t)(corner & 3)};
        corner = next[corner];
    } while (corner != NO_CORNER && corner != start);
}

slv_result slvi_adjacency_build_rings(const slv_env *env, slv_adjacency *a) {
    slv_result result = SLV_OK;
    uint32_t ncorners = a->nfaces * 4, nrings = 0, filled = 0;
    uint32_t *next = NULL;
    uint8_t *entered = NULL;
    if ((result = slvi_alloc(env, "rings", ncorners, sizeof *next, &next)) ||
        (result = slvi_alloc(env, "rings", ncorners, 1, &entered)) ||
        (result = slvi_alloc(env, "rings", ncorners, sizeof *a->ring_corners, &a->ring_corners)) ||
        (result = slvi_alloc(env, "rings", (uint64_t)ncorners + 1, sizeof *a->ring_first,
                             &a->ring_first)) ||
        (result = slvi_alloc(env, "rings", ncorners, 1, &a->ring_closed)) ||
        (result = slvi_alloc(env, "rings", ncorners, sizeof *a->corner_ring, &a->corner_ring)) ||
        (result =
             slvi_alloc(env, "rings", ncorners, sizeof *a->corner_position, &a->corner_position)))
        goto done;
    for (uint32_t c = 0; c < ncorners; c++) {
        next[c] = counter_clockwise(a, c);
        if (next[c] != NO_CORNER)
            entered[next[c]] = 1;
        a->corner_ring[c] = NO_CORNER;
    }
    for (uint32_t c = 0; c < ncorners; c++)
        if (!entered[c])
            collect_ring(a, next, c, false, &nrings, &filled);
    for (uint32_t c = 0; c < ncorners; c++)
        if (a->corner_ring[c] == NO_CORNER)
            collect_ring(a, next, c, true, &nrings, &filled);
    a->ring_first[nrings] = filled;
done:
    slvi_free(next);
    slvi_free(entered);
    return result;
}

slv_ring slv_adjacency_ring(const slv_adjacency *a, int32_t face, unsigned corner,
                            uint32_t *position) {
    if (position)
        *position = 0;
    if (face < 0 || (uint32_t)face >= a->nfaces)
        return (slv_ring){NULL, 0, false};
    uint32_t id = corner_id(face, corner), ring = a->corner_ring[id], first = a->ring_first[ring];
    if (position)
        *position = a->corner_position[id] - first;
    return (slv_ring){a->ring_corners + first, a->ring_first[ring + 1] - first,
                      a->ring_closed[ring] != 0};
}
