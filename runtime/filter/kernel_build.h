/* Making kernels: the weights of each filter along one axis, as the Ptex library defines them. It
 * is done in two steps. Where kernels lie, and what their weights are made of, is found for eight
 * at once: along one axis for eight lookups, or along both axes for one. Weights are then made for
 * one kernel at a time. */
#ifndef SLV_FILTER_KERNEL_BUILD_H
#define SLV_FILTER_KERNEL_BUILD_H

#include "filter/kernel.h"
#include "filter/numbers.h"
#include "filter/vector.h"

#include <math.h>
#include <selvage/filter.h>

/* A piecewise cubic: for |x| < 1 near[0] + near[2] x^2 + near[3] x^3, for |x| < 2 far[0] + far[1] x
 * + ..., else 0. */
typedef struct kernel_cubic {
    float near[4], far[4];
} kernel_cubic;

/* How the filters of one set of parameters weigh. */
typedef struct kernel_shape {
    slv_filter filter;
    bool lerp;
    kernel_cubic cubic;
} kernel_shape;

/* Eight kernels along an axis: texels `start`, ..., `start + n - 1` of 2^res. */
typedef struct kernel_spans {
    v8i res, start, n;
    /* bilinear: the two weights; box: the first and the last weight; gaussian and cubics: from the
     * position to `start` in texels, and how much a texel is in units of the filter's width */
    v8f a, b;
    v8f whole;  /* bilinear and box: the sum of weights */
    v8f coarse; /* gaussian and cubics: how much of the next coarser resolution is in it */
} kernel_spans;

/* At positions x of spans that are p wide, both in texels of a resolution of more than four. */
static inline __attribute__((always_inline)) void kernel_lay_bilinear(v8f x, kernel_spans *out) {
    x -= 0.5f;
    out->start = v8_floor(x);
    out->b = x - v8_to_float(out->start);
    out->a = 1 - out->b;
    out->n = (v8i){2, 2, 2, 2, 2, 2, 2, 2};
    out->whole = out->a + out->b;
    out->coarse = v8_splat(0);
}

static inline __attribute__((always_inline)) void kernel_lay_box(v8f x, v8f p, kernel_spans *out) {
    v8f half = p * 0.5f, low = x - half, high = x + half;
    v8i end = v8_ceil(high);
    out->start = v8_floor(low);
    out->n = end - out->start;
    out->a = 1 - (low - v8_to_float(out->start));
    out->b = 1 - (v8_to_float(end) - high);
    out->whole = out->a + out->b + v8_to_float(out->n - 2);
    out->coarse = v8_splat(0);
}

/* The filters that span four texels at each resolution: gaussian and cubics. */
static inline __attribute__((always_inline)) void kernel_lay_wide(v8f x, v8f p, bool lerp,
                                                                  kernel_spans *out) {
    x -= 0.5f;
    v8i odd = lerp ? (p != 1.0f) & 1 : (v8i){0};
    out->whole = v8_splat(0);
    out->coarse = lerp ? p - 1 : v8_splat(0);
    out->start = v8_ceil(x - 2 * p) & ~odd;
    out->n = ((v8_ceil(x + 2 * p) + odd) & ~odd) - out->start;
    out->a = v8_to_float(out->start) - x;
    out->b = 1 / p;
}

static inline __attribute__((always_inline)) void kernel_lay_axes(const kernel_shape *shape, v8f x,
                                                                  v8f p, kernel_spans *out) {
    if (shape->filter == SLV_FILTER_BILINEAR)
        kernel_lay_bilinear(x, out);
    else if (shape->filter == SLV_FILTER_BOX)
        kernel_lay_box(x, p, out);
    else
        kernel_lay_wide(x, p, shape->lerp, out);
}

/* The wide ones have a shape of their own at each of the coarsest three resolutions. */
static inline __attribute__((always_inline)) void kernel_lay_coarse(v8f x, v8f w, v8f p, v8f middle,
                                                                    bool lerp, kernel_spans *out) {
    v8i is_one = out->res == 0, is_two = out->res == 1, is_four = out->res == 2;
    x -= 0.5f;
    v8f radius = v8_select(is_four, v8_splat(2), 2 * p);
    v8i odd = (lerp ? is_four | (p != 1.0f) : is_four) & 1;
    v8i start = v8_ceil(x - radius) & ~odd, end = (v8_ceil(x + radius) + odd) & ~odd;
    v8i below = v8_floor(middle);
    start = v8_select_int(is_one | is_two, below + (below & is_two), start);
    out->whole = v8_splat(0);
    out->coarse = lerp ? p - 1 : v8_splat(0);
    out->start = start;
    out->n = v8_select_int(is_one, (v8i){2, 2, 2, 2, 2, 2, 2, 2},
                           v8_select_int(is_two, (v8i){4, 4, 4, 4, 4, 4, 4, 4}, end - start));
    out->a = v8_to_float(start) - x;
    out->b = 1 / v8_select(is_four, w + 0.75f, v8_select(is_two, 1.5f * w + 0.5f, p));
}

