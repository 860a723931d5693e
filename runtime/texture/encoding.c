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
    bool curve;       /* colours are encoded: else numbers become floats, no more */
    uint16_t u8[256]; /* halves */
};

static void begin_decoding(const slv_texture_desc *from, bool curve, struct decoding *d) {
    d->from = from;
    d->curve = curve;
    for (uint32_t i = 0; i < 256; i++)
        d->u8[i] =
            slv_half_from_float(curve ? slvi_srgb_to_linear((float)i / 255) : (float)i / 255);
}

static void decode_bytes(const struct decoding *d, const uint8_t *from, uint64_t count,
                         uint16_t *to) {
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

slv_result slv_texture_decode_rect(const slv_env *env, const slv_texture *texture, uint32_t face,
                                   slv_rect rect, slv_texture *decoded) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture),
                           *to_desc = slv_texture_get_desc(decoded);
    struct decoding d;
    void *texels = NULL;
    if (face >= desc->nfaces || !slvi_rect_is_within(rect, desc->res[face]))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "decoding: face %u has no such texels", face);
    slv_res old = to_desc->res[face], res = desc->res[face];
    bool resized = old.u != res.u || old.v != res.v;
    if (resized)
        rect = (slv_rect){0, 0, 1u << res.u, 1u << res.v};
    bool constant = slv_texture_is_constant(texture, face);
    uint64_t count = constant && !resized ? 1 : (uint64_t)rect.width * rect.height;
    size_t size = desc->nchannels * slv_type_size(desc->type),
           to_size = to_desc->nchannels * slv_type_size(to_desc->type);
    slv_result result = slvi_alloc_plain(env, "decoded texels", count, to_size, &texels);
    if (result)
        return result;
    begin_decoding(desc, to_desc->encoding != SLV_TEXTURE_DATA, &d);
    const unsigned char *from = slv_texture_texels(texture, face);
    unsigned char *to = texels;
    if (constant) {
        decode_texels(&d, from, 1, texels);
        slvi_fill_texels(texels, texels, to_size, count);
    } else {
        from += (((size_t)rect.y << desc->res[face].u) + rect.x) * size;
        for (uint32_t y = 0; y < rect.height; y++, to += rect.width * to_size) {
            decode_texels(&d, from, rect.width, to);
            from += size << desc->res[face].u;
        }
    }
    if (resized)
        result = slv_texture_set_resolution(decoded, face, res, texels);
    else if (constant)
        result = slv_texture_set_constant(decoded, face, texels);
    else
        result = slv_texture_set_rect(decoded, face, rect, texels);
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
