/* A filter of our own: the footprint as an ellipse, weighted by a gaussian, wherever it lies
 * (Greene and Heckbert 1986). The samples are texels of the resolution that fits, on a lattice of
 * the surface's own; each is weighted by where it lies when the faces are unfolded along the
 * straight line to it. That is the same from whatever face one looks, so that there are no seams.
 *
 * A line that passes an extraordinary vertex on the right leads elsewhere than one that passes it
 * on the left. Close to the vertex it is taken apart and goes both ways, with weights that change
 * continuously from the one to the other. */
#include "filter/anisotropic.h"

#define MOST_SOFT 0.35 /* how far from a vertex lines may pass to be taken apart */
#define RUN 16         /* samples weighed at a time */
#define MAX_SPLITS 5   /* vertices that take one line apart */
#define MAX_STEPS 64   /* edges that one line crosses */
#define SPAN 8         /* cells to each side */

/* A line from the centre to a sample. */
typedef struct line {
    float x, y, weight; /* of the sample */
    int nseen;
    int seen[MAX_SPLITS][2]; /* vertices that it was taken apart at */
} line;

/* What could not be found is black, or does not count. */
static void lose(job *j, bool black, float weight) {
    if (black)
        j->state->weight += weight;
}

static bool is_black(const cache_tables *t, const cell *c, int side) {
    return ((side - c->turn) & 1 ? t->border_u : t->border_v) == SLV_BORDER_BLACK;
}

/* How a line from the centre passes a vertex: 1 on its right, -1 on its left, and between the two
 * when it is close. Lines are never taken apart where they turn by a right angle at the vertex:
 * what is on one face stays there. */
static float passing(const job *j, const line *to, int x, int y) {
    float dx = to->x - j->e.x, dy = to->y - j->e.y, length = sqrtf(dx * dx + dy * dy);
    float vx = (float)x - j->e.x, vy = (float)y - j->e.y;
    float before = (vx * dx + vy * dy) / length, behind = length - before;
    float aside = (dx * vy - dy * vx) / length;
    float width = smaller(j->soft, 0.5f * smaller(before, behind));
    return !(width > 0) ? 2 : larger(smaller(aside / width, 1), -1);
}

