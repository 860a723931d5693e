/* Lookups on quad meshes, from position and footprint to value. Compiled once for every kind of
 * processor; the numbers are the same. */
#include "filter/apron.h"

#ifndef LOOKUP_FUNCTIONS
#define LOOKUP_FUNCTIONS lookup_portable
#endif

#define GROUP 8 /* lookups of a batch that are under way at once */

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

/* Returns the kernel's whole weight. */
static inline __attribute__((always_inline)) float build(const kernel_shape *shape,
                                                         const cache_face *f, float u, float v,
                                                         float uw, float vw, kernel *k) {
    k->turns = 0;
    if (!is_subface(f))
        return build_axis(shape, u, uw, f->res_u, &k->a[0]) *
               build_axis(shape, v, vw, f->res_v, &k->a[1]);
    /* a quarter of a whole face */
    float sum = build_axis(shape, u * 0.5f, uw * 0.5f, f->res_u + 1, &k->a[0]) *
                build_axis(shape, v * 0.5f, vw * 0.5f, f->res_v + 1, &k->a[1]);
    for (int axis = 0; axis < 2; axis++) {
        if (k->a[axis].res == 0)
            axis_upsample(&k->a[axis]);
        k->a[axis].res--;
    }
    return sum;
}

static inline __attribute__((always_inline)) bool is_inside(const kernel *k) {
    const kernel_axis *u = &k->a[0], *v = &k->a[1];
    int outside =
        u->start | ((1 << u->res) - u->n - u->start) | v->start | ((1 << v->res) - v->n - v->start);
    return outside >= 0;
}

