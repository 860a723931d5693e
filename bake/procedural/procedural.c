/* The patterns themselves: stripes, noise, cubes and colours as functions of face and position. */
#include "procedural/pattern.h"

#include <math.h>
#include <string.h>

static float clamp(float x, float low, float high) {
    return SLVI_CLAMP(x, low, high);
}

static float mix(float a, float b, float t) {
    return SLVI_MIX(a, b, t);
}

static uint32_t scramble(uint32_t h) {
    return SLVI_SCRAMBLE(h);
}

static float unit_from_bits(uint32_t bits) {
    return (float)(bits >> 8) * (1.0f / 16777216.0f);
}

static uint32_t cell(float x, float *fraction) {
    *fraction = 0.0f;
    if (!(fabsf(x) < SLVI_PATTERN_FAR))
        return 0;
    float whole = (float)(int32_t)x;
    if (whole > x)
        whole -= 1.0f;
    *fraction = x - whole;
    return (uint32_t)(int32_t)whole;
}

static float slope(uint32_t hash, int first) {
    return (float)(int32_t)(hash & SLVI_GRADIENT_BITS << first);
}

static float corner(uint32_t x, uint32_t y, uint32_t z, uint32_t seed, float dx, float dy,
                    float dz) {
    uint32_t h = scramble(x * SLVI_PATTERN_STEP ^ scramble(y + scramble(z + seed)));
    return slope(h, 0) * dx + slope(h, 10) * (dy * SLVI_UNIT(10)) +
           slope(h, 20) * (dz * SLVI_UNIT(20));
}

static float gradient_noise(const float p[3], uint32_t seed) {
    float f[3], w[3];
    uint32_t c[3];
    for (int i = 0; i < 3; i++) {
        c[i] = cell(p[i], &f[i]);
        w[i] = SLVI_FADE(f[i]);
    }
    float layer[2];
    for (uint32_t k = 0; k < 2; k++) {
        float row[2];
        for (uint32_t j = 0; j < 2; j++) {
            float dy = f[1] - (float)j, dz = f[2] - (float)k;
            float left = corner(c[0], c[1] + j, c[2] + k, seed, f[0], dy, dz);
            float right = corner(c[0] + 1, c[1] + j, c[2] + k, seed, f[0] - 1.0f, dy, dz);
            row[j] = mix(left, right, w[0]);
        }
        layer[k] = mix(row[0], row[1], w[1]);
    }
    return SLVI_GRADIENT_SUM(mix(layer[0], layer[1], w[2]), f, w);
}

slvi_octave slvi_pattern_octave(uint32_t seed, uint32_t i) {
    slvi_octave octave = {.lattice = scramble(seed * UINT32_C(0x85ebca6b) + i + 1),
                          .scale = (float)(UINT32_C(1) << i),
                          .weight = 1.0f / (float)(UINT32_C(1) << i)};
    for (uint32_t k = 0; k < 3; k++)
        octave.offset[k] = unit_from_bits(scramble(octave.lattice + k + 1));
    return octave;
}

/* -1..1 */
static float fractal_noise(const float p[3], uint32_t octaves, uint32_t seed) {
    float sum = 0.0f, weights = 0.0f;
    for (uint32_t i = 0; i < octaves; i++) {
        const slvi_octave octave = slvi_pattern_octave(seed, i);
        float q[3];
        for (uint32_t k = 0; k < 3; k++)
            q[k] = p[k] * octave.scale + octave.offset[k];
        sum += octave.weight * gradient_noise(q, octave.lattice);
        weights += octave.weight;
    }
    return SLVI_NOISE_SUM(sum, weights);
}

/* Neighbouring ids get hues far apart: steps of the golden ratio around the wheel. */
static void face_color(int32_t face, uint32_t seed, float rgb[3]) {
    uint32_t id = (uint32_t)face;
    float hue = unit_from_bits((id + scramble(seed)) * UINT32_C(0x9e3779b1)) * 6.0f;
    uint32_t h = scramble(id ^ scramble(seed + 1));
    float saturation = 0.40f + 0.30f * unit_from_bits(h);
    float value = 0.70f + 0.25f * unit_from_bits(h << 12);
    static const float centre[3] = {3.0f, 2.0f, 4.0f};
    for (int i = 0; i < 3; i++) {
        float away = fabsf(hue - centre[i]);
        float pure = clamp(i == 0 ? away - 1.0f : 2.0f - away, 0.0f, 1.0f);
        float shown = value * mix(1.0f, pure, saturation);
        rgb[i] = shown * shown; /* about what a display's curve does */
    }
}

