/* Pixels of tiles as light. */
#ifndef SLV_BAKE_UV_SAMPLE_H
#define SLV_BAKE_UV_SAMPLE_H

#include "uv/lines.h"
#include "uv/tiles.h"

/* `count` pixels of a row from (x, y) on, light, multiplied by alpha. */
void slvi_uv_decode(const uv_tile *tile, uint32_t nchannels, uint32_t x, uint32_t y, uint32_t count,
                    uv_pixel *out);

#endif
