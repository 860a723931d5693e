/* What the files of tangent frames share. */
#ifndef SLV_BAKE_UV_TANGENTS_DATA_H
#define SLV_BAKE_UV_TANGENTS_DATA_H

#include "source/vectors.h"
#include "uv/tangents.h"

#define SLVI_TANGENT_NONE UINT32_MAX

typedef struct tangent_triangle {
    uint32_t corners[3], across[3]; /* edge k goes from corner k; SLVI_TANGENT_NONE: a
                                         boundary */
    bool grouped[3];
    float tangent[3]; /* along growing u; the sign is that of the orientation */
    float twice_area; /* in coordinates */
    bool keeps;       /* coordinates turn as the surface does */
    bool any;         /* has no area in coordinates, and goes with any orientation */
    bool dead;        /* two of its positions are one, or it has no coordinates */
} tangent_triangle;

typedef struct tangent_corner {
    float normal[3], tangent[3], sign, place[2];
    uint32_t vertex, weld;
} tangent_corner;

struct slvi_tangents {
    const float *positions;
    uint32_t npolys, ncorners, ntriangles;
    uint32_t *first; /* of each polygon's triangles, and one past the last */
    tangent_corner *corners;
    tangent_triangle *triangles;
};

static inline void slvi_tangent_subtract(const float *a, const float *b, float out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

static inline void slvi_tangent_cross(const float *a, const float *b, float out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Into the plane of a normal, of length 1 or 0. */
static inline void slvi_tangent_project(const float n[3], float v[3]) {
    const float along = slvi_dot(n, v);
    for (int k = 0; k < 3; k++)
        v[k] -= along * n[k];
    slvi_normalise(v);
}

static inline const float *slvi_tangent_position(const slvi_tangents *t, uint32_t at) {
    return t->positions + 3 * (size_t)t->corners[at].vertex;
}

/* The angle at `at` between the sides to two others, as seen along a normal, or as it is. */
static inline float slvi_tangent_angle(const slvi_tangents *t, uint32_t before, uint32_t at,
                                       uint32_t after, const float *normal) {
    float a[3], b[3];
    slvi_tangent_subtract(slvi_tangent_position(t, before), slvi_tangent_position(t, at), a);
    slvi_tangent_subtract(slvi_tangent_position(t, after), slvi_tangent_position(t, at), b);
    if (normal) {
        slvi_tangent_project(normal, a);
        slvi_tangent_project(normal, b);
    } else {
        slvi_normalise(a);
        slvi_normalise(b);
    }
    return acosf(fminf(fmaxf(slvi_dot(a, b), -1), 1));
}

/* tangent_groups.c. A tangent for each corner, out of the triangles and what they meet. */
slv_result slvi_tangents_group(const slv_env *env, slvi_tangents *t);

#endif
