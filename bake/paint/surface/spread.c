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

static bool before(const slvi_crossing *a, const slvi_crossing *b) {
    return a->key != b->key ? a->key < b->key : a->side < b->side;
}

static void sift_up(slvi_crossing *heap, uint32_t i) {
    slvi_crossing one = heap[i];
    for (; i && before(&one, &heap[(i - 1) / 2]); i = (i - 1) / 2)
        heap[i] = heap[(i - 1) / 2];
    heap[i] = one;
}

static slvi_crossing take_nearest(slv_painter *p) {
    slvi_crossing *heap = p->heap, top = heap[0], last = heap[--p->nheap];
    uint32_t i = 0;
    for (uint32_t child; (child = 2 * i + 1) < p->nheap; i = child) {
        child += child + 1 < p->nheap && before(&heap[child + 1], &heap[child]);
        if (!before(&heap[child], &last))
            break;
        heap[i] = heap[child];
    }
    heap[i] = last;
    return top;
}

float slvi_reach_into(const slv_painter *p, const slvi_reach *reach, uint32_t face) {
    if (!reach->res)
        return reach->least;
    return fmaxf(reach->least, 0.75f * slvi_texel_length(p->surface, face, reach->res[face]));
}

/* Where the place that the distances of a and b are from lies, b being at (l, 0) and a at (0, 0):
 * x along the edge and y behind it. */
static void find_source(double a, double b, double l, double *x, double *y) {
    *x = l > 0 ? (a * a - b * b + l * l) / (2 * l) : 0;
    *y = sqrt(fmax(a * a - *x * *x, 0));
}

/* The least distance of a point of an edge that is beyond `reach` at both ends. */
static double edge_distance(double a, double b, double l) {
    double x, y;
    find_source(a, b, l, &x, &y);
    return x > 0 && x < l ? y : fmin(a, b);
}

/* Puts an edge among those that are to be crossed, by its nearer end, unless it is out of reach. */
static slv_result push_edge(slv_painter *p, uint32_t tri, unsigned edge, const slvi_reach *reach) {
    const slv_paint_surface *s = p->surface;
    double a = p->vertices[slvi_tri_vertex(s, tri, edge)].distance,
           b = p->vertices[slvi_tri_vertex(s, tri, (edge + 1) % 3)].distance, key = fmin(a, b);
    uint32_t to;
    unsigned by;
    if (!slvi_tri_across(s, tri, edge, &to, &by))
        return SLV_OK;
    if (!(key <= (double)reach->least)) {
        key = edge_distance(a, b, slvi_tri_length(s, tri, edge));
        if (!(key <= (double)slvi_reach_into(p, reach, s->cell_face[to / 2])))
            return SLV_OK;
    }
    slv_result result =
        slvi_painter_room(p, (uint64_t)p->nheap + 1, sizeof *p->heap, &p->heap, &p->heap_room);
    if (result)
        return result;
    p->heap[p->nheap] = (slvi_crossing){(float)key, 4 * tri + edge};
    sift_up(p->heap, p->nheap++);
    return SLV_OK;
}

/* The vertex opposite of edge `by` of a triangle, unfolded over it. */
static slvi_front_vertex unfold(const slv_painter *p, uint32_t tri, unsigned by, bool places) {
    const slv_paint_surface *s = p->surface;
    uint32_t va = slvi_tri_vertex(s, tri, by), vb = slvi_tri_vertex(s, tri, (by + 1) % 3);
    const slvi_front_vertex *a = &p->vertices[va], *b = &p->vertices[vb];
    double l = slvi_tri_length(s, tri, by), ac = slvi_tri_length(s, tri, (by + 2) % 3),
           bc = slvi_tri_length(s, tri, (by + 1) % 3);
    double sx, sy, cx, cy;
    slvi_front_vertex c = {.round = p->round};
    find_source(a->distance, b->distance, l, &sx, &sy);
    find_source(ac, bc, l, &cx, &cy);
    double dx = cx - sx, dy = cy + sy, leads = sx * dy + dx * sy; /* dy times where it crosses */
    c.distance = sqrt(dx * dx + dy * dy);
    if ((leads < 0 && s->bent[va]) || !(l > 0))
        c.distance = a->distance + ac; /* around the corner */
    else if (leads > l * dy && s->bent[vb])
        c.distance = b->distance + bc;
    if (!places)
        return c;
    double ex = (double)b->x - (double)a->x, ey = (double)b->y - (double)a->y,
           e = sqrt(ex * ex + ey * ey), x = (double)a->x, y = (double)a->y;
    if (e > 0) {
        x += (cx * ex - cy * ey) / e;
        y += (cx * ey + cy * ex) / e;
    }
    double r = sqrt(x * x + y * y), scale = r > 0 ? c.distance / r : 1;
    c.x = (float)(x * scale);
    c.y = (float)(y * scale);
    return c;
}

slv_result slvi_painter_touch(slv_painter *p, uint32_t tri) {
    slv_result result = slvi_painter_room(p, (uint64_t)p->ntouched + 1, sizeof *p->touched,
                                          &p->touched, &p->touched_room);
    if (result)
        return result;
    p->tri_round[tri] = p->round;
    p->touched[p->ntouched++] = tri;
    return SLV_OK;
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

static slv_result cross(slv_painter *p, slvi_crossing crossing, const slvi_reach *reach) {
    uint32_t to;
    unsigned by;
    slv_result result = SLV_OK;
    if (!slvi_tri_across(p->surface, crossing.side / 4, crossing.side & 3, &to, &by))
        return SLV_OK;
    uint32_t vertex = slvi_tri_vertex(p->surface, to, (by + 2) % 3);
    slvi_front_vertex c = unfold(p, to, by, reach->places), *known = &p->vertices[vertex];
    bool is_new = known->round != p->round;
    /* nearer by less than this is what rounding makes of the same */
    bool nearer = is_new || c.distance < known->distance * (1 - 1e-5) - 1e-6 * (double)reach->least;
    if (nearer)
        *known = c;
    bool first = p->tri_round[to] != p->round;
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
    p->nheap = p->ntouched = 0;
}

slv_result slvi_painter_spread(slv_painter *p, slv_surface_point from, const float axis[3],
                               const slvi_reach *reach) {
    const slv_paint_surface *s = p->surface;
    uint32_t tri;
    double x, y, w[3], right[3], up[3], middle[3];
    slvi_painter_begin_round(p);
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
    while (p->nheap && !result && most--)
        result = cross(p, take_nearest(p), reach);
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
    for (double far = 1.02 * straight;; far *= 2) {
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
