/* Distances along the surface from a place, triangle by triangle.
 *
 * A vertex beyond an edge is where the triangle lies when it is unfolded over that edge into the
 * plane in which the edge's ends have the distances that they have. On whatever can be unfolded
 * into the plane this is exact, and so is the distance of every point between the vertices (see
 * cover.c); elsewhere it is the update of Novotni and Klein 2002, "Computing geodesic distances on
 * triangular meshes". Since points of an edge know nothing but its ends, what is computed on its
 * two sides agrees. */
#include "surface/painter_data.h"

#include <string.h>

/* Where the place that the distances of a and b are from lies, b being at (l, 0) and a at (0, 0):
 * x along the edge and y behind it. */
static void find_source(double a, double b, double l, double *x, double *y) {
    *x = l > 0 ? (a * a - b * b + l * l) / (2 * l) : 0;
    *y = sqrt(fmax(a * a - *x * *x, 0));
}

static void begin_queue(slvi_queue *q, float reach) {
    memset(q->first, 0xff, sizeof q->first);
    q->used = q->at = q->waiting = 0;
    q->unused = SLVI_NONE;
    q->scale = SLVI_BUCKETS / reach;
}

static slv_result push(slv_painter *p, float key, uint32_t over) {
    slvi_queue *q = &p->queue;
    float place = key * q->scale;
    uint32_t bucket = place < SLVI_BUCKETS - 1 ? (uint32_t)place : SLVI_BUCKETS - 1, i = q->unused;
    bucket = bucket > q->at ? bucket : q->at;
    if (i != SLVI_NONE) {
        q->unused = q->list[i].next;
    } else {
        slv_result result =
            slvi_painter_room(p, (uint64_t)q->used + 1, sizeof *q->list, &q->list, &q->room);
        if (result)
            return result;
        i = q->used++;
    }
    q->list[i] = (slvi_crossing){over, SLVI_NONE};
    if (q->first[bucket] == SLVI_NONE)
        q->first[bucket] = i;
    else
        q->list[q->last[bucket]].next = i;
    q->last[bucket] = i;
    q->waiting++;
    return SLV_OK;
}

/* There is one. */
static uint32_t take_nearest(slvi_queue *q) {
    while (q->first[q->at] == SLVI_NONE)
        q->at++;
    uint32_t i = q->first[q->at];
    q->first[q->at] = q->list[i].next;
    q->list[i].next = q->unused;
    q->unused = i;
    q->waiting--;
    return q->list[i].over;
}

float slvi_reach_into(const slv_painter *p, const slvi_reach *reach, uint32_t face) {
    if (!reach->res)
        return reach->least;
    return fmaxf(reach->least, 0.75f * slvi_texel_length(p->surface, face, reach->res[face]));
}

/* The least distance of a point of an edge that is beyond `reach` at both ends. */
static double edge_distance(double a, double b, double l) {
    double x, y;
    find_source(a, b, l, &x, &y);
    return x > 0 && x < l ? y : fmin(a, b);
}

/* The distance of the vertex opposite of edge `by` of a triangle, unfolded over it; `at` (may be
 * NULL) becomes where it lies, as seen from the edge. */
static double unfold_distance(const slv_painter *p, uint32_t tri, unsigned by, double at[2]) {
    const slv_paint_surface *s = p->surface;
    uint32_t va = slvi_tri_vertex(s, tri, by), vb = slvi_tri_vertex(s, tri, (by + 1) % 3);
    double a = p->vertices[va].distance, b = p->vertices[vb].distance;
    double l = slvi_tri_length(s, tri, by), ac = slvi_tri_length(s, tri, (by + 2) % 3),
           bc = slvi_tri_length(s, tri, (by + 1) % 3);
    double sx, sy, cx, cy;
    find_source(a, b, l, &sx, &sy);
    find_source(ac, bc, l, &cx, &cy);
    double dx = cx - sx, dy = cy + sy, leads = sx * dy + dx * sy; /* dy times where it crosses */
    if (at) {
        at[0] = cx;
        at[1] = cy;
    }
    if ((leads < 0 && s->bent[va]) || !(l > 0))
        return a + ac; /* around the corner */
    if (leads > l * dy && s->bent[vb])
        return b + bc;
    return sqrt(dx * dx + dy * dy);
}

/* The vertex opposite of edge `by`. */
static slvi_front_vertex unfold(const slv_painter *p, uint32_t tri, unsigned by, bool places) {
    const slv_paint_surface *s = p->surface;
    const slvi_front_vertex *a = &p->vertices[slvi_tri_vertex(s, tri, by)],
                            *b = &p->vertices[slvi_tri_vertex(s, tri, (by + 1) % 3)];
    double at[2];
    slvi_front_vertex c = {.distance = unfold_distance(p, tri, by, at), .round = p->round};
    if (!places)
        return c;
    double ex = (double)b->x - (double)a->x, ey = (double)b->y - (double)a->y,
           e = sqrt(ex * ex + ey * ey), x = (double)a->x, y = (double)a->y;
    if (e > 0) {
        x += (at[0] * ex - at[1] * ey) / e;
        y += (at[0] * ey + at[1] * ex) / e;
    }
    double r = sqrt(x * x + y * y), scale = r > 0 ? c.distance / r : 1;
    c.x = (float)(x * scale);
    c.y = (float)(y * scale);
    return c;
}

