/* Faces whose texels are all made anew: other resolutions, a texture put into a layer, a layer put
 * into the one below. Each is made beside the old ones, and then takes their place. */
#include "history/history.h"

#include "base/log.h"
#include "base/memory.h"

#include <string.h>

/* What makes a piece of a face, of at most SLVI_BLOCK_SIDE squared texels. */
typedef void (*piece_fn)(const void *user, uint32_t face, slv_res res, slv_rect rect, float *out);

static bool is_fill(const slvi_plane *plane, const float *texels, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (memcmp(texels + i * plane->nchannels, plane->fill, plane->nchannels * sizeof *texels))
            return false;
    return true;
}

static slv_result make_table(slv_document *document, const slvi_plane *plane, uint32_t face,
                             slv_res res, piece_fn make, const void *user, slvi_table **out) {
    float texels[SLVI_BLOCK_SIDE * SLVI_BLOCK_SIDE * SLVI_MOST_CHANNELS];
    uint64_t entry = document->history.open->serial;
    slv_result result = slvi_table_create(plane, res, out);
    for (uint32_t i = 0; !result && i < (*out)->count; i++) {
        slv_rect rect = slvi_block_rect(res, i);
        make(user, face, res, rect, texels);
        if (is_fill(plane, texels, (size_t)rect.width * rect.height))
            continue;
        if (!(result = slvi_block_create(plane, res, entry, &(*out)->blocks[i])))
            slvi_table_write(plane, res, *out, rect, entry, texels);
    }
    return result;
}

/* An empty list of at most `count` faces. */
static slv_result begin_faces(slv_document *document, slvi_plane *plane, uint64_t count,
                              slvi_change *change) {
    *change = (slvi_change){.kind = SLVI_CHANGE_FACES};
    slv_result result =
        slvi_alloc(&document->env, "history", count, sizeof *change->faces, &change->faces);
    if (!result)
        change->plane = slvi_plane_hold(plane);
    return result;
}

static slv_result add_face(slv_document *document, slvi_change *change, uint32_t face, slv_res res,
                           piece_fn make, const void *user) {
    slvi_old_face *to = &change->faces[change->count++];
    *to = (slvi_old_face){face, res, NULL};
    return make ? make_table(document, change->plane, face, res, make, user, &to->table) : SLV_OK;
}

/* ---- resolutions ---- */

typedef struct resampling {
    const slv_document *document;
    const slvi_plane *plane;
    slvi_taps *taps;
} resampling;

static void resample(const void *user, uint32_t face, slv_res res, slv_rect rect, float *out) {
    const resampling *r = user;
    slvi_plane_sample(r->plane, r->document->adjacency, face, res, rect, r->taps, out);
}

static bool same_res(slv_res a, slv_res b) {
    return a.u == b.u && a.v == b.v;
}

static slv_result resize_plane(slv_document *document, slvi_plane *plane, const slvi_op *op) {
    slvi_taps taps = {0};
    resampling r = {document, plane, &taps};
    slvi_change change;
    slv_result result = begin_faces(document, plane, op->count, &change);
    for (uint32_t i = 0; !result && i < op->count; i++) {
        uint32_t face = op->faces ? op->faces[i] : i;
        if (!same_res(plane->res[face], op->res[i]))
            result = add_face(document, &change, face, op->res[i],
                              plane->tables[face] ? resample : NULL, &r);
    }
    if (!result && change.count)
        result = slvi_change_put(document, &change);
    slvi_change_free(&change);
    return result;
}

static slv_result resize_flat(slv_document *document, const slvi_op *op) {
    slvi_change change;
    slv_result result = begin_faces(document, NULL, op->count, &change);
    for (uint32_t i = 0; !result && i < op->count; i++) {
        uint32_t face = op->faces ? op->faces[i] : i;
        if (!same_res(document->res[face], op->res[i]))
            result = add_face(document, &change, face, op->res[i], NULL, NULL);
    }
    if (!result && change.count)
        result = slvi_change_put(document, &change);
    slvi_change_free(&change);
    return result;
}

