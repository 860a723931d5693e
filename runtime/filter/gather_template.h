/* Template: weighted sums of texels under a kernel, for each type and number of channels. */
#ifndef SLV_FILTER_GATHER_TEMPLATE_H
#define SLV_FILTER_GATHER_TEMPLATE_H

#include "filter/kernel.h"
#include "filter/sampler.h"
#include "filter/vector.h"

#define GATHER_MAX_VECTORS (KERNEL_MAX * 4 / 8)

/* Only the lanes that were summed up are looked at, which compilers do not see. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

/* `count` columns of sums over rows, each of `n` values, times weights that lie `stride` apart. No
 * function, in which compilers would not see how long the sums are, and so not unroll what is
 * short. */
#define GATHER_COLUMN(sums, n, weights, stride, at, out)                                           \
    do {                                                                                           \
        v4f column;                                                                                \
        memcpy(&column, (sums) + (size_t)(at) * (n), sizeof column);                               \
        (out) += column * (weights)[(at) * (stride)];                                              \
    } while (0)
#define GATHER_COLUMNS(sums, n, weights, stride, count, out)                                       \
    do {                                                                                           \
        v4f even = -(v4f){0, 0, 0, 0}, odd = even; /* -0 + x is x, which compilers know */         \
        int at = 0;                                                                                \
        for (; at + 1 < (count); at += 2) {                                                        \
            GATHER_COLUMN(sums, n, weights, stride, at, even);                                     \
            GATHER_COLUMN(sums, n, weights, stride, at + 1, odd);                                  \
        }                                                                                          \
        if (at < (count))                                                                          \
            GATHER_COLUMN(sums, n, weights, stride, at, even);                                     \
        (out) = even + odd;                                                                        \
    } while (0)

/* Sums over rows, weighed: columns of three or four values, two to a vector. */
static inline __attribute__((always_inline)) v4f gather_pairs(const v8f *sums, int nvectors,
                                                              bool three, const kernel_axis *u) {
    v8f both = -(v8f){0, 0, 0, 0, 0, 0, 0, 0};
    int pairs = nvectors - (u->n & 1);
    _Pragma("GCC unroll 9") for (int i = 0; i < nvectors; i++) {
        v8f x = sums[i];
        if (i == pairs)
            break;
        if (three)
            x = __builtin_shufflevector(x, x, 0, 1, 2, 3, 3, 4, 5, 6);
        both += x * v8_fours(u->k[2 * i], u->k[2 * i + 1]);
    }
    v4f even = v8_low(both), odd = v8_high(both);
    if (pairs < nvectors)
        even += v8_low(sums[nvectors - 1]) * u->k[2 * nvectors - 2];
    return even + odd;
}

/* Few channels: rows are added up as they lie in memory, whole vectors of `step` values at a time,
 * and the columns of the sum weighted at the end. Vectors may read beyond a row: texels have
 * padding behind them. Columns that lie across the vectors of a sum that was stored a moment ago
 * would have to wait for it, so that for three channels a vector has two texels. */
