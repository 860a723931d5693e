/* The half-edge form: a square for each edge of the mesh in place of a texture for each face. */
#include "form/faces.h"

#include "base/memory.h"
#include "form/htex/htex_data.h"

#include <string.h>

/* Of two polygons with two sub-faces each. */
enum { SIDES = 4 };
#define NONE UINT32_MAX

struct squares {
    slv_form_faces faces;
    slv_htex *htex;
    slv_htex_again *again;    /* NULL until something is refreshed */
    uint32_t (*sides)[SIDES]; /* per square: the faces that have a part of it, and NONE */
};

/* Puts down which faces have parts of which squares. */
static slv_result list_sides(const slv_env *env, struct squares *form) {
    uint32_t nedges = slv_htex_edge_count(form->htex);
    slv_result result = slvi_alloc(env, "squares", nedges, sizeof *form->sides, &form->sides);
    if (result)
        return result;
    memset(form->sides, 0xff, nedges * sizeof *form->sides);
    for (uint32_t face = 0; face < form->faces.desc->nfaces; face++) {
        slv_htex_face row = slv_htex_get_face(form->htex, face);
        for (uint32_t k = 0; k < 4; k++) {
            uint32_t *sides = form->sides[row.edge[k]], i = 0;
            while (i < SIDES && sides[i] != NONE && sides[i] != face)
                i++;
            if (i < SIDES && (!row.part || k == 1 || k == 2))
                sides[i] = face;
        }
    }
    return SLV_OK;
}

static void destroy(void *made) {
    struct squares *form = made;
    if (!form)
        return;
    slvi_htex_again_destroy(form->again);
    slvi_free(form->sides);
    slv_htex_destroy(form->htex);
    slvi_free(form);
}

static slv_result create(const slv_env *env, const slv_levels *levels,
                         const slv_adjacency *adjacency, uint32_t border, void **out) {
    struct squares *made = NULL;
    slv_result result = slvi_alloc(env, "half-edge form", 1, sizeof *made, &made);
    if (!result)
        result = slvi_form_faces_begin(env, levels, adjacency, border, &made->faces);
    if (!result)
        result = slv_htex_create(env, levels, adjacency, &made->htex);
    if (!result)
        result = list_sides(env, made);
    if (result) {
        destroy(made);
        made = NULL;
    }
    *out = made;
    return result;
}

static uint32_t count(const void *made) {
    return slv_htex_edge_count(((const struct squares *)made)->htex);
}

static slv_res res_of(const void *made, uint32_t item) {
    int8_t log2 = (int8_t)slv_htex_log2(((const struct squares *)made)->htex, item);
    return (slv_res){log2, log2};
}

static uint32_t items_of(const void *made, uint32_t face, uint32_t out[SLV_FORM_ITEMS]) {
    slv_htex_face row = slv_htex_get_face(((const struct squares *)made)->htex, face);
    for (uint32_t k = 0; k < 4; k++)
        out[k] = row.edge[k];
    return 4;
}

static slv_result read_level(const void *made, uint32_t item, uint32_t level, float *scratch,
                             slv_form_texels *out) {
    const struct squares *form = made;
    (void)scratch;
    *out = (slv_form_texels){slv_htex_texels(form->htex, item, level), form->faces.desc->type};
    return SLV_OK;
}

/* Whether a rectangle is so far inside that no other face's level 0 can tell: a neighbour reads the
 * outermost texels of a level that has texels as large as its own. `around` are the faces that
 * could. Oblong ones make levels meet that are further apart. */
static bool is_inside(const slv_form_faces *faces, const slv_face_set *around, uint32_t face,
                      const slv_rect *rect) {
    slv_res res = faces->desc->res[face];
    int least = res.u;
    uint32_t width = 1u << res.u, height = 1u << res.v;
    for (uint32_t i = 0; i < around->count; i++) {
        slv_res other = faces->desc->res[around->faces[i]];
        least = other.u < least ? other.u : least;
        if (other.u != other.v)
            return false;
    }
    uint32_t margin = 2u << (res.u - least);
    return rect->x >= margin && rect->y >= margin && width - rect->x - rect->width >= margin &&
           height - rect->y - rect->height >= margin;
}

