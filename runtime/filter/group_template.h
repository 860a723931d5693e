/* Template: batches. Some lookups at a time go through each step together, so that none waits for
 * memory or for the steps before, and what is the same for all is done once. */
#ifndef SLV_FILTER_GROUP_TEMPLATE_H
#define SLV_FILTER_GROUP_TEMPLATE_H

#include "filter/quick_template.h"

#define GROUP_SIZE 8 /* as many as a vector has lanes */

/* Lookups of a group, one to a lane. */
typedef struct group_places {
    v8i file, face;
    v8f u, v, uw, vw;
} group_places;

/* Where their kernels lie. */
typedef struct group_spans {
    kernel_spans u, v;
    v8i inside; /* whether within the face, */
    v8i small;  /* or within an apron */
} group_spans;

/* A step's results for each lookup of a group that is spread over faces. */
typedef struct group {
    const slv_lookup *lookups[GROUP_SIZE];
    size_t at[GROUP_SIZE]; /* which of the batch they are */
    int n;                 /* the rest are copies of the last */
    cache_tables *tables[GROUP_SIZE];
    cache_face *faces[GROUP_SIZE];
    const uint8_t *texels[GROUP_SIZE]; /* NULL: to be looked for */
    size_t pitch[GROUP_SIZE];
    bool ready[GROUP_SIZE]; /* false: not one of most lookups, see quick_look_up() */
    uint64_t moves;         /* of the thread, when it was prepared */
    float scale[GROUP_SIZE], weight[GROUP_SIZE];
    kernel kernels[GROUP_SIZE];
} group;

/* Where a batch's values go. */
typedef struct group_out {
    float *values;
    size_t stride, room;
    slv_result *results; /* or NULL */
    slv_result first;
    size_t first_at;
} group_out;

static inline void group_note_result(group_out *out, size_t at, slv_result result) {
    if (out->results)
        out->results[at] = result;
    if (result && at < out->first_at) {
        out->first = result;
        out->first_at = at;
    }
}

/* Turns rows into columns; without loops, so that none of it goes through memory. */
static inline __attribute__((always_inline)) void
group_load_places(const slv_sampler *s, const group *g, group_places *out) {
    v8f rows[GROUP_SIZE], pairs[GROUP_SIZE], fours[GROUP_SIZE];
    _Pragma("GCC unroll 8") for (int i = 0; i < GROUP_SIZE; i++) rows[i] =
        v8_load_float((const float *)(const void *)g->lookups[i]);
    _Pragma("GCC unroll 4") for (int i = 0; i < GROUP_SIZE; i += 2) {
        pairs[i] = v8_low_pairs(rows[i], rows[i + 1]);
        pairs[i + 1] = v8_high_pairs(rows[i], rows[i + 1]);
    }
    _Pragma("GCC unroll 2") for (int i = 0; i < GROUP_SIZE; i += 4)
        _Pragma("GCC unroll 2") for (int j = 0; j < 2; j++) {
        fours[i + 2 * j] = v8_low_fours(pairs[i + j], pairs[i + 2 + j]);
        fours[i + 2 * j + 1] = v8_high_fours(pairs[i + j], pairs[i + 2 + j]);
    }
    v8f uw1 = v8_high_half(fours[0], fours[4]), vw1 = v8_high_half(fours[1], fours[5]);
    v8f uw2 = v8_high_half(fours[2], fours[6]), vw2 = v8_high_half(fours[3], fours[7]);
    out->file = (v8i)v8_low_half(fours[0], fours[4]);
    out->face = (v8i)v8_low_half(fours[1], fours[5]);
    out->u = v8_low_half(fours[2], fours[6]);
    out->v = v8_low_half(fours[3], fours[7]);
    out->uw = (v8_abs(uw1) + v8_abs(uw2)) * s->width + s->blur;
    out->vw = (v8_abs(vw1) + v8_abs(vw2)) * s->width + s->blur;
}

/* Whether positions are on the face and footprints finite, and the filter is one of those that are
 * looked up quickly. */
