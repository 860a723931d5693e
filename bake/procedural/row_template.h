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

/* Rows lie anywhere; copies would be made in pieces, which processors do not put together. */
typedef floats loose_floats __attribute__((aligned(4), may_alias));

ALWAYS floats load(const float *from) {
    return *(const loose_floats *)from;
}

ALWAYS void store(float *to, floats x) {
    *(loose_floats *)to = x;
}

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

/* Numbers side by side, since each step of one waits for the step before. */
ALWAYS void scramble(bits *h, int count) {
    for (int k = 0; k < count; k++)
        h[k] ^= h[k] >> 16;
    for (int k = 0; k < count; k++)
        h[k] *= UINT32_C(0x7feb352d);
    for (int k = 0; k < count; k++)
        h[k] ^= h[k] >> 15;
    for (int k = 0; k < count; k++)
        h[k] *= UINT32_C(0x846ca68b);
    for (int k = 0; k < count; k++)
        h[k] ^= h[k] >> 16;
}

/* A coordinate of a gradient as SLVI_GRADIENT_BITS of its hash, from bit `first` on. */
ALWAYS floats slope(bits hash, int first) {
    return to_floats((ints)(hash & SLVI_GRADIENT_BITS << first));
}

/* A place in its cell: how far along each axis, from both ends of it, and the weights. */
typedef struct inside {
    floats f[3], x[2], y[2], z[2], w[3];
} inside;

ALWAYS inside find_inside(const floats f[3]) {
    inside at = {.x = {f[0], f[0] - 1.0f},
                 .y = {f[1] * SLVI_UNIT(10), (f[1] - 1.0f) * SLVI_UNIT(10)},
                 .z = {f[2] * SLVI_UNIT(20), (f[2] - 1.0f) * SLVI_UNIT(20)}};
    for (int i = 0; i < 3; i++) {
        at.f[i] = f[i];
        at.w[i] = SLVI_FADE(f[i]);
    }
    return at;
}

/* Of what lies between two corners of a cell along its first axis, the four times. */
ALWAYS floats mix_edges(const inside *at, const floats edges[4]) {
    const floats nearer = SLVI_MIX(edges[0], edges[1], at->w[1]),
                 farther = SLVI_MIX(edges[2], edges[3], at->w[1]);
    return SLVI_GRADIENT_SUM(SLVI_MIX(nearer, farther, at->w[2]), at->f, at->w);
}

ALWAYS floats noise_of_many(const bits cell[3], const floats f[3], uint32_t lattice) {
    floats edges[4];
    bits z[2], yz[4], h[8];
    for (uint32_t k = 0; k < 2; k++)
        z[k] = cell[2] + (lattice + k);
    scramble(z, 2);
    for (uint32_t k = 0; k < 4; k++)
        yz[k] = cell[1] + z[k >> 1] + (k & 1);
    scramble(yz, 4);
    const bits left = cell[0] * SLVI_PATTERN_STEP, right = left + SLVI_PATTERN_STEP;
    for (int k = 0; k < 8; k++)
        h[k] = (k & 1 ? right : left) ^ yz[k >> 1];
    scramble(h, 8);
    const inside at = find_inside(f);
    for (int k = 0; k < 4; k++) {
        const floats low = slope(h[2 * k], 0) * at.x[0] + slope(h[2 * k], 10) * at.y[k & 1] +
                           slope(h[2 * k], 20) * at.z[k >> 1],
                     high = slope(h[2 * k + 1], 0) * at.x[1] +
                            slope(h[2 * k + 1], 10) * at.y[k & 1] +
                            slope(h[2 * k + 1], 20) * at.z[k >> 1];
        edges[k] = SLVI_MIX(low, high, at.w[0]);
    }
    return mix_edges(&at, edges);
}

/* The gradients at the corners of one cell. */
typedef struct gradients {
    uint32_t cell[3];
    float slopes[3][8];
} gradients;

static void find_gradients(const uint32_t cell[3], uint32_t lattice, gradients *out) {
    for (uint32_t k = 0; k < 8; k++) {
        uint32_t z = cell[2] + (lattice + (k >> 2)), yz, h;
        SLVI_SCRAMBLE(z);
        yz = cell[1] + z + (k >> 1 & 1);
        SLVI_SCRAMBLE(yz);
        h = (cell[0] + (k & 1)) * SLVI_PATTERN_STEP ^ yz;
        SLVI_SCRAMBLE(h);
        for (int i = 0; i < 3; i++)
            out->slopes[i][k] = (float)(int32_t)(h & SLVI_GRADIENT_BITS << 10 * i);
    }
    memcpy(out->cell, cell, sizeof out->cell);
}

