/* The format's arithmetic, for callers that have texels and no file. */
#include "texture/reduce.h"

#include <selvage/ptx.h>

void slv_ptx_reduce(slv_ptx_mesh_type mesh_type, slv_type type, uint32_t nchannels, slv_res res,
                    const void *texels, void *out) {
    size_t width = (size_t)1 << res.u, height = (size_t)1 << res.v;
    if (mesh_type == SLV_PTX_TRIANGLE)
        slvi_halve_triangle(type, nchannels, width, width, texels, texels, out, width >> 1);
    else
        slvi_halve(type, nchannels, SLV_HALVE_BOTH, width, height, texels, out);
}

void slv_ptx_average(slv_type type, uint32_t nchannels, const void *texels, uint64_t count,
                     void *out) {
    slvi_average(type, nchannels, texels, count, out);
}

void slv_ptx_premultiply(slv_type type, uint32_t nchannels, int32_t alpha, void *texels,
                         uint64_t count) {
    slvi_multiply_alpha(type, nchannels, alpha, false, texels, count);
}

void slv_ptx_unmultiply(slv_type type, uint32_t nchannels, int32_t alpha, void *texels,
                        uint64_t count) {
    slvi_multiply_alpha(type, nchannels, alpha, true, texels, count);
}
