/* Formats of texels, and the conversion of texels to them. */
#include "gl/store/format.h"

#include "base/half.h"
#include "base/log.h"
#include "base/srgb.h"

#include <string.h>

slv_gl_format slvi_gl_format_for(slv_type type, const slv_gl_texture_params *params,
                                 bool coverage) {
    static const GLenum internal[4][3] = {{GL_R8, GL_RG8, GL_RGBA8},
                                          {GL_R16, GL_RG16, GL_RGBA16},
                                          {GL_R16F, GL_RG16F, GL_RGBA16F},
                                          {GL_R32F, GL_RG32F, GL_RGBA32F}};
    static const GLenum data[4] = {GL_UNSIGNED_BYTE, GL_UNSIGNED_SHORT, GL_HALF_FLOAT, GL_FLOAT};
    static const GLenum external[3] = {GL_RED, GL_RG, GL_RGBA};
    const uint32_t nchannels = params->nchannels;
    const bool own_alpha = slvi_gl_own_alpha(params);
    uint32_t wanted = !own_alpha && coverage ? nchannels + 1 : nchannels;
    uint32_t shape = wanted == 1   ? 0
                     : wanted == 2 ? 1
                                   : 2; /* three-component texels would be padded by the driver */
    slv_gl_format format = {.type = type,
                            .first = params->first_channel,
                            .nsource = nchannels,
                            .ncomponents = shape == 2 ? 4 : shape + 1,
                            .coverage = !own_alpha && (coverage || shape == 2),
                            .own_alpha = own_alpha,
                            .internal = internal[type][shape],
                            .external = external[shape],
                            .data = data[type],
                            .swizzle = {GL_RED, GL_GREEN, GL_BLUE, GL_ALPHA}};
    if (nchannels == 1) {
        format.swizzle[1] = format.swizzle[2] = GL_RED;
        format.swizzle[3] = coverage ? GL_GREEN : GL_ONE;
    } else if (params->grey_alpha) {
        format.swizzle[1] = format.swizzle[2] = GL_RED;
        format.swizzle[3] = GL_GREEN;
    } else if (shape == 1) {
        format.swizzle[2] = GL_ZERO;
        format.swizzle[3] = GL_ONE;
    }
    format.texel_bytes = slv_type_size(type) * format.ncomponents;
    return format;
}

slv_gl_format slvi_gl_format_srgb(const slv_gl *gl, const uint8_t *srgb,
                                  const slv_gl_texture_params *params, bool coverage, bool blocks) {
    static const GLenum internal[] = {0, SLV_GL_SR8, SLV_GL_SRG8, 0, GL_SRGB8_ALPHA8};
    slv_gl_format format = slvi_gl_format_for(SLV_TYPE_U8, params, coverage);
    /* blocks of one or two components know no sRGB; by itself OpenGL knows none of these */
    if (format.ncomponents < 4 && blocks)
        return format;
    /* and of two of them the second would not be spared */
    if (format.ncomponents < 4 && (!gl->narrow_srgb || format.own_alpha))
        return slvi_gl_format_for(SLV_TYPE_HALF, params, coverage);
    format.internal = internal[format.ncomponents];
    format.srgb = srgb;
    return format;
}

void slvi_gl_srgb_fill(uint8_t *srgb) {
    for (uint32_t i = 0; i < SLVI_GL_SRGB; i++)
        srgb[i] = (uint8_t)(255 * slvi_srgb_from_linear(slvi_half_to_float((uint16_t)i)) + 0.5f);
}

/* Alpha, the fourth component, is never encoded. */
static inline void encode_texel(const slv_gl_format *format, uint32_t count, const float *texel,
                                uint8_t *out) {
    for (uint32_t c = 0; c < count; c++) {
        float value = texel[c] > 0 ? texel[c] < 1 ? texel[c] : 1 : 0;
        out[c] = c < 3 ? format->srgb[slvi_half_from_float(value)] : (uint8_t)(255 * value + 0.5f);
    }
}

static void one_of(slv_type type, void *out) {
    static const uint16_t one16 = 0xffff, one_half = 0x3c00;
    static const float one = 1;
    if (type == SLV_TYPE_U8)
        *(uint8_t *)out = 255;
    else if (type == SLV_TYPE_FLOAT)
        memcpy(out, &one, sizeof one);
    else
        memcpy(out, type == SLV_TYPE_U16 ? &one16 : &one_half, 2);
}

