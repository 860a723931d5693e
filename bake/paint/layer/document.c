/* Documents: made, ended, and asked what they hold. */
#include "history/history.h"

#include "base/log.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

static slv_result check_params(const slv_env *env, const slv_document_params *params,
                               const slv_adjacency *adjacency) {
    const slv_texture_desc *flat = &params->flat;
    uint32_t room = SLV_PAINT_CHANNELS - (flat->alpha_channel < 0);
    if (!flat->nfaces || !flat->res || !flat->nchannels || (unsigned)flat->type > SLV_TYPE_FLOAT ||
        (unsigned)params->working > SLV_TYPE_FLOAT ||
        flat->alpha_channel >= (int32_t)flat->nchannels)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "document: %u faces of %u channels, type %d",
                         (unsigned)flat->nfaces, (unsigned)flat->nchannels, (int)flat->type);
    if (flat->nchannels > room)
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED,
                         "document: %u channels, and only %u can be painted on",
                         (unsigned)flat->nchannels, (unsigned)room);
    if (adjacency && slv_adjacency_face_count(adjacency) != flat->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "document: %u faces, and the adjacency has %u",
                         (unsigned)flat->nfaces, (unsigned)slv_adjacency_face_count(adjacency));
    return slvi_check_res(env, flat->nfaces, flat->nfaces, NULL, flat->res);
}

slv_result slvi_check_res(const slv_env *env, uint32_t nfaces, uint32_t count,
                          const uint32_t *faces, const slv_res *res) {
    for (uint32_t i = 0; i < count; i++) {
        uint32_t face = faces ? faces[i] : i;
        if (face >= nfaces || (faces && i && face <= faces[i - 1]))
            return slvi_fail(env, SLV_ERROR_ARGUMENT,
                             "document: face %u: there are %u, and each may be named once, in "
                             "ascending order",
                             (unsigned)face, (unsigned)nfaces);
        if (res && (res[i].u < 0 || res[i].v < 0 || res[i].u > SLV_MAX_LOG2_RES ||
                    res[i].v > SLV_MAX_LOG2_RES))
            return slvi_fail(env, SLV_ERROR_ARGUMENT,
                             "document: face %u: no resolution of 2^%d x 2^%d", (unsigned)face,
                             (int)res[i].u, (int)res[i].v);
    }
    return SLV_OK;
}

static slv_result make(const slv_env *env, const slv_document_params *params, slv_document *d) {
    const slv_texture_desc *flat = &params->flat;
    slv_result result;
    if ((result = slvi_alloc(env, "document", flat->nfaces, sizeof *d->res, &d->res)) ||
        (result = slvi_alloc(env, "document", flat->nfaces, sizeof *d->dirty, &d->dirty)) ||
        (result = slvi_alloc(env, "document", flat->nfaces, sizeof(uint32_t), &d->dirty_faces)))
        return result;
    if (params->scratch) {
        size_t size = strlen(params->scratch) + 1;
        if ((result = slvi_alloc(env, "document", size, 1, &d->history.scratch)))
            return result;
        memcpy(d->history.scratch, params->scratch, size);
    }
    memcpy(d->res, flat->res, flat->nfaces * sizeof *d->res);
    d->flat = *flat;
    d->flat.res = d->res;
    d->nchannels = flat->nchannels + (flat->alpha_channel < 0);
    d->alpha = flat->alpha_channel < 0 ? (int32_t)flat->nchannels : flat->alpha_channel;
    if (params->background)
        memcpy(d->background, params->background, flat->nchannels * sizeof *d->background);
    if (flat->alpha_channel < 0)
        d->background[d->alpha] = 1;
    d->working = params->working                                               ? params->working
                 : flat->type == SLV_TYPE_HALF || flat->type == SLV_TYPE_FLOAT ? SLV_TYPE_FLOAT
                                                                               : SLV_TYPE_U16;
    return SLV_OK;
}

slv_result slv_document_create(const slv_env *env, const slv_document_params *params,
                               const slv_adjacency *adjacency, slv_document **out) {
    slv_env found = slvi_env_or_default(env);
    slv_document *document = NULL;
    *out = NULL;
    slv_result result = check_params(&found, params, adjacency);
    if (result || (result = slvi_alloc(&found, "document", 1, sizeof *document, &document)))
        return result;
    document->env = found;
    document->adjacency = adjacency;
    document->next_id = 1;
    slvi_history_begin(&document->history, params);
    if ((result = make(&found, params, document))) {
        slv_document_destroy(document);
        return result;
    }
    *out = document;
    return SLV_OK;
}

void slv_document_destroy(slv_document *document) {
    if (!document)
        return;
    slvi_history_end(document);
    for (uint32_t i = 0; i < document->nlayers; i++)
        slvi_layer_drop(document->stack[i]);
    slvi_free(document->stack);
    slvi_document_free_handles(document);
    slv_texture_destroy(document->texture);
    slvi_free(document->selected);
    slvi_free(document->made);
    slvi_free(document->dirty);
    slvi_free(document->dirty_faces);
    slvi_free(document->res);
    slvi_free(document);
}

const slv_texture_desc *slv_document_get_desc(const slv_document *document) {
    return &document->flat;
}

uint32_t slv_document_layer_count(const slv_document *document) {
    return document->nlayers;
}

uint32_t slv_document_layer_at(const slv_document *document, uint32_t index) {
    return index < document->nlayers ? document->stack[index]->id : 0;
}

bool slv_document_layer(const slv_document *document, uint32_t id, slv_layer_info *out) {
    const slvi_layer *layer = slvi_document_find(document, id, NULL);
    if (!layer)
        return false;
    *out =
        (slv_layer_info){.id = id,
                         .props = layer->props,
                         .type = layer->colour->type,
                         .nchannels = layer->colour->nchannels,
                         .alpha_channel = layer->colour->alpha,
                         .res = layer->colour->res,
                         .has_mask = layer->mask != NULL,
                         .bytes = slvi_plane_bytes(layer->colour) + slvi_plane_bytes(layer->mask)};
    return true;
}
