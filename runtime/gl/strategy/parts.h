/* The GLSL of strategies, put together from the files in shaders/. */
#ifndef SLV_GL_STRATEGY_PARTS_H
#define SLV_GL_STRATEGY_PARTS_H

#include <selvage/gl_texture.h>

/* The text of a strategy's lookups: its own file with the parts that it names in place of their
 * names, and no definitions of a variant yet. Released with slvi_free. */
slv_result slvi_gl_strategy_text(const slv_env *env, slv_strategy strategy, char **out);

#endif
