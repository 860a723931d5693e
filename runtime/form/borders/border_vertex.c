/* The value of a vertex that all faces around it agree on. */
#include "form/borders/border_data.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* Which level of each face around a vertex takes part in its value. Every face has an offset, in
 * half levels, such that levels at equal offset - 2 level meet. Offsets follow the edges, so that
 * texels of one length along a shared edge meet; where unequal shapes make that contradict itself
 * once around the vertex, they are the faces' densities. */
typedef struct ring_levels {
    slv_ring ring;
    uint32_t
        stride; /* above 1 around the pole of very many faces: every stride-th stands for all */
    bool alike; /* squares of one resolution all around, of which one offset is all that there is */
    bool by_edges;
    int32_t meeting;    /* offset - 2 level of the levels that meet */
    int32_t own, least; /* the offset of the face that asks, and the least of all */
    int32_t quad;       /* the face whose edge this vertex is the middle of, or SLV_BOUNDARY */
    uint32_t quad_edge;
    bool quad_meets_first, quad_meets_last;
    int32_t quad_offset;
    uint32_t position; /* of the face that asks */
} ring_levels;

#define MOST_AROUND 256

static slv_res res_of(const slv_border_view *view, int32_t face) {
    return view->levels->res[face];
}

static int32_t density(const slv_border_view *view, int32_t face) {
    slv_res res = res_of(view, face);
    int side = res.u > res.v ? res.u : res.v; /* even levels of one density have it along both */
    return (view->levels->even ? 2 * side : res.u + res.v) +
           (slv_adjacency_is_subface(view->adjacency, face) ? 2 : 0);
}

/* What to add to one face's offset for that of the next across a shared edge. */
static int32_t offset_step(const slv_border_view *view, int32_t from, uint32_t from_edge,
                           int32_t to, uint32_t to_edge) {
    int32_t halvings = (int32_t)slv_adjacency_is_subface(view->adjacency, to) -
                       (int32_t)slv_adjacency_is_subface(view->adjacency, from);
    return 2 * (slvi_res_along(res_of(view, to), to_edge) + halvings -
                slvi_res_along(res_of(view, from), from_edge));
}

/* The offset of member i from that of the one before; i = count goes once around. */
static int32_t next_offset(const slv_border_view *view, const ring_levels *levels, uint32_t i,
                           int32_t offset) {
    const slv_corner *from = &levels->ring.corners[i - 1];
    const slv_corner *to = &levels->ring.corners[i == levels->ring.count ? 0 : i];
    if (levels->alike)
        return offset;
    if (!levels->by_edges)
        return density(view, to->face);
    return offset +
           offset_step(view, from->face, slvi_edge_before(from->corner), to->face, to->corner);
}

static int32_t first_offset(const slv_border_view *view, const ring_levels *levels) {
    return levels->by_edges ? 0 : density(view, levels->ring.corners[0].face);
}

static void find_quad(const slv_border_view *view, ring_levels *levels) {
    slv_neighbour across[2];
    const slv_corner *first = &levels->ring.corners[0];
    const slv_corner *last = &levels->ring.corners[levels->ring.count - 1];
    uint32_t edges[2] = {first->corner, slvi_edge_before(last->corner)};
    const slv_corner *ends[2] = {first, last};
    bool meets[2] = {false, false};
    for (uint32_t i = 0; i < 2; i++) {
        if (!slv_adjacency_neighbours(view->adjacency, ends[i]->face, edges[i], across) ||
            slvi_neighbour_halvings(&across[0]) >= 0)
            continue;
        if (levels->quad == SLV_BOUNDARY) {
            levels->quad = across[0].face;
            levels->quad_edge = across[0].edge;
        }
        meets[i] = levels->quad == across[0].face && levels->quad_edge == across[0].edge;
    }
    levels->quad_meets_first = meets[0];
    levels->quad_meets_last = meets[1];
}

/* The quad's offset; by edges if both ends of the ring agree on it. */
static bool place_quad(const slv_border_view *view, ring_levels *levels, int32_t last_offset) {
    const slv_corner *first = &levels->ring.corners[0];
    const slv_corner *last = &levels->ring.corners[levels->ring.count - 1];
    int32_t offsets[2] = {
        offset_step(view, first->face, first->corner, levels->quad, levels->quad_edge),
        last_offset + offset_step(view, last->face, slvi_edge_before(last->corner), levels->quad,
                                  levels->quad_edge)};
    levels->quad_offset = offsets[levels->quad_meets_first ? 0 : 1];
    return offsets[0] == offsets[1] || !levels->quad_meets_first || !levels->quad_meets_last;
}

