/* Texels of a form on their way into array textures. */
#ifndef SLV_GL_UPLOAD_H
#define SLV_GL_UPLOAD_H

#include "gl/store/compress.h"
#include "gl/store/pools.h"

/* Memory that uploads share; begins as zeroes, `memory` is released with slvi_free. */
typedef struct slv_gl_staging {
    unsigned char *memory;
    uint64_t capacity;
} slv_gl_staging;

/* Fills and uploads one level of every layer (of pages: the whole layer), as many layers at a time
 * as the staging holds. What blocks lose is added to *error. */
slv_result slvi_gl_upload_level(const slv_gl_source *source, const slv_gl_pools *pools,
                                const slv_gl_pool *pool, const void *made, uint32_t level,
                                slv_gl_staging *staging, slv_gl_block_error *error);

#endif
