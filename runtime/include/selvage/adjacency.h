/* How faces meet: the neighbour across each edge, the map from one face's (u,v) to the other's, and
 * the ring of faces around every corner.
 *
 * Edge ids run counter-clockwise from a face's first vertex: 0 is v=0, 1 is u=1, 2 is v=1, 3 is
 * u=0. Corner c is the vertex at which edge c starts: 0 is (0,0), 1 is (1,0), 2 is (1,1), 3 is
 * (0,1). Edge e goes from corner e to corner (e+1)%4.
 *
 * An n-gon of the control mesh is n faces, its sub-faces. Sub-face k has its corner 0 at the
 * polygon's vertex k, corner 1 in the middle of the polygon's edge k, corner 2 at the polygon's
 * centre and corner 3 in the middle of edge k-1. Where a whole quad meets an n-gon, the quad's edge
 * meets two sub-faces, each half as long; its record names the primary one, the first that is met
 * when walking along the edge counter-clockwise, and the other is the primary's neighbour over its
 * edge (adjacent edge + 3) % 4. */
#ifndef SELVAGE_ADJACENCY_H
#define SELVAGE_ADJACENCY_H

#include <selvage/result.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SLV_BOUNDARY (-1)

/* One face's four edges. face[e] is the face across edge e or SLV_BOUNDARY; edge[e] is that face's
 * edge. */
typedef struct slv_face_adjacency {
    int32_t face[4];
    uint8_t edge[4];
} slv_face_adjacency;

/* Face flags; the values are those of the .ptx file. */
enum {
    SLV_FACE_CONSTANT = 1,
    SLV_FACE_EDITED = 2,
    SLV_FACE_NEIGHBOURS_CONSTANT = 4,
    SLV_FACE_SUBFACE = 8
};

/* (u', v') = (uu u + uv v + u0, vu u + vv v + v0). Axes are only swapped, mirrored, and scaled by
 * 1, 2 or 1/2. */
typedef struct slv_affine {
    float uu, uv, u0;
    float vu, vv, v0;
} slv_affine;

/* The orientation: the map from a face's (u,v), across its edge `edge`, to the (u,v) of a neighbour
 * of equal size that touches with its edge `adjacent_edge`. One of 16. Both ids are taken modulo 4.
 */
SLV_API slv_affine slv_orientation(unsigned edge, unsigned adjacent_edge);

static inline void slv_affine_apply(const slv_affine *m, float u, float v, float *u_out,
                                    float *v_out) {
    *u_out = m->uu * u + m->uv * v + m->u0;
    *v_out = m->vu * u + m->vv * v + m->v0;
}

/* A neighbour across one edge. `scale` is the length of this face's edge in units of the
 * neighbour's: 1 for faces of a kind, 2 from a whole quad to a sub-face, 1/2 from a sub-face to a
 * whole quad. The neighbour lies along the stretch t0..t1 of this face's edge, t running
 * counter-clockwise. */
typedef struct slv_neighbour {
    int32_t face;
    uint8_t edge;
    float t0, t1, scale;
    slv_affine map;
} slv_neighbour;

typedef struct slv_corner {
    int32_t face;
    uint8_t corner;
} slv_corner;

/* The faces around a vertex, in counter-clockwise order (seen from outside): from each corner to
 * the next, one leaves over the edge that ends at the vertex, edge (corner + 3) % 4. A closed ring
 * wraps around; an open one begins and ends at a boundary. */
typedef struct slv_ring {
    const slv_corner *corners;
    uint32_t count;
    bool closed;
} slv_ring;

/* The adjacency of a whole mesh. Immutable once built, so any number of threads may read it. */
typedef struct slv_adjacency slv_adjacency;

/* Builds from per-face records and flags (only SLV_FACE_SUBFACE is looked at; `flags` may be NULL).
 * Copies. A link that the other side does not return, or that points outside the table, is cut on
 * the side that claims it and counted in one warning: what comes out is symmetric whatever went in.
 */
SLV_NODISCARD SLV_API slv_result slv_adjacency_create(const slv_env *env, uint32_t nfaces,
                                                      const slv_face_adjacency *faces,
                                                      const uint8_t *flags, slv_adjacency **out);
SLV_API void slv_adjacency_destroy(slv_adjacency *adjacency);

SLV_API uint32_t slv_adjacency_face_count(const slv_adjacency *adjacency);
/* `face_count` records. Owned by the adjacency. */
SLV_API const slv_face_adjacency *slv_adjacency_faces(const slv_adjacency *adjacency);
SLV_API bool slv_adjacency_is_subface(const slv_adjacency *adjacency, int32_t face);
/* How many one-sided links were cut when it was built. */
SLV_API uint32_t slv_adjacency_cut_count(const slv_adjacency *adjacency);

/* The neighbours across an edge in counter-clockwise order along it: none, one, or two (a whole
 * quad next to two sub-faces; one of scale 2 if the other is missing). Returns how many. */
SLV_API uint32_t slv_adjacency_neighbours(const slv_adjacency *adjacency, int32_t face,
                                          unsigned edge, slv_neighbour out[2]);

/* The ring around a corner, with `*position` (may be NULL) the index of this corner in it. A ring
 * is at least this corner alone. The mid-edge vertex where two sub-faces touch the side of a whole
 * quad is listed as an open ring of the two sub-faces with `closed` false; see
 * slv_adjacency_is_t_corner. */
SLV_API slv_ring slv_adjacency_ring(const slv_adjacency *adjacency, int32_t face, unsigned corner,
                                    uint32_t *position);

/* True if the corner lies in the middle of a whole quad's edge: that quad continues straight past
 * it, so the corner is regular whatever its ring says. */
SLV_API bool slv_adjacency_is_t_corner(const slv_adjacency *adjacency, int32_t face,
                                       unsigned corner);

/* Where a point just outside a face lies. (u,v) is in the frame of `*face` and at most one face
 * away on either axis; on success the three are replaced by the face that holds the point and its
 * coordinates there. With both coordinates outside, `v_first` says which edge is crossed first:
 * around a regular vertex both ways arrive at the same place. Returns false at a boundary, leaving
 * the arguments unchanged. */
SLV_API bool slv_adjacency_resolve(const slv_adjacency *adjacency, bool v_first, int32_t *face,
                                   float *u, float *v);

#ifdef __cplusplus
}
#endif

#endif
