/* The patterns themselves: stripes, noise, cubes and colours as functions of face and position. */
#include "procedural/pattern.h"

#include <math.h>
#include <string.h>

#define MAX_OCTAVES 16

/* Brings the fractal sum's usual extremes near -1 and 1; the rare rest is clamped. */
#define NOISE_GAIN 2.5f
#define WARP_FREQUENCY 0.25f

static float clamp(float x, float low, float high) {
    return x < low ? low : x > high ? high : x;
}

static float mix(float a, float b, float t) {
    return a + (b - a) * t;
}

static uint32_t scramble(uint32_t h) {
    h ^= h >> 16;
    h *= UINT32_C(0x7feb352d);
    h ^= h >> 15;
    h *= UINT32_C(0x846ca68b);
    h ^= h >> 16;
    return h;
}

static float unit_from_bits(uint32_t bits) {
    return (float)(bits >> 8) * (1.0f / 16777216.0f);
}

/* floorf of what fits an integer, which the oldest processors do in a row of four. */
static float below(float x) {
    float whole = (float)(int32_t)x;
    return whole > x ? whole - 1.0f : whole;
}

/* Beyond 2^30 a float has no fraction left to speak of, and the conversion could overflow. */
static uint32_t cell(float x, float *fraction) {
    *fraction = 0.0f;
    if (!(fabsf(x) < 1073741824.0f))
        return 0;
    float whole = below(x);
    *fraction = x - whole;
    return (uint32_t)(int32_t)whole;
}

static float fade(float t) {
    return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
}

static float slope(uint32_t x, uint32_t y, uint32_t z, uint32_t seed, float dx, float dy,
                   float dz) {
    uint32_t h = scramble(x * UINT32_C(0x9e3779b1) ^ scramble(y + scramble(z + seed)));
    float gx = (float)(h & 1023) * (2.0f / 1023.0f) - 1.0f;
    float gy = (float)(h >> 10 & 1023) * (2.0f / 1023.0f) - 1.0f;
    float gz = (float)(h >> 20 & 1023) * (2.0f / 1023.0f) - 1.0f;
    return gx * dx + gy * dy + gz * dz;
}

static float gradient_noise(const float p[3], uint32_t seed) {
    float f[3];
    uint32_t c[3];
    for (int i = 0; i < 3; i++)
        c[i] = cell(p[i], &f[i]);
    float wx = fade(f[0]), wy = fade(f[1]), wz = fade(f[2]);
    float layer[2];
    for (uint32_t k = 0; k < 2; k++) {
        float row[2];
        for (uint32_t j = 0; j < 2; j++) {
            float dy = f[1] - (float)j, dz = f[2] - (float)k;
            float left = slope(c[0], c[1] + j, c[2] + k, seed, f[0], dy, dz);
            float right = slope(c[0] + 1, c[1] + j, c[2] + k, seed, f[0] - 1.0f, dy, dz);
            row[j] = mix(left, right, wx);
        }
        layer[k] = mix(row[0], row[1], wy);
    }
    return mix(layer[0], layer[1], wz);
}

/* -1..1. Each octave has a lattice of its own: noise vanishes at lattice points, and shared ones
 * would show as a grid. */
static float fractal_noise(const float p[3], uint32_t octaves, uint32_t seed) {
    float sum = 0.0f, weights = 0.0f, weight = 1.0f, scale = 1.0f;
    for (uint32_t i = 0; i < octaves; i++) {
        uint32_t lattice = scramble(seed * UINT32_C(0x85ebca6b) + i + 1);
        float q[3];
        for (uint32_t k = 0; k < 3; k++)
            q[k] = p[k] * scale + unit_from_bits(scramble(lattice + k + 1));
        sum += weight * gradient_noise(q, lattice);
        weights += weight;
        weight *= 0.5f;
        scale *= 2.0f;
    }
    return clamp(sum / weights * NOISE_GAIN, -1.0f, 1.0f);
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

/* From the dark middle of a stripe at 0 to the light one at 1/2 and back. */
static float band(float t) {
    float triangle = 1.0f - fabsf(2.0f * t - 1.0f);
    return triangle * triangle * (3.0f - 2.0f * triangle);
}

static float stripes(const slv_procedural *pattern, const float p[3]) {
    const float *d = pattern->direction;
    float phase = p[0] * d[0] + p[1] * d[1] + p[2] * d[2];
    if (pattern->warp != 0.0f) {
        float q[3];
        for (int i = 0; i < 3; i++)
            q[i] = p[i] * WARP_FREQUENCY;
        phase += pattern->warp * fractal_noise(q, pattern->octaves, pattern->seed);
    }
    float t;
    cell(phase, &t);
    return band(t);
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
    if (r.octaves > MAX_OCTAVES)
        r.octaves = MAX_OCTAVES;
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

static void place(const slv_procedural *resolved, const float position[3], float p[3]) {
    for (int i = 0; i < 3; i++)
        p[i] = (position[i] - resolved->offset[i]) * resolved->frequency;
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

/* Plain stripes without a branch, for compilers that take several at a time: value for value what
 * `stripes` makes. */
static void plain_stripes(const slv_procedural *r, size_t count, float *const at[3], float *out) {
    const float *x = at[0], *y = at[1], *z = at[2], *d = r->direction, *o = r->offset;
    for (size_t i = 0; i < count; i++) {
        float phase = (x[i] - o[0]) * r->frequency * d[0] + (y[i] - o[1]) * r->frequency * d[1] +
                      (z[i] - o[2]) * r->frequency * d[2];
        bool good = fabsf(phase) < 1073741824.0f;
        float safe = good ? phase : 0.0f;
        out[i] = band(safe - below(safe));
    }
}

void slvi_pattern_values(const slv_procedural *resolved, size_t count, float *const at[3],
                         float *out) {
    if (resolved->pattern == SLV_PATTERN_STRIPES && resolved->warp == 0.0f) {
        plain_stripes(resolved, count, at, out);
        return;
    }
    for (size_t i = 0; i < count; i++) {
        float position[3] = {at[0][i], at[1][i], at[2][i]}, p[3];
        place(resolved, position, p);
        out[i] = value_at(resolved, p);
    }
}

void slvi_pattern_evaluate(const slv_procedural *resolved, int32_t face, const float position[3],
                           float rgba[4]) {
    float p[3];
    place(resolved, position, p);
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
