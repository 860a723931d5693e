/* Lookups on quad meshes, from position and footprint to value. Compiled once for every kind of
 * processor; the numbers are the same. */
#include "filter/apron.h"

#ifndef LOOKUP_FUNCTIONS
#define LOOKUP_FUNCTIONS slvi_lookup_portable
#endif

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
        at = ((size_t)y << f->res_u) + (size_t)x;
        texels = find_whole(state, l->face, f, f->res_u, f->res_v);
    } else {
        slv_res tile = slvi_cache_tile_res(t, f->res_u, f->res_v);
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

/* Returns the kernel's whole weight. */
static inline __attribute__((always_inline)) float build(const kernel_shape *shape,
                                                         const cache_face *f, float u, float v,
                                                         float uw, float vw, kernel *k) {
    if (!is_subface(f))
        return build_kernel(shape, u, v, uw, vw, f->res_u, f->res_v, k);
    /* a quarter of a whole face */
    float sum = build_kernel(shape, u * 0.5f, v * 0.5f, uw * 0.5f, vw * 0.5f, f->res_u + 1,
                             f->res_v + 1, k);
    for (int axis = 0; axis < 2; axis++) {
        if (k->a[axis].res == 0)
            axis_upsample(&k->a[axis]);
        k->a[axis].res--;
    }
    return sum;
}

/* Lays a kernel of a known weight onto its face and those around. */
static inline void sum_kernel(lookup_state *state, uint32_t face, cache_face *f, kernel *k,
                              float weight) {
    bool inside = kernel_is_inside(k);
    state->weight = weight;
    if (f->plain && !state->sampler->no_edge_blend && apron_fits(k) &&
        (apply_apron(state, face, f, k) || is_over(state)))
        return;
    if (inside) {
        apply_inside(state, face, f, k);
        return;
    }
    axis_strip(&k->a[0]);
    axis_strip(&k->a[1]);
    if (f->plain && !state->sampler->no_edge_blend && apply_one_edge(state, face, f, k))
        return;
    apply_across(state, face, k);
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
    float blur = is_subface(f) ? 2 * s->blur : s->blur;
    float uw = (fabsf(l->uw1) + fabsf(l->uw2)) * s->width + blur;
    float vw = (fabsf(l->vw1) + fabsf(l->vw2)) * s->width + blur;
    kernel k;
    float weight = build(&s->shape, f, u, v, uw, vw, &k);
    sum_kernel(state, l->face, f, &k, weight);
}

static inline bool is_sound(const slv_sampler *s, const slv_lookup *l) {
    /* x - x is 0 for all but infinity and NaN */
    float position = (l->u - l->u) + (l->v - l->v);
    float footprint = fabsf(l->uw1) + fabsf(l->vw1) + fabsf(l->uw2) + fabsf(l->vw2);
    return position == 0 && (s->shape.filter == SLV_FILTER_POINT || footprint == footprint);
}

static inline __attribute__((always_inline)) void put(v4f sum, uint32_t count, float *out) {
    if (count >= 2)
        memcpy(out, &sum, 2 * sizeof *out);
    else
        out[0] = sum[0];
    if (count >= 3)
        out[2] = sum[2];
    if (count >= 4)
        out[3] = sum[3];
}

/* A kernel that reaches beyond its face, or whose texels are not there yet. */
static __attribute__((noinline)) bool look_across(slv_sampler *s, cache_tables *t, uint32_t face,
                                                  cache_face *f, kernel *k, float weight,
                                                  uint32_t count, float *out, slv_result *result) {
    float sum[4] = {0};
    lookup_state state = {.sampler = s, .tables = t, .count = count, .sum = sum};
    sum_kernel(&state, face, f, k, weight);
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
typedef struct kernel_reach {
    v8i inside, small;
} kernel_reach;

static inline __attribute__((always_inline)) void
find_reach(const slv_sampler *s, const kernel_spans *spans, kernel_reach *out) {
    v8i size = v8_to_int(v8_power_of_two(spans->res)), after = size - spans->n - spans->start;
    /* no wider than the face */
    v8i width = v8_select_int(size < APRON_WIDTH, size, (v8i){0} + APRON_WIDTH);
    out->inside = (spans->start | after) >= 0;
    out->small = (((spans->start + width) | (after + width)) >= 0) & (spans->res <= APRON_LOG2);
    if (s->no_edge_blend)
        out->small = (v8i){0};
}

/* The resolution of a face that was looked for last: neighbours mostly want the same. */
typedef struct last_found {
    const cache_face *face;
    int res_u, res_v;
    const uint8_t *apron, *inner;
} last_found;

/* The texels under a kernel, or NULL if they are to be looked for. */
static inline __attribute__((always_inline)) const uint8_t *
find_texels(const slv_cache *cache, const cache_tables *t, uint32_t face, cache_face *f, bool small,
            bool inside, kernel *k, last_found *last, size_t *pitch) {
    int res_u = k->a[0].res, res_v = k->a[1].res;
    *pitch = (size_t)1 << res_u;
    if (f != last->face || res_u != last->res_u || res_v != last->res_v)
        *last = (last_found){f, res_u, res_v, NULL, NULL};
    if (small) {
        if (!last->apron)
            last->apron = cache_find_apron(cache, f, res_u, res_v);
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
static inline __attribute__((always_inline)) bool is_quick(const slv_sampler *s,
                                                           const cache_face *f) {
    return atomic_load_explicit(&f->state, memory_order_acquire) == CACHE_KNOWN && f->plain &&
           !s->first_channel;
}

static inline __attribute__((always_inline)) void put_zeros(const slv_sampler *s, uint32_t from,
                                                            float *out) {
    if (s->nchannels != UINT32_MAX)
        for (uint32_t c = from; c < s->nchannels; c++)
            out[c] = 0;
}

/* What floats of 0 <= x < 1 are less than, taken as integers; not -0, which is no loss. */
#define UNIT_BITS 0x3f800000

/* The thread is pinned. `room`: how many values to set, or 0 for as many as the file gives. */
static inline slv_result look_up(slv_sampler *s, const slv_lookup *l, size_t room, float *out) {
    for (;;) {
        cache_tables *t = cache_find_tables(s->thread.cache, l->file);
        if (!t) {
            cache_unpin(&s->thread);
            s->thread.moves++;
            slv_result result = slvi_cache_load_tables(s->thread.cache, l->file);
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
        if (l->face >= t->nfaces || !is_sound(s, l) || (room && state.count > room))
            return SLV_ERROR_ARGUMENT;
        if (!state.count)
            return SLV_OK;
        if (s->shape.filter == SLV_FILTER_POINT)
            point_sum(&state, l);
        else if (t->triangle)
            slvi_triangle_sum(&state, l);
        else if (s->shape.filter == SLV_FILTER_ANISOTROPIC)
            ANISOTROPIC_SUM(&state, l);
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

_Static_assert(sizeof(slv_lookup) == 32 && offsetof(slv_lookup, file) == 0 &&
                   offsetof(slv_lookup, face) == 4 && offsetof(slv_lookup, u) == 8 &&
                   offsetof(slv_lookup, uw1) == 16 && offsetof(slv_lookup, uw2) == 24,
               "a lookup is a row of eight values");

static inline __attribute__((always_inline)) void
put_texel(const cache_tables *t, const uint8_t *texel, uint32_t channels, float *out) {
    v8f values = load_texel(t->type, texel);
    put(__builtin_shufflevector(values, values, 0, 1, 2, 3) * t->scale + 0, channels, out);
}

/* Most lookups: on a quad whose texels are of few channels, from the first on. Returns false if
 * this is not one of them, or if the tables were dropped on the way. */
static inline __attribute__((always_inline)) bool look_up_quick(slv_sampler *s, const slv_lookup *l,
                                                                slv_filter filter, float *out,
                                                                slv_result *result) {
    if (filter == SLV_FILTER_ANISOTROPIC)
        return false;
    const slv_cache *cache = s->thread.cache;
    cache_tables *t = cache_find_tables(cache, l->file);
    if (!t || l->face >= t->nfaces)
        return false;
    cache_face *f = &t->faces[l->face];
    if (!is_quick(s, f))
        return false;
    uint32_t channels = t->nchannels < s->nchannels ? t->nchannels : s->nchannels;
    v8f row;
    memcpy(&row, l, sizeof row);
    /* u and v, as often as there is room */
    v4f at = __builtin_shufflevector(row, row, 2, 3, 2, 3);
    v4f sides = __builtin_shufflevector(row, row, 4, 5, 6, 7);
    v4i sound = (v4i)((v4u32)at < UNIT_BITS);
    if (filter == SLV_FILTER_POINT) {
        if (!(sound[0] & sound[1]))
            return false;
        int x = (int)(l->u * power_of_two(f->res_u)), y = (int)(l->v * power_of_two(f->res_v));
        const uint8_t *texels = cache_find_full(cache, f);
        if (!texels)
            return false;
        put_zeros(s, channels, out);
        put_texel(t, texels + (((size_t)y << f->res_u) + (size_t)x) * t->pixel_size, channels, out);
        return true;
    }
    sides = (v4f)((v4i)sides & 0x7fffffff);
    sides += __builtin_shufflevector(sides, sides, 2, 3, 0, 1);
    sides = sides * s->width + s->blur;
    sound &= sides < INFINITY;
    if (!(sound[0] & sound[1]))
        return false;
    kernel_shape shape = s->shape;
    shape.filter = filter;
    kernel_spans spans;
    kernel_reach reach;
    kernel k;
    span_axes(&shape, v8_join(at, at), v8_join(sides, sides), (v8i){f->res_u, f->res_v}, &spans);
    find_reach(s, &spans, &reach);
    k.turns = 0;
    float weight = weigh_axis(&shape, &spans, 0, &k.a[0]);
    weight *= weigh_axis(&shape, &spans, 1, &k.a[1]);
    last_found last = {0};
    size_t pitch;
    const uint8_t *texels = find_texels(cache, t, l->face, f, reach.small[0] & reach.small[1],
                                        reach.inside[0] & reach.inside[1], &k, &last, &pitch);
    put_zeros(s, channels, out);
    if (!texels)
        return look_across(s, t, l->face, f, &k, weight, channels, out, result);
    v4f sum = gather_few(t, texels, pitch, &k);
    put(sum * (t->scale / weight) + 0, channels, out);
    return true;
}

static inline __attribute__((always_inline)) slv_result
look_up_one(slv_sampler *s, const slv_lookup *l, slv_filter filter, float *out) {
    slv_result result = SLV_OK;
    cache_pin(&s->thread);
    if (!look_up_quick(s, l, filter, out, &result))
        result = look_up(s, l, s->nchannels == UINT32_MAX ? 0 : s->nchannels, out);
    cache_unpin(&s->thread);
    cache_count(&s->thread.lookups, 1);
    return result;
}

#include "filter/group.h"

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
DEFINE_LOOKUPS(anisotropic, SLV_FILTER_ANISOTROPIC)

const lookup_functions LOOKUP_FUNCTIONS[SLV_FILTER_COUNT] = {
    [SLV_FILTER_POINT] = {one_point, many_point},
    [SLV_FILTER_BILINEAR] = {one_bilinear, many_bilinear},
    [SLV_FILTER_BOX] = {one_box, many_box},
    [SLV_FILTER_GAUSSIAN] = {one_gaussian, many_gaussian},
    [SLV_FILTER_BICUBIC] = {one_cubic, many_cubic},
    [SLV_FILTER_BSPLINE] = {one_cubic, many_cubic},
    [SLV_FILTER_CATMULL_ROM] = {one_cubic, many_cubic},
    [SLV_FILTER_MITCHELL] = {one_cubic, many_cubic},
    [SLV_FILTER_ANISOTROPIC] = {one_anisotropic, many_anisotropic},
};
