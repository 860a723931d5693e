/* Texels, and how a face meets its neighbours along an edge. */
#include "form/borders/border_data.h"

#include "base/half.h"

slv_border_view slvi_border_view_begin(const slv_levels *levels, const slv_adjacency *adjacency) {
    slv_border_view view = {.levels = levels, .adjacency = adjacency, .one = 1.0f};
    if (levels->desc.type == SLV_TYPE_U8)
        view.one = 255.0f;
    if (levels->desc.type == SLV_TYPE_U16)
        view.one = 65535.0f;
    return view;
}

bool slvi_border_view_next(slv_border_view *view) {
    view->first += view->count;
    uint32_t left = view->levels->desc.nchannels - view->first;
    view->count = left < SLV_BORDER_CHANNELS ? left : SLV_BORDER_CHANNELS;
    return left > 0;
}

void slvi_border_fetch(const slv_border_view *view, uint32_t face, uint32_t level, uint32_t x,
                       uint32_t y, float *out) {
    const slv_levels *levels = view->levels;
    slv_res res = slvi_level_res(levels, face, level);
    const unsigned char *texels = slv_levels_texels(levels, face, level);
    size_t value = (((size_t)y << res.u) + x) * levels->desc.nchannels + view->first;
    if (levels->kind && levels->kind[face] & SLVI_LEVELS_SINGLE)
        value = view->first;
    if (levels->desc.type == SLV_TYPE_U8) {
        for (uint32_t c = 0; c < view->count; c++)
            out[c] = texels[value + c];
    } else if (levels->desc.type == SLV_TYPE_U16) {
        const uint16_t *from = (const uint16_t *)(const void *)texels + value;
        for (uint32_t c = 0; c < view->count; c++)
            out[c] = from[c];
    } else if (levels->desc.type == SLV_TYPE_HALF) {
        const uint16_t *from = (const uint16_t *)(const void *)texels + value;
        for (uint32_t c = 0; c < view->count; c++)
            out[c] = slvi_half_to_float(from[c]);
    } else {
        memcpy(out, texels + value * sizeof *out, view->count * sizeof *out);
    }
}

/* Where on the neighbour's edge a point t of this face's edge lies. */
static float map_along(const slv_border_edge *edge, const slv_neighbour *to, float t) {
    float u, v;
    slvi_edge_point(edge->edge, t, &u, &v);
    slv_affine_apply(&to->map, u, v, &u, &v);
    return slvi_edge_t(to->edge, u, v);
}

static int clamp_int(int value, int low, int high) {
    return value < low ? low : value > high ? high : value;
}

static int longer_side(slv_res res) {
    return res.u > res.v ? res.u : res.v;
}

/* The neighbour's even level of which texels are as long; below 0 where it has none so fine. */
static int level_alike(const slv_border_view *view, const slv_border_edge *edge,
                       const slv_neighbour *to) {
    return longer_side(view->levels->res[to->face]) + slvi_neighbour_halvings(to) +
           (int)edge->level - longer_side(view->levels->res[edge->face]);
}

uint32_t slvi_border_corner_level(const slv_border_view *view, const slv_border_edge *edge,
                                  const slv_border_link *link) {
    if (!view->levels->even)
        return edge->level ? link->level : 0;
    return (uint32_t)clamp_int(level_alike(view, edge, &link->to), 0,
                               longer_side(view->levels->res[link->to.face]));
}

/* Even levels meet where their texels are as long, and where they are not, as near to that as the
 * shorter side's texels along the edge allow. Where the neighbour has none so fine, the edge stays
 * what it is where the two meet at its finest: so it is one function at each length of texels,
 * whatever level a face has of that length, and does not change beyond the coarser face's. */
static void meet_even(const slv_border_view *view, const slv_border_edge *edge, int halvings,
                      slv_border_link *link) {
    slv_res res = view->levels->res[link->to.face];
    int own_side = longer_side(view->levels->res[edge->face]), side = longer_side(res);
    int along = slvi_res_along(res, link->to.edge), want = (int)edge->exponent - halvings;
    int coarsest = side - clamp_int(want, 0, along), finest = want < along ? coarsest : 0;
    int level = level_alike(view, edge, &link->to);
    int met = clamp_int((int)edge->level - level, (int)edge->level, own_side);
    link->relation = want > along ? SLV_BORDER_COARSER
                     : want < 0   ? SLV_BORDER_FINER
                                  : SLV_BORDER_EXACT;
    link->level = (uint32_t)clamp_int(level, finest, coarsest);
    link->own = (uint32_t)met;
}