/* Whether unfolding a triangle over its edge `by` may bring the vertex opposite nearer than it is
 * known to be: what takes no roots to say. */
static bool may_be_nearer(const slv_painter *p, uint32_t tri, unsigned by, double known) {
    const slv_paint_surface *s = p->surface;
    double a = p->vertices[slvi_tri_vertex(s, tri, by)].distance,
           b = p->vertices[slvi_tri_vertex(s, tri, (by + 1) % 3)].distance;
    double l = slvi_tri_length(s, tri, by), ac = slvi_tri_length(s, tri, (by + 2) % 3),
           bc = slvi_tri_length(s, tri, (by + 1) % 3);
    if (!(l > 0))
        return true;
    double half = 0.5 / l, a2 = a * a, c2 = ac * ac, sx = (a2 - b * b + l * l) * half,
           cx = (c2 - bc * bc + l * l) * half, sy2 = a2 - sx * sx, cy2 = c2 - cx * cx, dx = cx - sx,
           least = known * (1 - 1e-5);
    sy2 = sy2 > 0 ? sy2 : 0;
    cy2 = cy2 > 0 ? cy2 : 0;
    double rest = least * least - dx * dx - cy2 - sy2; /* of which is 2 sy cy */
    return rest > 0 && 4 * sy2 * cy2 < rest * rest;
}

/* Puts an edge among those that are to be crossed, by its nearer end, unless it is out of reach, or
 * nothing beyond it would become nearer. */
static slv_result push_edge(slv_painter *p, uint32_t tri, unsigned edge, const slvi_reach *reach) {
    const slv_paint_surface *s = p->surface;
    double a = p->vertices[slvi_tri_vertex(s, tri, edge)].distance,
           b = p->vertices[slvi_tri_vertex(s, tri, (edge + 1) % 3)].distance, key = a < b ? a : b;
    uint32_t to;
    unsigned by;
    if (!slvi_tri_across(s, tri, edge, &to, &by))
        return SLV_OK;
    if (!(key <= (double)reach->least)) {
        key = edge_distance(a, b, slvi_tri_length(s, tri, edge));
        if (!(key <= (double)slvi_reach_into(p, reach, s->cells[to / 2].face)))
            return SLV_OK;
    }
    if (p->tri_round[to] == p->round) {
        const slvi_front_vertex *known = &p->vertices[slvi_tri_vertex(s, to, (by + 2) % 3)];
        if (!may_be_nearer(p, to, by, known->distance))
            return SLV_OK;
    }
    __builtin_prefetch(&s->cells[to / 2]);
    return push(p, (float)key, 4 * to + by);
}

/* A vertex that became nearer: the edges of all touched triangles around it may be crossed anew. */
static slv_result push_around(slv_painter *p, uint32_t tri, unsigned corner,
                              const slvi_reach *reach) {
    enum { MOST_AROUND = 64 };
    slv_result result = SLV_OK;
    for (int way = 0; way < 2; way++) {
        uint32_t at = tri;
        unsigned k = corner, by;
        for (int i = 0; i < MOST_AROUND && !result; i++) {
            unsigned edge = way ? k : (k + 2) % 3;
            if (!slvi_tri_across(p->surface, at, edge, &at, &by) || p->tri_round[at] != p->round ||
                at == tri)
                break;
            k = way ? (by + 1) % 3 : by;
            if (!(result = push_edge(p, at, k, reach)))
                result = push_edge(p, at, (k + 2) % 3, reach);
        }
    }
    return result;
}

/* Over edge `by` into a triangle. */
static slv_result cross(slv_painter *p, uint32_t to, unsigned by, const slvi_reach *reach) {
    slv_result result = SLV_OK;
    slvi_front_vertex *known = &p->vertices[slvi_tri_vertex(p->surface, to, (by + 2) % 3)];
    bool is_new = known->round != p->round, first = p->tri_round[to] != p->round,
         nearer = is_new || may_be_nearer(p, to, by, known->distance);
    if (nearer) {
        slvi_front_vertex c = unfold(p, to, by, reach->places);
        /* nearer by less than this is what rounding makes of the same */
        nearer = is_new || c.distance < known->distance * (1 - 1e-5) - 1e-6 * (double)reach->least;
        if (nearer)
            *known = c;
    }
    if (!first && !nearer)
        return SLV_OK;
    if (first && (result = slvi_painter_touch(p, to)))
        return result;
    if (!(result = push_edge(p, to, (by + 1) % 3, reach)) &&
        !(result = push_edge(p, to, (by + 2) % 3, reach)) && nearer && !is_new)
        result = push_around(p, to, (by + 2) % 3, reach);
    return result;
}

