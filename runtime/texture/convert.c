/* Values of the four types as floats, and back. */
#include "base/half.h"
#include "base/names.h"

#include <selvage/texture.h>

#include <string.h>

size_t slv_type_size(slv_type type) {
    switch (type) {
    case SLV_TYPE_U8:
        return 1;
    case SLV_TYPE_U16:
    case SLV_TYPE_HALF:
        return 2;
    case SLV_TYPE_FLOAT:
        return 4;
    }
    return 0;
}

static const char *const types[] = {"uint8", "uint16", "half", "float"};

const char *slv_type_name(slv_type type) {
    return slvi_name_of(types, SLVI_COUNT(types), (int)type);
}

bool slv_type_from_name(const char *name, slv_type *out) {
    int value = 0;
    bool found = slvi_name_find(types, SLVI_COUNT(types), name, &value);
    if (found)
        *out = (slv_type)value;
    return found;
}

slv_res slv_res_level(slv_res res, uint32_t level) {
    slv_res out = {level < (uint32_t)res.u ? (int8_t)(res.u - (int)level) : 0,
                   level < (uint32_t)res.v ? (int8_t)(res.v - (int)level) : 0};
    return out;
}

slv_res slv_res_even_level(slv_res res, uint32_t level) {
    int side = (res.u > res.v ? res.u : res.v) - (int)level;
    side = side > 0 ? side : 0;
    return (slv_res){res.u < side ? res.u : (int8_t)side, res.v < side ? res.v : (int8_t)side};
}

int slv_res_log2(uint64_t texels) {
    for (int log2 = 0; log2 <= SLV_MAX_LOG2_RES; log2++)
        if (texels == UINT64_C(1) << log2)
            return log2;
    return -1;
}

uint32_t slv_res_level_count(slv_res res) {
    return 1 + (uint32_t)(res.u > res.v ? res.u : res.v);
}

void slv_type_to_float(slv_type type, const void *values, size_t count, float *out) {
    switch (type) {
    case SLV_TYPE_U8: {
        const uint8_t *in = values;
        for (size_t i = 0; i < count; i++)
            out[i] = (float)in[i] / 255.0f;
        break;
    }
    case SLV_TYPE_U16: {
        const uint16_t *in = values;
        for (size_t i = 0; i < count; i++)
            out[i] = (float)in[i] / 65535.0f;
        break;
    }
    case SLV_TYPE_HALF: {
        const uint16_t *in = values;
        for (size_t i = 0; i < count; i++)
            out[i] = slvi_half_to_float(in[i]);
        break;
    }
    case SLV_TYPE_FLOAT:
        memcpy(out, values, count * sizeof *out);
        break;
    }
}

/* NaN fails the first comparison and becomes 0. */
static inline float clamp_to(float value, float one) {
    float scaled = value * one;
    scaled = scaled > 0.0f ? scaled : 0.0f;
    return (scaled < one ? scaled : one) + 0.5f;
}

enum { HALVES = 64 };

/* slvi_half_from_float, many at once where all are zero or as large as most are: from 2^-14 up to
 * what rounds to 65504. */
static void halves_from_float(const float *in, size_t count, uint16_t *out) {
    const uint32_t least = 0x38800000u, end = 0x477ff000u;
    for (size_t first = 0, n; first < count; first += n, in += n, out += n) {
        uint32_t bits[HALVES], others = 0;
        n = count - first < HALVES ? count - first : HALVES;
        memcpy(bits, in, n * sizeof *bits);
        for (size_t i = 0; i < n; i++) {
            uint32_t magnitude = bits[i] & 0x7fffffffu;
            others |= (uint32_t)(magnitude != 0) & (uint32_t)(magnitude - least >= end - least);
        }
        for (size_t i = 0; i < n && others; i++)
            out[i] = slvi_half_from_float(in[i]);
        for (size_t i = 0; i < n && !others; i++) {
            uint32_t magnitude = bits[i] & 0x7fffffffu;
            uint32_t half = ((magnitude - 0x38000000u + 0x1000u) >> 13) | (bits[i] >> 16 & 0x8000u);
            out[i] = (uint16_t)(magnitude ? half : 0);
        }
    }
}

void slv_type_from_float(slv_type type, const float *values, size_t count, void *out) {
    switch (type) {
    case SLV_TYPE_U8: {
        uint8_t *to = out;
        for (size_t i = 0; i < count; i++)
            to[i] = (uint8_t)(int32_t)clamp_to(values[i], 255.0f);
        break;
    }
    case SLV_TYPE_U16: {
        uint16_t *to = out;
        for (size_t i = 0; i < count; i++)
            to[i] = (uint16_t)(int32_t)clamp_to(values[i], 65535.0f);
        break;
    }
    case SLV_TYPE_HALF:
        halves_from_float(values, count, out);
        break;
    case SLV_TYPE_FLOAT:
        memcpy(out, values, count * sizeof *values);
        break;
    }
}
