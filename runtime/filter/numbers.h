/* Powers of two, whole numbers and comparisons of floats without calls. */
#ifndef SLV_FILTER_NUMBERS_H
#define SLV_FILTER_NUMBERS_H

#include <stdint.h>
#include <string.h>

static inline uint32_t num_bits(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* -floor(log2 w), for normal w */
static inline int num_negative_log2(float w) {
    int32_t bits;
    memcpy(&bits, &w, sizeof bits);
    return 127 - (bits >> 23 & 0xff);
}

/* 2^n, for -126 < n < 128 */
static inline float num_power_of_two(int n) {
    int32_t bits = (n + 127) << 23;
    float f;
    memcpy(&f, &bits, sizeof f);
    return f;
}

/* floorf and ceilf of what fits an int, without a call. */
static inline int num_floor(float x) {
    int i = (int)x;
    return i - ((float)i > x);
}

static inline int num_ceil(float x) {
    int i = (int)x;
    return i + ((float)i < x);
}

/* What the C library does about NaN is not worth a call. */
static inline float num_smaller(float a, float b) {
    return a < b ? a : b;
}

static inline float num_larger(float a, float b) {
    return a > b ? a : b;
}

#endif
