/* What the colours of a texture stand for, and copies in which they are light. */
#include "base/log.h"
#include "base/memory.h"
#include "base/names.h"
#include "base/srgb.h"
#include "texture/reduce.h"
#include "texture/texture_data.h"
#include "texture/texture_map.h"

#include <selvage/half.h>

static const char *const encodings[] = {"auto", "linear", "srgb", "data"};

const char *slv_texture_encoding_name(slv_texture_encoding encoding) {
    return slvi_name_of(encodings, SLVI_COUNT(encodings), (int)encoding);
}

bool slv_texture_encoding_from_name(const char *name, slv_texture_encoding *out) {
    int value = 0;
    bool found = slvi_name_find(encodings, SLVI_COUNT(encodings), name, &value);
    if (found)
        *out = (slv_texture_encoding)value;
    return found;
}

slv_texture_encoding slv_type_encoding(slv_type type) {
    return type == SLV_TYPE_U8 || type == SLV_TYPE_U16 ? SLV_TEXTURE_SRGB : SLV_TEXTURE_LINEAR;
}

slv_texture_encoding slv_texture_get_encoding(const slv_texture *texture,
                                              slv_texture_encoding wanted) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    if (wanted != SLV_TEXTURE_AUTO)
        return wanted;
    return desc->encoding != SLV_TEXTURE_AUTO ? desc->encoding : slv_type_encoding(desc->type);
}

void slv_texels_decode(uint32_t nchannels, int32_t alpha, float *values, uint64_t count) {
    for (uint64_t i = 0; i < count; i++, values += nchannels)
        for (uint32_t c = 0; c < nchannels; c++)
            if ((int32_t)c != alpha)
                values[c] = slvi_srgb_to_linear(values[c]);
}

void slv_texels_encode(uint32_t nchannels, int32_t alpha, float *values, uint64_t count) {
    for (uint64_t i = 0; i < count; i++, values += nchannels)
        for (uint32_t c = 0; c < nchannels; c++)
            if ((int32_t)c != alpha)
                values[c] = slvi_srgb_from_linear(values[c]);
}

struct decoding {
    const slv_texture_desc *from;
    bool curve; /* colours are encoded: else numbers become floats, no more */
    const uint16_t *u8;
    uint16_t plain[256]; /* the numbers alone, where that is so */
};

