/* Encodes and decodes the blocks of block.h by libsquish; its exceptions end here. */
#include "gl/store/block.h"

#include <cstring>
#include <squish.h>

static int flags_of(slv_gl_block kind) {
    switch (kind) {
    case SLV_GL_BLOCK_BC3:
        return squish::kDxt5;
    case SLV_GL_BLOCK_BC4:
        return squish::kBc4;
    case SLV_GL_BLOCK_BC5:
        return squish::kBc5;
    default:
        return squish::kDxt1;
    }
}

bool slvi_gl_block_encode(slv_gl_block kind, const uint8_t rgba[64], uint32_t mask, uint8_t *out) {
    try {
        squish::CompressMasked(rgba, static_cast<int>(mask), out, flags_of(kind));
        return true;
    } catch (...) {
        return false;
    }
}

/* A BC4 block is the alpha half of a BC3 block, which every version of the library decodes alike.
 */
static void decode_single(const uint8_t *block, unsigned channel, uint8_t rgba[64]) {
    uint8_t whole[16] = {0}, decoded[64];
    std::memcpy(whole, block, 8);
    squish::Decompress(decoded, whole, squish::kDxt5);
    for (unsigned i = 0; i < 16; i++)
        rgba[4 * i + channel] = decoded[4 * i + 3];
}

bool slvi_gl_block_decode(slv_gl_block kind, const uint8_t *block, uint8_t rgba[64]) {
    try {
        if (kind == SLV_GL_BLOCK_BC4 || kind == SLV_GL_BLOCK_BC5)
            decode_single(block, 0, rgba);
        else
            squish::Decompress(rgba, block, flags_of(kind));
        if (kind == SLV_GL_BLOCK_BC5)
            decode_single(block + 8, 1, rgba);
        return true;
    } catch (...) {
        return false;
    }
}
