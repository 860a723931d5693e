/* Template: a filter of our own: the footprint as an ellipse, weighted by a gaussian, wherever it
 * lies (Greene and Heckbert 1986). The samples are texels of the resolution that fits, on a lattice
 * of the surface's own; each is weighted by where it lies when the faces are unfolded along the
 * straight line to it. That is the same from whatever face one looks, so that there are no seams.
 *
 * A line that passes an extraordinary vertex on the right leads elsewhere than one that passes it
 * on the left. Close to the vertex it is taken apart and goes both ways, with weights that change
 * continuously from the one to the other. */
#ifndef SLV_FILTER_ANISOTROPIC_TEMPLATE_H
#define SLV_FILTER_ANISOTROPIC_TEMPLATE_H

#include "filter/ellipse_template.h"
#include "filter/variants.h"

#define ANISO_MOST_SOFT 0.35 /* how far from a vertex lines may pass to be taken apart */
#define ANISO_RUN 16         /* samples weighed at a time */
#define ANISO_MAX_SPLITS 5   /* vertices that take one line apart */
#define ANISO_MAX_STEPS 64   /* edges that one line crosses */
#define ANISO_SPAN 8         /* cells to each side */

/* A line from the centre to a sample. */
typedef struct aniso_line {
    float x, y, weight; /* of the sample */
    int nseen;
    int seen[ANISO_MAX_SPLITS][2]; /* vertices that it was taken apart at */
} aniso_line;

/* What could not be found is black, or does not count. */
static void aniso_lose(ellipse_job *j, bool black, float weight) {
    if (black)
        j->state->weight += weight;
}

static bool aniso_is_black(const cache_tables *t, const cell *c, int side) {
    return ((side - c->turn) & 1 ? t->border_u : t->border_v) == SLV_BORDER_BLACK;
}

/* How a line from the centre passes a vertex: 1 on its right, -1 on its left, and between the two
 * when it is close. Lines are never taken apart where they turn by a right angle at the vertex:
 * what is on one face stays there. */
static float aniso_passing(const ellipse_job *j, const aniso_line *to, int x, int y) {
    float dx = to->x - j->e.x, dy = to->y - j->e.y, length = sqrtf(dx * dx + dy * dy);
    float vx = (float)x - j->e.x, vy = (float)y - j->e.y;
    float before = (vx * dx + vy * dy) / length, behind = length - before;
    float aside = (dx * vy - dy * vx) / length;
    float width = num_smaller(j->soft, 0.5f * num_smaller(before, behind));
    return !(width > 0) ? 2 : num_larger(num_smaller(aside / width, 1), -1);
}

/* The vertex, among the corners of a cell, that a line is taken apart at first. */
static bool aniso_find_split(ellipse_job *j, const cell *c, aniso_line *to, int *corner,
                             float *side) {
    float nearest = INFINITY;
    for (int k = 0; k < 4; k++) {
        int x = cell_corner_x(c, k), y = cell_corner_y(c, k);
        float s = aniso_passing(j, to, x, y);
        if (!(s > -1 && s < 1))
            continue;
        bool seen = false;
        for (int i = 0; i < to->nseen; i++)
            seen |= to->seen[i][0] == x && to->seen[i][1] == y;
        float dx = (float)x - j->e.x, dy = (float)y - j->e.y, distance = dx * dx + dy * dy;
        if (seen || distance >= nearest || cell_is_smooth(j->state->tables, c, k))
            continue;
        nearest = distance;
        *corner = k;
        *side = s;
    }
    return nearest < INFINITY;
}

/* Goes on along a line, from a place in a cell or on its edge, to the sample. Where it is taken
 * apart at a vertex both parts go around it and on. */
