/* Making kernels: the weights of each filter along one axis, as the Ptex library defines them. */
#ifndef SLV_FILTER_KERNEL_BUILD_H
#define SLV_FILTER_KERNEL_BUILD_H

#include "filter/kernel.h"
#include "filter/vector.h"

#include <math.h>
#include <selvage/filter.h>

/* A piecewise cubic: for |x| < 1 near[0] + near[2] x^2 + near[3] x^3, for |x| < 2 far[0] + far[1] x
 * + ..., else 0. */
typedef struct cubic_pieces {
    float near[4], far[4];
} cubic_pieces;

/* How the filters of one set of parameters weigh. */
typedef struct kernel_shape {
    slv_filter filter;
    bool lerp;
    cubic_pieces cubic;
} kernel_shape;

/* -floor(log2 w), for normal w */
static inline int negative_log2(float w) {
    int32_t bits;
    memcpy(&bits, &w, sizeof bits);
    return 127 - (bits >> 23 & 0xff);
}

/* 2^n, for -126 < n < 128 */
static inline float power_of_two(int n) {
    int32_t bits = (n + 127) << 23;
    float f;
    memcpy(&f, &bits, sizeof f);
    return f;
}

/* floorf and ceilf of what fits an int, without a call. */
static inline int floor_int(float x) {
    int i = (int)x;
    return i - ((float)i > x);
}

static inline int ceil_int(float x) {
    int i = (int)x;
    return i + ((float)i < x);
}

/* All of these return the sum of the weights. */

static inline float build_bilinear(float u, float w, int face_res, kernel_axis *out) {
    float least = power_of_two(-face_res);
    w = w > 1 ? 1 : w < least ? least : w;
    out->res = negative_log2(w);
    float x = u * power_of_two(out->res) - 0.5f;
    out->start = floor_int(x);
    float t = x - (float)out->start;
    out->n = 2;
    out->k[0] = 1 - t;
    out->k[1] = t;
    return out->k[0] + t;
}

static inline float build_box(float u, float w, int face_res, kernel_axis *out) {
    float least = power_of_two(-face_res);
    w = w > 1 ? 1 : w < least ? least : w;
    out->res = negative_log2(w);
    float size = power_of_two(out->res), x = u * size, half = w * size * 0.5f;
    float a = x - half, b = x + half;
    int end = ceil_int(b);
    out->start = floor_int(a);
    out->n = end - out->start;
    float first = 1 - (a - (float)out->start), last = 1 - ((float)end - b);
    if (out->n == 1) {
        out->k[0] = first + last - 1;
        return out->k[0];
    }
    out->k[0] = first;
    out->k[1] = 1;
    out->k[out->n - 1] = last;
    return first + last + (float)(out->n - 2);
}

static inline v8f smooth_step(v8f x) {
    v8f a = v8_abs(x);
    return v8_select(a < 1.0f, (2 * a - 3) * a * a + 1, v8_splat(0));
}

/* The filter's curve, in units of its width. */
static inline __attribute__((always_inline)) v8f filter_curve(const kernel_shape *shape, v8f x) {
    if (shape->filter == SLV_FILTER_GAUSSIAN)
        return v8_exp2(x * x * -2.885390082f);
    v8f a = v8_abs(x), a2 = a * a;
    const float *n = shape->cubic.near, *f = shape->cubic.far;
    v8f near = (n[3] * a + n[2]) * a2 + n[0];
    v8f far = (f[3] * a + f[2]) * a2 + (f[1] * a + f[0]);
    return v8_select(a < 1.0f, near, v8_select(a < 2.0f, far, v8_splat(0)));
}

/* Weights from the one at `at` on, as far as there are so many. */
static inline __attribute__((always_inline)) float store_weights(kernel_axis *out, int at,
                                                                 v8f weights) {
    v8i there = (v8i){0, 1, 2, 3, 4, 5, 6, 7} + at < out->n;
    weights = v8_select(there, weights, v8_splat(0));
    memcpy(out->k + at, &weights, sizeof weights);
    return v8_sum(weights);
}

/* The filters that span four texels at each resolution: gaussian and cubics. Between resolutions
 * the weights of pairs of texels go over to those of the next coarser resolution. */
static inline __attribute__((always_inline)) float
build_wide(const kernel_shape *shape, float u, float w, int face_res, kernel_axis *out) {
    const v8f each = {0, 1, 2, 3, 4, 5, 6, 7};
    const v8f even = {0, 0, 2, 2, 4, 4, 6, 6}, odd = {0, 1, 0, 1, 0, 1, 0, 1};
    float least = power_of_two(-face_res);
    w = w < least ? least : w;
    if (w >= 1) {
        out->res = 0;
        float x = u - 0.5f;
        out->start = floor_int(x);
        float t = x - (float)out->start;
        out->n = 2;
        out->k[0] = (2 * t - 3) * t * t + 1;
        out->k[1] = 1 - out->k[0];
        return out->k[0] + out->k[1];
    }
    out->res = negative_log2(w);
    float size = power_of_two(out->res);
    float coarse = shape->lerp ? w * size - 1 : 0, fine = 1 - coarse;
    if (w < 0.25f) {
        float x = u * size - 0.5f, p = w * size, step = 1 / p;
        int first = ceil_int(x - 2 * p), end = ceil_int(x + 2 * p);
        if (coarse == 0) {
            out->start = first;
            out->n = end - first;
            return store_weights(out, 0, filter_curve(shape, (each + ((float)first - x)) * step));
        }
        float sum = 0;
        first &= ~1;
        end = (end + 1) & ~1;
        out->start = first;
        out->n = end - first;
        for (int i = 0; i < out->n; i += 8) {
            v8f a = (even + ((float)(first + i) - x)) * step;
            v8f near = filter_curve(shape, a + odd * step);
            v8f far = filter_curve(shape, (a + (a + step)) * 0.5f);
            sum += store_weights(out, i, fine * near + coarse * far);
        }
        return sum;
    }
    if (w < 0.5f) {
        float x = 4 * u - 0.5f, s = 1 / (w + 0.75f);
        int first = ceil_int(x - 2) & ~1, end = (ceil_int(x + 2) + 1) & ~1;
        out->start = first;
        out->n = end - first;
        v8f a = even + ((float)first - x), both = (a + (a + 1)) * 0.25f;
        v8f near = filter_curve(shape, a + odd);
        if (coarse == 0)
            return store_weights(out, 0, near);
        return store_weights(out, 0, fine * near + coarse * smooth_step(both * s));
    }
    float x = 2 * u - 0.5f, s = 1 / (1.5f * w + 0.5f);
    out->start = 2 * floor_int(u - 0.5f);
    out->n = 4;
    v8f a = even + ((float)out->start - x), both = (a + (a + 1)) * 0.5f;
    v8f near = smooth_step((a + odd) * s);
    if (coarse == 0)
        return store_weights(out, 0, near);
    return store_weights(out, 0, fine * near + coarse * smooth_step(both * s));
}

static inline __attribute__((always_inline)) float
build_axis(const kernel_shape *shape, float u, float w, int face_res, kernel_axis *out) {
    if (shape->filter == SLV_FILTER_BILINEAR)
        return build_bilinear(u, w, face_res, out);
    if (shape->filter == SLV_FILTER_BOX)
        return build_box(u, w, face_res, out);
    return build_wide(shape, u, w, face_res, out);
}

#endif