static slv_result find_unlocked(slv_document *document, uint32_t id, slvi_layer **layer,
                                uint32_t *index) {
    *layer = slvi_document_find(document, id, index);
    if (!*layer || (*layer)->props.locked)
        return slvi_fail(&document->env, SLV_ERROR_ARGUMENT,
                         *layer ? "document: layer %u is locked" : "document: there is no layer %u",
                         (unsigned)id);
    return SLV_OK;
}

uint64_t slv_document_resize_bytes(const slv_document *document, uint32_t id, uint32_t count,
                                   const uint32_t *faces, const slv_res *res) {
    const slvi_layer *layer = slvi_document_find(document, id, NULL);
    uint64_t bytes = 0, flat = slv_type_size(document->flat.type) * document->flat.nchannels;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t face = faces ? faces[i] : i;
        if (face >= document->flat.nfaces)
            continue;
        for (int mask = 0; layer && mask < 2; mask++) {
            const slvi_plane *plane = mask ? layer->mask : layer->colour;
            if (plane && plane->tables[face] && !same_res(plane->res[face], res[i]))
                bytes += (plane->texel_size << (res[i].u + res[i].v)) +
                         slvi_block_count(res[i]) * (sizeof(slvi_block) + sizeof(void *));
        }
        bytes += id ? 0 : flat << (res[i].u + res[i].v);
    }
    return bytes;
}

slv_result slv_document_resize(slv_document *document, uint32_t id, uint32_t count,
                               const uint32_t *faces, const slv_res *res) {
    slvi_layer *layer = NULL;
    slvi_op op = {.kind = SLVI_OP_RESIZE, .id = id, .count = count, .faces = faces, .res = res};
    slvi_edit edit;
    slv_result result = slvi_check_res(&document->env, document->flat.nfaces, count, faces, res);
    if (result || (id && (result = find_unlocked(document, id, &layer, NULL))))
        return result;
    uint64_t bytes = slv_document_resize_bytes(document, id, count, faces, res);
    uint64_t most = document->env.max_bytes ? document->env.max_bytes : (uint64_t)16 << 30;
    if (bytes > most)
        return slvi_fail(&document->env, SLV_ERROR_LIMIT,
                         "document: these resolutions need %llu bytes, of at most %llu",
                         (unsigned long long)bytes, (unsigned long long)most);
    if ((result = slvi_edit_begin(document, "resolution", &edit)))
        return result;
    bool mixed = document->mixed;
    document->mixed = true;
    if (!layer)
        result = resize_flat(document, &op);
    else if (!(result = resize_plane(document, layer->colour, &op)) && layer->mask)
        result = resize_plane(document, layer->mask, &op);
    if ((result = slvi_edit_end(document, &edit, &op, result)))
        document->mixed = mixed;
    return result;
}

/* ---- a texture into a layer ---- */

typedef struct loading {
    const slv_texture *texture;
    uint32_t nchannels; /* of the layer */
    int32_t alpha;
} loading;

static void load(const void *user, uint32_t face, slv_res res, slv_rect rect, float *out) {
    const loading *l = user;
    const slv_texture_desc *desc = slv_texture_get_desc(l->texture);
    const unsigned char *texels = slv_texture_texels(l->texture, face);
    const bool constant = slv_texture_is_constant(l->texture, face);
    const size_t size = slv_type_size(desc->type) * desc->nchannels;
    float row[SLVI_BLOCK_SIDE * SLVI_MOST_CHANNELS];
    for (uint32_t y = 0; y < rect.height; y++) {
        const size_t at = ((size_t)(rect.y + y) << res.u) + rect.x;
        slv_type_to_float(desc->type, texels + (constant ? 0 : at * size),
                          (size_t)desc->nchannels * (constant ? 1 : rect.width), row);
        if (constant)
            slvi_repeat(row, desc->nchannels * sizeof *row,
                        (size_t)rect.width * desc->nchannels * sizeof *row);
        for (uint32_t x = 0; x < rect.width; x++, out += l->nchannels) {
            if (desc->nchannels < l->nchannels)
                out[l->alpha] = 1;
            memcpy(out, row + (size_t)x * desc->nchannels, desc->nchannels * sizeof *out);
        }
    }
}

