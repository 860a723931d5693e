/* How far lookups reach from their face: the batches that hold the pools which they need, and the
 * tables in which they find their way. */
#ifndef SLV_GL_REACH_H
#define SLV_GL_REACH_H

#include "gl/store/batches.h"
#include "gl/store/corners.h"
#include "gl/store/marks.h"

typedef struct slv_gl_reach {
    slv_gl_batches batches;
    slv_gl_chunks chunks;   /* which draws are shown which rows of tables */
    slv_gl_part *parts;     /* one for each chunk; NULL: there are no tables but that of faces */
    uint64_t bytes;         /* of all tables */
    slv_gl_corners corners; /* where values are; which corner has which for `live` only */
    slv_gl_marks at_hand;   /* of htex: corners that are being changed */
} slv_gl_reach;

/* `made` is what the pools' form has made of the source. */
slv_result slvi_gl_reach_build(const slv_gl_source *source, slv_gl_reach_kind kind,
                               const slv_gl_pools *pools, const void *made, slv_gl_reach *out);
/* After a change: the values at the corners of some faces, those whose borders may be others. */
slv_result slvi_gl_reach_refresh(const slv_gl_source *source, slv_gl_reach_kind kind,
                                 const slv_gl_pools *pools, const void *made,
                                 const slv_gl_marks *faces, slv_gl_reach *reach);
/* Whether it has such values. */
bool slvi_gl_reach_has_values(slv_gl_reach_kind kind);
void slvi_gl_reach_free(const slv_gl *gl, slv_gl_reach *reach);

/* The most pools that a batch binds. */
uint32_t slvi_gl_reach_pools(slv_gl_reach_kind kind, const slv_gl_texture_params *params);

#endif
