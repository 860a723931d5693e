/* Sums of bilinear samples of pixels along lines. */
#ifndef SLV_BAKE_UV_LINES_H
#define SLV_BAKE_UV_LINES_H

#include <stdint.h>

/* A pixel's four channels as light, of which the last ones may be unused. */
typedef float uv_pixel __attribute__((vector_size(16)));

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
typedef void slvi_uv_sum_line(const uv_window *window, const uv_line *line, uint32_t per_texel,
                              uint32_t ntexels, uv_pixel *sums);

/* Kinds of processor that this is compiled for, the best first; the same bits by each. */
#ifdef SLV_HAVE_AVX2
#define SLVI_UV_PROCESSORS(LINE) LINE(avx2) LINE(portable)
#else
#define SLVI_UV_PROCESSORS(LINE) LINE(portable)
#endif
#define SLVI_UV_DECLARE(KIND) slvi_uv_sum_line slvi_uv_sum_line_##KIND;
SLVI_UV_PROCESSORS(SLVI_UV_DECLARE)

#endif
