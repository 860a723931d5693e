/* The history: entries, undo and redo, and the limits that hold. */
#include "history/history.h"

#include "base/log.h"
#include "base/memory.h"

#include <string.h>
#include <unistd.h>

#define DEFAULT_BYTES ((uint64_t)512 << 20)
#define DEFAULT_DISK ((uint64_t)8 << 30)

static void free_entry(slvi_entry *entry) {
    if (!entry)
        return;
    for (uint32_t i = entry->nchanges; i--;)
        slvi_change_free(&entry->changes[i]);
    slvi_free(entry->changes);
    slvi_free(entry);
}

void slvi_history_begin(slvi_history *history, const slv_document_params *params) {
    history->file = -1;
    history->most_bytes = params->history_bytes ? params->history_bytes : DEFAULT_BYTES;
    history->most_disk = params->disk_bytes ? params->disk_bytes : DEFAULT_DISK;
}

void slvi_history_end(slv_document *document) {
    slvi_history *history = &document->history;
    slvi_spill_end(document);
    for (uint64_t i = 0; i < history->count; i++)
        free_entry(history->entries[history->first + i]);
    free_entry(history->open);
    slvi_free(history->entries);
    slvi_free(history->scratch);
    if (history->file >= 0)
        close(history->file);
}

static void uncount(slvi_history *history, const slvi_entry *entry) {
    history->bytes -= entry->bytes;
    history->block_bytes -= entry->block_bytes;
}

static void recount(slvi_history *history, slvi_entry *entry) {
    slvi_entry_measure(entry);
    history->bytes += entry->bytes;
    history->block_bytes += entry->block_bytes;
}

/* Forgets what can be redone, but for the next `kept`. */
static void drop_redos(slvi_history *history, uint64_t kept) {
    while (history->count > history->done + kept) {
        slvi_entry *entry = slvi_entry_at(history, --history->count);
        uncount(history, entry);
        free_entry(entry);
    }
}

/* Forgets the oldest. */
static void drop_oldest(slvi_history *history) {
    slvi_entry *entry = slvi_entry_at(history, 0);
    uncount(history, entry);
    if (entry->spilled) {
        history->spilled--;
        history->disk -= entry->size;
        history->tail = entry->at + entry->size;
    }
    free_entry(entry);
    history->first++;
    history->count--;
    history->done--;
    history->lost++;
    if (history->first > history->count) { /* so that the array is not all that was */
        memmove(history->entries, history->entries + history->first,
                history->count * sizeof *history->entries);
        history->first = 0;
    }
}

/* Waits for what is on its way to the disk, which then is in memory no more. What could not be
 * written is lost, and with it all that is older. */
static void settle(slv_document *document) {
    slvi_history *history = &document->history;
    uint64_t first = history->spilled, count = first + history->leaving;
    if (!history->leaving)
        return;
    int reason = slvi_spill_end(document);
    if (reason)
        slvi_logf(&document->env, SLV_LOG_WARNING, "history: old entries are lost: %s",
                  strerror(reason));
    for (uint64_t i = 0; reason && i < count; i++)
        drop_oldest(history);
    for (uint64_t i = first; !reason && i < count; i++) {
        uncount(history, slvi_entry_at(history, i));
        recount(history, slvi_entry_at(history, i));
    }
}

void slvi_history_forget(slv_document *document) {
    const uint64_t lost = document->history.lost;
    settle(document);
    drop_redos(&document->history, 0);
    while (document->history.done)
        drop_oldest(&document->history);
    document->history.lost = lost; /* for the limits, that is */
}

/* The oldest go to the disk, then away; where all that can be undone is there, the last to be
 * redone go. Writing begins an eighth before the limit, and by and by, so that nobody waits for it.
 */
static void keep_limits(slv_document *document) {
    slvi_history *history = &document->history;
    const uint64_t most = history->most_bytes, low = most - most / 8, high = low + most / 512;
    while (history->bytes > most || (history->bytes - history->leaving_bytes > high &&
                                     history->spilled + history->leaving < history->done)) {
        if (history->leaving) {
            settle(document);
        } else if (history->spilled < history->done) {
            while (history->disk + (history->bytes - low) > history->most_disk && history->spilled)
                drop_oldest(history);
            slv_result result = slvi_spill_begin(document, low);
            if (result && history->bytes <= most && !history->spilled)
                break;
            if (result)
                drop_oldest(history);
        } else if (history->count > history->done) {
            drop_redos(history, history->count - history->done - 1);
        } else if (history->done) {
            drop_oldest(history);
        } else {
            break;
        }
    }
}

static slv_result open_entry(slv_document *document, const char *name) {
    slvi_history *history = &document->history;
    slvi_entry *entry = NULL;
    slv_result result = SLV_OK;
    uint64_t need = history->first + history->count + 1;
    if (need > history->room) {
        uint64_t room = need + need / 2 + 16;
        settle(document); /* the array moves */
        result = slvi_grow(&document->env, "history", room, sizeof(void *), &history->entries);
        history->room = result ? history->room : room;
    }
    if (result || (result = slvi_alloc(&document->env, "history", 1, sizeof *entry, &entry)))
        return result;
    entry->serial = ++history->serial;
    strncpy(entry->name, name ? name : "", sizeof entry->name - 1);
    history->open = entry;
    return SLV_OK;
}

