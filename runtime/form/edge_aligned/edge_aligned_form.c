/* The edge-aligned form: every face's levels as samples of which the outermost lie on its edges. */
#include "form/faces.h"

#include "base/memory.h"
#include "form/edge_aligned/edge_aligned_data.h"

struct aligned_faces {
    slv_form_faces faces;
    slv_edge_aligned *aligned;
};

static void destroy(void *made) {
    struct aligned_faces *form = made;
    if (!form)
        return;
    slv_edge_aligned_destroy(form->aligned);
    slvi_free(form);
}

static slv_result create(const slv_env *env, const slv_levels *levels,
                         const slv_adjacency *adjacency, uint32_t border, void **out) {
    struct aligned_faces *made = NULL;
    slv_result result = slvi_alloc(env, "edge-aligned form", 1, sizeof *made, &made);
    if (!result)
        result = slvi_form_faces_begin(env, levels, adjacency, border, &made->faces);
    if (!result)
        result = slv_edge_aligned_create(env, levels, adjacency, &made->aligned);
    if (result) {
        destroy(made);
        made = NULL;
    }
    *out = made;
    return result;
}

static slv_result read_level(const void *made, uint32_t item, uint32_t level, float *scratch,
                             slv_form_texels *out) {
    const struct aligned_faces *form = made;
    (void)scratch;
    *out = (slv_form_texels){slv_edge_aligned_samples(form->aligned, item, level),
                             form->faces.desc->type};
    return SLV_OK;
}

static slv_result needs(const void *made, uint32_t item, slv_form_room *room, slv_visit_item visit,
                        void *user) {
    const slv_form_faces *faces = &((const struct aligned_faces *)made)->faces;
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

static slv_result refresh(void *made, const uint32_t *items, uint32_t count) {
    struct aligned_faces *form = made;
    return slvi_edge_aligned_refresh(form->faces.levels, form->faces.adjacency, items, count,
                                     form->aligned);
}

const slv_form *slv_form_edge_aligned(void) {
    static const slv_form form = {
        .name = "edge-aligned",
        .title = "samples on the edges of faces in place of borders",
        .item = "a face",
        .samples = true,
        .create = create,
        .destroy = destroy,
        .count = slvi_form_faces_count,
        .res = slvi_form_faces_res,
        .items = slvi_form_faces_items,
        .read = read_level,
        .read_rim = read_level,
        .stale = stale,
        .needs = needs,
        .refresh = refresh,
    };
    return &form;
}
