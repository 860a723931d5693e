/* The layers of a document put over one another, where something has changed. */
#include "canvas/blend.h"
#include "layer/document_data.h"

#include "base/parallel.h"

#include <string.h>

void slvi_layer_over(const slv_document *document, const slvi_layer *layer, uint32_t face,
                     slv_res res, slv_rect rect, slvi_taps *taps, float *texels) {
    const slvi_plane *plane = layer->colour;
    float above[SLVI_BLOCK_SIDE * SLVI_BLOCK_SIDE * SLVI_MOST_CHANNELS];
    float mask[SLVI_BLOCK_SIDE * SLVI_BLOCK_SIDE];
    slv_canvas_desc desc = {plane->nfaces, plane->nchannels, plane->alpha, NULL};
    if (!slvi_plane_sample(plane, document->adjacency, face, res, rect, taps, above))
        return;
    if (layer->mask)
        slvi_plane_sample(layer->mask, document->adjacency, face, res, rect, taps, mask);
    slvi_blend_layer(&desc, layer->props.blend, layer->props.opacity, above,
                     layer->mask ? mask : NULL, (uint64_t)rect.width * rect.height, texels);
}

/* A piece of a face, flat, without what layers have beyond the document's channels. */
static void flatten_piece(const slv_document *document, uint32_t face, slv_rect rect,
                          slvi_taps *taps, unsigned char *out, size_t pitch) {
    uint32_t n = document->nchannels, kept = document->flat.nchannels;
    float texels[SLVI_BLOCK_SIDE * SLVI_BLOCK_SIDE * SLVI_MOST_CHANNELS];
    size_t count = (size_t)rect.width * rect.height,
           size = slv_type_size(document->flat.type) * kept;
    memcpy(texels, document->background, n * sizeof *texels);
    slvi_repeat(texels, n * sizeof *texels, count * n * sizeof *texels);
    for (uint32_t i = 0; i < document->nlayers; i++)
        if (!document->stack[i]->props.hidden)
            slvi_layer_over(document, document->stack[i], face, document->res[face], rect, taps,
                            texels);
    for (size_t i = 0; kept != n && i < count; i++)
        for (uint32_t c = 0; c < kept; c++) /* shorter than a call */
            texels[i * kept + c] = texels[i * n + c];
    for (uint32_t y = 0; y < rect.height; y++)
        slv_type_from_float(document->flat.type, texels + (size_t)y * rect.width * kept,
                            (size_t)rect.width * kept, out + y * pitch * size);
}

struct part {
    const slv_document *document;
    uint32_t face;
    slvi_taps *taps;
};

static void flatten_part(void *user, void *texels, size_t pitch) {
    const struct part *part = user;
    const slv_document *document = part->document;
    size_t size = slv_type_size(document->flat.type) * document->flat.nchannels;
    slv_rect rect = document->dirty[part->face];
    for (uint32_t y = 0; y < rect.height; y += SLVI_BLOCK_SIDE)
        for (uint32_t x = 0; x < rect.width; x += SLVI_BLOCK_SIDE) {
            uint32_t width = rect.width - x, height = rect.height - y;
            slv_rect piece = {rect.x + x, rect.y + y,
                              width < SLVI_BLOCK_SIDE ? width : SLVI_BLOCK_SIDE,
                              height < SLVI_BLOCK_SIDE ? height : SLVI_BLOCK_SIDE};
            flatten_piece(document, part->face, piece, part->taps,
                          (unsigned char *)texels + (y * pitch + x) * size, pitch);
        }
}

static slv_result flatten_some(void *user, uint64_t first, uint64_t end) {
    const slv_document *document = user;
    unsigned char texels[SLVI_BLOCK_SIDE * SLVI_BLOCK_SIDE * SLVI_MOST_CHANNELS * sizeof(float)];
    slvi_taps taps = {0};
    slv_result result = SLV_OK;
    for (uint64_t i = first; !result && i < end; i++) {
        struct part part = {document, document->dirty_faces[i], &taps};
        slv_rect rect = document->dirty[part.face];
        /* many at a dab's rim stay of one value, and need no room */
        if (slv_texture_is_constant(document->texture, part.face) &&
            rect.width <= SLVI_BLOCK_SIDE && rect.height <= SLVI_BLOCK_SIDE) {
            flatten_piece(document, part.face, rect, &taps, texels, rect.width);
            result = slv_texture_set_rect(document->texture, part.face, rect, texels);
        } else {
            result = slv_texture_fill_rect(document->texture, part.face, rect, flatten_part, &part);
        }
    }
    return result;
}

/* A texture of new resolutions, all of which is to be made. */
static slv_result remake(slv_document *document) {
    slv_texture *texture = NULL;
    slv_result result = slv_texture_create(&document->env, &document->flat, &texture);
    if (result)
        return result;
    slv_texture_destroy(document->texture);
    document->texture = texture;
    document->remake = false;
    while (document->ndirty) /* rectangles may be those of other resolutions */
        document->dirty[document->dirty_faces[--document->ndirty]] = (slv_rect){0};
    slvi_document_touch_all(document);
    return SLV_OK;
}

slv_result slv_document_flatten(slv_document *document) {
    slv_result result = SLV_OK;
    if ((!document->texture || document->remake) && (result = remake(document)))
        return result;
    if (!document->ndirty)
        return SLV_OK;
    /* the texture logs one line at a time, and nothing else there does */
    result = slvi_parallel_for(&document->env, document->ndirty, 1 + document->ndirty / 64,
                               flatten_some, document);
    while (!result && document->ndirty)
        document->dirty[document->dirty_faces[--document->ndirty]] = (slv_rect){0};
    return result;
}

slv_texture *slv_document_texture(const slv_document *document) {
    return document->texture;
}

slv_result slv_document_as_source(slv_document *document, const char *name, slv_source *out) {
    slv_result result = slv_document_flatten(document);
    *out = (slv_source){0};
    return result ? result
                  : slv_texture_as_source(&document->env, document->texture, document->adjacency,
                                          &(slv_texture_source_params){.name = name}, out);
}
