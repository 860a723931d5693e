/* The form of bare levels: every face as the texture has it. */
#include "form/faces.h"

static slv_result read_level(const void *made, uint32_t item, uint32_t level, float *scratch,
                             slv_form_texels *out) {
    const slv_form_faces *faces = made;
    (void)scratch;
    *out = (slv_form_texels){slv_levels_texels(faces->levels, item, level), faces->desc->type};
    return SLV_OK;
}

static slv_result stale(const void *made, uint32_t face, const slv_rect *rect, slv_visit_item visit,
                        void *user) {
    slv_result result = slvi_form_check_rect(made, face, rect);
    return result ? result : visit(user, face);
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
