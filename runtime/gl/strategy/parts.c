/* The GLSL of strategies, put together from the files in shaders/. */
#include "gl/strategy/parts.h"

#include "gl/context/api.h"

/* A strategy's file says which features it has and which parts it is made of. */
static const char *const files[SLV_STRATEGY_COUNT] = {
    [SLV_STRATEGY_CLAMP] = "strategy/clamp.glsl",
    [SLV_STRATEGY_BORDERS] = "strategy/borders.glsl",
    [SLV_STRATEGY_TRAVERSE] = "strategy/traverse.glsl",
    [SLV_STRATEGY_DISCARD] = "strategy/discard.glsl",
    [SLV_STRATEGY_HYBRID] = "strategy/hybrid.glsl",
    [SLV_STRATEGY_TRAVERSE_FULL] = "strategy/traverse_full.glsl",
    [SLV_STRATEGY_EDGE_ALIGNED] = "strategy/edge_aligned.glsl",
    [SLV_STRATEGY_HTEX] = "strategy/htex.glsl",
};

slv_result slvi_gl_strategy_text(const slv_env *env, slv_strategy strategy, char **out) {
    return slvi_gl_shader_with_parts(env, files[strategy], out);
}
