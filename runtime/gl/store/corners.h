/* The values on which the faces around a vertex agree, once for all of them. */
#ifndef SLV_GL_CORNERS_H
#define SLV_GL_CORNERS_H

#include "gl/store/marks.h"
#include "gl/store/parts.h"

/* Values of four floats in lists, one or two to a ring of faces; where a table is looked at in
 * parts, one for each part that has faces of the ring. */
typedef struct slv_gl_corners {
    uint32_t *where; /* per face and corner, as shaders read it: number of the list's first value in
                        its part, and in the upper 5 bits how many levels share it */
    uint64_t *first; /* per part: number of its first value, and one past the last part */
    float *texel;    /* a value that is computed after a change; NULL before the first */
} slv_gl_corners;

/* Lays the values out; *chunks gets as many parts as the driver's limits need, no row of any table
 * being longer than `row` bytes. */
slv_result slvi_gl_corners_list(const slv_gl_source *source, uint64_t row, slv_gl_chunks *chunks,
                                slv_gl_corners *out);
/* Computes all values, four floats each. */
slv_result slvi_gl_corners_fill(const slv_gl_source *source, slv_gl_chunks chunks,
                                const slv_gl_corners *corners, float *values);
/* Computes and uploads those around some faces. */
slv_result slvi_gl_corners_refresh(const slv_gl_source *source, slv_gl_chunks chunks,
                                   slv_gl_corners *corners, const slv_gl_marks *faces,
                                   const slv_gl_part *parts);
void slvi_gl_corners_free(slv_gl_corners *corners);

#endif
