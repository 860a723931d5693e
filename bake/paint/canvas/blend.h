/* How colours are mixed. */
#ifndef SLV_PAINT_BLEND_H
#define SLV_PAINT_BLEND_H

#include <selvage/canvas.h>

/* Mixes a paint into `count` texels of `nchannels` floats, as much of it as `coverage` says.
 * `colors` (may be NULL) has SLV_PAINT_CHANNELS for each texel, in place of the paint's. */
void slvi_blend_texels(const slv_canvas_desc *canvas, const slv_paint *paint, const float *coverage,
                       const float *colors, uint64_t count, float *texels);
/* Mixes a layer's texels, which have alpha, into others, as much as `opacity` and `mask` (NULL: 1)
 * say. */
void slvi_blend_layer(const slv_canvas_desc *canvas, slv_blend blend, float opacity,
                      const float *above, const float *mask, uint64_t count, float *texels);

#endif
