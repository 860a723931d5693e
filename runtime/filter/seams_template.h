/* Template: kernels that reach beyond their face: cut at the edges, turned, and laid onto the
 * neighbours. The steps are those of the Ptex library, so that values agree. */
#ifndef SLV_FILTER_SEAMS_TEMPLATE_H
#define SLV_FILTER_SEAMS_TEMPLATE_H

#include "adjacency/edge.h"
#include "filter/gather_template.h"

enum { SEAM_BOTTOM = 0, SEAM_RIGHT = 1, SEAM_TOP = 2, SEAM_LEFT = 3 };

/* Sub-faces pass kernels on to sub-faces; more often than this only in files that make no sense. */
#define SEAM_MAX_DEPTH 24
/* Faces around a vertex beyond this many count as none. */
#define SEAM_MAX_RING 10

static void seam_across(lookup_state *state, uint32_t face, kernel *k);

/* Adds a piece whose first two channels are a vector in the face's own frame. */
static void seam_add_turned(lookup_state *state, int turns, const float *piece) {
    float x = piece[0], y = piece[1];
    slvi_edge_turn_vector((unsigned)turns, &x, &y);
    state->sum[0] += x;
    state->sum[1] += y;
    for (uint32_t c = 2; c < state->count; c++)
        state->sum[c] += piece[c];
}

static void seam_add_gathered(lookup_state *state, const uint8_t *texels, size_t pitch,
                              const kernel *k) {
    const cache_tables *t = state->tables;
    if (!t->tanvec || k->turns == 0 || state->count < 2) {
        gather_sum(t, texels, pitch, k, state->first, state->count, state->sum);
        return;
    }
    enum { SOME = 64 };
    for (uint32_t c = 0; c < state->count; c += SOME) {
        float piece[SOME] = {0};
        uint32_t n = state->count - c < SOME ? state->count - c : SOME;
        gather_sum(t, texels, pitch, k, state->first + c, n, piece);
        lookup_state part = *state;
        part.sum += c;
        part.count = n;
        if (c == 0)
            seam_add_turned(&part, k->turns, piece);
        else
            for (uint32_t i = 0; i < n; i++)
                part.sum[i] += piece[i];
    }
}

static void seam_tiles(lookup_state *state, uint32_t face, const kernel *k) {
    slv_res tile = slvi_cache_tile_res(state->tables, k->a[0].res, k->a[1].res);
    int log2[2] = {tile.u, tile.v}, first[2], last[2];
    for (int axis = 0; axis < 2; axis++) {
        first[axis] = k->a[axis].start >> log2[axis];
        last[axis] = (k->a[axis].start + k->a[axis].n - 1) >> log2[axis];
    }
    for (int y = first[1]; y <= last[1]; y++)
        for (int x = first[0]; x <= last[0]; x++) {
            kernel part = {.turns = k->turns};
            int at[2] = {x, y};
            for (int axis = 0; axis < 2; axis++) {
                const kernel_axis *from = &k->a[axis];
                int begin = at[axis] << log2[axis], end = (at[axis] + 1) << log2[axis];
                int skip = begin > from->start ? begin - from->start : 0;
                int stop = from->start + from->n < end ? from->n : end - from->start;
                kernel_axis_take(from, skip, stop - skip, &part.a[axis]);
                part.a[axis].start -= begin;
                part.a[axis].res = log2[axis];
            }
            uint32_t index = ((uint32_t)y << (k->a[0].res - log2[0])) + (uint32_t)x;
            const uint8_t *texels = lookup_find_tile(state, face, k->a[0].res, k->a[1].res, index);
            if (!texels)
                return;
            seam_add_gathered(state, texels, (size_t)1 << log2[0], &part);
        }
}

/* Weighs the texels of a face under a kernel that lies inside of it. */
static inline void seam_inside(lookup_state *state, uint32_t face, cache_face *f, kernel *k) {
    const cache_tables *t = state->tables;
    if (kernel_is_empty(k))
        return;
    while (k->a[0].res > f->res_u)
        kernel_axis_downsample(&k->a[0]);
    while (k->a[1].res > f->res_v)
        kernel_axis_downsample(&k->a[1]);
    int res_u = k->a[0].res, res_v = k->a[1].res;
    if ((cache_flags(f) & SLV_FACE_CONSTANT) || res_u + res_v == 0) {
        gather_add_average(state, face, f, kernel_weight(k));
        return;
    }
    if (res_u + res_v > t->whole_log2) {
        seam_tiles(state, face, k);
        return;
    }
    const uint8_t *texels = lookup_find_whole(state, face, f, res_u, res_v);
    if (texels)
        seam_add_gathered(state, texels, (size_t)1 << res_u, k);
}

/* From the frame of a whole face, moved across its edge, to that of one of two sub-faces there.
 * Says whether it is the primary one. */
