/* Samples on the edges of faces in place of borders (Purnomo 2004): the same values from both sides
 * at any resolution, of a texture that is slightly blurred. */
#include "gl/strategy/strategy.h"

#include <selvage/edge_aligned.h>

const slv_strategy slvi_strategy_edge_aligned = {
    .name = "edge-aligned",
    .title = "samples on the edges of faces, shared with the neighbours",
    .form = slv_form_edge_aligned,
    .packing = SLV_GL_PAGES,
    .wrap = SLV_GL_WRAP_ZERO, /* as borders has it */
    .resampled = true,
    .file = "strategy/edge_aligned.glsl",
};