slv_result slv_document_load_layer(slv_document *document, uint32_t id,
                                   const slv_texture *texture) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    loading l = {texture, document->nchannels, document->alpha};
    slvi_op op = {.kind = SLVI_OP_LOAD, .id = id, .texture = texture};
    slvi_layer *layer;
    slvi_change change = {.kind = SLVI_CHANGE_FACES};
    slvi_edit edit;
    slv_result result = find_unlocked(document, id, &layer, NULL);
    if (result)
        return result;
    if (desc->nfaces != document->flat.nfaces || desc->nchannels != document->flat.nchannels ||
        desc->alpha_channel != document->flat.alpha_channel || layer->mask)
        return slvi_fail(&document->env, SLV_ERROR_MISMATCH,
                         "document: layer %u%s: a texture of %u faces, %u channels, and it has %u, "
                         "%u",
                         (unsigned)id, layer->mask ? " has a mask" : "", (unsigned)desc->nfaces,
                         (unsigned)desc->nchannels, (unsigned)document->flat.nfaces,
                         (unsigned)document->flat.nchannels);
    if ((result = slvi_edit_begin(document, "load layer", &edit)))
        return result;
    bool mixed = document->mixed;
    document->mixed |= memcmp(desc->res, document->res, desc->nfaces * sizeof *desc->res) != 0;
    result = begin_faces(document, layer->colour, desc->nfaces, &change);
    for (uint32_t face = 0; !result && face < desc->nfaces; face++)
        result = add_face(document, &change, face, desc->res[face], load, &l);
    if (!result)
        result = slvi_change_put(document, &change);
    slvi_change_free(&change);
    if ((result = slvi_edit_end(document, &edit, &op, result)))
        document->mixed = mixed;
    return result;
}

/* ---- a layer into the one below ---- */

typedef struct merging {
    const slv_document *document;
    const slvi_layer *above;
    const slvi_plane *below;
    slvi_taps *taps;
} merging;

static void merge(const void *user, uint32_t face, slv_res res, slv_rect rect, float *out) {
    const merging *m = user;
    slvi_plane_read(m->below, face, rect, out);
    slvi_layer_over(m->document, m->above, face, res, rect, m->taps, out);
}

/* Of faces of which nothing was painted there may be something through their edges. */
static bool has_paint(const merging *m, uint32_t face) {
    const slvi_plane *plane = m->above->colour;
    return plane->tables[face] || plane->filled || !same_res(plane->res[face], m->below->res[face]);
}

slv_result slv_document_merge_down(slv_document *document, uint32_t id) {
    slvi_op op = {.kind = SLVI_OP_MERGE, .id = id};
    slvi_layer *layer = slvi_document_find(document, id, &op.index), *below;
    slvi_change change = {.kind = SLVI_CHANGE_FACES};
    slvi_edit edit;
    slv_result result;
    if (!layer || !op.index)
        return slvi_fail(&document->env, SLV_ERROR_ARGUMENT,
                         layer ? "document: there is nothing below layer %u"
                               : "document: there is no layer %u",
                         (unsigned)id);
    if ((result = find_unlocked(document, document->stack[op.index - 1]->id, &below, NULL)) ||
        (result = slvi_edit_begin(document, "merge layers", &edit)))
        return result;
    slvi_taps taps = {0};
    merging m = {document, layer, below->colour, &taps};
    result = begin_faces(document, below->colour, document->flat.nfaces, &change);
    for (uint32_t face = 0; !result && !layer->props.hidden && face < document->flat.nfaces; face++)
        if (has_paint(&m, face))
            result = add_face(document, &change, face, below->colour->res[face], merge, &m);
    if (!result && change.count)
        result = slvi_change_put(document, &change);
    slvi_change_free(&change);
    if (!result)
        result = slvi_document_remove(document, op.index);
    return slvi_edit_end(document, &edit, &op, result);
}
