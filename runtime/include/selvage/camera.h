/* What looks at a surface: a camera, and how the surface is shaded for it. */
#ifndef SELVAGE_CAMERA_H
#define SELVAGE_CAMERA_H

#include <selvage/result.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A right-handed eye that looks down its own -z. Matrices are row-major and act on column vectors.
 * The world is that of the mesh's positions, which are relative to its origin (slv_mesh_view). */
typedef struct slv_camera {
    float world_to_camera[16];
    bool perspective;
    /* left, right, bottom, top: on the plane at distance 1 with perspective, else in eye units */
    float window[4];
} slv_camera;

/* Frames a box from a direction: azimuth in degrees from +z towards +x around the y axis, elevation
 * in degrees above the horizon, vertical field of view in degrees (0 means orthographic), aspect =
 * width / height. */
SLV_API slv_camera slv_camera_orbit(const float bounds_min[3], const float bounds_max[3],
                                    float azimuth, float elevation, float fov, float aspect);

/* The depths, distances along the eye's -z, between which a box is drawn. With perspective both are
 * positive: what is nearer than 1/10000 of the farthest, or behind the eye, is not drawn. */
SLV_API void slv_camera_depths(const slv_camera *camera, const float bounds_min[3],
                               const float bounds_max[3], float *nearest, float *farthest);

/* The matrix that carries normals to the eye: the inverse transpose of the camera's upper left 3x3,
 * up to a positive factor, row-major. */
SLV_API void slv_camera_normal_matrix(const slv_camera *camera, float out[9]);

typedef enum slv_shading {
    SLV_SHADE_HEADLIGHT = 0, /* c * (kd * max(dot(n, -i), 0) + ka), i from the eye to the surface */
    SLV_SHADE_HEADLIGHT_ABS, /* c * kd * clamp(abs(dot(n, i)) + ka, 0, 1) */
    SLV_SHADE_UNLIT,         /* c */
    SLV_SHADE_FACES,         /* a colour per face, lit: where the faces are */
    SLV_SHADE_LEVELS,        /* the level that a lookup uses, from 0 (red) to coarse (blue) */
    SLV_SHADE_HEADLIGHT_COS2, /* c * (ka + kd * dot(n, i)^2) */
    SLV_SHADE_IMAGE           /* c * what a light from all around (slv_light) sends to n */
} slv_shading;

/* What becomes of an alpha channel. */
typedef enum slv_alpha_mode {
    SLV_ALPHA_IGNORE = 0, /* colours are shown as they are stored, all of the surface is opaque */
    SLV_ALPHA_BLEND,      /* what lies behind shows through */
    SLV_ALPHA_MASK        /* the surface is cut out where alpha is below 1/2 */
} slv_alpha_mode;

/* ignore, blend, mask */
SLV_API const char *slv_alpha_mode_name(slv_alpha_mode mode);

/* headlight, headlight-abs, unlit, faces, levels, headlight-cos2, image */
SLV_API const char *slv_shading_name(slv_shading shading);
SLV_API bool slv_shading_from_name(const char *name, slv_shading *out);

#ifdef __cplusplus
}
#endif

#endif
