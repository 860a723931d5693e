/* Every level stored with a border from the neighbours (Purnomo 2004; McDonald and Burley 2011). */
#include "gl/strategy/strategy.h"

#include <selvage/border.h>

const slv_strategy slvi_strategy_borders = {
    .name = "borders",
    .title = "every level stored with a border copied from the neighbours",
    .form = slv_form_borders,
    .packing = SLV_GL_PAGES,
    /* A page is never left; but with this mode software drivers filter 8-bit texels in float and
     * not in 8 bits. */
    .wrap = SLV_GL_WRAP_ZERO,
    .file = "strategy/borders.glsl",
};
