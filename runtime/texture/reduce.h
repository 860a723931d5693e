/* The arithmetic of reductions and averages, bit for bit as .ptx files have it. Texels are tightly
 * packed. */
#ifndef SLV_TEXTURE_REDUCE_H
#define SLV_TEXTURE_REDUCE_H

#include <selvage/texture.h>

typedef enum slv_halving { SLV_HALVE_U = 1, SLV_HALVE_V = 2, SLV_HALVE_BOTH = 3 } slv_halving;

/* Means of pairs along one axis, or of 2x2 texels, of an array of any even size along that axis, or
 * both. `out` may be `texels`. */
void slvi_halve(slv_type type, uint32_t nchannels, slv_halving along, size_t width, size_t height,
                const void *texels, void *out);
/* A part of a triangle to the next coarser texels, in rows `pitch` texels apart. `mirrored` is the
 * part that the anti-diagonal of the whole maps it to, of `height` columns and `width` rows: where
 * its odd texels are. Nothing may overlap `out`. */
void slvi_halve_triangle(slv_type type, uint32_t nchannels, size_t width, size_t height,
                         const void *texels, const void *mirrored, void *out, size_t pitch);
/* The mean of `count` texels. */
void slvi_average(slv_type type, uint32_t nchannels, const void *texels, uint64_t count, void *out);
/* Multiplies by alpha, or divides where alpha is not zero, the channels that it covers: those
 * before it, or, if it is channel 0, those behind it. Nothing happens with SLV_NO_ALPHA. */
void slvi_multiply_alpha(slv_type type, uint32_t nchannels, int32_t alpha, bool divide,
                         void *texels, uint64_t count);
/* Fills `out` with `count` copies of a texel of `size` bytes. */
void slvi_fill_texels(void *out, const void *texel, size_t size, uint64_t count);
/* Whether the texels are all bitwise equal. */
bool slvi_texels_equal(const void *texels, size_t size, uint64_t count);

#endif
