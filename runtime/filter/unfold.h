/* Faces unfolded into the plane of the one where a lookup lies: squares that meet at their sides,
 * each turned as it takes. The unit is half an edge of a whole face, which is the edge of a
 * sub-face, so that corners have whole numbers. Around an extraordinary vertex the plane does not
 * close: what lies behind depends on the side that the way there passes it on. */
#ifndef SLV_FILTER_UNFOLD_H
#define SLV_FILTER_UNFOLD_H

#include "adjacency/edge.h"
#include "filter/numbers.h"
#include "filter/sampler.h"

#define CELL_MAX_AROUND 64 /* faces around a vertex beyond this many are not looked at */

/* A face in the plane: its lower left corner, how long it is, and by how many quarter turns,
 * counter- clockwise, it is turned. Sides of the plane are numbered as edges are; corner k is where
 * side k begins. */
typedef struct cell {
    uint32_t face;
    int x, y;
    int size, turn;
} cell;

enum {
    CELL_AROUND_KNOWN = 1,
    CELL_AROUND_SMOOTH = 2 /* for corner 0, and three more */,
    CELL_AROUND_EVEN = 32
};

static inline cell cell_home(cache_tables *t, uint32_t face) {
    return (cell){face, 0, 0, is_subface(cache_find_face(t, face)) ? 1 : 2, 0};
}

static inline int cell_corner_x(const cell *c, int corner) {
    return c->x + (slvi_corner_u((unsigned)corner) ? c->size : 0);
}

static inline int cell_corner_y(const cell *c, int corner) {
    return c->y + (slvi_corner_v((unsigned)corner) ? c->size : 0);
}

/* Which corner of a cell a point is, or -1. */
static inline int cell_corner_at(const cell *c, int x, int y) {
    bool right = x == c->x + c->size, top = y == c->y + c->size;
    if ((!right && x != c->x) || (!top && y != c->y))
        return -1;
    return (int)slvi_corner_at(right, top);
}

/* Over a side to the next cell; `second`: over the half of the side that comes second,
 * counter-clockwise. False at a border. */
static inline bool cell_cross(cache_tables *t, const cell *from, int side, bool second, cell *out) {
    const cache_face *f = cache_find_face(t, from->face);
    int edge = (side - from->turn) & 3, along = 0;
    if (f->adjacent[edge] < 0)
        return false;
    uint32_t to = (uint32_t)f->adjacent[edge];
    int to_edge = adjacent_edge(f, edge);
    const cache_face *g = cache_find_face(t, to);
    bool rising = slvi_edge_is_rising((unsigned)side);
    if (is_subface(g) && !is_subface(f)) {
        if (second) {
            int next = (int)slvi_edge_before((unsigned)to_edge);
            if (g->adjacent[next] < 0)
                return false;
            to = (uint32_t)g->adjacent[next];
            to_edge = (int)slvi_edge_before((unsigned)adjacent_edge(g, next));
        }
        along = second == rising;
    } else if (is_subface(f) && !is_subface(g)) {
        bool primary = g->adjacent[to_edge] == (int32_t)from->face;
        along = primary == rising ? -1 : 0;
    }
    int size = is_subface(cache_find_face(t, to)) ? 1 : 2;
    cell c = {to, from->x, from->y, size, (int)slvi_edge_turns((unsigned)side, (unsigned)to_edge)};
    c.x += side == 1 ? from->size : side == 3 ? -size : along;
    c.y += side == 2 ? from->size : side == 0 ? -size : along;
    *out = c;
    return true;
}

/* To the next cell around a vertex. False at a border, or if the vertex is no corner of the cell:
 * it may lie in the middle of a whole face's edge. */
static inline bool cell_turn(cache_tables *t, cell *c, int x, int y, bool counter_clockwise) {
    int corner = cell_corner_at(c, x, y);
    return corner >= 0 &&
           cell_cross(t, c, counter_clockwise ? (int)slvi_edge_before((unsigned)corner) : corner,
                      counter_clockwise, c);
}

/* Whether straight lines pass a corner on either side to the same places: four faces meet there, or
 * two of them and the middle of a third one's edge, or the border is straight. */
static inline bool cell_find_smooth(cache_tables *t, const cell *home, int corner) {
    int x = cell_corner_x(home, corner), y = cell_corner_y(home, corner), count = 1;
    int local = (corner - home->turn) & 3;
    cell c = *home;
    for (; cell_turn(t, &c, x, y, true); count++) {
        int here = cell_corner_at(&c, x, y);
        if (here < 0)
            return c.size == 2;
        if (c.face == home->face && ((here - c.turn) & 3) == local)
            return count == 4;
        if (count > 4)
            return false;
    }
    for (c = *home; count < 3 && cell_turn(t, &c, x, y, false); count++)
        if (cell_corner_at(&c, x, y) < 0)
            return c.size == 2;
    return count < 3;
}

