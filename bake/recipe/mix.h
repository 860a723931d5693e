/* Sources that are made of sources. Each takes what it is given, also if it fails. */
#ifndef SLV_BAKE_MIX_H
#define SLV_BAKE_MIX_H

#include "source/source.h"

typedef enum slvi_blend {
    SLVI_BLEND_NORMAL = 0,
    SLVI_BLEND_MULTIPLY,
    SLVI_BLEND_SCREEN,
    SLVI_BLEND_OVERLAY,
    SLVI_BLEND_ADD,
    SLVI_BLEND_SUBTRACT,
    SLVI_BLEND_MIN,
    SLVI_BLEND_MAX
} slvi_blend;
const char *slvi_blend_name(slvi_blend blend);

typedef struct slvi_levels_of {
    float in[2], out[2], gamma;
    bool unclamped;
} slvi_levels_of;

slv_result slvi_mix_constant(const slv_env *env, uint32_t nfaces, const float *values, uint32_t n,
                             slv_bake_source **out);
/* `mask` may be NULL. */
slv_result slvi_mix_blend(const slv_env *env, slvi_blend blend, float opacity,
                          slv_bake_source *bottom, slv_bake_source *top, slv_bake_source *mask,
                          slv_bake_source **out);
slv_result slvi_mix_levels(const slv_env *env, const slvi_levels_of *levels, slv_bake_source *of,
                           slv_bake_source **out);
slv_result slvi_mix_channels(const slv_env *env, const uint32_t *channels, uint32_t n,
                             slv_bake_source *of, slv_bake_source **out);

#endif
