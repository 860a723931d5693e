/* A pattern with its defaults filled in, so that a batch resolves them once; what its evaluation at
 * a point and that of eight texels at a time share. */
#ifndef SLV_BAKE_PATTERN_H
#define SLV_BAKE_PATTERN_H

#include <selvage/bake.h>

/* Formulas for numbers and vectors of them. */
#define SLVI_MIX(a, b, t) ((a) + ((b) - (a)) * (t))
#define SLVI_FADE(t) ((t) * (t) * (t) * ((t) * ((t)*6.0f - 15.0f) + 10.0f))
#define SLVI_SCRAMBLE(h)                                                                           \
    ((h) ^= (h) >> 16, (h) *= UINT32_C(0x7feb352d), (h) ^= (h) >> 15, (h) *= UINT32_C(0x846ca68b), \
     (h) ^= (h) >> 16)
/* From the dark middle of a stripe at 0 to the light one at 1 and back. */
#define SLVI_BAND(t) ((t) * (t) * (3.0f - 2.0f * (t)))

#define SLVI_PATTERN_STEP UINT32_C(0x9e3779b1)
/* Three coordinates of a gradient are so many bits of a hash each, as 2/1023 of -1..1: the scale,
 * and the place of the lowest bit, go into what they are multiplied with, and the -1 of all eight
 * corners of a cell come to one sum. */
#define SLVI_GRADIENT_BITS UINT32_C(1023)
#define SLVI_UNIT(first) (1.0f / (float)(UINT32_C(1) << (first)))
#define SLVI_GRADIENT_SUM(sum, f, w)                                                               \
    ((sum) * (2.0f / 1023.0f) - (((f)[0] - (w)[0]) + ((f)[1] - (w)[1]) + ((f)[2] - (w)[2])))
/* From here on a float has no fraction left to speak of, and conversions could overflow. */
#define SLVI_PATTERN_FAR 1073741824.0f
/* Brings a fractal sum's usual extremes near -1 and 1; the rare rest is clamped. */
#define SLVI_NOISE_SUM(sum, weights) SLVI_CLAMP((sum) / (weights)*2.5f, -1.0f, 1.0f)
#define SLVI_CLAMP(x, low, high) ((x) < (low) ? (low) : (x) > (high) ? (high) : (x))
#define SLVI_WARP_FREQUENCY 0.25f

enum { SLVI_MAX_OCTAVES = 16 };

/* Each octave has a lattice of its own: noise vanishes at lattice points, and shared ones would
 * show as a grid. */
typedef struct slvi_octave {
    uint32_t lattice;
    float offset[3], scale, weight;
} slvi_octave;

slvi_octave slvi_pattern_octave(uint32_t seed, uint32_t i);

slv_procedural slvi_pattern_resolve(const slv_procedural *pattern);

/* A position as it enters the pattern, */
static inline float slvi_pattern_place(const slv_procedural *resolved, float position, int axis) {
    return (position - resolved->offset[axis]) * resolved->frequency;
}

/* slv_procedural_evaluate of a resolved pattern. */
void slvi_pattern_evaluate(const slv_procedural *resolved, int32_t face, const float position[3],
                           float rgba[4]);

/* The colour of a value. */
void slvi_pattern_color(const slv_procedural *resolved, int32_t face, const float p[3], float value,
                        float rgba[4]);

#endif
