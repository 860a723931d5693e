/* Square textures of edges, each shared by the faces on both sides (Barbier and Dupuy 2022): the
 * same values from both sides at any resolution and any footprint, of a texture that is resampled.
 */
#include "gl/strategy/strategy.h"

#include <selvage/htex.h>

const slv_strategy slvi_strategy_htex = {
    .name = "htex",
    .title = "squares of edges, shared by the faces on both sides",
    .form = slv_form_htex,
    /* A square is left by half a texel at most, which repeats the one at its side. */
    .wrap = SLV_GL_WRAP_MIRROR,
    .reach = SLV_GL_REACH_SQUARES,
    .own_taps = true,
    .resampled = true,
    .file = "strategy/htex.glsl",
};
