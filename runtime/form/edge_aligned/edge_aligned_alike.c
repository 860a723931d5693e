/* Samples on the edges of a face among squares of its own resolution, as most faces are: each is
 * the mean of the four texels around it, and nothing about how faces meet need be asked. */
#include "form/edge_aligned/edge_aligned_data.h"

#include "base/half.h"

#include <string.h>

bool slvi_edge_aligned_is_alike(const slv_levels *levels, const slv_adjacency *adjacency,
                                uint32_t face, slv_ring rings[4], uint32_t positions[4]) {
    slv_res own = levels->res[face];
    bool part = slv_adjacency_is_subface(adjacency, (int32_t)face);
    if (own.u != own.v || levels->vectors)
        return false;
    for (uint32_t corner = 0; corner < 4; corner++) {
        slv_ring ring = slv_adjacency_ring(adjacency, (int32_t)face, corner, &positions[corner]);
        if (!ring.closed || ring.count != 4)
            return false;
        for (uint32_t i = 0; i < 4; i++) {
            slv_res res = levels->res[ring.corners[i].face];
            if (res.u != own.u || res.v != own.u ||
                slv_adjacency_is_subface(adjacency, ring.corners[i].face) != part)
                return false;
        }
        rings[corner] = ring;
    }
    return true;
}

/* The raw value of a channel. The type is a constant where this is called. */
static inline float raw(slv_type type, const unsigned char *at) {
    uint16_t two;
    float four;
    if (type == SLV_TYPE_U8)
        return *at;
    if (type == SLV_TYPE_FLOAT) {
        memcpy(&four, at, sizeof four);
        return four;
    }
    memcpy(&two, at, sizeof two);
    return type == SLV_TYPE_U16 ? two : slvi_half_to_float(two);
}

/* A level of a face and of those around it. */
struct level {
    int32_t side; /* texels */
    ptrdiff_t n, texel;
    const unsigned char *own, *across[4], *diagonal[4]; /* texels; beyond edges and corners */
    float *out;
};

/* Bytes from a face's first texel to that at the start of an edge; and how far it is to the next.
 */
static ptrdiff_t along(const struct level *l, uint32_t edge, ptrdiff_t *step) {
    int32_t x, y;
    slvi_edge_texel(l->side, l->side, edge, 0, 0, &x, &y);
    *step = slvi_edge_step(edge, l->texel, l->texel * l->side);
    return ((ptrdiff_t)y * l->side + x) * l->texel;
}

static float *sample_at(const struct level *l, uint32_t corner) {
    int32_t x, y;
    slvi_corner_texel(l->side + 1, l->side + 1, corner, &x, &y);
    return l->out + ((ptrdiff_t)y * (l->side + 1) + x) * l->n;
}

/* Sums in the order in which the face across, whose edge runs the other way, forms them, too. */
static inline void fill_side(slv_type type, const struct level *l, uint32_t edge,
                             uint32_t across_edge, float one) {
    ptrdiff_t size = (ptrdiff_t)slv_type_size(type), own_step, step;
    ptrdiff_t to_step = slvi_edge_step(edge, l->n, (l->side + 1) * l->n);
    const unsigned char *own = l->own + along(l, edge, &own_step);
    const unsigned char *other = l->across[edge] + along(l, across_edge, &step);
    float *to = sample_at(l, edge);
    other += (l->side - 1) * step;
    for (int32_t k = 1; k < l->side; k++) {
        own += own_step;
        other -= step;
        to += to_step;
        for (ptrdiff_t c = 0; c < l->n; c++) {
            const unsigned char *a = own + c * size, *b = other + c * size;
            float before = raw(type, a - own_step) + raw(type, b + step);
            to[c] = 0.25f * (before + (raw(type, a) + raw(type, b))) / one;
        }
    }
}

/* In the ring's order, as all faces around sum. */
static inline void fill_corner(slv_type type, const struct level *l, uint32_t corner,
                               const slv_corner *ring, uint32_t position, float one) {
    const unsigned char *around[4] = {l->own, l->across[slvi_edge_before(corner)],
                                      l->diagonal[corner], l->across[corner]};
    float *to = sample_at(l, corner);
    ptrdiff_t step;
    for (ptrdiff_t c = 0; c < l->n; c++) {
        ptrdiff_t channel = c * (ptrdiff_t)slv_type_size(type);
        double sum = 0;
        for (uint32_t i = 0; i < 4; i++)
            sum += (double)raw(type, around[(i - position) & 3] + along(l, ring[i].corner, &step) +
                                         channel);
        to[c] = (float)(0.25 * sum) / one;
    }
}

static inline void fill_rim(slv_type type, const struct level *l, const slv_ring rings[4],
                            const uint32_t positions[4], float one) {
    for (uint32_t edge = 0; edge < 4; edge++) {
        const slv_corner *ring = rings[edge].corners;
        fill_side(type, l, edge, slvi_edge_before(ring[(positions[edge] + 3) & 3].corner), one);
        fill_corner(type, l, edge, ring, positions[edge], one);
    }
}

void slvi_edge_aligned_fill_alike(const slv_levels *levels, uint32_t face, uint32_t level,
                                  const slv_ring rings[4], const uint32_t positions[4],
                                  float *out) {
    struct level l = {.side = 1 << slvi_level_res(levels, face, level).u,
                      .n = (ptrdiff_t)levels->desc.nchannels,
                      .texel = (ptrdiff_t)levels->texel_size,
                      .own = slv_levels_texels(levels, face, level),
                      .out = out};
    for (uint32_t i = 0; i < 4; i++) {
        const slv_corner *ring = rings[i].corners;
        int32_t across = ring[(positions[i] + 3) & 3].face;
        int32_t diagonal = ring[(positions[i] + 2) & 3].face;
        l.across[i] = slv_levels_texels(levels, (uint32_t)across, level);
        l.diagonal[i] = slv_levels_texels(levels, (uint32_t)diagonal, level);
    }
    switch (levels->desc.type) {
    case SLV_TYPE_U8:
        fill_rim(SLV_TYPE_U8, &l, rings, positions, 255.0f);
        break;
    case SLV_TYPE_U16:
        fill_rim(SLV_TYPE_U16, &l, rings, positions, 65535.0f);
        break;
    case SLV_TYPE_HALF:
        fill_rim(SLV_TYPE_HALF, &l, rings, positions, 1.0f);
        break;
    case SLV_TYPE_FLOAT:
        fill_rim(SLV_TYPE_FLOAT, &l, rings, positions, 1.0f);
        break;
    }
}
