/* Lookups on quad meshes, from position and footprint to value. Compiled once for every kind of
 * processor; the numbers are the same. */
#include "filter/seams.h"

#ifndef LOOKUP_FUNCTIONS
#define LOOKUP_FUNCTIONS lookup_portable
#endif

#define BATCH 16

static void point_sum(lookup_state *state, const slv_lookup *l) {
    const cache_tables *t = state->tables;
    cache_face *f = face_at(state, l->face);
    state->weight = 1;
    if ((f->flags & SLV_FACE_CONSTANT) || f->res_u + f->res_v == 0) {
        add_texel(t->type, t->averages + (size_t)l->face * t->pixel_size, state->first,
                  state->count, 1, state->sum);
        return;
    }
    float size_u = power_of_two(f->res_u), size_v = power_of_two(f->res_v);
    float u = l->u * size_u, v = l->v * size_v;
    u = u > 0 ? u < size_u ? u : size_u - 1 : 0;
    v = v > 0 ? v < size_v ? v : size_v - 1 : 0;
    int x = (int)u, y = (int)v;
    if (t->triangle && u - (float)x + (v - (float)y) > 1) {
        int mirrored = (1 << f->res_u) - 1 - y;
        y = (1 << f->res_u) - 1 - x;
        x = mirrored;
    }
    const uint8_t *texels;
    size_t at;
    if (f->res_u + f->res_v <= t->whole_log2) {
        texels = find_whole(state, l->face, f, f->res_u, f->res_v);
        at = ((size_t)y << f->res_u) + (size_t)x;
    } else {
        slv_res tile = cache_tile_res(t, f->res_u, f->res_v);
        uint32_t index = ((uint32_t)(y >> tile.v) << (f->res_u - tile.u)) + (uint32_t)(x >> tile.u);
        texels = find_tile(state, l->face, f->res_u, f->res_v, index);
        at = ((size_t)(y & ((1 << tile.v) - 1)) << tile.u) + (size_t)(x & ((1 << tile.u) - 1));
    }
    if (texels)
        add_texel(t->type, texels + at * t->pixel_size, state->first, state->count, 1, state->sum);
}

/* A coordinate outside of its face; false if the lookup sees nothing but black. */
static inline bool border(slv_border_mode mode, float *x) {
    switch (mode) {
    case SLV_BORDER_CLAMP:
        *x = *x > 0 ? *x < 1 ? *x : 1 : 0;
        return true;
    case SLV_BORDER_PERIODIC:
        *x -= floorf(*x);
        return true;
    default:
        return *x > -1 && *x < 2;
    }
}

static inline void build(const slv_sampler *s, const cache_face *f, float u, float v, float uw,
                         float vw, kernel *k) {
    k->turns = 0;
    if (!is_subface(f)) {
        build_axis(&s->shape, u, uw, f->res_u, &k->a[0]);
        build_axis(&s->shape, v, vw, f->res_v, &k->a[1]);
        return;
    }
    /* a quarter of a whole face */
    build_axis(&s->shape, u * 0.5f, uw * 0.5f, f->res_u + 1, &k->a[0]);
    build_axis(&s->shape, v * 0.5f, vw * 0.5f, f->res_v + 1, &k->a[1]);
    for (int axis = 0; axis < 2; axis++) {
        if (k->a[axis].res == 0)
            axis_upsample(&k->a[axis]);
        k->a[axis].res--;
    }
}

static inline bool is_inside(const kernel_axis *a) {
    return a->start >= 0 && a->start + a->n <= 1 << a->res;
}

static void quad_sum(lookup_state *state, const slv_lookup *l) {
    const slv_sampler *s = state->sampler;
    const cache_tables *t = state->tables;
    cache_face *f = face_at(state, l->face);
    float u = l->u, v = l->v;
    if (f->flags & SLV_FACE_NEIGHBOURS_CONSTANT) {
        state->weight = 1;
        add_texel(t->type, t->averages + (size_t)l->face * t->pixel_size, state->first,
                  state->count, 1, state->sum);
        return;
    }
    if (!border(t->border_u, &u) || !border(t->border_v, &v)) {
        state->weight = 1;
        return;
    }
    bool half = is_subface(f);
    float uw = (fabsf(l->uw1) + fabsf(l->uw2)) * s->width + s->blur * (half ? 2 : 1);
    float vw = (fabsf(l->vw1) + fabsf(l->vw2)) * s->width + s->blur * (half ? 2 : 1);
    kernel k;
    build(s, f, u, v, uw, vw, &k);
    bool inside = is_inside(&k.a[0]) && is_inside(&k.a[1]);
    if (!inside) {
        axis_strip(&k.a[0]);
        axis_strip(&k.a[1]);
    }
    state->weight = kernel_weight(&k);
    if (inside)
        apply_inside(state, l->face, f, &k);
    else
        apply_across(state, l->face, &k);
}