#define DEFINE_GATHER_ROWS(TYPE, T)                                                                \
    static inline __attribute__((always_inline)) void gather_rows_##TYPE(                          \
        const T *p, size_t pitch, const kernel_axis *v, size_t step, size_t nvectors, v8f *acc) {  \
        int rows = v->n;                                                                           \
        float weight = v->k[0];                                                                    \
        v8f sums[GATHER_MAX_VECTORS];                                                              \
        _Pragma("GCC unroll 9") for (size_t i = 0; i < nvectors; i++) sums[i] =                    \
            v8_load_##TYPE(p + step * i) * weight;                                                 \
        for (int j = 1; j < rows; j++) {                                                           \
            p += pitch;                                                                            \
            weight = v->k[j];                                                                      \
            _Pragma("GCC unroll 9") for (size_t i = 0; i < nvectors; i++) sums[i] +=               \
                v8_load_##TYPE(p + step * i) * weight;                                             \
        }                                                                                          \
        _Pragma("GCC unroll 9") for (size_t i = 0; i < nvectors; i++) acc[i] = sums[i];            \
    }                                                                                              \
    static inline __attribute__((always_inline)) void gather_rows_few_##TYPE(                      \
        const T *p, size_t pitch, const kernel_axis *v, size_t nvectors, v8f *acc) {               \
        switch (nvectors) {                                                                        \
        case 1:                                                                                    \
            gather_rows_##TYPE(p, pitch, v, 8, 1, acc);                                            \
            break;                                                                                 \
        case 2:                                                                                    \
            gather_rows_##TYPE(p, pitch, v, 8, 2, acc);                                            \
            break;                                                                                 \
        case 3:                                                                                    \
            gather_rows_##TYPE(p, pitch, v, 8, 3, acc);                                            \
            break;                                                                                 \
        case 4:                                                                                    \
            gather_rows_##TYPE(p, pitch, v, 8, 4, acc);                                            \
            break;                                                                                 \
        default:                                                                                   \
            gather_rows_##TYPE(p, pitch, v, 8, nvectors, acc);                                     \
        }                                                                                          \
    }                                                                                              \
    static inline __attribute__((always_inline)) v4f gather_pairs_##TYPE(                          \
        const T *p, size_t pitch, size_t n, size_t nvectors, const kernel *k) {                    \
        v8f sums[GATHER_MAX_VECTORS];                                                              \
        gather_rows_##TYPE(p, pitch, &k->a[1], 2 * n, nvectors, sums);                             \
        return gather_pairs(sums, (int)nvectors, n == 3, &k->a[0]);                                \
    }                                                                                              \
    static inline __attribute__((always_inline))                                                   \
    v4f gather_few_##TYPE(const T *p, size_t pitch, size_t n, const kernel *k) {                   \
        size_t width = (size_t)k->a[0].n;                                                          \
        if (n >= 3)                                                                                \
            switch ((width + 1) / 2) {                                                             \
            case 1:                                                                                \
                return gather_pairs_##TYPE(p, pitch, n, 1, k);                                     \
            case 2:                                                                                \
                return gather_pairs_##TYPE(p, pitch, n, 2, k);                                     \
            case 3:                                                                                \
                return gather_pairs_##TYPE(p, pitch, n, 3, k);                                     \
            case 4:                                                                                \
                return gather_pairs_##TYPE(p, pitch, n, 4, k);                                     \
            default:                                                                               \
                return gather_pairs_##TYPE(p, pitch, n, (width + 1) / 2, k);                       \
            }                                                                                      \
        union {                                                                                    \
            v8f v[GATHER_MAX_VECTORS + 1];                                                         \
            float f[8 * GATHER_MAX_VECTORS + 8];                                                   \
        } acc;                                                                                     \
        gather_rows_few_##TYPE(p, pitch, &k->a[1], (width * n + 7) / 8, acc.v);                    \
        v4f sum;                                                                                   \
        GATHER_COLUMNS(acc.f, n, k->a[0].k, 1, k->a[0].n, sum);                                    \
        return sum;                                                                                \
    }                                                                                              \
    /* Rows `pitch` values apart, added up as far as a group reaches. */                           \
    static void gather_band_##TYPE(const void *texels, size_t pitch, const kernel_axis *v,         \
                                   size_t nvectors, v8f *acc) {                                    \
        const T *p = (const T *)texels + (size_t)v->start * pitch;                                 \
        for (; nvectors > 4; nvectors -= 4, p += 32, acc += 4)                                     \
            gather_rows_##TYPE(p, pitch, v, 8, 4, acc);                                            \
        gather_rows_few_##TYPE(p, pitch, v, nvectors, acc);                                        \
    }                                                                                              \
    /* Any number of channels, of which `count` are wanted. */                                     \
    static inline void gather_many_##TYPE(const T *texels, size_t pitch, size_t n, size_t first,   \
                                          size_t count, const kernel *k, float *sum) {             \
        for (int j = 0; j < k->a[1].n; j++) {                                                      \
            const T *p =                                                                           \
                texels + (size_t)(k->a[1].start + j) * pitch + (size_t)k->a[0].start * n + first;  \
            for (int i = 0; i < k->a[0].n; i++, p += n) {                                          \
                float weight = k->a[0].k[i] * k->a[1].k[j];                                        \
                size_t c = 0;                                                                      \
                for (; c + 8 <= count; c += 8) {                                                   \
                    v8f s;                                                                         \
                    memcpy(&s, sum + c, sizeof s);                                                 \
                    s += v8_load_##TYPE(p + c) * weight;                                           \
                    memcpy(sum + c, &s, sizeof s);                                                 \
                }                                                                                  \
                if (c < count) {                                                                   \
                    v8f s = v8_load_##TYPE(p + c) * weight;                                        \
                    for (int lane = 0; c < count; c++, lane++)                                     \
                        sum[c] += s[lane];                                                         \
                }                                                                                  \
            }                                                                                      \
        }                                                                                          \
    }

DEFINE_GATHER_ROWS(u8, uint8_t)
DEFINE_GATHER_ROWS(u16, uint16_t)
DEFINE_GATHER_ROWS(half, uint16_t)
DEFINE_GATHER_ROWS(float, float)

/* The sum over up to four channels, all of them, of texels in rows `pitch` texels apart, from the
 * first under a kernel on. Not inlined: there is too much of it. */
#define DEFINE_GATHER_CHANNELS(TYPE, T, N)                                                         \
    static __attribute__((noinline))                                                               \
    v4f gather_##TYPE##_##N(const void *texels, size_t pitch, const kernel *k) {                   \
        return gather_few_##TYPE((const T *)texels, N * pitch, N, k);                              \
    }
