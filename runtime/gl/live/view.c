/* How large a face is on the screen. */
#include "gl/live/residency.h"

#include <math.h>

#define MARGIN 1.25f /* of the window: surfaces bulge out of their corners */
#define STRETCH 1.5f /* texels may be longer in places than on average */

slvi_view slvi_view_of(const slv_camera *camera, uint32_t width, uint32_t height) {
    float across = (camera->window[1] - camera->window[0]) / (float)(width ? width : 1);
    float up = (camera->window[3] - camera->window[2]) / (float)(height ? height : 1);
    return (slvi_view){camera, fminf(fabsf(across), fabsf(up))};
}

bool slvi_camera_is_finite(const slv_camera *camera) {
    float sum = 0; /* of zeros, or no number */
    for (uint32_t i = 0; i < 16; i++)
        sum += 0 * camera->world_to_camera[i];
    for (uint32_t i = 0; i < 4; i++)
        sum += 0 * camera->window[i];
    return sum == 0;
}

static float edge_length(const float *a, const float *b) {
    float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return sqrtf(x * x + y * y + z * z);
}

/* Whether all corners are beyond one side of the window. */
static bool is_outside(const slv_camera *camera, float eye[4][3]) {
    float middle[2], half[2];
    for (uint32_t axis = 0; axis < 2; axis++) {
        float low = camera->window[2 * axis], high = camera->window[2 * axis + 1];
        middle[axis] = 0.5f * (low + high);
        half[axis] = 0.5f * MARGIN * fabsf(high - low);
    }
    uint32_t beyond[4] = {0}, behind = 0;
    for (uint32_t i = 0; i < 4; i++) {
        float depth = camera->perspective ? -eye[i][2] : 1;
        behind += depth <= 0;
        for (uint32_t axis = 0; axis < 2; axis++) {
            float at = eye[i][axis] - middle[axis] * depth;
            beyond[2 * axis] += at > half[axis] * depth;
            beyond[2 * axis + 1] += -at > half[axis] * depth;
        }
    }
    if (behind == 4)
        return true;
    if (behind)
        return false;
    return beyond[0] == 4 || beyond[1] == 4 || beyond[2] == 4 || beyond[3] == 4;
}

/* Halvings of an axis of 2^log2 texels after which one is still no longer than a pixel; an axis of
 * which one texel is enough stays at that through any further level. */
static uint32_t halvings(int log2, float length, float pixel) {
    float pixels = length / pixel; /* infinite next to the eye */
    int needed = pixels > 1 ? pixels < 65536 ? (int)ceilf(log2f(pixels)) : SLV_MAX_LOG2_RES : 0;
    if (!needed)
        return SLV_MAX_LOG2_RES;
    return needed < log2 ? (uint32_t)(log2 - needed) : 0;
}

bool slvi_view_level(const slvi_view *view, const float corners[12], slv_res res, float closer,
                     uint32_t *level) {
    const float *m = view->camera->world_to_camera;
    float eye[4][3], nearest = INFINITY;
    for (uint32_t i = 0; i < 4; i++) {
        const float *p = corners + 3 * i;
        for (uint32_t row = 0; row < 3; row++)
            eye[i][row] =
                m[4 * row] * p[0] + m[4 * row + 1] * p[1] + m[4 * row + 2] * p[2] + m[4 * row + 3];
        nearest = fminf(nearest, -eye[i][2]);
    }
    if (is_outside(view->camera, eye))
        return false;
    float pixel = view->pixel / (STRETCH * closer);
    if (view->camera->perspective)
        pixel *= nearest > 0 ? nearest : 0;
    float u = fmaxf(edge_length(eye[0], eye[1]), edge_length(eye[3], eye[2]));
    float v = fmaxf(edge_length(eye[1], eye[2]), edge_length(eye[0], eye[3]));
    uint32_t along_u = halvings(res.u, u, pixel), along_v = halvings(res.v, v, pixel);
    *level = along_u < along_v ? along_u : along_v;
    if (*level >= slv_res_level_count(res))
        *level = slv_res_level_count(res) - 1;
    return true;
}
