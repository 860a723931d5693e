/* Buffers that shaders read. */
#ifndef SLV_GL_TABLES_H
#define SLV_GL_TABLES_H

#include "gl/store/pools.h"

void slvi_gl_tables_free(slv_gl_tables *tables);

slv_result slvi_gl_buffer(const slv_gl *gl, const slv_env *env, const char *what, const void *data,
                          uint64_t bytes, GLuint *out);
/* A buffer that shaders read: refused above the driver's limit for storage blocks. Where buffers
 * are put off, `data` is copied, and *out is set later. */
slv_result slvi_gl_table(const slv_gl_source *source, const char *what, const void *data,
                         uint64_t bytes, GLuint *out);

/* The same for one that draws are shown parts of. */
slv_result slvi_gl_long_table(const slv_gl_source *source, const char *what, const void *data,
                              uint64_t bytes, GLuint *out);

/* Per face its resolution and, where it is an item itself, its pool and layer. */
slv_result slvi_gl_face_table(const slv_gl_source *source, const slv_gl_pools *pools,
                              const void *made, GLuint *out, uint64_t *bytes);
/* Whether all that is stored of a face is one texel. What of a texture that is followed has come to
 * be constant may have kept its place. */
bool slvi_gl_is_single(const slv_gl_source *source, const slv_gl_pools *pools, uint32_t face);
/* A row of that table. */
void slvi_gl_face_row(const slv_gl_source *source, const slv_gl_pools *pools, const void *made,
                      uint32_t face, uint32_t row[2]);
/* Of levels side by side: where in a pool's layers, or in the first cell of a grid, each level is;
 * of a grid the columns, the page and the size of a cell, too. */
slv_result slvi_gl_level_table(const slv_gl_source *source, const slv_gl_pools *pools, GLuint *out,
                               uint64_t *bytes);
/* A value with all channels as shaders read it: those that are shown, grey as all three, alpha 1.
 */
void slvi_gl_table_value(const slv_gl_texture_params *params, const float *from, float to[4]);

#endif
