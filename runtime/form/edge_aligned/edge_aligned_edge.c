/* Samples on edges and vertices, the same from every face that has them. */
#include "form/edge_aligned/edge_aligned_data.h"

#include <string.h>

/* The edge of a whole quad in whose middle a corner of two sub-faces lies, if the quad has a single
 * texel along it. Its edge is one straight line, whatever the vertex would like to be. */
static bool straight_past(const slv_border_view *view, uint32_t face, uint32_t corner,
                          uint32_t *quad, uint32_t *quad_edge, unsigned *turns) {
    return slvi_border_quad_past(view, face, corner, quad, quad_edge, turns) &&
           slvi_res_along(view->levels->res[*quad], *quad_edge) == 0;
}

/* The raw value of what the type makes of it. */
static void round_to_type(const slv_border_view *view, float *raw) {
    slv_type type = view->levels->desc.type;
    float values[SLV_BORDER_CHANNELS];
    uint16_t stored[SLV_BORDER_CHANNELS];
    if (type == SLV_TYPE_FLOAT)
        return;
    for (uint32_t c = 0; c < view->count; c++)
        values[c] = raw[c] / view->one;
    slv_type_from_float(type, values, view->count, stored);
    for (uint32_t c = 0; c < view->count; c++) {
        if (type == SLV_TYPE_U8)
            raw[c] = ((const uint8_t *)stored)[c];
        else if (type == SLV_TYPE_U16)
            raw[c] = stored[c];
    }
    if (type == SLV_TYPE_HALF)
        slv_type_to_float(type, stored, view->count, raw);
}

void slvi_edge_aligned_corner(const slv_border_view *view, bool rounded, uint32_t face,
                              uint32_t level, uint32_t corner, float *out) {
    uint32_t quad, edge;
    unsigned turns;
    if (!straight_past(view, face, corner, &quad, &edge, &turns)) {
        slvi_border_vertex_value(view, face, level, corner, out, NULL);
        return;
    }
    float ends[2][SLV_BORDER_CHANNELS];
    slvi_border_vertex_value(view, quad, 0, edge, ends[0], NULL);
    slvi_border_vertex_value(view, quad, 0, slvi_edge_next(edge), ends[1], NULL);
    for (uint32_t i = 0; rounded && i < 2; i++)
        round_to_type(view, ends[i]);
    for (uint32_t c = 0; c < view->count; c++)
        out[c] = 0.5f * (ends[0][c] + ends[1][c]);
    slvi_border_turn(view, turns, out);
}

/* The own texel plus the one across, at index j; twice the own one at a boundary. */
static void pair(const slv_border_view *view, const slv_border_edge *edge,
                 const slv_border_link *link, uint32_t j, float *out) {
    float across[SLV_BORDER_CHANNELS];
    slvi_border_own(view, edge, link, j, out);
    slvi_border_edge_from(view, edge, link, j, across);
    for (uint32_t c = 0; c < view->count; c++)
        out[c] += across[c];
}

/* Whether sample k is the vertex between two sub-faces, or between one and a boundary. */
static bool is_middle(const slv_border_edge *edge, uint32_t k) {
    return edge->nlinks && slvi_neighbour_halvings(&edge->links[0].to) > 0 &&
           2 * k == 1u << edge->exponent;
}

static void middle(const slv_border_view *view, bool rounded, const slv_border_edge *edge,
                   float *out) {
    const slv_border_link *link = &edge->links[0];
    /* Edges that meet run in opposite directions. */
    uint32_t corner = link->to.t0 > 0.25f ? slvi_edge_next(link->to.edge) : link->to.edge;
    slvi_edge_aligned_corner(view, rounded, (uint32_t)link->to.face,
                             slvi_border_corner_level(view, edge, link), corner, out);
    slvi_border_turn_across(view, edge, link, out);
}