/* Takes back what was done after the first `changes` and, of the last of them, `last` elements. */
static void take_back(slv_document *document, uint32_t changes, uint64_t last) {
    slvi_entry *entry = document->history.open;
    document->history.open_room = 0; /* not known of the change that is now the last */
    while (entry->nchanges > changes) {
        slvi_change *change = &entry->changes[entry->nchanges - 1];
        slvi_change_swap(document, change, 0, false);
        slvi_change_free(change);
        entry->nchanges--;
    }
    slvi_change *change = changes ? &entry->changes[changes - 1] : NULL;
    if (!change || !change->blocks || change->count <= last)
        return;
    slvi_change_swap(document, change, last, false);
    while (change->count > last)
        slvi_block_drop(change->blocks[--change->count].block);
}

/* Leaves out changes of no blocks. */
static void tidy(slvi_entry *entry) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < entry->nchanges; i++)
        if (entry->changes[i].kind == SLVI_CHANGE_BLOCKS && !entry->changes[i].count)
            slvi_change_free(&entry->changes[i]);
        else
            entry->changes[kept++] = entry->changes[i];
    entry->nchanges = kept;
}

static slv_result close_entry(slv_document *document) {
    slvi_history *history = &document->history;
    slvi_entry *entry = history->open;
    slv_result result = SLV_OK;
    tidy(entry);
    if (!entry->nchanges && document->watch.cancel)
        document->watch.cancel(document->watch.user);
    if (entry->nchanges && document->watch.close &&
        (result = document->watch.close(document->watch.user, entry->name)))
        take_back(document, 0, 0);
    history->open = NULL;
    if (result || !entry->nchanges) {
        free_entry(entry);
        return result;
    }
    drop_redos(history, 0);
    history->entries[history->first + history->count++] = entry;
    history->done = history->count;
    recount(history, entry);
    keep_limits(document);
    return SLV_OK;
}

slv_result slv_document_begin(slv_document *document, const char *name) {
    if (document->history.open)
        return slvi_fail(&document->env, SLV_ERROR_ARGUMENT,
                         "document: an entry of the history is open already");
    return open_entry(document, name);
}

slv_result slv_document_end(slv_document *document) {
    if (!document->history.open)
        return slvi_fail(&document->env, SLV_ERROR_ARGUMENT,
                         "document: no entry of the history is open");
    return close_entry(document);
}

void slv_document_cancel(slv_document *document) {
    slvi_history *history = &document->history;
    if (!history->open)
        return;
    take_back(document, 0, 0);
    free_entry(history->open);
    history->open = NULL;
    if (document->watch.cancel)
        document->watch.cancel(document->watch.user);
}

slv_result slvi_edit_begin(slv_document *document, const char *name, slvi_edit *edit) {
    slvi_entry *entry = document->history.open;
    *edit = (slvi_edit){.own = !entry};
    if (!entry)
        return open_entry(document, name);
    edit->changes = entry->nchanges;
    edit->last = entry->nchanges ? entry->changes[entry->nchanges - 1].count : 0;
    return SLV_OK;
}

slv_result slvi_edit_end(slv_document *document, const slvi_edit *edit, const slvi_op *op,
                         slv_result result) {
    if (!result && op && document->watch.edit)
        result = document->watch.edit(document->watch.user, op);
    if (!result)
        return edit->own ? close_entry(document) : SLV_OK;
    take_back(document, edit->changes, edit->last);
    if (edit->own) {
        free_entry(document->history.open);
        document->history.open = NULL;
        if (document->watch.cancel)
            document->watch.cancel(document->watch.user);
    }
    return result;
}

/* Swaps an entry's changes with what is there: backwards to undo, forwards to redo. */
static void swap_entry(slv_document *document, slvi_entry *entry, bool forward) {
    for (uint32_t i = 0; i < entry->nchanges; i++)
        slvi_change_swap(document, &entry->changes[forward ? i : entry->nchanges - 1 - i], 0,
                         forward);
}

static slv_result step(slv_document *document, bool redo) {
    slvi_history *history = &document->history;
    slv_result result = SLV_OK;
    settle(document);
    if (history->open || (redo ? history->done == history->count : !history->done))
        return slvi_fail(&document->env, SLV_ERROR_ARGUMENT, "document: %s",
                         history->open ? "an entry of the history is open"
                         : redo        ? "there is nothing to redo"
                                       : "there is nothing to undo");
    slvi_entry *entry = slvi_entry_at(history, redo ? history->done : history->done - 1);
    if (entry->spilled) {
        uncount(history, entry);
        result = slvi_unspill(document, entry);
        recount(history, entry);
        if (result)
            return result;
        history->spilled--;
    }
    uncount(history, entry);
    swap_entry(document, entry, redo);
    if (document->watch.step && (result = document->watch.step(document->watch.user, redo)))
        swap_entry(document, entry, !redo);
    else
        history->done += redo ? 1 : (uint64_t)-1;
    recount(history, entry);
    keep_limits(document);
    return result;
}

slv_result slv_document_undo(slv_document *document) {
    return step(document, false);
}

slv_result slv_document_redo(slv_document *document) {
    return step(document, true);
}

const char *slv_document_history_name(const slv_document *document, uint32_t index) {
    const slvi_history *history = &document->history;
    return index < history->count ? slvi_entry_at(history, index)->name : NULL;
}

void slv_document_history(const slv_document *document, slv_history_info *out) {
    const slvi_history *history = &document->history;
    *out = (slv_history_info){.undos = (uint32_t)history->done,
                              .redos = (uint32_t)(history->count - history->done),
                              .bytes = history->bytes,
                              .block_bytes = history->block_bytes,
                              .disk_bytes = history->disk,
                              .lost = history->lost};
    if (out->undos)
        out->undo_name = slvi_entry_at(history, history->done - 1)->name;
    if (out->redos)
        out->redo_name = slvi_entry_at(history, history->done)->name;
}
