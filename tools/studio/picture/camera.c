/* Orbits, pans and zooms. */
#include "studio/picture/camera.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846f

/* Rows: right, up, back. */
static void axes_of(const studio_camera *c, float axes[3][3]) {
    float a = c->azimuth * PI / 180, e = c->elevation * PI / 180;
    const float right[3] = {cosf(a), 0, -sinf(a)};
    const float back[3] = {sinf(a) * cosf(e), sinf(e), cosf(a) * cosf(e)};
    const float up[3] = {back[1] * right[2] - back[2] * right[1],
                         back[2] * right[0] - back[0] * right[2],
                         back[0] * right[1] - back[1] * right[0]};
    memcpy(axes[0], right, sizeof right);
    memcpy(axes[1], up, sizeof up);
    memcpy(axes[2], back, sizeof back);
}

static float half_height(const studio_camera *c) {
    return c->distance * tanf(c->fov * PI / 360);
}

slv_camera studio_camera_get(const studio_camera *c, float aspect) {
    slv_camera camera = {.perspective = !c->orthographic};
    float axes[3][3], h = c->orthographic ? half_height(c) : tanf(c->fov * PI / 360);
    axes_of(c, axes);
    for (int r = 0; r < 3; r++) {
        float *row = camera.world_to_camera + 4 * r;
        memcpy(row, axes[r], sizeof axes[r]);
        row[3] = -(row[0] * c->target[0] + row[1] * c->target[1] + row[2] * c->target[2]);
    }
    camera.world_to_camera[11] -= c->distance;
    camera.world_to_camera[15] = 1;
    camera.window[0] = -h * aspect;
    camera.window[1] = h * aspect;
    camera.window[2] = -h;
    camera.window[3] = h;
    return camera;
}

void studio_camera_set(studio_camera *c, const slv_camera *from, const float low[3],
                       const float high[3]) {
    const float *m = from->world_to_camera;
    float eye[3], depth = 0, scale = sqrtf(m[8] * m[8] + m[9] * m[9] + m[10] * m[10]);
    float high_half = fmaxf(fabsf(from->window[2]), fabsf(from->window[3]));
    for (int i = 0; i < 3; i++)
        eye[i] = -(m[i] * m[3] + m[4 + i] * m[7] + m[8 + i] * m[11]) / (scale * scale);
    for (int i = 0; i < 3; i++)
        depth += (eye[i] - (low[i] + high[i]) / 2) * m[8 + i] / scale;
    c->orthographic = !from->perspective;
    c->azimuth = atan2f(m[8], m[10]) * 180 / PI;
    c->elevation = asinf(fminf(fmaxf(m[9] / scale, -1), 1)) * 180 / PI;
    if (from->perspective) {
        c->fov = 2 * atanf(high_half) * 180 / PI;
        c->distance = depth > 0 ? depth : 1;
    } else {
        c->distance = high_half / tanf(c->fov * PI / 360);
    }
    for (int i = 0; i < 3; i++)
        c->target[i] = eye[i] - m[8 + i] / scale * (from->perspective ? c->distance : depth);
}

void studio_camera_frame(studio_camera *c, const float low[3], const float high[3], float aspect) {
    slv_camera framed = slv_camera_orbit(low, high, c->azimuth, c->elevation, c->fov, aspect);
    bool orthographic = c->orthographic;
    studio_camera_set(c, &framed, low, high);
    c->orthographic = orthographic;
}

void studio_camera_orbit(studio_camera *c, float dx, float dy) {
    c->azimuth = fmodf(c->azimuth - dx * 0.4f, 360);
    c->elevation = fminf(fmaxf(c->elevation + dy * 0.4f, -90), 90);
}

void studio_camera_pan(studio_camera *c, float dx, float dy, uint32_t height) {
    float axes[3][3], unit = 2 * half_height(c) / (float)(height ? height : 1);
    axes_of(c, axes);
    for (int i = 0; i < 3; i++)
        c->target[i] += unit * (-dx * axes[0][i] + dy * axes[1][i]);
}

void studio_camera_zoom(studio_camera *c, float factor) {
    c->distance = fminf(fmaxf(c->distance / factor, 1e-12f), 1e12f);
}
