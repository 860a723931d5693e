/* Own face, clamped: shows every seam; the baseline. */
#include "gl/strategy/strategy.h"

const slv_strategy slvi_strategy_clamp = {
    .name = "clamp",
    .title = "reads its own face only; the baseline that shows the problem",
    .form = slv_form_bare,
    .file = "strategy/clamp.glsl",
};
