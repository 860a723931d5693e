/* What is done to the stack of layers, their properties and masks, and the selection: each is a
 * change of the history. */
#include "history/history.h"

#include "base/log.h"
#include "base/memory.h"

#include <string.h>

static slv_result find(slv_document *document, uint32_t id, slvi_layer **layer, uint32_t *index) {
    *layer = slvi_document_find(document, id, index);
    return *layer ? SLV_OK
                  : slvi_fail(&document->env, SLV_ERROR_ARGUMENT, "document: there is no layer %u",
                              (unsigned)id);
}

static slv_result check_props(slv_document *document, const slv_layer_props *props) {
    if (!(props->opacity >= 0 && props->opacity <= 1) || (unsigned)props->blend >= SLV_BLEND_COUNT)
        return slvi_fail(&document->env, SLV_ERROR_ARGUMENT,
                         "document: a layer of opacity %g, blend mode %d", (double)props->opacity,
                         (int)props->blend);
    return SLV_OK;
}

/* Ends names with a zero, and nothing behind it. */
static slv_layer_props clean(const slv_layer_props *props) {
    slv_layer_props out = *props;
    memset(out.name, 0, sizeof out.name);
    memcpy(out.name, props->name, strnlen(props->name, sizeof out.name - 1));
    while (out.name[0] && (out.name[strlen(out.name) - 1] & 0xc0) == 0x80 &&
           strlen(out.name) == sizeof out.name - 1)
        out.name[strlen(out.name) - 1] = 0; /* no part of a character */
    return out;
}

/* The stack without the layer at `without` (the count: none), and `with` at `at`. */
static slv_result put_stack(slv_document *document, uint32_t without, slvi_layer *with,
                            uint32_t at) {
    slvi_change change = {.kind = SLVI_CHANGE_STACK};
    uint32_t count = document->nlayers, kept = 0;
    slv_result result = slvi_alloc(&document->env, "document", count + (uint64_t)1,
                                   sizeof *change.stack, &change.stack);
    if (result)
        return result;
    for (uint32_t i = 0; i <= count; i++) {
        if (kept == at && with) {
            change.stack[kept++] = with;
            with->refs++;
        }
        if (i < count && i != without) {
            change.stack[kept++] = document->stack[i];
            document->stack[i]->refs++;
        }
    }
    change.count = kept;
    result = slvi_change_put(document, &change);
    slvi_change_free(&change);
    return result;
}

slv_result slvi_document_remove(slv_document *document, uint32_t index) {
    return put_stack(document, index, NULL, 0);
}

static slv_result make_layer(slv_document *document, const slv_layer_params *p, uint32_t id,
                             slvi_layer **out) {
    const slv_layer_props plain = {.opacity = 1};
    slv_texture_desc desc = document->flat;
    slv_result result = slvi_alloc(&document->env, "layer", 1, sizeof **out, out);
    if (result)
        return result;
    desc.type = p->type ? p->type : document->working;
    desc.nchannels = document->nchannels;
    desc.alpha_channel = document->alpha;
    desc.res = p->res ? p->res : document->res;
    (*out)->refs = 1;
    (*out)->id = id;
    (*out)->props = clean(p->props ? p->props : &plain);
    return slvi_plane_create(&document->env, &desc, p->fill, &(*out)->colour);
}

static slv_result check_id(slv_document *document, uint32_t id) {
    if (id && (id < document->next_id || id == UINT32_MAX))
        return slvi_fail(&document->env, SLV_ERROR_ARGUMENT, "document: layer %u has been there",
                         (unsigned)id);
    return SLV_OK;
}

