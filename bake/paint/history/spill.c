/* Old entries on the disk, in a nameless file: oldest first, in a ring. */
#include "history/history.h"

#include "base/beside.h"
#include "base/file.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static slv_result open_file(slv_document *document) {
    static const slv_env silent = {0};
    slvi_history *history = &document->history;
    const char *temporary = getenv("TMPDIR"), *folder = history->scratch ? history->scratch
                                                        : temporary      ? temporary
                                                                         : "/tmp";
    char path[4096];
    if (history->file >= 0)
        return SLV_OK;
    int length = snprintf(path, sizeof path, "%s/selvage_history", folder);
    errno = ENAMETOOLONG;
    if (length < 0 || (size_t)length >= sizeof path ||
        slvi_beside_nameless(&silent, path, path, &history->file)) {
        slvi_logf(&document->env, SLV_LOG_WARNING, "%s: no history on the disk: %s", folder,
                  strerror(errno));
        return SLV_ERROR_IO;
    }
    return SLV_OK;
}

/* Where `size` bytes have room. */
static bool find_room(const slvi_history *history, uint64_t size, uint64_t *at) {
    if (!history->disk) {
        *at = 0;
        return size <= history->most_disk;
    }
    bool wrapped = history->head <= history->tail;
    *at = history->head;
    if (wrapped)
        return size <= history->tail - history->head;
    if (size <= history->most_disk - history->head)
        return true;
    *at = 0;
    return size <= history->tail;
}

/* What is on its way to the file: blocks are small, and a call of the system for each takes longer
 * than they do. */
typedef struct writing {
    int file;
    uint64_t at;
    size_t held;
    int reason;
    unsigned char room[1 << 15];
} writing;

static void flush(writing *w) {
    static const slv_env silent = {0}; /* what fails is no error of a call */
    if (!w->reason && slvi_write_at(&silent, "history", w->file, w->room, w->held, w->at))
        w->reason = errno ? errno : EIO;
    w->at += w->held;
    w->held = 0;
}

static void put(writing *w, const void *data, size_t size) {
    for (const unsigned char *from = data; size;) {
        size_t left = sizeof w->room - w->held, n = size < left ? size : left;
        memcpy(w->room + w->held, from, n);
        w->held += n;
        from += n;
        size -= n;
        if (w->held == sizeof w->room)
            flush(w);
    }
}

static void put_block(writing *w, const slvi_block *block) {
    uint32_t bytes = block ? block->bytes : 0;
    put(w, &bytes, sizeof bytes);
    if (block)
        put(w, block->texels, bytes);
}

static void put_table(writing *w, const slvi_table *table) {
    uint32_t count = table ? table->count : 0;
    put(w, &count, sizeof count);
    for (uint32_t i = 0; i < count; i++)
        put_block(w, table->blocks[i]);
}

static uint64_t size_of(const slvi_entry *entry) {
    uint64_t size = 0;
    for (uint32_t k = 0; k < entry->nchanges; k++) {
        const slvi_change *c = &entry->changes[k];
        for (uint64_t i = 0; c->blocks && i < c->count; i++)
            size += sizeof *c->blocks + sizeof(uint32_t) +
                    (c->blocks[i].block ? c->blocks[i].block->bytes : 0);
        for (uint64_t i = 0; c->faces && i < c->count; i++) {
            const slvi_table *table = c->faces[i].table;
            size += sizeof *c->faces + sizeof(uint32_t);
            for (uint32_t b = 0; table && b < table->count; b++)
                size += sizeof(uint32_t) + (table->blocks[b] ? table->blocks[b]->bytes : 0);
        }
    }
    return size;
}

/* What of a change is on the disk is not in memory. */
static void forget(slvi_change *change) {
    for (uint64_t i = 0; change->blocks && i < change->count; i++)
        slvi_block_drop(change->blocks[i].block);
    for (uint64_t i = 0; change->faces && i < change->count; i++)
        slvi_table_drop(change->faces[i].table);
    slvi_free(change->blocks);
    slvi_free(change->faces);
    change->blocks = NULL;
    change->faces = NULL;
}

static bool is_kept(const slvi_change *change) {
    return change->kind != SLVI_CHANGE_BLOCKS && change->kind != SLVI_CHANGE_FACES;
}

static void put_entry(writing *w, const slvi_entry *entry) {
    w->at = entry->at;
    for (uint32_t k = 0; k < entry->nchanges; k++) {
        const slvi_change *c = &entry->changes[k];
        for (uint64_t i = 0; c->blocks && i < c->count; i++) {
            put(w, &c->blocks[i], sizeof *c->blocks);
            put_block(w, c->blocks[i].block);
        }
        for (uint64_t i = 0; c->faces && i < c->count; i++) {
            put(w, &c->faces[i], sizeof *c->faces);
            put_table(w, c->faces[i].table);
        }
    }
    flush(w);
}

/* Blocks of entries are read by whoever likes, and changed by nobody. */
static void *write_leaving(void *user) {
    slvi_history *history = user;
    writing w;
    w.file = history->file;
    w.held = 0;
    w.reason = 0;
    for (uint64_t i = 0; i < history->leaving; i++)
        put_entry(&w, slvi_entry_at(history, history->spilled + i));
    history->reason = w.reason;
    return NULL;
}

