/* Vectors of eight floats, in the compiler's own syntax: what the processor has is chosen by
 * compiling the files that include this more than once. */
#ifndef SLV_FILTER_VECTOR_H
#define SLV_FILTER_VECTOR_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#if defined(__AVX2__)
#include <immintrin.h>
#elif defined(__SSE2__)
#include <emmintrin.h>
#endif

typedef float v4f __attribute__((vector_size(16)));
typedef int32_t v4i __attribute__((vector_size(16)));
typedef uint32_t v4u32 __attribute__((vector_size(16)));
typedef float v8f __attribute__((vector_size(32)));
typedef int32_t v8i __attribute__((vector_size(32)));
typedef uint8_t v8u8 __attribute__((vector_size(8)));
typedef uint16_t v8u16 __attribute__((vector_size(16)));
typedef uint32_t v8u32 __attribute__((vector_size(32)));

static inline __attribute__((always_inline)) v8f v8_splat(float x) {
    return (v8f){x, x, x, x, x, x, x, x};
}

static inline __attribute__((always_inline)) v8f v8_join(v4f low, v4f high) {
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}

/* Four times a, four times b: compilers make it in memory otherwise, and wait for that. */
static inline __attribute__((always_inline)) v8f v8_fours(float a, float b) {
    return v8_join((v4f){a, a, a, a}, (v4f){b, b, b, b});
}

/* Whatever in the upper half: code for four lanes takes no more steps than that. */
static inline __attribute__((always_inline)) v8f v8_widen(v4f low) {
    return __builtin_shufflevector(low, low, 0, 1, 2, 3, -1, -1, -1, -1);
}

static inline __attribute__((always_inline)) v4f v8_low(v8f x) {
    return __builtin_shufflevector(x, x, 0, 1, 2, 3);
}

static inline __attribute__((always_inline)) v4f v8_high(v8f x) {
    return __builtin_shufflevector(x, x, 4, 5, 6, 7);
}

static inline __attribute__((always_inline)) v8f v8_select(v8i mask, v8f yes, v8f no) {
    return (v8f)(((v8i)yes & mask) | ((v8i)no & ~mask));
}

static inline __attribute__((always_inline)) v8i v8_select_int(v8i mask, v8i yes, v8i no) {
    return (yes & mask) | (no & ~mask);
}

/* Whether all lanes of a comparison are true. */
static inline __attribute__((always_inline)) bool v8_all(v8i mask) {
#if defined(__AVX2__)
    return _mm256_movemask_ps((__m256)mask) == 0xff;
#else
    typedef int64_t v4i64 __attribute__((vector_size(32)));
    v4i64 x = (v4i64)mask;
    return (x[0] & x[1] & x[2] & x[3]) == -1;
#endif
}

static inline __attribute__((always_inline)) bool v8_none(v8i mask) {
#if defined(__AVX2__)
    return _mm256_movemask_ps((__m256)mask) == 0;
#else
    typedef int64_t v4i64 __attribute__((vector_size(32)));
    v4i64 x = (v4i64)mask;
    return (x[0] | x[1] | x[2] | x[3]) == 0;
#endif
}

/* Whether the first two lanes are negative. */
static inline __attribute__((always_inline)) bool v8_first_two_negative(v8i x) {
#if defined(__AVX2__)
    return (_mm_movemask_ps(_mm256_castps256_ps128((__m256)x)) & 3) == 3;
#else
    return (x[0] & x[1]) < 0;
#endif
}

static inline __attribute__((always_inline)) int v8_least(v8i x) {
    v4i a = __builtin_shufflevector(x, x, 0, 1, 2, 3),
        b = __builtin_shufflevector(x, x, 4, 5, 6, 7);
    v4i less = a < b, c = (a & less) | (b & ~less);
    int d = c[0] < c[1] ? c[0] : c[1], e = c[2] < c[3] ? c[2] : c[3];
    return d < e ? d : e;
}

static inline __attribute__((always_inline)) int v8_most(v8i x) {
    return ~v8_least(~x);
}

static inline __attribute__((always_inline)) v8f v8_abs(v8f x) {
    return (v8f)((v8i)x & 0x7fffffff);
}

