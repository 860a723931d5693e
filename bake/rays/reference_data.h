/* What the files of the reference share. */
#ifndef SLV_BAKE_REFERENCE_DATA_H
#define SLV_BAKE_REFERENCE_DATA_H

#include "texture/bilinear.h"

#include <selvage/reference.h>

#if SLV_EMBREE_VERSION >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

/* Where a face's edge runs along a neighbour of longer texels, and takes its values from there. */
typedef struct reference_link {
    uint32_t face; /* the neighbour */
    uint32_t edge;
    float t0, t1; /* counter-clockwise along the edge */
    slv_affine map;
} reference_link;

/* The shown channels of level 0 of every face, bordered by one texel. */
typedef struct reference_texels {
    uint32_t nchannels; /* 1 to 3 */
    slv_res *res;
    uint64_t *first; /* per face: its first value */
    float *values;
    uint32_t *first_link; /* per face, and one past the last */
    reference_link *links;
    float *corners; /* 4 * nchannels per face: what each corner lacks of its vertex's value */
    bool *mended;   /* per face: it has links, or a corner that lacks something */
} reference_texels;

slv_result slvi_reference_texels_create(const slv_env *env, const slv_texture *texture,
                                        const slv_adjacency *adjacency, uint32_t first_channel,
                                        uint32_t nchannels, reference_texels *out);
void slvi_reference_texels_free(reference_texels *texels);

/* Quads on the vertices of the tessellation, (x+1,y) (x+1,y+1) (x,y+1) (x,y) for cell (x,y): Embree
 * splits a quad between its second and fourth vertex, which is where the renderer splits it. */
struct slv_reference {
    slv_env env;
    reference_texels texels;
    slv_tessellation mesh;
    uint32_t *quads; /* 4 each */
    RTCDevice device;
    RTCScene scene;
};

static inline float reference_clamp(float x, float most) {
    return x > 0.0f ? x < most ? x : most : 0.0f;
}

/* Bilinear in the bordered texels; true if one of them was a border texel. */
static inline bool reference_bilinear(const reference_texels *texels, uint32_t face, float u,
                                      float v, float rgb[3]) {
    slv_res res = texels->res[face];
    slvi_bilinear at = slvi_bilinear_bordered_floats(texels->values + texels->first[face], res,
                                                     texels->nchannels, u, v, rgb);
    return at.x == 0 || at.y == 0 || at.x == 1u << res.u || at.y == 1u << res.v;
}

/* A value beside an edge of a face that needs it, made to meet the neighbours' on the edge. */
void slvi_reference_mend(const reference_texels *texels, uint32_t face, float u, float v,
                         float rgb[3]);

/* The texture as a function; (u,v) is clamped. */
static inline void reference_fetch(const reference_texels *texels, uint32_t face, float u, float v,
                                   float rgb[3]) {
    u = reference_clamp(u, 1.0f);
    v = reference_clamp(v, 1.0f);
    if (reference_bilinear(texels, face, u, v, rgb) && texels->mended[face])
        slvi_reference_mend(texels, face, u, v, rgb);
    if (texels->nchannels < 3) {
        rgb[1] = texels->nchannels == 1 ? rgb[0] : rgb[1];
        rgb[2] = texels->nchannels == 1 ? rgb[0] : 0.0f;
    }
}

/* The camera turned round: eye space to world space, columns x, y, z, and the origin. */
typedef struct reference_eye {
    float x[3], y[3], z[3], origin[3];
    bool perspective;
    float window[4], nearest;
    float normal_matrix[9];
} reference_eye;

/* False if the camera cannot be inverted, or its window is empty. */
bool slvi_reference_eye_make(const slv_reference *reference, const slv_camera *camera,
                             reference_eye *out);

/* The ray through (x,y) of the window's plane. Distances along it are depths: its direction has
 * length 1 along the eye's -z. */
static inline void reference_eye_ray(const reference_eye *e, float x, float y, float origin[3],
                                     float direction[3]) {
    for (int k = 0; k < 3; k++) {
        float across = x * e->x[k] + y * e->y[k];
        direction[k] = e->perspective ? across - e->z[k] : -e->z[k];
        origin[k] = e->perspective ? e->origin[k] : e->origin[k] + across - e->nearest * e->z[k];
    }
}

/* Where samples fall. */
typedef struct reference_sampler {
    slv_pixel_filter filter;
    uint32_t seed;
    uint32_t *sobol;  /* the second dimension, bits reversed; the first one's are the index */
    float *positions; /* Mitchell: bounds of equally likely intervals */
} reference_sampler;

/* `samples` is the most that one sequence will have. */
slv_result slvi_reference_sampler_create(const slv_env *env, slv_pixel_filter filter, uint32_t seed,
                                         uint32_t samples, reference_sampler *out);
void slvi_reference_sampler_free(reference_sampler *sampler);

/* A sequence of its own for each pixel and half. */
typedef struct reference_sequence {
    uint32_t scramble[2];
} reference_sequence;
reference_sequence slvi_reference_sequence_begin(const reference_sampler *sampler, uint32_t x,
                                                 uint32_t y, uint32_t half);
/* Sample `index`: its offset from the pixel's upper left corner and its weight. */
float slvi_reference_sample(const reference_sampler *sampler, const reference_sequence *sequence,
                            uint32_t index, float offset[2]);

#endif
