/* Inside a stroke: the plane that a brush works in, and where its places lie on the surface. */
#ifndef SLV_PAINT_STROKE_DATA_H
#define SLV_PAINT_STROKE_DATA_H

#include "brush/brush_data.h"
#include "brush/path.h"

#include <selvage/stroke.h>

enum { SLVI_BASES = 4, SLVI_ALL_MIRRORS = 1 << SLV_MIRRORS };

/* A sample on the surface, unrolled: where it lies in the plane, in mesh units, and which direction
 * there is the plane's x. */
typedef struct slvi_base {
    slv_surface_point at;
    float axis[3];
    double x, y;
} slvi_base;

struct slv_stroke {
    slv_env env;
    slv_painter *painter;
    slv_canvas canvas;
    slv_stroke_params params;
    slv_mirror mirrors[SLV_MIRRORS];
    slv_lay lay;         /* if params.lay is not NULL, which then points here */
    slvi_base first_dab; /* of a clone: where it was */
    slvi_base source;    /* and what it took its colour from */
    slv_result result;   /* what went wrong, and ends the stroke */
    slv_stroke_stats stats;
    slvi_path path;
    slvi_mypaint *engine;
    slvi_base bases[SLVI_BASES]; /* the newest is number nbases - 1, modulo SLVI_BASES */
    uint64_t nbases;
    slvi_path_point first;
    bool begun, tap;
    double scale;        /* the plane's units for a unit of length, or for a pixel of the picture */
    double radius;       /* of the brush in the plane */
    double walked, next; /* along the curve: so far, and where the next dab or step is */
    slvi_path_point step; /* where the last step of libmypaint's ended */
    uint64_t ndabs;
};

/* A sample's place in the plane. `*reached` is false if it cannot be reached from the one before:
 * then it is the first of a new plane. */
slv_result slvi_place_sample(slv_stroke *s, const slv_stroke_sample *sample, double *x, double *y,
                             bool *reached);
/* How many units of the plane a unit of length, or a pixel, is: so that the brush has the size that
 * is asked for. `sample` is the first. False if the size cannot be known there. */
bool slvi_place_scale(slv_stroke *s, const slv_stroke_sample *sample);
/* Where a dab of the plane lies. False if there is no surface. */
bool slvi_place_dab(slv_stroke *s, const slvi_plane_dab *dab, slv_stroke_dab *out);
/* What a dab is cloned from: as far from the source of the first one, and in the same direction.
 * False if there is none. */
bool slvi_place_source(slv_stroke *s, slv_stroke_dab *dab);
/* The same dab on the other side of those of the mirrors whose bits are set. False if there is no
 * surface. */
bool slvi_mirror_dab(const slv_stroke *s, unsigned which, const slv_stroke_dab *dab,
                     slv_stroke_dab *out);

#endif
