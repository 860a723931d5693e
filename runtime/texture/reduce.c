/* The arithmetic of reductions, for every type of texel. */
#include "texture/reduce.h"

#include <selvage/half.h>

#include <string.h>

static float float_from_u8(uint8_t x) {
    return (float)x;
}
static float float_from_u16(uint16_t x) {
    return (float)x;
}
static float float_from_float(float x) {
    return x;
}

/* Truncation is the format's rule. The bounds are reached only by averages whose alpha was rounded
 * away. */
static uint8_t u8_from_float(float x) {
    return x > 0.0f ? x < 255.0f ? (uint8_t)x : 255 : 0;
}
static uint16_t u16_from_float(float x) {
    return x > 0.0f ? x < 65535.0f ? (uint16_t)x : 65535 : 0;
}

#define INTEGER_MEAN2(a, b, T, GET, PUT) (T)(((unsigned)(a) + (b)) >> 1)
#define INTEGER_MEAN4(a, b, c, d, T, GET, PUT) (T)(((unsigned)(a) + (b) + (c) + (d)) >> 2)
#define REAL_MEAN2(a, b, T, GET, PUT) PUT(0.5f * (GET(a) + GET(b)))
#define REAL_MEAN4(a, b, c, d, T, GET, PUT) PUT(0.25f * (((GET(a) + GET(b)) + GET(c)) + GET(d)))

/* The functions for one texel type T, with conversions GET and PUT and a largest value ONE. */
#define DEFINE_TYPE(NAME, T, GET, PUT, MEAN2, MEAN4, ONE)                                          \
    static void halve_u_##NAME(size_t n, size_t w, size_t h, const T *in, T *out) {                \
        for (size_t i = 0; i < w / 2 * h; i++, in += 2 * n, out += n)                              \
            for (size_t c = 0; c < n; c++)                                                         \
                out[c] = MEAN2(in[c], in[n + c], T, GET, PUT);                                     \
    }                                                                                              \
    static void halve_v_##NAME(size_t n, size_t w, size_t h, const T *in, T *out) {                \
        for (size_t y = 0; y < h / 2; y++, in += 2 * w * n, out += w * n)                          \
            for (size_t i = 0; i < w * n; i++)                                                     \
                out[i] = MEAN2(in[i], in[w * n + i], T, GET, PUT);                                 \
    }                                                                                              \
    static void halve_both_##NAME(size_t n, size_t w, size_t h, const T *in, T *out) {             \
        for (size_t y = 0; y < h / 2; y++, in += w * n)                                            \
            for (size_t x = 0; x < w / 2; x++, in += 2 * n, out += n)                              \
                for (size_t c = 0; c < n; c++)                                                     \
                    out[c] =                                                                       \
                        MEAN4(in[c], in[n + c], in[w * n + c], in[w * n + n + c], T, GET, PUT);    \
    }                                                                                              \
    static void halve_triangle_##NAME(size_t n, size_t w, size_t h, const T *in,                   \
                                      const T *mirrored, T *out, size_t pitch) {                   \
        for (size_t y = 0; y < h / 2; y++, out += (pitch - w / 2) * n)                             \
            for (size_t x = 0; x < w / 2; x++, out += n) {                                         \
                const T *even = in + (2 * y * w + 2 * x) * n;                                      \
                const T *odd = mirrored + ((w - 1 - 2 * x) * h + (h - 1 - 2 * y)) * n;             \
                for (size_t c = 0; c < n; c++)                                                     \
                    out[c] = MEAN4(even[c], even[n + c], even[w * n + c], odd[c], T, GET, PUT);    \
            }                                                                                      \
    }                                                                                              \
    static void average_##NAME(size_t n, const T *in, uint64_t count, T *out) {                    \
        for (size_t c = 0; c < n; c++) {                                                           \
            float sum = 0.0f;                                                                      \
            for (uint64_t i = 0; i < count; i++)                                                   \
                sum += GET(in[i * n + c]);                                                         \
            out[c] = PUT(sum * (1.0f / (float)count));                                             \
        }                                                                                          \
    }                                                                                              \
    static void scale_##NAME(size_t n, size_t alpha, bool divide, T *texels, uint64_t count) {     \
        size_t first = alpha ? 0 : 1, end = alpha ? alpha : n;                                     \
        for (T *texel = texels; count; count--, texel += n) {                                      \
            float a = GET(texel[alpha]);                                                           \
            if (divide && a == 0.0f)                                                               \
                continue;                                                                          \
            float factor = divide ? ONE / a : a * (1.0f / ONE);                                    \
            for (size_t c = first; c < end; c++)                                                   \
                texel[c] = PUT(GET(texel[c]) * factor);                                            \
        }                                                                                          \
    }

