/* A separable filter kernel: a rectangle of texels of one resolution, each weighted by the product
 * of a weight along u and one along v. */
#ifndef SLV_FILTER_KERNEL_H
#define SLV_FILTER_KERNEL_H

#include "adjacency/edge.h"
#include "filter/vector.h"

#include <stdbool.h>

/* A filter spans 10 texels at most; the resolution changes between a face and its sub-face
 * neighbours double spans of up to 8 at the very coarsest. The rest is room for whole vectors from
 * any of them on. */
#define KERNEL_MAX 16
#define KERNEL_ROOM 32

/* The texels start, start+1, ... of 2^res along one axis. */
typedef struct kernel_axis {
    int res, start, n;
    float k[KERNEL_ROOM]; /* n weights, and whatever */
} kernel_axis;

/* [0] along u, [1] along v. `turns`: quarter turns since it left its first face. */
typedef struct kernel {
    kernel_axis a[2];
    int turns;
} kernel;

static inline float kernel_axis_sum(const kernel_axis *a) {
    float sum = 0;
    for (int i = 0; i < a->n; i++)
        sum += a->k[i];
    return sum;
}

static inline float kernel_weight(const kernel *k) {
    return kernel_axis_sum(&k->a[0]) * kernel_axis_sum(&k->a[1]);
}

static inline bool kernel_is_empty(const kernel *k) {
    return k->a[0].n <= 0 || k->a[1].n <= 0;
}

/* Whether it reaches beyond no edge of its face. */
static inline __attribute__((always_inline)) bool kernel_is_inside(const kernel *k) {
    const kernel_axis *u = &k->a[0], *v = &k->a[1];
    int outside =
        u->start | ((1 << u->res) - u->n - u->start) | v->start | ((1 << v->res) - v->n - v->start);
    return outside >= 0;
}

/* The part of `from` that begins at its texel `first`. */
static inline void kernel_axis_take(const kernel_axis *from, int first, int n, kernel_axis *to) {
    v8f low, high;
    to->res = from->res;
    to->start = from->start + first;
    to->n = n;
    memcpy(&low, from->k + first, sizeof low);
    memcpy(&high, from->k + first + 8, sizeof high);
    memcpy(to->k, &low, sizeof low);
    memcpy(to->k + 8, &high, sizeof high);
}

/* Drops weights that are zero from both ends. */
static inline void kernel_axis_strip(kernel_axis *a) {
    int first = 0;
    while (a->n > 1 && a->k[a->n - 1] == 0)
        a->n--;
    while (first < a->n - 1 && a->k[first] == 0)
        first++;
    if (first)
        kernel_axis_take(a, first, a->n - first, a);
}

/* Twice the resolution: every weight becomes two halves. */
static inline void kernel_axis_upsample(kernel_axis *a) {
    a->n = a->n > KERNEL_MAX / 2 ? KERNEL_MAX / 2 : a->n;
    for (int i = a->n - 1; i >= 0; i--)
        a->k[2 * i] = a->k[2 * i + 1] = a->k[i] * 0.5f;
    a->start *= 2;
    a->n *= 2;
    a->res++;
}

/* Half the resolution: weights of texels that become one are added. */
static inline void kernel_axis_downsample(kernel_axis *a) {
    int start = a->start >> 1, n = a->n ? ((a->start + a->n - 1) >> 1) - start + 1 : 0;
    int from = 0, odd = a->start & 1;
    for (int i = 0; i < n; i++) {
        float k = a->k[from++];
        if (!(i == 0 && odd) && from < a->n)
            k += a->k[from++];
        a->k[i] = k;
    }
    a->start = start;
    a->n = n;
    a->res--;
}

/* The same texels seen from the other end. */
static inline void kernel_axis_reverse(kernel_axis *a) {
    v8f low, high;
    float turned[2 * KERNEL_MAX] = {0};
    memcpy(&low, a->k, sizeof low);
    memcpy(&high, a->k + 8, sizeof high);
    low = v8_reverse(low);
    high = v8_reverse(high);
    memcpy(turned, &high, sizeof high);
    memcpy(turned + 8, &low, sizeof low);
    memcpy(a->k, turned + KERNEL_MAX - a->n, KERNEL_MAX * sizeof *turned);
    a->start = (1 << a->res) - a->start - a->n;
}

/* Quarter turns of the unit square: 1 takes (x,y) to (y,1-x), 2 to (1-x,1-y), 3 to (1-y,x). */
static inline void kernel_turn(kernel *k, int turns) {
    turns &= 3;
    k->turns = (k->turns + turns) & 3;
    if (turns & 1) {
        kernel_axis u = k->a[0];
        k->a[0] = k->a[1];
        k->a[1] = u;
    }
    if (turns == 2 || turns == 3)
        kernel_axis_reverse(&k->a[0]);
    if (turns == 1 || turns == 2)
        kernel_axis_reverse(&k->a[1]);
}

/* Whether it reaches beyond an edge of its face. */
static inline bool kernel_crosses(const kernel *k, int edge) {
    const kernel_axis *a = &k->a[!slvi_edge_along_v((unsigned)edge)];
    return slvi_edge_is_far((unsigned)edge) ? a->start + a->n > 1 << a->res : a->start < 0;
}

/* Gives the weight outside of an edge to the texels along it, or drops it. */
static inline void kernel_merge(kernel *k, int edge, bool drop) {
    kernel_axis *a = &k->a[!slvi_edge_along_v((unsigned)edge)];
    int size = 1 << a->res;
    if (!slvi_edge_is_far((unsigned)edge)) {
        int outside = -a->start < a->n ? -a->start : a->n;
        float sum = 0;
        for (int i = 0; i < outside; i++)
            sum += a->k[i];
        if (outside == a->n && !drop) {
            a->k[0] = sum;
            a->n = 1;
            a->start = 0;
            return;
        }
        kernel_axis_take(a, outside, a->n - outside, a);
        a->start = 0;
        if (!drop)
            a->k[0] += sum;
    } else {
        int inside = size - a->start > 0 ? size - a->start : 0;
        float sum = 0;
        for (int i = inside; i < a->n; i++)
            sum += a->k[i];
        if (inside == 0 && !drop) {
            a->k[0] = sum;
            a->n = 1;
            a->start = size - 1;
            return;
        }
        a->n = inside;
        if (!drop)
            a->k[inside - 1] += sum;
    }
}

/* Cuts off what lies outside of an edge, in the coordinates of a face on the other side that is
 * turned like this one. A piece counts its turns anew, a kernel that moves as a whole does not: so
 * does the Ptex library. */
static inline void kernel_split(kernel *k, int edge, kernel *out) {
    int axis = !slvi_edge_along_v((unsigned)edge);
    kernel_axis *a = &k->a[axis], *to = &out->a[axis];
    int size = 1 << a->res;
    bool low = !slvi_edge_is_far((unsigned)edge);
    int outside = low ? -a->start : a->start + a->n - size;
    if (outside >= a->n) {
        for (int i = 0; i < 2; i++)
            kernel_axis_take(&k->a[i], 0, k->a[i].n, &out->a[i]);
        out->turns = k->turns;
        to->start += low ? size : -size;
        a->n = 0;
        return;
    }
    out->turns = 0;
    kernel_axis_take(&k->a[!axis], 0, k->a[!axis].n, &out->a[!axis]);
    kernel_axis_take(a, low ? 0 : a->n - outside, outside, to);
    to->start = low ? size - outside : 0;
    a->n -= outside;
    if (low)
        kernel_axis_take(a, outside, a->n, a);
}

#endif
