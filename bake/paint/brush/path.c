/* The curve through samples: cubic pieces whose tangents are those of parabolas through three
 * samples, by chord length (Overhauser). Where a pen is asked more often the pieces are shorter and
 * the curve is the same up to the third power of their length. */
#include "brush/path.h"

#include <math.h>

enum { PIECES = 16 };
/* A pen that rests is told now and then, since time passes for brushes. */
#define REST 0.05

static double chord(const slvi_path_point *a, const slvi_path_point *b) {
    return hypot(b->x - a->x, b->y - a->y);
}

/* The slope of the parabola through three samples, at the middle one; and at its beginning, which
 * with the samples reversed is that at its end with its sign changed. */
static double slope_within(double a, double b, double c, double h0, double h1) {
    return ((b - a) / h0 * h1 + (c - b) / h1 * h0) / (h0 + h1);
}

static double slope_at_end(double a, double b, double c, double h0, double h1) {
    return 2 * (b - a) / h0 - slope_within(a, b, c, h0, h1);
}

/* From one sample to the next with the tangents there, x and y. */
static void emit(const slvi_path *path, const slvi_path_point *a, const slvi_path_point *b,
                 const double ta[2], const double tb[2]) {
    double h = chord(a, b);
    slvi_path_point from = *a;
    int pieces = h > path->smallest * PIECES ? PIECES : 1 + (int)(h / path->smallest);
    for (int i = 1; i <= pieces; i++) {
        double t = (double)i / pieces, s = 1 - t;
        double wa = s * s * (1 + 2 * t), wb = t * t * (1 + 2 * s), va = s * s * t * h,
               vb = -t * t * s * h;
        float f = (float)t;
        slvi_path_point to = {wa * a->x + wb * b->x + va * ta[0] + vb * tb[0],
                              wa * a->y + wb * b->y + va * ta[1] + vb * tb[1],
                              s * a->time + t * b->time,
                              a->pressure + f * (b->pressure - a->pressure),
                              a->tilt_x + f * (b->tilt_x - a->tilt_x),
                              a->tilt_y + f * (b->tilt_y - a->tilt_y)};
        path->piece(path->user, &from, &to);
        from = to;
    }
}

static void find_tangent(const slvi_path_point *a, const slvi_path_point *b,
                         const slvi_path_point *c,
                         double (*slope)(double, double, double, double, double), double out[2]) {
    double h0 = chord(a, b), h1 = chord(b, c);
    out[0] = slope(a->x, b->x, c->x, h0, h1);
    out[1] = slope(a->y, b->y, c->y, h0, h1);
}

void slvi_path_end(slvi_path *path) {
    slvi_path_point *p = path->last;
    double ta[2], tb[2];
    if (path->count == 2) {
        double h = chord(&p[0], &p[1]);
        ta[0] = tb[0] = (p[1].x - p[0].x) / h;
        ta[1] = tb[1] = (p[1].y - p[0].y) / h;
        emit(path, &p[0], &p[1], ta, tb);
    } else if (path->count == 3) {
        find_tangent(&p[0], &p[1], &p[2], slope_within, ta);
        find_tangent(&p[2], &p[1], &p[0], slope_at_end, tb);
        tb[0] = -tb[0];
        tb[1] = -tb[1];
        emit(path, &p[1], &p[2], ta, tb);
    }
    path->count = 0;
}

void slvi_path_add(slvi_path *path, const slvi_path_point *sample) {
    slvi_path_point *p = path->last;
    double ta[2], tb[2];
    if (path->count && chord(&p[path->count - 1], sample) < path->smallest) {
        slvi_path_point newest = p[path->count - 1];
        if (sample->time - newest.time < REST)
            return;
        slvi_path_end(path);
        path->piece(path->user, &newest, sample);
    }
    if (path->count < 2) {
        p[path->count++] = *sample;
        return;
    }
    if (path->count == 2) {
        find_tangent(&p[0], &p[1], sample, slope_at_end, ta);
        find_tangent(&p[0], &p[1], sample, slope_within, tb);
        emit(path, &p[0], &p[1], ta, tb);
        p[path->count++] = *sample;
        return;
    }
    find_tangent(&p[0], &p[1], &p[2], slope_within, ta);
    find_tangent(&p[1], &p[2], sample, slope_within, tb);
    emit(path, &p[1], &p[2], ta, tb);
    p[0] = p[1];
    p[1] = p[2];
    p[2] = *sample;
}
