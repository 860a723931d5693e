/* Faces into UV images: for each pixel near a face, where on the face it is. */
#include "uv/raster.h"

#include "adjacency/edge.h"

#include <math.h>
#include <string.h>

/* The corners in pixels from the image's upper left corner; y goes down. */
typedef struct quad {
    double at[4][2];
    double low[2], high[2];
} quad;

static quad quad_of(const uv_band *band, const float corners[8]) {
    quad q = {.low = {INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY}};
    for (int c = 0; c < 4; c++) {
        q.at[c][0] = ((double)corners[2 * c] - band->u) * band->width;
        q.at[c][1] = (band->v + 1 - (double)corners[2 * c + 1]) * band->height;
        for (int axis = 0; axis < 2; axis++) {
            q.low[axis] = fmin(q.low[axis], q.at[c][axis]);
            q.high[axis] = fmax(q.high[axis], q.at[c][axis]);
        }
    }
    return q;
}

/* The place of (u,v), and its derivatives: j = {dx/du, dx/dv, dy/du, dy/dv}. */
static void map(const quad *q, double u, double v, double at[2], double j[4]) {
    for (int axis = 0; axis < 2; axis++) {
        double a = q->at[0][axis], b = q->at[1][axis], c = q->at[2][axis], d = q->at[3][axis];
        at[axis] = (a * (1 - u) + b * u) * (1 - v) + (d * (1 - u) + c * u) * v;
        j[2 * axis] = (b - a) * (1 - v) + (c - d) * v;
        j[2 * axis + 1] = (d - a) * (1 - u) + (c - b) * u;
    }
}

static double cross(const double a[2], const double b[2]) {
    return a[0] * b[1] - a[1] * b[0];
}

/* (u,v) in the face of a point: the roots of a quadratic, in the form that loses nothing where the
 * quadrilateral is a parallelogram. False if no root is in the face. */
static bool invert(const quad *q, const double p[2], double *u, double *v) {
    double e[2], f[2], g[2], h[2];
    for (int axis = 0; axis < 2; axis++) {
        e[axis] = q->at[1][axis] - q->at[0][axis];
        f[axis] = q->at[3][axis] - q->at[0][axis];
        g[axis] = q->at[0][axis] - q->at[1][axis] + q->at[2][axis] - q->at[3][axis];
        h[axis] = p[axis] - q->at[0][axis];
    }
    double a = cross(g, f), b = cross(e, f) + cross(h, g), c = cross(h, e);
    double root = b * b - 4 * a * c;
    if (!(root >= 0))
        return false;
    double t = -0.5 * (b + copysign(sqrt(root), b)), roots[2] = {c / t, t / a};
    for (int k = 0; k < 2; k++) {
        double y = roots[k], across[2] = {e[0] + g[0] * y, e[1] + g[1] * y};
        int axis = fabs(across[0]) > fabs(across[1]) ? 0 : 1;
        double x = (h[axis] - f[axis] * y) / across[axis];
        if (x >= -1e-9 && x <= 1 + 1e-9 && y >= -1e-9 && y <= 1 + 1e-9) {
            *u = fmin(fmax(x, 0), 1);
            *v = fmin(fmax(y, 0), 1);
            return true;
        }
    }
    return false;
}

/* The nearest point of the four sides. */
static double nearest(const quad *q, const double p[2], double *u, double *v) {
    double best = INFINITY;
    for (unsigned k = 0; k < 4; k++) {
        unsigned n = slvi_edge_next(k);
        double side[2] = {q->at[n][0] - q->at[k][0], q->at[n][1] - q->at[k][1]};
        double away[2] = {p[0] - q->at[k][0], p[1] - q->at[k][1]};
        double square = side[0] * side[0] + side[1] * side[1];
        double t = square > 0 ? (away[0] * side[0] + away[1] * side[1]) / square : 0;
        t = fmin(fmax(t, 0), 1);
        double distance = hypot(away[0] - t * side[0], away[1] - t * side[1]);
        if (distance < best) {
            best = distance;
            *u = slvi_corner_u(k) + (slvi_corner_u(n) - slvi_corner_u(k)) * t;
            *v = slvi_corner_v(k) + (slvi_corner_v(n) - slvi_corner_v(k)) * t;
        }
    }
    return best;
}

/* How (u,v) changes with x and y; false where the face has no area. */
static bool derivatives(const double j[4], double out[4]) {
    double det = j[0] * j[3] - j[1] * j[2];
    double size = fabs(j[0] * j[3]) + fabs(j[1] * j[2]);
    if (!(fabs(det) > 1e-6 * size) || !(fabs(det) > 1e-12))
        return false;
    out[0] = j[3] / det;  /* du/dx */
    out[1] = -j[1] / det; /* du/dy */
    out[2] = -j[2] / det;
    out[3] = j[0] / det;
    return true;
}

static double within(double x, double most) {
    return fmin(fmax(x, -most), most);
}

/* Fills an owner for a pixel whose middle is `p`. */
static void own(const quad *q, int32_t face, double distance, double u, double v, const double p[2],
                uv_owner *out) {
    double at[2], j[4], d[4] = {0, 0, 0, 0};
    map(q, u, v, at, j);
    bool flat = !derivatives(j, d);
    if (distance > 0 && !flat) {
        u += within(d[0] * (p[0] - at[0]) + d[1] * (p[1] - at[1]), 1);
        v += within(d[2] * (p[0] - at[0]) + d[3] * (p[1] - at[1]), 1);
    }
    *out = (uv_owner){.face = face,
                      .distance = (float)distance,
                      .u = (float)u,
                      .v = (float)v,
                      .du = {(float)within(d[0], 1), (float)within(d[1], 1)},
                      .dv = {(float)within(d[2], 1), (float)within(d[3], 1)}};
}

uint64_t slvi_uv_draw(const uv_band *band, int32_t face, const float corners[8], float reach) {
    const quad q = quad_of(band, corners);
    double left = fmax(floor(q.low[0] - (double)reach - 0.5), 0),
           right = fmin(ceil(q.high[0] + (double)reach - 0.5), (double)band->width - 1);
    double top = fmax(floor(q.low[1] - (double)reach - 0.5), (double)band->top),
           bottom = fmin(ceil(q.high[1] + (double)reach - 0.5),
                         (double)band->top + (double)band->rows - 1);
    uint64_t shared = 0;
    for (double y = top; y <= bottom; y++)
        for (double x = left; x <= right; x++) {
            uv_owner *owner = &band->owners[(size_t)(y - band->top) * band->width + (size_t)x];
            double p[2] = {x + 0.5, y + 0.5}, u, v, distance = 0;
            bool taken = owner->face >= 0 && owner->distance <= 0;
            if (taken) {
                shared +=
                    invert(&q, p, &u, &v) && u > 1e-6 && u < 1 - 1e-6 && v > 1e-6 && v < 1 - 1e-6;
                continue;
            }
            if (!invert(&q, p, &u, &v)) {
                distance = nearest(&q, p, &u, &v);
                if (distance > (double)reach ||
                    (owner->face >= 0 && (double)owner->distance <= (double)(float)distance))
                    continue;
            }
            own(&q, face, distance, u, v, p, owner);
        }
    return shared;
}
