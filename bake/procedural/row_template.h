/* The means of a pattern's value over a row of texels; compiled once for each kind of processor, by
 * its name SLVI_VARIANT_NAME and the LANES that its vectors have. */
#include "procedural/row.h"

#include <math.h>
#include <string.h>

#define ALWAYS static inline __attribute__((always_inline))
#define JOIN(NAME, KIND) PASTE(NAME, KIND)
#define PASTE(NAME, KIND) NAME##_##KIND

typedef float floats __attribute__((vector_size(4 * LANES)));
typedef int32_t ints __attribute__((vector_size(4 * LANES)));
typedef uint32_t bits __attribute__((vector_size(4 * LANES)));

ALWAYS floats to_floats(ints x) {
    return __builtin_convertvector(x, floats);
}

/* ---- one octave ---- */

ALWAYS ints split_all(floats x, floats *fraction) {
    const floats size = (floats)((ints)x & INT32_MAX);
    x = (floats)((ints)x & (size < SLVI_PATTERN_FAR));
    ints whole = __builtin_convertvector(x, ints);
    whole += to_floats(whole) > x;
    *fraction = x - to_floats(whole);
    return whole;
}

ALWAYS bits scramble(bits h) {
    return SLVI_SCRAMBLE(h);
}

/* A coordinate of a gradient as SLVI_GRADIENT_BITS of its hash, from bit `first` on. */
ALWAYS floats slope(bits hash, int first) {
    return to_floats((ints)(hash & SLVI_GRADIENT_BITS << first));
}

/* What lies between two corners of a cell along its first axis. */
ALWAYS floats between(bits x, bits yz, const floats f[3], floats y, floats z, floats w) {
    const bits left = scramble(x ^ yz), right = scramble((x + SLVI_PATTERN_STEP) ^ yz);
    const floats low = slope(left, 0) * f[0] + slope(left, 10) * y + slope(left, 20) * z,
                 high =
                     slope(right, 0) * (f[0] - 1.0f) + slope(right, 10) * y + slope(right, 20) * z;
    return SLVI_MIX(low, high, w);
}

ALWAYS floats gradient_noise(const floats p[3], uint32_t lattice) {
    floats f[3], w[3];
    bits c[3];
    for (int i = 0; i < 3; i++) {
        c[i] = (bits)split_all(p[i], &f[i]);
        w[i] = SLVI_FADE(f[i]);
    }
    c[0] *= SLVI_PATTERN_STEP;
    const bits near = c[1] + scramble(c[2] + lattice), far = c[1] + scramble(c[2] + (lattice + 1));
    const floats y = f[1] * SLVI_UNIT(10), above = (f[1] - 1.0f) * SLVI_UNIT(10),
                 z = f[2] * SLVI_UNIT(20), behind = (f[2] - 1.0f) * SLVI_UNIT(20);
    const floats a = between(c[0], scramble(near), f, y, z, w[0]),
                 b = between(c[0], scramble(near + 1), f, above, z, w[0]);
    const floats nearer = SLVI_MIX(a, b, w[1]);
    const floats d = between(c[0], scramble(far), f, y, behind, w[0]),
                 e = between(c[0], scramble(far + 1), f, above, behind, w[0]);
    const floats farther = SLVI_MIX(d, e, w[1]);
    return SLVI_GRADIENT_SUM(SLVI_MIX(nearer, farther, w[2]), f, w);
}

static void find_noise(const slvi_octave *octave, slvi_row_places places, uint32_t count,
                       float *out) {
    for (uint32_t i = 0; i < count; i += LANES) {
        floats p[3];
        for (int axis = 0; axis < 3; axis++) {
            memcpy(&p[axis], places[axis] + i, sizeof *p);
            p[axis] = p[axis] * octave->scale + octave->offset[axis];
        }
        const floats noise = gradient_noise(p, octave->lattice);
        memcpy(out + i, &noise, sizeof noise);
    }
}

/* ---- samples of texels ---- */