static void aniso_follow(ellipse_job *j, cell c, float x, float y, const aniso_line *line_to) {
    cache_tables *t = j->state->tables;
    aniso_line to = *line_to;
    for (int step = 0; step < ANISO_MAX_STEPS && !lookup_is_over(j->state); step++) {
        int corner = 0;
        float passed = 0;
        if (to.nseen < ANISO_MAX_SPLITS && aniso_find_split(j, &c, &to, &corner, &passed)) {
            int vx = cell_corner_x(&c, corner), vy = cell_corner_y(&c, corner);
            bool right = to.x > (float)vx, top = to.y > (float)vy;
            /* the corner there, of its cell */
            int target = (int)slvi_edge_opposite(slvi_corner_at(right, top));
            float weight = to.weight;
            to.seen[to.nseen][0] = vx;
            to.seen[to.nseen++][1] = vy;
            /* next to a border there may be nothing on the other side: what is seen past it fades
             */
            bool closed = cell_is_closed(t, &c, corner);
            float shares[2] = {closed ? 0.5f * (1 + passed) : num_larger(passed, 0),
                               closed ? 0.5f * (1 - passed) : num_larger(-passed, 0)};
            aniso_lose(j, aniso_is_black(t, &c, corner), weight * (1 - shares[0] - shares[1]));
            for (int way = 0; way < 2 && !lookup_is_over(j->state); way++) {
                /* a vertex on the left is gone around counter-clockwise */
                int turns = (way == 0 ? target - corner : corner - target) & 3, side = 0;
                cell at = c;
                bool there = true;
                to.weight = weight * shares[way];
                if (to.weight == 0)
                    continue;
                for (int i = 0; i < turns && there; i++) {
                    int here = cell_corner_at(&at, vx, vy);
                    side = way == 0 ? (int)slvi_edge_before((unsigned)here) : here;
                    there = here >= 0 && cell_cross(t, &at, side, way == 0, &at);
                }
                if (there)
                    aniso_follow(j, at, (float)vx, (float)vy, &to);
                else
                    aniso_lose(j, aniso_is_black(t, &at, side), to.weight);
            }
            return;
        }
        float dx = to.x - x, dy = to.y - y, most = 1;
        float left = (float)c.x, right = (float)(c.x + c.size);
        float bottom = (float)c.y, top = (float)(c.y + c.size);
        int side = -1;
        if (to.x > right)
            most = (right - x) / dx, side = 1;
        else if (to.x < left)
            most = (left - x) / dx, side = 3;
        if (to.y > top && (side < 0 || (top - y) / dy < most))
            most = (top - y) / dy, side = 2;
        else if (to.y < bottom && (side < 0 || (bottom - y) / dy < most))
            most = (bottom - y) / dy, side = 0;
        if (side < 0) {
            ellipse_add_sample(j, &c, to.x, to.y, to.weight);
            return;
        }
        x = side == 1   ? right
            : side == 3 ? left
                        : num_smaller(num_larger(x + dx * most, left), right);
        y = side == 2   ? top
            : side == 0 ? bottom
                        : num_smaller(num_larger(y + dy * most, bottom), top);
        float along = side & 1 ? y - bottom : x - left;
        bool upper = along > 0.5f * (float)c.size;
        if (!cell_cross(t, &c, side, upper == (side < 2), &c)) {
            aniso_lose(j, aniso_is_black(t, &c, side), to.weight);
            return;
        }
    }
}

enum { ANISO_THERE, ANISO_LINES, ANISO_LOST, ANISO_BLACK };

/* The weights of a row of samples, which are 2^-((a du + b) du + c) times a scale. Returns their
 * sum.
 */
static inline float aniso_weigh_run(float a, float b, float c, float first, float step, float scale,
                                    int n, float *weights) {
    const v8f each = {0.5f, 1.5f, 2.5f, 3.5f, 4.5f, 5.5f, 6.5f, 7.5f};
    float sum = 0;
    for (int i = 0; i < n; i += 8) {
        v8f du = (each + (float)i) * step + first;
        v8f w = v8_exp2(-((a * du + b) * du + c)) - ELLIPSE_AT_REACH;
        w = v8_select(w > 0, w * scale, v8_splat(0));
        memcpy(weights + i, &w, sizeof w);
    }
    for (int i = 0; i < n; i++)
        sum += weights[i];
    return sum;
}

/* Sums up the samples of a cell: from the face that is there, by a line to each, or as what lies
 * beyond a border. */
