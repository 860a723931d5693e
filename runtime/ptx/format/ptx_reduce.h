/* The arithmetic of reductions and averages, bit for bit as .ptx files have it. Texels are tightly
 * packed. */
#ifndef SLV_PTX_REDUCE_H
#define SLV_PTX_REDUCE_H

#include <selvage/ptx.h>

/* Means of pairs along one axis, for resolutions that differ by it alone. `out` may be `texels`. */
void slvi_ptx_halve_u(slv_type type, uint32_t nchannels, slv_res res, const void *texels,
                      void *out);
void slvi_ptx_halve_v(slv_type type, uint32_t nchannels, slv_res res, const void *texels,
                      void *out);
/* Means of 2x2 texels; `out` may be `texels`. */
void slvi_ptx_halve_both(slv_type type, uint32_t nchannels, slv_res res, const void *texels,
                         void *out);
/* 2^log2 x 2^log2 texels of a triangle to the next coarser ones, in rows `pitch` texels apart. For
 * a part of the triangle `mirrored` is the part that the anti-diagonal of the whole maps it to:
 * where its odd texels are. Nothing may overlap `out`. */
void slvi_ptx_halve_triangle(slv_type type, uint32_t nchannels, int log2, const void *texels,
                             const void *mirrored, void *out, size_t pitch);
/* Fills `out` with `count` copies of a texel of `size` bytes. */
void slvi_ptx_fill(void *out, const void *texel, size_t size, uint64_t count);
/* Whether the texels are all bitwise equal. */
bool slvi_ptx_all_equal(const void *texels, size_t size, uint64_t count);

#endif
