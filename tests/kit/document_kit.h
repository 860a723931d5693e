/* What tests of documents share: random things done to one, and one number for all that it holds.
 */
#ifndef SLV_TEST_DOCUMENT_KIT_H
#define SLV_TEST_DOCUMENT_KIT_H

#include "kit/paint_kit.h"

#include <selvage/document.h>

static inline uint64_t document_hash(uint64_t hash, const void *data, size_t size) {
    const unsigned char *bytes = data;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ bytes[i]) * UINT64_C(1099511628211);
    return hash;
}

static inline uint64_t document_hash_canvas(uint64_t hash, const slv_canvas *canvas) {
    slv_canvas_desc desc;
    MUST(canvas->fns->describe(canvas->user, &desc));
    for (uint32_t face = 0; face < desc.nfaces; face++) {
        slv_rect all = {0, 0, 1u << desc.res[face].u, 1u << desc.res[face].v};
        size_t count = (size_t)all.width * all.height * desc.nchannels;
        float *texels = malloc(count * sizeof *texels);
        MUST(canvas->fns->read(canvas->user, face, all, texels));
        hash = document_hash(hash, &desc.res[face], sizeof desc.res[face]);
        hash = document_hash(hash, texels, count * sizeof *texels);
        free(texels);
    }
    return hash;
}

/* Of everything that can be asked but the history. */
static inline uint64_t document_state(slv_document *d) {
    const slv_texture_desc *flat = slv_document_get_desc(d);
    uint64_t hash = UINT64_C(14695981039346656037);
    slv_canvas canvas;
    hash = document_hash(hash, flat->res, flat->nfaces * sizeof *flat->res);
    for (uint32_t face = 0; face < flat->nfaces; face++) {
        bool selected = slv_document_selected(d, face);
        hash = document_hash(hash, &selected, sizeof selected);
    }
    for (uint32_t i = 0; i < slv_document_layer_count(d); i++) {
        slv_layer_info info;
        uint32_t id = slv_document_layer_at(d, i);
        REQUIRE(slv_document_layer(d, id, &info));
        hash = document_hash(hash, &id, sizeof id);
        hash = document_hash(hash, info.props.name, strlen(info.props.name));
        hash = document_hash(hash, &info.props.opacity, sizeof info.props.opacity);
        unsigned char flags[4] = {(unsigned char)info.props.blend, info.props.hidden,
                                  info.props.locked, info.has_mask};
        hash = document_hash(hash, flags, sizeof flags);
        MUST(slv_document_canvas(d, id, false, &canvas));
        hash = document_hash_canvas(hash, &canvas);
        if (!info.has_mask)
            continue;
        MUST(slv_document_canvas(d, id, true, &canvas));
        hash = document_hash_canvas(hash, &canvas);
    }
    return hash;
}

static inline uint64_t document_texture_hash(const slv_texture *texture) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    uint64_t hash = 1;
    for (uint32_t face = 0; face < desc->nfaces; face++)
        for (uint32_t y = 0; y < 1u << desc->res[face].v; y++)
            for (uint32_t x = 0; x < 1u << desc->res[face].u; x++) {
                float texel[SLV_PAINT_CHANNELS];
                bool constant = slv_texture_is_constant(texture, face);
                slv_texture_fetch(texture, face, constant ? 0 : x, constant ? 0 : y, texel);
                hash = document_hash(hash, texel, desc->nchannels * sizeof *texel);
            }
    return hash;
}

/* A dab somewhere on a layer or its mask. */
static inline slv_result document_dab(slv_document *d, slv_painter *painter, uint32_t layer,
                                      bool mask, uint64_t *random) {
    slv_canvas canvas;
    slv_canvas_desc desc;
    slv_patches patches;
    slv_result result = slv_document_canvas(d, layer, mask, &canvas);
    if (result || (result = canvas.fns->describe(canvas.user, &desc)))
        return result;
    slv_dab dab = {.at = {(int32_t)(test_random(random) % desc.nfaces),
                          (float)(test_random(random) % 1000) / 1000,
                          (float)(test_random(random) % 1000) / 1000},
                   .radius = 0.05f + (float)(test_random(random) % 60) / 100,
                   .hardness = 0.5f};
    slv_paint paint = {.opacity = (float)(1 + test_random(random) % 100) / 100,
                       .blend = (slv_blend)(test_random(random) % SLV_BLEND_COUNT),
                       .erase = test_random(random) % 8 == 0};
    for (uint32_t c = 0; c < desc.nchannels; c++)
        paint.color[c] = (float)(test_random(random) % 256) / 255;
    if ((result = slv_painter_cover(painter, desc.res, &dab, &patches)))
        return result;
    return slv_painter_apply(painter, &canvas, &patches, &paint);
}

enum { DOCUMENT_ACTS = 16 };

/* One of all that can be done, with numbers that may be wrong. */
static inline slv_result document_act(slv_document *d, slv_painter *painter, uint32_t act,
                                      uint64_t *random) {
    uint32_t count = slv_document_layer_count(d), nfaces = slv_document_get_desc(d)->nfaces;
    uint32_t id = slv_document_layer_at(d, count ? test_random(random) % count : 0);
    slv_layer_props props = {.opacity = (float)(test_random(random) % 101) / 100,
                             .blend = (slv_blend)(test_random(random) % SLV_BLEND_COUNT),
                             .hidden = test_random(random) % 4 == 0,
                             .locked = test_random(random) % 8 == 0};
    uint32_t faces[3] = {0, nfaces / 2, nfaces - 1};
    slv_res res[3];
    snprintf(props.name, sizeof props.name, "layer %u", test_random(random) % 100);
    for (int i = 0; i < 3; i++)
        res[i] = (slv_res){(int8_t)(test_random(random) % 7), (int8_t)(test_random(random) % 7)};
    switch (act) {
    case 0:
        return count < 6 ? slv_document_add_layer(d, &(slv_layer_params){.props = &props}, &id)
                         : slv_document_remove_layer(d, id);
    case 1:
        return slv_document_add_layer(
            d, &(slv_layer_params){.above = id, .fill = (const float[8]){0.2f, 0.4f, 0.6f, 0.5f}},
            NULL);
    case 2:
        return count > 2 ? slv_document_remove_layer(d, id) : SLV_OK;
    case 3:
        return slv_document_move_layer(d, id, test_random(random) % (count + 1));
    case 4:
        return count < 6 ? slv_document_duplicate_layer(d, id, NULL) : SLV_OK;
    case 5:
        return count > 2 ? slv_document_merge_down(d, id) : SLV_OK;
    case 6:
        return slv_document_set_layer(d, id, &props);
    case 7:
        return slv_document_add_mask(d, id, 0.75f);
    case 8:
        return slv_document_remove_mask(d, id);
    case 9:
        return slv_document_resize(d, id, 3, nfaces > 2 ? faces : NULL, res);
    case 10:
        return slv_document_resize(d, 0, 3, nfaces > 2 ? faces : NULL, res);
    case 11:
        return slv_document_select(d, test_random(random) % 2 ? 3 : 0, faces);
    case 12:
        return document_dab(d, painter, id, true, random);
    default:
        return document_dab(d, painter, id, false, random);
    }
}

#endif