static inline bool is_sound(const slv_lookup *l) {
    /* x - x is 0 for all but infinity and NaN */
    float position = (l->u - l->u) + (l->v - l->v);
    float footprint = fabsf(l->uw1) + fabsf(l->vw1) + fabsf(l->uw2) + fabsf(l->vw2);
    return position == 0 && footprint == footprint;
}

/* Most lookups: inside of a face whose texels are there, of few channels from the first on. Returns
 * false, and nothing happened, if this is not one of them. */
static inline __attribute__((always_inline)) bool
look_up_quickly(slv_sampler *s, const slv_lookup *l, slv_filter filter, float *out) {
    cache_tables *t = cache_find_tables(s->thread.cache, l->file);
    if (!t || l->face >= t->nfaces || t->nchannels > 4 || s->first_channel || t->triangle)
        return false;
    cache_face *f = &t->faces[l->face];
    if (atomic_load_explicit(&f->state, memory_order_acquire) != CACHE_KNOWN ||
        (f->flags & (SLV_FACE_CONSTANT | SLV_FACE_SUBFACE)))
        return false;
    float u = l->u, v = l->v;
    if (!(u >= 0 && u <= 1 && v >= 0 && v <= 1))
        return false;
    v4f sum;
    const uint8_t *texels;
    if (filter == SLV_FILTER_POINT) {
        int x = (int)(u * power_of_two(f->res_u)), y = (int)(v * power_of_two(f->res_v));
        x -= x >> f->res_u;
        y -= y >> f->res_v;
        texels = cache_find_full(s->thread.cache, f);
        if (!texels)
            return false;
        v8f texel =
            load_texel(t->type, texels + (((size_t)y << f->res_u) + (size_t)x) * t->pixel_size);
        memcpy(&sum, &texel, sizeof sum);
        sum = sum * t->scale + 0;
    } else {
        float uw = (fabsf(l->uw1) + fabsf(l->uw2)) * s->width + s->blur;
        float vw = (fabsf(l->vw1) + fabsf(l->vw2)) * s->width + s->blur;
        if (!(uw + vw < INFINITY))
            return false;
        kernel k;
        k.turns = 0;
        kernel_shape shape = s->shape;
        shape.filter = filter;
        build_axis(&shape, u, uw, f->res_u, &k.a[0]);
        build_axis(&shape, v, vw, f->res_v, &k.a[1]);
        int res_u = k.a[0].res, res_v = k.a[1].res;
        if (!is_inside(&k.a[0]) || !is_inside(&k.a[1]) || res_u > f->res_u || res_v > f->res_v)
            return false;
        texels = res_u == f->res_u && res_v == f->res_v
                     ? cache_find_full(s->thread.cache, f)
                     : cache_find_hashed(s->thread.cache, t, l->face, res_u, res_v, 0);
        if (!texels || res_u + res_v > t->whole_log2)
            return false;
        sum = gather_few(t, texels, (size_t)1 << res_u, &k);
        sum = sum * (t->scale / kernel_weight(&k)) + 0;
    }
    uint32_t count = t->nchannels < s->nchannels ? t->nchannels : s->nchannels;
    if (count >= 2)
        memcpy(out, &sum, 2 * sizeof *out);
    else
        out[0] = sum[0];
    if (count >= 3)
        out[2] = sum[2];
    if (count >= 4)
        out[3] = sum[3];
    if (s->nchannels != UINT32_MAX)
        for (uint32_t c = count; c < s->nchannels; c++)
            out[c] = 0;
    return true;
}