/* Whether faces go all the way around a corner. */
static inline bool cell_is_closed(cache_tables *t, const cell *home, int corner) {
    int x = cell_corner_x(home, corner), y = cell_corner_y(home, corner);
    cell c = *home;
    for (int i = 0; i < CELL_MAX_AROUND && cell_turn(t, &c, x, y, true); i++)
        if (c.face == home->face)
            return true;
    return false;
}

/* How long texels are along the plane's axes; at most a unit, which is the most that samples are
 * apart. */
static inline void cell_texel(cache_tables *t, const cell *c, float size[2]) {
    const cache_face *f = cache_find_face(t, c->face);
    size[c->turn & 1] = num_smaller((float)c->size * num_power_of_two(-f->res_u), 1);
    size[!(c->turn & 1)] = num_smaller((float)c->size * num_power_of_two(-f->res_v), 1);
}

/* Raises sizes to those of a cell's texels, less the distance to it. */
static inline void cell_raise(cache_tables *t, const cell *c, const float *at, float size[2]) {
    float texel[2], distance = 0;
    cell_texel(t, c, texel);
    if (at) {
        float x = num_larger(num_larger((float)c->x - at[0], at[0] - (float)(c->x + c->size)), 0);
        float y = num_larger(num_larger((float)c->y - at[1], at[1] - (float)(c->y + c->size)), 0);
        distance = x == 0 ? y : y == 0 ? x : sqrtf(x * x + y * y);
    }
    size[0] = num_larger(size[0], texel[0] - distance);
    size[1] = num_larger(size[1], texel[1] - distance);
}

static inline unsigned cell_around(cache_tables *t, uint32_t face);

static inline bool cell_is_smooth(cache_tables *t, const cell *c, int corner) {
    return (cell_around(t, c->face) & (unsigned)CELL_AROUND_SMOOTH << ((corner - c->turn) & 3)) !=
           0;
}

/* The length of texels at a place, continuous from face to face: that of the coarsest texels
 * around, less the distance to them. Around an extraordinary vertex there are no axes, so that the
 * longer side of texels counts along both. Without a place: the most that it is on the face. */
static inline void cell_coarsest(cache_tables *t, const cell *home, const float *at,
                                 unsigned smooth, float size[2]) {
    cell_texel(t, home, size);
    for (int corner = 0; corner < 4; corner++) {
        int x = cell_corner_x(home, corner), y = cell_corner_y(home, corner);
        bool flat = (smooth & (unsigned)CELL_AROUND_SMOOTH << corner) != 0;
        float longest = num_larger(size[0], size[1]), texel[2];
        if (!flat)
            cell_texel(t, home, texel), longest = num_larger(texel[0], texel[1]);
        for (int way = 0; way < 2; way++) {
            cell c = *home;
            for (int i = 0; i < (flat ? 3 : CELL_MAX_AROUND) && cell_turn(t, &c, x, y, way == 0);
                 i++) {
                /* cells further around may lie over others in the plane */
                if (flat || i == 0)
                    cell_raise(t, &c, at, size);
                cell_texel(t, &c, texel);
                longest = num_larger(longest, num_larger(texel[0], texel[1]));
                if (c.face == home->face)
                    break;
            }
        }
        if (!flat) {
            float dx = at ? at[0] - (float)x : 0, dy = at ? at[1] - (float)y : 0;
            longest -= sqrtf(dx * dx + dy * dy);
            size[0] = num_larger(size[0], longest);
            size[1] = num_larger(size[1], longest);
        }
    }
}

/* What is around a face: AROUND_... */
static inline unsigned cell_around(cache_tables *t, uint32_t face) {
    cache_face *f = cache_find_face(t, face);
    unsigned around = atomic_load_explicit(&f->around, memory_order_relaxed);
    if (around)
        return around;
    cell home = cell_home(t, face);
    float own[2], size[2];
    around = CELL_AROUND_KNOWN;
    for (int corner = 0; corner < 4; corner++)
        if (cell_find_smooth(t, &home, corner))
            around |= (unsigned)CELL_AROUND_SMOOTH << corner;
    cell_texel(t, &home, own);
    cell_coarsest(t, &home, NULL, around, size);
    if (size[0] <= own[0] && size[1] <= own[1])
        around |= CELL_AROUND_EVEN;
    /* found anew by whoever asks at the same time: it is the same */
    atomic_store_explicit(&f->around, (uint8_t)around, memory_order_relaxed);
    return around;
}

#endif
