/* A face's texels at another resolution. */
#ifndef SELVAGE_PTX_RESIZE_H
#define SELVAGE_PTX_RESIZE_H

#include <selvage/ptx.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Resamples 2^u * 2^v * nchannels values, each axis by itself: the mean of the texels that a
 * smaller one covers, or linear interpolation between texel centres, the outermost texels reaching
 * to the edge. Triangles are square: smaller ones as the format reduces, larger ones by dividing
 * every texel. With alpha, multiply colours by it first (slv_ptx_premultiply). `out` must not
 * overlap. Thread-safe. */
SLV_NODISCARD SLV_API slv_result slv_ptx_resize(const slv_env *env, slv_ptx_mesh_type mesh_type,
                                                uint32_t nchannels, slv_res from,
                                                const float *values, slv_res to, float *out);

#ifdef __cplusplus
}
#endif

#endif