/* slvi_srgb_to_linear(i / 255) as halves: a brush changes few texels at a time. */
static const uint16_t light_of_bytes[256] = {
    0x0000, 0x0cf9, 0x10f9, 0x1376, 0x14f9, 0x1637, 0x1776, 0x185a, 0x18f9, 0x1998, 0x1a37, 0x1adb,
    0x1b88, 0x1c1f, 0x1c7f, 0x1ce4, 0x1d4e, 0x1dbd, 0x1e32, 0x1eab, 0x1f2a, 0x1fae, 0x201c, 0x2063,
    0x20ad, 0x20fa, 0x214a, 0x219d, 0x21f2, 0x224a, 0x22a6, 0x2304, 0x2365, 0x23c9, 0x2418, 0x244d,
    0x2484, 0x24bc, 0x24f6, 0x2532, 0x256f, 0x25ad, 0x25ed, 0x262f, 0x2673, 0x26b8, 0x26ff, 0x2747,
    0x2791, 0x27dd, 0x2815, 0x283d, 0x2865, 0x288f, 0x28b9, 0x28e4, 0x2910, 0x293d, 0x296a, 0x2999,
    0x29c9, 0x29f9, 0x2a2a, 0x2a5d, 0x2a90, 0x2ac4, 0x2af9, 0x2b2f, 0x2b66, 0x2b9e, 0x2bd7, 0x2c08,
    0x2c26, 0x2c44, 0x2c62, 0x2c81, 0x2ca0, 0x2cc0, 0x2ce0, 0x2d01, 0x2d22, 0x2d44, 0x2d66, 0x2d89,
    0x2dad, 0x2dd0, 0x2df5, 0x2e1a, 0x2e3f, 0x2e65, 0x2e8b, 0x2eb2, 0x2ed9, 0x2f01, 0x2f2a, 0x2f53,
    0x2f7c, 0x2fa7, 0x2fd1, 0x2ffc, 0x3014, 0x302a, 0x3040, 0x3057, 0x306e, 0x3085, 0x309d, 0x30b4,
    0x30cc, 0x30e5, 0x30fd, 0x3116, 0x312f, 0x3149, 0x3162, 0x317c, 0x3197, 0x31b1, 0x31cc, 0x31e7,
    0x3203, 0x321e, 0x323a, 0x3257, 0x3273, 0x3290, 0x32ad, 0x32cb, 0x32e8, 0x3306, 0x3325, 0x3343,
    0x3362, 0x3381, 0x33a1, 0x33c1, 0x33e1, 0x3401, 0x3411, 0x3422, 0x3432, 0x3443, 0x3454, 0x3465,
    0x3476, 0x3488, 0x3499, 0x34ab, 0x34bd, 0x34cf, 0x34e1, 0x34f4, 0x3506, 0x3519, 0x352c, 0x353f,
    0x3552, 0x3565, 0x3578, 0x358c, 0x35a0, 0x35b4, 0x35c8, 0x35dc, 0x35f1, 0x3605, 0x361a, 0x362f,
    0x3644, 0x3659, 0x366f, 0x3684, 0x369a, 0x36b0, 0x36c6, 0x36dc, 0x36f2, 0x3709, 0x3720, 0x3736,
    0x374d, 0x3765, 0x377c, 0x3794, 0x37ab, 0x37c3, 0x37db, 0x37f3, 0x3806, 0x3812, 0x381f, 0x382b,
    0x3838, 0x3844, 0x3851, 0x385e, 0x386b, 0x3877, 0x3885, 0x3892, 0x389f, 0x38ac, 0x38ba, 0x38c7,
    0x38d5, 0x38e2, 0x38f0, 0x38fe, 0x390c, 0x391a, 0x3928, 0x3936, 0x3944, 0x3953, 0x3961, 0x3970,
    0x397e, 0x398d, 0x399c, 0x39ab, 0x39ba, 0x39c9, 0x39d8, 0x39e7, 0x39f7, 0x3a06, 0x3a16, 0x3a25,
    0x3a35, 0x3a45, 0x3a55, 0x3a65, 0x3a75, 0x3a85, 0x3a95, 0x3aa5, 0x3ab6, 0x3ac6, 0x3ad7, 0x3ae8,
    0x3af9, 0x3b09, 0x3b1a, 0x3b2c, 0x3b3d, 0x3b4e, 0x3b5f, 0x3b71, 0x3b82, 0x3b94, 0x3ba6, 0x3bb8,
    0x3bca, 0x3bdc, 0x3bee, 0x3c00};

static void begin_decoding(const slv_texture_desc *from, bool curve, struct decoding *d) {
    d->from = from;
    d->curve = curve;
    d->u8 = curve ? light_of_bytes : d->plain;
    for (uint32_t i = 0; !curve && i < 256; i++)
        d->plain[i] = slv_half_from_float((float)i / 255);
}

static void decode_bytes(const struct decoding *d, const uint8_t *from, uint64_t count,
                         uint16_t *to) {
    if (d->from->alpha_channel < 0) {
        for (uint64_t i = 0; i < count * d->from->nchannels; i++)
            to[i] = d->u8[from[i]];
        return;
    }
    for (uint64_t i = 0; i < count; i++)
        for (uint32_t c = 0; c < d->from->nchannels; c++, from++)
            *to++ = (int32_t)c == d->from->alpha_channel ? slv_half_from_float((float)*from / 255)
                                                         : d->u8[*from];
}

static void decode_texels(const void *user, const void *from, uint64_t count, void *to) {
    const struct decoding *d = user;
    const slv_texture_desc *desc = d->from;
    if (desc->type == SLV_TYPE_U8) {
        decode_bytes(d, from, count, to);
    } else {
        slv_type_to_float(desc->type, from, count * desc->nchannels, to);
        if (d->curve)
            slv_texels_decode(desc->nchannels, desc->alpha_channel, to, count);
    }
}