void slvi_painter_begin_round(slv_painter *p) {
    if (++p->round == 0) { /* rounds of old would be taken for this one */
        for (uint32_t v = 0; v < p->surface->nverts; v++)
            p->vertices[v].round = 0;
        memset(p->tri_round, 0, 2 * (size_t)p->surface->ncells * sizeof *p->tri_round);
        p->round = 1;
    }
    p->ntouched = 0;
}

slv_result slvi_painter_spread(slv_painter *p, slv_surface_point from, const float axis[3],
                               const slvi_reach *reach) {
    const slv_paint_surface *s = p->surface;
    uint32_t tri;
    double x, y, w[3], right[3], up[3], middle[3];
    slvi_painter_begin_round(p);
    begin_queue(&p->queue, reach->least);
    if (!slvi_surface_place(s, from, &tri, &x, &y))
        return SLV_OK;
    slvi_tri_weights(tri, x, y, w);
    slvi_tri_frame(s, tri, axis, right, up);
    for (int i = 0; i < 3; i++)
        middle[i] = w[0] * (double)slvi_tri_point(s, tri, 0)[i] +
                    w[1] * (double)slvi_tri_point(s, tri, 1)[i] +
                    w[2] * (double)slvi_tri_point(s, tri, 2)[i];
    for (unsigned k = 0; k < 3; k++) {
        double d[3];
        for (int i = 0; i < 3; i++)
            d[i] = (double)slvi_tri_point(s, tri, k)[i] - middle[i];
        p->vertices[slvi_tri_vertex(s, tri, k)] = (slvi_front_vertex){
            sqrt(slvi_dot(d, d)), (float)slvi_dot(d, right), (float)slvi_dot(d, up), p->round};
    }
    slv_result result = slvi_painter_touch(p, tri);
    for (unsigned k = 0; k < 3 && !result; k++)
        result = push_edge(p, tri, k, reach);
    /* Each crossing makes a vertex nearer by a share of its distance; the bound is for surfaces
     * that have no shape, where that may take for ever. */
    uint64_t most = 64 + 64 * (uint64_t)s->ncells;
    while (p->queue.waiting && !result && most--) {
        uint32_t over = take_nearest(&p->queue);
        result = cross(p, over / 4, over & 3, reach);
    }
    return result;
}

/* The place in the unfolded plane of weights of a triangle's corners. */
static double find_place(const slv_painter *p, uint32_t tri, const double w[3], float out[2]) {
    double square = 0, x = 0, y = 0;
    for (unsigned k = 0; k < 3; k++) {
        const slvi_front_vertex *v = &p->vertices[slvi_tri_vertex(p->surface, tri, k)];
        double l = slvi_tri_length(p->surface, tri, k);
        square += w[k] * v->distance * v->distance - w[k] * w[(k + 1) % 3] * l * l;
        x += w[k] * (double)v->x;
        y += w[k] * (double)v->y;
    }
    double distance = sqrt(fmax(square, 0)), r = sqrt(x * x + y * y);
    out[0] = (float)(r > 0 ? x * distance / r : 0);
    out[1] = (float)(r > 0 ? y * distance / r : 0);
    return distance;
}

bool slv_painter_unfolded(const slv_painter *painter, slv_surface_point point, float out[2]) {
    uint32_t tri;
    double x, y, w[3];
    if (!slvi_surface_place(painter->surface, point, &tri, &x, &y) ||
        painter->tri_round[tri] != painter->round)
        return false;
    slvi_tri_weights(tri, x, y, w);
    find_place(painter, tri, w, out);
    return true;
}

slv_result slv_painter_locate(slv_painter *painter, slv_surface_point from, const float axis[3],
                              slv_surface_point to, float limit, float out[2], bool *reached) {
    const slv_paint_surface *s = painter->surface;
    uint32_t tri, start;
    double x, y, w[3];
    float a[3], b[3];
    *reached = false;
    if (!slvi_surface_place(s, to, &tri, &x, &y) || !slvi_surface_place(s, from, &start, w, w + 1))
        return SLV_OK;
    slvi_tri_weights(tri, x, y, w);
    slv_paint_surface_at(s, from, a, NULL, NULL);
    slv_paint_surface_at(s, to, b, NULL, NULL);
    double straight = slvi_distance(a, b);
    if (!(straight <= (double)limit))
        return SLV_OK;
    /* never from 0 on, which would stay that: a place may be a rounding away from itself */
    for (double far = fmax(1.02 * straight, 1e-4 * (double)limit);; far *= 2) {
        const slvi_reach reach = {.least = fminf((float)far, limit), .places = true};
        slv_result result = slvi_painter_spread(painter, from, axis, &reach);
        if (result)
            return result;
        *reached = painter->tri_round[tri] == painter->round &&
                   find_place(painter, tri, w, out) <= (double)reach.least * 1.0001 + 1e-30;
        if (*reached || !(far < (double)limit))
            return SLV_OK;
    }
}
