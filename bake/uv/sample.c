/* Pixels are decoded once, in as many forms as there are kinds of them, so that the loop over
 * samples, of which each pixel has several, asks nothing and has all channels in a register. */
#include "uv/sample.h"

#include <math.h>

#define ALWAYS static inline __attribute__((always_inline))

enum storage { BYTES, WORDS, FLOATS };

ALWAYS float value_at(const uv_tile *tile, enum storage storage, const float *table, size_t at) {
    if (storage == BYTES)
        return table[((const uint8_t *)tile->pixels)[at]];
    if (storage == WORDS)
        return table[((const uint16_t *)tile->pixels)[at]];
    return ((const float *)tile->pixels)[at];
}

ALWAYS void decode(const uv_tile *tile, enum storage storage, uint32_t n, size_t at, uint32_t count,
                   uv_pixel *out) {
    const bool has_alpha = n == 2 || n == 4;
    for (uint32_t i = 0; i < count; i++, at += n) {
        float value[4] = {0, 0, 0, 0};
        for (uint32_t c = 0; c < n; c++)
            value[c] = value_at(tile, storage,
                                has_alpha && c == n - 1 ? tile->alphas : tile->colors, at + c);
        /* made at once: one channel after another goes through memory */
        uv_pixel pixel = {value[0], value[1], value[2], value[3]};
        if (n == 4 && tile->straight)
            pixel *= (uv_pixel){value[3], value[3], value[3], 1};
        if (n == 2 && tile->straight)
            pixel *= (uv_pixel){value[1], 1, 1, 1};
        out[i] = pixel;
    }
}

#define CASE(storage, n)                                                                           \
    case (storage)*8 + (n):                                                                        \
        decode(tile, storage, n, at, count, out);                                                  \
        break;
#define CASES(storage) CASE(storage, 1) CASE(storage, 2) CASE(storage, 3) CASE(storage, 4)

void slvi_uv_decode(const uv_tile *tile, uint32_t nchannels, uint32_t x, uint32_t y, uint32_t count,
                    uv_pixel *out) {
    enum storage storage = tile->type == SLV_TYPE_U8      ? BYTES
                           : tile->type == SLV_TYPE_FLOAT ? FLOATS
                                                          : WORDS;
    size_t at = ((size_t)y * tile->width + x) * nchannels;
    switch ((uint32_t)storage * 8 + nchannels) {
        CASES(BYTES)
        CASES(WORDS)
        CASES(FLOATS)
    default:
        break;
    }
}

#define STRAIGHT 1e-9f /* pixels a sample: less is a line along an axis */

/* A line along an axis of the image: what lies between its two rows (or columns) of pixels is found
 * once a pixel, not once a sample. Pixels are `along` apart on the line and `across` between the
 * two. More than 8 parameters, since the compiler is to see both forms by themselves. */
static inline void sum_straight(const uv_pixel *pixels, size_t along, size_t across, float start,
                                float step, float fraction, uint32_t per_texel, uint32_t ntexels,
                                uv_pixel *sums) {
    int32_t held = INT32_MIN;
    uv_pixel low = {0}, high = {0};
    uint32_t k = 0;
    for (uint32_t texel = 0; texel < ntexels; texel++) {
        uv_pixel sum = sums[texel];
        for (uint32_t i = 0; i < per_texel; i++, k++) {
            float x = start + (float)k * step;
            int32_t left = (int32_t)x;
            if (left != held) {
                const uv_pixel *at = pixels + (size_t)left * along;
                low = left == held + 1 ? high : at[0] + (at[across] - at[0]) * fraction;
                high = at[along] + (at[along + across] - at[along]) * fraction;
                held = left;
            }
            sum += low + (high - low) * (x - (float)left);
        }
        sums[texel] = sum;
    }
}

typedef int32_t four_ints __attribute__((vector_size(16)));
typedef float four __attribute__((vector_size(16)));

enum { AT_ONCE = 64 };

/* Where some samples of a line are: the pixel in the upper left of each, and how far beyond it. */
typedef struct places {
    _Alignas(16) int32_t at[AT_ONCE];
    _Alignas(16) float fx[AT_ONCE], fy[AT_ONCE];
} places;

/* Four at a time; those beyond `count` may lie anywhere, and nobody looks there. */
ALWAYS void find_places(const uv_line *line, float row, uint32_t first, uint32_t count,
                        places *out) {
    const four_ints steps = {0, 1, 2, 3};
    for (uint32_t i = 0; i < count; i += 4) {
        const four k = __builtin_convertvector(steps + (int32_t)(first + i), four);
        const four x = line->x + k * line->dx, y = line->y + k * line->dy;
        const four left = __builtin_convertvector(__builtin_convertvector(x, four_ints), four),
                   top = __builtin_convertvector(__builtin_convertvector(y, four_ints), four);
        /* exact: a window has few pixels */
        *(four_ints *)(out->at + i) = __builtin_convertvector(top * row + left, four_ints);
        *(four *)(out->fx + i) = x - left;
        *(four *)(out->fy + i) = y - top;
    }
}

/* Where samples lie is found for many of them before any pixel is read, four at a time. */
static void sum_leaning(const uv_window *window, const uv_line *line, uint32_t per_texel,
                        uint32_t ntexels, uv_pixel *sums) {
    const size_t row = window->width;
    const uint32_t count = per_texel * ntexels;
    places where;
    uint32_t texel = 0, left = per_texel;
    uv_pixel sum = sums[0];
    for (uint32_t first = 0; first < count; first += AT_ONCE) {
        const uint32_t some = count - first < AT_ONCE ? count - first : AT_ONCE;
        find_places(line, (float)row, first, some, &where);
        for (uint32_t i = 0; i < some; i++) {
            const uv_pixel *at = window->pixels + where.at[i];
            uv_pixel upper = at[0] + (at[1] - at[0]) * where.fx[i];
            uv_pixel lower = at[row] + (at[row + 1] - at[row]) * where.fx[i];
            sum += upper + (lower - upper) * where.fy[i];
            if (--left == 0) {
                sums[texel++] = sum;
                sum = texel < ntexels ? sums[texel] : sum;
                left = per_texel;
            }
        }
    }
}

void slvi_uv_sum_line(const uv_window *window, const uv_line *line, uint32_t per_texel,
                      uint32_t ntexels, uv_pixel *sums) {
    size_t row = window->width;
    int32_t column = (int32_t)line->x, level = (int32_t)line->y;
    if (fabsf(line->dy) < STRAIGHT) {
        sum_straight(window->pixels + (size_t)level * row, 1, row, line->x, line->dx,
                     line->y - (float)level, per_texel, ntexels, sums);
        return;
    }
    if (fabsf(line->dx) < STRAIGHT) {
        sum_straight(window->pixels + column, row, 1, line->y, line->dy, line->x - (float)column,
                     per_texel, ntexels, sums);
        return;
    }
    sum_leaning(window, line, per_texel, ntexels, sums);
}
