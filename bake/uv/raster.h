/* Which face each pixel of a UV image shows. */
#ifndef SLV_BAKE_UV_RASTER_H
#define SLV_BAKE_UV_RASTER_H

#include <selvage/adjacency.h>

/* What a pixel's middle shows. */
typedef struct uv_owner {
    int32_t face;   /* -1: no face is within reach */
    float distance; /* to the face, in pixels; 0 inside */
    float u, v;     /* of the face; beyond it, as its plane goes on, where the pixel is outside */
    float du[2], dv[2]; /* changes of them by a pixel to the right and one down */
} uv_owner;

/* Rows top..top+rows-1 of an image of `width` x `height` pixels over the cell (u, v). */
typedef struct uv_band {
    int32_t u, v;
    uint32_t width, height, top, rows;
    uv_owner *owners; /* width * rows */
} uv_band;

/* Draws a face, given the texture coordinates at its corners, wherever it comes within `reach`
 * pixels of the band: a pixel belongs to the lowest face that its middle is in, else to the
 * nearest. Faces come in ascending order. Returns how many pixels were some other face's already.
 */
uint64_t slvi_uv_draw(const uv_band *band, int32_t face, const float corners[8], float reach);

#endif
