/* Items that get a layer elsewhere while they are drawn. */
#ifndef SLV_GL_MOVE_H
#define SLV_GL_MOVE_H

#include "gl/store/store.h"

/* Gives an item a layer among those of its resolution and type as they are now. *filler is another
 * item that has got another layer by it, or the item itself; both are to be uploaded. */
slv_result slvi_gl_move_item(const slv_gl_source *source, slv_gl_store *store, uint32_t item,
                             uint32_t *filler);
/* Tells the table of faces where an item is, if it is a face's only one. */
void slvi_gl_move_row(const slv_gl_source *source, const slv_gl_store *store, uint32_t item);
/* After items have moved: their order, and the table of levels. */
slv_result slvi_gl_move_end(const slv_gl_source *source, slv_gl_store *store);

#endif