static void find_samples(slvi_pattern_rows *rows, unsigned lower, uint32_t width, float u, float v,
                         slvi_row_places out) {
    for (int axis = 0; axis < 3; axis++) {
        const float *low = rows->corners[lower][axis], *high = rows->corners[!lower][axis];
        float *to = out[axis];
        for (uint32_t i = 0; i < width; i++) {
            const float below = SLVI_MIX(low[i], low[i + 1], u),
                        above = SLVI_MIX(high[i], high[i + 1], u);
            to[i] = SLVI_MIX(below, above, v);
        }
        for (uint32_t i = width; i < width + SLVI_ROW_AT_ONCE; i++)
            to[i] = to[width - 1];
    }
}

static void find_grid(slvi_pattern_rows *rows, unsigned lower, uint32_t width) {
    for (int k = 0; k < 4; k++)
        find_samples(rows, lower, width, k & 1 ? 0.75f : 0.25f, k & 2 ? 0.75f : 0.25f,
                     rows->grid[k]);
}

/* ---- stripes and cubes: four samples ---- */

/* floorf of what fits an integer, which the oldest processors do in a row of four. */
ALWAYS float whole_of(float x) {
    const float whole = (float)(int32_t)x;
    return whole > x ? whole - 1.0f : whole;
}

ALWAYS float near(float x) {
    return fabsf(x) < SLVI_PATTERN_FAR ? x : 0.0f;
}

static void warp(const slv_procedural *r, const slvi_octave *octaves, slvi_pattern_rows *rows,
                 int sample, uint32_t width) {
    float weights = 0;
    memset(rows->sums, 0, width * sizeof *rows->sums);
    for (uint32_t k = 0; k < r->octaves; k++) {
        slvi_octave octave = octaves[k];
        octave.scale *= SLVI_WARP_FREQUENCY;
        find_noise(&octave, rows->grid[sample], width, rows->noise[0]);
        for (uint32_t i = 0; i < width; i++)
            rows->sums[i] += octave.weight * rows->noise[0][i];
        weights += octave.weight;
    }
    for (uint32_t i = 0; i < width; i++)
        rows->phases[i] += r->warp * SLVI_NOISE_SUM(rows->sums[i], weights);
}

static void stripes_means(const slv_procedural *r, const slvi_octave *octaves,
                          slvi_pattern_rows *rows, uint32_t width) {
    for (int k = 0; k < 4; k++) {
        const float *x = rows->grid[k][0], *y = rows->grid[k][1], *z = rows->grid[k][2];
        for (uint32_t i = 0; i < width; i++)
            rows->phases[i] =
                x[i] * r->direction[0] + y[i] * r->direction[1] + z[i] * r->direction[2];
        if (r->warp != 0.0f)
            warp(r, octaves, rows, k, width);
        for (uint32_t i = 0; i < width; i++) {
            const float phase = near(rows->phases[i]), t = phase - whole_of(phase),
                        light = 1.0f - fabsf(2.0f * t - 1.0f);
            rows->means[i] += 0.25f * SLVI_BAND(light);
        }
    }
}

ALWAYS int32_t cell(float x) {
    return (int32_t)whole_of(near(x));
}

static void checker_means(slvi_pattern_rows *rows, uint32_t width) {
    for (int k = 0; k < 4; k++) {
        const float *x = rows->grid[k][0], *y = rows->grid[k][1], *z = rows->grid[k][2];
        for (uint32_t i = 0; i < width; i++)
            rows->means[i] += (cell(x[i]) ^ cell(y[i]) ^ cell(z[i])) & 1 ? 0.25f : 0.0f;
    }
}

/* ---- noise ---- */

/* Up to so large a mean square of a texel's two sides, in an octave's cells, the middle of the
 * texel stands for it; then the middle and the corners, which are exact for cubics; then four
 * samples. Larger ones are further from the mean by these than by nothing, which is the mean of all
 * (docs/bake.md has how far each is). */
static const float one = 1.0f / 256, five = 0.25f, four = 5.76f;

