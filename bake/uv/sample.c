/* Pixels are decoded once, in as many forms as there are kinds of them, so that the loop over
 * samples, of which each pixel has several, asks nothing and has all channels in a register. */
#include "uv/sample.h"

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