static __attribute__((noinline)) void aniso_sum_cell(ellipse_job *j, const cell *c, int kind) {
    lookup_state *state = j->state;
    const cache_tables *t = state->tables;
    const ellipse *e = &j->e;
    cache_face *f = cache_find_face(state->tables, c->face);
    bool turned = c->turn & 1;
    int log2_u = e->log2[turned], log2_v = e->log2[!turned], res_u, res_v;
    int size_u = c->size << log2_u, size_v = c->size << log2_v, low, high;
    float unit_u = num_power_of_two(log2_u), unit_v = num_power_of_two(log2_v), u, v;
    float step_u = num_power_of_two(-log2_u), step_v = num_power_of_two(-log2_v);
    float uu = turned ? e->yy : e->xx, vv = turned ? e->xx : e->yy, uv = turned ? -e->xy : e->xy;
    float slope = -uv / uu, widest = ELLIPSE_REACH_LOG2 / uu, narrowing = (vv + uv * slope) / uu;
    const uint8_t *texels = NULL;
    ellipse_to_local(c, e->x, e->y, &u, &v);
    ellipse_sample_res(e, c, f, &res_u, &res_v);
    int shift_u = log2_u + (c->size == 2) - res_u, shift_v = log2_v + (c->size == 2) - res_v;
    bool constant = (cache_flags(f) & SLV_FACE_CONSTANT) || res_u + res_v == 0;
    bool direct = j->few && res_u + res_v <= t->whole_log2;
    float reach = e->reach[!turned], total = 0;
    low = num_ceil(num_larger((v - reach) * unit_v - 0.5f, 0));
    high = num_floor(num_smaller((v + reach) * unit_v - 0.5f, (float)(size_v - 1)));
    for (int y = low; y <= high && !lookup_is_over(state); y++) {
        float dv = ((float)y + 0.5f) * step_v - v, middle = slope * dv;
        float rest = widest - narrowing * dv * dv;
        if (!(rest > 0))
            continue;
        float half = sqrtf(rest);
        int x0 = num_ceil(num_larger((u + middle - half) * unit_u - 0.5f, 0));
        int x1 = num_floor(num_smaller((u + middle + half) * unit_u - 0.5f, (float)(size_u - 1)));
        for (; x0 <= x1 && !lookup_is_over(state); x0 += ANISO_RUN) {
            int n = x1 - x0 + 1 < ANISO_RUN ? x1 - x0 + 1 : ANISO_RUN;
            float weights[ANISO_RUN], at_x0 = (float)x0 * step_u - u;
            float sum =
                aniso_weigh_run(uu, 2 * uv * dv, vv * dv * dv, at_x0, step_u, j->scale, n, weights);
            if (kind == ANISO_LINES) {
                for (int i = 0; i < n && !lookup_is_over(state); i++) {
                    aniso_line to = {.x = (float)c->x + ((float)(x0 + i) + 0.5f) * step_u,
                                     .y = (float)c->y + ((float)y + 0.5f) * step_v,
                                     .weight = weights[i]};
                    if (to.weight > 0)
                        aniso_follow(j, (cell){c->face, 0, 0, c->size, 0}, e->x, e->y, &to);
                }
                continue;
            }
            total += sum;
            if (kind == ANISO_BLACK || j->weigh || constant)
                continue;
            int from = x0 >> shift_u, count = ((x0 + n - 1) >> shift_u) - from + 1;
            if (shift_u) {
                float coarse[ANISO_RUN] = {0};
                for (int i = 0; i < n; i++)
                    coarse[((x0 + i) >> shift_u) - from] += weights[i];
                memcpy(weights, coarse, sizeof weights);
            }
            if (!direct) {
                ellipse_add_turned_run(j, c, f, res_u, res_v, from, y >> shift_v, count, weights);
                continue;
            }
            if (!texels)
                texels = ellipse_find_texels(j, c->face, f, res_u, res_v, 0, true);
            if (!texels)
                return;
            size_t at = ((size_t)(y >> shift_v) << res_u) + (size_t)from;
            ellipse_add_few(t, texels + at * t->pixel_size, count, weights, j->sums);
        }
    }
    if (kind != ANISO_LINES)
        state->weight += total;
    if (kind == ANISO_THERE && constant && !j->weigh && total > 0)
        gather_add_average(state, c->face, f, total);
}

typedef struct aniso_patch {
    cell c;
    int kind;
} aniso_patch;

/* The patch next to one, over a side of it. `smooth`: whether lines on their way pass nothing that
 * takes them apart. */
static void aniso_next_patch(ellipse_job *j, const aniso_patch *from, int side, bool smooth,
                             bool may_end, bool may_go_on, aniso_patch *out) {
    cache_tables *t = j->state->tables;
    if (from->kind != ANISO_THERE) {
        out->kind = from->kind;
        return;
    }
    bool there = !j->stay && cell_cross(t, &from->c, side, false, &out->c);
    if (smooth && !there && may_end)
        out->kind = aniso_is_black(t, &from->c, side) ? ANISO_BLACK : ANISO_LOST;
    else if (smooth && there && may_go_on && out->c.size == from->c.size)
        out->kind = ANISO_THERE;
}

/* The face of the lookup and, as far as the ellipse reaches, those around it. Squares of the plane
 * that straight lines reach without passing an extraordinary vertex, over faces of one size, are
 * summed up whole. */
