/* A texture that is not all uploaded yet. */
#ifndef SLV_GL_MAKING_H
#define SLV_GL_MAKING_H

#include "gl/store/texture.h"

typedef struct slv_gl_making {
    slvi_steps steps;
    slv_gl_tables tables;               /* still to be uploaded */
    uint32_t store, pool, level, layer; /* what comes next */
    uint64_t layers;                    /* of the store that are uploaded */
    uint64_t done, total;               /* bytes */
    uint64_t filled;                    /* of the first table */
    GLuint buffer;                      /* that is it */
    bool failed;                        /* what there is cannot be gone on with */
    slv_gl_staging staging;
} slv_gl_making;

slv_result slvi_gl_making_begin(slv_gl_texture *texture);
/* Bytes of all that is to be uploaded. */
uint64_t slvi_gl_making_bytes(const slv_gl_texture *texture);
/* Uploads the texels of the stores that there are, and then the tables; stops when it has uploaded
 * that many bytes. */
slv_result slvi_gl_making_upload(slv_gl_texture *texture, uint64_t max_bytes);
/* All is uploaded: what it took is given back, but for what following changes takes. */
slv_result slvi_gl_making_end(slv_gl_texture *texture);
void slvi_gl_making_free(slv_gl_texture *texture);

#endif