static bool seam_to_subface(kernel *k, int edge) {
    for (int axis = 0; axis < 2; axis++) {
        if (k->a[axis].res == 0)
            kernel_axis_upsample(&k->a[axis]);
        k->a[axis].res--;
    }
    kernel_axis *along = &k->a[slvi_edge_along_v((unsigned)edge)];
    kernel_axis *across = &k->a[!slvi_edge_along_v((unsigned)edge)];
    bool upper = along->start >= 1 << along->res;
    if (!slvi_edge_is_far((unsigned)edge))
        across->start -= 1 << across->res;
    if (upper)
        along->start -= 1 << along->res;
    return upper != slvi_edge_is_rising((unsigned)edge);
}

static void seam_to_whole_face(kernel *k, int edge) {
    unsigned corner = slvi_edge_before((unsigned)edge);
    k->a[0].start += slvi_corner_u(corner) << k->a[0].res;
    k->a[1].start += slvi_corner_v(corner) << k->a[1].res;
    k->a[0].res++;
    k->a[1].res++;
}

/* A sub-face may be smaller than the kernel expects, and a kernel of a position outside of its face
 * may reach beyond the neighbour: cut again. So are the kernels of files that make no sense. */
static void seam_arrive(lookup_state *state, uint32_t face, kernel *k) {
    cache_face *f = lookup_face_at(state, face);
    if (is_subface(f)) {
        state->subfaces = true;
        seam_across(state, face, k);
    } else if (kernel_is_inside(k))
        seam_inside(state, face, f, k);
    else
        seam_across(state, face, k);
}

static void seam_edge(lookup_state *state, uint32_t face, const cache_face *f, int edge,
                      kernel *k) {
    if (kernel_is_empty(k))
        return;
    uint32_t to = (uint32_t)f->adjacent[edge];
    int to_edge = adjacent_edge(f, edge),
        turns = (int)slvi_edge_turns((unsigned)edge, (unsigned)to_edge);
    const cache_face *g = lookup_face_at(state, to);
    if (is_subface(g) && !is_subface(f)) {
        if (!seam_to_subface(k, edge)) {
            int side = (int)slvi_edge_before((unsigned)to_edge);
            if (g->adjacent[side] < 0) {
                state->weight -= kernel_weight(k);
                return;
            }
            to = (uint32_t)g->adjacent[side];
            to_edge = adjacent_edge(g, side);
            turns += (int)slvi_edge_turns((unsigned)side, (unsigned)to_edge);
        }
    } else if (is_subface(f) && !is_subface(g)) {
        bool primary = g->adjacent[to_edge] == (int32_t)face;
        seam_to_whole_face(k, edge - primary);
    }
    kernel_turn(k, turns);
    seam_arrive(state, to, k);
}

static void seam_place_corner(lookup_state *state, const cache_face *f, int edge, uint32_t to,
                              int to_edge, kernel *k) {
    const cache_face *g = lookup_face_at(state, to);
    if (is_subface(g) && !is_subface(f))
        seam_to_subface(k, edge + 3);
    else if (is_subface(f) && !is_subface(g))
        seam_to_whole_face(k, edge + 3);
    kernel_turn(k, (int)slvi_edge_turns((unsigned)edge, (unsigned)to_edge));
    seam_arrive(state, to, k);
}

/* Around an extraordinary vertex every face behind gets the same kernel, which is the same along
 * both axes, so that it does not matter from where they are seen. */
static void seam_ring(lookup_state *state, const cache_face *f, int edge, const uint32_t *faces,
                      const int *edges, int n, kernel *k) {
    kernel_axis *u = &k->a[0], *v = &k->a[1];
    float before = kernel_weight(k);
    kernel_turn(k, edge + 2);
    while (u->res > v->res)
        kernel_axis_downsample(u);
    while (v->res > u->res)
        kernel_axis_downsample(v);
    u->n = v->n = u->n < v->n ? u->n : v->n;
    for (int i = 0; i < u->n; i++)
        u->k[i] = v->k[i] = u->k[i] + v->k[i];
    float after = kernel_weight(k), scale = after == 0 ? 1 : before / after;
    if (scale < 1) {
        float by = scale < -1 ? -1 : scale;
        for (int i = 0; i < u->n; i++)
            u->k[i] *= by;
        after = scale < -1 ? -after : before;
    }
    for (int i = 0; i < n && !lookup_is_over(state); i++) {
        kernel copy = *k;
        seam_place_corner(state, f, 2, faces[i], edges[i], &copy);
    }
    state->weight += (float)n * after - before;
}

