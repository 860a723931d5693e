/* Sources that are made of sources: constants, channels, levels, and one blended over another. */
#include "recipe/mix.h"

#include "base/blend.h"
#include "base/log.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

enum { BOTTOM, TOP, MASK, PARTS };

typedef struct mix {
    slv_bake_source base;
    slv_bake_source *parts[PARTS]; /* the only one is BOTTOM */
    slv_blend blend;
    float opacity;
    slvi_levels_of levels;
    float constant[SLVI_BAKE_MAX_CHANNELS];
    uint32_t channels[SLVI_BAKE_MAX_CHANNELS];
} mix;

static void destroy(slv_bake_source *source) {
    mix *m = (mix *)source;
    for (int i = 0; i < PARTS; i++)
        slv_bake_source_destroy(m->parts[i]);
    slvi_free(m);
}

/* The finest of what it is made of. */
static void extent(const slv_bake_source *source, uint32_t face, float size[2]) {
    const mix *m = (const mix *)source;
    size[0] = size[1] = 0;
    for (int i = 0; i < PARTS; i++) {
        float own[2] = {0, 0};
        if (m->parts[i] && m->parts[i]->fns->extent)
            m->parts[i]->fns->extent(m->parts[i], face, own);
        size[0] = fmaxf(size[0], own[0]);
        size[1] = fmaxf(size[1], own[1]);
    }
}

static uint32_t colors_of(const slv_bake_source *source) {
    return source->desc.nchannels - (source->desc.alpha_channel >= 0);
}

/* Values of a part, in memory of its own. */
typedef struct part {
    const slv_bake_source *source;
    float *values;
    uint8_t *misses;
    uint32_t n, colors;
    int32_t alpha;
} part;

static void release(part *p) {
    slvi_free(p->values);
    slvi_free(p->misses);
}

static slv_result evaluate_part(const slv_bake_source *source, const slv_env *env, uint32_t face,
                                slv_res res, slv_rect rect, part *out) {
    size_t count = (size_t)rect.width * rect.height;
    *out = (part){source, NULL, NULL, 0, 0, SLV_NO_ALPHA};
    if (!source)
        return SLV_OK;
    out->n = source->desc.nchannels;
    out->colors = colors_of(source);
    out->alpha = source->desc.alpha_channel;
    slv_result result =
        slvi_alloc_plain(env, "bake: values", count, out->n * sizeof *out->values, &out->values);
    if (!result)
        result = slvi_alloc_plain(env, "bake: misses", count, 1, &out->misses);
    return result ? result
                  : slv_bake_evaluate(source, env, face, res, rect, out->values, out->misses);
}

/* ---- constants ---- */

static slv_result evaluate_constant(const slv_bake_source *source, const slv_env *env,
                                    uint32_t face, slv_res res, slv_rect rect, float *values,
                                    uint8_t *misses) {
    const mix *m = (const mix *)source;
    size_t count = (size_t)rect.width * rect.height;
    (void)env, (void)face, (void)res, (void)misses;
    for (size_t i = 0; i < count; i++)
        memcpy(values + i * source->desc.nchannels, m->constant,
               source->desc.nchannels * sizeof *values);
    return SLV_OK;
}

slv_result slvi_mix_constant(const slv_env *env, uint32_t nfaces, const float *values, uint32_t n,
                             slv_bake_source **out) {
    static const slvi_bake_fns fns = {evaluate_constant, NULL, NULL, destroy, NULL};
    mix *m = NULL;
    bool small = true;
    *out = NULL;
    slv_result result = slvi_alloc(env, "bake: constant", 1, sizeof *m, &m);
    if (result)
        return result;
    for (uint32_t c = 0; c < n; c++)
        small = small && values[c] >= 0 && values[c] <= 1;
    memcpy(m->constant, values, n * sizeof *values);
    m->base = (slv_bake_source){.fns = &fns,
                                .nfaces = nfaces,
                                .desc = {small ? SLV_TYPE_U8 : SLV_TYPE_FLOAT, n,
                                         n == 4 || n == 2 ? (int32_t)n - 1 : SLV_NO_ALPHA,
                                         small ? SLV_TEXTURE_SRGB : SLV_TEXTURE_LINEAR}};
    *out = &m->base;
    return SLV_OK;
}

/* ---- of one source ---- */

