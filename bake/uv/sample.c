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
    bool has_alpha = n == 2 || n == 4;
    for (uint32_t i = 0; i < count; i++, at += n) {
        uv_pixel pixel = {0, 0, 0, 0};
        for (uint32_t c = 0; c < n; c++)
            pixel[c] = value_at(tile, storage,
                                has_alpha && c == n - 1 ? tile->alphas : tile->colors, at + c);
        for (uint32_t c = 0; has_alpha && tile->straight && c + 1 < n; c++)
            pixel[c] *= pixel[n - 1];
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

void slvi_uv_sum_line(const uv_window *window, const uv_line *line, uint32_t per_texel,
                      uint32_t ntexels, uv_pixel *sums) {
    size_t row = window->width;
    uint32_t k = 0;
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
    for (uint32_t texel = 0; texel < ntexels; texel++) {
        uv_pixel sum = sums[texel];
        for (uint32_t i = 0; i < per_texel; i++, k++) {
            float x = line->x + (float)k * line->dx, y = line->y + (float)k * line->dy;
            int32_t left = (int32_t)x, top = (int32_t)y;
            float fx = x - (float)left, fy = y - (float)top;
            const uv_pixel *at = window->pixels + (size_t)top * row + (size_t)left;
            uv_pixel upper = at[0] + (at[1] - at[0]) * fx;
            uv_pixel lower = at[row] + (at[row + 1] - at[row]) * fx;
            sum += upper + (lower - upper) * fy;
        }
        sums[texel] = sum;
    }
}