static float stripes(const slv_procedural *pattern, const float p[3]) {
    const float *d = pattern->direction;
    float phase = p[0] * d[0] + p[1] * d[1] + p[2] * d[2];
    if (pattern->warp != 0.0f) {
        float q[3];
        for (int i = 0; i < 3; i++)
            q[i] = p[i] * SLVI_WARP_FREQUENCY;
        phase += pattern->warp * fractal_noise(q, pattern->octaves, pattern->seed);
    }
    float t;
    cell(phase, &t);
    return SLVI_BAND(1.0f - fabsf(2.0f * t - 1.0f));
}

static float checker(const float p[3]) {
    float unused;
    return (cell(p[0], &unused) + cell(p[1], &unused) + cell(p[2], &unused)) & 1 ? 1.0f : 0.0f;
}

static void default_color(float color[4], float grey) {
    if (color[0] == 0.0f && color[1] == 0.0f && color[2] == 0.0f && color[3] == 0.0f) {
        color[0] = color[1] = color[2] = grey;
        color[3] = 1.0f;
    }
}

slv_procedural slvi_pattern_resolve(const slv_procedural *pattern) {
    slv_procedural r = *pattern;
    if (r.frequency == 0.0f)
        r.frequency = 1.0f;
    if (!r.octaves)
        r.octaves = 4;
    if (r.octaves > SLVI_MAX_OCTAVES)
        r.octaves = SLVI_MAX_OCTAVES;
    float *d = r.direction;
    float length = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    if (!(length > 0.0f) || !isfinite(length)) {
        d[0] = 0.36f;
        d[1] = 0.80f;
        d[2] = 0.48f;
    } else {
        for (int i = 0; i < 3; i++)
            d[i] /= length;
    }
    default_color(r.color0, 0.0f);
    default_color(r.color1, 1.0f);
    r.face_tint = r.face_tint > 0.0f ? clamp(r.face_tint, 0.0f, 1.0f) : 0.0f;
    return r;
}

static float value_at(const slv_procedural *resolved, const float p[3]) {
    switch (resolved->pattern) {
    case SLV_PATTERN_STRIPES:
        return stripes(resolved, p);
    case SLV_PATTERN_NOISE:
        return 0.5f + 0.5f * fractal_noise(p, resolved->octaves, resolved->seed);
    case SLV_PATTERN_CHECKER:
        return checker(p);
    case SLV_PATTERN_FACE_COLOR:
    case SLV_PATTERN_POSITION:
        break;
    }
    return 0.0f;
}

void slvi_pattern_evaluate(const slv_procedural *resolved, int32_t face, const float position[3],
                           float rgba[4]) {
    float p[3];
    for (int i = 0; i < 3; i++)
        p[i] = slvi_pattern_place(resolved, position[i], i);
    slvi_pattern_color(resolved, face, p, value_at(resolved, p), rgba);
}

void slvi_pattern_color(const slv_procedural *resolved, int32_t face, const float p[3], float value,
                        float rgba[4]) {
    if (resolved->pattern == SLV_PATTERN_FACE_COLOR) {
        face_color(face, resolved->seed, rgba);
        rgba[3] = 1.0f;
        return;
    }
    if (resolved->pattern == SLV_PATTERN_POSITION) {
        memcpy(rgba, p, 3 * sizeof *p);
        rgba[3] = 1.0f;
    }
    if (resolved->pattern != SLV_PATTERN_POSITION)
        for (int i = 0; i < 4; i++)
            rgba[i] = mix(resolved->color0[i], resolved->color1[i], value);
    if (resolved->face_tint > 0.0f) {
        float own[3];
        face_color(face, resolved->seed, own);
        for (int i = 0; i < 3; i++)
            rgba[i] = mix(rgba[i], own[i], resolved->face_tint);
    }
}

void slv_procedural_evaluate(const slv_procedural *pattern, int32_t face, const float position[3],
                             float rgba[4]) {
    slv_procedural resolved = slvi_pattern_resolve(pattern);
    slvi_pattern_evaluate(&resolved, face, position, rgba);
}
