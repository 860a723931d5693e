/* Texels become blocks. */
#include "gl/store/compress.h"

#include "base/log.h"

#include <string.h>

void slvi_gl_block_error_add(slv_gl_block_error *to, const slv_gl_block_error *from) {
    to->squares += from->squares;
    to->most = from->most > to->most ? from->most : to->most;
    to->count += from->count;
}

/* Where texel i of a block comes from when the block is turned `quarters` times. */
static uint32_t turned_from(uint32_t i, uint32_t quarters) {
    uint32_t x = i % 4, y = i / 4;
    for (; quarters; quarters--) {
        uint32_t was_x = x;
        x = y;
        y = 3 - was_x;
    }
    return 4 * y + x;
}

static void turn(const uint8_t from[64], uint32_t quarters, uint8_t to[64]) {
    for (uint32_t i = 0; i < 16; i++)
        memcpy(to + 4 * i, from + 4 * turned_from(i, quarters), 4);
}

/* Moves the indices of a block, `bits` each and the first in the lowest bits, to where the texels
 * stood before they were turned. */
static void turn_indices_back(uint8_t *indices, uint32_t bits, uint32_t quarters) {
    uint64_t from = 0, to = 0, mask = (UINT64_C(1) << bits) - 1;
    uint32_t nbytes = 2 * bits;
    for (uint32_t i = 0; i < nbytes; i++)
        from |= (uint64_t)indices[i] << 8 * i;
    for (uint32_t i = 0; i < 16; i++)
        to |= (from >> bits * i & mask) << bits * turned_from(i, quarters);
    for (uint32_t i = 0; i < nbytes; i++)
        indices[i] = (uint8_t)(to >> 8 * i);
}

static void turn_block_back(slv_gl_block kind, uint8_t *block, uint32_t quarters) {
    bool single = kind == SLV_GL_BLOCK_BC1;
    if (!single) /* two endpoints of a byte, then 16 indices of 3 bits */
        turn_indices_back(block + 2, 3, quarters);
    if (kind == SLV_GL_BLOCK_BC5)
        turn_indices_back(block + 10, 3, quarters);
    if (single || kind == SLV_GL_BLOCK_BC3) /* two endpoints of two bytes, 16 indices of 2 bits */
        turn_indices_back(block + (single ? 4 : 12), 2, quarters);
}

/* Of the four ways to turn a block always the same one is encoded. */
static bool encode(slv_gl_block kind, const uint8_t rgba[64], uint32_t mask, uint8_t *out) {
    uint8_t least[64], other[64];
    uint32_t quarters = 0;
    if (mask != 0xffff)
        return slvi_gl_block_encode(kind, rgba, mask, out);
    memcpy(least, rgba, sizeof least);
    for (uint32_t q = 1; q < 4; q++) {
        turn(rgba, q, other);
        if (memcmp(other, least, sizeof least) < 0) {
            memcpy(least, other, sizeof least);
            quarters = q;
        }
    }
    if (!slvi_gl_block_encode(kind, least, mask, out))
        return false;
    turn_block_back(kind, out, quarters);
    return true;
}

/* The parameters say what the channels are and what of the texels counts, which no other struct
 * does. */
slv_result slvi_gl_compress(const slv_env *env, slv_gl_block kind, uint32_t ncomponents,
                            uint32_t nmeasured, uint32_t width, uint32_t height,
                            const uint8_t *texels, const uint8_t *used, uint8_t *out,
                            slv_gl_block_error *error) {
    for (uint32_t y = 0; y < height; y += 4) {
        for (uint32_t x = 0; x < width; x += 4, out += slv_gl_block_bytes(kind)) {
            uint8_t rgba[64] = {0}, decoded[64];
            uint32_t mask = 0;
            for (uint32_t i = 0; i < 16; i++) {
                uint32_t at_x = x + i % 4, at_y = y + i / 4;
                size_t at = (size_t)at_y * width + at_x;
                if (at_x >= width || at_y >= height || (used && !used[at]))
                    continue;
                mask |= 1u << i;
                memcpy(rgba + 4 * i, texels + at * ncomponents, ncomponents);
            }
            memset(out, 0, slv_gl_block_bytes(kind));
            if (!mask)
                continue;
            if (!encode(kind, rgba, mask, out) || !slvi_gl_block_decode(kind, out, decoded))
                return slvi_fail(env, SLV_ERROR_MEMORY, "a block could not be compressed");
            for (uint32_t i = 0; i < 16; i++) {
                for (uint32_t c = 0; mask >> i & 1 && c < nmeasured; c++) {
                    double lost = ((double)decoded[4 * i + c] - rgba[4 * i + c]) / 255;
                    error->squares += lost * lost;
                    lost = lost < 0 ? -lost : lost;
                    error->most = lost > error->most ? lost : error->most;
                    error->count++;
                }
            }
        }
    }
    return SLV_OK;
}
