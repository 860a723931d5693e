/* Template: most lookups, which are on a face that is there, of few channels from the first on: the
 * steps that single lookups and groups of them share, and single ones. */
#ifndef SLV_FILTER_QUICK_TEMPLATE_H
#define SLV_FILTER_QUICK_TEMPLATE_H

#include "filter/any_template.h"

#include <stddef.h>

static inline __attribute__((always_inline)) void quick_put(v4f sum, uint32_t count, float *out) {
    if (count >= 2)
        memcpy(out, &sum, 2 * sizeof *out);
    else
        out[0] = sum[0];
    if (count >= 3)
        out[2] = sum[2];
    if (count >= 4)
        out[3] = sum[3];
}

/* A kernel that reaches beyond its face, or whose texels are not there yet. The parameters are what
 * the quick way has found, so that nothing is looked for twice. */
static __attribute__((noinline)) bool quick_across(slv_sampler *s, cache_tables *t, uint32_t face,
                                                   cache_face *f, kernel *k, float weight,
                                                   uint32_t count, float *out, slv_result *result) {
    float sum[4] = {0};
    lookup_state state = {.sampler = s, .tables = t, .count = count, .sum = sum};
    any_kernel(&state, face, f, k, weight);
    cache_count(&s->thread.pieces, state.pieces);
    cache_count(&s->thread.slow, 1);
    *result = state.result;
    if (state.gone)
        return false;
    float scale = state.weight == 0 || state.result ? 0 : t->scale / state.weight;
    for (uint32_t c = 0; c < count; c++)
        out[c] = scale == 0 ? 0 : sum[c] * scale + 0;
    return true;
}

/* Whether spans lie within their faces, or within an apron where there is one. */
typedef struct quick_reach {
    v8i inside, small;
} quick_reach;

static inline __attribute__((always_inline)) void
quick_find_reach(const slv_sampler *s, const kernel_spans *spans, quick_reach *out) {
    v8i size = v8_to_int(v8_power_of_two(spans->res)), after = size - spans->n - spans->start;
    /* no wider than the face */
    v8i width = v8_select_int(size < APRON_WIDTH, size, (v8i){0} + APRON_WIDTH);
    out->inside = (spans->start | after) >= 0;
    out->small = (((spans->start + width) | (after + width)) >= 0) & (spans->res <= APRON_LOG2);
    if (s->no_edge_blend)
        out->small = (v8i){0};
}

/* The resolution of a face that was looked for last: neighbours mostly want the same. */
typedef struct quick_last {
    const cache_face *face;
    int res_u, res_v;
    const uint8_t *apron, *inner;
} quick_last;

/* The texels under a kernel, or NULL if they are to be looked for. Inlined everywhere, so that its
 * parameters cost nothing. */
static inline __attribute__((always_inline)) const uint8_t *
quick_find_texels(const cache_view *cache, const cache_tables *t, uint32_t face, cache_face *f,
                  bool small, bool inside, kernel *k, quick_last *last, size_t *pitch) {
    int res_u = k->a[0].res, res_v = k->a[1].res;
    *pitch = (size_t)1 << res_u;
    if (f != last->face || res_u != last->res_u || res_v != last->res_v)
        *last = (quick_last){f, res_u, res_v, NULL, NULL};
    if (small) {
        if (!last->apron)
            last->apron = cache_find_apron(cache, t, f, res_u, res_v);
        if (!last->apron || !apron_covers(last->apron, k))
            return NULL;
        *pitch = apron_pitch(res_u);
        return last->apron;
    }
    if (!inside)
        return NULL;
    if (!last->inner && res_u == f->res_u && res_v == f->res_v)
        last->inner = cache_find_full(cache, f);
    else if (!last->inner && res_u + res_v <= t->whole_log2)
        last->inner = cache_find_hashed(cache, t, face, res_u, res_v, 0);
    return last->inner;
}

/* Whether most lookups can be done at this face. */
static inline __attribute__((always_inline)) bool quick_fits(const slv_sampler *s,
                                                             const cache_face *f) {
    return atomic_load_explicit(&f->state, memory_order_acquire) == CACHE_KNOWN &&
           cache_is_plain(f) && !s->first_channel;
}

static inline __attribute__((always_inline)) void quick_put_zeros(const slv_sampler *s,
                                                                  uint32_t from, float *out) {
    if (s->nchannels != UINT32_MAX)
        for (uint32_t c = from; c < s->nchannels; c++)
            out[c] = 0;
}

/* What floats of 0 <= x < 1 are less than, taken as integers; not -0, which is no loss. */
#define QUICK_UNIT_BITS 0x3f800000

_Static_assert(sizeof(slv_lookup) == 32 && offsetof(slv_lookup, file) == 0 &&
                   offsetof(slv_lookup, face) == 4 && offsetof(slv_lookup, u) == 8 &&
                   offsetof(slv_lookup, uw1) == 16 && offsetof(slv_lookup, uw2) == 24,
               "a lookup is a row of eight values");

static inline __attribute__((always_inline)) void
quick_put_texel(const cache_tables *t, const uint8_t *texel, uint32_t channels, float *out) {
    v8f values = gather_load(t->type, texel);
    quick_put(__builtin_shufflevector(values, values, 0, 1, 2, 3) * t->scale + 0, channels, out);
}

/* What is looked at first, of a lookup that may be quick: u and v, and the footprint along them, as
 * often as there is room. */
typedef struct quick_place {
    cache_tables *tables;
    cache_face *face;
    uint32_t channels;
    v4f at, sides;
} quick_place;

