/* Copies of textures whose texels are computed from those of another, each from its own. */
#ifndef SLV_TEXTURE_MAP_H
#define SLV_TEXTURE_MAP_H

#include <selvage/texture.h>

/* Makes `count` texels out of those of the texture. `to` has room for floats of all channels.
 * Called by several threads at once. */
typedef void (*slvi_texel_map)(const void *user, const void *from, uint64_t count, void *to);

/* A texture like another, with the type and encoding of `desc`; faces of one value stay so. */
slv_result slvi_texture_map(const slv_env *env, const slv_texture *texture,
                            const slv_texture_desc *desc, slvi_texel_map map, const void *user,
                            slv_texture **out);

#endif
