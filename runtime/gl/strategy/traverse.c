/* Own face and the neighbours that the footprint reaches, colour over coverage (McDonald 2013). */
#include "gl/strategy/strategy.h"

const slv_strategy slvi_strategy_traverse = {
    .name = "traverse",
    .title = "reads the neighbours that a lookup reaches as well",
    .form = slv_form_bare,
    .wrap = SLV_GL_WRAP_ZERO,
    .reach = SLV_GL_REACH_NEIGHBOURS,
    .coverage = true,
    .file = "strategy/traverse.glsl",
};
