/* Which constant faces lie among nothing but their own value, so that a filter need not look
 * around. */
#include "texture/neighbourhood.h"

#include "adjacency/edge.h"

#define MAX_STEPS 10 /* the format's own bound on a walk around a vertex */

enum walk { WALK_CLOSED, WALK_BOUNDARY, WALK_DIFFERENT };

/* Around the vertex where an edge starts, leaving over that edge. */
static enum walk walk_clockwise(const slv_neighbourhood *s, uint32_t start, unsigned edge) {
    unsigned nedges = s->triangles ? 3 : 4;
    int32_t previous = (int32_t)start;
    slv_source_face from = s->face(s->user, start);
    for (int step = 0; step < MAX_STEPS; step++) {
        int32_t face = from.adjacency.face[edge];
        unsigned arrived = from.adjacency.edge[edge];
        if (face < 0)
            return WALK_BOUNDARY;
        if (face == (int32_t)start)
            return WALK_CLOSED;
        if (!s->same(s->user, start, (uint32_t)face))
            return WALK_DIFFERENT;
        slv_source_face to = s->face(s->user, (uint32_t)face);
        /* the vertex is in the middle of the whole quad's edge: there is nothing else around it */
        if ((from.flags & SLV_FACE_SUBFACE) && !(to.flags & SLV_FACE_SUBFACE) &&
            to.adjacency.face[arrived] == previous)
            return WALK_CLOSED;
        previous = face;
        from = to;
        edge = (arrived + 1) % nedges;
    }
    return WALK_CLOSED;
}

/* Around the same vertex the other way, leaving over the edge before. */
static enum walk walk_counter_clockwise(const slv_neighbourhood *s, uint32_t start, unsigned edge) {
    unsigned nedges = s->triangles ? 3 : 4;
    slv_source_face from = s->face(s->user, start);
    edge = (edge + nedges - 1) % nedges;
    for (int step = 0; step < MAX_STEPS; step++) {
        int32_t face = from.adjacency.face[edge];
        unsigned arrived = from.adjacency.edge[edge];
        if (face < 0)
            return WALK_BOUNDARY;
        if (!(from.flags & SLV_FACE_SUBFACE) &&
            (s->face(s->user, (uint32_t)face).flags & SLV_FACE_SUBFACE)) {
            /* the record names the sub-face at the edge's start; the one at its end touches the
             * vertex */
            slv_face_adjacency primary = s->face(s->user, (uint32_t)face).adjacency;
            unsigned across = slvi_edge_before(arrived);
            face = primary.face[across];
            arrived = slvi_edge_before(primary.edge[across]);
            if (face < 0)
                return WALK_BOUNDARY;
        }
        if (face == (int32_t)start)
            return WALK_CLOSED;
        if (!s->same(s->user, start, (uint32_t)face))
            return WALK_DIFFERENT;
        from = s->face(s->user, (uint32_t)face);
        edge = (arrived + nedges - 1) % nedges;
    }
    return WALK_CLOSED;
}

bool slvi_neighbourhood_is_constant(const slv_neighbourhood *s, uint32_t face) {
    bool constant = (s->face(s->user, face).flags & SLV_FACE_CONSTANT) != 0;
    for (unsigned edge = 0; constant && edge < (s->triangles ? 3 : 4); edge++) {
        enum walk walk = walk_clockwise(s, face, edge);
        if (walk == WALK_BOUNDARY)
            walk = s->borders_clamp ? walk_counter_clockwise(s, face, edge) : WALK_DIFFERENT;
        constant = walk != WALK_DIFFERENT;
    }
    return constant;
}
