/* What the files of the reference share. */
#ifndef SLV_BAKE_REFERENCE_DATA_H
#define SLV_BAKE_REFERENCE_DATA_H

#include "rays/embree.h"
#include "rays/reference_texels.h"

#include <selvage/reference.h>

/* Quads on the vertices of the tessellation, (x+1,y) (x+1,y+1) (x,y+1) (x,y) for cell (x,y): Embree
 * splits a quad between its second and fourth vertex, which is where the renderer splits it. */
struct slv_reference {
    slv_env env;
    reference_texels texels;
    slv_uv_images images; /* in place of texels, if there is a `color` */
    slv_alpha_mode alpha;
    float step; /* between two hits of a ray */
    slv_tessellation mesh;
    uint32_t *quads; /* 4 each */
    RTCDevice device;
    RTCScene scene;
};

static inline void reference_color(const slv_reference *r, uint32_t face, float u, float v,
                                   float rgba[4]) {
    if (!r->images.color)
        reference_fetch(&r->texels, face, u, v, rgba);
    else
        r->images.color(r->images.user, face, reference_clamp(u, 1.0f), reference_clamp(v, 1.0f),
                        rgba);
    rgba[3] = r->alpha ? reference_clamp(rgba[3], 1.0f) : 1.0f;
}

/* The camera turned round: eye space to world space, columns x, y, z, and the origin. */
typedef struct reference_eye {
    float x[3], y[3], z[3], origin[3];
    bool perspective;
    float window[4], nearest;
    float normal_matrix[9];
} reference_eye;

/* Says what is wrong with a camera: it cannot be inverted, its window is empty, or its rays begin
 * or go too far away. */
slv_result slvi_reference_eye_make(const slv_env *env, const slv_reference *reference,
                                   const slv_camera *camera, reference_eye *out);

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
    uint32_t mask;    /* one less than the power of two of samples */
    uint32_t *sobol;  /* of so many the second dimension, bits reversed; the first is the index */
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
static inline uint32_t reference_reverse(uint32_t x) {
    x = x >> 16 | x << 16;
    x = (x & 0xff00ff00u) >> 8 | (x & 0x00ff00ffu) << 8;
    x = (x & 0xf0f0f0f0u) >> 4 | (x & 0x0f0f0f0fu) << 4;
    x = (x & 0xccccccccu) >> 2 | (x & 0x33333333u) << 2;
    return (x & 0xaaaaaaaau) >> 1 | (x & 0x55555555u) << 1;
}

/* Owen's scrambling as a hash of the reversed bits in which a bit depends on lower ones only
 * (Laine and Karras 2011; constants of Burley 2020, with Vegdahl's first step). */
static inline uint32_t reference_hash(uint32_t reversed, uint32_t seed) {
    uint32_t x = reversed;
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= seed >> 16 | 1;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

static inline float reference_scramble(uint32_t reversed, uint32_t seed) {
    /* 24 bits are what a float below 1 can hold; signed integers become one by a step of processors
     */
    return (float)(int32_t)(reference_reverse(reference_hash(reversed, seed)) >> 8) *
           (1.0f / 16777216);
}

/* The number of a sample in an order of one's own, of 2^n, `mask` being one less: what is sampled
 * side by side by sequences in one order would go together, since each one's first bit is its
 * number's lowest (Burley 2020, section 4). */
static inline uint32_t reference_shuffle(uint32_t index, uint32_t seed, uint32_t mask) {
    return reference_reverse(reference_hash(reference_reverse(index), seed)) & mask;
}

/* Sample `index`: its offset from the pixel's upper left corner and its weight. */
float slvi_reference_sample(const reference_sampler *sampler, const reference_sequence *sequence,
                            uint32_t index, float offset[2]);

#endif
