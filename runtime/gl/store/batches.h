/* Batches: sets of faces whose pools fit the texture units that a draw binds. */
#ifndef SLV_GL_BATCHES_H
#define SLV_GL_BATCHES_H

#include "gl/store/chunks.h"
#include "gl/store/pools.h"

typedef struct slv_gl_batch_range {
    uint32_t first, count; /* in the batch list's faces */
    uint32_t variant, npools, chunk;
    uint32_t pools[16]; /* number 0 is the batch's own */
} slv_gl_batch_range;

typedef struct slv_gl_batches {
    slv_gl_batch_range *ranges;
    uint32_t count, capacity;
    uint32_t *faces;
    bool of_pools; /* `faces` is the pools' list of items, which they change when items move */
} slv_gl_batches;

/* Variants: the number of pools a shader can reach, 1 << (variant >> 1), and whether there are
 * sub-faces among them or their neighbours. */
static inline uint32_t slv_gl_variant_pools(uint32_t variant) {
    return 1u << (variant >> 1);
}
uint32_t slvi_gl_variant_for(uint32_t npools, bool subfaces);

/* Adds a pool to a set if it is not there; returns its place. */
uint32_t slvi_gl_add_pool(uint32_t *pools, uint32_t *npools, uint32_t pool);
/* The place of a pool in a batch, or its number of pools. */
uint32_t slvi_gl_slot_of(const slv_gl_batch_range *range, uint32_t pool);

/* One batch an array and chunk, of faces that are items. */
slv_result slvi_gl_batches_by_pool(const slv_env *env, const slv_gl_pools *pools,
                                   slv_gl_chunks chunks, slv_gl_batches *out);
/* One more, empty; the pointer holds until the next. */
slv_result slvi_gl_add_batch(const slv_env *env, slv_gl_batches *batches, slv_gl_batch_range **out);
/* Sorts batches by chunk and variant, so that few draws change what is bound, and lists the faces
 * of each in the order of `order`, a batch for each chunk; batches->faces has room for them.
 * `batch_of` has the new numbers afterwards. */
slv_result slvi_gl_batches_list(const slv_env *env, slv_gl_batches *batches, const uint32_t *order,
                                uint32_t nfaces, slv_gl_chunks chunks, uint32_t *batch_of);
/* Gives all of them the variant that does for each, so that one program draws them. */
void slvi_gl_batches_unite(slv_gl_batches *batches);
void slvi_gl_batches_free(slv_gl_batches *batches);

#endif
