/* What both sides of an edge agree on in their outermost texels. */
#include "form/seamless/rims.h"

/* The raw value of what the type makes of it. */
static void round_to_type(const slv_border_view *view, float *raw) {
    slv_type type = view->levels->desc.type;
    float values[SLV_BORDER_CHANNELS], rounded[SLV_BORDER_CHANNELS];
    if (type == SLV_TYPE_FLOAT)
        return;
    for (uint32_t c = 0; c < view->count; c++)
        values[c] = raw[c] / view->one;
    slv_type_from_float(type, values, view->count, rounded);
    slv_type_to_float(type, rounded, view->count, values);
    /* whole numbers of integers, so that rounding again gives the same */
    for (uint32_t c = 0; c < view->count; c++)
        raw[c] = type == SLV_TYPE_HALF ? values[c] : (float)(int32_t)(values[c] * view->one + 0.5f);
}

/* Around a vertex where oblong resolutions contradict each other levels do not meet: there all
 * levels take the value of the first ones, which do. */
static void vertex_value(const slv_border_view *view, uint32_t face, uint32_t level,
                         uint32_t corner, float *out) {
    if (!slvi_border_vertex_fits(view, face, corner))
        level = 0;
    slvi_border_vertex_value(view, face, level, corner, out, NULL);
    round_to_type(view, out);
}

bool slvi_rim_is_between_two(const slv_border_view *view, uint32_t face, uint32_t corner,
                             uint32_t *quad, uint32_t *edge) {
    return slvi_border_quad_past(view, face, corner, quad, edge, NULL) &&
           slvi_res_along(view->levels->res[*quad], *edge) == 1;
}

static void corner_value(const slv_border_view *view, uint32_t face, uint32_t level,
                         uint32_t corner, float *out) {
    uint32_t quad, edge;
    float end[SLV_BORDER_CHANNELS];
    if (!slvi_rim_is_between_two(view, face, corner, &quad, &edge)) {
        vertex_value(view, face, level, corner, out);
        return;
    }
    /* both of the quad's texels are in its corners: the vertex has no say */
    vertex_value(view, quad, 0, edge, out);
    vertex_value(view, quad, 0, slvi_edge_next(edge), end);
    for (uint32_t c = 0; c < view->count; c++)
        out[c] = 0.5f * (out[c] + end[c]);
    round_to_type(view, out);
}

/* Beside the middle of a whole quad's edge that meets two sub-faces. */
static bool is_beside_middle(const slv_border_edge *edge, uint32_t k) {
    uint32_t half = (1u << edge->exponent) / 2;
    return edge->nlinks && slvi_neighbour_halvings(&edge->links[0].to) > 0 &&
           (k == half || k + 1 == half);
}

static void middle_value(const slv_border_view *view, const slv_border_edge *edge, float *out) {
    const slv_border_link *link = &edge->links[0];
    /* edges that meet run in opposite directions */
    uint32_t corner = link->to.t0 > 0.25f ? slvi_edge_next(link->to.edge) : link->to.edge;
    corner_value(view, (uint32_t)link->to.face, link->level, corner, out);
}

/* Recursive, to the row of a coarser face and no further than there are coarser ones. */
void slvi_rim_value(const slv_border_view *view, const slv_border_edge *edge, uint32_t k,
                    float *out) {
    uint32_t n = 1u << edge->exponent;
    const slv_border_link *link = slvi_border_link_at(edge, k);
    bool bound = slvi_rim_is_bound(view->levels, edge->face, edge->res);
    if (!bound && (k == 0 || k + 1 == n)) {
        corner_value(view, edge->face, edge->level, k ? slvi_edge_next(edge->edge) : edge->edge,
                     out);
        return;
    }
    if (!bound && is_beside_middle(edge, k)) {
        middle_value(view, edge, out);
        return;
    }
    slvi_border_edge_from(view, edge, NULL, k, out);
    if (bound || !link)
        return;
    if (link->relation == SLV_BORDER_COARSER) {
        slvi_rim_between(view, edge, link, k, out);
        round_to_type(view, out);
        return;
    }
    float across[SLV_BORDER_CHANNELS];
    bool takes = slvi_rim_is_bound(view->levels, (uint32_t)link->to.face, link->res);
    slvi_border_edge_from(view, edge, link, k, across);
    for (uint32_t c = 0; c < view->count; c++)
        out[c] = takes ? across[c] : 0.5f * (out[c] + across[c]);
    round_to_type(view, out);
}

void slvi_rim_between(const slv_border_view *view, const slv_border_edge *edge,
                      const slv_border_link *link, uint32_t k, float *out) {
    slv_border_edge coarse = slvi_border_edge_at(view, (uint32_t)link->to.face, 0, link->to.edge);
    float last = (float)((1u << coarse.exponent) - 1);
    float at = slvi_rim_place(edge, link, k, last);
    uint32_t low = (uint32_t)at;
    float weight = at - (float)low, next[SLV_BORDER_CHANNELS];
    slvi_rim_value(view, &coarse, low, out);
    if (!(weight > 0.0f))
        return;
    slvi_rim_value(view, &coarse, low + 1, next);
    for (uint32_t c = 0; c < view->count; c++)
        out[c] += weight * (next[c] - out[c]);
}

void slvi_rims_agree(const slv_levels *levels, const slv_adjacency *adjacency, uint32_t face,
                     uint32_t level, void *texels) {
    slv_border_view view = slvi_border_view_begin(levels, adjacency);
    slv_border_edge edges[4];
    size_t size = slv_type_size(levels->desc.type);
    slv_res res = slv_res_level(levels->res[face], level);
    if (slvi_rim_is_bound(levels, face, res))
        return;
    for (uint32_t edge = 0; edge < 4; edge++)
        edges[edge] = slvi_border_edge_at(&view, face, level, edge);
    while (slvi_border_view_next(&view)) {
        for (uint32_t edge = 0; edge < 4; edge++) {
            uint32_t last = (1u << edges[edge].exponent) - 1;
            for (uint32_t k = 0; k < last; k++) { /* the last is the next edge's first */
                float value[SLV_BORDER_CHANNELS];
                int32_t x, y;
                slvi_rim_value(&view, &edges[edge], k, value);
                for (uint32_t c = 0; c < view.count; c++)
                    value[c] /= view.one;
                slvi_res_edge_texel(res, edge, (int32_t)k, 0, &x, &y);
                size_t at = (((size_t)y << res.u) + (size_t)x) * levels->desc.nchannels;
                slv_type_from_float(levels->desc.type, value, view.count,
                                    (unsigned char *)texels + (at + view.first) * size);
            }
        }
    }
}