static slv_result begin(const slv_env *env, const slvi_bake_fns *fns, slv_bake_source *const *parts,
                        mix **out) {
    slv_result result = slvi_alloc(env, "bake: mix", 1, sizeof **out, out);
    if (result) {
        for (int i = 0; i < PARTS; i++)
            slv_bake_source_destroy(parts[i]);
        return result;
    }
    mix *m = *out;
    m->base = *parts[BOTTOM];
    m->base.fns = fns;
    m->base.cost = 0;
    for (int i = 0; i < PARTS; i++) {
        m->parts[i] = parts[i];
        m->base.apart |= parts[i] && parts[i]->apart;
        m->base.cost += parts[i] ? parts[i]->cost : 0;
    }
    return SLV_OK;
}

static bool any_extent(slv_bake_source *const *parts) {
    bool any = false;
    for (int i = 0; i < PARTS; i++)
        any |= parts[i] && parts[i]->fns->extent;
    return any;
}

static slv_result evaluate_levels(const slv_bake_source *source, const slv_env *env, uint32_t face,
                                  slv_res res, slv_rect rect, float *values, uint8_t *misses) {
    const mix *m = (const mix *)source;
    const slvi_levels_of *l = &m->levels;
    size_t count = (size_t)rect.width * rect.height, n = source->desc.nchannels;
    slv_result result = slv_bake_evaluate(m->parts[BOTTOM], env, face, res, rect, values, misses);
    for (size_t i = 0; i < count * n && !result; i++) {
        if ((int32_t)(i % n) == source->desc.alpha_channel || misses[i / n])
            continue;
        float x = (values[i] - l->in[0]) / (l->in[1] - l->in[0]);
        if (!l->unclamped)
            x = x > 0 ? (x < 1 ? x : 1) : 0;
        if (l->gamma != 1 && x > 0)
            x = powf(x, 1 / l->gamma);
        values[i] = l->out[0] + x * (l->out[1] - l->out[0]);
    }
    return result;
}

slv_result slvi_mix_levels(const slv_env *env, const slvi_levels_of *levels, slv_bake_source *of,
                           slv_bake_source **out) {
    static const slvi_bake_fns sized = {evaluate_levels, extent, NULL, destroy, NULL},
                               plain = {evaluate_levels, NULL, NULL, destroy, NULL};
    slv_bake_source *parts[PARTS] = {of, NULL, NULL};
    mix *m = NULL;
    *out = NULL;
    slv_result result = begin(env, any_extent(parts) ? &sized : &plain, parts, &m);
    if (result)
        return result;
    m->levels = *levels;
    *out = &m->base;
    return SLV_OK;
}

static slv_result evaluate_channels(const slv_bake_source *source, const slv_env *env,
                                    uint32_t face, slv_res res, slv_rect rect, float *values,
                                    uint8_t *misses) {
    const mix *m = (const mix *)source;
    size_t count = (size_t)rect.width * rect.height, n = source->desc.nchannels;
    part p;
    slv_result result = evaluate_part(m->parts[BOTTOM], env, face, res, rect, &p);
    for (size_t i = 0; i < count && !result; i++) {
        misses[i] = p.misses[i];
        for (uint32_t c = 0; c < n; c++)
            values[i * n + c] = p.values[i * p.n + m->channels[c]];
    }
    release(&p);
    return result;
}

slv_result slvi_mix_channels(const slv_env *env, const uint32_t *channels, uint32_t n,
                             slv_bake_source *of, slv_bake_source **out) {
    static const slvi_bake_fns sized = {evaluate_channels, extent, NULL, destroy, NULL},
                               plain = {evaluate_channels, NULL, NULL, destroy, NULL};
    slv_bake_source *parts[PARTS] = {of, NULL, NULL};
    uint32_t has = of->desc.nchannels;
    mix *m = NULL;
    *out = NULL;
    slv_result result = begin(env, any_extent(parts) ? &sized : &plain, parts, &m);
    if (result)
        return result;
    memcpy(m->channels, channels, n * sizeof *channels);
    m->base.desc.nchannels = n;
    m->base.desc.alpha_channel = SLV_NO_ALPHA;
    for (uint32_t c = 0; c < n; c++) {
        if (channels[c] >= has) {
            destroy(&m->base);
            return slvi_fail(env, SLV_ERROR_ARGUMENT,
                             "recipe: channels: there is no channel %u, the source has %u",
                             channels[c], has);
        }
        if ((int32_t)channels[c] == of->desc.alpha_channel && c + 1 == n && n > 1)
            m->base.desc.alpha_channel = (int32_t)c;
    }
    *out = &m->base;
    return SLV_OK;
}

/* ---- one over another ---- */