struct decode_rect {
    struct decoding decoding;
    slv_rect rect;
    const unsigned char *from; /* its first texel */
    bool constant;
    size_t pitch, size, to_size;
};

static void decode_rect(void *user, void *texels, size_t pitch) {
    const struct decode_rect *job = user;
    unsigned char *to = texels;
    for (uint32_t y = 0; y < job->rect.height; y++, to += pitch * job->to_size) {
        const unsigned char *from = job->from + (job->constant ? 0 : y * job->pitch * job->size);
        decode_texels(&job->decoding, from, job->constant ? 1 : job->rect.width, to);
        if (job->constant)
            slvi_fill_texels(to, to, job->to_size, job->rect.width);
    }
}

slv_result slv_texture_decode_rect(const slv_env *env, const slv_texture *texture, uint32_t face,
                                   slv_rect rect, slv_texture *decoded) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture),
                           *to_desc = slv_texture_get_desc(decoded);
    if (face >= desc->nfaces || !slvi_rect_is_within(rect, desc->res[face]))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "decoding: face %u has no such texels", face);
    slv_res old = to_desc->res[face], res = desc->res[face];
    bool resized = old.u != res.u || old.v != res.v;
    struct decode_rect job = {.rect = rect,
                              .constant = slv_texture_is_constant(texture, face),
                              .pitch = (size_t)1 << res.u,
                              .size = desc->nchannels * slv_type_size(desc->type),
                              .to_size = to_desc->nchannels * slv_type_size(to_desc->type)};
    begin_decoding(desc, to_desc->encoding != SLV_TEXTURE_DATA, &job.decoding);
    if (!resized && !job.constant) {
        job.from = (const unsigned char *)slv_texture_texels(texture, face) +
                   (rect.y * job.pitch + rect.x) * job.size;
        return slv_texture_fill_rect(decoded, face, rect, decode_rect, &job);
    }
    float few[16];
    void *texels = NULL;
    job.from = slv_texture_texels(texture, face);
    if (!resized && job.to_size <= sizeof few) {
        decode_texels(&job.decoding, job.from, 1, few);
        return slv_texture_set_constant(decoded, face, few);
    }
    job.rect = resized ? (slv_rect){0, 0, 1u << res.u, 1u << res.v} : (slv_rect){0, 0, 1, 1};
    slv_result result = slvi_alloc_plain(
        env, "decoded texels", (uint64_t)job.rect.width * job.rect.height, job.to_size, &texels);
    if (result)
        return result;
    decode_rect(&job, texels, job.rect.width);
    result = resized ? slv_texture_set_resolution(decoded, face, res, texels)
                     : slv_texture_set_constant(decoded, face, texels);
    slvi_free(texels);
    return result;
}

static slv_result decode(const slv_env *env, const slv_texture *texture, bool curve,
                         slv_texture **out) {
    slv_texture_desc desc = *slv_texture_get_desc(texture);
    struct decoding d;
    begin_decoding(slv_texture_get_desc(texture), curve, &d);
    desc.type = desc.type == SLV_TYPE_U8 ? SLV_TYPE_HALF : SLV_TYPE_FLOAT;
    desc.encoding = curve ? SLV_TEXTURE_LINEAR : SLV_TEXTURE_DATA;
    return slvi_texture_map(env, texture, &desc, decode_texels, &d, out);
}

slv_result slv_texture_decode(const slv_env *env, const slv_texture *texture,
                              slv_texture_encoding wanted, slv_texture **out) {
    slv_env own;
    *out = NULL;
    if (slv_texture_get_encoding(texture, wanted) != SLV_TEXTURE_SRGB)
        return SLV_OK;
    own = slvi_budget_begin(env);
    return slvi_budget_end(&own, decode(&own, texture, true, out));
}

slv_result slv_texture_widen(const slv_env *env, const slv_texture *texture, slv_texture **out) {
    slv_type type = slv_texture_get_desc(texture)->type;
    *out = NULL;
    return type == SLV_TYPE_U8 || type == SLV_TYPE_U16 ? decode(env, texture, false, out) : SLV_OK;
}