/* Sample k = 0..2^exponent of an edge whose own texels decide there. */
static void decide(const slv_border_view *view, bool rounded, const slv_border_edge *edge,
                   uint32_t k, float *out) {
    uint32_t n = 1u << edge->exponent;
    if (k == 0 || k == n) {
        slvi_edge_aligned_corner(view, rounded, edge->face, edge->level,
                                 k ? slvi_edge_next(edge->edge) : edge->edge, out);
        return;
    }
    if (is_middle(edge, k)) {
        middle(view, rounded, edge, out);
        return;
    }
    float before[SLV_BORDER_CHANNELS];
    const slv_border_link *link = slvi_border_link_at(edge, k);
    pair(view, edge, link, k - 1, before);
    pair(view, edge, link, k, out);
    for (uint32_t c = 0; c < view->count; c++)
        out[c] = 0.25f * (before[c] + out[c]);
}

static void put(const slv_border_view *view, const float *raw, float *to) {
    for (uint32_t c = 0; c < view->count; c++)
        to[c] = raw[c] / view->one;
}

/* Samples k0..k1-1 beside texels as long as the own, or beside none. Sums are formed so that the
 * other face, which counts the other way, finds the same bits. */
static void fill_met(const slv_border_view *view, const slv_border_edge *edge,
                     const slv_border_link *link, uint32_t k0, uint32_t k1, float *to,
                     ptrdiff_t step) {
    float sums[2][SLV_BORDER_CHANNELS], value[SLV_BORDER_CHANNELS];
    if (k0 >= k1)
        return;
    pair(view, edge, link, k0 - 1, sums[(k0 - 1) % 2]);
    for (uint32_t k = k0; k < k1; k++, to += step) {
        pair(view, edge, link, k, sums[k % 2]);
        for (uint32_t c = 0; c < view->count; c++)
            value[c] = 0.25f * (sums[0][c] + sums[1][c]);
        put(view, value, to);
    }
}

/* Samples k0..k1-1 on the lines between those of a coarser neighbour. */
static void fill_between(const slv_border_view *view, bool rounded, const slv_border_edge *edge,
                         const slv_border_link *link, uint32_t k0, uint32_t k1, float *to,
                         ptrdiff_t step) {
    slv_border_edge coarse =
        slvi_border_edge_at(view, (uint32_t)link->to.face, link->level, link->to.edge);
    float n = (float)(1u << edge->exponent), coarse_n = (float)(1u << coarse.exponent);
    float ends[2][SLV_BORDER_CHANNELS], value[SLV_BORDER_CHANNELS];
    uint32_t low = UINT32_MAX;
    for (uint32_t k = k0; k < k1; k++, to += step) {
        /* Powers of two throughout: exact. */
        float at = (link->slope * ((float)k / n) + link->offset) * coarse_n;
        uint32_t index = at < coarse_n ? (uint32_t)at : (uint32_t)coarse_n - 1;
        if (index != low) {
            low = index;
            for (uint32_t i = 0; i < 2; i++) {
                decide(view, rounded, &coarse, low + i, ends[i]);
                if (rounded)
                    round_to_type(view, ends[i]);
                slvi_border_turn_across(view, edge, link, ends[i]);
            }
        }
        float weight = at - (float)low;
        for (uint32_t c = 0; c < view->count; c++)
            value[c] = ends[0][c] + weight * (ends[1][c] - ends[0][c]);
        put(view, value, to);
    }
}

void slvi_edge_aligned_side(const slv_border_view *view, bool rounded, const slv_border_edge *edge,
                            float *to, ptrdiff_t step) {
    uint32_t n = 1u << edge->exponent;
    bool split = n > 1 && is_middle(edge, n / 2);
    for (uint32_t half = 0; half <= (split ? 1u : 0u); half++) {
        uint32_t first = half ? n / 2 : 0, end = split && !half ? n / 2 : n;
        const slv_border_link *link = slvi_border_link_at(edge, first);
        float *start = to + (ptrdiff_t)first * step;
        if (link && link->relation == SLV_BORDER_COARSER)
            fill_between(view, rounded, edge, link, first + 1, end, start, step);
        else
            fill_met(view, edge, link, first + 1, end, start, step);
    }
    if (split) {
        float value[SLV_BORDER_CHANNELS];
        middle(view, rounded, edge, value);
        put(view, value, to + (ptrdiff_t)(n / 2 - 1) * step);
    }
}
