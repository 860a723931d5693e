/* Where a whole quad's edge meets two sub-faces: which is the first, and which the second. */
#include "adjacency/adjacency_data.h"
#include "adjacency/edge.h"

slv_half_edge slvi_adjacency_secondary(const slv_adjacency *a, slv_half_edge whole,
                                       slv_half_edge primary) {
    static const slv_half_edge none = {SLV_BOUNDARY, 0};
    slv_half_edge inner = {primary.face, (uint8_t)slvi_edge_before(primary.edge)};
    slv_half_edge other = slvi_adjacency_across(a, inner);
    if (!slvi_adjacency_has(a, other.face) || !a->subface[other.face] ||
        !slvi_half_edge_same(slvi_adjacency_across(a, other), inner) ||
        slvi_half_edge_same(inner, other))
        return none;
    slv_half_edge secondary = {other.face, (uint8_t)slvi_edge_before(other.edge)};
    if (slvi_half_edge_same(secondary, primary) ||
        !slvi_half_edge_same(slvi_adjacency_across(a, secondary), whole))
        return none;
    return secondary;
}

bool slvi_adjacency_is_primary(const slv_adjacency *a, slv_half_edge sub) {
    return slvi_half_edge_same(slvi_adjacency_across(a, slvi_adjacency_across(a, sub)), sub);
}
