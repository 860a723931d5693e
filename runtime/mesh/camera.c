/* Cameras around a model, and the names of shadings. */
#include "base/names.h"

#include <selvage/camera.h>

#include <float.h>
#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846f

static const char *const shadings[] = {"headlight", "headlight-abs",  "unlit", "faces",
                                       "levels",    "headlight-cos2", "image"};

static const char *const alpha_modes[] = {"ignore", "blend", "mask"};

const char *slv_alpha_mode_name(slv_alpha_mode mode) {
    return slvi_name_of(alpha_modes, SLVI_COUNT(alpha_modes), (int)mode);
}

const char *slv_shading_name(slv_shading shading) {
    return slvi_name_of(shadings, SLVI_COUNT(shadings), (int)shading);
}

bool slv_shading_from_name(const char *name, slv_shading *out) {
    int value = 0;
    bool found = slvi_name_find(shadings, SLVI_COUNT(shadings), name, &value);
    if (found)
        *out = (slv_shading)value;
    return found;
}

/* How far the corners of a box reach, in units of half the picture: with perspective the distance
 * at which all are inside, without it half the picture's height. */
static float fit_box(const float half[3], const float *rows[3], float tangent, float aspect) {
    float needed = 0;
    for (int corner = 0; corner < 8; corner++) {
        float at[3] = {0, 0, 0};
        for (int r = 0; r < 3; r++)
            for (int i = 0; i < 3; i++)
                at[r] += rows[r][i] * (corner >> i & 1 ? half[i] : -half[i]);
        float across = fmaxf(fabsf(at[0]) / aspect, fabsf(at[1]));
        needed = fmaxf(needed, tangent > 0 ? at[2] + across / tangent : across);
    }
    return needed > 0 ? needed * 1.04f : 1;
}

slv_camera slv_camera_orbit(const float bounds_min[3], const float bounds_max[3], float azimuth,
                            float elevation, float fov, float aspect) {
    slv_camera camera = {.perspective = fov > 0};
    float a = fmodf(azimuth, 360) * PI / 180, e = fmodf(elevation, 360) * PI / 180, radius = 0,
          half[3], center[3];
    for (int i = 0; i < 3; i++) {
        half[i] = (bounds_max[i] - bounds_min[i]) / 2;
        center[i] = bounds_min[i] + half[i];
        radius += half[i] * half[i];
    }
    radius = radius > 0 ? sqrtf(radius) : 1;
    /* rows: right, up, and back, which points from the centre to the eye */
    const float right[3] = {cosf(a), 0, -sinf(a)};
    const float back[3] = {sinf(a) * cosf(e), sinf(e), cosf(a) * cosf(e)};
    const float up[3] = {back[1] * right[2] - back[2] * right[1],
                         back[2] * right[0] - back[0] * right[2],
                         back[0] * right[1] - back[1] * right[0]};
    const float *rows[3] = {right, up, back};
    float tangent = camera.perspective ? tanf(fov * PI / 360) : 0;
    float fit = fit_box(half, rows, tangent, aspect);
    float distance = camera.perspective ? fit : 2 * radius;
    for (int r = 0; r < 3; r++) {
        float *row = camera.world_to_camera + 4 * r;
        memcpy(row, rows[r], 3 * sizeof *row);
        row[3] = -(row[0] * center[0] + row[1] * center[1] + row[2] * center[2]);
    }
    camera.world_to_camera[11] -= distance;
    camera.world_to_camera[15] = 1;
    float half_height = camera.perspective ? tangent : fit;
    camera.window[0] = -half_height * aspect;
    camera.window[1] = half_height * aspect;
    camera.window[2] = -half_height;
    camera.window[3] = half_height;
    return camera;
}

void slv_camera_depths(const slv_camera *camera, const float bounds_min[3],
                       const float bounds_max[3], float *nearest, float *farthest) {
    const float *m = camera->world_to_camera;
    float highest = -INFINITY, lowest = INFINITY; /* z in eye space: the eye looks down -z */
    for (int corner = 0; corner < 8; corner++) {
        float z = m[11];
        for (int c = 0; c < 3; c++)
            z += m[8 + c] * (corner >> c & 1 ? bounds_max[c] : bounds_min[c]);
        highest = fmaxf(highest, z);
        lowest = fminf(lowest, z);
    }
    float margin =
        (highest - lowest) * 0.01f + fmaxf(fabsf(highest), fabsf(lowest)) * 1e-6f + FLT_MIN;
    float n = -(highest + margin), f = -(lowest - margin);
    if (camera->perspective) {
        f = fmaxf(f, FLT_MIN * 1e5f);
        n = fmaxf(n, f * 1e-4f);
        f = fmaxf(f, n * 1.001f);
    }
    *nearest = n;
    *farthest = f;
}

void slv_camera_normal_matrix(const slv_camera *camera, float out[9]) {
    const float *m = camera->world_to_camera;
    float determinant = 0;
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) {
            int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            float cofactor = m[4 * r1 + c1] * m[4 * r2 + c2] - m[4 * r1 + c2] * m[4 * r2 + c1];
            out[3 * r + c] = cofactor;
            determinant += r == 0 ? cofactor * m[c] : 0;
        }
    }
    for (int i = 0; determinant < 0 && i < 9; i++)
        out[i] = -out[i];
}
