/* The edge-aligned form: every face's levels as samples of which the outermost lie on its edges. */
#include "form/faces.h"

#include "form/edge_aligned/edge_aligned_data.h"

#include <string.h>

enum { VALUES = 512 };

/* Rounds values to the texture's type where they are; they become shorter. */
static void round_run(slv_type type, float *values, size_t first, size_t count) {
    unsigned char rounded[VALUES * sizeof(float)];
    size_t size = slv_type_size(type);
    for (size_t at = first, n; at < first + count; at += n) {
        n = first + count - at < VALUES ? first + count - at : VALUES;
        slv_type_from_float(type, values + at, n, rounded);
        memcpy((unsigned char *)values + at * size, rounded, n * size);
    }
}

static slv_result read_level(const void *made, uint32_t item, uint32_t level, float *scratch,
                             slv_form_texels *out) {
    const slv_form_faces *faces = made;
    uint64_t count = slv_edge_aligned_count(slvi_level_res(faces->levels, item, level));
    slvi_edge_aligned_fill(faces->levels, faces->adjacency, item, level, false, scratch);
    round_run(faces->desc->type, scratch, 0, (size_t)count * faces->desc->nchannels);
    *out = (slv_form_texels){scratch, faces->desc->type};
    return SLV_OK;
}

static slv_result read_rim(const void *made, uint32_t item, uint32_t level, float *scratch,
                           slv_form_texels *out) {
    const slv_form_faces *faces = made;
    slv_type type = faces->desc->type;
    slv_res res = slvi_level_res(faces->levels, item, level);
    size_t n = faces->desc->nchannels, row = (((size_t)1 << res.u) + 1) * n;
    size_t height = ((size_t)1 << res.v) + 1;
    slvi_edge_aligned_fill(faces->levels, faces->adjacency, item, level, true, scratch);
    round_run(type, scratch, 0, row);
    for (size_t y = 1; y + 1 < height; y++) {
        round_run(type, scratch, y * row, n);
        round_run(type, scratch, (y + 1) * row - n, n);
    }
    round_run(type, scratch, (height - 1) * row, row);
    *out = (slv_form_texels){scratch, type};
    return SLV_OK;
}

static slv_result needs(const void *made, uint32_t item, slv_form_room *room, slv_visit_item visit,
                        void *user) {
    const slv_form_faces *faces = made;
    slvi_form_sets *sets;
    slv_result result = slvi_form_sets_of(&faces->env, room, &sets);
    if (!result && !(result = slvi_face_set_add(&faces->env, &sets->around, item)))
        result = slvi_form_faces_need(faces, true, &sets->around, visit, user);
    return result;
}

static slv_result stale(const void *made, const slv_form_change *changes, uint32_t count,
                        slv_form_room *room, slv_visit_item visit, void *user) {
    return slvi_form_faces_stale(made, changes, count, true, room, visit, user);
}

const slv_form *slv_form_edge_aligned(void) {
    static const slv_form form = {
        .name = "edge-aligned",
        .title = "samples on the edges of faces in place of borders",
        .item = "a face",
        .samples = true,
        .computed = true,
        .create = slvi_form_faces_create,
        .destroy = slvi_form_faces_destroy,
        .count = slvi_form_faces_count,
        .res = slvi_form_faces_res,
        .items = slvi_form_faces_items,
        .read = read_level,
        .read_rim = read_rim,
        .stale = stale,
        .needs = needs,
    };
    return &form;
}