void slvi_gl_convert(const slv_gl_format *format, const void *texels, uint32_t nchannels,
                     size_t count, void *out) {
    size_t size = slv_type_size(format->type), stride = size * nchannels;
    size_t copied = size * format->nsource, last = size * (format->ncomponents - 1);
    const unsigned char *from = (const unsigned char *)texels + size * format->first;
    unsigned char *to = out;
    unsigned char one[4];
    one_of(format->type, one);
    if (!format->coverage && nchannels == format->ncomponents && format->nsource == nchannels) {
        memcpy(out, texels, count * format->texel_bytes);
        return;
    }
    if (format->texel_bytes == 4 &&
        copied == 3) { /* RGB to RGBA in 8 bits: by far the most common */
        for (size_t i = 0; i < count; i++, from += stride, to += 4) {
            to[0] = from[0];
            to[1] = from[1];
            to[2] = from[2];
            to[3] = 255;
        }
        return;
    }
    memset(out, 0, count * format->texel_bytes);
    for (size_t i = 0; i < count; i++, from += stride, to += format->texel_bytes) {
        memcpy(to, from, copied);
        if (format->coverage)
            memcpy(to + last, one, size);
    }
}

/* Above 1 up to infinity is 1; negative ones are black. */
static uint16_t of_unit(uint16_t half) {
    return half <= 0x3c00 ? half : half <= 0x7c00 ? 0x3c00 : 0;
}

void slvi_gl_convert_half(const slv_gl_format *format, const uint16_t *texels, uint32_t nchannels,
                          size_t count, uint8_t *out) {
    uint32_t colours = format->nsource < 3 ? format->nsource : 3;
    if (colours == 3 && format->nsource == 3 && format->coverage) { /* by far the most common */
        for (texels += format->first; count; count--, texels += nchannels, out += 4) {
            for (uint32_t c = 0; c < 3; c++)
                out[c] = format->srgb[of_unit(texels[c])];
            out[3] = 255;
        }
        return;
    }
    for (size_t i = 0; i < count; i++, texels += nchannels, out += format->texel_bytes) {
        const uint16_t *from = texels + format->first;
        memset(out, 0, format->texel_bytes);
        for (uint32_t c = 0; c < colours; c++)
            out[c] = format->srgb[of_unit(from[c])];
        if (format->nsource == 4) {
            float alpha = slvi_half_to_float(from[3]);
            alpha = alpha > 0 ? alpha < 1 ? alpha : 1 : 0;
            out[3] = (uint8_t)(255 * alpha + 0.5f);
        }
        if (format->coverage)
            out[format->texel_bytes - 1] = 255;
    }
}

void slvi_gl_convert_float(const slv_gl_format *format, const float *texels, uint32_t nchannels,
                           size_t count, void *out) {
    size_t size = slv_type_size(format->type), last = size * (format->ncomponents - 1);
    unsigned char *to = out;
    unsigned char one[4];
    if (format->srgb && format->nsource == 3 && format->coverage) { /* by far the most common */
        for (texels += format->first; count; count--, texels += nchannels, to += 4) {
            encode_texel(format, 3, texels, to);
            to[3] = 255;
        }
        return;
    }
    one_of(format->type, one);
    for (size_t i = 0; i < count; i++, texels += nchannels, to += format->texel_bytes) {
        memset(to, 0, format->texel_bytes);
        if (format->srgb)
            encode_texel(format, format->nsource, texels + format->first, to);
        else
            slv_type_from_float(format->type, texels + format->first, format->nsource, to);
        if (format->coverage)
            memcpy(to + last, one, size);
    }
}

slv_result slvi_gl_format_compress(const slv_gl *gl, const slv_env *env, slv_type type,
                                   slv_gl_format *format) {
    if (type != SLV_TYPE_U8)
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED,
                         "a texture of %s cannot be compressed, only one of uint8",
                         slv_type_name(type));
    if (format->ncomponents == 4 && !gl->s3tc)
        return slvi_fail(env, SLV_ERROR_GL, "the driver lacks GL_EXT_texture_compression_s3tc");
    if (format->ncomponents == 4) {
        format->block = format->nsource == 4 ? SLV_GL_BLOCK_BC3 : SLV_GL_BLOCK_BC1;
        format->internal = format->srgb ? format->nsource == 4 ? SLV_GL_SRGB_BC3 : SLV_GL_SRGB_BC1
                           : format->nsource == 4 ? SLV_GL_RGBA_BC3
                                                  : SLV_GL_RGBA_BC1;
    } else {
        format->block = format->ncomponents == 2 ? SLV_GL_BLOCK_BC5 : SLV_GL_BLOCK_BC4;
        format->internal =
            format->ncomponents == 2 ? GL_COMPRESSED_RG_RGTC2 : GL_COMPRESSED_RED_RGTC1;
    }
    return SLV_OK;
}