/* Lays a kernel of a known weight onto its face and those around. */
static inline void sum_kernel(lookup_state *state, uint32_t face, cache_face *f, kernel *k,
                              float weight) {
    bool inside = is_inside(k);
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

static inline bool is_sound(const slv_lookup *l) {
    /* x - x is 0 for all but infinity and NaN */
    float position = (l->u - l->u) + (l->v - l->v);
    float footprint = fabsf(l->uw1) + fabsf(l->vw1) + fabsf(l->uw2) + fabsf(l->vw2);
    return position == 0 && footprint == footprint;
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

/* A lookup that is nearly done: what is left is to sum up texels, if they were found. */
typedef struct prepared {
    cache_tables *t;
    cache_face *f;
    const uint8_t *texels;
    size_t pitch;
    float weight;
    kernel k;
} prepared;

/* Whether 0 <= x < 1; false for -0, which is no loss. */
static inline bool is_unit(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits < 0x3f800000;
}

/* Most lookups: on a quad whose texels are of few channels, from the first on. Returns false if
 * this is not one of them. */
static inline __attribute__((always_inline)) bool prepare(const slv_sampler *s, const slv_lookup *l,
                                                          slv_filter filter, prepared *p) {
    const slv_cache *cache = s->thread.cache;
    cache_tables *t = cache_find_tables(cache, l->file);
    if (!t || l->face >= t->nfaces || s->first_channel)
        return false;
    cache_face *f = &t->faces[l->face];
    if (atomic_load_explicit(&f->state, memory_order_acquire) != CACHE_KNOWN || !f->plain ||
        !is_unit(l->u) || !is_unit(l->v))
        return false;
    p->t = t;
    p->f = f;
    if (filter == SLV_FILTER_POINT) {
        int x = (int)(l->u * power_of_two(f->res_u)), y = (int)(l->v * power_of_two(f->res_v));
        p->texels = cache_find_full(cache, f);
        if (!p->texels)
            return false;
        p->texels += (((size_t)y << f->res_u) + (size_t)x) * t->pixel_size;
        return true;
    }
    float uw = (fabsf(l->uw1) + fabsf(l->uw2)) * s->width + s->blur;
    float vw = (fabsf(l->vw1) + fabsf(l->vw2)) * s->width + s->blur;
    if (!(uw + vw < INFINITY))
        return false;
    kernel_shape shape = s->shape;
    shape.filter = filter;
    p->k.turns = 0;
    p->weight = build_axis(&shape, l->u, uw, f->res_u, &p->k.a[0]) *
                build_axis(&shape, l->v, vw, f->res_v, &p->k.a[1]);
    int res_u = p->k.a[0].res, res_v = p->k.a[1].res;
    p->texels = NULL;
    p->pitch = (size_t)1 << res_u;
    if ((res_u | res_v) <= APRON_LOG2 && !s->no_edge_blend && apron_fits(&p->k)) {
        const uint8_t *apron = cache_find_apron(cache, f, res_u, res_v);
        if (apron && apron_covers(apron, &p->k)) {
            p->texels = apron;
            p->pitch = apron_pitch(res_u);
        }
    } else if (res_u == f->res_u && res_v == f->res_v) {
        if (is_inside(&p->k))
            p->texels = cache_find_full(cache, f);
    } else if (is_inside(&p->k) && res_u < f->res_u && res_v < f->res_v &&
               res_u + res_v <= t->whole_log2)
        p->texels = cache_find_hashed(cache, t, l->face, res_u, res_v, 0);
    return true;
}

/* Does what is left. False if the tables were dropped: the lookup must begin anew. */
static inline __attribute__((always_inline)) bool complete(slv_sampler *s, uint32_t face,
                                                           slv_filter filter, prepared *p,
                                                           float *out, slv_result *result) {
    const cache_tables *t = p->t;
    uint32_t count = t->nchannels < s->nchannels ? t->nchannels : s->nchannels;
    if (s->nchannels != UINT32_MAX)
        for (uint32_t c = count; c < s->nchannels; c++)
            out[c] = 0;
    if (filter == SLV_FILTER_POINT) {
        v8f texel = load_texel(t->type, p->texels);
        v4f sum;
        memcpy(&sum, &texel, sizeof sum);
        put(sum * t->scale + 0, count, out);
        return true;
    }
    if (!p->texels)
        return look_across(s, p->t, face, p->f, &p->k, p->weight, count, out, result);
    v4f sum = gather_few(t, p->texels, p->pitch, &p->k);
    put(sum * (t->scale / p->weight) + 0, count, out);
    return true;
}

/* Asks for the memory that a prepared lookup will read. */
static inline __attribute__((always_inline)) void fetch_ahead(const prepared *p,
                                                              slv_filter filter) {
    const uint8_t *at = p->texels;
    if (filter == SLV_FILTER_POINT) {
        __builtin_prefetch(at);
        return;
    }
    if (!at)
        return;
    const kernel_axis *u = &p->k.a[0], *v = &p->k.a[1];
    size_t pixel = p->t->pixel_size, pitch = pixel * p->pitch, width = (size_t)u->n * pixel - 1;
    at += (size_t)v->start * pitch + (size_t)u->start * pixel;
    for (int i = 0; i < v->n; i++, at += pitch) {
        __builtin_prefetch(at);
        __builtin_prefetch(at + width);
    }
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
    prepared p;
    cache_pin(&s->thread);
    if (!prepare(s, l, filter, &p) || !complete(s, l->face, filter, &p, out, &result))
        result = look_up(s, l, s->nchannels == UINT32_MAX ? 0 : s->nchannels, out);
    cache_unpin(&s->thread);
    cache_count(&s->thread.lookups, 1);
    return result;
}

/* Some lookups at a time go through each step together, so that none waits for memory or for the
 * steps before. */
static inline __attribute__((always_inline)) slv_result
look_up_many(slv_sampler *s, const slv_lookup *lookups, const uint32_t *order, size_t count,
             slv_filter filter, float *out, size_t stride, slv_result *results) {
    slv_result first = SLV_OK;
    size_t first_at = count, room = s->nchannels == UINT32_MAX ? stride : s->nchannels;
    prepared group[GROUP];
    for (size_t begin = 0; begin < count; begin += GROUP) {
        size_t n = count - begin < GROUP ? count - begin : GROUP, at[GROUP];
        bool ready[GROUP];
        uintptr_t near = 0;
        uint32_t face = UINT32_MAX;
        cache_pin(&s->thread);
        for (size_t i = 0; i < n; i++) {
            at[i] = order ? order[begin + i] : begin + i;
            const slv_lookup *l = &lookups[at[i]];
            if (l->face == face)
                continue;
            face = l->face;
            cache_tables *t = cache_find_tables(s->thread.cache, l->file);
            if (t && face < t->nfaces)
                __builtin_prefetch(&t->faces[face]);
        }
        for (size_t i = 0; i < n; i++) {
            ready[i] = prepare(s, &lookups[at[i]], filter, &group[i]);
            /* neighbours are in the processor's cache, or soon will be */
            if (ready[i] && (uintptr_t)group[i].texels - near + 2048 > 4096)
                fetch_ahead(&group[i], filter);
            near = ready[i] ? (uintptr_t)group[i].texels : near;
        }
        uint64_t moves = s->thread.moves;
        for (size_t i = 0; i < n; i++) {
            slv_result result = SLV_OK;
            const slv_lookup *l = &lookups[at[i]];
            float *to = out + at[i] * stride;
            /* what was found is worth nothing once the pin was let go */
            if (!ready[i] || s->thread.moves != moves ||
                !complete(s, l->face, filter, &group[i], to, &result))
                result = look_up(s, l, room, to);
            if (results)
                results[at[i]] = result;
            if (result && at[i] < first_at) {
                first = result;
                first_at = at[i];
            }
        }
        cache_unpin(&s->thread);
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