static void aniso_sum_plane(ellipse_job *j, const cell *home) {
    cache_tables *t = j->state->tables;
    const ellipse *e = &j->e;
    float size = (float)home->size;
    int low[2], high[2];
    const float at[2] = {e->x, e->y};
    for (int axis = 0; axis < 2; axis++) {
        low[axis] = num_floor((at[axis] - e->reach[axis]) / size);
        high[axis] = num_floor((at[axis] + e->reach[axis]) / size);
        low[axis] = low[axis] < -ANISO_SPAN ? -ANISO_SPAN : low[axis] > 0 ? 0 : low[axis];
        high[axis] = high[axis] > ANISO_SPAN ? ANISO_SPAN : high[axis] < 0 ? 0 : high[axis];
    }
    aniso_sum_cell(j, home, ANISO_THERE);
    if (!(low[0] | low[1] | high[0] | high[1]))
        return;
    aniso_patch plane[2 * ANISO_SPAN + 1][2 * ANISO_SPAN + 1];
    plane[ANISO_SPAN][ANISO_SPAN] = (aniso_patch){*home, ANISO_THERE};
    for (int row = 0; row <= high[1] - low[1]; row++) {
        int y = row <= high[1] ? row : high[1] - row, up = y > 0;
        for (int column = 0; column <= high[0] - low[0] && !lookup_is_over(j->state); column++) {
            int x = column <= high[0] ? column : high[0] - column, right = x > 0;
            aniso_patch *p = &plane[ANISO_SPAN + y][ANISO_SPAN + x];
            const aniso_patch *across = x ? p - (right ? 1 : -1) : p;
            const aniso_patch *below =
                y ? &plane[ANISO_SPAN + y - (up ? 1 : -1)][ANISO_SPAN + x] : p;
            int side = x ? right ? 1 : 3 : up ? 2 : 0;
            if (!x && !y)
                continue;
            *p = (aniso_patch){*home, ANISO_LINES};
            if (!x || !y) {
                const aniso_patch *from = x ? across : below;
                bool smooth =
                    from->kind == ANISO_THERE &&
                    (j->stay || (cell_is_smooth(t, &from->c, side) &&
                                 cell_is_smooth(t, &from->c, (int)slvi_edge_next((unsigned)side))));
                aniso_next_patch(j, from, side, smooth, true, true, p);
            } else if (across->kind != ANISO_THERE && below->kind != ANISO_THERE) {
                p->kind = below->kind == ANISO_LINES ? ANISO_LINES : across->kind;
            } else if (across->kind != ANISO_LINES && below->kind != ANISO_LINES) {
                bool both = across->kind == below->kind, from_across = across->kind == ANISO_THERE;
                const aniso_patch *from = from_across ? across : below;
                side = from_across ? right ? 1 : 3 : up ? 2 : 0;
                /* the corner that lies towards the centre */
                int corner =
                    cell_corner_at(&from->c, (x + !right) * home->size, (y + !up) * home->size);
                bool smooth = j->stay || cell_is_smooth(t, &from->c, corner);
                aniso_next_patch(j, from, side, smooth, !both, both, p);
            }
            cell c = p->kind == ANISO_THERE
                         ? p->c
                         : (cell){home->face, x * home->size, y * home->size, home->size, 0};
            if (p->kind != ANISO_LOST)
                aniso_sum_cell(j, &c, p->kind);
        }
    }
}

/* Near an extraordinary vertex directions cease to mean anything. So the ellipse gives way to a
 * circle around the vertex, which looks the same from all its faces. */
static int aniso_find_ring(cache_tables *t, const cell *home, int x, int y,
                           cell ring[CELL_MAX_AROUND]) {
    int count = 1;
    ring[0] = *home;
    for (int way = 0; way < 2; way++) {
        cell c = *home;
        while (count < CELL_MAX_AROUND && cell_turn(t, &c, x, y, way == 0)) {
            if (c.face == home->face)
                return count;
            ring[count++] = c;
        }
    }
    return count;
}

/* Sums up an ellipse around a place: in the plane, or, if there is a ring, in each of its faces. */
static void aniso_sum_ellipse(ellipse_job *j, const ellipse_wanted *w, float x, float y,
                              const cell *faces, int nring, float scale) {
    int log2[2][2], count[2];
    float share[2][2];
    for (int axis = 0; axis < 2; axis++)
        count[axis] = ellipse_find_lattices(w, axis, log2[axis], share[axis]);
    for (int i = 0; i < count[1]; i++)
        for (int k = 0; k < count[0] && !lookup_is_over(j->state); k++) {
            float all = ellipse_find(x, y, w, log2[0][k], log2[1][i], &j->e);
            j->scale = scale * share[0][k] * share[1][i] / all;
            if (!nring)
                aniso_sum_plane(j, faces);
            for (int f = 0; f < nring && !lookup_is_over(j->state); f++)
                aniso_sum_cell(j, &faces[f], ANISO_THERE);
        }
}

