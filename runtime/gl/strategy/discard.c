/* Own face with a zero border, colour over coverage; multisampling blends (Toth 2013). */
#include "gl/strategy/strategy.h"

const slv_strategy slvi_strategy_discard = {
    .name = "discard",
    .title = "drops what falls outside its face; multisampling blends",
    .form = slv_form_bare,
    .wrap = SLV_GL_WRAP_ZERO,
    .coverage = true,
    .file = "strategy/discard.glsl",
};
