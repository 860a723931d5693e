/* The edge function that two faces of different resolutions agree on, and the texel across an edge
 * that makes interpolation meet it. */
#include "form/borders/border_data.h"

void slvi_border_function_begin(const slv_border_view *view, const slv_border_link *link,
                                slv_border_function *out) {
    out->edge = slvi_border_edge_at(view, (uint32_t)link->to.face, link->level, link->to.edge);
    out->index[0] = out->index[1] = -2;
}

/* Knot k: -1 and n are the ends of the edge, where E is the value of the vertex. */
static void knot(const slv_border_view *view, slv_border_function *function, uint32_t slot,
                 int32_t k) {
    const slv_border_edge *edge = &function->edge;
    int32_t n = INT32_C(1) << edge->exponent;
    float *value = function->value[slot];
    function->index[slot] = k;
    if (k < 0 || k == n) {
        uint32_t corner = k < 0 ? edge->edge : slvi_edge_next(edge->edge);
        slvi_border_vertex_value(view, edge->face, edge->level, corner, value, NULL);
        return;
    }
    float own[SLV_BORDER_CHANNELS], across[SLV_BORDER_CHANNELS];
    slvi_border_fetch_row(view, edge->face, edge->level, edge->res, edge->edge, (uint32_t)k, own);
    slvi_border_across(view, edge, (uint32_t)k, across);
    for (uint32_t c = 0; c < view->count; c++)
        value[c] = 0.5f * (own[c] + across[c]);
}

/* The slot that holds knot k, computed unless it is there; `keep` is the slot not to overwrite. */
static uint32_t find_knot(const slv_border_view *view, slv_border_function *function, int32_t k,
                          uint32_t keep) {
    for (uint32_t slot = 0; slot < 2; slot++)
        if (function->index[slot] == k)
            return slot;
    knot(view, function, !keep, k);
    return !keep;
}

void slvi_border_function_at(const slv_border_view *view, slv_border_function *function, float t,
                             float *out) {
    int32_t n = INT32_C(1) << function->edge.exponent;
    float at = t * (float)n - 0.5f;
    int32_t k = at < 0.0f ? -1 : (int32_t)at;
    if (k > n - 1)
        k = n - 1;
    /* The outermost stretches are half a texel long. */
    float low = k < 0 ? -0.5f : (float)k, high = k == n - 1 ? (float)n - 0.5f : (float)k + 1.0f;
    float weight = (at - low) / (high - low);
    uint32_t kept = function->index[0] == k + 1 ? 0 : 1;
    uint32_t a = find_knot(view, function, k, kept), b = find_knot(view, function, k + 1, a);
    for (uint32_t c = 0; c < view->count; c++) {
        float from = function->value[a][c], to = function->value[b][c];
        out[c] = from + weight * (to - from);
    }
}

/* Adds a part of what the face's own texel that counts on the edge is above this level's. */
static void add_own(const slv_border_view *view, const slv_border_edge *edge,
                    const slv_border_link *link, uint32_t j, float part, float *out) {
    float counts[SLV_BORDER_CHANNELS], own[SLV_BORDER_CHANNELS];
    if (!link || link->own == edge->level)
        return;
    slvi_border_own(view, edge, link, j, counts);
    slvi_border_own(view, edge, NULL, j, own);
    for (uint32_t c = 0; c < view->count; c++)
        out[c] += part * (counts[c] - own[c]);
}

void slvi_border_across(const slv_border_view *view, const slv_border_edge *edge, uint32_t j,
                        float *out) {
    if (edge->nlinks && edge->links[0].relation == SLV_BORDER_FINER) {
        slvi_border_across_two(view, edge, out);
        for (uint32_t i = 0; i < edge->nlinks; i++)
            add_own(view, edge, &edge->links[i], 0, 0.5f, out);
        return;
    }
    const slv_border_link *link = slvi_border_link_at(edge, j);
    slvi_border_edge_from(view, edge, link, j, out);
    if (!link || link->relation == SLV_BORDER_EXACT) {
        add_own(view, edge, link, j, 1.0f, out);
        return;
    }
    float own[SLV_BORDER_CHANNELS];
    slv_border_function function;
    slvi_border_function_begin(view, link, &function);
    slvi_border_function_at(
        view, &function, link->slope * slvi_border_centre(edge->exponent, j) + link->offset, out);
    slvi_border_turn_across(view, edge, link, out);
    slvi_border_fetch_row(view, edge->face, edge->level, edge->res, edge->edge, j, own);
    for (uint32_t c = 0; c < view->count; c++)
        out[c] = 2.0f * out[c] - own[c];
}