/* Gives a circle around a vertex its part in a lookup. */
static void aniso_blend_vertex(ellipse_job *j, const cell *home, int corner, ellipse_wanted w,
                               float part) {
    lookup_state *state = j->state;
    int x = cell_corner_x(home, corner), y = cell_corner_y(home, corner);
    float before = part < 1 && state->weight > 0 ? (1 - part) / state->weight : 0;
    cell ring[CELL_MAX_AROUND];
    int count = aniso_find_ring(state->tables, home, x, y, ring);
    w.xx = w.yy = 0.5 * (w.xx + w.yy);
    w.xy = 0;
    w.across[0] = w.across[1] = w.mean;
    w.texel[0] = w.texel[1] = num_larger(w.texel[0], w.texel[1]);
    for (uint32_t c = 0; c < state->count; c++)
        state->sum[c] *= before;
    state->weight = 0;
    j->weigh = true;
    aniso_sum_ellipse(j, &w, (float)x, (float)y, ring, count, 1);
    j->weigh = false;
    aniso_sum_ellipse(j, &w, (float)x, (float)y, ring, count,
                      state->weight > 0 ? part / state->weight : 0);
    state->weight = 1;
}

/* A coordinate of the lookup on its face. False if it lies so far outside that all is black.
 * Outside of a black border it stays there, and sees of the face what reaches it. */
static bool aniso_to_plane(ellipse_job *j, const cache_face *f, slv_border_mode mode, int low_edge,
                           int size, float x, float *out) {
    if (mode == SLV_BORDER_PERIODIC)
        x -= floorf(x);
    float inside = x > 0 ? x < 1 ? x : 1 : 0;
    if (mode == SLV_BORDER_BLACK && x != inside) {
        int edge = x < 0 ? low_edge : (int)slvi_edge_opposite((unsigned)low_edge);
        if (!(x > -1 && x < 2))
            return false;
        if (j->stay || f->adjacent[edge] < 0) {
            j->stay = true;
            inside = x;
        }
    }
    *out = inside * (float)size;
    return true;
}

void SLVI_VARIANT(slvi_anisotropic_sum)(lookup_state *state, const slv_lookup *l) {
    cache_tables *t = state->tables;
    const cache_face *f = cache_find_face(t, l->face);
    const slv_sampler *s = state->sampler;
    cell home = cell_home(t, l->face);
    unsigned around = cell_around(t, l->face);
    float at[2], texel[2];
    ellipse_wanted w;
    ellipse_job j = {.state = state,
                     .scale = 1,
                     .stay = s->no_edge_blend,
                     .few = t->nchannels <= 4 && !t->tanvec};
    if (!aniso_to_plane(&j, f, t->border_u, 3, home.size, l->u, &at[0]) ||
        !aniso_to_plane(&j, f, t->border_v, 0, home.size, l->v, &at[1])) {
        state->weight = 1;
        return;
    }
    if (j.stay || (around & CELL_AROUND_EVEN))
        cell_texel(t, &home, texel);
    else
        cell_coarsest(t, &home, at, around, texel);
    ellipse_find_wanted(s, l, home.size, texel, &w);
    j.soft = num_smaller(w.soft, ANISO_MOST_SOFT);
    float part = 0;
    int corner = 0;
    for (int k = 0; k < 4 && !j.stay; k++) {
        float dx = (float)cell_corner_x(&home, k) - at[0];
        float dy = (float)cell_corner_y(&home, k) - at[1], near = sqrtf(dx * dx + dy * dy) / j.soft;
        if (near < 1 && !(around & (unsigned)CELL_AROUND_SMOOTH << k)) {
            part = (1 - near) * (1 - near) * (1 + 2 * near);
            corner = k;
        }
    }
    if (part < 1)
        aniso_sum_ellipse(&j, &w, at[0], at[1], &home, 0, 1);
    if (lookup_is_over(state))
        return;
    ellipse_settle(&j);
    if (part > 0)
        aniso_blend_vertex(&j, &home, corner, w, part);
    if (!lookup_is_over(state))
        ellipse_settle(&j);
}

#endif
