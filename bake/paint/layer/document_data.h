/* The inside of a document. */
#ifndef SLV_PAINT_DOCUMENT_DATA_H
#define SLV_PAINT_DOCUMENT_DATA_H

#include "layer/plane.h"

#include <selvage/document.h>

#include <pthread.h>
#include <sys/types.h>

typedef struct slvi_layer {
    uint32_t refs; /* the stack, and entries of the history */
    uint32_t id;
    slv_layer_props props;
    slvi_plane *colour, *mask; /* mask may be NULL */
} slvi_layer;

/* What was there before a change; undoing swaps it with what is there now, and so does redoing. */
typedef enum slvi_change_kind {
    SLVI_CHANGE_BLOCKS,
    SLVI_CHANGE_FACES, /* resolution and table of a plane's faces; of the document's, without plane
                        */
    SLVI_CHANGE_STACK,
    SLVI_CHANGE_LAYER, /* properties and mask */
    SLVI_CHANGE_SELECTION
} slvi_change_kind;

typedef struct slvi_old_block {
    uint32_t face, index;
    slvi_block *block;
} slvi_old_block;

typedef struct slvi_old_face {
    uint32_t face;
    slv_res res;
    slvi_table *table;
} slvi_old_face;

typedef struct slvi_change {
    slvi_change_kind kind;
    slvi_plane *plane;
    slvi_layer *layer;
    uint64_t count; /* of the list, which is one of the four */
    slvi_old_block *blocks;
    slvi_old_face *faces;
    slvi_layer **stack;
    uint64_t *bits;
    slv_layer_props props;
    slvi_plane *mask;
} slvi_change;

typedef struct slvi_entry {
    uint64_t serial;
    char name[32];
    slvi_change *changes;
    uint32_t nchanges;
    uint64_t bytes, block_bytes;
    bool spilled; /* blocks and faces are in the file */
    uint64_t at, size;
} slvi_entry;

typedef struct slvi_history {
    slvi_entry **entries; /* first..first + count - 1; the first `done` of them can be undone */
    uint64_t first, count, done, room;
    uint64_t spilled; /* so many of them, the oldest, are in the file */
    uint64_t bytes, block_bytes, lost, serial;
    uint64_t most_bytes, most_disk;
    slvi_entry *open;
    uint64_t open_room; /* of the last change's list */
    int file;           /* -1: none yet */
    uint64_t head, tail, disk;
    char *scratch;
    /* what a thread is writing to the file: so many after those that are in it */
    uint64_t leaving, leaving_bytes; /* these of memory */
    pthread_t writer;
    pid_t writer_of; /* the process that has the thread; 0: there is none */
    int reason;      /* errno of what could not be written */
} slvi_history;

/* One thing that was done, for those who keep a journal. */
typedef enum slvi_op_kind {
    SLVI_OP_ADD,
    SLVI_OP_REMOVE,
    SLVI_OP_MOVE,
    SLVI_OP_DUPLICATE,
    SLVI_OP_MERGE,
    SLVI_OP_SET,
    SLVI_OP_ADD_MASK,
    SLVI_OP_REMOVE_MASK,
    SLVI_OP_RESIZE,
    SLVI_OP_SELECT,
    SLVI_OP_LOAD,
    SLVI_OP_COUNT
} slvi_op_kind;

typedef struct slvi_op {
    slvi_op_kind kind;
    uint32_t id, other, index; /* the layer; the copy, or the one below a new one; its place */
    float value;
    slv_layer_props props;
    slv_type type;
    const slv_res *res; /* NULL, or of nfaces faces */
    const float *fill;
    uint32_t count; /* of `faces`, and with RESIZE of `res` */
    const uint32_t *faces;
    const slv_texture *texture;
} slvi_op;

/* Who is told of all that is done. A failure takes it back. `edit` comes after each thing, `close`
 * at the end of an entry, `step` after an undo or redo; `paint` before texels of a layer change. */