/* At positions x, w wide, no finer than 2^-face_res, all in units of the face. */
static inline __attribute__((always_inline)) void
kernel_span_axes(const kernel_shape *shape, v8f x, v8f w, v8i face_res, kernel_spans *out) {
    bool wide = shape->filter != SLV_FILTER_BILINEAR && shape->filter != SLV_FILTER_BOX;
    w = v8_min(v8_max(w, v8_power_of_two(-face_res)), v8_splat(1));
    out->res = 127 - ((v8i)w >> 23);
    v8f size = v8_power_of_two(out->res), p = w * size;
    if (wide && !v8_all(out->res > 2))
        kernel_lay_coarse(x * size, w, p, x - 0.5f, shape->lerp, out);
    else
        kernel_lay_axes(shape, x * size, p, out);
}

static inline __attribute__((always_inline)) v8f kernel_smooth_step(v8f x) {
    v8f a = v8_abs(x);
    return v8_select(a < 1.0f, (2 * a - 3) * a * a + 1, v8_splat(0));
}

/* The filter's curve, in units of its width. */
static inline __attribute__((always_inline)) v8f kernel_curve(const kernel_shape *shape, v8f x) {
    if (shape->filter == SLV_FILTER_GAUSSIAN)
        return v8_exp2(x * x * -2.885390082f);
    v8f a = v8_abs(x), a2 = a * a;
    const float *n = shape->cubic.near, *f = shape->cubic.far;
    v8f near = (n[3] * a + n[2]) * a2 + n[0];
    v8f far = (f[3] * a + f[2]) * a2 + (f[1] * a + f[0]);
    return v8_select(a < 1.0f, near, v8_select(a < 2.0f, far, v8_splat(0)));
}

/* Weights from the one at `at` on, as far as there are so many. */
static inline __attribute__((always_inline)) float kernel_store_weights(kernel_axis *out, int at,
                                                                        v8f weights) {
    v8i there = (v8i){0, 1, 2, 3, 4, 5, 6, 7} + at < out->n;
    weights = v8_select(there, weights, v8_splat(0));
    memcpy(out->k + at, &weights, sizeof weights);
    return v8_sum(weights);
}

/* Between resolutions the weights of pairs of texels go over to those of the next coarser one. */
static inline __attribute__((always_inline)) float kernel_weigh_wide(const kernel_shape *shape,
                                                                     int res, float first,
                                                                     float step, float coarse,
                                                                     kernel_axis *out) {
    const v8f each = {0, 1, 2, 3, 4, 5, 6, 7};
    const v8f even = {0, 0, 2, 2, 4, 4, 6, 6}, odd = {0, 1, 0, 1, 0, 1, 0, 1};
    float fine = 1 - coarse;
    if (res > 2) {
        if (coarse == 0)
            return kernel_store_weights(out, 0, kernel_curve(shape, (each + first) * step));
        float sum = 0;
        for (int i = 0; i < out->n; i += 8) {
            v8f a = (even + (first + (float)i)) * step;
            v8f near = kernel_curve(shape, a + odd * step);
            v8f far = kernel_curve(shape, (a + (a + step)) * 0.5f);
            sum += kernel_store_weights(out, i, fine * near + coarse * far);
        }
        return sum;
    }
    if (res == 0) {
        out->k[0] = (2 * -first - 3) * first * first + 1;
        out->k[1] = 1 - out->k[0];
        return out->k[0] + out->k[1];
    }
    v8f a = even + first, both = a + (a + 1), near;
    if (res == 2) {
        near = kernel_curve(shape, a + odd);
        both *= 0.25f;
    } else {
        near = kernel_smooth_step((a + odd) * step);
        both *= 0.5f;
    }
    if (coarse == 0)
        return kernel_store_weights(out, 0, near);
    return kernel_store_weights(out, 0, fine * near + coarse * kernel_smooth_step(both * step));
}

