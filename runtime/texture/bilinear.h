/* The one bilinear lookup: which four texels lie around a place, how far it is to each, and their
 * mean. What lookups differ in is where their texels are (centred, with a border, or on the edges)
 * and how they are stored; the arithmetic is this. */
#ifndef SLV_TEXTURE_BILINEAR_H
#define SLV_TEXTURE_BILINEAR_H

#include <selvage/texture.h>

/* The texel at or below a place along both axes, and how far it is from there towards the next. */
typedef struct slvi_bilinear {
    uint32_t x, y;
    float wx, wy;
    bool right, up; /* whether there is a next one */
} slvi_bilinear;

/* A place in texels, clamped to 0..last (NaN becomes 0), taken apart. */
static inline uint32_t slvi_linear_at(float at, uint32_t last, float *weight) {
    float most = (float)last;
    at = at > 0.0f ? at < most ? at : most : 0.0f;
    uint32_t low = (uint32_t)at;
    *weight = at - (float)low;
    return low;
}

static inline slvi_bilinear slvi_bilinear_at(float x, float y, uint32_t last_x, uint32_t last_y) {
    slvi_bilinear at;
    at.x = slvi_linear_at(x, last_x, &at.wx);
    at.y = slvi_linear_at(y, last_y, &at.wy);
    at.right = at.x < last_x;
    at.up = at.y < last_y;
    return at;
}

/* Among texels at their centres, none beyond the outermost ones. */
static inline slvi_bilinear slvi_bilinear_centred(slv_res res, float u, float v) {
    uint32_t width = 1u << res.u, height = 1u << res.v;
    return slvi_bilinear_at(u * (float)width - 0.5f, v * (float)height - 0.5f, width - 1,
                            height - 1);
}

/* Among texels at their centres and one texel of border all around. */
static inline slvi_bilinear slvi_bilinear_bordered(slv_res res, float u, float v) {
    uint32_t width = 1u << res.u, height = 1u << res.v;
    return slvi_bilinear_at(u * (float)width + 0.5f, v * (float)height + 0.5f, width + 1,
                            height + 1);
}

/* Among samples of which the outermost are on the edges. */
static inline slvi_bilinear slvi_bilinear_edge_aligned(slv_res res, float u, float v) {
    uint32_t width = 1u << res.u, height = 1u << res.v;
    return slvi_bilinear_at(u * (float)width, v * (float)height, width, height);
}

/* The part that one of the four has: bit 0 of k is right, bit 1 is up. */
static inline float slvi_bilinear_share(float wx, float wy, int k) {
    return (k & 1 ? wx : 1 - wx) * (k & 2 ? wy : 1 - wy);
}

/* The mean of four texels of n values each: here, right, up, and right of that. Those on the right
 * or up may be NULL where their weight is 0: they are then left out, so that what is there cannot
 * matter even if it is infinite. */
static inline void slvi_bilinear_mix(const slvi_bilinear *at, const float *here, const float *right,
                                     const float *up, const float *up_right, size_t n, float *out) {
    for (size_t c = 0; c < n; c++) {
        float low = right ? here[c] + at->wx * (right[c] - here[c]) : here[c];
        if (up) {
            float high = right ? up[c] + at->wx * (up_right[c] - up[c]) : up[c];
            low = low + at->wy * (high - low);
        }
        out[c] = low;
    }
}

/* In bordered texels of n floats each. */
static inline slvi_bilinear slvi_bilinear_bordered_floats(const float *texels, slv_res res,
                                                          size_t n, float u, float v, float *out) {
    slvi_bilinear at = slvi_bilinear_bordered(res, u, v);
    size_t pitch = (((size_t)1 << res.u) + 2) * n;
    const float *low = texels + at.y * pitch + at.x * n, *high = low + pitch;
    slvi_bilinear_mix(&at, low, low + n, high, high + n, n, out);
    return at;
}

/* In texels of a type: `texel` bytes each, `pitch` bytes from row to row. Reads a block of `count`
 * channels of which `texels` points at the first. */
#define SLVI_BILINEAR_CHANNELS 16
static inline void slvi_bilinear_typed(slv_type type, const void *texels, size_t texel,
                                       size_t pitch, const slvi_bilinear *at, uint32_t count,
                                       float *out) {
    float corner[4][SLVI_BILINEAR_CHANNELS];
    const unsigned char *here = (const unsigned char *)texels + at->y * pitch + at->x * texel;
    size_t right = at->right ? texel : 0, up = at->up ? pitch : 0;
    slv_type_to_float(type, here, count, corner[0]);
    slv_type_to_float(type, here + right, count, corner[1]);
    slv_type_to_float(type, here + up, count, corner[2]);
    slv_type_to_float(type, here + up + right, count, corner[3]);
    slvi_bilinear_mix(at, corner[0], corner[1], corner[2], corner[3], count, out);
}

#endif
