/* Faces at other resolutions. */
#include <selvage/ptx_resize.h>

#include "base/log.h"
#include "base/memory.h"

#include <string.h>

/* `rows` runs of `from` texels of `size` values each become runs of `to` texels. */
static void resize_axis(uint64_t rows, uint64_t from, uint64_t to, uint64_t size, const float *in,
                        float *out) {
    uint64_t step = from > to ? from / to : 1;
    for (uint64_t row = 0; row < rows; row++, in += from * size)
        for (uint64_t i = 0; i < to; i++, out += size) {
            if (from >= to) {
                const float *first = in + i * step * size;
                for (uint64_t c = 0; c < size; c++) {
                    double sum = 0;
                    for (uint64_t k = 0; k < step; k++)
                        sum += (double)first[k * size + c];
                    out[c] = step == 1 ? first[c] : (float)(sum / (double)step);
                }
                continue;
            }
            double at = ((double)i + 0.5) * (double)from / (double)to - 0.5;
            at = at < 0 ? 0 : at > (double)(from - 1) ? (double)(from - 1) : at;
            uint64_t low = (uint64_t)at, high = low + 1 < from ? low + 1 : low;
            float t = (float)(at - (double)low);
            for (uint64_t c = 0; c < size; c++) {
                float a = in[low * size + c], b = in[high * size + c];
                out[c] = t > 0 ? a + (b - a) * t : a;
            }
        }
}

static slv_result resize_quad(const slv_env *env, uint32_t nchannels, slv_res from,
                              const float *values, slv_res to, float *out) {
    uint64_t w = UINT64_C(1) << from.u, h = UINT64_C(1) << from.v, to_w = UINT64_C(1) << to.u,
             to_h = UINT64_C(1) << to.v;
    float *between = NULL;
    slv_result result = slvi_alloc(env, "texels between two sizes", to_w * h,
                                   nchannels * sizeof *between, &between);
    if (result)
        return result;
    resize_axis(h, w, to_w, nchannels, values, between);
    resize_axis(1, h, to_h, to_w * nchannels, between, out);
    slvi_free(between);
    return SLV_OK;
}

/* Which texel of a triangle of `n` texels a side holds the point: an even one lies at (u,v), an odd
 * one, the far half of that cell, at (n-1-v, n-1-u). */
static uint64_t triangle_texel(double u, double v, uint64_t n) {
    uint64_t x = (uint64_t)(u * (double)n), y = (uint64_t)(v * (double)n);
    bool even = u * (double)n - (double)x + v * (double)n - (double)y < 1;
    return even ? y * n + x : (n - 1 - x) * n + (n - 1 - y);
}

static void grow_triangle(uint32_t nchannels, int from, const float *values, int to, float *out) {
    uint64_t n = UINT64_C(1) << from, m = UINT64_C(1) << to;
    for (uint64_t y = 0; y < m; y++)
        for (uint64_t x = 0; x < m; x++) {
            bool even = x + y < m;
            uint64_t u = even ? x : m - 1 - y, v = even ? y : m - 1 - x;
            double centre = even ? 1.0 / 3 : 2.0 / 3;
            uint64_t texel = triangle_texel(((double)u + centre) / (double)m,
                                            ((double)v + centre) / (double)m, n);
            memcpy(out + (y * m + x) * nchannels, values + texel * nchannels,
                   nchannels * sizeof *out);
        }
}

static slv_result shrink_triangle(const slv_env *env, uint32_t nchannels, int from,
                                  const float *values, int to, float *out) {
    float *work[2] = {NULL, NULL};
    const float *source = values;
    slv_result result = SLV_OK;
    for (int i = 0; i < 2 && !result; i++)
        result = slvi_alloc(env, "texels between two sizes", UINT64_C(1) << (2 * (from - 1)),
                            nchannels * sizeof(float), &work[i]);
    for (int log2 = from; log2 > to && !result; log2--) {
        float *target = log2 == to + 1 ? out : work[log2 & 1];
        slv_ptx_reduce(SLV_PTX_TRIANGLE, SLV_TYPE_FLOAT, nchannels,
                       (slv_res){(int8_t)log2, (int8_t)log2}, source, target);
        source = target;
    }
    slvi_free(work[0]);
    slvi_free(work[1]);
    return result;
}

slv_result slv_ptx_resize(const slv_env *env, slv_ptx_mesh_type mesh_type, uint32_t nchannels,
                          slv_res from, const float *values, slv_res to, float *out) {
    bool triangle = mesh_type == SLV_PTX_TRIANGLE;
    const int8_t sides[4] = {from.u, from.v, to.u, to.v};
    for (int i = 0; i < 4; i++)
        if (sides[i] < 0 || sides[i] > SLV_MAX_LOG2_RES)
            return slvi_fail(env, SLV_ERROR_ARGUMENT,
                             "a resolution of 2^%d, where 2^0 to 2^%d is possible", sides[i],
                             SLV_MAX_LOG2_RES);
    if (triangle && (from.u != from.v || to.u != to.v))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "the texels of a triangle are square");
    if (from.u == to.u && from.v == to.v)
        memcpy(out, values, ((size_t)nchannels << (from.u + from.v)) * sizeof *out);
    else if (!triangle)
        return resize_quad(env, nchannels, from, values, to, out);
    else if (to.u > from.u)
        grow_triangle(nchannels, from.u, values, to.u, out);
    else
        return shrink_triangle(env, nchannels, from.u, values, to.u, out);
    return SLV_OK;
}
