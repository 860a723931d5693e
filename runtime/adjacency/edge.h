/* The one geometry of a face's edges and corners: where they are in (u,v) and among texels, what
 * follows what on the way around, and how coordinates change across an edge.
 *
 * Along edge e a point has t, 0..1 counter-clockwise from corner e, where the edge starts, to
 * corner e + 1; its depth is the distance from the edge, inwards. Edge and corner ids are taken
 * modulo 4 unless another range is named. */
#ifndef SLV_ADJACENCY_EDGE_H
#define SLV_ADJACENCY_EDGE_H

#include <selvage/adjacency.h>

#include <stddef.h>

/* Where a corner is: 0 or 1. */
static inline int slvi_corner_u(unsigned corner) {
    return (int)((corner ^ corner >> 1) & 1);
}

static inline int slvi_corner_v(unsigned corner) {
    return (int)(corner >> 1 & 1);
}

/* The corner at an end of both axes. */
static inline unsigned slvi_corner_at(bool right, bool top) {
    return top ? right ? 2 : 3 : right ? 1 : 0;
}

/* The edge that follows counter-clockwise, and the corner that this edge ends at. */
static inline unsigned slvi_edge_next(unsigned edge) {
    return (edge + 1) & 3;
}

/* The edge before, which ends at the corner that has this edge's id. */
static inline unsigned slvi_edge_before(unsigned edge) {
    return (edge + 3) & 3;
}

static inline unsigned slvi_edge_opposite(unsigned edge) {
    return (edge + 2) & 3;
}

/* Edges 1 and 3 run along v, the others along u. */
static inline bool slvi_edge_along_v(unsigned edge) {
    return (edge & 1) != 0;
}

/* Whether the edge lies at 1, and not at 0, of the axis that leads away from it. */
static inline bool slvi_edge_is_far(unsigned edge) {
    return slvi_corner_u(edge) != 0;
}

/* Whether the coordinate along it grows with t. */
static inline bool slvi_edge_is_rising(unsigned edge) {
    return (edge & 2) == 0;
}

/* The edge at 0 or, if it is `far`, at 1 of an axis: of u (edges 3 and 1) or of v (edges 0, 2). */
static inline unsigned slvi_edge_at(bool of_v, bool far) {
    return of_v ? (far ? 2 : 0) : (far ? 1 : 3);
}

/* Of a value for u and one for v, that of the axis along an edge; and that of the other. */
static inline int slvi_edge_along(unsigned edge, int of_u, int of_v) {
    return slvi_edge_along_v(edge) ? of_v : of_u;
}

static inline int slvi_edge_across(unsigned edge, int of_u, int of_v) {
    return slvi_edge_along_v(edge) ? of_u : of_v;
}

/* The point t of an edge. */
static inline void slvi_edge_point(unsigned edge, float t, float *u, float *v) {
    float along = slvi_edge_is_rising(edge) ? t : 1.0f - t;
    float across = slvi_edge_is_far(edge) ? 1.0f : 0.0f;
    *u = slvi_edge_along_v(edge) ? across : along;
    *v = slvi_edge_along_v(edge) ? along : across;
}

/* A point's t and depth. */
static inline float slvi_edge_t(unsigned edge, float u, float v) {
    float along = slvi_edge_along_v(edge) ? v : u;
    return slvi_edge_is_rising(edge) ? along : 1.0f - along;
}

static inline float slvi_edge_depth(unsigned edge, float u, float v) {
    float across = slvi_edge_along_v(edge) ? u : v;
    return slvi_edge_is_far(edge) ? 1.0f - across : across;
}

/* Moves a point straight onto an edge. */
static inline void slvi_edge_project(unsigned edge, float *u, float *v) {
    *(slvi_edge_along_v(edge) ? u : v) = slvi_edge_is_far(edge) ? 1.0f : 0.0f;
}

/* Turns a vector of the plane by as many right angles as it takes for this edge's inward direction
 * to become that of edge 0. */
static inline void slvi_edge_turn(unsigned edge, float *x, float *y) {
    for (unsigned turn = 0; turn < (edge & 3); turn++) {
        float turned = -*x;
        *x = *y;
        *y = turned;
    }
}

/* Among width x height texels: texel j along an edge, counter-clockwise, `depth` rows inside of it
 * (negative: outside). */
static inline void slvi_edge_texel(int32_t width, int32_t height, unsigned edge, int32_t j,
                                   int32_t depth, int32_t *x, int32_t *y) {
    bool along_v = slvi_edge_along_v(edge);
    int32_t last_along = (along_v ? height : width) - 1,
            last_across = (along_v ? width : height) - 1;
    int32_t along = slvi_edge_is_rising(edge) ? j : last_along - j;
    int32_t across = slvi_edge_is_far(edge) ? last_across - depth : depth;
    *x = along_v ? across : along;
    *y = along_v ? along : across;
}

