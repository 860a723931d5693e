/* Entries of the history: what a document was before each. */
#ifndef SLV_PAINT_HISTORY_H
#define SLV_PAINT_HISTORY_H

#include "layer/document_data.h"

void slvi_history_begin(slvi_history *history, const slv_document_params *params);
void slvi_history_end(slv_document *document);
/* Nothing can be undone or redone any more. */
void slvi_history_forget(slv_document *document);

/* Begins something within the open entry, or in one of its own. */
slv_result slvi_edit_begin(slv_document *document, const char *name, slvi_edit *edit);
/* Ends it: with another result than SLV_OK, or if the watcher fails (which is told `op`, unless it
 * is NULL), all that was done since is taken back. */
slv_result slvi_edit_end(slv_document *document, const slvi_edit *edit, const slvi_op *op,
                         slv_result result);

/* Swaps a change that holds what is to be with what is there, and puts it into the open entry: then
 * it is zeroed. */
slv_result slvi_change_put(slv_document *document, slvi_change *change);
/* Room for `count` more blocks of a plane. */
slv_result slvi_change_room_blocks(slv_document *document, slvi_plane *plane, uint64_t count);
/* Puts a block in the place of another, which goes into the open entry. Takes it. */
void slvi_change_block(slv_document *document, slvi_plane *plane, uint32_t face, uint32_t index,
                       slvi_block *block);

/* Swaps what a change holds with what the document has. */
void slvi_change_swap(slv_document *document, slvi_change *change, uint64_t from, bool forward);
void slvi_change_free(slvi_change *change);
/* Of memory that an entry holds. */
void slvi_entry_measure(slvi_entry *entry);
static inline slvi_entry *slvi_entry_at(const slvi_history *history, uint64_t i) {
    return history->entries[history->first + i];
}

/* The file that old entries go to. `begin` lets a thread write the oldest that are not there yet,
 * until no more than `bytes` stay in memory; they count there until `end`, which waits for it
 * (nothing if there is none), and until then the array of entries stays where it is.
 * SLV_ERROR_LIMIT where the file has no room. The end returns 0, or errno: then they are as they
 * were. */
slv_result slvi_spill_begin(slv_document *document, uint64_t bytes);
int slvi_spill_end(slv_document *document);
slv_result slvi_unspill(slv_document *document, slvi_entry *entry);

#endif
