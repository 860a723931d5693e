/* Inside an slv_adjacency. */
#ifndef SLV_MESH_ADJACENCY_DATA_H
#define SLV_MESH_ADJACENCY_DATA_H

#include <selvage/adjacency.h>

/* Corners and half-edges are numbered 4 * face + id, so this many faces still fit an int32_t. */
#define SLV_MAX_FACES (INT32_MAX / 4)

struct slv_adjacency {
    uint32_t nfaces, ncut;
    slv_face_adjacency *faces;
    uint8_t *subface; /* 0 or 1 per face */

    slv_corner *ring_corners; /* 4 * nfaces, ring by ring */
    uint32_t *ring_first;     /* nrings + 1 */
    uint8_t *ring_closed;
    uint32_t *corner_ring;     /* per corner: its ring ... */
    uint32_t *corner_position; /* ... and its place in ring_corners */
};

/* One half-edge: an edge as one of its faces sees it. face is SLV_BOUNDARY where there is none. */
typedef struct slv_half_edge {
    int32_t face;
    uint8_t edge;
} slv_half_edge;

/* The half-edge that a face says is across. */
static inline slv_half_edge slvi_adjacency_across(const slv_adjacency *a, slv_half_edge h) {
    return (slv_half_edge){a->faces[h.face].face[h.edge], a->faces[h.face].edge[h.edge]};
}

static inline bool slvi_half_edge_same(slv_half_edge a, slv_half_edge b) {
    return a.face == b.face && a.edge == b.edge;
}

static inline bool slvi_adjacency_has(const slv_adjacency *a, int32_t face) {
    return face >= 0 && (uint32_t)face < a->nfaces;
}

/* halves.c */
/* The second sub-face along an edge of a whole quad whose record names `primary`; none if the
 * tables do not agree. */
slv_half_edge slvi_adjacency_secondary(const slv_adjacency *adjacency, slv_half_edge whole,
                                       slv_half_edge primary);

/* Whether a sub-face's edge that meets a whole quad is the first half of that quad's edge. */
bool slvi_adjacency_is_primary(const slv_adjacency *adjacency, slv_half_edge sub);

/* rings.c */
slv_result slvi_adjacency_build_rings(const slv_env *env, slv_adjacency *adjacency);

#endif
