/* What makes textures: procedural patterns that are continuous in space, evaluated on the limit
 * surface. */
#ifndef SELVAGE_BAKE_H
#define SELVAGE_BAKE_H

#include <selvage/surface.h>
#include <selvage/texture.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum slv_pattern {
    SLV_PATTERN_STRIPES = 0, /* smooth bands across `direction`, bent by noise if `warp` says so */
    SLV_PATTERN_NOISE,       /* gradient noise, `octaves` of it */
    SLV_PATTERN_CHECKER,     /* cubes in space, hard-edged */
    SLV_PATTERN_FACE_COLOR,  /* one opaque colour a face, drawn from the face id and the seed */
    SLV_PATTERN_POSITION     /* the position itself, scaled: linear in space, not clamped, opaque */
} slv_pattern;

/* stripes, noise, checker, face-color, position */
SLV_API const char *slv_pattern_name(slv_pattern pattern);
SLV_API bool slv_pattern_from_name(const char *name, slv_pattern *out);

/* A pattern; zero means default (a colour of four zeros, too). Colours are linear. Position enters
 * as (position - offset) * frequency. The same values come out on every machine: nothing but IEEE
 * arithmetic and an integer hash is used. */
typedef struct slv_procedural {
    slv_pattern pattern;
    float frequency;    /* periods per unit of length; default 1 */
    float direction[3]; /* of stripes, any length; default (0.36, 0.80, 0.48) */
    float offset[3];
    float warp; /* how far noise, four periods wide, bends the stripes, in periods; default 0 */
    uint32_t octaves; /* default 4, at most 16 */
    uint32_t seed;
    float color0[4]; /* where the pattern is 0; default opaque black */
    float color1[4]; /* where it is 1; default opaque white */
    float face_tint; /* 0..1: how much of each face's own colour is mixed into RGB */
    uint64_t reserved[4];
} slv_procedural;

/* The pattern at a point in space, as RGBA; `face` matters only to FACE_COLOR and
 * face_tint. Pure. */
SLV_API void slv_procedural_evaluate(const slv_procedural *pattern, int32_t face,
                                     const float position[3], float rgba[4]);

/* Zero means default. */
typedef struct slv_bake_params {
    uint32_t samples;      /* per texel and axis, 1..64; default 1, the texel's centre */
    uint32_t first_face;   /* where to begin; faces before it are left as they are */
    uint32_t face_count;   /* how many; default all from first_face on */
    slv_progress progress; /* faces */
    uint64_t reserved[4];
} slv_bake_params;

/* Evaluates a pattern into every texel of every face, at the limit position of the texel's centre
 * (or the mean over a regular grid of samples in it). Channels are the first of RGBA, or the
 * luminance (Rec. 709) for one channel; more than four are SLV_ERROR_UNSUPPORTED. In parallel; the
 * same bytes with any number of threads. A surface and a texture of different face counts are
 * SLV_ERROR_MISMATCH. `params` may be NULL. */
SLV_NODISCARD SLV_API slv_result slv_bake_procedural(const slv_env *env, const slv_surface *surface,
                                                     const slv_procedural *pattern,
                                                     const slv_bake_params *params,
                                                     slv_texture *texture);

#ifdef __cplusplus
}
#endif

#endif
