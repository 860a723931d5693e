/* Sources that are made of sources. Each takes what it is given, also if it fails. */
#ifndef SLV_BAKE_MIX_H
#define SLV_BAKE_MIX_H

#include "source/source.h"

#include <selvage/blend.h>

typedef struct slvi_levels_of {
    float in[2], out[2], gamma;
    bool unclamped;
} slvi_levels_of;

slv_result slvi_mix_constant(const slv_env *env, uint32_t nfaces, const float *values, uint32_t n,
                             slv_bake_source **out);
/* `mask` may be NULL. */
slv_result slvi_mix_blend(const slv_env *env, slv_blend blend, float opacity,
                          slv_bake_source *bottom, slv_bake_source *top, slv_bake_source *mask,
                          slv_bake_source **out);
slv_result slvi_mix_levels(const slv_env *env, const slvi_levels_of *levels, slv_bake_source *of,
                           slv_bake_source **out);
slv_result slvi_mix_channels(const slv_env *env, const uint32_t *channels, uint32_t n,
                             slv_bake_source *of, slv_bake_source **out);

#endif