/* All texels' sizes, and what they lie between. */
static void find_sizes(slvi_pattern_rows *rows, unsigned lower, uint32_t width, float extent[2]) {
    memset(rows->sizes, 0, width * sizeof *rows->sizes);
    for (int axis = 0; axis < 3; axis++) {
        const float *low = rows->corners[lower][axis], *high = rows->corners[!lower][axis];
        for (uint32_t i = 0; i < width; i++) {
            const float rise = high[i + 1] - low[i], fall = high[i] - low[i + 1];
            rows->sizes[i] += 0.25f * (rise * rise + fall * fall);
        }
    }
    extent[0] = INFINITY;
    extent[1] = 0;
    for (uint32_t i = 0; i < width; i++) {
        extent[0] = rows->sizes[i] < extent[0] ? rows->sizes[i] : extent[0];
        extent[1] = rows->sizes[i] > extent[1] ? rows->sizes[i] : extent[1];
    }
}

/* Found once for the texels above and those below. */
static const float *noise_of_corners(const slvi_octave *octave, uint32_t number,
                                     slvi_pattern_rows *rows, unsigned which, uint32_t width) {
    float *noise = rows->corner_noise[number][which];
    if (!rows->has_noise[number][which])
        find_noise(octave, rows->corners[which], width + 1, noise);
    rows->has_noise[number][which] = true;
    return noise;
}

/* To rows->noise[0] what an octave is in each texel. */
static void octave_means(const slvi_octave *octave, uint32_t number, slvi_pattern_rows *rows,
                         unsigned lower, uint32_t width, const float extent[2]) {
    const float unit = octave->scale * octave->scale, least = extent[0] * unit,
                most = extent[1] * unit;
    float *out = rows->noise[0];
    const float *size = rows->sizes;
    if (least <= five)
        find_noise(octave, rows->middle, width, out);
    if (most > one && least <= five) {
        const float *low = noise_of_corners(octave, number, rows, lower, width),
                    *high = noise_of_corners(octave, number, rows, !lower, width);
        for (uint32_t i = 0; i < width; i++) {
            const float corners = (low[i] + low[i + 1]) + (high[i] + high[i + 1]),
                        mean = out[i] * (2.0f / 3) + corners * (1.0f / 12);
            out[i] = size[i] * unit > one ? mean : out[i];
        }
    }
    if (most > five && least <= four) {
        find_grid(rows, lower, width);
        for (int k = 0; k < 4; k++)
            find_noise(octave, rows->grid[k], width, rows->noise[1 + k]);
        for (uint32_t i = 0; i < width; i++) {
            const float mean = 0.25f * ((rows->noise[1][i] + rows->noise[2][i]) +
                                        (rows->noise[3][i] + rows->noise[4][i]));
            out[i] = size[i] * unit > five ? mean : out[i];
        }
    }
    for (uint32_t i = 0; i < width; i++)
        out[i] = size[i] * unit <= four ? out[i] : 0.0f;
}

static void noise_means(const slv_procedural *r, const slvi_octave *octaves,
                        slvi_pattern_rows *rows, unsigned lower, uint32_t width) {
    float extent[2], weights = 0;
    find_sizes(rows, lower, width, extent);
    find_samples(rows, lower, width, 0.5f, 0.5f, rows->middle);
    for (uint32_t k = 0; k < r->octaves; k++) {
        octave_means(&octaves[k], k, rows, lower, width, extent);
        for (uint32_t i = 0; i < width; i++)
            rows->means[i] += octaves[k].weight * rows->noise[0][i];
        weights += octaves[k].weight;
    }
    for (uint32_t i = 0; i < width; i++)
        rows->means[i] = 0.5f + 0.5f * SLVI_NOISE_SUM(rows->means[i], weights);
}

void JOIN(slvi_pattern_means,
          SLVI_VARIANT_NAME)(const slv_procedural *resolved, const slvi_octave *octaves,
                             slvi_pattern_rows *rows, unsigned lower, uint32_t width) {
    memset(rows->means, 0, width * sizeof *rows->means);
    if (resolved->pattern == SLV_PATTERN_NOISE) {
        noise_means(resolved, octaves, rows, lower, width);
        return;
    }
    find_grid(rows, lower, width);
    if (resolved->pattern == SLV_PATTERN_STRIPES)
        stripes_means(resolved, octaves, rows, width);
    else
        checker_means(rows, width);
}
