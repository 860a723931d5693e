/* Places on the surface: from (face, u, v) to triangles and back, and straight walks along them. */
#include "surface/surface_data.h"

const slv_adjacency *slv_paint_surface_adjacency(const slv_paint_surface *surface) {
    return surface->adjacency;
}

void slv_paint_surface_bounds(const slv_paint_surface *surface, float low[3], float high[3]) {
    for (int k = 0; k < 3; k++) {
        low[k] = surface->low[k];
        high[k] = surface->high[k];
    }
}

float slv_paint_surface_texel_area(const slv_paint_surface *surface, uint32_t face, slv_res res) {
    return face < surface->nfaces ? ldexpf(surface->sides[3 * (size_t)face + 2], -res.u - res.v)
                                  : 0;
}

static double into_unit(double x) {
    return x > 0 ? (x < 1 ? x : 1) : 0; /* NaN: 0 */
}

bool slvi_surface_place(const slv_paint_surface *s, slv_surface_point point, uint32_t *tri,
                        double *x, double *y) {
    if (point.face < 0 || (uint32_t)point.face >= s->nfaces || !s->segments[point.face])
        return false;
    uint32_t n = s->segments[point.face];
    double u = into_unit((double)point.u) * n, v = into_unit((double)point.v) * n;
    uint32_t i = (uint32_t)u, j = (uint32_t)v;
    i -= i == n;
    j -= j == n;
    *x = u - i;
    *y = v - j;
    *tri = 2 * (s->first[point.face] + j * n + i) + (*y > *x);
    return true;
}

slv_surface_point slvi_surface_point_of(const slv_paint_surface *s, uint32_t tri, double x,
                                        double y) {
    uint32_t face = s->cells[tri / 2].face, n = s->segments[face], local = tri / 2 - s->first[face];
    return (slv_surface_point){(int32_t)face, (float)((local % n + into_unit(x)) / n),
                               (float)((local / n + into_unit(y)) / n)};
}

void slvi_tri_normal(const slv_paint_surface *s, uint32_t tri, double out[3]) {
    double a[3], b[3];
    const float *p[3];
    for (unsigned k = 0; k < 3; k++)
        p[k] = slvi_tri_point(s, tri, k);
    for (int k = 0; k < 3; k++) {
        a[k] = (double)p[1][k] - (double)p[0][k];
        b[k] = (double)p[2][k] - (double)p[0][k];
    }
    slvi_unit(a);
    slvi_unit(b);
    slvi_cross(a, b, out);
    if (!slvi_unit(out)) {
        out[0] = out[1] = 0;
        out[2] = 1;
    }
}

/* Puts a vector into the plane at right angles to `normal`; false if nothing is left of it. */
static bool flatten(const double normal[3], double v[3]) {
    double length = sqrt(slvi_dot(v, v)), up = slvi_dot(normal, v);
    for (int k = 0; k < 3; k++)
        v[k] -= up * normal[k];
    return slvi_dot(v, v) > 1e-12 * length * length && slvi_unit(v);
}

void slvi_tri_frame(const slv_paint_surface *s, uint32_t tri, const float axis[3], double x[3],
                    double y[3]) {
    double normal[3];
    const uint32_t *c = s->cells[tri / 2].corners;
    slvi_tri_normal(s, tri, normal);
    for (int k = 0; k < 3; k++)
        x[k] = axis ? (double)axis[k] : 0;
    bool found = flatten(normal, x);
    for (unsigned turn = 0; !found && turn < 4; turn++) { /* along the cell's sides */
        static const unsigned ends[4][2] = {{0, 1}, {3, 2}, {0, 2}, {0, 3}};
        const float *p = s->positions + 3 * (size_t)c[ends[turn][0]],
                    *q = s->positions + 3 * (size_t)c[ends[turn][1]];
        for (int k = 0; k < 3; k++)
            x[k] = (double)q[k] - (double)p[k];
        found = flatten(normal, x);
    }
    for (int k = 0; !found && k < 3; k++) {
        x[0] = x[1] = x[2] = 0;
        x[k] = 1;
        found = flatten(normal, x);
    }
    slvi_cross(normal, x, y);
}

bool slv_paint_surface_at(const slv_paint_surface *surface, slv_surface_point point,
                          float position[3], float normal[3], float u_axis[3]) {
    uint32_t tri;
    double x, y, w[3], across[3], along[3], up[3];
    if (!slvi_surface_place(surface, point, &tri, &x, &y))
        return false;
    slvi_tri_weights(tri, x, y, w);
    slvi_tri_normal(surface, tri, up);
    slvi_tri_frame(surface, tri, NULL, along, across);
    for (int k = 0; k < 3; k++) {
        if (position)
            position[k] = (float)(w[0] * (double)slvi_tri_point(surface, tri, 0)[k] +
                                  w[1] * (double)slvi_tri_point(surface, tri, 1)[k] +
                                  w[2] * (double)slvi_tri_point(surface, tri, 2)[k]);
        if (normal)
            normal[k] = (float)up[k];
        if (u_axis)
            u_axis[k] = (float)along[k];
    }
    return true;
}

/* A triangle laid into the plane: corner 0 at zero, corner 1 along x. */
typedef struct flat {
    double x[3], y[3];
    double along[3], across[3]; /* the plane's axes in space */
} flat;

