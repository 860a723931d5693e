/* Lookups in the squares of edges. */
#ifndef SLV_GL_SQUARES_H
#define SLV_GL_SQUARES_H

#include "gl/store/reach.h"

/* A face has four squares, which a batch holds however few arrays a host asks for. */
#define SLV_GL_SQUARES_POOLS 4

/* Batches whose pools hold all squares that their faces look up, the table of these, and the
 * values of corners. */
slv_result slvi_gl_reach_squares(const slv_gl_source *source, const slv_gl_pools *pools,
                                 const void *made, slv_gl_reach *out);
/* The values at the corners of some faces, and of those across their edges, anew. */
slv_result slvi_gl_squares_refresh(const slv_gl_source *source, const slv_gl_pools *pools,
                                   const void *made, const slv_gl_marks *faces,
                                   slv_gl_reach *reach);

#endif
