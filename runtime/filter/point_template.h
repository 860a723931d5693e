/* Template: lookups of single texels. What any file and position asks for, and the quick way that
 * most take. */
#ifndef SLV_FILTER_POINT_TEMPLATE_H
#define SLV_FILTER_POINT_TEMPLATE_H

#include "filter/gather_template.h"

/* Which of a face's texels a position of 0 <= u, v < 1 is in. */
static inline __attribute__((always_inline)) size_t point_place(float u, float v, int res_u,
                                                                int res_v) {
    int x = (int)(u * num_power_of_two(res_u)), y = (int)(v * num_power_of_two(res_v));
    return ((size_t)y << res_u) + (size_t)x;
}

/* The same for eight at a time, which is faster than one by one: columns and rows. */
static inline __attribute__((always_inline)) void point_places(v8f u, v8f v, v8i res_u, v8i res_v,
                                                               v8i *x, v8i *y) {
    *x = v8_to_int(u * v8_power_of_two(res_u));
    *y = v8_to_int(v * v8_power_of_two(res_v));
}

/* Any position, on a face of either kind, whose texels may come in tiles or not be there yet. */
static void point_any(lookup_state *state, const slv_lookup *l) {
    const cache_tables *t = state->tables;
    cache_face *f = lookup_face_at(state, l->face);
    state->weight = 1;
    if ((cache_flags(f) & SLV_FACE_CONSTANT) || f->res_u + f->res_v == 0) {
        gather_add_average(state, l->face, f, 1);
        return;
    }
    float size_u = num_power_of_two(f->res_u), size_v = num_power_of_two(f->res_v);
    float u = l->u * size_u, v = l->v * size_v;
    u = u > 0 ? u < size_u ? u : size_u - 1 : 0;
    v = v > 0 ? v < size_v ? v : size_v - 1 : 0;
    int x = (int)u, y = (int)v;
    if (t->triangle && u - (float)x + (v - (float)y) > 1) {
        int mirrored = (1 << f->res_u) - 1 - y;
        y = (1 << f->res_u) - 1 - x;
        x = mirrored;
    }
    const uint8_t *texels;
    size_t at;
    if (f->res_u + f->res_v <= t->whole_log2) {
        at = ((size_t)y << f->res_u) + (size_t)x;
        texels = lookup_find_whole(state, l->face, f, f->res_u, f->res_v);
    } else {
        slv_res tile = slvi_cache_tile_res(t, f->res_u, f->res_v);
        uint32_t index = ((uint32_t)(y >> tile.v) << (f->res_u - tile.u)) + (uint32_t)(x >> tile.u);
        texels = lookup_find_tile(state, l->face, f->res_u, f->res_v, index);
        at = ((size_t)(y & ((1 << tile.v) - 1)) << tile.u) + (size_t)(x & ((1 << tile.u) - 1));
    }
    if (texels)
        gather_add_texel(t->type, texels + at * t->pixel_size, state->first, state->count, 1,
                         state->sum);
}

#endif