/* 2^x for -127 < x < 128 */
static inline __attribute__((always_inline)) v8f v8_power_of_two(v8i x) {
    return (v8f)((x + 127) << 23);
}

/* Towards zero, as a C conversion; lanes that do not fit an int have some value. */
static inline __attribute__((always_inline)) v8i v8_to_int(v8f x) {
#if defined(__AVX2__)
    return (v8i)_mm256_cvttps_epi32((__m256)x);
#elif defined(__SSE2__)
    union {
        v8f all;
        __m128 half[2];
    } from = {x};
    union {
        v8i all;
        __m128i half[2];
    } to;
    to.half[0] = _mm_cvttps_epi32(from.half[0]);
    to.half[1] = _mm_cvttps_epi32(from.half[1]);
    return to.all;
#else
    return __builtin_convertvector(x, v8i);
#endif
}

static inline __attribute__((always_inline)) v8f v8_to_float(v8i x) {
#if defined(__AVX2__)
    return (v8f)_mm256_cvtepi32_ps((__m256i)x);
#elif defined(__SSE2__)
    union {
        v8i all;
        __m128i half[2];
    } from = {x};
    union {
        v8f all;
        __m128 half[2];
    } to;
    to.half[0] = _mm_cvtepi32_ps(from.half[0]);
    to.half[1] = _mm_cvtepi32_ps(from.half[1]);
    return to.all;
#else
    return __builtin_convertvector(x, v8f);
#endif
}

/* Within each half: two lanes of either vector by turns, ... */
static inline __attribute__((always_inline)) v8f v8_low_pairs(v8f x, v8f y) {
    return __builtin_shufflevector(x, y, 0, 8, 1, 9, 4, 12, 5, 13);
}

static inline __attribute__((always_inline)) v8f v8_high_pairs(v8f x, v8f y) {
    return __builtin_shufflevector(x, y, 2, 10, 3, 11, 6, 14, 7, 15);
}

/* ... two lanes of the one before two of the other; */
static inline __attribute__((always_inline)) v8f v8_low_fours(v8f x, v8f y) {
    return __builtin_shufflevector(x, y, 0, 1, 8, 9, 4, 5, 12, 13);
}

static inline __attribute__((always_inline)) v8f v8_high_fours(v8f x, v8f y) {
    return __builtin_shufflevector(x, y, 2, 3, 10, 11, 6, 7, 14, 15);
}

/* one half of either. */
static inline __attribute__((always_inline)) v8f v8_low_half(v8f x, v8f y) {
    return __builtin_shufflevector(x, y, 0, 1, 2, 3, 8, 9, 10, 11);
}

static inline __attribute__((always_inline)) v8f v8_high_half(v8f x, v8f y) {
    return __builtin_shufflevector(x, y, 4, 5, 6, 7, 12, 13, 14, 15);
}

/* The first four lanes, and four from `at` <= 4 on. */
static inline __attribute__((always_inline)) v8f v8_two_fours(v8f x, int at) {
#if defined(__AVX2__)
    const v8i each = {0, 1, 2, 3, 0, 1, 2, 3}, second = {0, 0, 0, 0, -1, -1, -1, -1};
    return (v8f)_mm256_permutevar8x32_ps((__m256)x, (__m256i)(each + (second & at)));
#else
    float lanes[8];
    v4f from;
    memcpy(lanes, &x, sizeof lanes);
    memcpy(&from, lanes + at, sizeof from);
    return v8_join(v8_low(x), from);
#endif
}

static inline __attribute__((always_inline)) v8f v8_reverse(v8f x) {
    return __builtin_shufflevector(x, x, 7, 6, 5, 4, 3, 2, 1, 0);
}

static inline __attribute__((always_inline)) v8i v8_floor(v8f x) {
    v8i i = v8_to_int(x);
    return i + (v8_to_float(i) > x);
}

static inline __attribute__((always_inline)) v8i v8_ceil(v8f x) {
    v8i i = v8_to_int(x);
    return i - (v8_to_float(i) < x);
}

static inline __attribute__((always_inline)) v8f v8_min(v8f x, v8f y) {
#if defined(__AVX2__)
    return (v8f)_mm256_min_ps((__m256)x, (__m256)y);
#else
    return v8_select(x < y, x, y);
#endif
}