static inline __attribute__((always_inline)) v8i group_are_sound(const group_places *at,
                                                                 slv_filter filter) {
    if (filter == SLV_FILTER_ANISOTROPIC)
        return (v8i){0};
    v8i sound = (v8i)((v8u32)at->u < QUICK_UNIT_BITS) & (v8i)((v8u32)at->v < QUICK_UNIT_BITS);
    return filter == SLV_FILTER_POINT ? sound : sound & (at->uw < INFINITY) & (at->vw < INFINITY);
}

static inline __attribute__((always_inline)) void
group_find_spans(const slv_sampler *s, const kernel_shape *shape, const group_places *at, v8i res_u,
                 v8i res_v, group_spans *out) {
    quick_reach u, v;
    kernel_span_axes(shape, at->u, at->uw, res_u, &out->u);
    kernel_span_axes(shape, at->v, at->vw, res_v, &out->v);
    quick_find_reach(s, &out->u, &u);
    quick_find_reach(s, &out->v, &v);
    out->inside = u.inside & v.inside;
    out->small = u.small & v.small;
}

/* A face that all lookups of a group are on. */
typedef struct group_face {
    cache_tables *tables;
    cache_face *face;
    uint32_t id, channels;
} group_face;

/* How far the lookups of a group may be from each other to count as neighbours: in values of a row
 * of texels, with those that vectors read beyond. */
#define GROUP_BAND 256

/* Rows of texels under kernels that are one along v and side by side along u. */
typedef struct group_band {
    kernel_axis rows;
    float weight;          /* of the rows */
    v8i there;             /* which kernels lie on it */
    int first, end;        /* their first texel along u, and the one behind the last */
    const uint8_t *texels; /* that first one's, in the row that `rows` begins at */
    size_t pitch;
    uint8_t copies[(GROUP_BAND / 4 + PATCH_GAP) * PATCH_PIXEL * KERNEL_MAX + CACHE_PADDING];
} group_band;

static inline __attribute__((always_inline)) size_t group_band_vectors(const group_band *band,
                                                                       size_t channels) {
    return ((size_t)(band->end - band->first) * channels + 7) / 8;
}

static inline __attribute__((always_inline)) void group_measure_band(const group_spans *spans,
                                                                     group_band *band) {
    const v8i none = {0};
    band->first = v8_least(v8_select_int(band->there, spans->u.start, none + INT32_MAX));
    band->end = v8_most(v8_select_int(band->there, spans->u.start + spans->u.n, none + INT32_MIN));
}

/* A band that reaches beyond its face. False if it is none that can be a patch. */
static __attribute__((noinline)) bool group_patch_band(slv_sampler *s, const group_face *on,
                                                       int res_u, group_band *band) {
    lookup_state state = {.sampler = s, .tables = on->tables, .count = on->tables->nchannels};
    patch p;
    int width = band->end - band->first;
    if (!patch_cut(res_u, band->first, width, &p.a[0]) ||
        !patch_cut(band->rows.res, band->rows.start, band->rows.n, &p.a[1]) ||
        !patch_find(&state, on->id, on->face, &p))
        return false;
    band->pitch = (size_t)width + PATCH_GAP;
    patch_copy(&p, on->tables->pixel_size, band->pitch, band->copies);
    band->rows.start = 0;
    band->texels = band->copies;
    cache_count(&s->thread.pieces, state.pieces);
    return true;
}

/* False if there is none. */
static inline __attribute__((always_inline)) bool
group_find_band(slv_sampler *s, const kernel_shape *shape, const group_spans *spans,
                const group_face *on, group_band *band) {
    const v8i none = {0};
    const cache_tables *t = on->tables;
    v8i same = (spans->u.res == spans->u.res[0]) & (spans->v.res == spans->v.res[0]) &
               (spans->v.start == spans->v.start[0]) & (spans->v.n == spans->v.n[0]) &
               (spans->v.a == spans->v.a[0]) & (spans->v.b == spans->v.b[0]) &
               (spans->v.coarse == spans->v.coarse[0]);
    if (!v8_all(same))
        return false;
    int res_u = spans->u.res[0];
    band->weight = kernel_weigh_axis(shape, &spans->v, 0, &band->rows);
    if (!v8_all(spans->inside) && !s->no_edge_blend) {
        band->there = ~none;
        group_measure_band(spans, band);
        uint64_t moves = s->thread.moves;
        if (group_band_vectors(band, t->nchannels) < GROUP_BAND / 8 &&
            group_patch_band(s, on, res_u, band))
            return true;
        if (s->thread.moves != moves)
            return false;
    }
    band->there = spans->inside;
    if (v8_none(band->there))
        return false;
    group_measure_band(spans, band);
    kernel k;
    quick_last last = {0};
    k.a[0].res = res_u;
    k.a[1].res = band->rows.res;
    band->texels = quick_find_texels(s->thread.view, t, on->id, on->face, false, true, &k, &last,
                                     &band->pitch);
    if (!band->texels || group_band_vectors(band, t->nchannels) >= GROUP_BAND / 8)
        return false;
    band->texels += (size_t)band->first * t->pixel_size;
    return true;
}

