/* Which of a texture's strategies is meant. */
#include "gl/store/texture.h"

#include "base/log.h"

const slv_strategy *const *slvi_gl_strategies(const slv_gl_texture_params *params,
                                              const slv_strategy *one[1], uint32_t *count) {
    if (params && params->nstrategies) {
        *count = params->nstrategies;
        return params->strategies;
    }
    *count = 1;
    one[0] = slv_strategy_default();
    return one;
}

slv_gl_slot *slvi_gl_texture_slot(const slv_gl_texture *texture, const slv_strategy *strategy) {
    for (uint32_t i = 0; i < texture->nslots; i++)
        if (!strategy || texture->slots[i].strategy == strategy)
            return &texture->slots[i];
    return NULL;
}

slv_result slvi_gl_texture_need(const slv_gl_texture *texture, const slv_env *env,
                                const slv_strategy *strategy, slv_gl_slot **out) {
    *out = slvi_gl_texture_slot(texture, strategy);
    return *out ? SLV_OK
                : slvi_fail(env, SLV_ERROR_ARGUMENT, "the texture was not made for the strategy %s",
                            strategy->name);
}

slv_result slvi_gl_texture_need_ready(const slv_gl_texture *texture, const slv_env *env) {
    return texture->making ? slvi_fail(env, SLV_ERROR_ARGUMENT, "the texture is not uploaded yet")
                           : slvi_gl_need_current(texture->gl, env);
}

const slv_gl_batches *slvi_gl_texture_batches(const slv_gl_texture *texture,
                                              const slv_strategy *strategy) {
    static const slv_gl_batches none;
    const slv_gl_slot *slot = slvi_gl_texture_slot(texture, strategy);
    return slot && !texture->making ? &texture->reaches[slot->reach].reach.batches : &none;
}
