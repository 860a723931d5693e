/* Items that get a layer elsewhere while they are drawn. */
#ifndef SLV_GL_MOVE_H
#define SLV_GL_MOVE_H

#include "gl/store/store.h"

/* Gives an item a layer among those of its resolution and type as they are now. *filler is another
 * item that has got another layer by it, or the item itself; both are to be uploaded. */
slv_result slvi_gl_move_item(const slv_gl_source *source, slv_gl_store *store, uint32_t item,
                             uint32_t *filler);
/* Whether an item is in a pool of its class. */
bool slvi_gl_move_needed(const slv_gl_store *store, uint32_t item);
/* A face's row of the table of faces anew. */
void slvi_gl_move_row(const slv_gl_source *source, const slv_gl_store *store, uint32_t face);
/* After items have moved: their order, and the table of levels. */
slv_result slvi_gl_move_end(const slv_gl_source *source, slv_gl_store *store);

#endif
