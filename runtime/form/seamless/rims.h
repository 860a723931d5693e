/* The outermost texels of levels, made to agree with those of neighbours. */
#ifndef SLV_FORM_RIMS_H
#define SLV_FORM_RIMS_H

#include "form/borders/border_data.h"

#include <selvage/seamless.h>

/* Whether a level's texels stay as they are: those of a single row belong to two opposite edges at
 * once, and a face can be meant to stay constant. */
static inline bool slvi_rim_is_bound(const slv_levels *levels, uint32_t face, slv_res res) {
    return res.u == 0 || res.v == 0 || (levels->kind && levels->kind[face] & SLVI_LEVELS_STAYS);
}

/* Whether a corner lies in the middle of a whole quad's edge that has two texels. Two sub-faces
 * have one value there, which is the quad's on neither side of the middle. */
bool slvi_rim_is_between_two(const slv_border_view *view, uint32_t face, uint32_t corner,
                             uint32_t *quad, uint32_t *edge);
/* What texel k of a face's outermost row along an edge is to be, raw, as the type can hold it. */
void slvi_rim_value(const slv_border_view *view, const slv_border_edge *edge, uint32_t k,
                    float *out);
/* The line through the agreed texels of the coarser face across, where texel k has its middle. */
void slvi_rim_between(const slv_border_view *view, const slv_border_edge *edge,
                      const slv_border_link *link, uint32_t k, float *out);
/* Where that is in the coarser face's row of `last` + 1 texels. */
static inline float slvi_rim_place(const slv_border_edge *edge, const slv_border_link *link,
                                   uint32_t k, float last) {
    float along = link->slope * slvi_border_centre(edge->exponent, k) + link->offset;
    float at = along * (last + 1.0f) - 0.5f;
    return at < 0.0f ? 0.0f : at > last ? last : at;
}
/* Puts agreed values into `texels`, which hold a level of a face as `levels` has it. Reads plain
 * levels only, so that faces can be done in any order. */
void slvi_rims_agree(const slv_levels *levels, const slv_adjacency *adjacency, uint32_t face,
                     uint32_t level, void *texels);

#endif