static void meet(const slv_border_view *view, const slv_border_edge *edge, slv_border_link *link) {
    const slv_neighbour *to = &link->to;
    slv_res res = view->levels->res[to->face];
    int halvings = slvi_neighbour_halvings(to);
    int along = slvi_res_along(res, to->edge), across = slvi_res_across(res, to->edge);
    int want_along = (int)edge->exponent - halvings;
    int want_across = slvi_res_across(edge->res, edge->edge) - halvings;
    link->offset = map_along(edge, to, 0.0f);
    link->slope = map_along(edge, to, 1.0f) - link->offset;
    link->level = 0;
    link->own = edge->level;
    link->relation = SLV_BORDER_EXACT;
    if (view->levels->even) {
        meet_even(view, edge, halvings, link);
    } else if (want_along > along) {
        link->relation = SLV_BORDER_COARSER;
    } else if (want_along > 0) {
        link->level = (uint32_t)(along - want_along);
    } else {
        /* One texel along the edge, at several levels perhaps: the one nearest in the other
         * direction. */
        if (want_along < 0)
            link->relation = SLV_BORDER_FINER;
        int last = along > across ? along : across;
        link->level = (uint32_t)clamp_int(across - want_across, along, last);
    }
    link->res = slvi_res_level(res, link->level, view->levels->even);
    link->aligned = link->relation == SLV_BORDER_EXACT && link->own == edge->level &&
                    slvi_res_across(link->res, to->edge) == want_across;
}

slv_border_edge slvi_border_edge_at(const slv_border_view *view, uint32_t face, uint32_t level,
                                    uint32_t edge) {
    slv_border_edge out = {.face = face, .level = level, .edge = edge};
    out.res = slvi_level_res(view->levels, face, level);
    out.exponent = (uint32_t)slvi_res_along(out.res, edge);
    slv_neighbour neighbours[2];
    out.nlinks = slv_adjacency_neighbours(view->adjacency, (int32_t)face, edge, neighbours);
    for (uint32_t i = 0; i < out.nlinks; i++) {
        out.links[i].to = neighbours[i];
        meet(view, &out, &out.links[i]);
    }
    return out;
}

uint32_t slvi_border_link_index(const slv_border_edge *edge, const slv_border_link *link,
                                uint32_t j) {
    int32_t n = INT32_C(1) << slvi_res_along(link->res, link->to.edge);
    float at = (link->slope * slvi_border_centre(edge->exponent, j) + link->offset) * (float)n;
    return (uint32_t)clamp_int((int)at, 0, n - 1);
}

const slv_border_link *slvi_border_link_at(const slv_border_edge *edge, uint32_t j) {
    float t = slvi_border_centre(edge->exponent, j);
    for (uint32_t i = 0; i < edge->nlinks; i++)
        if (t > edge->links[i].to.t0 && t < edge->links[i].to.t1)
            return &edge->links[i];
    return NULL;
}

void slvi_border_fetch_row(const slv_border_view *view, uint32_t face, uint32_t level, slv_res res,
                           uint32_t edge, uint32_t j, float *out) {
    int32_t x, y;
    slvi_res_edge_texel(res, edge, (int32_t)j, 0, &x, &y);
    slvi_border_fetch(view, face, level, (uint32_t)x, (uint32_t)y, out);
}

void slvi_border_own(const slv_border_view *view, const slv_border_edge *edge,
                     const slv_border_link *link, uint32_t j, float *out) {
    uint32_t level = link ? link->own : edge->level;
    slvi_border_fetch_row(view, edge->face, level, slvi_level_res(view->levels, edge->face, level),
                          edge->edge, j, out);
}

void slvi_border_edge_from(const slv_border_view *view, const slv_border_edge *edge,
                           const slv_border_link *link, uint32_t j, float *out) {
    if (!link) {
        slvi_border_fetch_row(view, edge->face, edge->level, edge->res, edge->edge, j, out);
        return;
    }
    slvi_border_fetch_row(view, (uint32_t)link->to.face, link->level, link->res, link->to.edge,
                          slvi_border_link_index(edge, link, j), out);
    slvi_border_turn_across(view, edge, link, out);
}

/* A face of one texel along the edge, opposite two sub-faces: half of each, its own texel where one
 * is missing. */
void slvi_border_across_two(const slv_border_view *view, const slv_border_edge *edge, float *out) {
    float half[2][SLV_BORDER_CHANNELS];
    for (uint32_t i = 0; i < 2; i++) {
        if (i < edge->nlinks) {
            const slv_border_link *link = &edge->links[i];
            slvi_border_fetch_row(view, (uint32_t)link->to.face, link->level, link->res,
                                  link->to.edge, 0, half[i]);
            slvi_border_turn_across(view, edge, link, half[i]);
        } else {
            slvi_border_fetch_row(view, edge->face, edge->level, edge->res, edge->edge, 0, half[i]);
        }
    }
    for (uint32_t c = 0; c < view->count; c++)
        out[c] = 0.5f * (half[0][c] + half[1][c]);
}
