/* Chains of levels that agree where faces meet, and how far any chain does. */
#include "form/seamless/rims.h"

#include "base/log.h"
#include "base/memory.h"
#include "texture/levels.h"

#include <math.h>
#include <string.h>

enum { FACES_PER_RANGE = 16 };

struct fill {
    const slv_levels *plain;
    const slv_adjacency *adjacency;
    slv_levels *out;
    uint32_t first;
};

static slv_result fill_faces(void *user, uint64_t first, uint64_t end) {
    const struct fill *fill = user;
    for (uint32_t face = (uint32_t)first; face < end; face++) {
        slv_res res = fill->plain->res[face];
        for (uint32_t level = 0; level < slv_res_level_count(res); level++) {
            void *texels = slvi_levels_place(fill->out, face, level);
            memcpy(texels, slv_levels_texels(fill->plain, face, level),
                   slv_res_texels(slv_res_level(res, level)) * fill->plain->texel_size);
            if (level >= fill->first)
                slvi_rims_agree(fill->plain, fill->adjacency, face, level, texels);
        }
    }
    return SLV_OK;
}

slv_result slv_levels_create_seamless(const slv_env *given, const slv_texture *texture,
                                      const slv_adjacency *adjacency, uint32_t first,
                                      slv_levels **out) {
    slv_env env = slvi_budget_begin(given);
    slv_levels *plain = NULL;
    struct fill fill = {.adjacency = adjacency, .first = first};
    slv_result result = SLV_OK;
    *out = NULL;
    if (!texture || !adjacency)
        result = slvi_fail(&env, SLV_ERROR_ARGUMENT, "levels: no texture, or no adjacency");
    else if (slv_adjacency_face_count(adjacency) != slv_texture_get_desc(texture)->nfaces)
        result =
            slvi_fail(&env, SLV_ERROR_MISMATCH, "levels: %u faces of texture, %u of adjacency",
                      slv_texture_get_desc(texture)->nfaces, slv_adjacency_face_count(adjacency));
    if (result || (result = slv_levels_create_over(&env, texture, &plain)) ||
        (result = slvi_levels_lay(&env, slv_texture_get_desc(texture), NULL, &fill.out)))
        goto done;
    if (first && ((result = slvi_levels_kinds(plain)) || (result = slvi_levels_kinds(fill.out))))
        goto done;
    for (uint32_t face = 0; first && face < plain->desc.nfaces; face++)
        if (slv_texture_is_constant(texture, face))
            plain->kind[face] = fill.out->kind[face] = SLVI_LEVELS_STAYS;
    fill.plain = plain;
    if ((result =
             slvi_parallel_for(&env, fill.out->desc.nfaces, FACES_PER_RANGE, fill_faces, &fill)))
        goto done;
    *out = fill.out;
    fill.out = NULL;
done:
    slv_levels_destroy(plain);
    slv_levels_destroy(fill.out);
    return slvi_budget_end(&env, result);
}

/* The largest difference of two texels, in units of the type's range. */
static float apart(const slv_border_view *view, const float *a, const float *b) {
    float most = 0.0f;
    for (uint32_t c = 0; c < view->count; c++)
        most = fmaxf(most, fabsf(a[c] - b[c]) / view->one);
    return most;
}

/* The line through a coarser face's texels as they are stored, at the middle of texel k. */
static void line(const slv_border_view *view, const slv_border_edge *edge,
                 const slv_border_link *link, uint32_t k, float *out) {
    float last = (float)((1u << slvi_res_along(link->res, link->to.edge)) - 1);
    float at = slvi_rim_place(edge, link, k, last);
    uint32_t low = (uint32_t)at, high = (float)low < last ? low + 1 : low;
    float weight = at - (float)low, next[SLV_BORDER_CHANNELS];
    slvi_border_fetch_row(view, (uint32_t)link->to.face, link->level, link->res, link->to.edge, low,
                          out);
    slvi_border_fetch_row(view, (uint32_t)link->to.face, link->level, link->res, link->to.edge,
                          high, next);
    for (uint32_t c = 0; c < view->count; c++)
        out[c] += weight * (next[c] - out[c]);
}

static void compare(const slv_border_view *view, const slv_border_edge *edge, uint32_t k,
                    const slv_border_link *link, slv_seam_agreement *out) {
    float own[SLV_BORDER_CHANNELS], across[SLV_BORDER_CHANNELS];
    uint32_t quad, quad_edge, last = (1u << edge->exponent) - 1;
    slvi_border_edge_from(view, edge, NULL, k, own);
    if (link->relation == SLV_BORDER_COARSER) {
        if ((k == 0 || k == last) &&
            slvi_rim_is_between_two(view, edge->face, k ? slvi_edge_next(edge->edge) : edge->edge,
                                    &quad, &quad_edge))
            return;
        line(view, edge, link, k, across);
        out->mixed_max = fmaxf(out->mixed_max, apart(view, own, across));
    } else {
        slvi_border_edge_from(view, edge, link, k, across);
        out->equal_max = fmaxf(out->equal_max, apart(view, own, across));
    }
}

static bool is_bound(const slv_levels *levels, const slv_border_link *link) {
    return slvi_rim_is_bound(levels, (uint32_t)link->to.face, link->res);
}

void slv_levels_agreement(const slv_levels *levels, const slv_adjacency *adjacency, uint32_t level,
                          slv_seam_agreement *out) {
    slv_border_view view = slvi_border_view_begin(levels, adjacency);
    memset(out, 0, sizeof *out);
    while (slvi_border_view_next(&view))
        for (uint32_t face = 0; face < levels->desc.nfaces; face++) {
            slv_res res = slv_res_level(levels->res[face], level);
            if (level >= slv_levels_count(levels, face) || slvi_rim_is_bound(levels, face, res))
                continue;
            for (uint32_t e = 0; e < 4; e++) {
                slv_border_edge edge = slvi_border_edge_at(&view, face, level, e);
                for (uint32_t i = 0; i < edge.nlinks && !view.first; i++)
                    *(edge.links[i].relation == SLV_BORDER_COARSER ? &out->mixed : &out->edges) +=
                        !is_bound(levels, &edge.links[i]);
                for (uint32_t k = 0; k < 1u << edge.exponent; k++) {
                    const slv_border_link *link = slvi_border_link_at(&edge, k);
                    if (link && !is_bound(levels, link))
                        compare(&view, &edge, k, link, out);
                }
            }
        }
}
