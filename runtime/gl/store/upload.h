/* Texels of a form on their way into array textures. */
#ifndef SLV_GL_UPLOAD_H
#define SLV_GL_UPLOAD_H

#include "gl/store/compress.h"
#include "gl/store/place.h"

/* Memory that uploads share; begins as zeroes, is released with slvi_gl_staging_free. */
typedef struct slv_gl_staging {
    unsigned char *memory; /* stored texels */
    uint64_t capacity;
    float *scratch; /* what forms compute in */
    uint64_t nscratch;
} slv_gl_staging;
void slvi_gl_staging_free(slv_gl_staging *staging);

/* Fills and uploads one level of every layer (of pages: the whole layer), as many layers at a time
 * as the staging holds. What blocks lose is added to *error. */
slv_result slvi_gl_upload_level(const slv_gl_source *source, const slv_gl_pools *pools,
                                const slv_gl_pool *pool, const void *made, uint32_t level,
                                slv_gl_staging *staging, slv_gl_block_error *error);

/* Fills and uploads a rectangle of the texels that a level of one item has where it lies; NULL: all
 * of them. On this thread. *sent grows by the bytes handed to the driver. */
slv_result slvi_gl_upload_rect(const slv_gl_source *source, const slv_gl_pools *pools,
                               const void *made, uint32_t item, uint32_t level,
                               const slv_rect *rect, slv_gl_staging *staging, uint64_t *sent);

#endif