/* The thread is pinned. `room`: how many values to set, or 0 for as many as the file gives. */
static inline slv_result look_up(slv_sampler *s, const slv_lookup *l, size_t room, float *out) {
    for (;;) {
        cache_tables *t = cache_find_tables(s->thread.cache, l->file);
        if (!t) {
            cache_unpin(&s->thread);
            s->thread.moves++;
            slv_result result = cache_load_tables(s->thread.cache, l->file);
            cache_pin(&s->thread);
            if (!result)
                continue;
            memset(out, 0, room * sizeof *out);
            return result;
        }
        uint32_t there = t->nchannels > s->first_channel ? t->nchannels - s->first_channel : 0;
        lookup_state state = {.sampler = s,
                              .tables = t,
                              .first = s->first_channel,
                              .count = there < s->nchannels ? there : s->nchannels,
                              .sum = out};
        memset(out, 0, (room ? room : state.count) * sizeof *out);
        if (l->face >= t->nfaces || !is_sound(l))
            return SLV_ERROR_ARGUMENT;
        if (!state.count)
            return SLV_OK;
        if (s->shape.filter == SLV_FILTER_POINT)
            point_sum(&state, l);
        else if (t->triangle)
            triangle_sum(&state, l);
        else
            quad_sum(&state, l);
        cache_count(&s->thread.pieces, state.pieces);
        cache_count(&s->thread.slow, 1);
        if (state.gone)
            continue;
        float scale = state.weight == 0 || state.result ? 0 : t->scale / state.weight;
        for (uint32_t c = 0; c < state.count; c++)
            out[c] = scale == 0 ? 0 : out[c] * scale + 0;
        return state.result;
    }
}

static inline __attribute__((always_inline)) slv_result
look_up_one(slv_sampler *s, const slv_lookup *l, slv_filter filter, float *out) {
    slv_result result = SLV_OK;
    cache_pin(&s->thread);
    if (!look_up_quickly(s, l, filter, out))
        result = look_up(s, l, s->nchannels == UINT32_MAX ? 0 : s->nchannels, out);
    cache_unpin(&s->thread);
    cache_count(&s->thread.lookups, 1);
    return result;
}

static inline __attribute__((always_inline)) slv_result
look_up_many(slv_sampler *s, const slv_lookup *lookups, const uint32_t *order, size_t count,
             slv_filter filter, float *out, size_t stride, slv_result *results) {
    slv_result first = SLV_OK;
    size_t first_at = count, room = s->nchannels == UINT32_MAX ? stride : s->nchannels;
    for (size_t i = 0; i < count; i++) {
        size_t at = order ? order[i] : i;
        slv_result result = SLV_OK;
        cache_pin(&s->thread);
        if (!look_up_quickly(s, &lookups[at], filter, out + at * stride))
            result = look_up(s, &lookups[at], room, out + at * stride);
        cache_unpin(&s->thread);
        if (results)
            results[at] = result;
        if (result && at < first_at) {
            first = result;
            first_at = at;
        }
    }
    cache_count(&s->thread.lookups, count);
    return first;
}

#define DEFINE_LOOKUPS(NAME, FILTER)                                                               \
    static slv_result one_##NAME(slv_sampler *s, const slv_lookup *l, float *out) {                \
        return look_up_one(s, l, FILTER, out);                                                     \
    }                                                                                              \
    static slv_result many_##NAME(slv_sampler *s, const slv_lookup *l, const uint32_t *order,      \
                                  size_t count, float *out, size_t stride, slv_result *results) {  \
        return look_up_many(s, l, order, count, FILTER, out, stride, results);                     \
    }

DEFINE_LOOKUPS(point, SLV_FILTER_POINT)
DEFINE_LOOKUPS(bilinear, SLV_FILTER_BILINEAR)
DEFINE_LOOKUPS(box, SLV_FILTER_BOX)
DEFINE_LOOKUPS(gaussian, SLV_FILTER_GAUSSIAN)
DEFINE_LOOKUPS(cubic, SLV_FILTER_BICUBIC)

const lookup_functions LOOKUP_FUNCTIONS[SLV_FILTER_COUNT] = {
    [SLV_FILTER_POINT] = {one_point, many_point},
    [SLV_FILTER_BILINEAR] = {one_bilinear, many_bilinear},
    [SLV_FILTER_BOX] = {one_box, many_box},
    [SLV_FILTER_GAUSSIAN] = {one_gaussian, many_gaussian},
    [SLV_FILTER_BICUBIC] = {one_cubic, many_cubic},
    [SLV_FILTER_BSPLINE] = {one_cubic, many_cubic},
    [SLV_FILTER_CATMULL_ROM] = {one_cubic, many_cubic},
    [SLV_FILTER_MITCHELL] = {one_cubic, many_cubic},
};