/* What a band gives: sums of its rows, and how columns of them are weighed. */
typedef struct group_columns {
    union {
        v8f v[GROUP_BAND / 8];
        float f[GROUP_BAND];
    } sums;
    union {
        v8f v[KERNEL_GROUP];
        float f[KERNEL_GROUP * GROUP_SIZE];
    } weights;
    v8f scales;
    v8i at; /* the first of each kernel among the sums */
} group_columns;

/* The values of lookups whose kernels have `count` columns each, a constant, so that there are no
 * loops; 0: they differ. */
static inline __attribute__((always_inline)) void
group_put_band(const slv_sampler *s, const group *g, const group_columns *columns, v8i counts,
               int count, const group_band *band, const group_face *on, group_out *out) {
    size_t n = on->tables->nchannels;
    bool zeros = on->channels < s->nchannels, all = v8_all(band->there);
    for (int i = 0; i < g->n; i++) {
        if (!all && !band->there[i])
            continue;
        float *to = out->values + g->at[i] * out->stride;
        const float *sums = columns->sums.f + columns->at[i];
        if (zeros)
            quick_put_zeros(s, on->channels, to);
        v4f sum;
        GATHER_COLUMNS(sums, n, columns->weights.f + i, GROUP_SIZE, count ? count : counts[i], sum);
        quick_put(sum * columns->scales[i] + 0, on->channels, to);
        group_note_result(out, g->at[i], SLV_OK);
    }
}

/* Kernels side by side, as along rows of pixels or texels: rows of texels are added up once for all
 * of them. Returns which were done. */
static inline __attribute__((always_inline)) v8i
group_add_band(slv_sampler *s, const group *g, const kernel_shape *shape, const group_spans *spans,
               const group_face *on, group_out *out) {
    group_band band;
    group_columns columns;
    const cache_tables *t = on->tables;
    v8i counts = spans->u.n;
    int longest = v8_most(counts);
    v8f whole = v8_splat(1);
    if (!kernel_weigh_group(shape, &spans->u, longest, columns.weights.v, &whole) ||
        !group_find_band(s, shape, spans, on, &band))
        return (v8i){0};
    gather_bands[t->type](band.texels, band.pitch * t->nchannels, &band.rows,
                          group_band_vectors(&band, t->nchannels), columns.sums.v);
    columns.scales = t->scale / (whole * band.weight);
    columns.at = (spans->u.start - band.first) * (int)t->nchannels;
#define GROUP_PUT(COUNT) group_put_band(s, g, &columns, counts, COUNT, &band, on, out)
    /* bilinear kernels, and most boxes of up to two texels, are a sixth faster without loops; wide
     * ones hardly */
    switch (v8_all(counts == longest) ? longest : 0) {
    case 2:
        GROUP_PUT(2);
        break;
    case 3:
        GROUP_PUT(3);
        break;
    default:
        GROUP_PUT(0);
    }
#undef GROUP_PUT
    return band.there;
}

