/* Traverse where texels are larger than pixels, discard where smaller. */
#include "gl/strategy/strategy.h"

const slv_strategy slvi_strategy_hybrid = {
    .name = "hybrid",
    .title = "traverse where texels are larger than pixels, else discard",
    .form = slv_form_bare,
    .wrap = SLV_GL_WRAP_ZERO,
    .reach = SLV_GL_REACH_NEIGHBOURS,
    .coverage = true,
    .file = "strategy/hybrid.glsl",
};
