/* The stages between what a dab covers and the canvas: mask, ink, symmetry, then paint or blur. */
#include "canvas/lay_data.h"

#include "base/log.h"

slv_result slv_painter_lay(slv_painter *painter, const slv_canvas *canvas,
                           const slv_patches *patches, const slv_paint *paint, const slv_lay *lay,
                           const slv_dab *dab, const slv_screen_dab *screen) {
    slvi_laying w = {.p = painter,
                     .canvas = canvas,
                     .patches = patches,
                     .paint = paint,
                     .lay = lay,
                     .dab = dab,
                     .screen = screen};
    slv_patches all = *patches;
    float *colors = NULL;
    uint64_t texels = 0;
    slv_result result = canvas->fns->describe(canvas->user, &w.desc);
    if (result || !patches->count)
        return result;
    w.res = w.desc.res;
    if (w.desc.nfaces != painter->surface->nfaces)
        return slvi_fail(&painter->env, SLV_ERROR_MISMATCH, "canvas: %u faces on a surface of %u",
                         (unsigned)w.desc.nfaces, (unsigned)painter->surface->nfaces);
    if ((result = slvi_painter_room(painter, patches->count, sizeof *painter->starts,
                                    &painter->starts, &painter->start_room)))
        return result;
    w.starts = painter->starts;
    for (uint32_t i = 0; i < patches->count; i++) {
        w.starts[i] = texels;
        texels += (uint64_t)patches->list[i].rect.width * patches->list[i].rect.height;
    }
    if (!(result = slvi_lay_mask(&w)) && !(result = slvi_lay_ink(&w))) {
        colors = w.colors;
        if (lay->symmetry)
            result = slvi_lay_mirror(&w, &all, &colors);
    }
    if (!result)
        result = lay->blur > 0 ? slv_painter_blur(painter, canvas, &all, lay->blur, paint->opacity)
                               : slvi_painter_apply(painter, canvas, &all, paint, colors);
    return result;
}
