/* What the border mode black leaves of a lookup: texels beyond the boundary count, and are zero. */
#ifndef SLV_TEXTURE_BLACK_H
#define SLV_TEXTURE_BLACK_H

#include "adjacency/edge.h"

#include <selvage/source.h>

/* One bit for each edge of a face beyond which it is black. */
static inline unsigned slvi_black_edges(const slv_adjacency *adjacency, uint32_t face,
                                        slv_border_mode border_u, slv_border_mode border_v) {
    const int32_t *across = slv_adjacency_faces(adjacency)[face].face;
    unsigned edges = 0;
    for (unsigned e = 0; e < 4; e++)
        if (across[e] == SLV_BOUNDARY &&
            (slvi_edge_along_v(e) ? border_u : border_v) == SLV_BORDER_BLACK)
            edges |= 1u << e;
    return edges;
}

/* How much of a bilinear filter between the texels of level 0 lies on this side of those edges. */
static inline float slvi_lit(unsigned black, slv_res res, float u, float v) {
    float lit = 1;
    for (unsigned e = 0; e < 4; e++) {
        float texels = (float)(UINT32_C(1) << (slvi_edge_along_v(e) ? res.u : res.v));
        float part = slvi_edge_depth(e, u, v) * texels + 0.5f;
        if (black >> e & 1)
            lit *= part < 0 ? 0 : part < 1 ? part : 1;
    }
    return lit;
}

#endif
