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
/* Room for that many values in `scratch`. */
slv_result slvi_gl_staging_scratch(const slv_gl_source *source, uint64_t values,
                                   slv_gl_staging *staging);

/* A level (of pages: all that there is) of some layers of a pool. */
typedef struct slv_gl_layers {
    const slv_gl_pool *pool;
    uint32_t level, first, count;
} slv_gl_layers;

/* Bytes of one of them, as the GPU has it. */
uint64_t slvi_gl_layers_bytes(const slv_gl_pools *pools, const slv_gl_layers *layers);

/* How many from the first on are uploaded together within so many bytes: of a grid whole rows of
 * cells, at least one. */
uint32_t slvi_gl_layers_fitting(const slv_gl_pools *pools, const slv_gl_layers *layers,
                                uint64_t bytes);

/* Fills them on threads and uploads them in one call, blocks of a grid in one for each cell. What
 * blocks lose is added to *error. */
slv_result slvi_gl_upload_layers(const slv_gl_source *source, const slv_gl_pools *pools,
                                 const void *made, const slv_gl_layers *layers,
                                 slv_gl_staging *staging, slv_gl_block_error *error);

/* All levels of items of which nothing is compressed, whose layers lie in a row: in as few calls as
 * there are levels that OpenGL knows of, however many items. On this thread. *sent grows by the
 * bytes handed to the driver. */
slv_result slvi_gl_upload_run(const slv_gl_source *source, const slv_gl_pools *pools,
                              const void *made, const slv_gl_pool *pool, uint32_t first,
                              uint32_t count, slv_gl_staging *staging, uint64_t *sent);
/* Whether a layer goes into no run with the one before: so that the staging memory stays small, and
 * a run of cells within a row. */
bool slvi_gl_begins_run(const slv_gl_pools *pools, const slv_gl_pool *pool, uint32_t layer);

/* Whether an item has so much inside that its rim is worth being uploaded apart. */
bool slvi_gl_has_rim(const slv_gl_source *source, const slv_gl_pools *pools, const void *made,
                     uint32_t item);

/* Fills and uploads a rectangle of the texels that a level of one item has where it lies; NULL: all
 * of them. On this thread. *sent grows by the bytes handed to the driver. */
slv_result slvi_gl_upload_rect(const slv_gl_source *source, const slv_gl_pools *pools,
                               const void *made, uint32_t item, uint32_t level,
                               const slv_rect *rect, slv_gl_staging *staging, uint64_t *sent);

/* The same with all that can be another of an item whose own face was not changed. */
slv_result slvi_gl_upload_rim(const slv_gl_source *source, const slv_gl_pools *pools,
                              const void *made, uint32_t item, uint32_t level,
                              slv_gl_staging *staging, uint64_t *sent);

#endif
