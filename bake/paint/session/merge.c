/* Two sessions over one mesh: what one has painted on faces that the other has not. */
#include "session/session_data.h"

#include "base/log.h"
#include "base/memory.h"
#include "history/history.h"

#include <string.h>

static bool same_table(const slvi_plane *a, const slvi_plane *b, uint32_t face) {
    const slvi_table *x = a->tables[face], *y = b->tables[face];
    if (a->res[face].u != b->res[face].u || a->res[face].v != b->res[face].v)
        return false;
    for (uint32_t i = 0; i < slvi_block_count(a->res[face]); i++) {
        const slvi_block *p = x ? x->blocks[i] : NULL, *q = y ? y->blocks[i] : NULL;
        if (p != q && (!p || !q || memcmp(p->texels, q->texels, p->bytes) != 0))
            return false;
    }
    return true;
}

/* Whether something is there that was painted. */
static bool is_painted(const slvi_plane *plane, uint32_t face) {
    const slvi_table *table = plane->tables[face];
    for (uint32_t i = 0; table && i < table->count; i++)
        if (table->blocks[i])
            return true;
    return false;
}

static slv_result copy_table(const slvi_plane *plane, const slvi_plane *from, uint32_t face,
                             slvi_table **out) {
    const slvi_table *table = from->tables[face];
    slv_result result = slvi_table_create(plane, from->res[face], out);
    for (uint32_t i = 0; !result && i < table->count; i++)
        if (table->blocks[i])
            result =
                slvi_block_copy(plane, from->res[face], table->blocks[i], 0, &(*out)->blocks[i]);
    return result;
}

/* The faces of a plane that `from` has painted on and it has not. */
static slv_result merge_plane(slv_session *session, slvi_plane *plane, const slvi_plane *from,
                              uint32_t layer, uint32_t *faces) {
    slv_document *document = session->document;
    slvi_change change = {.kind = SLVI_CHANGE_FACES};
    slv_result result =
        slvi_alloc(&session->env, "history", plane->nfaces, sizeof *change.faces, &change.faces);
    if (plane->type != from->type || memcmp(plane->fill, from->fill, sizeof plane->fill) != 0)
        result = slvi_fail(&session->env, SLV_ERROR_MISMATCH,
                           "%s: layer %u is of another kind in the other session", session->path,
                           (unsigned)layer);
    for (uint32_t face = 0; !result && face < plane->nfaces; face++) {
        if (!is_painted(from, face) || same_table(plane, from, face))
            continue;
        if (is_painted(plane, face)) {
            result = slvi_fail(&session->env, SLV_ERROR_MISMATCH,
                               "%s: layer %u: face %u was painted on in both sessions",
                               session->path, (unsigned)layer, (unsigned)face);
            break;
        }
        slvi_old_face *to = &change.faces[change.count++];
        *to = (slvi_old_face){face, from->res[face], NULL};
        result = copy_table(plane, from, face, &to->table);
    }
    *faces += (uint32_t)change.count;
    change.plane = slvi_plane_hold(plane);
    if (!result && change.count)
        result = slvi_change_put(document, &change);
    slvi_change_free(&change);
    return result;
}

static slv_result merge_layers(slv_session *session, const slv_document *other, uint32_t *faces) {
    slv_document *document = session->document;
    slv_result result = SLV_OK;
    for (uint32_t i = 0; !result && i < other->nlayers; i++) {
        const slvi_layer *from = other->stack[i];
        slvi_layer *to = slvi_document_find(document, from->id, NULL);
        if (!to || (from->mask && !to->mask))
            result = slvi_fail(&session->env, SLV_ERROR_MISMATCH,
                               "%s: there is no %s %u, which the other session has", session->path,
                               to ? "mask of layer" : "layer", (unsigned)from->id);
        else if (!(result = merge_plane(session, to->colour, from->colour, from->id, faces)) &&
                 from->mask)
            result = merge_plane(session, to->mask, from->mask, from->id, faces);
    }
    return result;
}

slv_result slv_session_merge(slv_session *session, const slv_session *other, uint32_t *faces) {
    slv_document *document = session->document;
    const slv_texture_desc *a = &document->flat, *b = &other->document->flat;
    uint32_t count = 0;
    slvi_edit edit;
    slv_result result = SLV_OK;
    if (a->nfaces != b->nfaces || document->nchannels != other->document->nchannels ||
        document->alpha != other->document->alpha || document->history.open)
        return slvi_fail(&session->env, SLV_ERROR_MISMATCH,
                         document->history.open
                             ? "%s: cannot be merged within an entry of its history"
                             : "%s: the other session has other faces or channels",
                         session->path);
    if ((result = slvi_edit_begin(document, "merge", &edit)))
        return result;
    bool mixed = document->mixed;
    document->mixed = true;
    session->replaying = true; /* the state that is saved has it, not the journal */
    if (!(result = merge_layers(session, other->document, &count)))
        result = slvi_session_save(session);
    result = slvi_edit_end(document, &edit, NULL, result);
    session->replaying = false;
    if (result)
        document->mixed = mixed;
    else
        slvi_history_forget(document);
    session->floor = result ? session->floor : session->state;
    if (faces)
        *faces = result ? 0 : count;
    return result;
}
