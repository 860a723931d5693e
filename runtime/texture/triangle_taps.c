/* Gaussians over lattices of triangles. Cartesian coordinates are those of equilateral triangles;
 * the unit is a texel's side. */
#include "texture/triangle_taps.h"

#include <math.h>

/* The Ptex library's gaussian for magnified lookups: variance 1/4, cut off at 3.5 deviations. */
#define VARIANCE 0.25
#define CUT_OFF (3.5 * 3.5)
#define REACH 2 /* cells that it reaches into, and none beyond */

/* Where a sample is on the lattice, and how that changes along s and t from sample to sample. */
typedef struct place {
    double at[2], ds[2], dt[2]; /* u, v */
} place;

static place place_of(const slvi_tile *tile, double x, double y) {
    double n = ldexp(1, tile->log2), count = ldexp(1, slv_triangle_subface_log2(tile->log2));
    double s = x / count, t = y / count, step = n / count;
    const double next[3] = {s * (3 - t) / 6, (3 - t) / 6 * step, -s / 6 * step},
                 before[3] = {t * (3 - s) / 6, -t / 6 * step, (3 - s) / 6 * step};
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
        double here = (i == 0) - next[i] - before[i];
        u[i] = tile->sub == 1 ? here : tile->sub == 0 ? next[i] : before[i];
        v[i] = tile->sub == 2 ? here : tile->sub == 1 ? next[i] : before[i];
    }
    return (place){{u[0] * n, v[0] * n}, {u[1], v[1]}, {u[2], v[2]}};
}

slvi_lattice slvi_triangle_window(const slvi_tile *tile) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int corner = 0; corner < 4; corner++) {
        place p = place_of(tile, tile->x + (corner & 1 ? tile->width : 0),
                           tile->y + (corner & 2 ? tile->height : 0));
        for (int i = 0; i < 2; i++) {
            low[i] = fmin(low[i], p.at[i]);
            high[i] = fmax(high[i], p.at[i]);
        }
    }
    int32_t u0 = (int32_t)floor(low[0]) - REACH, v0 = (int32_t)floor(low[1]) - REACH;
    return (slvi_lattice){u0, v0, (int32_t)floor(high[0]) + REACH + 1 - u0,
                          (int32_t)floor(high[1]) + REACH + 1 - v0};
}

/* The form a du^2 + b du dv + c dv^2 that is the squared number of deviations. A bilinear lookup
 * adds a sixth of the square of the distance to the next sample along s, and along t, to the
 * variance: so much less is left to the gaussian. */
static void form_of(const place *p, double form[3]) {
    const double root = 0.8660254037844386;
    double sx = p->ds[0] + 0.5 * p->ds[1], sy = root * p->ds[1];
    double tx = p->dt[0] + 0.5 * p->dt[1], ty = root * p->dt[1];
    double xx = VARIANCE - (sx * sx + tx * tx) / 6, xy = -(sx * sy + tx * ty) / 6,
           yy = VARIANCE - (sy * sy + ty * ty) / 6, scale = 1 / (xx * yy - xy * xy);
    double a = yy * scale, b = -xy * scale, c = xx * scale;
    /* x = u + v / 2, y = root v */
    form[0] = a;
    form[1] = a + 2 * root * b;
    form[2] = 0.25 * a + root * b + 0.75 * c;
}

static uint8_t taps_of(const place *p, const slvi_lattice *w, slvi_tap *taps) {
    double form[3];
    uint8_t count = 0;
    form_of(p, form);
    int32_t u = (int32_t)floor(p->at[0]), v = (int32_t)floor(p->at[1]);
    for (int32_t j = v - REACH; j <= v + REACH; j++)
        for (int32_t i = u - REACH; i <= u + REACH; i++)
            for (int odd = 0; odd < 2; odd++) {
                double du = i + (1 + odd) / 3.0 - p->at[0], dv = j + (1 + odd) / 3.0 - p->at[1];
                double q = form[0] * du * du + form[1] * du * dv + form[2] * dv * dv;
                if (q >= CUT_OFF || count == SLVI_TAPS)
                    continue;
                taps[count++] = (slvi_tap){2 * ((j - w->v0) * w->width + i - w->u0) + odd,
                                           expf((float)(-0.5 * q))};
            }
    return count;
}

void slvi_triangle_taps(const slvi_tile *tile, const slvi_lattice *window, slvi_tap *taps,
                        uint8_t *counts) {
    for (uint32_t y = 0; y < tile->height; y++)
        for (uint32_t x = 0; x < tile->width; x++) {
            place p = place_of(tile, tile->x + x + 0.5, tile->y + y + 0.5);
            *counts++ = taps_of(&p, window, taps);
            taps += SLVI_TAPS;
        }
}
