/* Where the camera is at a moment of the orbit. */
#include "compare/engine/orbit.h"

#include <math.h>

static const double two_pi = 6.283185307179586;

slv_camera orbit_camera(const orbit *path, double t) {
    double elevation = (double)path->elevation + (double)path->tilt * sin(3 * two_pi * t);
    slv_camera camera = slv_camera_orbit(path->bounds_min, path->bounds_max,
                                         path->azimuth + (float)(t * (double)path->turn),
                                         (float)elevation, path->fov, path->aspect);
    double factor = pow((double)path->dolly, -sin(two_pi * t)), reach = 0, distance = 0;
    float *back = camera.world_to_camera + 8; /* its z axis, and minus the distance */
    if (!camera.perspective) {
        for (int k = 0; k < 4; k++)
            camera.window[k] *= (float)factor;
        return camera;
    }
    for (int k = 0; k < 3; k++) {
        double half = ((double)path->bounds_max[k] - (double)path->bounds_min[k]) / 2;
        reach += fabs((double)back[k]) * half;
        distance -= (double)back[k] * ((double)path->bounds_min[k] + half);
    }
    distance -= (double)back[3];
    double wanted = fmax(distance * factor, fmin(distance, 1.02 * reach));
    back[3] += (float)(distance - wanted);
    return camera;
}

slv_camera orbit_shifted(const slv_camera *camera, uint32_t width, uint32_t height, float dx,
                         float dy) {
    slv_camera moved = *camera;
    float *w = moved.window;
    float across = dx * (w[1] - w[0]) / (float)width, down = dy * (w[3] - w[2]) / (float)height;
    w[0] += across;
    w[1] += across;
    w[2] -= down;
    w[3] -= down;
    return moved;
}

slv_camera orbit_part(const slv_camera *camera, double left, double top, double right,
                      double bottom) {
    slv_camera part = *camera;
    const float *w = camera->window;
    double width = (double)w[1] - (double)w[0], height = (double)w[3] - (double)w[2];
    part.window[0] = (float)((double)w[0] + left * width);
    part.window[1] = (float)((double)w[0] + right * width);
    part.window[2] = (float)((double)w[3] - bottom * height);
    part.window[3] = (float)((double)w[3] - top * height);
    return part;
}
