/* Pixels of tiles as light, and sums of bilinear samples of them along lines. */
#ifndef SLV_BAKE_UV_SAMPLE_H
#define SLV_BAKE_UV_SAMPLE_H

#include "uv/tiles.h"

/* A pixel's four channels, of which the last ones may be unused. */
typedef float uv_pixel __attribute__((vector_size(16)));

/* `count` pixels of a row from (x, y) on, light, multiplied by alpha. */
void slvi_uv_decode(const uv_tile *tile, uint32_t nchannels, uint32_t x, uint32_t y, uint32_t count,
                    uv_pixel *out);

/* Decoded pixels. */
typedef struct uv_window {
    const uv_pixel *pixels;
    uint32_t width;
} uv_window;

/* Samples number k of a line lie at (x + k dx, y + k dy), in pixels from the middle of the window's
 * first one, the upper left. */
typedef struct uv_line {
    float x, y, dx, dy;
} uv_line;

/* Adds to each of `ntexels` sums `per_texel` samples of the line, one texel's after another's. All
 * lie so that the four pixels around each are in the window. */
void slvi_uv_sum_line(const uv_window *window, const uv_line *line, uint32_t per_texel,
                      uint32_t ntexels, uv_pixel *sums);

#endif
