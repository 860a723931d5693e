/* The form of bare levels: every face as the texture has it. */
#include "form/faces.h"

static slv_result read_level(const void *made, uint32_t item, uint32_t level, float *scratch,
                             slv_form_texels *out) {
    const slv_form_faces *faces = made;
    (void)scratch;
    *out = (slv_form_texels){slv_levels_texels(faces->levels, item, level), faces->desc->type};
    return SLV_OK;
}

static slv_result stale(const void *made, const slv_form_change *changes, uint32_t count,
                        slv_form_room *room, slv_visit_item visit, void *user) {
    const slv_form_faces *faces = made;
    slvi_form_sets *sets;
    slv_result result = slvi_form_sets_of(&faces->env, room, &sets);
    for (uint32_t i = 0; !result && i < count; i++)
        if (!(result = slvi_form_check(faces, &changes[i])))
            result = slvi_face_set_add(&faces->env, &sets->around, changes[i].face);
    for (uint32_t i = 0; !result && i < sets->around.count; i++)
        result = visit(user, sets->around.faces[i]);
    return result;
}

const slv_form *slv_form_bare(void) {
    static const slv_form form = {
        .name = "bare",
        .title = "the levels of faces as they are",
        .item = "a face",
        .create = slvi_form_faces_create,
        .destroy = slvi_form_faces_destroy,
        .count = slvi_form_faces_count,
        .res = slvi_form_faces_res,
        .items = slvi_form_faces_items,
        .read = read_level,
        .stale = stale,
    };
    return &form;
}