#define DEFINE_GATHER_FEW(TYPE, T)                                                                 \
    DEFINE_GATHER_CHANNELS(TYPE, T, 1)                                                             \
    DEFINE_GATHER_CHANNELS(TYPE, T, 2)                                                             \
    DEFINE_GATHER_CHANNELS(TYPE, T, 3)                                                             \
    DEFINE_GATHER_CHANNELS(TYPE, T, 4)

DEFINE_GATHER_FEW(u8, uint8_t)
DEFINE_GATHER_FEW(u16, uint16_t)
DEFINE_GATHER_FEW(half, uint16_t)
DEFINE_GATHER_FEW(float, float)

typedef v4f (*gather_function)(const void *texels, size_t pitch, const kernel *k);

/* By type and channels. */
static const gather_function gather_functions[][4] = {
    [SLV_TYPE_U8] = {gather_u8_1, gather_u8_2, gather_u8_3, gather_u8_4},
    [SLV_TYPE_U16] = {gather_u16_1, gather_u16_2, gather_u16_3, gather_u16_4},
    [SLV_TYPE_HALF] = {gather_half_1, gather_half_2, gather_half_3, gather_half_4},
    [SLV_TYPE_FLOAT] = {gather_float_1, gather_float_2, gather_float_3, gather_float_4},
};

/* From the first texel under the kernel on. */
static inline __attribute__((always_inline)) v4f
gather_from(const cache_tables *t, const uint8_t *first, size_t pitch, const kernel *k) {
    return gather_functions[t->type][t->nchannels - 1](first, pitch, k);
}

static inline __attribute__((always_inline)) v4f
gather_few(const cache_tables *t, const uint8_t *texels, size_t pitch, const kernel *k) {
    size_t first = (size_t)k->a[1].start * pitch + (size_t)k->a[0].start;
    return gather_from(t, texels + first * t->pixel_size, pitch, k);
}

typedef void (*gather_band_function)(const void *texels, size_t pitch, const kernel_axis *v,
                                     size_t nvectors, v8f *acc);

static const gather_band_function gather_bands[] = {[SLV_TYPE_U8] = gather_band_u8,
                                                    [SLV_TYPE_U16] = gather_band_u16,
                                                    [SLV_TYPE_HALF] = gather_band_half,
                                                    [SLV_TYPE_FLOAT] = gather_band_float};

/* Eight values from a texel's first on; there is memory behind it. */
static inline __attribute__((always_inline)) v8f gather_load(slv_type type, const uint8_t *texel) {
    const void *p = texel;
    switch (type) {
    case SLV_TYPE_U8:
        return v8_load_u8(p);
    case SLV_TYPE_U16:
        return v8_load_u16(p);
    case SLV_TYPE_HALF:
        return v8_load_half(p);
    default:
        return v8_load_float(p);
    }
}

/* Adds `count` values of a texel, from `first` on, times a weight. */
static inline void gather_add_texel(slv_type type, const uint8_t *texel, size_t first, size_t count,
                                    float weight, float *sum) {
    for (size_t c = 0; c < count; c += 8) {
        size_t left = count - c < 8 ? count - c : 8;
        uint8_t bytes[32] = {0};
        memcpy(bytes, texel + (first + c) * slv_type_size(type), left * slv_type_size(type));
        v8f x = gather_load(type, bytes);
        for (size_t lane = 0; lane < left; lane++)
            sum[c + lane] += x[lane] * weight;
    }
}

/* Adds the mean of a face times a weight. */
static inline void gather_add_average(lookup_state *state, uint32_t face, cache_face *f,
                                      float weight) {
    const uint8_t *texel = lookup_find_average(state, face, f);
    if (texel)
        gather_add_texel(state->tables->type, texel, state->first, state->count, weight,
                         state->sum);
}

/* The sum of texels that lie in rows `pitch` texels apart. */
static inline void gather_sum(const cache_tables *t, const uint8_t *texels, size_t pitch,
                              const kernel *k, size_t first, size_t count, float *sum) {
    size_t n = t->nchannels;
    const void *p = texels;
    if (n <= 4) {
        v4f s = gather_few(t, texels, pitch, k);
        for (size_t c = 0; c < count; c++)
            sum[c] += s[first + c];
        return;
    }
    switch (t->type) {
    case SLV_TYPE_U8:
        gather_many_u8(p, pitch * n, n, first, count, k, sum);
        break;
    case SLV_TYPE_U16:
        gather_many_u16(p, pitch * n, n, first, count, k, sum);
        break;
    case SLV_TYPE_HALF:
        gather_many_half(p, pitch * n, n, first, count, k, sum);
        break;
    default:
        gather_many_float(p, pitch * n, n, first, count, k, sum);
    }
}

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

#endif