/* Returns false if it is none of most lookups. */
static inline __attribute__((always_inline)) bool
quick_find_place(const slv_sampler *s, const slv_lookup *l, slv_filter filter, quick_place *out) {
    cache_tables *t = cache_find_tables(s->thread.view, l->file);
    if (!t || l->face >= t->nfaces)
        return false;
    out->tables = t;
    out->face = &t->faces[l->face];
    out->channels = t->nchannels < s->nchannels ? t->nchannels : s->nchannels;
    if (!quick_fits(s, out->face))
        return false;
    if (filter == SLV_FILTER_POINT)
        return num_bits(l->u) < QUICK_UNIT_BITS && num_bits(l->v) < QUICK_UNIT_BITS;
    v8f row;
    memcpy(&row, l, sizeof row);
    out->at = __builtin_shufflevector(row, row, 2, 3, 2, 3);
    v4f sides = __builtin_shufflevector(row, row, 4, 5, 6, 7);
    v4i sound = (v4i)((v4u32)out->at < QUICK_UNIT_BITS);
    sides = (v4f)((v4i)sides & 0x7fffffff);
    sides += __builtin_shufflevector(sides, sides, 2, 3, 0, 1);
    out->sides = sides * s->width + s->blur;
    sound &= out->sides < INFINITY;
    return (sound[0] & sound[1]) != 0;
}

/* One along u and one along v, as often as there is room. */
static inline __attribute__((always_inline)) v8i quick_both(int u, int v) {
    return (v8i){u, v, u, v, u, v, u, v};
}

static inline __attribute__((always_inline)) void
quick_find_spans(const kernel_shape *shape, const quick_place *p, kernel_spans *out) {
    kernel_span_axes(shape, v8_join(p->at, p->at), v8_join(p->sides, p->sides),
                     quick_both(p->face->res_u, p->face->res_v), out);
}

/* Those that are one texel, and bilinear ones that lie between four texels of a face at full
 * resolution: as few steps as there can be, and no call, so that no registers are saved. Returns
 * false for all others. The values are those of the others' way. */
static inline __attribute__((always_inline)) bool
quick_at_once(const slv_sampler *s, const slv_lookup *l, slv_filter filter, float *out) {
    quick_place p;
    if (!quick_find_place(s, l, filter, &p))
        return false;
    const cache_tables *t = p.tables;
    cache_face *f = p.face;
    const uint8_t *texels = cache_find_full(s->thread.view, f);
    bool zeros = p.channels < s->nchannels && s->nchannels != UINT32_MAX; /* to be put behind */
    if (!texels || zeros)
        return false;
    if (filter == SLV_FILTER_POINT) {
        size_t place = point_place(l->u, l->v, f->res_u, f->res_v);
        quick_put_texel(t, texels + place * t->pixel_size, p.channels, out);
        return true;
    }
    union {
        v8f v;
        float f[8];
    } rows;
    kernel_shape shape = {.filter = filter};
    kernel_spans spans;
    quick_find_spans(&shape, &p, &spans);
    int x = spans.start[0], y = spans.start[1];
    if (spans.res[0] != f->res_u || spans.res[1] != f->res_v ||
        (f->res_u <= APRON_LOG2 && f->res_v <= APRON_LOG2) ||
        (x | y | ((1 << f->res_u) - 2 - x) | ((1 << f->res_v) - 2 - y)) < 0)
        return false;
    v8f total = spans.a + spans.b;
    size_t pitch = (size_t)t->pixel_size << f->res_u;
    texels += (size_t)y * pitch + (size_t)x * t->pixel_size;
    rows.v = gather_load(t->type, texels) * spans.a[1];
    rows.v += gather_load(t->type, texels + pitch) * spans.b[1];
    v4f sum = gather_two_columns(rows.f, t->nchannels, spans.a[0], spans.b[0]);
    quick_put(sum * (t->scale / (total[0] * total[1])) + 0, p.channels, out);
    return true;
}

/* Most lookups: on a quad whose texels are of few channels, from the first on. Returns false if
 * this is not one of them, or if the tables were dropped on the way. */
static inline __attribute__((always_inline)) bool quick_look_up(slv_sampler *s, const slv_lookup *l,
                                                                slv_filter filter, float *out,
                                                                slv_result *result) {
    quick_place p;
    if (filter == SLV_FILTER_ANISOTROPIC || filter == SLV_FILTER_POINT ||
        !quick_find_place(s, l, filter, &p))
        return false;
    const cache_view *cache = s->thread.view;
    cache_tables *t = p.tables;
    cache_face *f = p.face;
    uint32_t channels = p.channels;
    kernel_shape shape = s->shape;
    shape.filter = filter;
    kernel_spans spans;
    quick_reach reach;
    kernel k;
    quick_find_spans(&shape, &p, &spans);
    quick_find_reach(s, &spans, &reach);
    k.turns = 0;
    float weight = kernel_weigh_axis(&shape, &spans, 0, &k.a[0]);
    weight *= kernel_weigh_axis(&shape, &spans, 1, &k.a[1]);
    quick_last last = {0};
    size_t pitch;
    const uint8_t *texels = quick_find_texels(cache, t, l->face, f, reach.small[0] & reach.small[1],
                                              reach.inside[0] & reach.inside[1], &k, &last, &pitch);
    quick_put_zeros(s, channels, out);
    if (!texels)
        return quick_across(s, t, l->face, f, &k, weight, channels, out, result);
    v4f sum = gather_few(t, texels, pitch, &k);
    quick_put(sum * (t->scale / weight) + 0, channels, out);
    return true;
}

#endif
