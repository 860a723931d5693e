/* Paint and layers go into texels: one formula for all blend modes that mixes by alpha. */
#include "canvas/blend.h"

#include "base/blend.h"

#include <math.h>
#include <string.h>

/* The channels that are painted, as they are for all texels. */
typedef struct mixing {
    const slv_paint *paint;
    uint32_t first, end; /* channels */
    int32_t alpha;       /* or -1 */
    uint32_t colours;    /* of them without alpha */
    const float *color;  /* of the channels from the first on */
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
        out[c - m->first] = slvi_blend_channel(m->paint->blend, texel[c], m->color[c - m->first]);
    if (m->paint->blend != SLV_BLEND_COLOR || m->colours != 3)
        return;
    for (uint32_t c = m->first; c < m->end; c++)
        if ((int32_t)c != m->alpha) {
            below[n] = texel[c];
            above[n++] = m->color[c - m->first];
        }
    slvi_blend_color(below, above, mixed);
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
        texel[c] += share * (m->color[c - m->first] - texel[c]);
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
                texel[c] += amount * (m->color[c - m->first] - texel[c]);
        return;
    }
    mix(m, texel, mixed);
    float result = paint->lock_alpha ? below : above + below * (1 - above);
    for (uint32_t c = m->first; c < m->end; c++) {
        if ((int32_t)c == m->alpha)
            continue;
        float color = m->color[c - m->first];
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

/* put_normal() of a texel of three colours and alpha, which is what layers of pictures have. */
static inline void put_rgba(float amount, const float *color, float *texel) {
    float below = texel[3], result = amount + below * (1 - amount);
    float share = below == 1 ? amount : result > 0 ? amount / result : 0;
    for (int c = 0; c < 3; c++)
        texel[c] += share * (color[c] - texel[c]);
    texel[3] = result;
}

void slvi_blend_texels(const slv_canvas_desc *canvas, const slv_paint *paint, const float *coverage,
                       const float *colors, uint64_t count, float *texels) {
    uint32_t n = canvas->nchannels, room = paint->nchannels ? paint->nchannels : SLV_PAINT_CHANNELS;
    room = room < SLV_PAINT_CHANNELS ? room : SLV_PAINT_CHANNELS;
    mixing m = {.paint = paint,
                .first = paint->first_channel,
                .alpha = canvas->alpha_channel,
                .color = paint->color};
    m.end = n - m.first < room ? n : m.first + room;
    m.colours = m.end - m.first;
    if (m.alpha >= (int32_t)m.first && m.alpha < (int32_t)m.end)
        m.colours--;
    if (paint->blend == SLV_BLEND_NORMAL && !paint->erase && !paint->lock_alpha && m.alpha == 3 &&
        !m.first && m.end == 4) {
        for (uint64_t i = 0; i < count; i++, texels += n) {
            float amount = coverage[i] * paint->opacity;
            if (amount > 0)
                put_rgba(amount, colors ? colors + i * SLV_PAINT_CHANNELS : paint->color, texels);
        }
        return;
    }
    for (uint64_t i = 0; i < count; i++, texels += n) {
        float amount = coverage[i] * paint->opacity;
        if (!(amount > 0))
            continue;
        if (colors)
            m.color = colors + i * SLV_PAINT_CHANNELS;
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
    mixing m = {&paint, 0, n, canvas->alpha_channel, n - 1, NULL};
    bool rgba = blend == SLV_BLEND_NORMAL && n == 4 && canvas->alpha_channel == 3;
    for (uint64_t i = 0; rgba && i < count; i++, texels += 4, above += 4) {
        float amount = opacity * (mask ? mask[i] : 1) * above[3];
        if (amount > 0)
            put_rgba(amount < 1 ? amount : 1, above, texels);
    }
    for (uint64_t i = 0; !rgba && i < count; i++, texels += n, above += n) {
        float amount = opacity * (mask ? mask[i] : 1) * above[canvas->alpha_channel];
        if (!(amount > 0))
            continue;
        m.color = above;
        put(&m, amount < 1 ? amount : 1, texels);
    }
}