slv_result slvi_spill_begin(slv_document *document, uint64_t bytes) {
    slvi_history *history = &document->history;
    slv_result result = open_file(document);
    for (uint64_t i = history->spilled;
         !result && i < history->done && history->bytes - history->leaving_bytes > bytes; i++) {
        slvi_entry *entry = slvi_entry_at(history, i);
        uint64_t size = size_of(entry), at;
        if (history->disk + size > history->most_disk || !find_room(history, size, &at)) {
            result = history->leaving ? SLV_OK : SLV_ERROR_LIMIT;
            break;
        }
        if (!history->disk)
            history->tail = at;
        entry->at = at;
        entry->size = size;
        history->head = at + size;
        history->disk += size;
        history->leaving++;
        history->leaving_bytes += entry->bytes;
    }
    if (result)
        return result;
    history->writer_of = getpid();
    if (slvi_thread_start(&history->writer, write_leaving, history)) {
        history->writer_of = 0;
        write_leaving(history);
    }
    return SLV_OK;
}

int slvi_spill_end(slv_document *document) {
    slvi_history *history = &document->history;
    uint64_t count = history->leaving;
    if (!count)
        return 0;
    if (history->writer_of == getpid())
        pthread_join(history->writer, NULL);
    else if (history->writer_of) /* a fork has no such thread, and the same to write there */
        write_leaving(history);
    history->writer_of = 0;
    history->leaving = history->leaving_bytes = 0;
    if (history->reason) {
        history->head = slvi_entry_at(history, history->spilled)->at;
        while (count--)
            history->disk -= slvi_entry_at(history, history->spilled + count)->size;
        return history->reason;
    }
    while (count--) {
        slvi_entry *entry = slvi_entry_at(history, history->spilled++);
        entry->spilled = true;
        for (uint32_t k = 0; k < entry->nchanges; k++)
            if (!is_kept(&entry->changes[k]))
                forget(&entry->changes[k]);
    }
    return 0;
}

typedef struct reading {
    slv_document *document;
    slv_result result;
    uint64_t at;
} reading;

static void read_bytes(reading *r, void *out, size_t size) {
    if (r->result)
        return;
    int reason = slvi_read_at(r->document->history.file, out, size, r->at);
    r->at += size;
    if (reason)
        r->result = slvi_fail(&r->document->env, slvi_io_error(reason),
                              "history: an entry cannot be read back: %s", strerror(reason));
}

static slvi_block *read_block(reading *r) {
    uint32_t bytes = 0;
    slvi_block *block = NULL;
    read_bytes(r, &bytes, sizeof bytes);
    if (r->result || !bytes ||
        (r->result = slvi_alloc(&r->document->env, "history", 1, sizeof *block + bytes, &block)))
        return NULL;
    atomic_init(&block->refs, 1);
    block->bytes = bytes;
    read_bytes(r, block->texels, bytes);
    return block;
}

static slvi_table *read_table(reading *r) {
    uint32_t count = 0;
    slvi_table *table = NULL;
    read_bytes(r, &count, sizeof count);
    if (r->result || !count ||
        (r->result = slvi_alloc(&r->document->env, "history", 1,
                                sizeof *table + count * sizeof *table->blocks, &table)))
        return NULL;
    table->count = count;
    for (uint32_t i = 0; i < count; i++)
        table->blocks[i] = read_block(r);
    return table;
}

static void read_change(reading *r, slvi_change *c) {
    const slv_env *env = &r->document->env;
    if (c->kind == SLVI_CHANGE_BLOCKS) {
        r->result = slvi_alloc(env, "history", c->count, sizeof *c->blocks, &c->blocks);
        for (uint64_t i = 0; c->blocks && i < c->count; i++) {
            slvi_old_block old = {0};
            read_bytes(r, &old, sizeof old);
            c->blocks[i] = (slvi_old_block){old.face, old.index, read_block(r)};
        }
    } else {
        r->result = slvi_alloc(env, "history", c->count, sizeof *c->faces, &c->faces);
        for (uint64_t i = 0; c->faces && i < c->count; i++) {
            slvi_old_face old = {0};
            read_bytes(r, &old, sizeof old);
            c->faces[i] = (slvi_old_face){old.face, old.res, read_table(r)};
        }
    }
}

slv_result slvi_unspill(slv_document *document, slvi_entry *entry) {
    slvi_history *history = &document->history;
    reading r = {document, SLV_OK, entry->at};
    for (uint32_t k = 0; !r.result && k < entry->nchanges; k++)
        if (!is_kept(&entry->changes[k]))
            read_change(&r, &entry->changes[k]);
    if (r.result) {
        for (uint32_t k = 0; k < entry->nchanges; k++)
            if (!is_kept(&entry->changes[k]))
                forget(&entry->changes[k]);
        return r.result;
    }
    entry->spilled = false;
    history->head = entry->at;
    history->disk -= entry->size;
    return SLV_OK;
}
