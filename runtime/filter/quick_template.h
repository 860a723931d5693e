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
quick_find_place(const slv_sampler *s, const slv_lookup *l, quick_place *out) {
    cache_tables *t = cache_find_tables(s->thread.view, l->file);
    if (!t || l->face >= t->nfaces)
        return false;
    out->tables = t;
    out->face = &t->faces[l->face];
    out->channels = t->nchannels < s->nchannels ? t->nchannels : s->nchannels;
    if (!quick_fits(s, out->face))
        return false;
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

/* Where a lookup lies on a face at full resolution. */
typedef struct quick_inner {
    cache_tables *tables;
    const uint8_t *texels;
    int res_u, res_v;
    uint32_t channels;
} quick_inner;

static inline __attribute__((always_inline)) bool
quick_find_inner(const slv_sampler *s, const slv_lookup *l, quick_inner *out) {
    cache_tables *t = cache_find_tables(s->thread.view, l->file);
    if (!t || l->face >= t->nfaces)
        return false;
    cache_face *f = &t->faces[l->face];
    /* what has texels is known */
    const uint8_t *texels = cache_find_full(s->thread.view, f);
    if (!texels || !cache_is_plain(f) || t->nchannels < s->least)
        return false;
    *out = (quick_inner){t, texels, f->res_u, f->res_v,
                         t->nchannels < s->nchannels ? t->nchannels : s->nchannels};
    return true;
}

/* Those whose texels all lie on a face at full resolution: as few steps as there can be. Returns
 * false for all others. The values are those of the others' way. */
static inline __attribute__((always_inline)) bool
quick_at_once(const slv_sampler *s, const slv_lookup *l, slv_filter filter, float *out) {
    quick_inner on;
    if (filter == SLV_FILTER_ANISOTROPIC || !quick_find_inner(s, l, &on))
        return false;
    const cache_tables *t = on.tables;
    if (filter == SLV_FILTER_POINT) {
        if (num_bits(l->u) >= QUICK_UNIT_BITS || num_bits(l->v) >= QUICK_UNIT_BITS)
            return false;
        size_t place = point_place(l->u, l->v, on.res_u, on.res_v);
        quick_put_texel(t, on.texels + place * t->pixel_size, on.channels, out);
        return true;
    }
    v4f at, sides, others;
    memcpy(&at, &l->u, sizeof at);
    memcpy(&sides, &l->uw1, sizeof sides);
    sides = (v4f)((v4i)sides & 0x7fffffff);
    others = __builtin_shufflevector(sides, sides, 2, 3, 2, 3);
    /* the first two lanes, in texels; what is in the others is not looked at */
    kernel_spans spans = {.res = {on.res_u, on.res_v}};
    v8f size = v8_power_of_two(spans.res);
    v8f wide = v8_widen((sides + others) * s->width + s->blur) * size;
    kernel_shape shape = s->shape;
    shape.filter = filter;
    /* what is not a number or far away must not overflow, and is outside where it is put */
    v8f x = v8_min(v8_max(v8_widen(at), v8_splat(0)), v8_splat(1)) * size;
    v8f p = v8_min(v8_max(wide, v8_splat(1)), v8_splat(2));
    kernel_lay_axes(&shape, x, p, &spans);
    v8i outside = spans.start | (v8_to_int(size) - spans.n - spans.start);
    if (!v8_first_two_negative((wide < 2.0f) & (APRON_LOG2 - spans.res) & ~outside))
        return false;
    size_t pitch = (size_t)1 << on.res_u, pixel = t->pixel_size;
    const uint8_t *first =
        on.texels + ((size_t)spans.start[1] * pitch + (size_t)spans.start[0]) * pixel;
    v4f sum;
    float weight;
    if (filter == SLV_FILTER_BILINEAR) {
        v8f rows = gather_load(t->type, first) * spans.a[1];
        rows += gather_load(t->type, first + pitch * pixel) * spans.b[1];
        rows = v8_two_fours(rows, (int)t->nchannels) * v8_fours(spans.a[0], spans.b[0]);
        sum = v8_low(rows) + v8_high(rows);
        weight = spans.whole[0] * spans.whole[1];
    } else {
        kernel k;
        weight = kernel_weigh_span(&shape, &spans, 0, &k.a[0]);
        weight *= kernel_weigh_span(&shape, &spans, 1, &k.a[1]);
        sum = gather_from(t, first, pitch, &k);
    }
    quick_put(sum * (t->scale / weight) + 0, on.channels, out);
    return true;
}

/* Most lookups: on a quad whose texels are of few channels, from the first on. Returns false if
 * this is not one of them, or if the tables were dropped on the way. */
static inline __attribute__((always_inline)) bool quick_look_up(slv_sampler *s, const slv_lookup *l,
                                                                slv_filter filter, float *out,
                                                                slv_result *result) {
    quick_place p;
    if (filter == SLV_FILTER_ANISOTROPIC || filter == SLV_FILTER_POINT ||
        !quick_find_place(s, l, &p))
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
