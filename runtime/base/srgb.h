/* The sRGB curve (IEC 61966-2-1). */
#ifndef SLV_BASE_SRGB_H
#define SLV_BASE_SRGB_H

#include <math.h>

static inline float slvi_srgb_from_linear(float x) {
    return x <= 0.0031308f ? 12.92f * x : 1.055f * powf(x, 1.0f / 2.4f) - 0.055f;
}

static inline float slvi_srgb_to_linear(float x) {
    return x <= 0.04045f ? x / 12.92f : powf((x + 0.055f) / 1.055f, 2.4f);
}

#endif