DEFINE_TYPE(u8, uint8_t, float_from_u8, u8_from_float, INTEGER_MEAN2, INTEGER_MEAN4, 255.0f)
DEFINE_TYPE(u16, uint16_t, float_from_u16, u16_from_float, INTEGER_MEAN2, INTEGER_MEAN4, 65535.0f)
DEFINE_TYPE(half, uint16_t, slv_half_to_float, slv_half_from_float, REAL_MEAN2, REAL_MEAN4, 1.0f)
DEFINE_TYPE(float, float, float_from_float, float_from_float, REAL_MEAN2, REAL_MEAN4, 1.0f)

#define SELECT(type, FUNCTION, ...)                                                                \
    switch (type) {                                                                                \
    case SLV_TYPE_U8:                                                                              \
        FUNCTION##_u8(__VA_ARGS__);                                                                \
        break;                                                                                     \
    case SLV_TYPE_U16:                                                                             \
        FUNCTION##_u16(__VA_ARGS__);                                                               \
        break;                                                                                     \
    case SLV_TYPE_HALF:                                                                            \
        FUNCTION##_half(__VA_ARGS__);                                                              \
        break;                                                                                     \
    case SLV_TYPE_FLOAT:                                                                           \
        FUNCTION##_float(__VA_ARGS__);                                                             \
        break;                                                                                     \
    }

void slvi_halve(slv_type type, uint32_t nchannels, slv_halving along, size_t width, size_t height,
                const void *texels, void *out) {
    switch (along) {
    case SLV_HALVE_U:
        SELECT(type, halve_u, nchannels, width, height, texels, out)
        break;
    case SLV_HALVE_V:
        SELECT(type, halve_v, nchannels, width, height, texels, out)
        break;
    case SLV_HALVE_BOTH:
        SELECT(type, halve_both, nchannels, width, height, texels, out)
        break;
    }
}

void slvi_halve_triangle(slv_type type, uint32_t nchannels, size_t width, size_t height,
                         const void *texels, const void *mirrored, void *out, size_t pitch) {
    SELECT(type, halve_triangle, nchannels, width, height, texels, mirrored, out, pitch)
}

void slvi_average(slv_type type, uint32_t nchannels, const void *texels, uint64_t count,
                  void *out) {
    SELECT(type, average, nchannels, texels, count, out)
}

void slvi_multiply_alpha(slv_type type, uint32_t nchannels, int32_t alpha, bool divide,
                         void *texels, uint64_t count) {
    if (alpha < 0 || (uint32_t)alpha >= nchannels)
        return;
    SELECT(type, scale, nchannels, (size_t)alpha, divide, texels, count)
}

void slvi_fill_texels(void *out, const void *texel, size_t size, uint64_t count) {
    uint8_t *to = out;
    size_t total = size * (size_t)count, done = size;
    memmove(to, texel, size);
    while (done < total) {
        size_t next = done < total - done ? done : total - done;
        memcpy(to + done, to, next);
        done += next;
    }
}

bool slvi_texels_equal(const void *texels, size_t size, uint64_t count) {
    const uint8_t *bytes = texels;
    /* the array equals itself shifted by one texel */
    return count < 2 || memcmp(bytes, bytes + size, size * (size_t)(count - 1)) == 0;
}
