/* Samples on the edges and vertices of faces, for the files of edge_aligned. Values are raw as in
 * texture/border.h. */
#ifndef SLV_TEXTURE_EDGE_ALIGNED_H
#define SLV_TEXTURE_EDGE_ALIGNED_H

#include "form/borders/border_data.h"

#include <selvage/edge_aligned.h>

/* The value of a vertex as a face at some level has it. If `rounded`, what is interpolated between
 * samples is interpolated between samples that are rounded to the texture's type, as a lookup will
 * find them. */
void slvi_edge_aligned_corner(const slv_border_view *view, bool rounded, uint32_t face,
                              uint32_t level, uint32_t corner, float *out);

/* Writes the samples strictly inside an edge, 1..2^exponent - 1 counter-clockwise, divided by
 * view->one; `to` is where sample 1 goes, `step` the floats from one to the next. */
void slvi_edge_aligned_side(const slv_border_view *view, bool rounded, const slv_border_edge *edge,
                            float *to, ptrdiff_t step);

/* The samples of a level, to be rounded to the texture's type; with `rim` only the outermost. */
void slvi_edge_aligned_fill(const slv_levels *levels, const slv_adjacency *adjacency, uint32_t face,
                            uint32_t level, bool rim, float *out);

/* Whether squares of one resolution, and nothing else, lie around a face; and the rings of its
 * corners, with where it is in them. */
bool slvi_edge_aligned_is_alike(const slv_levels *levels, const slv_adjacency *adjacency,
                                uint32_t face, slv_ring rings[4], uint32_t positions[4]);

/* The samples on the edges and vertices of such a face, the same to the bit as if it were
 * any face. */
void slvi_edge_aligned_fill_alike(const slv_levels *levels, uint32_t face, uint32_t level,
                                  const slv_ring rings[4], const uint32_t positions[4], float *out);

/* Floats that a face's level 0, the largest of its levels, takes. */
static inline uint64_t slv_edge_aligned_floats(const slv_texture_desc *desc, uint32_t face) {
    return slv_edge_aligned_count(desc->res[face]) * desc->nchannels;
}

#endif
