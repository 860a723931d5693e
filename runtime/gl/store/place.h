/* Where a level of an item lies on the GPU, and putting texels there. Nothing else knows. */
#ifndef SLV_GL_PLACE_H
#define SLV_GL_PLACE_H

#include "gl/store/pools.h"

/* width x height texels of one layer of an array, what surrounds the item's own texels included. */
typedef struct slv_gl_place {
    const slv_gl_pool *pool;
    const slv_gl_format *format;
    uint32_t level; /* OpenGL's */
    uint32_t layer, x, y, width, height;
    uint32_t array_width, array_height; /* of the array at that level */
} slv_gl_place;

slv_gl_place slvi_gl_place(const slv_gl_pools *pools, uint32_t item, uint32_t level);

/* All that an item has of a level that OpenGL knows of: its cell, of levels side by side. */
slv_gl_place slvi_gl_place_cell(const slv_gl_pools *pools, const slv_gl_pool *pool, uint32_t layer,
                                uint32_t level);

/* A rectangle of a place's texels, to be put there by itself; of blocks those that it touches,
 * which may begin or end outside of the place, where there are no other texels. */
slv_gl_place slvi_gl_place_part(const slv_gl_place *place, slv_rect rect);

/* Bytes of a place as the format stores it. */
uint64_t slvi_gl_place_bytes(const slv_gl_place *place);

/* Hands `nlayers` times a place's texels or blocks, tightly packed, to the driver: for its own
 * layer and those that follow. */
void slvi_gl_place_send(const slv_gl_source *source, const slv_gl_place *place, uint32_t nlayers,
                        const void *stored);

#endif