/* Whether texels of a rectangle reach into the triangle of a whole quad's edge. */
static bool in_triangle(slv_res res, const slv_rect *rect, uint32_t edge) {
    double w = (double)(1u << res.u), h = (double)(1u << res.v);
    /* bilinear interpolation spreads them by half a texel; the rest is for rounding */
    double low[2] = {(rect->x - 0.75) / w, (rect->y - 0.75) / h};
    double high[2] = {(rect->x + rect->width + 0.75) / w, (rect->y + rect->height + 0.75) / h};
    uint32_t along = edge & 1;
    double from = edge == 0 || edge == 3 ? low[!along] : 1 - high[!along];
    double nearest = low[along] > 0.5 ? low[along] : high[along] < 0.5 ? high[along] : 0.5;
    return from <= nearest && from <= 1 - nearest;
}

/* The squares that a face has a part of; `rect` (may be NULL) of which texels are another. */
static slv_result add_squares(const struct squares *form, uint32_t face, const slv_rect *rect,
                              slv_face_set *out) {
    slv_htex_face row = slv_htex_get_face(form->htex, face);
    slv_res res = form->faces.desc->res[face];
    slv_result result = SLV_OK;
    for (uint32_t k = 0; !result && k < 4; k++)
        if (row.part ? k == 1 || k == 2 : !rect || in_triangle(res, rect, k))
            result = slvi_face_set_add(&form->faces.env, out, row.edge[k]);
    return result;
}

static slv_result stale(const void *made, const slv_form_change *changes, uint32_t nchanges,
                        slv_form_room *room, slv_visit_item visit, void *user) {
    const struct squares *form = made;
    slvi_form_sets *sets;
    slv_result result = slvi_form_sets_of(&form->faces.env, room, &sets);
    for (uint32_t n = 0; !result && n < nchanges; n++) {
        const slv_form_change *change = &changes[n];
        slvi_face_set_clear(&sets->around);
        result = slvi_form_faces_around(&form->faces, change, 1, false, &sets->around);
        bool inside =
            !result && is_inside(&form->faces, &sets->around, change->face, &change->rect);
        if (inside)
            result = add_squares(form, change->face, &change->rect, &sets->items);
        for (uint32_t i = 0; !result && !inside && i < sets->around.count; i++)
            result = add_squares(form, sets->around.faces[i], NULL, &sets->items);
    }
    for (uint32_t i = 0; !result && i < sets->items.count; i++)
        result = visit(user, sets->items.faces[i]);
    return result;
}

static slv_result needs(const void *made, uint32_t item, slv_form_room *room, slv_visit_item visit,
                        void *user) {
    const struct squares *form = made;
    slvi_form_sets *sets;
    slv_result result = slvi_form_sets_of(&form->faces.env, room, &sets);
    for (uint32_t i = 0; !result && i < SIDES && form->sides[item][i] != NONE; i++)
        result = slvi_face_set_add(&form->faces.env, &sets->around, form->sides[item][i]);
    if (!result)
        result = slvi_form_faces_need(&form->faces, false, &sets->around, visit, user);
    return result;
}

static slv_result refresh(void *made, const uint32_t *items, uint32_t nitems) {
    struct squares *form = made;
    const slv_form_faces *faces = &form->faces;
    slv_result result = SLV_OK;
    if (!form->again)
        result = slvi_htex_again_create(&faces->env, faces->adjacency, form->htex, &form->again);
    return result ? result
                  : slvi_htex_refresh(form->again, faces->levels, faces->adjacency, items, nitems,
                                      form->htex);
}

const slv_form *slv_form_htex(void) {
    static const slv_form form = {
        .name = "htex",
        .title = "a square for each edge, shared by the faces on both sides",
        .item = "an edge's square",
        .create = create,
        .destroy = destroy,
        .count = count,
        .res = res_of,
        .items = items_of,
        .read = read_level,
        .stale = stale,
        .refresh = refresh,
        .needs = needs,
    };
    return &form;
}

const slv_htex *slv_form_get_htex(const slv_form *form, const void *made) {
    return form == slv_form_htex() ? ((const struct squares *)made)->htex : NULL;
}
