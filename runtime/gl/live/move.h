/* Items that get a layer elsewhere while they are drawn. */
#ifndef SLV_GL_MOVE_H
#define SLV_GL_MOVE_H

#include "gl/live/live.h"
#include "gl/store/store.h"

/* Gives an item a layer among those of the class `res` (slvi_gl_item_res) and its type as they are
 * now; arrays grow by *room bytes at most. `fillers` are other items that have got other layers by
 * it, or the item itself; all are to be uploaded. *clipped: it should have the wider type, but
 * there is no room for that. */
slv_result slvi_gl_move_item(const slv_gl_source *source, slv_gl_store *store, uint32_t item,
                             slv_res res, uint64_t *room, uint32_t fillers[2], bool *waits);
/* Makes sure, before a face gets another resolution, of layers for all that may have to move then:
 * the store's arrays grow now, by `room` bytes at most, and not when it moves. If it does not fit
 * the face is to stay as it is. What is reserved is let go of by the next move_end or sweep. */
slv_result slvi_gl_move_reserve(const slv_gl_live *live, slv_gl_store *store, uint32_t face,
                                slv_res res, uint64_t room, bool *fits);
/* Lets go of what is reserved, and of arrays that nothing is in any more. */
void slvi_gl_move_sweep(const slv_gl_source *source, slv_gl_store *store);
/* Whether an item is not in a pool of its class. */
bool slvi_gl_move_needed(const slv_gl_store *store, uint32_t item, slv_res res);
/* A face's row of the table of faces anew. */
void slvi_gl_move_row(const slv_gl_source *source, const slv_gl_store *store, uint32_t face);
/* After items have moved: their order, and the table of levels. */
slv_result slvi_gl_move_end(const slv_gl_source *source, slv_gl_store *store);

#endif
