/* Array textures by handles (GL_ARB_bindless_texture): a table with a row for each batch, so that
 * one multi-draw shows many, and the handles that are resident for it. */
#ifndef SLV_GL_HANDLES_H
#define SLV_GL_HANDLES_H

#include "gl/store/batches.h"

/* Arrays in a row, and as many with their coverage: 256 bytes, from any of which a table can be
 * bound. */
#define SLV_GL_ROW_POOLS 16
typedef struct slv_gl_handle_row {
    GLuint64 pools[SLV_GL_ROW_POOLS], coverage[SLV_GL_ROW_POOLS];
} slv_gl_handle_row;

/* Those of a strategy. */
typedef struct slv_gl_handles {
    GLuint table;     /* 0: none are made */
    uint64_t bytes;   /* of the table */
    GLuint64 *listed; /* of each pool, and of its coverage; 0: none */
    uint32_t count;
} slv_gl_handles;

/* Makes them resident in the current context, if it is another that shares objects with that in
 * which they are made. */
void slvi_gl_handles_need(const slv_gl *gl, const slv_gl_handles *handles);

#endif
