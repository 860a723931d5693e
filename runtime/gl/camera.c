#include <selvage/gl_renderer.h>

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846f

bool slv_shading_from_name(const char *name, slv_shading *out) {
    static const char *const names[] = {"headlight", "headlight-abs", "unlit", "faces", "levels"};
    for (int i = 0; i < 5; i++) {
        if (strcmp(name, names[i]) == 0) {
            *out = (slv_shading)i;
            return true;
        }
    }
    return false;
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

static float longest_edge_in_pixels(const slv_mesh_view *mesh, const slv_camera *camera,
                                    uint32_t width, uint32_t height) {
    const float *m = camera->world_to_camera;
    float scale_x = (float)width / (camera->window[1] - camera->window[0]);
    float scale_y = (float)height / (camera->window[3] - camera->window[2]);
    float longest = 0;
    const int32_t *verts = mesh->poly_verts;
    for (uint32_t p = 0; p < mesh->npolys; verts += mesh->poly_sizes[p++]) {
        float first[2] = {0}, before[2] = {0};
        bool behind = false;
        float here = 0;
        for (int32_t k = 0; k < mesh->poly_sizes[p]; k++) {
            const float *v = mesh->positions + 3 * (size_t)verts[k];
            float eye[3], at[2];
            for (int r = 0; r < 3; r++)
                eye[r] = m[4 * r] * v[0] + m[4 * r + 1] * v[1] + m[4 * r + 2] * v[2] + m[4 * r + 3];
            float depth = camera->perspective ? -eye[2] : 1;
            behind |= depth <= 1e-6f;
            at[0] = eye[0] / depth * scale_x;
            at[1] = eye[1] / depth * scale_y;
            if (k == 0)
                memcpy(first, at, sizeof first);
            else
                here = fmaxf(here, hypotf(at[0] - before[0], at[1] - before[1]));
            memcpy(before, at, sizeof before);
        }
        here = fmaxf(here, hypotf(first[0] - before[0], first[1] - before[1]));
        /* an edge seen from next to it is as long as the picture at most */
        here = behind || here > (float)(width + height) ? (float)(width + height) : here;
        longest = fmaxf(longest, here);
    }
    return longest;
}

uint32_t slv_tessellation_for(const slv_mesh *mesh, const slv_camera *camera, uint32_t width,
                              uint32_t height) {
    float wanted = longest_edge_in_pixels(slv_mesh_get_view(mesh), camera, width, height) / 3;
    uint64_t nfaces = slv_mesh_face_count(mesh), most = 2 * (uint64_t)width * height;
    uint32_t segments = 2;
    while (segments < 64 && (float)segments < wanted &&
           nfaces * segments * 2 * segments * 2 <= most)
        segments *= 2;
    return segments;
}