/* A group on one face. Returns false, and nothing is done, if it is none. */
static inline __attribute__((always_inline)) bool
group_look_up_alike(slv_sampler *s, const group *g, const group_places *at, slv_filter filter,
                    group_out *out) {
    v8i same = (at->file == at->file[0]) & (at->face == at->face[0]) & group_are_sound(at, filter);
    if (!v8_all(same))
        return false;
    const cache_view *cache = s->thread.view;
    uint32_t face = (uint32_t)at->face[0];
    cache_tables *t = cache_find_tables(cache, (slv_file_id)at->file[0]);
    if (!t || face >= t->nfaces || !quick_fits(s, &t->faces[face]))
        return false;
    cache_face *f = &t->faces[face];
    uint32_t channels = t->nchannels < s->nchannels ? t->nchannels : s->nchannels;
    if (channels > out->room)
        return false;
    v8i res_u = (v8i){0} + f->res_u, res_v = (v8i){0} + f->res_v;
    if (filter == SLV_FILTER_POINT) {
        const uint8_t *texels = cache_find_full(cache, f);
        if (!texels)
            return false;
        v8i x, y;
        point_places(at->u, at->v, res_u, res_v, &x, &y);
        v8i index = (y << f->res_u) + x;
        for (int i = 0; i < g->n; i++) {
            float *to = out->values + g->at[i] * out->stride;
            quick_put_zeros(s, channels, to);
            quick_put_texel(t, texels + (size_t)index[i] * t->pixel_size, channels, to);
            group_note_result(out, g->at[i], SLV_OK);
        }
        return true;
    }
    kernel_shape shape = s->shape;
    shape.filter = filter;
    group_spans spans;
    group_find_spans(s, &shape, at, res_u, res_v, &spans);
    quick_last last = {0};
    uint64_t moves = s->thread.moves;
    group_face on = {t, f, face, channels};
    v8i done = {0};
    if (v8_none(spans.small))
        done = group_add_band(s, g, &shape, &spans, &on, out);
    if (v8_all(done))
        return true;
    kernel k;
    k.turns = 0;
    for (int i = 0; i < g->n; i++) {
        slv_result result = SLV_OK;
        float *to = out->values + g->at[i] * out->stride;
        if (done[i])
            continue;
        /* what was found is worth nothing once the pin was let go */
        if (s->thread.moves != moves) {
            group_note_result(out, g->at[i], any_look_up(s, g->lookups[i], out->room, to));
            continue;
        }
        size_t pitch;
        float weight = kernel_weigh_axis(&shape, &spans.u, i, &k.a[0]);
        weight *= kernel_weigh_axis(&shape, &spans.v, i, &k.a[1]);
        const uint8_t *texels = quick_find_texels(cache, t, face, f, spans.small[i],
                                                  spans.inside[i], &k, &last, &pitch);
        quick_put_zeros(s, channels, to);
        if (texels) {
            v4f sum = gather_few(t, texels, pitch, &k);
            quick_put(sum * (t->scale / weight) + 0, channels, to);
        } else if (!quick_across(s, t, face, f, &k, weight, channels, to, &result))
            result = any_look_up(s, g->lookups[i], out->room, to);
        group_note_result(out, g->at[i], result);
    }
    return true;
}

/* Asks for the memory that a prepared lookup will read. */
static inline __attribute__((always_inline)) void group_fetch_ahead(const group *g, int i,
                                                                    slv_filter filter) {
    const uint8_t *at = g->texels[i];
    if (filter == SLV_FILTER_POINT) {
        __builtin_prefetch(at);
        return;
    }
    const kernel_axis *u = &g->kernels[i].a[0], *v = &g->kernels[i].a[1];
    size_t pixel = g->tables[i]->pixel_size, pitch = pixel * g->pitch[i];
    size_t width = (size_t)u->n * pixel - 1;
    at += (size_t)v->start * pitch + (size_t)u->start * pixel;
    for (int j = 0; j < v->n; j++, at += pitch) {
        __builtin_prefetch(at);
        __builtin_prefetch(at + width);
    }
}

/* The same for one that reaches over edges: its own face's part, and what is known of the others.
 */
