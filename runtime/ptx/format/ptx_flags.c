/* Which constant faces lie among nothing but their own value, so that a filter need not look
 * around. */
#include "ptx/write/ptx_write.h"

#include "adjacency/edge.h"

#define MAX_STEPS 10 /* the format's own bound on a walk around a vertex */

struct surroundings {
    const uint8_t *records;
    const uint8_t *constants;
    size_t pixel_size;
    unsigned nedges;
    bool borders_clamp;
};

enum walk { WALK_CLOSED, WALK_BOUNDARY, WALK_DIFFERENT };

static slv_ptx_face face_at(const struct surroundings *s, int32_t face) {
    slv_ptx_face out;
    slvi_ptx_unpack_record(s->records + (size_t)face * PTX_FACE_INFO_SIZE, s->nedges == 3, &out);
    return out;
}

static bool same_value(const struct surroundings *s, uint32_t face, int32_t other) {
    return (s->records[(size_t)other * PTX_FACE_INFO_SIZE + 3] & SLV_FACE_CONSTANT) &&
           memcmp(s->constants + face * s->pixel_size, s->constants + (size_t)other * s->pixel_size,
                  s->pixel_size) == 0;
}

/* Around the vertex where an edge starts, leaving over that edge. */
static enum walk walk_clockwise(const struct surroundings *s, uint32_t start, unsigned edge) {
    int32_t previous = (int32_t)start;
    slv_ptx_face from = face_at(s, (int32_t)start);
    for (int step = 0; step < MAX_STEPS; step++) {
        int32_t face = from.adjacency.face[edge];
        unsigned arrived = from.adjacency.edge[edge];
        if (face < 0)
            return WALK_BOUNDARY;
        if (face == (int32_t)start)
            return WALK_CLOSED;
        if (!same_value(s, start, face))
            return WALK_DIFFERENT;
        slv_ptx_face to = face_at(s, face);
        /* the vertex is in the middle of the whole quad's edge: there is nothing else around it */
        if ((from.flags & SLV_FACE_SUBFACE) && !(to.flags & SLV_FACE_SUBFACE) &&
            to.adjacency.face[arrived] == previous)
            return WALK_CLOSED;
        previous = face;
        from = to;
        edge = (arrived + 1) % s->nedges;
    }
    return WALK_CLOSED;
}

/* Around the same vertex the other way, leaving over the edge before. */
static enum walk walk_counter_clockwise(const struct surroundings *s, uint32_t start,
                                        unsigned edge) {
    slv_ptx_face from = face_at(s, (int32_t)start);
    edge = (edge + s->nedges - 1) % s->nedges;
    for (int step = 0; step < MAX_STEPS; step++) {
        int32_t face = from.adjacency.face[edge];
        unsigned arrived = from.adjacency.edge[edge];
        if (face < 0)
            return WALK_BOUNDARY;
        if (!(from.flags & SLV_FACE_SUBFACE) && (face_at(s, face).flags & SLV_FACE_SUBFACE)) {
            /* the record names the sub-face at the edge's start; the one at its end touches the
             * vertex */
            slv_face_adjacency primary = face_at(s, face).adjacency;
            unsigned across = slvi_edge_before(arrived);
            face = primary.face[across];
            arrived = slvi_edge_before(primary.edge[across]);
            if (face < 0)
                return WALK_BOUNDARY;
        }
        if (face == (int32_t)start)
            return WALK_CLOSED;
        if (!same_value(s, start, face))
            return WALK_DIFFERENT;
        from = face_at(s, face);
        edge = (arrived + s->nedges - 1) % s->nedges;
    }
    return WALK_CLOSED;
}

void slvi_ptx_flag_neighbourhoods(uint8_t *records, uint32_t nfaces, const uint8_t *constants,
                                  size_t pixel_size, slv_ptx_mesh_type mesh_type,
                                  bool borders_clamp) {
    unsigned nedges = mesh_type == SLV_PTX_TRIANGLE ? 3 : 4;
    struct surroundings s = {records, constants, pixel_size, nedges, borders_clamp};
    for (uint32_t face = 0; face < nfaces; face++) {
        bool constant = records[(size_t)face * PTX_FACE_INFO_SIZE + 3] & SLV_FACE_CONSTANT;
        for (unsigned edge = 0; constant && edge < nedges; edge++) {
            enum walk walk = walk_clockwise(&s, face, edge);
            if (walk == WALK_BOUNDARY)
                walk = s.borders_clamp ? walk_counter_clockwise(&s, face, edge) : WALK_DIFFERENT;
            constant = walk != WALK_DIFFERENT;
        }
        if (constant)
            records[(size_t)face * PTX_FACE_INFO_SIZE + 3] |= SLV_FACE_NEIGHBOURS_CONSTANT;
    }
}