static bool is_alike(const slv_border_view *view, const slv_ring *ring) {
    slv_res res = res_of(view, ring->corners[0].face);
    bool part = slv_adjacency_is_subface(view->adjacency, ring->corners[0].face);
    bool same = res.u == res.v;
    for (uint32_t i = 1; same && i < ring->count; i++) {
        slv_res other = res_of(view, ring->corners[i].face);
        same = other.u == res.u && other.v == res.u &&
               slv_adjacency_is_subface(view->adjacency, ring->corners[i].face) == part;
    }
    return same;
}

static ring_levels ring_levels_at(const slv_border_view *view, uint32_t face, uint32_t level,
                                  uint32_t corner, uint32_t *position) {
    ring_levels out = {.by_edges = !view->levels->even, .quad = SLV_BOUNDARY};
    out.ring = slv_adjacency_ring(view->adjacency, (int32_t)face, corner, position);
    out.position = *position;
    out.stride = (out.ring.count + MOST_AROUND - 1) / MOST_AROUND;
    if (out.stride > 1) {
        int32_t own = density(view, (int32_t)face) - 2 * (int32_t)level;
        out.by_edges = false;
        out.meeting = own;
        for (uint32_t i = 0; i < out.ring.count; i += out.stride) {
            int32_t offset = density(view, out.ring.corners[i].face);
            out.meeting = offset < out.meeting ? offset : out.meeting;
        }
        return out;
    }
    if (!out.ring.closed && slv_adjacency_is_t_corner(view->adjacency, (int32_t)face, corner))
        find_quad(view, &out);
    out.alike = out.quad == SLV_BOUNDARY && is_alike(view, &out.ring);
    if (out.alike) {
        out.own = out.least = first_offset(view, &out);
        out.meeting = out.own - 2 * (int32_t)level;
        return out;
    }
    for (;;) {
        int32_t offset = first_offset(view, &out), least = offset, own = offset;
        for (uint32_t i = 1; i < out.ring.count; i++) {
            offset = next_offset(view, &out, i, offset);
            least = offset < least ? offset : least;
            own = i == *position ? offset : own;
        }
        bool fits = !out.ring.closed || next_offset(view, &out, out.ring.count, offset) == 0;
        if (out.quad != SLV_BOUNDARY) {
            fits = place_quad(view, &out, offset) && fits;
            if (!out.by_edges)
                out.quad_offset = density(view, out.quad);
            least = out.quad_offset < least ? out.quad_offset : least;
        }
        out.own = own;
        out.least = least;
        own -= 2 * (int32_t)level;
        out.meeting = own < least ? own : least;
        if (fits || !out.by_edges)
            return out;
        out.by_edges = false;
    }
}

static uint32_t meeting_level(const slv_border_view *view, const ring_levels *levels, int32_t face,
                              int32_t offset) {
    uint32_t level = (uint32_t)(offset - levels->meeting + 1) / 2;
    uint32_t last = slv_res_level_count(res_of(view, face)) - 1;
    return level < last ? level : last;
}

static void fetch_corner(const slv_border_view *view, uint32_t face, uint32_t level,
                         uint32_t corner, float *out) {
    slv_res res = slvi_level_res(view->levels, face, level);
    int32_t x, y;
    slvi_res_corner_texel(res, corner, &x, &y);
    slvi_border_fetch(view, face, level, (uint32_t)x, (uint32_t)y, out);
}

/* The same of the quad, which lies across the first edge of the first sub-face and across the last
 * of the last. */
static unsigned quad_turns(const ring_levels *levels) {
    unsigned corner = levels->ring.corners[levels->position].corner;
    bool first = levels->position == 0 && levels->quad_meets_first;
    return slvi_edge_turns(first ? corner : slvi_edge_before(corner), levels->quad_edge);
}

/* The middle of a whole quad's edge: the mean of two sub-faces and the quad's texels on both sides
 * of the middle, which is also what the quad's own interpolation gives there. */
static void t_value(const slv_border_view *view, const ring_levels *levels, const double *sum,
                    float *out) {
    uint32_t quad = (uint32_t)levels->quad;
    uint32_t level = meeting_level(view, levels, levels->quad, levels->quad_offset);
    slv_border_edge edge = slvi_border_edge_at(view, quad, level, levels->quad_edge);
    uint32_t n = UINT32_C(1) << edge.exponent;
    float texel[2][SLV_BORDER_CHANNELS], across[SLV_BORDER_CHANNELS];
    unsigned turns = quad_turns(levels);
    for (uint32_t side = 0; side < 2; side++) {
        int32_t x, y;
        slvi_res_edge_texel(edge.res, edge.edge, n > 1 ? (int32_t)(n / 2 - 1 + side) : 0, 0, &x,
                            &y);
        slvi_border_fetch(view, quad, level, (uint32_t)x, (uint32_t)y, texel[side]);
        slvi_border_turn(view, turns, texel[side]);
    }
    if (n == 1) {
        slvi_border_across_two(view, &edge, across);
        slvi_border_turn(view, turns, across);
    }
    for (uint32_t c = 0; c < view->count; c++) {
        /* Where a sub-face is missing, the quad's own texel stands for it, as at any boundary. */
        double missing = (levels->quad_meets_first ? 0.0 : (double)texel[0][c]) +
                         (levels->quad_meets_last ? 0.0 : (double)texel[1][c]);
        out[c] = n == 1 ? 0.5f * (texel[0][c] + across[c])
                        : (float)(0.25 * (sum[c] + missing + texel[0][c] + texel[1][c]));
    }
}

