/* Triangles of a tessellated surface in the order of batches. */
#ifndef SLV_GL_INDICES_H
#define SLV_GL_INDICES_H

#include "gl/store/batches.h"

#include <selvage/tessellation.h>

/* Those of one texture's batches. Each strategy keeps those that it drew last. */
typedef struct slv_gl_indices {
    uint64_t texture; /* serial; 0 is none */
    const slv_strategy *strategy;
    GLuint buffer, array;
    GLsizei *counts; /* of each batch */
    const void **at; /* where its first is in the buffer */
} slv_gl_indices;

/* Makes them of the faces of batches, one of which may be in several, unless those of `texture`,
 * the serial of what the batches are of, are there. `vertices` is the buffer of the surface's. */
slv_result slvi_gl_indices_make(const slv_gl *gl, const slv_env *env, const slv_tessellation *mesh,
                                GLuint vertices, uint64_t texture, const slv_gl_batches *batches,
                                slv_gl_indices *out);
void slvi_gl_indices_free(const slv_gl *gl, slv_gl_indices *indices);

#endif