static inline __attribute__((always_inline)) v8f v8_max(v8f x, v8f y) {
#if defined(__AVX2__)
    return (v8f)_mm256_max_ps((__m256)x, (__m256)y);
#else
    return v8_select(x > y, x, y);
#endif
}

/* 2^x for -126 < x < 127, to 2e-7: the exponent put in, and for the fraction in -0.5..0.5 the
 * polynomial that is right at the Chebyshev points. */
static inline __attribute__((always_inline)) v8f v8_exp2(v8f x) {
    v8f shifted = x + 12582912.0f; /* 1.5 * 2^23: rounds to an integer */
    v8f f = x - (shifted - 12582912.0f), f2 = f * f;
    v8f low = 0.693147182f * f + 1.00000012f, middle = 0.0555035695f * f + 0.240221068f;
    v8f high = 0.00133908633f * f + 0.00967603177f;
    v8f y = (high * f2 + middle) * f2 + low;
    return (v8f)((v8u32)y + ((v8u32)shifted << 23));
}

static inline __attribute__((always_inline)) float v8_sum(v8f x) {
    v4f low = {x[0], x[1], x[2], x[3]}, high = {x[4], x[5], x[6], x[7]};
    low += high;
    return (low[0] + low[2]) + (low[1] + low[3]);
}

/* Eight texel values as floats. Compilers take the plain conversion apart value by value. */
static inline __attribute__((always_inline)) v8f v8_load_u8(const uint8_t *p) {
#if defined(__AVX2__)
    __m128i x = _mm_loadl_epi64((const __m128i *)(const void *)p);
    return (v8f)_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(x));
#elif defined(__SSE2__)
    __m128i zero = _mm_setzero_si128();
    __m128i x = _mm_unpacklo_epi8(_mm_loadl_epi64((const __m128i *)(const void *)p), zero);
    return v8_join((v4f)_mm_cvtepi32_ps(_mm_unpacklo_epi16(x, zero)),
                   (v4f)_mm_cvtepi32_ps(_mm_unpackhi_epi16(x, zero)));
#else
    v8u8 x;
    memcpy(&x, p, sizeof x);
    return __builtin_convertvector(__builtin_convertvector(x, v8i), v8f);
#endif
}

static inline __attribute__((always_inline)) v8f v8_load_u16(const uint16_t *p) {
#if defined(__AVX2__)
    __m128i x = _mm_loadu_si128((const __m128i *)(const void *)p);
    return (v8f)_mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(x));
#elif defined(__SSE2__)
    __m128i zero = _mm_setzero_si128(), x = _mm_loadu_si128((const __m128i *)(const void *)p);
    return v8_join((v4f)_mm_cvtepi32_ps(_mm_unpacklo_epi16(x, zero)),
                   (v4f)_mm_cvtepi32_ps(_mm_unpackhi_epi16(x, zero)));
#else
    v8u16 x;
    memcpy(&x, p, sizeof x);
    return __builtin_convertvector(__builtin_convertvector(x, v8i), v8f);
#endif
}

static inline __attribute__((always_inline)) v8f v8_load_half(const uint16_t *p) {
#if defined(__AVX2__) && defined(__F16C__)
    return (v8f)_mm256_cvtph_ps(_mm_loadu_si128((const __m128i *)(const void *)p));
#else
    v8u16 x;
    memcpy(&x, p, sizeof x);
    v8u32 h = __builtin_convertvector(x, v8u32);
    /* the exponent is put right by a product, which treats denormals well; infinity and NaN are
     * then made anew */
    v8u32 magnitude = (h & 0x7fff) << 13;
    v8f f = (v8f)magnitude * 5.192296858534828e33f; /* 2^112 */
    v8i huge = (v8i)(magnitude >= 0x7c00u << 13);
    v8u32 bits = (v8u32)f | ((v8u32)huge & 0x7f800000u);
    return (v8f)(bits | (h & 0x8000) << 16);
#endif
}

static inline __attribute__((always_inline)) v8f v8_load_float(const float *p) {
    v8f x;
    memcpy(&x, p, sizeof x);
    return x;
}

#endif
