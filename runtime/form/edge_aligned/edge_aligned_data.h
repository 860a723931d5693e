/* Samples on the edges and vertices of faces, for the files of edge_aligned. Values are raw as in
 * texture/border.h. */
#ifndef SLV_TEXTURE_EDGE_ALIGNED_H
#define SLV_TEXTURE_EDGE_ALIGNED_H

#include "form/borders/border_data.h"

#include <selvage/edge_aligned.h>

/* Makes all levels of some faces anew. */
slv_result slvi_edge_aligned_refresh(const slv_levels *levels, const slv_adjacency *adjacency,
                                     const uint32_t *faces, uint32_t count,
                                     slv_edge_aligned *aligned);

/* The value of a vertex as a face at some level has it. If `rounded`, what is interpolated between
 * samples is interpolated between samples that are rounded to the texture's type, as a lookup will
 * find them. */
void slvi_edge_aligned_corner(const slv_border_view *view, bool rounded, uint32_t face,
                              uint32_t level, uint32_t corner, float *out);

/* Writes the samples strictly inside an edge, 1..2^exponent - 1 counter-clockwise, divided by
 * view->one; `to` is where sample 1 goes, `step` the floats from one to the next. */
void slvi_edge_aligned_side(const slv_border_view *view, bool rounded, const slv_border_edge *edge,
                            float *to, ptrdiff_t step);

/* slv_edge_aligned_build, which rounds nothing, or for samples that will be rounded. Checks
 * nothing.
 */
void slvi_edge_aligned_fill(const slv_levels *levels, const slv_adjacency *adjacency, bool rounded,
                            uint32_t face, uint32_t level, float *out);

/* Floats that a face's level 0, the largest of its levels, takes. */
static inline uint64_t slv_edge_aligned_floats(const slv_texture_desc *desc, uint32_t face) {
    return slv_edge_aligned_count(desc->res[face]) * desc->nchannels;
}

#endif
