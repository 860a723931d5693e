/* How colours are mixed. */
#ifndef SLV_PAINT_BLEND_H
#define SLV_PAINT_BLEND_H

#include <selvage/canvas.h>

/* Mixes a paint into `count` texels of `nchannels` floats, as much of it as `coverage` says. */
void slvi_blend_texels(const slv_canvas_desc *canvas, const slv_paint *paint, const float *coverage,
                       uint64_t count, float *texels);

#endif