/* Bounds on 4M that keep d = 4M - a - b - e of every face inside 0..1. */
typedef struct sum_bounds {
    float low[SLV_BORDER_CHANNELS], high[SLV_BORDER_CHANNELS];
} sum_bounds;

static void bound(const slv_border_view *view, sum_bounds *bounds, const float *before,
                  const float *at, const float *after) {
    for (uint32_t c = 0; c < view->count; c++) {
        float s = before[c] + at[c] + after[c];
        float most = view->one + s;
        bounds->low[c] = bounds->low[c] > s ? bounds->low[c] : s;
        bounds->high[c] = bounds->high[c] < most ? bounds->high[c] : most;
    }
}

/* Sums the corner texels in the ring's own order, so that every face around finds the same bits;
 * returns of how many. `bounds` may be NULL. */
static uint32_t ring_sum(const slv_border_view *view, const ring_levels *levels, double *sum,
                         sum_bounds *bounds) {
    const slv_ring *ring = &levels->ring;
    float head[2][SLV_BORDER_CHANNELS], window[3][SLV_BORDER_CHANNELS];
    size_t size = sizeof window[0];
    int32_t offset = first_offset(view, levels);
    uint32_t members = 0;
    for (uint32_t i = 0; i < ring->count; i += levels->stride, members++) {
        slv_corner member = ring->corners[i];
        if (i)
            offset = next_offset(view, levels, i, offset);
        memcpy(window[0], window[1], i > 1 ? size : 0);
        memcpy(window[1], window[2], i > 0 ? size : 0);
        fetch_corner(view, (uint32_t)member.face, meeting_level(view, levels, member.face, offset),
                     member.corner, window[2]);
        slvi_border_turn(view, slvi_ring_turns(ring, levels->position, i), window[2]);
        for (uint32_t c = 0; c < view->count; c++)
            sum[c] += window[2][c];
        if (i < 2)
            memcpy(head[i], window[2], size);
        if (i >= 2 && bounds)
            bound(view, bounds, window[0], window[1], window[2]);
    }
    if (!bounds)
        return members;
    /* The first and the last member: neighbours of each other, or with a boundary on one side. */
    const float *first = head[0], *last = window[2];
    const float *second = ring->count > 1 ? head[1] : first;
    const float *before_last = ring->count > 1 ? window[1] : last;
    bound(view, bounds, ring->closed ? last : first, first, second);
    bound(view, bounds, before_last, last, ring->closed ? first : last);
    return members;
}

/* The texel diagonally across a vertex of four faces whose levels meet texel to texel. */
static bool find_opposite(const slv_border_view *view, const ring_levels *levels, uint32_t level,
                          uint32_t position, float *out) {
    uint32_t at[4];
    if (levels->ring.count != 4 || !levels->ring.closed)
        return false;
    int32_t offset = first_offset(view, levels);
    for (uint32_t i = 0; i < 4; i++) {
        if (i)
            offset = next_offset(view, levels, i, offset);
        at[i] = meeting_level(view, levels, levels->ring.corners[i].face, offset);
    }
    const slv_corner *own = &levels->ring.corners[position];
    uint32_t before = at[(position + 3) % 4], after = at[(position + 1) % 4];
    slv_border_edge starts = slvi_border_edge_at(view, (uint32_t)own->face, level, own->corner);
    slv_border_edge ends =
        slvi_border_edge_at(view, (uint32_t)own->face, level, slvi_edge_before(own->corner));
    if (at[position] != level || !starts.nlinks || !ends.nlinks)
        return false;
    const slv_border_link *to_before = &starts.links[0], *to_after = &ends.links[ends.nlinks - 1];
    if (to_before->relation != SLV_BORDER_EXACT || to_before->level != before ||
        to_before->own != level || to_after->relation != SLV_BORDER_EXACT ||
        to_after->level != after || to_after->own != level)
        return false;
    uint32_t across = (position + 2) % 4;
    const slv_corner *opposite = &levels->ring.corners[across];
    fetch_corner(view, (uint32_t)opposite->face, at[across], opposite->corner, out);
    slvi_border_turn(view, slvi_ring_turns(&levels->ring, position, across), out);
    return true;
}

