/* What a camera sees of the surface that is painted on. */
#ifndef SLV_PAINT_VIEW_H
#define SLV_PAINT_VIEW_H

#include "surface/painter_data.h"

/* A camera taken apart: the matrix as doubles, and the eye. */
typedef struct slvi_view {
    slv_camera camera;
    uint32_t width, height;
    double matrix[12], eye[3], towards[3]; /* perspective: the eye; else where rays come from */
} slvi_view;

/* False for a camera that is none. */
bool slvi_view_make(const slv_paint_surface *s, const slv_camera *camera, uint32_t width,
                    uint32_t height, slvi_view *out);
/* A point's place in the picture; false behind the eye. */
bool slvi_view_project(const slvi_view *v, const double p[3], double out[2]);
/* Whether a triangle faces the eye, as seen from a point of it. */
bool slvi_view_faces(const slv_paint_surface *s, const slvi_view *v, uint32_t tri,
                     const double point[3]);
/* Whether nothing lies between a point and the eye. */
bool slvi_view_sees(const slv_painter *p, const slvi_view *v, const double point[3]);

#endif
