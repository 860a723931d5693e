/* A sampler from the inside, and the functions that lookups are made of. */
#ifndef SLV_FILTER_SAMPLER_H
#define SLV_FILTER_SAMPLER_H

#include "cache/cache_lookup.h"
#include "filter/kernel_build.h"

/* The lookups of one filter for one kind of processor: variants.h has them all. */
typedef struct lookup_functions {
    slv_result (*one)(slv_sampler *sampler, const slv_lookup *lookup, float *out);
    /* `order` (may be NULL) says which lookup comes when. */
    slv_result (*many)(slv_sampler *sampler, const slv_lookup *lookups, const uint32_t *order,
                       size_t count, float *out, size_t stride, slv_result *results);
} lookup_functions;

struct slv_sampler {
    cache_thread thread; /* first: on a line of memory of its own */
    kernel_shape shape;
    float width, blur;
    bool no_edge_blend;
    uint32_t first_channel, nchannels;
    uint32_t least; /* channels of files in which a lookup needs nothing but the first ones */
    lookup_functions functions;
};

/* One lookup under way. The thread is pinned. */
typedef struct lookup_state {
    slv_sampler *sampler;
    cache_tables *tables;
    uint32_t first, count; /* the channels that are wanted and there */
    float *sum;            /* count, added to */
    float weight;
    uint32_t pieces;
    slv_result result; /* of what could not be read */
    bool gone;         /* the tables were dropped: begin anew */
    bool subfaces;     /* something was laid onto sub-faces */
    uint8_t depth;
} lookup_state;

/* triangle.c: the elliptical filter of triangle meshes. u and v are finite. */
void slvi_triangle_sum(lookup_state *state, const slv_lookup *lookup);

static inline cache_face *lookup_face_at(lookup_state *state, uint32_t face) {
    return cache_find_face(state->tables, face);
}

/* One of the pieces that a resolution of a face comes in, or all of it, which is piece 0; NULL when
 * state says why. */
static inline const uint8_t *lookup_find_tile(lookup_state *state, uint32_t face, int res_u,
                                              int res_v, uint32_t tile) {
    cache_thread *thread = &state->sampler->thread;
    const uint8_t *texels =
        cache_find_hashed(thread->view, state->tables, face, res_u, res_v, tile);
    state->pieces++;
    if (!texels) {
        texels =
            slvi_cache_load_block(thread, state->tables, face, res_u, res_v, tile, &state->result);
        state->gone = !texels && !state->result;
    }
    return texels;
}

/* Texels of a face at a resolution that it has, untiled. */
static inline const uint8_t *lookup_find_whole(lookup_state *state, uint32_t face, cache_face *f,
                                               int res_u, int res_v) {
    const uint8_t *texels = res_u == f->res_u && res_v == f->res_v
                                ? cache_find_full(state->sampler->thread.view, f)
                                : NULL;
    if (!texels)
        return lookup_find_tile(state, face, res_u, res_v, 0);
    state->pieces++;
    return texels;
}

/* The mean of a face, which is its value if it is constant; NULL when state says why. */
static inline const uint8_t *lookup_find_average(lookup_state *state, uint32_t face,
                                                 cache_face *f) {
    const cache_tables *t = state->tables;
    return t->averages ? t->averages + (size_t)face * t->pixel_size
                       : lookup_find_whole(state, face, f, 0, 0);
}

static inline bool lookup_is_over(const lookup_state *state) {
    return state->gone || state->result != SLV_OK;
}

#endif
