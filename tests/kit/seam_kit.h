/* Textures on the GPU and their seam jumps. */
#ifndef SEAM_KIT_H
#define SEAM_KIT_H

#include "kit/border_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_texture.h>

/* For all strategies, unless a list is given. */
static inline slv_gl_texture *seam_upload(slv_gl *gl, const kit *k, slv_gl_texture_params params) {
    slv_env env = test_env();
    slv_gl_texture *texture = NULL;
    if (!params.nstrategies) {
        params.strategies = kit_strategies();
        params.nstrategies = slv_strategy_count();
    }
    REQUIRE(slv_gl_texture_create(gl, &env, k->texture, k->adjacency, &params, &texture) == SLV_OK);
    return texture;
}

static inline slv_gl_seam seam_jump(slv_gl_texture *texture, const kit *k,
                                    const slv_strategy *strategy, slv_gl_seam_params params) {
    slv_env env = test_env();
    slv_gl_seam seam;
    REQUIRE(slv_gl_texture_seam_jump(texture, &env, strategy, k->adjacency, &params, &seam) ==
            SLV_OK);
    return seam;
}

#endif
