/* How texels are laid out for a sampler. */
#ifndef SLV_GL_FORMAT_H
#define SLV_GL_FORMAT_H

#include "gl/context/api.h"
#include "gl/store/block.h"

#include <selvage/gl_texture.h>

/* `nsource` channels from `first`, padded to `ncomponents`. */
typedef struct slv_gl_format {
    slv_type type;
    uint32_t first, nsource, ncomponents;
    bool coverage;  /* the last component is 1 in every texel */
    bool own_alpha; /* alpha is a channel of the texels */
    GLenum internal, external, data;
    GLint swizzle[4];
    const uint8_t *srgb; /* NULL: linear; else the bytes of colours, by halves of 0 to 1 */
    size_t texel_bytes;  /* before compression */
    slv_gl_block block;
} slv_gl_format;

/* Whether alpha, in lookups, is a channel of the texels. */
static inline bool slvi_gl_own_alpha(const slv_gl_texture_params *params) {
    return params->nchannels == 4 || params->grey_alpha;
}

/* Of the channels that the parameters show. */
slv_gl_format slvi_gl_format_for(slv_type type, const slv_gl_texture_params *params, bool coverage);
/* The format of 8-bit colours that were decoded; `srgb` has SLVI_GL_SRGB bytes,
 * slvi_gl_srgb_fill's.
 */
enum { SLVI_GL_SRGB = 0x3c01 }; /* halves from 0 to 1 */
slv_gl_format slvi_gl_format_srgb(const slv_gl *gl, const uint8_t *srgb,
                                  const slv_gl_texture_params *params, bool coverage, bool blocks);
void slvi_gl_srgb_fill(uint8_t *srgb);
/* Makes a format of 8-bit texels one of blocks. `type` is the texture's. */
slv_result slvi_gl_format_compress(const slv_gl *gl, const slv_env *env, slv_type type,
                                   slv_gl_format *format);

/* `count` texels with `nchannels` channels of the format's type, to the format. */
void slvi_gl_convert(const slv_gl_format *format, const void *texels, uint32_t nchannels,
                     size_t count, void *out);
/* The same from halves of decoded colours, to a format that encodes them again. */
void slvi_gl_convert_half(const slv_gl_format *format, const uint16_t *texels, uint32_t nchannels,
                          size_t count, uint8_t *out);
/* The same from floats. */
void slvi_gl_convert_float(const slv_gl_format *format, const float *texels, uint32_t nchannels,
                           size_t count, void *out);

#endif
