/* Light to stored texels. The sRGB curve takes a power for each value, which would be most of the
 * time that a bake takes; bytes go by a table that gives the same. */
#include "recipe/encode.h"

#include <string.h>

static uint8_t slowly(float x) {
    uint8_t byte;
    slv_texels_encode(1, SLV_NO_ALPHA, &x, 1);
    slv_type_from_float(SLV_TYPE_U8, &x, 1, &byte);
    return byte;
}

static float float_of(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

void slvi_encoder_begin(encoder *e, slv_type type, uint32_t nchannels, int32_t alpha, bool srgb) {
    memset(e, 0, sizeof *e);
    e->type = type;
    e->nchannels = nchannels;
    e->alpha = alpha;
    e->srgb = srgb;
    if (type != SLV_TYPE_U8 || !srgb)
        return;
    for (uint32_t byte = 1; byte < 256; byte++) {
        uint32_t low = 0, high = 0x3f800000; /* 0 is less, 1 is not */
        while (high - low > 1) {
            uint32_t middle = low + (high - low) / 2;
            if (slowly(float_of(middle)) >= byte)
                high = middle;
            else
                low = middle;
        }
        e->least[byte] = float_of(high);
    }
    e->least[256] = float_of(0x7f800000);
    uint32_t byte = 0;
    for (uint32_t upper = 0; upper < 32768; upper++) {
        float x = float_of(upper << 16);
        while (byte < 255 && x >= e->least[byte + 1])
            byte++;
        e->guess[upper] = (uint8_t)byte;
    }
}

static uint8_t byte_of(const encoder *e, float x) {
    uint32_t bits;
    if (!(x > 0))
        return 0; /* NaN too */
    memcpy(&bits, &x, sizeof bits);
    uint32_t byte = e->guess[bits >> 16];
    while (x >= e->least[byte + 1] && byte < 255)
        byte++;
    return (uint8_t)byte;
}

void slvi_encoder_run(const encoder *e, float *values, uint64_t count, void *out) {
    uint32_t n = e->nchannels;
    if (e->srgb && e->type == SLV_TYPE_U8) {
        uint8_t *bytes = out;
        for (uint64_t i = 0; i < count * n; i++)
            bytes[i] = byte_of(e, values[i]);
        for (uint64_t i = 0; e->alpha >= 0 && i < count; i++)
            slv_type_from_float(SLV_TYPE_U8, values + i * n + (size_t)e->alpha, 1,
                                bytes + i * n + (size_t)e->alpha);
        return;
    }
    if (e->srgb)
        slv_texels_encode(n, e->alpha, values, count);
    slv_type_from_float(e->type, values, (size_t)(count * n), out);
}

void slvi_encoder_undo(const encoder *e, const void *texels, uint64_t count, float *out) {
    slv_type_to_float(e->type, texels, (size_t)(count * e->nchannels), out);
    if (e->srgb)
        slv_texels_decode(e->nchannels, e->alpha, out, count);
}
