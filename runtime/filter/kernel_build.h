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
    v8f coarse; /* gaussian and cubics: how much of the next coarser resolution is in it */
} kernel_spans;

/* At positions x, w wide, no finer than 2^-face_res, all in units of the face. */
static inline __attribute__((always_inline)) void kernel_span_bilinear(v8f x, v8f w, v8i face_res,
                                                                       kernel_spans *out) {
    w = v8_min(v8_max(w, v8_power_of_two(-face_res)), v8_splat(1));
    out->res = 127 - ((v8i)w >> 23);
    x = x * v8_power_of_two(out->res) - 0.5f;
    out->start = v8_floor(x);
    out->b = x - v8_to_float(out->start);
    out->a = 1 - out->b;
    out->n = (v8i){2, 2, 2, 2, 2, 2, 2, 2};
    out->coarse = v8_splat(0);
}

static inline __attribute__((always_inline)) void kernel_span_box(v8f x, v8f w, v8i face_res,
                                                                  kernel_spans *out) {
    w = v8_min(v8_max(w, v8_power_of_two(-face_res)), v8_splat(1));
    out->res = 127 - ((v8i)w >> 23);
    v8f size = v8_power_of_two(out->res), half = w * size * 0.5f;
    x *= size;
    v8f low = x - half, high = x + half;
    v8i end = v8_ceil(high);
    out->start = v8_floor(low);
    out->n = end - out->start;
    out->a = 1 - (low - v8_to_float(out->start));
    out->b = 1 - (v8_to_float(end) - high);
    out->coarse = v8_splat(0);
}

/* The filters that span four texels at each resolution: gaussian and cubics. They have a shape of
 * their own at each of the coarsest three resolutions. */
static inline __attribute__((always_inline)) void kernel_span_wide(v8f x, v8f w, v8i face_res,
                                                                   bool lerp, kernel_spans *out) {
    w = v8_min(v8_max(w, v8_power_of_two(-face_res)), v8_splat(1));
    out->res = 127 - ((v8i)w >> 23);
    v8f size = v8_power_of_two(out->res), p = w * size, middle = x - 0.5f;
    v8i is_one = out->res == 0, is_two = out->res == 1, is_four = out->res == 2;
    x = x * size - 0.5f;
    v8f radius = v8_select(is_four, v8_splat(2), 2 * p);
    v8i even = is_four, start = v8_ceil(x - radius), end = v8_ceil(x + radius);
    out->coarse = v8_splat(0);
    if (lerp) {
        out->coarse = p - 1;
        even |= p != 1.0f;
    }
    start &= ~(even & 1);
    end = (end + (even & 1)) & ~(even & 1);
    v8i below = v8_floor(middle);
    start = v8_select_int(is_one | is_two, below + (below & is_two), start);
    out->start = start;
    out->n = v8_select_int(is_one, (v8i){2, 2, 2, 2, 2, 2, 2, 2},
                           v8_select_int(is_two, (v8i){4, 4, 4, 4, 4, 4, 4, 4}, end - start));
    out->a = v8_to_float(start) - x;
    out->b = 1 / v8_select(is_four, w + 0.75f, v8_select(is_two, 1.5f * w + 0.5f, p));
}

static inline __attribute__((always_inline)) void
kernel_span_axes(const kernel_shape *shape, v8f x, v8f w, v8i face_res, kernel_spans *out) {
    if (shape->filter == SLV_FILTER_BILINEAR)
        kernel_span_bilinear(x, w, face_res, out);
    else if (shape->filter == SLV_FILTER_BOX)
        kernel_span_box(x, w, face_res, out);
    else
        kernel_span_wide(x, w, face_res, shape->lerp, out);
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
                                                                     float first, float step,
                                                                     float coarse,
                                                                     kernel_axis *out) {
    const v8f each = {0, 1, 2, 3, 4, 5, 6, 7};
    const v8f even = {0, 0, 2, 2, 4, 4, 6, 6}, odd = {0, 1, 0, 1, 0, 1, 0, 1};
    float fine = 1 - coarse;
    if (out->res > 2) {
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
    if (out->res == 0) {
        out->k[0] = (2 * -first - 3) * first * first + 1;
        out->k[1] = 1 - out->k[0];
        return out->k[0] + out->k[1];
    }
    v8f a = even + first, both = a + (a + 1), near;
    if (out->res == 2) {
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

/* Makes the kernel of one span; returns the sum of its weights. */
static inline __attribute__((always_inline)) float kernel_weigh_axis(const kernel_shape *shape,
                                                                     const kernel_spans *spans,
                                                                     int lane, kernel_axis *out) {
    float a = spans->a[lane], b = spans->b[lane];
    out->res = spans->res[lane];
    out->start = spans->start[lane];
    int n = out->n = spans->n[lane];
    if (shape->filter == SLV_FILTER_BILINEAR) {
        out->k[0] = a;
        out->k[1] = b;
        return a + b;
    }
    if (shape->filter == SLV_FILTER_BOX) {
        float sum = a + b + (float)(n - 2);
        out->k[1] = 1;
        out->k[n - 1] = b;
        out->k[0] = n == 1 ? sum : a;
        return sum;
    }
    return kernel_weigh_wide(shape, a, b, spans->coarse[lane], out);
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