typedef struct slvi_watch {
    slv_result (*edit)(void *user, const slvi_op *op);
    slv_result (*close)(void *user, const char *name);
    slv_result (*step)(void *user, bool redo);
    slv_result (*paint)(void *user, uint32_t layer, bool mask);
    void (*cancel)(void *user); /* what was told since the last `close` was taken back */
    void *user;
} slvi_watch;

typedef struct slvi_handle slvi_handle;

struct slv_document {
    slv_env env;
    const slv_adjacency *adjacency; /* or NULL */
    slv_texture_desc flat;          /* its `res` is the array below */
    slv_res *res;
    uint32_t nchannels; /* of layers */
    int32_t alpha;
    float background[SLVI_MOST_CHANNELS];
    slv_type working;
    slvi_layer **stack; /* from the lowest up */
    uint32_t nlayers, next_id;
    uint64_t *selected; /* bits; NULL: all */
    slvi_history history;
    slvi_handle *handles;
    slvi_watch watch;
    /* what is to be flattened: a rectangle of each face that is listed */
    slv_rect *dirty;
    uint32_t *dirty_faces;
    uint32_t ndirty;
    slv_texture *texture;
    bool remake; /* resolutions have changed */
    /* used again from dab to dab */
    slvi_old_block *made;
    uint64_t made_room;
    bool mixed; /* resolutions of a layer may differ from the document's */
};

/* What is being done within an entry, its own if none was begun. */
typedef struct slvi_edit {
    bool own;
    uint32_t changes;
    uint64_t last; /* of the last change's list */
} slvi_edit;

void slvi_layer_drop(slvi_layer *layer); /* may be NULL */
slvi_layer *slvi_document_find(const slv_document *document, uint32_t id, uint32_t *index);

void slvi_document_free_handles(slv_document *document);
/* Within an edit. */
slv_result slvi_document_remove(slv_document *document, uint32_t index);
/* As an id that was never used, or 0. */
slv_result slvi_document_duplicate(slv_document *document, uint32_t id, uint32_t as,
                                   uint32_t *copy);
/* Whether `faces` (NULL: 0..count-1) ascend, and `res` (may be NULL) can be. */
slv_result slvi_check_res(const slv_env *env, uint32_t nfaces, uint32_t count,
                          const uint32_t *faces, const slv_res *res);

/* Texels of a plane at `rect`, of its own resolution there, show otherwise. */
void slvi_document_touch(slv_document *document, const slvi_plane *plane, uint32_t face,
                         slv_rect rect);
/* All that a layer has. */
void slvi_document_touch_layer(slv_document *document, const slvi_layer *layer);
void slvi_document_touch_all(slv_document *document);

/* Texels of a plane beyond the edges of faces, kept from piece to piece while neither the plane nor
 * the resolutions wanted change: of another resolution each may be the mean of a million. */
typedef struct slvi_tap {
    const slvi_plane *plane; /* NULL: none yet */
    uint32_t face;
    int32_t x, y;
    bool any;
    float texel[SLVI_MOST_CHANNELS];
} slvi_tap;

enum { SLVI_TAPS = 128 };
typedef struct slvi_taps {
    slvi_tap list[SLVI_TAPS];
} slvi_taps;

/* A rectangle of a face at a resolution, of a plane that may have another: at most SLVI_BLOCK_SIDE
 * squared. Whether there is anything to be seen: else all are zero. `taps` are zeros at first. */
bool slvi_plane_sample(const slvi_plane *plane, const slv_adjacency *adjacency, uint32_t face,
                       slv_res res, slv_rect rect, slvi_taps *taps, float *out);
/* Such a piece of a layer over texels of the document's layers' channels. */
void slvi_layer_over(const slv_document *document, const slvi_layer *layer, uint32_t face,
                     slv_res res, slv_rect rect, slvi_taps *taps, float *texels);

#endif