/* Makes the weights of one span; returns their sum. */
static inline __attribute__((always_inline)) float kernel_weigh_span(const kernel_shape *shape,
                                                                     const kernel_spans *spans,
                                                                     int lane, kernel_axis *out) {
    float a = spans->a[lane], b = spans->b[lane];
    int n = out->n = spans->n[lane];
    if (shape->filter == SLV_FILTER_BILINEAR) {
        out->k[0] = a;
        out->k[1] = b;
        return spans->whole[lane];
    }
    if (shape->filter == SLV_FILTER_BOX) {
        out->k[1] = 1;
        out->k[n - 1] = b;
        out->k[0] = n == 1 ? spans->whole[lane] : a;
        return spans->whole[lane];
    }
    return kernel_weigh_wide(shape, spans->res[lane], a, b, spans->coarse[lane], out);
}

/* Makes the kernel of one span; returns the sum of its weights. */
static inline __attribute__((always_inline)) float kernel_weigh_axis(const kernel_shape *shape,
                                                                     const kernel_spans *spans,
                                                                     int lane, kernel_axis *out) {
    out->res = spans->res[lane];
    out->start = spans->start[lane];
    return kernel_weigh_span(shape, spans, lane, out);
}

/* Kernels of eight at once come in columns: weights[i] are their weights i, zeros where they have
 * none. */
#define KERNEL_GROUP 8

/* The weights of gaussians and cubics: two columns, as kernel_weigh_wide() has them. */
static inline __attribute__((always_inline)) void kernel_weigh_pair(const kernel_shape *shape,
                                                                    const kernel_spans *spans,
                                                                    bool fine, int at, v8f *out) {
    v8f x = spans->a, step = spans->b;
    if (fine) {
        out[0] = kernel_curve(shape, (x + (float)at) * step);
        out[1] = kernel_curve(shape, (x + (float)(at + 1)) * step);
        return;
    }
    v8f a = (x + (float)at) * step;
    v8f far = spans->coarse * kernel_curve(shape, (a + (a + step)) * 0.5f);
    out[0] = (1 - spans->coarse) * kernel_curve(shape, a) + far;
    out[1] = (1 - spans->coarse) * kernel_curve(shape, a + step) + far;
}

/* Makes the kernels of all spans, if these are short and simple enough; their sums, as
 * kernel_weigh_axis() has them, go to *sums. */
static inline __attribute__((always_inline)) bool kernel_weigh_group(const kernel_shape *shape,
                                                                     const kernel_spans *spans,
                                                                     int longest, v8f *weights,
                                                                     v8f *sums) {
    if (shape->filter == SLV_FILTER_BILINEAR) {
        weights[0] = spans->a;
        weights[1] = spans->b;
        *sums = spans->whole;
        return true;
    }
    if (longest > KERNEL_GROUP)
        return false;
    if (shape->filter == SLV_FILTER_BOX) {
        *sums = spans->whole;
        weights[0] = v8_select(spans->n == 1, *sums, spans->a);
        for (int i = 1; i < longest; i++)
            weights[i] = v8_select(spans->n == i + 1, spans->b, v8_splat(1));
        return true;
    }
    v8i whole = spans->coarse == 0.0f;
    bool fine = v8_all(whole);
    if (!v8_all(spans->res > 2) || (!fine && !v8_none(whole)))
        return false;
    v8f w[KERNEL_GROUP];
    _Pragma("GCC unroll 4") for (int i = 0; i < KERNEL_GROUP; i += 2) {
        w[i] = w[i + 1] = v8_splat(0);
        if (i >= longest)
            continue;
        kernel_weigh_pair(shape, spans, fine, i, w + i);
        w[i] = v8_select(spans->n > i, w[i], v8_splat(0));
        w[i + 1] = v8_select(spans->n > i + 1, w[i + 1], v8_splat(0));
        weights[i] = w[i];
        weights[i + 1] = w[i + 1];
    }
    *sums = ((w[0] + w[4]) + (w[2] + w[6])) + ((w[1] + w[5]) + (w[3] + w[7]));
    return true;
}

/* Makes the kernel of a lookup; returns its whole weight. */
static inline __attribute__((always_inline)) float kernel_build(const kernel_shape *shape, float u,
                                                                float v, float uw, float vw,
                                                                int res_u, int res_v, kernel *out) {
    kernel_spans spans;
    kernel_span_axes(shape, (v8f){u, v}, (v8f){uw, vw}, (v8i){res_u, res_v}, &spans);
    out->turns = 0;
    return kernel_weigh_axis(shape, &spans, 0, &out->a[0]) *
           kernel_weigh_axis(shape, &spans, 1, &out->a[1]);
}

#endif