static inline void group_fetch_around(const slv_sampler *s, const group *g, int i) {
    const kernel_axis *u = &g->kernels[i].a[0], *v = &g->kernels[i].a[1];
    const cache_tables *t = g->tables[i];
    cache_face *f = g->faces[i];
    for (int e = 0; e < 4; e++) {
        const kernel_axis *a = slvi_edge_along_v((unsigned)e) ? u : v;
        bool over = slvi_edge_is_far((unsigned)e) ? a->start + a->n > 1 << a->res : a->start < 0;
        if (over && f->adjacent[e] >= 0)
            __builtin_prefetch(&t->faces[f->adjacent[e]]);
    }
    const uint8_t *at = cache_find_full(s->thread.view, f);
    if (!at || u->res != f->res_u || v->res != f->res_v)
        return;
    int first = v->start < 0 ? 0 : v->start, end = v->start + v->n, size = 1 << v->res;
    size_t pitch = (size_t)t->pixel_size << u->res;
    at += (size_t)(u->start < 0 ? 0 : u->start) * t->pixel_size + (size_t)first * pitch;
    for (; first < end && first < size; first++, at += pitch)
        __builtin_prefetch(at);
}

/* Finds tables and faces. */
static inline __attribute__((always_inline)) void group_find_faces(const slv_sampler *s, group *g) {
    const cache_view *cache = s->thread.view;
    for (int i = 0; i < g->n; i++) {
        const slv_lookup *l = g->lookups[i];
        if (i && l->face == g->lookups[i - 1]->face && l->file == g->lookups[i - 1]->file) {
            g->tables[i] = g->tables[i - 1];
            g->faces[i] = g->faces[i - 1];
            continue;
        }
        cache_tables *t = cache_find_tables(cache, l->file);
        g->tables[i] = t;
        g->faces[i] = t && l->face < t->nfaces ? &t->faces[l->face] : NULL;
        if (g->faces[i])
            __builtin_prefetch(g->faces[i]);
    }
}

/* Finds texels, and makes kernels, as look_up_quick() does for one. */
static inline __attribute__((always_inline)) void
group_prepare(slv_sampler *s, group *g, group_places *at, slv_filter filter, size_t room) {
    const cache_view *cache = s->thread.view;
    size_t most = s->nchannels == UINT32_MAX ? room : UINT32_MAX;
    v8i res_u = {0}, res_v = {0}, sound = group_are_sound(at, filter);
    /* what is not a number, or huge, overflows integers in its lane */
    at->u = v8_select(sound, at->u, v8_splat(0));
    at->v = v8_select(sound, at->v, v8_splat(0));
    g->moves = s->thread.moves;
    group_find_faces(s, g);
    for (int i = 0; i < g->n; i++) {
        const cache_face *f = g->faces[i];
        g->ready[i] = f && quick_fits(s, f) && sound[i] && g->tables[i]->nchannels <= most;
        res_u[i] = g->ready[i] ? f->res_u : 0;
        res_v[i] = g->ready[i] ? f->res_v : 0;
        g->scale[i] = g->ready[i] ? g->tables[i]->scale : 0;
    }
    if (filter == SLV_FILTER_POINT) {
        v8i x, y;
        point_places(at->u, at->v, res_u, res_v, &x, &y);
        for (int i = 0; i < g->n; i++) {
            if (!g->ready[i])
                continue;
            cache_face *f = g->faces[i];
            const uint8_t *texels = cache_find_full(cache, f);
            size_t place = ((size_t)y[i] << f->res_u) + (size_t)x[i];
            g->ready[i] = texels != NULL;
            if (texels)
                g->texels[i] = texels + place * g->tables[i]->pixel_size;
        }
        return;
    }
    kernel_shape shape = s->shape;
    shape.filter = filter;
    group_spans spans;
    group_find_spans(s, &shape, at, res_u, res_v, &spans);
    quick_last last = {0};
    for (int i = 0; i < g->n; i++) {
        if (!g->ready[i])
            continue;
        kernel *k = &g->kernels[i];
        k->turns = 0;
        g->weight[i] = kernel_weigh_axis(&shape, &spans.u, i, &k->a[0]);
        g->weight[i] *= kernel_weigh_axis(&shape, &spans.v, i, &k->a[1]);
        g->texels[i] = quick_find_texels(cache, g->tables[i], g->lookups[i]->face, g->faces[i],
                                         spans.small[i], spans.inside[i], k, &last, &g->pitch[i]);
    }
}

/* Asks for what a prepared lookup reads. `near` is where the one before did: neighbours are in the
 * processor's cache, or soon will be. */
