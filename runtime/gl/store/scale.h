/* Floats so large that shaders could not add a few. */
#ifndef SLV_GL_SCALE_H
#define SLV_GL_SCALE_H

#include <selvage/texture.h>

/* Shaders multiply what they return by this where the texture was divided by it. */
#define SLV_GL_SCALE 16777216.0f
bool slvi_gl_is_large(const float *values, uint64_t count);
/* A copy of a float texture with values so large that sums of a few would overflow, divided by
 * SLV_GL_SCALE; NULL for any other. */
slv_result slvi_gl_scale_down(const slv_env *env, const slv_texture *texture, slv_texture **out);

#endif
