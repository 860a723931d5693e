/* Lookups in the squares of edges. */
#ifndef SLV_GL_SQUARES_H
#define SLV_GL_SQUARES_H

#include "gl/store/reach.h"

/* Batches whose pools hold all squares that their faces look up, the table of these, and the
 * values of corners. */
slv_result slvi_gl_reach_squares(const slv_gl_source *source, const slv_gl_pools *pools,
                                 const void *made, slv_gl_reach *out);

#endif
