/* Colours multiplied by alpha, whatever level they are of. */
#ifndef SLV_BAKE_UV_MULTIPLIED_H
#define SLV_BAKE_UV_MULTIPLIED_H

#include <selvage/source.h>

/* A source of the same texels, multiplied by alpha at every resolution, and without an alpha
 * channel of which others would take notice: the channel is one like others. Takes `inner`, also if
 * it fails. */
slv_result slvi_uv_multiplied(const slv_env *env, slv_source *inner, slv_source *out);

#endif