/* Lays a kernel onto the faces behind the vertex where `edge` begins to be left. */
static void seam_corner(lookup_state *state, uint32_t face, const cache_face *f, int edge,
                        kernel *k) {
    if (kernel_is_empty(k))
        return;
    uint32_t faces[SEAM_MAX_RING] = {0};
    int edges[SEAM_MAX_RING] = {0}, behind = 0;
    const cache_face *at = f;
    int leave = edge;
    uint32_t from = face;
    for (int i = 0; i < SEAM_MAX_RING; i++) {
        int32_t to = at->adjacent[leave];
        int arrived = adjacent_edge(at, leave), next = (int)slvi_edge_next((unsigned)arrived);
        if (to < 0 || ((uint32_t)to == face && next == edge)) {
            behind = i - 2;
            break;
        }
        const cache_face *g = lookup_face_at(state, (uint32_t)to);
        faces[i] = (uint32_t)to;
        edges[i] = next;
        if (is_subface(at) && !is_subface(g) &&
            g->adjacent[(int)slvi_edge_before((unsigned)next)] == (int32_t)from) {
            /* the vertex lies within an edge of a whole face */
            state->subfaces = true;
            bool primary = i == 1;
            seam_to_whole_face(k, edge + 2 * primary);
            kernel_turn(k, edge - next + 3 - primary);
            seam_across(state, (uint32_t)to, k);
            return;
        }
        at = g;
        leave = next;
        from = (uint32_t)to;
    }
    if (behind == 1)
        seam_place_corner(state, f, edge, faces[1], edges[1], k);
    else if (behind > 1)
        seam_ring(state, f, edge, faces + 1, edges + 1, behind, k);
    else
        state->weight -= kernel_weight(k);
}

/* The part of a kernel that crosses `side` of a face, with its corners: `above` is the edge to
 * leave over for the corner at the top, `below` for that at the bottom. The
 * parameters are many, since a caller has a case for each side, which these tell apart. */
static void seam_side(lookup_state *state, uint32_t face, const cache_face *f, int side, int above,
                      int below, bool top, bool bottom, kernel *k) {
    const cache_tables *t = state->tables;
    bool drop = t->border_v == SLV_BORDER_BLACK;
    kernel part, corner;
    if (f->adjacent[side] < 0) {
        kernel_merge(k, side, t->border_u == SLV_BORDER_BLACK);
        return;
    }
    kernel_split(k, side, &part);
    if (top && f->adjacent[SEAM_TOP] < 0)
        kernel_merge(&part, SEAM_TOP, drop);
    else if (top) {
        kernel_split(&part, SEAM_TOP, &corner);
        seam_corner(state, face, f, above, &corner);
    }
    if (lookup_is_over(state))
        return;
    if (bottom && f->adjacent[SEAM_BOTTOM] < 0)
        kernel_merge(&part, SEAM_BOTTOM, drop);
    else if (bottom) {
        kernel_split(&part, SEAM_BOTTOM, &corner);
        seam_corner(state, face, f, below, &corner);
    }
    if (!lookup_is_over(state))
        seam_edge(state, face, f, side, &part);
}

/* Cuts a kernel at the edges of a face and lays the pieces onto the faces they belong to. */
static void seam_across(lookup_state *state, uint32_t face, kernel *k) {
    const cache_tables *t = state->tables;
    cache_face *f = lookup_face_at(state, face);
    bool right = kernel_crosses(k, SEAM_RIGHT), left = kernel_crosses(k, SEAM_LEFT);
    bool top = kernel_crosses(k, SEAM_TOP), bottom = kernel_crosses(k, SEAM_BOTTOM);
    if (state->depth >= SEAM_MAX_DEPTH || lookup_is_over(state))
        return;
    state->depth++;
    if (state->sampler->no_edge_blend) {
        bool sides[4] = {bottom, right, top, left};
        for (int e = 0; e < 4; e++)
            if (sides[e] && !kernel_is_empty(k))
                kernel_merge(k, e,
                             (slvi_edge_along_v((unsigned)e) ? t->border_u : t->border_v) ==
                                 SLV_BORDER_BLACK);
    } else {
        if (right)
            seam_side(state, face, f, SEAM_RIGHT, SEAM_TOP, SEAM_RIGHT, top, bottom, k);
        if (left && !lookup_is_over(state))
            seam_side(state, face, f, SEAM_LEFT, SEAM_LEFT, SEAM_BOTTOM, top, bottom, k);
        for (int i = 0; i < 2 && !lookup_is_over(state); i++) {
            int side = i ? SEAM_BOTTOM : SEAM_TOP;
            if (!(i ? bottom : top))
                continue;
            if (f->adjacent[side] < 0)
                kernel_merge(k, side, t->border_v == SLV_BORDER_BLACK);
            else {
                kernel part;
                kernel_split(k, side, &part);
                seam_edge(state, face, f, side, &part);
            }
        }
    }
    if (!lookup_is_over(state))
        seam_inside(state, face, f, k);
    state->depth--;
}

#endif
