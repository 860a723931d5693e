/* A painted document: layers over the faces of a mesh, and one history of all that is done to them.
 *
 *     slv_document_create(&env, &(slv_document_params){.flat = desc}, adjacency, &document);
 *     slv_document_add_layer(document, NULL, &layer);
 *     slv_document_begin(document, "stroke");           pen down
 *     slv_document_canvas(document, layer, false, &canvas);
 *     slv_painter_apply(painter, &canvas, &patches, &paint);
 *     slv_document_end(document);                       pen up
 *     slv_document_flatten(document);                   only where something was changed
 *     slv_texture *texture = slv_document_texture(document);
 *
 * Layers keep their texels in blocks of up to 32x32 texels of a face, which are shared by all that
 * hold the same (a duplicate, the history) and copied when one of them is painted on. Blocks that
 * nobody has painted are not there. An entry of the history is the blocks that were replaced.
 *
 * A document is for one thread at a time, but that the canvases it hands out may be read and
 * written by many, as slv_canvas_fns says. Every call that fails leaves the document as it was. */
#ifndef SELVAGE_DOCUMENT_H
#define SELVAGE_DOCUMENT_H

#include <selvage/canvas.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct slv_document slv_document;

/* Zero means default, but for `flat`. */
typedef struct slv_document_params {
    /* What the document is when it is flattened. Layers have its colour channels, and alpha: at the
     * same place, or else behind them. At most SLV_PAINT_CHANNELS with alpha. */
    slv_texture_desc flat;
    const float *background; /* what is below all layers, as many values as `flat` has channels;
                                NULL: zeros */
    /* Of layers that do not say: uint16, half or float. SLV_TYPE_U8, in which low opacities would
     * stick, stands for uint16 where `flat` has integers, else float. */
    slv_type working;
    uint64_t history_bytes; /* of memory; default 512 MiB. Older entries go to a nameless
                               file, which a thread writes from an eighth before that on */
    uint64_t disk_bytes;    /* of that file; default 8 GiB. Beyond it the oldest entries are lost */
    const char *scratch;    /* the folder of that file; NULL: $TMPDIR, or /tmp */
    uint64_t reserved[4];
} slv_document_params;

/* `adjacency`, which may be NULL, says what lies across edges where layers are coarser than the
 * document; it must outlive the document. Nothing is allocated for texels. */
SLV_NODISCARD SLV_API slv_result slv_document_create(const slv_env *env,
                                                     const slv_document_params *params,
                                                     const slv_adjacency *adjacency,
                                                     slv_document **out);
SLV_API void slv_document_destroy(slv_document *document);
/* With the resolutions as they are now. Owned by the document. */
SLV_API const slv_texture_desc *slv_document_get_desc(const slv_document *document);

/* ---- layers: known by ids, 1.., which are never used again ---- */

/* All of it can be set at any time. */
typedef struct slv_layer_props {
    char name[64]; /* UTF-8, cut to fit */
    float opacity; /* 0..1 */
    slv_blend blend;
    bool hidden;
    bool locked; /* cannot be painted on, merged into, or resized */
    uint64_t reserved[4];
} slv_layer_props;

/* Zero means default, but for opacity (in `props`, which NULL makes 1, visible, normal). */
typedef struct slv_layer_params {
    const slv_layer_props *props;
    uint32_t above;     /* the id of the layer to put it on; 0: the topmost. */
    slv_type type;      /* SLV_TYPE_U8: the document's working type */
    const slv_res *res; /* of each face; NULL: the document's, as it is now */
    const float *fill;  /* one texel of the layer's channels that all begin as; NULL: zeros */
    uint32_t id;        /* 0: the next; else one that was never used */
    uint64_t reserved[4];
} slv_layer_params;

typedef struct slv_layer_info {
    uint32_t id;
    slv_layer_props props;
    slv_type type;
    uint32_t nchannels;
    int32_t alpha_channel;
    const slv_res *res; /* of each face. Owned by the layer, until the next change */
    bool has_mask;
    uint64_t bytes; /* of its blocks, shared ones too */
    uint64_t reserved[4];
} slv_layer_info;

SLV_API uint32_t slv_document_layer_count(const slv_document *document);
/* Ids from the lowest up; 0 beyond the topmost. */
SLV_API uint32_t slv_document_layer_at(const slv_document *document, uint32_t index);
/* False if there is none of that id. */
SLV_API bool slv_document_layer(const slv_document *document, uint32_t id, slv_layer_info *out);

/* `params` may be NULL, `id` too. */
SLV_NODISCARD SLV_API slv_result slv_document_add_layer(slv_document *document,
                                                        const slv_layer_params *params,
                                                        uint32_t *id);
SLV_NODISCARD SLV_API slv_result slv_document_remove_layer(slv_document *document, uint32_t id);
/* To `index` from the lowest up. */
SLV_NODISCARD SLV_API slv_result slv_document_move_layer(slv_document *document, uint32_t id,
                                                         uint32_t index);