/* How far apart texels j and j + 1 of an edge are, given how far neighbours along u and v are. */
static inline ptrdiff_t slvi_edge_step(unsigned edge, ptrdiff_t step_u, ptrdiff_t step_v) {
    ptrdiff_t step = slvi_edge_along_v(edge) ? step_v : step_u;
    return slvi_edge_is_rising(edge) ? step : -step;
}

/* The texel in a corner. */
static inline void slvi_corner_texel(int32_t width, int32_t height, unsigned corner, int32_t *x,
                                     int32_t *y) {
    slvi_edge_texel(width, height, corner, 0, 0, x, y);
}

/* On a walk around the face from corner 0, along all its edges: how many texels lie before edge 0
 * to 3; edge 4 is the end. */
static inline uint64_t slvi_edge_walked(unsigned edge, uint64_t width, uint64_t height) {
    return (edge + 1) / 2 * width + edge / 2 * height;
}

/* The same along the edges 0 to 2 of a triangle, v = 0, u + v = 1 and u = 0, with `width` texels
 * along each. */
static inline void slvi_edge_triangle_texel(int32_t width, unsigned edge, int32_t j, int32_t *x,
                                            int32_t *y) {
    int32_t back = width - 1 - j;
    *x = edge == 0 ? j : edge == 1 ? back : 0;
    *y = edge == 0 ? 0 : edge == 1 ? j : back;
}

/* log2 of how much longer a face's edge is than its neighbour's: 1 from a whole quad to a sub-face,
 * -1 from a sub-face to a whole quad. So many halvings make texels of the neighbour as long. */
static inline int slvi_neighbour_halvings(const slv_neighbour *to) {
    return to->scale > 1.5f ? 1 : to->scale < 0.75f ? -1 : 0;
}

/* Quarter turns, counter-clockwise, of the neighbour's axes seen in the face's own. */
static inline unsigned slvi_edge_turns(unsigned edge, unsigned adjacent_edge) {
    return (edge - adjacent_edge + 2) & 3;
}

/* A vector in a neighbour's axes, which are turned by so many quarters, in the face's own. Exact.
 */
static inline void slvi_edge_turn_vector(unsigned turns, float *x, float *y) {
    float a = *x, b = *y;
    *x = (turns & 3) == 0 ? a : (turns & 3) == 1 ? -b : (turns & 3) == 2 ? -a : b;
    *y = (turns & 3) == 0 ? b : (turns & 3) == 1 ? a : (turns & 3) == 2 ? -b : -a;
}

/* How the axes of member i of a ring are turned as member `own` sees them: across the edge to those
 * beside it, diagonally across to all others, as lookups on the CPU have it. Around four faces that
 * is the same from everywhere; around other numbers there is no way for which it is. */
static inline unsigned slvi_ring_turns(const slv_ring *ring, uint32_t own, uint32_t i) {
    uint32_t last = ring->count - 1;
    bool after = i == own + 1 || (ring->closed && own == last && i == 0);
    bool before = i + 1 == own || (ring->closed && own == 0 && i == last);
    unsigned turned = (unsigned)ring->corners[own].corner - ring->corners[i].corner;
    return i == own ? 0 : (turned + (after ? 1u : before ? 3u : 2u)) & 3;
}

/* The map across an edge that sends t to t_shift - scale t and the depth d to -scale d. With both 1
 * it is one of the 16 orientations. */
static inline slv_affine slvi_edge_map(unsigned edge, unsigned adjacent_edge, float scale,
                                       float t_shift) {
    /* t = tu u + tv v + t0, d = du u + dv v + d0, for each edge; the transpose leads back. */
    static const struct {
        float tu, tv, t0, du, dv, d0;
    } frames[4] = {
        {1, 0, 0, 0, 1, 0}, {0, 1, 0, -1, 0, 1}, {-1, 0, 1, 0, -1, 1}, {0, -1, 1, 1, 0, 0}};
    const unsigned a = edge & 3, b = adjacent_edge & 3;
    float tu = -scale * frames[a].tu, tv = -scale * frames[a].tv;
    float t0 = t_shift - scale * frames[a].t0 - frames[b].t0;
    float du = -scale * frames[a].du, dv = -scale * frames[a].dv;
    float d0 = -scale * frames[a].d0 - frames[b].d0;
    slv_affine map = {frames[b].tu * tu + frames[b].du * du, frames[b].tu * tv + frames[b].du * dv,
                      frames[b].tu * t0 + frames[b].du * d0, frames[b].tv * tu + frames[b].dv * du,
                      frames[b].tv * tv + frames[b].dv * dv, frames[b].tv * t0 + frames[b].dv * d0};
    return map;
}

#endif
