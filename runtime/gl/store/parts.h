/* Tables with rows for faces and values of corners, as parts: each what draws of one chunk of faces
 * are shown. */
#ifndef SLV_GL_PARTS_H
#define SLV_GL_PARTS_H

#include "gl/store/chunks.h"
#include "gl/store/source.h"

/* Bound at SLV_GL_FIRST_STORAGE + 1 and + 3. */
typedef struct slv_gl_part {
    GLuint ways, values;
    uint64_t way_bytes, value_bytes;
} slv_gl_part;

/* The most bytes that a table of a part may have. */
uint64_t slvi_gl_parts_limit(const slv_gl *gl);

typedef struct slv_gl_part_rows {
    const void *rows; /* of all faces */
    uint64_t row_bytes;
    const float *values;   /* four floats each, */
    const uint64_t *first; /* of each chunk from there on, and one past the last */
} slv_gl_part_rows;

/* Makes the tables, or puts them off; *out, one for each chunk, is to be freed on failure too. */
slv_result slvi_gl_parts_make(const slv_gl_source *source, slv_gl_chunks chunks,
                              const slv_gl_part_rows *from, slv_gl_part **out);
void slvi_gl_parts_free(const slv_gl *gl, slv_gl_chunks chunks, slv_gl_part *parts);

#endif
