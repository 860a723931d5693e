/* The form of levels with borders: every face's levels, each with texels of its neighbours around
 * it. */
#include "form/faces.h"

#include "form/borders/border_data.h"

#include <selvage/border.h>

static slv_result read_level(const void *made, uint32_t item, uint32_t level, float *scratch,
                             slv_form_texels *out) {
    const slv_form_faces *faces = made;
    slv_form_extent extent = slvi_form_extent(slv_form_borders(), faces->desc->res[item], level,
                                              faces->border, faces->levels->even);
    *out = (slv_form_texels){scratch, SLV_TYPE_FLOAT};
    return slv_border_build(faces->levels, faces->adjacency, item, level, extent.border_u,
                            extent.border_v, scratch, NULL);
}

static slv_result read_rim(const void *made, uint32_t item, uint32_t level, float *scratch,
                           slv_form_texels *out) {
    const slv_form_faces *faces = made;
    slv_form_extent extent = slvi_form_extent(slv_form_borders(), faces->desc->res[item], level,
                                              faces->border, faces->levels->even);
    *out = (slv_form_texels){scratch, SLV_TYPE_FLOAT};
    return slvi_border_build_rim(faces->levels, faces->adjacency, item, level, extent, scratch,
                                 NULL);
}

static bool copies(const void *made, uint32_t item) {
    const slv_form_faces *faces = made;
    bool all = true;
    for (uint32_t corner = 0; corner < 4; corner++)
        all = all && slvi_border_opposite(faces->levels, faces->adjacency, item, corner);
    return all;
}

/* Only the innermost border can leave the range of a type, so one texel of border is enough to
 * know. */
static slv_result leaves_range(const void *made, uint32_t item, float *scratch, bool *out) {
    const slv_form_faces *faces = made;
    slv_res res = faces->desc->res[item];
    slv_result result = SLV_OK;
    *out = false;
    if (faces->desc->type == SLV_TYPE_FLOAT)
        return SLV_OK;
    for (uint32_t level = 0; !result && !*out && level < slv_res_level_count(res); level++)
        result =
            slvi_border_build_rim(faces->levels, faces->adjacency, item, level,
                                  (slv_form_extent){.border_u = 1, .border_v = 1}, scratch, out);
    return result;
}

static slv_result needs(const void *made, uint32_t item, slv_form_room *room, slv_visit_item visit,
                        void *user) {
    const slv_form_faces *faces = made;
    slvi_form_sets *sets;
    slv_result result = slvi_form_sets_of(&faces->env, room, &sets);
    if (!result && !(result = slvi_face_set_add(&faces->env, &sets->around, item)))
        result = slvi_form_faces_need(faces, false, &sets->around, visit, user);
    return result;
}

static slv_result stale(const void *made, const slv_form_change *changes, uint32_t count,
                        slv_form_room *room, slv_visit_item visit, void *user) {
    return slvi_form_faces_stale(made, changes, count, false, room, visit, user);
}

const slv_form *slv_form_borders(void) {
    static const slv_form form = {
        .name = "borders",
        .title = "every level of every face with a border from its neighbours",
        .item = "a face",
        .borders = true,
        .computed = true,
        .create = slvi_form_faces_create,
        .destroy = slvi_form_faces_destroy,
        .count = slvi_form_faces_count,
        .res = slvi_form_faces_res,
        .items = slvi_form_faces_items,
        .read = read_level,
        .read_rim = read_rim,
        .copies = copies,
        .leaves_range = leaves_range,
        .stale = stale,
        .needs = needs,
    };
    return &form;
}
