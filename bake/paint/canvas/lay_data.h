/* What the stages between patches and a canvas share. */
#ifndef SLV_PAINT_LAY_DATA_H
#define SLV_PAINT_LAY_DATA_H

#include "surface/view.h"

#include <selvage/lay.h>

/* slv_painter_apply with a colour for each texel, or NULL. */
slv_result slvi_painter_apply(slv_painter *painter, const slv_canvas *canvas,
                              const slv_patches *patches, const slv_paint *paint,
                              const float *colors);

/* Makes the canvas ready to be looked up, as it is now; and lookups, each as wide as `width` mesh
 * units, of its channels. */
slv_result slvi_painter_watch(slv_painter *p, const slv_canvas *canvas,
                              const slv_canvas_desc *desc);
slv_result slvi_painter_look_up(const slv_painter *p, uint32_t count, const slv_surface_point *at,
                                float width, float *out);

/* slv_painter_flood from several places, each paint laid its own way; a texel is the first's that
 * takes it. */
typedef struct slvi_seed {
    slv_surface_point at;
    const slv_lay *lay;
} slvi_seed;
slv_result slvi_painter_flood(slv_painter *painter, const slv_canvas *canvas,
                              const slvi_seed *seeds, uint32_t count, float tolerance,
                              const slv_paint *paint, uint64_t *texels);

/* What is laid, and what its patches are of. */
typedef struct slvi_laying {
    slv_painter *p;
    const slv_canvas *canvas;
    slv_canvas_desc desc;
    const slv_res *res; /* of the patches */
    const slv_patches *patches;
    const slv_paint *paint;
    const slv_lay *lay;
    const slv_dab *dab;
    const slv_screen_dab *screen;
    slvi_view view;   /* of an image before the camera, or the mask's */
    float *colors;    /* NULL: the paint's */
    uint64_t *starts; /* of each patch's texels */
} slvi_laying;

/* The middle of texel x, y of a face. */
static inline slv_surface_point slvi_texel_point(uint32_t face, slv_res res, uint32_t x,
                                                 uint32_t y) {
    return (slv_surface_point){(int32_t)face, ldexpf((float)x + 0.5f, -res.u),
                               ldexpf((float)y + 0.5f, -res.v)};
}

/* A patch's coverage, which is the painter's own. */
static inline float *slvi_own_coverage(const slv_painter *p, const slv_patch *patch) {
    return p->coverage + (patch->coverage - p->coverage);
}

/* Takes away what the mask does not let through. */
slv_result slvi_lay_mask(slvi_laying *w);
/* Each texel's colour, and less coverage where the image has less. */
slv_result slvi_lay_ink(slvi_laying *w);
/* The patches with their mirror images, each face once, which belong to the painter. */
slv_result slvi_lay_mirror(slvi_laying *w, slv_patches *out, float **colors);

#endif