bool slvi_border_vertex_value(const slv_border_view *view, uint32_t face, uint32_t level,
                              uint32_t corner, float *out, float *opposite) {
    uint32_t position = 0;
    ring_levels levels = ring_levels_at(view, face, level, corner, &position);
    double sum[SLV_BORDER_CHANNELS] = {0};
    sum_bounds bounds;
    for (uint32_t c = 0; c < view->count; c++) {
        bounds.low[c] = 0.0f;
        bounds.high[c] = 4.0f * view->one;
    }
    slv_type type = view->levels->desc.type;
    bool whole = (type == SLV_TYPE_U8 || type == SLV_TYPE_U16) && !view->levels->vectors;
    uint32_t members = ring_sum(view, &levels, sum, whole && levels.stride == 1 ? &bounds : NULL);
    if (levels.quad != SLV_BOUNDARY) {
        t_value(view, &levels, sum, out);
        return false;
    }
    for (uint32_t c = 0; c < view->count; c++) {
        out[c] = (float)(sum[c] / members);
        if (!whole)
            continue;
        /* A whole 4M makes d a whole number of texel units. */
        float quadruple = (float)floor(4.0 * sum[c] / members + 0.5);
        if (bounds.low[c] <= bounds.high[c])
            quadruple = fminf(fmaxf(quadruple, bounds.low[c]), bounds.high[c]);
        out[c] = 0.25f * quadruple;
    }
    return opposite && find_opposite(view, &levels, level, position, opposite);
}

const slv_corner *slvi_border_opposite(const slv_levels *levels, const slv_adjacency *adjacency,
                                       uint32_t face, uint32_t corner) {
    uint32_t position;
    slv_ring ring = slv_adjacency_ring(adjacency, (int32_t)face, corner, &position);
    slv_res own = levels->res[face];
    bool part = slv_adjacency_is_subface(adjacency, (int32_t)face);
    if (!ring.closed || ring.count != 4 || own.u != own.v || levels->vectors)
        return NULL;
    for (uint32_t i = 1; i < 4; i++) {
        int32_t other = ring.corners[(position + i) & 3].face;
        slv_res res = levels->res[other];
        if (res.u != own.u || res.v != own.u || slv_adjacency_is_subface(adjacency, other) != part)
            return NULL;
    }
    return &ring.corners[(position + 2) & 3];
}

bool slvi_border_vertex_fits(const slv_border_view *view, uint32_t face, uint32_t corner) {
    uint32_t position;
    return ring_levels_at(view, face, 0, corner, &position).by_edges;
}

bool slvi_border_quad_past(const slv_border_view *view, uint32_t face, uint32_t corner,
                           uint32_t *quad, uint32_t *edge, unsigned *turns) {
    ring_levels levels = {.quad = SLV_BOUNDARY};
    if (!slv_adjacency_is_t_corner(view->adjacency, (int32_t)face, corner))
        return false;
    levels.ring = slv_adjacency_ring(view->adjacency, (int32_t)face, corner, &levels.position);
    find_quad(view, &levels);
    *quad = (uint32_t)levels.quad;
    *edge = levels.quad_edge;
    if (turns)
        *turns = quad_turns(&levels);
    return levels.quad != SLV_BOUNDARY;
}

void slv_border_vertex(const slv_levels *levels, const slv_adjacency *adjacency, uint32_t face,
                       uint32_t level, unsigned corner, float *out) {
    assert(face < levels->desc.nfaces && face < slv_adjacency_face_count(adjacency));
    slv_border_view view = slvi_border_view_begin(levels, adjacency);
    float value[SLV_BORDER_CHANNELS];
    while (slvi_border_view_next(&view)) {
        slvi_border_vertex_value(&view, face, level, corner % 4, value, NULL);
        for (uint32_t c = 0; c < view.count; c++)
            out[view.first + c] = value[c] / view.one;
    }
}

slv_vertex_share slv_border_vertex_share(const slv_levels *levels, const slv_adjacency *adjacency,
                                         uint32_t face, unsigned corner) {
    assert(face < levels->desc.nfaces && face < slv_adjacency_face_count(adjacency));
    slv_border_view view = slvi_border_view_begin(levels, adjacency);
    uint32_t position = 0;
    ring_levels ring = ring_levels_at(&view, face, 0, corner % 4, &position);
    /* vectors are another pair of numbers in each face's frame */
    if (ring.stride > 1 || levels->vectors)
        return (slv_vertex_share){.alone = true};
    uint32_t ahead = (uint32_t)(ring.own - ring.least);
    return (slv_vertex_share){.skip = ahead / 2, .half = ahead & 1};
}
