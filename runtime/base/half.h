/* The conversion of halves within the library, where many are converted (selvage/half.h). */
#ifndef SLV_BASE_HALF_H
#define SLV_BASE_HALF_H

#include <math.h>
#include <stdint.h>
#include <string.h>

static inline float slvi_half_float_of(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Without branches, so that the compiler can do many at once: the scaling by 2^112 moves the
 * exponent's bias and normalises small numbers in one exact multiplication. */
static inline float slvi_half_to_float(uint16_t half) {
    uint32_t magnitude = (uint32_t)(half & 0x7fffu) << 13, sign = (uint32_t)(half & 0x8000u) << 16;
    float scaled = slvi_half_float_of(magnitude) * 0x1p112f;
    uint32_t bits;
    memcpy(&bits, &scaled, sizeof bits);
    return slvi_half_float_of((magnitude >= 0x0f800000u ? magnitude | 0x7f800000u : bits) | sign);
}

static inline uint16_t slvi_half_from_float(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    uint32_t sign = bits >> 16 & 0x8000u, magnitude = bits & 0x7fffffffu;
    if (magnitude == 0)
        return 0;
    if (magnitude >= 0x7f800000u) /* infinity, NaN: keep the top mantissa bits */
        return (uint16_t)(sign | 0x7c00u | (magnitude >> 13 & 0x3ffu));
    if (magnitude < 0x38800000u) /* below 2^-14 */
        return (uint16_t)(sign | (uint32_t)(fabs((double)value) * 0x1p24 + 0.5));
    uint32_t rounded = (magnitude - 0x38000000u + 0x1000u) >> 13;
    return (uint16_t)(sign | (rounded < 0x7c00u ? rounded : 0x7c00u));
}

#endif