static inline __attribute__((always_inline)) void
group_fetch(const slv_sampler *s, const group *g, int i, slv_filter filter, uintptr_t *near) {
    if (!g->ready[i] || s->thread.moves != g->moves)
        return;
    if (!g->texels[i]) {
        group_fetch_around(s, g, i);
        return;
    }
    if ((uintptr_t)g->texels[i] - *near + 2048 > 4096)
        group_fetch_ahead(g, i, filter);
    *near = (uintptr_t)g->texels[i];
}

/* Looks up one of a group that is spread over faces. */
static inline __attribute__((always_inline)) slv_result
group_look_up_spread(slv_sampler *s, group *g, int i, slv_filter filter, group_out *out) {
    float *to = out->values + g->at[i] * out->stride;
    if (!g->ready[i] || s->thread.moves != g->moves)
        return any_look_up(s, g->lookups[i], out->room, to);
    cache_tables *t = g->tables[i];
    uint32_t channels = t->nchannels < s->nchannels ? t->nchannels : s->nchannels;
    quick_put_zeros(s, channels, to);
    if (filter == SLV_FILTER_POINT) {
        quick_put_texel(t, g->texels[i], channels, to);
        return SLV_OK;
    }
    if (g->texels[i]) {
        v4f sum = gather_few(t, g->texels[i], g->pitch[i], &g->kernels[i]);
        quick_put(sum * (g->scale[i] / g->weight[i]) + 0, channels, to);
        return SLV_OK;
    }
    slv_result result = SLV_OK;
    if (!quick_across(s, t, g->lookups[i]->face, g->faces[i], &g->kernels[i], g->weight[i],
                      channels, to, &result))
        result = any_look_up(s, g->lookups[i], out->room, to);
    return result;
}

/* Looks up what the group before (or NULL) has asked for, and by turns asks for what the next one
 * (or NULL) reads: all at once would be more than processors wait for at a time. */
static inline __attribute__((always_inline)) void
group_step(slv_sampler *s, group *before, const group *next, slv_filter filter, group_out *out) {
    uintptr_t near = 0;
    for (int i = 0; i < GROUP_SIZE; i++) {
        if (next && i < next->n)
            group_fetch(s, next, i, filter, &near);
        if (before && i < before->n)
            group_note_result(out, before->at[i], group_look_up_spread(s, before, i, filter, out));
    }
}

/* How many groups go by until memory that was thrown away meanwhile can be used anew. */
#define GROUP_PINNED 64

static inline __attribute__((always_inline)) slv_result
group_look_up_many(slv_sampler *s, const slv_lookup *lookups, const uint32_t *order, size_t count,
                   slv_filter filter, float *values, size_t stride, slv_result *results) {
    group_out out = {values,  stride, s->nchannels == UINT32_MAX ? stride : s->nchannels,
                     results, SLV_OK, count};
    group groups[2], *waiting = NULL; /* for what it has asked for */
    int next = 0;
    for (size_t begin = 0; begin < count; begin += GROUP_SIZE) {
        group *g = &groups[next];
        g->n = count - begin < GROUP_SIZE ? (int)(count - begin) : GROUP_SIZE;
        for (int i = 0; i < GROUP_SIZE; i++) {
            size_t each = begin + (size_t)(i < g->n ? i : g->n - 1);
            g->at[i] = order ? order[each] : each;
            g->lookups[i] = &lookups[g->at[i]];
        }
        group_places at;
        group_load_places(s, g, &at);
        if (begin / GROUP_SIZE % GROUP_PINNED == 0)
            cache_pin(&s->thread);
        bool alike = group_look_up_alike(s, g, &at, filter, &out);
        if (!alike)
            group_prepare(s, g, &at, filter, out.room);
        if (waiting || !alike)
            group_step(s, waiting, alike ? NULL : g, filter, &out);
        waiting = alike ? NULL : g;
        next ^= !alike;
        if (begin / GROUP_SIZE % GROUP_PINNED == GROUP_PINNED - 1 || begin + GROUP_SIZE >= count) {
            if (waiting)
                group_step(s, waiting, NULL, filter, &out);
            waiting = NULL;
            cache_unpin(&s->thread);
        }
    }
    cache_count(&s->thread.lookups, count);
    return out.first;
}

#endif