static flat lay_flat(const slv_paint_surface *s, uint32_t tri) {
    flat f = {{0}, {0}, {0}, {0}};
    float first[3];
    for (int k = 0; k < 3; k++)
        first[k] = slvi_tri_point(s, tri, 1)[k] - slvi_tri_point(s, tri, 0)[k];
    slvi_tri_frame(s, tri, first, f.along, f.across);
    for (unsigned k = 1; k < 3; k++) {
        double d[3];
        for (int i = 0; i < 3; i++)
            d[i] = (double)slvi_tri_point(s, tri, k)[i] - (double)slvi_tri_point(s, tri, 0)[i];
        f.x[k] = slvi_dot(d, f.along);
        f.y[k] = slvi_dot(d, f.across);
    }
    return f;
}

/* A walker: a triangle, a place in its plane, and a direction there. */
typedef struct walker {
    uint32_t tri;
    flat flat;
    double x, y, dx, dy;
} walker;

/* How far it is to the edge that the walker leaves its triangle over, other than the one that it
 * came in by. */
static double find_exit(const walker *w, unsigned came_by, unsigned *edge) {
    double nearest = INFINITY;
    const flat *f = &w->flat;
    *edge = 3;
    for (unsigned k = 0; k < 3; k++) {
        unsigned next = (k + 1) % 3;
        double ex = f->x[next] - f->x[k], ey = f->y[next] - f->y[k];
        double towards = ex * w->dy - ey * w->dx; /* negative: it leads out, to the right */
        double inside = ex * (w->y - f->y[k]) - ey * (w->x - f->x[k]);
        if (k == came_by || !(towards < 0))
            continue;
        double far = fmax(inside, 0) / -towards;
        if (far < nearest) {
            nearest = far;
            *edge = k;
        }
    }
    return nearest;
}

/* Over an edge: what is along it stays along it, and what leads out leads in. */
static void cross_over(const slv_paint_surface *s, walker *w, unsigned from, uint32_t to,
                       unsigned by) {
    unsigned next = (from + 1) % 3, end = (by + 1) % 3;
    const flat *f = &w->flat;
    double ex = f->x[next] - f->x[from], ey = f->y[next] - f->y[from], l = sqrt(ex * ex + ey * ey);
    double t = l > 0 ? ((w->x - f->x[from]) * ex + (w->y - f->y[from]) * ey) / (l * l) : 0.5;
    double along = l > 0 ? (w->dx * ex + w->dy * ey) / l : 0;
    double out = l > 0 ? (w->dx * ey - w->dy * ex) / l : 1;
    flat g = lay_flat(s, to);
    double gx = g.x[end] - g.x[by], gy = g.y[end] - g.y[by], m = sqrt(gx * gx + gy * gy);
    gx = m > 0 ? gx / m : 1;
    gy = m > 0 ? gy / m : 0;
    t = into_unit(t);
    w->x = g.x[end] + t * (g.x[by] - g.x[end]);
    w->y = g.y[end] + t * (g.y[by] - g.y[end]);
    w->dx = -along * gx - out * gy;
    w->dy = -along * gy + out * gx;
    w->tri = to;
    w->flat = g;
}

/* The walker's place as weights of the corners. */
static void find_weights(const walker *w, double out[3]) {
    const flat *f = &w->flat;
    double area = f->x[1] * f->y[2] - f->x[2] * f->y[1];
    out[1] = area != 0 ? (w->x * f->y[2] - w->y * f->x[2]) / area : 0;
    out[2] = area != 0 ? (f->x[1] * w->y - f->y[1] * w->x) / area : 0;
    out[0] = 1 - out[1] - out[2];
}

float slv_paint_surface_walk(const slv_paint_surface *surface, slv_surface_point *point,
                             float direction[3], float distance) {
    enum { MOST_TRIANGLES = 1 << 20 };
    walker w = {0};
    double x, y, weights[3], axis[3], side[3], left = (double)distance;
    unsigned came_by = 3, edge;
    if (!slvi_surface_place(surface, *point, &w.tri, &x, &y) || !(left > 0))
        return 0;
    slvi_tri_weights(w.tri, x, y, weights);
    slvi_tri_frame(surface, w.tri, direction, axis, side);
    w.flat = lay_flat(surface, w.tri);
    for (int k = 0; k < 3; k++) {
        w.x += weights[k] * w.flat.x[k];
        w.y += weights[k] * w.flat.y[k];
    }
    w.dx = slvi_dot(axis, w.flat.along);
    w.dy = slvi_dot(axis, w.flat.across);
    for (int i = 0; i < MOST_TRIANGLES; i++) {
        double far = find_exit(&w, came_by, &edge), step = fmin(far, left);
        uint32_t to;
        if (edge == 3)
            break;
        w.x += step * w.dx;
        w.y += step * w.dy;
        left -= step;
        if (!(left > 0) || !slvi_tri_across(surface, w.tri, edge, &to, &came_by))
            break;
        cross_over(surface, &w, edge, to, came_by);
    }
    find_weights(&w, weights);
    *point = w.tri & 1 ? slvi_surface_point_of(surface, w.tri, weights[1], weights[1] + weights[2])
                       : slvi_surface_point_of(surface, w.tri, weights[1] + weights[2], weights[2]);
    for (int k = 0; k < 3; k++)
        direction[k] = (float)(w.dx * w.flat.along[k] + w.dy * w.flat.across[k]);
    return (float)((double)distance - left);
}
