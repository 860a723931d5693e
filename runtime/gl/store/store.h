/* A form of a texture on the GPU: its items in array textures, and the tables that say where. */
#ifndef SLV_GL_STORE_H
#define SLV_GL_STORE_H

#include "gl/store/compress.h"
#include "gl/store/marks.h"
#include "gl/store/pools.h"
#include "gl/store/upload.h"

typedef struct slv_gl_store {
    slv_gl_pools pools;
    void *made;           /* by the form; NULL where nothing follows changes */
    uint8_t *wide;        /* per item: whether it needs a wider type; likewise */
    slv_gl_marks stale;   /* items at hand; likewise */
    slv_gl_marks whole;   /* those of them that are uploaded as a whole, not only at their edges */
    slv_gl_marks waiting; /* for room for their type, wider or not; likewise */
    bool moved;           /* an item has got another layer, which batches do not know yet */
    bool coverage; /* texels have it, in a channel or, beside four channels, in arrays of its own */
    uint32_t nwide, nclipped;
    slv_gl_block_error error;
    GLuint table; /* per face: pool | layer << 16, res */
    GLuint rects; /* of pages */
    uint64_t rect_bytes;
    uint64_t bytes, coverage_bytes; /* coverage apart, for not every strategy binds it */
} slv_gl_store;

/* All but what takes OpenGL: arrays and texels are still to be made. `made` is what the form has
 * made of the source, which the store takes, also if it fails. `out` stays where it is. */
slv_result slvi_gl_store_prepare(const slv_gl_source *source, const slv_form *form, void *made,
                                 slv_gl_packing packing, bool shares, bool coverage,
                                 slv_gl_store *out);
/* Whether an item needs a wider type than the texture's, as it is now; works in the staging
 * memory. */
slv_result slvi_gl_store_is_wide(const slv_gl_source *source, const slv_gl_store *store,
                                 uint32_t item, slv_gl_staging *staging, bool *out);
/* Makes the array of a pool, if there is none; what the driver says to that is still to be asked.
 */
slv_result slvi_gl_store_make_pool(const slv_gl_source *source, slv_gl_store *store,
                                   slv_gl_pool *pool);
/* Gives back what only following changes takes. */
void slvi_gl_store_let_go(slv_gl_store *store);
void slvi_gl_store_free(const slv_gl *gl, slv_gl_store *store);

#endif