slv_result slv_document_add_layer(slv_document *document, const slv_layer_params *params,
                                  uint32_t *id) {
    static const slv_layer_params plain = {0};
    const slv_layer_params *p = params ? params : &plain;
    slvi_layer *layer = NULL, *below = NULL;
    uint32_t at = document->nlayers, next = p->id ? p->id : document->next_id;
    slvi_edit edit;
    slv_result result = check_id(document, p->id);
    if (result || (p->props && (result = check_props(document, p->props))) ||
        (p->res && (result = slvi_check_res(&document->env, document->flat.nfaces,
                                            document->flat.nfaces, NULL, p->res))))
        return result;
    if ((unsigned)p->type > SLV_TYPE_FLOAT)
        return slvi_fail(&document->env, SLV_ERROR_ARGUMENT, "document: a layer of type %d",
                         (int)p->type);
    if (p->above) {
        if ((result = find(document, p->above, &below, &at)))
            return result;
        at++;
    }
    if ((result = slvi_edit_begin(document, "add layer", &edit)))
        return result;
    bool mixed = document->mixed;
    document->mixed |= p->res != NULL;
    if (!(result = make_layer(document, p, next, &layer)))
        result = put_stack(document, document->nlayers, layer, at);
    document->next_id = result ? document->next_id : next + 1;
    slvi_op op = {.kind = SLVI_OP_ADD,
                  .id = next,
                  .other = p->above,
                  .res = p->res,
                  .fill = p->fill,
                  .count = document->nchannels};
    if (!result) {
        op.props = layer->props;
        op.type = layer->colour->type;
    }
    if ((result = slvi_edit_end(document, &edit, &op, result)))
        document->mixed = mixed;
    slvi_layer_drop(layer);
    if (id)
        *id = next;
    return result;
}

slv_result slv_document_remove_layer(slv_document *document, uint32_t id) {
    slvi_layer *layer;
    slvi_edit edit;
    uint32_t index;
    slvi_op op = {.kind = SLVI_OP_REMOVE, .id = id};
    slv_result result = find(document, id, &layer, &index);
    if (result || (result = slvi_edit_begin(document, "remove layer", &edit)))
        return result;
    return slvi_edit_end(document, &edit, &op, slvi_document_remove(document, index));
}

slv_result slv_document_move_layer(slv_document *document, uint32_t id, uint32_t to) {
    slvi_layer *layer;
    slvi_edit edit;
    uint32_t index;
    slvi_op op = {.kind = SLVI_OP_MOVE, .id = id, .index = to};
    slv_result result = find(document, id, &layer, &index);
    if (result)
        return result;
    if (to >= document->nlayers)
        return slvi_fail(&document->env, SLV_ERROR_ARGUMENT, "document: place %u of %u layers",
                         (unsigned)to, (unsigned)document->nlayers);
    if (index == to)
        return SLV_OK;
    if ((result = slvi_edit_begin(document, "move layer", &edit)))
        return result;
    return slvi_edit_end(document, &edit, &op, put_stack(document, index, layer, to));
}

static slv_result copy_layer(slv_document *document, const slvi_layer *layer, uint32_t id,
                             slvi_layer **out) {
    slv_result result = slvi_alloc(&document->env, "layer", 1, sizeof **out, out);
    if (result)
        return result;
    (*out)->refs = 1;
    (*out)->id = id;
    (*out)->props = layer->props;
    if ((result = slvi_plane_share(layer->colour, &(*out)->colour)))
        return result;
    return layer->mask ? slvi_plane_share(layer->mask, &(*out)->mask) : SLV_OK;
}

slv_result slvi_document_duplicate(slv_document *document, uint32_t id, uint32_t as,
                                   uint32_t *copy) {
    slvi_layer *layer, *other = NULL;
    slvi_edit edit;
    uint32_t index, next = as ? as : document->next_id;
    slvi_op op = {.kind = SLVI_OP_DUPLICATE, .id = id, .other = next};
    slv_result result = find(document, id, &layer, &index);
    if (result || (result = check_id(document, as)) ||
        (result = slvi_edit_begin(document, "duplicate layer", &edit)))
        return result;
    if (!(result = copy_layer(document, layer, next, &other)))
        result = put_stack(document, document->nlayers, other, index + 1);
    document->next_id = result ? document->next_id : next + 1;
    result = slvi_edit_end(document, &edit, &op, result);
    slvi_layer_drop(other);
    if (copy)
        *copy = next;
    return result;
}

