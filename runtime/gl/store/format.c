/* Formats of texels, and the conversion of texels to them. */
#include "gl/store/format.h"

#include "base/log.h"

#include <selvage/half.h>

#include <string.h>

slv_gl_format slvi_gl_format_for(slv_type type, uint32_t first, uint32_t nchannels, bool coverage) {
    static const GLenum internal[4][3] = {{GL_R8, GL_RG8, GL_RGBA8},
                                          {GL_R16, GL_RG16, GL_RGBA16},
                                          {GL_R16F, GL_RG16F, GL_RGBA16F},
                                          {GL_R32F, GL_RG32F, GL_RGBA32F}};
    static const GLenum data[4] = {GL_UNSIGNED_BYTE, GL_UNSIGNED_SHORT, GL_HALF_FLOAT, GL_FLOAT};
    static const GLenum external[3] = {GL_RED, GL_RG, GL_RGBA};
    uint32_t wanted = nchannels < 4 && coverage ? nchannels + 1 : nchannels;
    uint32_t shape = wanted == 1   ? 0
                     : wanted == 2 ? 1
                                   : 2; /* three-component texels would be padded by the driver */
    slv_gl_format format = {.type = type,
                            .first = first,
                            .nsource = nchannels,
                            .ncomponents = shape == 2 ? 4 : shape + 1,
                            .coverage = nchannels < 4 && (coverage || shape == 2),
                            .internal = internal[type][shape],
                            .external = external[shape],
                            .data = data[type],
                            .swizzle = {GL_RED, GL_GREEN, GL_BLUE, GL_ALPHA}};
    if (nchannels == 1) {
        format.swizzle[1] = format.swizzle[2] = GL_RED;
        format.swizzle[3] = coverage ? GL_GREEN : GL_ONE;
    } else if (shape == 1) {
        format.swizzle[2] = GL_ZERO;
        format.swizzle[3] = GL_ONE;
    }
    format.texel_bytes = slv_type_size(type) * format.ncomponents;
    return format;
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

void slvi_gl_convert_float(const slv_gl_format *format, const float *texels, uint32_t nchannels,
                           size_t count, void *out) {
    size_t size = slv_type_size(format->type), last = size * (format->ncomponents - 1);
    unsigned char *to = out;
    unsigned char one[4];
    one_of(format->type, one);
    for (size_t i = 0; i < count; i++, texels += nchannels, to += format->texel_bytes) {
        memset(to, 0, format->texel_bytes);
        slv_type_from_float(format->type, texels + format->first, format->nsource, to);
        if (format->coverage)
            memcpy(to + last, one, size);
    }
}

slv_result slvi_gl_format_compress(const slv_gl *gl, const slv_env *env, slv_gl_format *format) {
    if (format->type != SLV_TYPE_U8)
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED,
                         "a texture of %s cannot be compressed, only one of uint8",
                         slv_type_name(format->type));
    if (format->ncomponents == 4 && !gl->s3tc)
        return slvi_fail(env, SLV_ERROR_GL, "the driver lacks GL_EXT_texture_compression_s3tc");
    if (format->ncomponents == 4) {
        format->block = format->nsource == 4 ? SLV_GL_BLOCK_BC3 : SLV_GL_BLOCK_BC1;
        format->internal = format->nsource == 4 ? SLV_GL_RGBA_BC3 : SLV_GL_RGBA_BC1;
    } else {
        format->block = format->ncomponents == 2 ? SLV_GL_BLOCK_BC5 : SLV_GL_BLOCK_BC4;
        format->internal =
            format->ncomponents == 2 ? GL_COMPRESSED_RG_RGTC2 : GL_COMPRESSED_RED_RGTC1;
    }
    return SLV_OK;
}
