/* Lookups that go on in the faces across the edges. */
#ifndef SLV_GL_LINKS_H
#define SLV_GL_LINKS_H

#include "gl/store/reach.h"

/* Batches whose pools hold the neighbours too, the table of links, and the values of corners. */
slv_result slvi_gl_reach_neighbours(const slv_gl_source *source, const slv_gl_pools *pools,
                                    const void *made, slv_gl_reach *out);
/* The values at the corners of some faces anew. */
slv_result slvi_gl_links_refresh(const slv_gl_source *source, const slv_gl_pools *pools,
                                 const void *made, const slv_gl_marks *faces, slv_gl_reach *reach);

#endif