slv_result slv_document_duplicate_layer(slv_document *document, uint32_t id, uint32_t *copy) {
    return slvi_document_duplicate(document, id, 0, copy);
}

/* Gives a layer other properties, and another mask, which it takes. */
static slv_result put_props(slv_document *document, slvi_layer *layer, const slv_layer_props *props,
                            slvi_plane *mask) {
    slvi_change change = {.kind = SLVI_CHANGE_LAYER, .layer = layer, .props = *props, .mask = mask};
    layer->refs++;
    slv_result result = slvi_change_put(document, &change);
    slvi_change_free(&change);
    return result;
}

slv_result slv_document_set_layer(slv_document *document, uint32_t id,
                                  const slv_layer_props *props) {
    slvi_layer *layer;
    slvi_edit edit;
    slv_result result = find(document, id, &layer, NULL);
    if (result || (result = check_props(document, props)))
        return result;
    slvi_op op = {.kind = SLVI_OP_SET, .id = id, .props = clean(props)};
    if ((result = slvi_edit_begin(document, "layer", &edit)))
        return result;
    return slvi_edit_end(document, &edit, &op,
                         put_props(document, layer, &op.props, slvi_plane_hold(layer->mask)));
}

slv_result slv_document_add_mask(slv_document *document, uint32_t id, float value) {
    slvi_layer *layer;
    slvi_plane *mask = NULL;
    slvi_edit edit;
    slvi_op op = {.kind = SLVI_OP_ADD_MASK, .id = id, .value = value};
    slv_result result = find(document, id, &layer, NULL);
    if (result)
        return result;
    if (layer->mask || !(value >= 0 && value <= 1))
        return slvi_fail(&document->env, SLV_ERROR_ARGUMENT,
                         layer->mask ? "document: layer %u has a mask already"
                                     : "document: layer %u: a mask begins as 0 to 1",
                         (unsigned)id);
    if ((result = slvi_edit_begin(document, "add mask", &edit)))
        return result;
    slv_texture_desc desc = {.nfaces = document->flat.nfaces,
                             .type = layer->colour->type,
                             .nchannels = 1,
                             .alpha_channel = SLV_NO_ALPHA,
                             .res = layer->colour->res};
    if (!(result = slvi_plane_create(&document->env, &desc, &value, &mask)))
        result = put_props(document, layer, &layer->props, mask);
    return slvi_edit_end(document, &edit, &op, result);
}

slv_result slv_document_remove_mask(slv_document *document, uint32_t id) {
    slvi_layer *layer;
    slvi_edit edit;
    slvi_op op = {.kind = SLVI_OP_REMOVE_MASK, .id = id};
    slv_result result = find(document, id, &layer, NULL);
    if (result)
        return result;
    if (!layer->mask)
        return slvi_fail(&document->env, SLV_ERROR_ARGUMENT, "document: layer %u has no mask",
                         (unsigned)id);
    if ((result = slvi_edit_begin(document, "remove mask", &edit)))
        return result;
    return slvi_edit_end(document, &edit, &op, put_props(document, layer, &layer->props, NULL));
}

slv_result slv_document_select(slv_document *document, uint32_t count, const uint32_t *faces) {
    slvi_change change = {.kind = SLVI_CHANGE_SELECTION,
                          .count = (document->flat.nfaces + 63) / 64};
    slvi_op op = {.kind = SLVI_OP_SELECT, .count = count, .faces = faces};
    slvi_edit edit;
    slv_result result = slvi_check_res(&document->env, document->flat.nfaces, count, faces, NULL);
    if (result || (result = slvi_edit_begin(document, "select", &edit)))
        return result;
    if (count)
        result =
            slvi_alloc(&document->env, "document", change.count, sizeof(uint64_t), &change.bits);
    for (uint32_t i = 0; !result && i < count; i++) {
        uint32_t face = faces ? faces[i] : i;
        change.bits[face / 64] |= (uint64_t)1 << face % 64;
    }
    if (!result)
        result = slvi_change_put(document, &change);
    slvi_change_free(&change);
    return slvi_edit_end(document, &edit, &op, result);
}
