/* The texture of a reference as one continuous function: level 0 of every face with its border, and
 * what is added beside coarser neighbours and at corners. */
#ifndef SLV_BAKE_REFERENCE_TEXELS_H
#define SLV_BAKE_REFERENCE_TEXELS_H

#include "texture/bilinear.h"
#include "texture/black.h"

#include <selvage/reference.h>

/* Where a face's edge runs along a neighbour of longer texels, and takes its values from there. */
typedef struct reference_link {
    uint32_t face; /* the neighbour */
    uint32_t edge;
    float t0, t1; /* counter-clockwise along the edge */
    slv_affine map;
} reference_link;

/* The shown channels of level 0 of every face, bordered by one texel. */
typedef struct reference_texels {
    uint32_t nchannels; /* 1 to 4 */
    bool alpha;         /* the last one is alpha */
    slv_res *res;
    uint64_t *first; /* per face: its first value */
    float *values;
    uint32_t *first_link; /* per face, and one past the last */
    reference_link *links;
    float *corners; /* 4 * nchannels per face: what each corner lacks of its vertex's value */
    uint8_t *black; /* NULL, or per face the edges beyond which it is black */
    bool *mended;   /* per face: it has links, or a corner that lacks something */
} reference_texels;

slv_result slvi_reference_texels_create(const slv_env *env, const slv_texture *texture,
                                        const slv_adjacency *adjacency,
                                        const slv_reference_params *params, uint32_t nchannels,
                                        reference_texels *out);
/* Makes them black beyond the boundary where either mode asks for it. */
slv_result slvi_reference_texels_border(const slv_env *env, const slv_adjacency *adjacency,
                                        slv_border_mode border_u, slv_border_mode border_v,
                                        reference_texels *texels);
void slvi_reference_texels_free(reference_texels *texels);

static inline float reference_clamp(float x, float most) {
    return x > 0.0f ? x < most ? x : most : 0.0f;
}

/* Bilinear in the bordered texels; true if one of them was a border texel. */
static inline bool reference_bilinear(const reference_texels *texels, uint32_t face, float u,
                                      float v, float rgba[4]) {
    slv_res res = texels->res[face];
    slvi_bilinear at = slvi_bilinear_bordered_floats(texels->values + texels->first[face], res,
                                                     texels->nchannels, u, v, rgba);
    return at.x == 0 || at.y == 0 || at.x == 1u << res.u || at.y == 1u << res.v;
}

/* A value beside an edge of a face that needs it, made to meet the neighbours' on the edge. */
void slvi_reference_mend(const reference_texels *texels, uint32_t face, float u, float v,
                         float rgba[4]);

/* The texture as a function; (u,v) is clamped. Alpha is 1 where it is no channel. */
static inline void reference_fetch(const reference_texels *texels, uint32_t face, float u, float v,
                                   float rgba[4]) {
    u = reference_clamp(u, 1.0f);
    v = reference_clamp(v, 1.0f);
    if (reference_bilinear(texels, face, u, v, rgba) && texels->mended[face])
        slvi_reference_mend(texels, face, u, v, rgba);
    if (texels->black && texels->black[face]) {
        float lit = slvi_lit(texels->black[face], texels->res[face], u, v);
        for (uint32_t c = 0; c < texels->nchannels; c++)
            rgba[c] *= lit;
    }
    if (texels->nchannels == 4)
        return;
    rgba[3] = texels->alpha ? rgba[1] : 1.0f;
    if (texels->nchannels == 1 || texels->alpha)
        rgba[1] = rgba[2] = rgba[0];
    else if (texels->nchannels == 2)
        rgba[2] = 0.0f;
}

#endif