static float color(const part *p, size_t texel, uint32_t c) {
    uint32_t k = p->colors == 1 ? 0 : c;
    return p->values[texel * p->n + k + (p->alpha == 0)];
}

static float alpha(const part *p, size_t texel) {
    return p->alpha < 0 ? 1 : p->values[texel * p->n + (size_t)p->alpha];
}

/* A mask is one number: Rec. 709's luminance of colours. */
static float mask_of(const part *p, size_t texel) {
    if (!p->source)
        return 1;
    float value = p->colors < 3 ? color(p, texel, 0)
                                : 0.2126f * color(p, texel, 0) + 0.7152f * color(p, texel, 1) +
                                      0.0722f * color(p, texel, 2);
    value *= alpha(p, texel);
    return value > 0 ? (value < 1 ? value : 1) : 0;
}

static void blend_texel(const mix *m, const part *p, size_t i, float *out) {
    const slv_bake_source_desc *desc = &m->base.desc;
    const uint32_t colors = colors_of(&m->base);
    const bool whole = m->blend == SLV_BLEND_COLOR && colors == 3;
    const float amount = m->opacity * mask_of(&p[MASK], i), over = alpha(&p[TOP], i);
    const float weight = m->blend == SLV_BLEND_REPLACE ? amount : amount * over;
    const float under = alpha(&p[BOTTOM], i);
    /* a color of other than three is normal */
    const bool normal = m->blend == SLV_BLEND_NORMAL || (m->blend == SLV_BLEND_COLOR && !whole);
    float total = under, a[SLVI_BAKE_MAX_CHANNELS], b[SLVI_BAKE_MAX_CHANNELS], mixed[3];
    for (uint32_t c = 0; c < colors; c++) {
        a[c] = color(&p[BOTTOM], i, c);
        b[c] = color(&p[TOP], i, c);
    }
    if (whole)
        slvi_blend_color(a, b, mixed);
    if (normal)
        total = weight + under * (1 - weight);
    else if (m->blend == SLV_BLEND_REPLACE)
        total = under + weight * (over - under);
    for (uint32_t c = 0; c < colors; c++) {
        if (normal)
            out[c] = total > 0 ? (a[c] * under * (1 - weight) + b[c] * weight) / total : 0;
        else
            out[c] =
                a[c] +
                weight * ((whole ? mixed[c] : slvi_blend_channel(m->blend, a[c], b[c])) - a[c]);
    }
    if (desc->alpha_channel >= 0)
        out[colors] = total;
}

static slv_result evaluate_blend(const slv_bake_source *source, const slv_env *env, uint32_t face,
                                 slv_res res, slv_rect rect, float *values, uint8_t *misses) {
    const mix *m = (const mix *)source;
    size_t count = (size_t)rect.width * rect.height;
    part p[PARTS] = {{0}};
    slv_result result = SLV_OK;
    for (int k = 0; k < PARTS && !result; k++)
        result = evaluate_part(m->parts[k], env, face, res, rect, &p[k]);
    for (size_t i = 0; i < count && !result; i++) {
        for (int k = 0; k < PARTS; k++)
            if (!misses[i] && p[k].misses)
                misses[i] = p[k].misses[i];
        if (!misses[i])
            blend_texel(m, p, i, values + i * source->desc.nchannels);
    }
    for (int k = 0; k < PARTS; k++)
        release(&p[k]);
    return result;
}

slv_result slvi_mix_blend(const slv_env *env, slv_blend blend, float opacity,
                          slv_bake_source *bottom, slv_bake_source *top, slv_bake_source *mask,
                          slv_bake_source **out) {
    static const slvi_bake_fns sized = {evaluate_blend, extent, NULL, destroy, NULL},
                               plain = {evaluate_blend, NULL, NULL, destroy, NULL};
    slv_bake_source *parts[PARTS] = {bottom, top, mask};
    uint32_t a = colors_of(bottom), b = colors_of(top), colors = a > b ? a : b;
    mix *m = NULL;
    *out = NULL;
    slv_result result = begin(env, any_extent(parts) ? &sized : &plain, parts, &m);
    if (result)
        return result;
    if (a != b && a != 1 && b != 1) {
        destroy(&m->base);
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "recipe: blend: %u colours over %u: as many, or one on either side", b, a);
    }
    m->blend = blend;
    m->opacity = opacity;
    bool covers = bottom->desc.alpha_channel >= 0;
    m->base.desc.nchannels = colors + covers;
    m->base.desc.alpha_channel = covers ? (int32_t)colors : SLV_NO_ALPHA;
    *out = &m->base;
    return SLV_OK;
}
