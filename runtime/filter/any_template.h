/* Template: any lookup on a quad mesh, from position and footprint to value: every position, face,
 * number of channels and filter, loading what is not there. */
#ifndef SLV_FILTER_ANY_TEMPLATE_H
#define SLV_FILTER_ANY_TEMPLATE_H

#include "filter/apron_template.h"
#include "filter/patch_template.h"
#include "filter/point_template.h"
#include "filter/variants.h"

/* A coordinate outside of its face; false if the lookup sees nothing but black. */
static inline bool any_border(slv_border_mode mode, float *x) {
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
static inline __attribute__((always_inline)) float any_build(const kernel_shape *shape,
                                                             const cache_face *f, float u, float v,
                                                             float uw, float vw, kernel *k) {
    if (!is_subface(f))
        return kernel_build(shape, u, v, uw, vw, f->res_u, f->res_v, k);
    /* a quarter of a whole face */
    float sum = kernel_build(shape, u * 0.5f, v * 0.5f, uw * 0.5f, vw * 0.5f, f->res_u + 1,
                             f->res_v + 1, k);
    for (int axis = 0; axis < 2; axis++) {
        if (k->a[axis].res == 0)
            kernel_axis_upsample(&k->a[axis]);
        k->a[axis].res--;
    }
    return sum;
}

/* Lays a kernel of a known weight onto its face and those around. */
static inline void any_kernel(lookup_state *state, uint32_t face, cache_face *f, kernel *k,
                              float weight) {
    bool inside = kernel_is_inside(k);
    state->weight = weight;
    if (cache_is_plain(f) && !state->sampler->no_edge_blend && apron_fits(k) &&
        (apron_apply(state, face, f, k) || lookup_is_over(state)))
        return;
    if (inside) {
        seam_inside(state, face, f, k);
        return;
    }
    if (cache_is_plain(f) && !state->sampler->no_edge_blend &&
        (patch_apply(state, face, f, k) || lookup_is_over(state)))
        return;
    kernel_axis_strip(&k->a[0]);
    kernel_axis_strip(&k->a[1]);
    seam_across(state, face, k);
}

static void any_quad(lookup_state *state, const slv_lookup *l) {
    const slv_sampler *s = state->sampler;
    const cache_tables *t = state->tables;
    cache_face *f = lookup_face_at(state, l->face);
    float u = l->u, v = l->v;
    if (cache_flags(f) & SLV_FACE_NEIGHBOURS_CONSTANT) {
        state->weight = 1;
        gather_add_average(state, l->face, f, 1);
        return;
    }
    if (!any_border(t->border_u, &u) || !any_border(t->border_v, &v)) {
        state->weight = 1;
        return;
    }
    float blur = is_subface(f) ? 2 * s->blur : s->blur;
    float uw = (fabsf(l->uw1) + fabsf(l->uw2)) * s->width + blur;
    float vw = (fabsf(l->vw1) + fabsf(l->vw2)) * s->width + blur;
    kernel k;
    float weight = any_build(&s->shape, f, u, v, uw, vw, &k);
    any_kernel(state, l->face, f, &k, weight);
}

static inline bool any_is_sound(const slv_sampler *s, const slv_lookup *l) {
    /* x - x is 0 for all but infinity and NaN */
    float position = (l->u - l->u) + (l->v - l->v);
    float footprint = fabsf(l->uw1) + fabsf(l->vw1) + fabsf(l->uw2) + fabsf(l->vw2);
    return position == 0 && (s->shape.filter == SLV_FILTER_POINT || footprint == footprint);
}

/* The thread is pinned. `room`: how many values to set, or 0 for as many as the file gives. Not
 * inlined, so that lookups that need none of it save no registers for it. */
static __attribute__((noinline)) slv_result any_look_up(slv_sampler *s, const slv_lookup *l,
                                                        size_t room, float *out) {
    for (;;) {
        cache_tables *t = cache_find_tables(s->thread.view, l->file);
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
        if (l->face >= t->nfaces || !any_is_sound(s, l) || (room && state.count > room))
            return SLV_ERROR_ARGUMENT;
        if (!state.count)
            return SLV_OK;
        if (s->shape.filter == SLV_FILTER_POINT)
            point_any(&state, l);
        else if (t->triangle)
            slvi_triangle_sum(&state, l);
        else if (s->shape.filter == SLV_FILTER_ANISOTROPIC)
            SLVI_VARIANT(slvi_anisotropic_sum)(&state, l);
        else
            any_quad(&state, l);
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

#endif