/* The vertex, among the corners of a cell, that a line is taken apart at first. */
static bool find_split(job *j, const cell *c, line *to, int *corner, float *side) {
    float nearest = INFINITY;
    for (int k = 0; k < 4; k++) {
        int x = cell_corner_x(c, k), y = cell_corner_y(c, k);
        float s = passing(j, to, x, y);
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
static void follow(job *j, cell c, float x, float y, const line *line_to) {
    cache_tables *t = j->state->tables;
    line to = *line_to;
    for (int step = 0; step < MAX_STEPS && !is_over(j->state); step++) {
        int corner = 0;
        float passed = 0;
        if (to.nseen < MAX_SPLITS && find_split(j, &c, &to, &corner, &passed)) {
            int vx = cell_corner_x(&c, corner), vy = cell_corner_y(&c, corner);
            bool right = to.x > (float)vx, top = to.y > (float)vy;
            int target = top ? right ? 0 : 1 : right ? 3 : 2; /* the corner there, of its cell */
            float weight = to.weight;
            to.seen[to.nseen][0] = vx;
            to.seen[to.nseen++][1] = vy;
            /* next to a border there may be nothing on the other side: what is seen past it fades
             */
            bool closed = cell_is_closed(t, &c, corner);
            float shares[2] = {closed ? 0.5f * (1 + passed) : larger(passed, 0),
                               closed ? 0.5f * (1 - passed) : larger(-passed, 0)};
            lose(j, is_black(t, &c, corner), weight * (1 - shares[0] - shares[1]));
            for (int way = 0; way < 2 && !is_over(j->state); way++) {
                /* a vertex on the left is gone around counter-clockwise */
                int turns = (way == 0 ? target - corner : corner - target) & 3, side = 0;
                cell at = c;
                bool there = true;
                to.weight = weight * shares[way];
                if (to.weight == 0)
                    continue;
                for (int i = 0; i < turns && there; i++) {
                    int here = cell_corner_at(&at, vx, vy);
                    side = way == 0 ? (here + 3) & 3 : here;
                    there = here >= 0 && cell_cross(t, &at, side, way == 0, &at);
                }
                if (there)
                    follow(j, at, (float)vx, (float)vy, &to);
                else
                    lose(j, is_black(t, &at, side), to.weight);
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
            add_sample(j, &c, to.x, to.y, to.weight);
            return;
        }
        x = side == 1 ? right : side == 3 ? left : smaller(larger(x + dx * most, left), right);
        y = side == 2 ? top : side == 0 ? bottom : smaller(larger(y + dy * most, bottom), top);
        float along = side & 1 ? y - bottom : x - left;
        bool upper = along > 0.5f * (float)c.size;
        if (!cell_cross(t, &c, side, upper == (side < 2), &c)) {
            lose(j, is_black(t, &c, side), to.weight);
            return;
        }
    }
}

enum { CELL_THERE, CELL_LINES, CELL_LOST, CELL_BLACK };

/* The weights of a row of samples, which are 2^-((a du + b) du + c) times a scale. Returns their
 * sum.
 */
static inline float weigh_run(float a, float b, float c, float first, float step, float scale,
                              int n, float *weights) {
    const v8f each = {0.5f, 1.5f, 2.5f, 3.5f, 4.5f, 5.5f, 6.5f, 7.5f};
    float sum = 0;
    for (int i = 0; i < n; i += 8) {
        v8f du = (each + (float)i) * step + first;
        v8f w = v8_exp2(-((a * du + b) * du + c)) - AT_REACH;
        w = v8_select(w > 0, w * scale, v8_splat(0));
        memcpy(weights + i, &w, sizeof w);
    }
    for (int i = 0; i < n; i++)
        sum += weights[i];
    return sum;
}

/* Sums up the samples of a cell: from the face that is there, by a line to each, or as what lies
 * beyond a border. */
static __attribute__((noinline)) void sum_cell(job *j, const cell *c, int kind) {
    lookup_state *state = j->state;
    const cache_tables *t = state->tables;
    const ellipse *e = &j->e;
    cache_face *f = cache_find_face(state->tables, c->face);
    bool turned = c->turn & 1;
    int log2_u = e->log2[turned], log2_v = e->log2[!turned], res_u, res_v;
    int size_u = c->size << log2_u, size_v = c->size << log2_v, low, high;
    float unit_u = power_of_two(log2_u), unit_v = power_of_two(log2_v), u, v;
    float step_u = power_of_two(-log2_u), step_v = power_of_two(-log2_v);
    float uu = turned ? e->yy : e->xx, vv = turned ? e->xx : e->yy, uv = turned ? -e->xy : e->xy;
    float slope = -uv / uu, widest = REACH_LOG2 / uu, narrowing = (vv + uv * slope) / uu;
    const uint8_t *texels = NULL;
    to_local(c, e->x, e->y, &u, &v);
    sample_res(e, c, f, &res_u, &res_v);
    int shift_u = log2_u + (c->size == 2) - res_u, shift_v = log2_v + (c->size == 2) - res_v;
    bool constant = (f->flags & SLV_FACE_CONSTANT) || res_u + res_v == 0;
    bool direct = j->few && res_u + res_v <= t->whole_log2;
    float reach = e->reach[!turned], total = 0;
    low = ceil_int(larger((v - reach) * unit_v - 0.5f, 0));
    high = floor_int(smaller((v + reach) * unit_v - 0.5f, (float)(size_v - 1)));
    for (int y = low; y <= high && !is_over(state); y++) {
        float dv = ((float)y + 0.5f) * step_v - v, middle = slope * dv;
        float rest = widest - narrowing * dv * dv;
        if (!(rest > 0))
            continue;
        float half = sqrtf(rest);
        int x0 = ceil_int(larger((u + middle - half) * unit_u - 0.5f, 0));
        int x1 = floor_int(smaller((u + middle + half) * unit_u - 0.5f, (float)(size_u - 1)));
        for (; x0 <= x1 && !is_over(state); x0 += RUN) {
            int n = x1 - x0 + 1 < RUN ? x1 - x0 + 1 : RUN;
            float weights[RUN], at_x0 = (float)x0 * step_u - u;
            float sum =
                weigh_run(uu, 2 * uv * dv, vv * dv * dv, at_x0, step_u, j->scale, n, weights);
            if (kind == CELL_LINES) {
                for (int i = 0; i < n && !is_over(state); i++) {
                    line to = {.x = (float)c->x + ((float)(x0 + i) + 0.5f) * step_u,
                               .y = (float)c->y + ((float)y + 0.5f) * step_v,
                               .weight = weights[i]};
                    if (to.weight > 0)
                        follow(j, (cell){c->face, 0, 0, c->size, 0}, e->x, e->y, &to);
                }
                continue;
            }
            total += sum;
            if (kind == CELL_BLACK || j->weigh || constant)
                continue;
            int from = x0 >> shift_u, count = ((x0 + n - 1) >> shift_u) - from + 1;
            if (shift_u) {
                float coarse[RUN] = {0};
                for (int i = 0; i < n; i++)
                    coarse[((x0 + i) >> shift_u) - from] += weights[i];
                memcpy(weights, coarse, sizeof weights);
            }
            if (!direct) {
                add_turned_run(j, c, f, res_u, res_v, from, y >> shift_v, count, weights);
                continue;
            }
            if (!texels)
                texels = find_texels(j, c->face, f, res_u, res_v, 0, true);
            if (!texels)
                return;
            size_t at = ((size_t)(y >> shift_v) << res_u) + (size_t)from;
            add_few(t, texels + at * t->pixel_size, count, weights, j->sums);
        }
    }
    if (kind != CELL_LINES)
        state->weight += total;
    if (kind == CELL_THERE && constant && !j->weigh && total > 0)
        add_texel(t->type, t->averages + (size_t)c->face * t->pixel_size, state->first,
                  state->count, total, state->sum);
}

typedef struct patch {
    cell c;
    int kind;
} patch;

/* The patch next to one, over a side of it. `smooth`: whether lines on their way pass nothing that
 * takes them apart. */
static void next_patch(job *j, const patch *from, int side, bool smooth, bool may_end,
                       bool may_go_on, patch *out) {
    cache_tables *t = j->state->tables;
    if (from->kind != CELL_THERE) {
        out->kind = from->kind;
        return;
    }
    bool there = !j->stay && cell_cross(t, &from->c, side, false, &out->c);
    if (smooth && !there && may_end)
        out->kind = is_black(t, &from->c, side) ? CELL_BLACK : CELL_LOST;
    else if (smooth && there && may_go_on && out->c.size == from->c.size)
        out->kind = CELL_THERE;
}

/* The face of the lookup and, as far as the ellipse reaches, those around it. Squares of the plane
 * that straight lines reach without passing an extraordinary vertex, over faces of one size, are
 * summed up whole. */
static void sum_plane(job *j, const cell *home) {
    cache_tables *t = j->state->tables;
    const ellipse *e = &j->e;
    float size = (float)home->size;
    int low[2], high[2];
    const float at[2] = {e->x, e->y};
    for (int axis = 0; axis < 2; axis++) {
        low[axis] = floor_int((at[axis] - e->reach[axis]) / size);
        high[axis] = floor_int((at[axis] + e->reach[axis]) / size);
        low[axis] = low[axis] < -SPAN ? -SPAN : low[axis] > 0 ? 0 : low[axis];
        high[axis] = high[axis] > SPAN ? SPAN : high[axis] < 0 ? 0 : high[axis];
    }
    sum_cell(j, home, CELL_THERE);
    if (!(low[0] | low[1] | high[0] | high[1]))
        return;
    patch plane[2 * SPAN + 1][2 * SPAN + 1];
    plane[SPAN][SPAN] = (patch){*home, CELL_THERE};
    for (int row = 0; row <= high[1] - low[1]; row++) {
        int y = row <= high[1] ? row : high[1] - row, up = y > 0;
        for (int column = 0; column <= high[0] - low[0] && !is_over(j->state); column++) {
            int x = column <= high[0] ? column : high[0] - column, right = x > 0;
            patch *p = &plane[SPAN + y][SPAN + x];
            const patch *across = x ? p - (right ? 1 : -1) : p;
            const patch *below = y ? &plane[SPAN + y - (up ? 1 : -1)][SPAN + x] : p;
            int side = x ? right ? 1 : 3 : up ? 2 : 0;
            if (!x && !y)
                continue;
            *p = (patch){*home, CELL_LINES};
            if (!x || !y) {
                const patch *from = x ? across : below;
                bool smooth = from->kind == CELL_THERE &&
                              (j->stay || (cell_is_smooth(t, &from->c, side) &&
                                           cell_is_smooth(t, &from->c, (side + 1) & 3)));
                next_patch(j, from, side, smooth, true, true, p);
            } else if (across->kind != CELL_THERE && below->kind != CELL_THERE) {
                p->kind = below->kind == CELL_LINES ? CELL_LINES : across->kind;
            } else if (across->kind != CELL_LINES && below->kind != CELL_LINES) {
                bool both = across->kind == below->kind, from_across = across->kind == CELL_THERE;
                const patch *from = from_across ? across : below;
                side = from_across ? right ? 1 : 3 : up ? 2 : 0;
                /* the corner that lies towards the centre */
                int corner =
                    cell_corner_at(&from->c, (x + !right) * home->size, (y + !up) * home->size);
                bool smooth = j->stay || cell_is_smooth(t, &from->c, corner);
                next_patch(j, from, side, smooth, !both, both, p);
            }
            cell c = p->kind == CELL_THERE
                         ? p->c
                         : (cell){home->face, x * home->size, y * home->size, home->size, 0};
            if (p->kind != CELL_LOST)
                sum_cell(j, &c, p->kind);
        }
    }
}

/* Near an extraordinary vertex directions cease to mean anything. So the ellipse gives way to a
 * circle around the vertex, which looks the same from all its faces. */
static int find_ring(cache_tables *t, const cell *home, int x, int y, cell ring[MAX_AROUND]) {
    int count = 1;
    ring[0] = *home;
    for (int way = 0; way < 2; way++) {
        cell c = *home;
        while (count < MAX_AROUND && cell_turn(t, &c, x, y, way == 0)) {
            if (c.face == home->face)
                return count;
            ring[count++] = c;
        }
    }
    return count;
}

/* Sums up an ellipse around a place: in the plane, or, if there is a ring, in each of its faces. */
static void sum_ellipse(job *j, const wanted *w, float x, float y, const cell *faces, int nring,
                        float scale) {
    int log2[2][2], count[2];
    float share[2][2];
    for (int axis = 0; axis < 2; axis++)
        count[axis] = find_lattices(w, axis, log2[axis], share[axis]);
    for (int i = 0; i < count[1]; i++)
        for (int k = 0; k < count[0] && !is_over(j->state); k++) {
            float all = find_ellipse(x, y, w, log2[0][k], log2[1][i], &j->e);
            j->scale = scale * share[0][k] * share[1][i] / all;
            if (!nring)
                sum_plane(j, faces);
            for (int f = 0; f < nring && !is_over(j->state); f++)
                sum_cell(j, &faces[f], CELL_THERE);
        }
}

/* Gives a circle around a vertex its part in a lookup. */
static void blend_vertex(job *j, const cell *home, int corner, wanted w, float part) {
    lookup_state *state = j->state;
    int x = cell_corner_x(home, corner), y = cell_corner_y(home, corner);
    float before = part < 1 && state->weight > 0 ? (1 - part) / state->weight : 0;
    cell ring[MAX_AROUND];
    int count = find_ring(state->tables, home, x, y, ring);
    w.xx = w.yy = 0.5 * (w.xx + w.yy);
    w.xy = 0;
    w.across[0] = w.across[1] = w.mean;
    w.texel[0] = w.texel[1] = larger(w.texel[0], w.texel[1]);
    for (uint32_t c = 0; c < state->count; c++)
        state->sum[c] *= before;
    state->weight = 0;
    j->weigh = true;
    sum_ellipse(j, &w, (float)x, (float)y, ring, count, 1);
    j->weigh = false;
    sum_ellipse(j, &w, (float)x, (float)y, ring, count,
                state->weight > 0 ? part / state->weight : 0);
    state->weight = 1;
}

/* A coordinate of the lookup on its face. False if it lies so far outside that all is black.
 * Outside of a black border it stays there, and sees of the face what reaches it. */
static bool to_plane(job *j, const cache_face *f, slv_border_mode mode, int low_edge, int size,
                     float x, float *out) {
    if (mode == SLV_BORDER_PERIODIC)
        x -= floorf(x);
    float inside = x > 0 ? x < 1 ? x : 1 : 0;
    if (mode == SLV_BORDER_BLACK && x != inside) {
        int edge = x < 0 ? low_edge : (low_edge + 2) & 3;
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

void ANISOTROPIC_SUM(lookup_state *state, const slv_lookup *l) {
    cache_tables *t = state->tables;
    const cache_face *f = cache_find_face(t, l->face);
    const slv_sampler *s = state->sampler;
    cell home = cell_home(t, l->face);
    unsigned around = cell_around(t, l->face);
    float at[2], texel[2];
    wanted w;
    job j = {.state = state,
             .scale = 1,
             .stay = s->no_edge_blend,
             .few = t->nchannels <= 4 && !t->tanvec};
    if (!to_plane(&j, f, t->border_u, 3, home.size, l->u, &at[0]) ||
        !to_plane(&j, f, t->border_v, 0, home.size, l->v, &at[1])) {
        state->weight = 1;
        return;
    }
    if (j.stay || (around & AROUND_EVEN))
        cell_texel(t, &home, texel);
    else
        cell_coarsest(t, &home, at, around, texel);
    find_wanted(s, l, home.size, texel, &w);
    j.soft = smaller(w.soft, MOST_SOFT);
    float part = 0;
    int corner = 0;
    for (int k = 0; k < 4 && !j.stay; k++) {
        float dx = (float)cell_corner_x(&home, k) - at[0];
        float dy = (float)cell_corner_y(&home, k) - at[1], near = sqrtf(dx * dx + dy * dy) / j.soft;
        if (near < 1 && !(around & (unsigned)AROUND_SMOOTH << k)) {
            part = (1 - near) * (1 - near) * (1 + 2 * near);
            corner = k;
        }
    }
    if (part < 1)
        sum_ellipse(&j, &w, at[0], at[1], &home, 0, 1);
    if (is_over(state))
        return;
    settle(&j);
    if (part > 0)
        blend_vertex(&j, &home, corner, w, part);
    if (!is_over(state))
        settle(&j);
}
