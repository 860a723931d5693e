/* Layers as compressed blocks. */
#ifndef SLV_GL_COMPRESS_H
#define SLV_GL_COMPRESS_H

#include "gl/store/block.h"

#include <selvage/result.h>

/* What compression loses: sums over the components of texels, in units of 1. */
typedef struct slv_gl_block_error {
    double squares, most;
    uint64_t count;
} slv_gl_block_error;

void slvi_gl_block_error_add(slv_gl_block_error *to, const slv_gl_block_error *from);

/* Encodes width x height texels of 1, 2 or 4 components, of which `nmeasured` count in the error.
 * Where `used` (may be NULL) is 0, a texel may become anything. A block that is turned by a quarter
 * gives the same decoded texels, turned: so a border that is copied from whole blocks of a
 * neighbour decodes to what the neighbour decodes to. */
slv_result slvi_gl_compress(const slv_env *env, slv_gl_block kind, uint32_t ncomponents,
                            uint32_t nmeasured, uint32_t width, uint32_t height,
                            const uint8_t *texels, const uint8_t *used, uint8_t *out,
                            slv_gl_block_error *error);

static inline uint64_t slv_gl_compressed_bytes(slv_gl_block kind, uint32_t width, uint32_t height) {
    return (uint64_t)((width + 3) / 4) * ((height + 3) / 4) * slv_gl_block_bytes(kind);
}

#endif
