/* One function of what is below and what comes over for each blend mode. */
#ifndef SLV_BASE_BLEND_H
#define SLV_BASE_BLEND_H

#include <selvage/blend.h>

#include <math.h>

/* Of one channel; what takes more than that, or none, is what comes over. */
static inline float slvi_blend_channel(slv_blend blend, float below, float above) {
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
    case SLV_BLEND_SUBTRACT:
        return below - above;
    default:
        return above;
    }
}

static inline float slvi_luminosity(const float *c) {
    return 0.3f * c[0] + 0.59f * c[1] + 0.11f * c[2];
}

/* Three colours of what comes over with the luminosity of what is below; brought back into 0..1 as
 * the specification's ClipColor does, if both were in it. */
static inline void slvi_blend_color(const float *below, const float *above, float *out) {
    float shift = slvi_luminosity(below) - slvi_luminosity(above), low, high,
          l = slvi_luminosity(below);
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

#endif