/* Right above it, sharing its blocks. `copy` may be NULL. */
SLV_NODISCARD SLV_API slv_result slv_document_duplicate_layer(slv_document *document, uint32_t id,
                                                              uint32_t *copy);
/* Puts a layer, as it shows, into the one below it, which keeps its properties, resolutions, type
 * and mask, and removes it. */
SLV_NODISCARD SLV_API slv_result slv_document_merge_down(slv_document *document, uint32_t id);
SLV_NODISCARD SLV_API slv_result slv_document_set_layer(slv_document *document, uint32_t id,
                                                        const slv_layer_props *props);
/* A mask has one channel, which the layer's alpha is multiplied by. It begins as `value`. */
SLV_NODISCARD SLV_API slv_result slv_document_add_mask(slv_document *document, uint32_t id,
                                                       float value);
SLV_NODISCARD SLV_API slv_result slv_document_remove_mask(slv_document *document, uint32_t id);

/* Puts a texture of the document's faces and channels into a layer, at the resolutions that it has:
 * those of the layer become the same. Where the layer's alpha is not among the texture's channels
 * it becomes 1. */
SLV_NODISCARD SLV_API slv_result slv_document_load_layer(slv_document *document, uint32_t id,
                                                         const slv_texture *texture);

/* ---- resolutions ---- */

/* What slv_document_resize would need, in bytes, of memory beyond what there is now. */
SLV_API uint64_t slv_document_resize_bytes(const slv_document *document, uint32_t id,
                                           uint32_t count, const uint32_t *faces,
                                           const slv_res *res);
/* Gives `count` faces of a layer (and its mask), or with id 0 of the flattened document, new
 * resolutions, one for each. Texels become means of those that they are larger than, else are
 * interpolated bilinearly, across edges. Ascending faces; NULL: faces 0..count-1. */
SLV_NODISCARD SLV_API slv_result slv_document_resize(slv_document *document, uint32_t id,
                                                     uint32_t count, const uint32_t *faces,
                                                     const slv_res *res);

/* ---- what is painted on ---- */

/* Only these faces take paint, on any layer; 0: all do. */
SLV_NODISCARD SLV_API slv_result slv_document_select(slv_document *document, uint32_t count,
                                                     const uint32_t *faces);
SLV_API bool slv_document_selected(const slv_document *document, uint32_t face);

/* A layer, or its mask, as what paint is put on: valid as long as the document, though it fails
 * while there is no such layer, or while it is locked. Outside of begin and end each dab is an
 * entry of its own. */
SLV_NODISCARD SLV_API slv_result slv_document_canvas(slv_document *document, uint32_t id, bool mask,
                                                     slv_canvas *out);

/* ---- history ---- */

/* All that is done until `end` is one entry; the name (may be NULL) is cut to 31 bytes. An entry
 * that changes nothing leaves no trace. */
SLV_NODISCARD SLV_API slv_result slv_document_begin(slv_document *document, const char *name);
SLV_NODISCARD SLV_API slv_result slv_document_end(slv_document *document);
/* Takes back all that was done since `begin`. */
SLV_API void slv_document_cancel(slv_document *document);

/* SLV_ERROR_ARGUMENT if there is nothing to undo, or inside of begin and end. */
SLV_NODISCARD SLV_API slv_result slv_document_undo(slv_document *document);
SLV_NODISCARD SLV_API slv_result slv_document_redo(slv_document *document);

typedef struct slv_history_info {
    uint32_t undos, redos;             /* how many there are */
    const char *undo_name, *redo_name; /* of the next; NULL if there is none */
    uint64_t bytes;                    /* of memory that entries hold */
    uint64_t block_bytes;              /* of it, texels */
    uint64_t disk_bytes;
    uint64_t lost; /* entries that were given up for the limits */
    uint64_t reserved[4];
} slv_history_info;
SLV_API void slv_document_history(const slv_document *document, slv_history_info *out);
/* The names of its entries, the oldest first: as many as can be undone, then those that can be
 * redone; NULL beyond them. Owned by the document, until the next change. */
SLV_API const char *slv_document_history_name(const slv_document *document, uint32_t index);

/* ---- flattened ---- */

/* Brings the flattened texture up to date where layers were changed since, on the environment's
 * threads. Colours are mixed as the layers hold them; where `flat` has no alpha, over the
 * background. */
SLV_NODISCARD SLV_API slv_result slv_document_flatten(slv_document *document);
/* As of the last slv_document_flatten; NULL before the first. It stays the same object, whose
 * changed rectangles slv_texture_changed (and so slv_gl_texture_update) tells, until the document's
 * own resolutions change. */
SLV_API slv_texture *slv_document_texture(const slv_document *document);
/* That texture as a source; the same holds. `name` (may be NULL) is for messages. */
SLV_NODISCARD SLV_API slv_result slv_document_as_source(slv_document *document, const char *name,
                                                        slv_source *out);

#ifdef __cplusplus
}
#endif

#endif