ALWAYS floats noise_of_one(const gradients *g, const floats f[3]) {
    const inside at = find_inside(f);
    floats edges[4];
    for (int k = 0; k < 4; k++) {
        const floats low = g->slopes[0][2 * k] * at.x[0] + g->slopes[1][2 * k] * at.y[k & 1] +
                           g->slopes[2][2 * k] * at.z[k >> 1],
                     high = g->slopes[0][2 * k + 1] * at.x[1] +
                            g->slopes[1][2 * k + 1] * at.y[k & 1] +
                            g->slopes[2][2 * k + 1] * at.z[k >> 1];
        edges[k] = SLVI_MIX(low, high, at.w[0]);
    }
    return mix_edges(&at, edges);
}

/* Whether all lanes lie in one cell. */
ALWAYS bool is_one_cell(const bits cell[3]) {
    typedef uint64_t pairs __attribute__((vector_size(4 * LANES)));
    const pairs other =
        (pairs)((cell[0] ^ cell[0][0]) | (cell[1] ^ cell[1][0]) | (cell[2] ^ cell[2][0]));
    uint64_t any = 0;
    for (int k = 0; k < LANES / 2; k++)
        any |= other[k];
    return any == 0;
}

/* Cells are hashed once while a row stays in one: of the lower octaves most of the work. */
static void find_noise(const slvi_octave *octave, slvi_row_places places, uint32_t count,
                       float *out) {
    gradients here;
    bool any = false;
    for (uint32_t i = 0; i < count; i += LANES) {
        floats f[3], noise;
        bits cell[3];
        for (int axis = 0; axis < 3; axis++)
            cell[axis] = (bits)split_all(
                load(places[axis] + i) * octave->scale + octave->offset[axis], &f[axis]);
        if (is_one_cell(cell)) {
            const uint32_t first[3] = {cell[0][0], cell[1][0], cell[2][0]};
            if (!any || memcmp(first, here.cell, sizeof first) != 0)
                find_gradients(first, octave->lattice, &here);
            any = true;
            noise = noise_of_one(&here, f);
        } else {
            noise = noise_of_many(cell, f, octave->lattice);
        }
        store(out + i, noise);
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

/* Up to so large a mean square of a texel's two sides, in an octave's cells, the middle of the
 * texel stands for it; then the middle and the corners, which are exact for cubics; then four
 * samples. Larger ones are further from the mean by these than by nothing, which is the mean of all
 * (docs/bake.md has how far each is). Powers of two are no bounds, so that rounding does not choose
 * for texels of such sizes. */
static const float one = 1.0f / 250, five = 0.256f, four = 5.76f;

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

/* ---- stripes and cubes: four samples ---- */

/* Of numbers at corners what lies a quarter of a texel from its middle, all four times. */
ALWAYS void find_quarters(const float *low, const float *high, uint32_t i, floats out[4]) {
    for (int k = 0; k < 4; k += 2) {
        const float v = k ? 0.75f : 0.25f;
        const floats left = SLVI_MIX(load(low + i), load(high + i), v),
                     right = SLVI_MIX(load(low + i + 1), load(high + i + 1), v);
        out[k] = SLVI_MIX(left, right, 0.25f);
        out[k + 1] = SLVI_MIX(left, right, 0.75f);
    }
}

ALWAYS floats choose(ints which, floats yes, floats no) {
    return (floats)(((ints)yes & which) | ((ints)no & ~which));
}

/* To rows->noise[0..3] what noise bends the samples by: of an octave of which texels are small
 * parts of cells, what lies between their corners. */
static void find_bends(const slv_procedural *r, const slvi_octave *octaves, slvi_pattern_rows *rows,
                       unsigned lower, uint32_t width) {
    float extent[2], weights = 0;
    find_sizes(rows, lower, width, extent);
    memset(rows->noise, 0, sizeof rows->noise);
    for (uint32_t k = 0; k < r->octaves; k++) {
        slvi_octave octave = octaves[k];
        octave.scale *= SLVI_WARP_FREQUENCY;
        const float unit = octave.scale * octave.scale, weight = octave.weight;
        const bool some = extent[0] * unit <= one, all = some && extent[1] * unit <= one;
        const float *low = rows->sums, *high = rows->sums;
        if (some) {
            low = noise_of_corners(&octave, k, rows, lower, width);
            high = noise_of_corners(&octave, k, rows, !lower, width);
        }
        if (!all)
            find_grid(rows, lower, width);
        for (int sample = 0; sample < 4 && !all; sample++)
            find_noise(&octave, rows->grid[sample], width, rows->own[sample]);
        for (uint32_t i = 0; i < width; i += LANES) {
            const ints small = load(rows->sizes + i) * unit <= one;
            floats between[4];
            find_quarters(low, high, i, between);
            for (int sample = 0; sample < 4; sample++) {
                const floats noise =
                    all ? between[sample]
                        : choose(small, between[sample], load(rows->own[sample] + i));
                float *to = rows->noise[sample] + i;
                store(to, load(to) + weight * noise);
            }
        }
        weights += weight;
    }
    for (int sample = 0; sample < 4; sample++)
        for (uint32_t i = 0; i < width; i++)
            rows->noise[sample][i] = r->warp * SLVI_NOISE_SUM(rows->noise[sample][i], weights);
}

/* Across stripes; texels' samples lie between those of their corners. */
static void find_phases(const slv_procedural *r, slvi_pattern_rows *rows, unsigned which,
                        uint32_t width) {
    const float *x = rows->corners[which][0], *y = rows->corners[which][1],
                *z = rows->corners[which][2];
    for (uint32_t i = 0; i <= width; i += LANES)
        store(rows->phases[which] + i, load(x + i) * r->direction[0] +
                                           load(y + i) * r->direction[1] +
                                           load(z + i) * r->direction[2]);
}

static void stripes_means(const slv_procedural *r, const slvi_octave *octaves,
                          slvi_pattern_rows *rows, unsigned lower, uint32_t width) {
    const bool bent = r->warp != 0.0f;
    find_phases(r, rows, lower, width);
    find_phases(r, rows, !lower, width);
    if (bent)
        find_bends(r, octaves, rows, lower, width);
    for (uint32_t i = 0; i < width; i += LANES) {
        floats phases[4], sum = {0}, squares = {0};
        find_quarters(rows->phases[lower], rows->phases[!lower], i, phases);
        for (int k = 0; k < 4; k++) {
            floats t;
            split_all(bent ? phases[k] + load(rows->noise[k] + i) : phases[k], &t);
            t = 2.0f * t - 1.0f;
            t = 1.0f - (floats)((ints)t & INT32_MAX);
            t = SLVI_BAND(t);
            sum += t;
            squares += t * t;
        }
        store(rows->means + i, 0.25f * sum);
        store(rows->squares + i, 0.25f * squares);
    }
}

/* floorf of what fits an integer, which the oldest processors do in a row of four. */
ALWAYS float whole_of(float x) {
    const float whole = (float)(int32_t)x;
    return whole > x ? whole - 1.0f : whole;
}

ALWAYS float near(float x) {
    return fabsf(x) < SLVI_PATTERN_FAR ? x : 0.0f;
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
    memcpy(rows->squares, rows->means, width * sizeof *rows->means); /* of nothing but 0 and 1 */
}

/* ---- noise ---- */

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
    for (uint32_t i = 0; i < width; i++) {
        rows->means[i] = 0.5f + 0.5f * SLVI_NOISE_SUM(rows->means[i], weights);
        rows->squares[i] = rows->means[i] * rows->means[i];
    }
}

void JOIN(slvi_pattern_means,
          SLVI_VARIANT_NAME)(const slv_procedural *resolved, const slvi_octave *octaves,
                             slvi_pattern_rows *rows, unsigned lower, uint32_t width) {
    memset(rows->means, 0, width * sizeof *rows->means);
    memset(rows->squares, 0, width * sizeof *rows->squares);
    if (resolved->pattern == SLV_PATTERN_NOISE) {
        noise_means(resolved, octaves, rows, lower, width);
        return;
    }
    if (resolved->pattern == SLV_PATTERN_STRIPES) {
        stripes_means(resolved, octaves, rows, lower, width);
        return;
    }
    find_grid(rows, lower, width);
    checker_means(rows, width);
}
