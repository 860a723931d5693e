/* Blend modes: one function of backdrop and source for each, and one formula for all that mixes by
 * alpha. */
#include "canvas/blend.h"

#include "base/names.h"

#include <math.h>
#include <string.h>

static const char *const blend_names[SLV_BLEND_COUNT] = {
    "normal", "multiply", "screen", "overlay", "darken", "lighten", "add", "color", "replace"};

const char *slv_blend_name(slv_blend blend) {
    return slvi_name_of(blend_names, SLVI_COUNT(blend_names), (int)blend);
}

bool slv_blend_from_name(const char *name, slv_blend *out) {
    int value;
    if (!slvi_name_find(blend_names, SLVI_COUNT(blend_names), name, &value))
        return false;
    *out = (slv_blend)value;
    return true;
}

static float mix_channel(slv_blend blend, float below, float above) {
    switch (blend) {
    case SLV_BLEND_MULTIPLY:
        return below * above;
    case SLV_BLEND_SCREEN:
        return below + above - below * above;
    case SLV_BLEND_OVERLAY:
        return below <= 0.5f ? 2 * below * above : 1 - 2 * (1 - below) * (1 - above);
    case SLV_BLEND_DARKEN:
        return fminf(below, above);
    case SLV_BLEND_LIGHTEN:
        return fmaxf(below, above);
    case SLV_BLEND_ADD:
        return below + above;
    default:
        return above;
    }
}

static float luminosity(const float *c) {
    return 0.3f * c[0] + 0.59f * c[1] + 0.11f * c[2];
}

/* The paint's colour with the luminosity of what is below; brought back into 0..1 as the
 * specification's ClipColor does, if both were in it. */
static void mix_color(const float *below, const float *above, float *out) {
    float shift = luminosity(below) - luminosity(above), low, high, l = luminosity(below);
    for (int k = 0; k < 3; k++)
        out[k] = above[k] + shift;
    low = fminf(out[0], fminf(out[1], out[2]));
    high = fmaxf(out[0], fmaxf(out[1], out[2]));
    for (int k = 0; k < 3; k++) {
        if (low < 0 && l > low && l >= 0)
            out[k] = l + (out[k] - l) * l / (l - low);
        if (high > 1 && high > l && l <= 1)
            out[k] = l + (out[k] - l) * (1 - l) / (high - l);
    }
}

/* The channels that are painted, as they are for all texels. */
typedef struct mixing {
    const slv_paint *paint;
    uint32_t first, end; /* channels */
    int32_t alpha;       /* or -1 */
    uint32_t colours;    /* of them without alpha */
} mixing;

static void erase(const mixing *m, float amount, float *texel) {
    if (m->alpha >= 0) {
        texel[m->alpha] *= 1 - amount;
        return;
    }
    for (uint32_t c = m->first; c < m->end; c++)
        texel[c] *= 1 - amount;
}

/* The colours of the paint over a backdrop that is opaque. */
static void mix(const mixing *m, const float *texel, float *out) {
    float below[3], above[3], mixed[3];
    uint32_t n = 0;
    for (uint32_t c = m->first; c < m->end; c++)
        out[c - m->first] = mix_channel(m->paint->blend, texel[c], m->paint->color[c - m->first]);
    if (m->paint->blend != SLV_BLEND_COLOR || m->colours != 3)
        return;
    for (uint32_t c = m->first; c < m->end; c++)
        if ((int32_t)c != m->alpha) {
            below[n] = texel[c];
            above[n++] = m->paint->color[c - m->first];
        }
    mix_color(below, above, mixed);
    n = 0;
    for (uint32_t c = m->first; c < m->end; c++)
        if ((int32_t)c != m->alpha)
            out[c - m->first] = mixed[n++];
}

/* Normal blending, as nearly all paint is: what put() comes to. */
static void put_normal(const mixing *m, float amount, float *texel) {
    float below = m->alpha >= 0 ? texel[m->alpha] : 1;
    float result = m->paint->lock_alpha ? below : amount + below * (1 - amount);
    float share = m->paint->lock_alpha || below == 1 ? amount : result > 0 ? amount / result : 0;
    for (uint32_t c = m->first; c < m->end; c++)
        texel[c] += share * (m->paint->color[c - m->first] - texel[c]);
    if (m->alpha >= 0)
        texel[m->alpha] = result;
}

static void put(const mixing *m, float amount, float *texel) {
    const slv_paint *paint = m->paint;
    float mixed[SLV_PAINT_CHANNELS], below = m->alpha >= 0 ? texel[m->alpha] : 1, above = amount;
    if (paint->blend == SLV_BLEND_NORMAL) {
        put_normal(m, amount, texel);
        return;
    }
    if (paint->blend == SLV_BLEND_REPLACE) {
        for (uint32_t c = m->first; c < m->end; c++)
            if (!paint->lock_alpha || (int32_t)c != m->alpha)
                texel[c] += amount * (paint->color[c - m->first] - texel[c]);
        return;
    }
    mix(m, texel, mixed);
    float result = paint->lock_alpha ? below : above + below * (1 - above);
    for (uint32_t c = m->first; c < m->end; c++) {
        if ((int32_t)c == m->alpha)
            continue;
        float color = paint->color[c - m->first];
        if (paint->lock_alpha || below == 1) /* so that what is opaque owes nothing to a quotient */
            texel[c] += above * (mixed[c - m->first] - texel[c]);
        else if (result > 0)
            texel[c] = (above * ((1 - below) * color + below * mixed[c - m->first]) +
                        (1 - above) * below * texel[c]) /
                       result;
    }
    if (m->alpha >= 0)
        texel[m->alpha] = result;
}

void slvi_blend_texels(const slv_canvas_desc *canvas, const slv_paint *paint, const float *coverage,
                       uint64_t count, float *texels) {
    uint32_t n = canvas->nchannels, room = paint->nchannels ? paint->nchannels : SLV_PAINT_CHANNELS;
    room = room < SLV_PAINT_CHANNELS ? room : SLV_PAINT_CHANNELS;
    mixing m = {.paint = paint, .first = paint->first_channel, .alpha = canvas->alpha_channel};
    m.end = n - m.first < room ? n : m.first + room;
    m.colours = m.end - m.first;
    if (m.alpha >= (int32_t)m.first && m.alpha < (int32_t)m.end)
        m.colours--;
    for (uint64_t i = 0; i < count; i++, texels += n) {
        float amount = coverage[i] * paint->opacity;
        if (!(amount > 0))
            continue;
        if (paint->erase)
            erase(&m, amount, texels);
        else
            put(&m, amount, texels);
    }
}

void slvi_blend_layer(const slv_canvas_desc *canvas, slv_blend blend, float opacity,
                      const float *above, const float *mask, uint64_t count, float *texels) {
    uint32_t n = canvas->nchannels;
    slv_paint paint = {.opacity = 1, .blend = blend};
    mixing m = {&paint, 0, n, canvas->alpha_channel, n - 1};
    for (uint64_t i = 0; i < count; i++, texels += n, above += n) {
        float amount = opacity * (mask ? mask[i] : 1) * above[canvas->alpha_channel];
        if (!(amount > 0))
            continue;
        memcpy(paint.color, above, n * sizeof *above);
        put(&m, amount < 1 ? amount : 1, texels);
    }
}
