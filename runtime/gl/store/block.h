/* Blocks of 4 x 4 texels in the formats that GPUs decode, through libsquish. The one C++ file of
 * this library is behind it. */
#ifndef SLV_GL_BLOCK_H
#define SLV_GL_BLOCK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum slv_gl_block {
    SLV_GL_BLOCK_NONE = 0,
    SLV_GL_BLOCK_BC1, /* RGB, alpha 1 */
    SLV_GL_BLOCK_BC3, /* RGBA */
    SLV_GL_BLOCK_BC4, /* R */
    SLV_GL_BLOCK_BC5  /* RG */
} slv_gl_block;

static inline size_t slv_gl_block_bytes(slv_gl_block kind) {
    return kind == SLV_GL_BLOCK_BC1 || kind == SLV_GL_BLOCK_BC4 ? 8 : 16;
}

/* `rgba` is 16 texels in rows; bit i of `mask` says that texel i matters. False if the library
 * threw an exception. */
bool slvi_gl_block_encode(slv_gl_block kind, const uint8_t rgba[64], uint32_t mask, uint8_t *out);
bool slvi_gl_block_decode(slv_gl_block kind, const uint8_t *block, uint8_t rgba[64]);

#ifdef __cplusplus
}
#endif

#endif
