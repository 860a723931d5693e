/* The same values as traverse from the plain form of it, which a report compares it with. */
#include "gl/strategy/strategy.h"

const slv_strategy slvi_strategy_traverse_full = {
    .name = "traverse-full",
    .title = "traverse in its plain form, for comparison",
    .form = slv_form_bare,
    .wrap = SLV_GL_WRAP_ZERO,
    .reach = SLV_GL_REACH_NEIGHBOURS,
    .coverage = true,
    .comparison = true,
    .file = "strategy/traverse_full.glsl",
};
