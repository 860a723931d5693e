/* The camera turned round, from pixels to rays. */
#include "rays/reference_data.h"

#include "base/log.h"

#include <math.h>
#include <string.h>

/* Whether all rays keep in the bounds, also those that begin a window's size beside it, further
 * than any pixel filter reaches. */
static bool is_in_reach(const reference_eye *e) {
    const float *w = e->window;
    double x = fmax(fabs((double)w[0]), fabs((double)w[1])) + ((double)w[1] - (double)w[0]);
    double y = fmax(fabs((double)w[2]), fabs((double)w[3])) + ((double)w[3] - (double)w[2]);
    for (int k = 0; k < 3; k++) {
        double across = x * fabs((double)e->x[k]) + y * fabs((double)e->y[k]);
        double along = fabs((double)e->z[k]) * (1 + fabs((double)e->nearest));
        if (!(across + along + fabs((double)e->origin[k]) < (double)EMBREE_FARTHEST))
            return false;
    }
    return fabsf(e->nearest) < EMBREE_FARTHEST;
}

slv_result slvi_reference_eye_make(const slv_env *env, const slv_reference *reference,
                                   const slv_camera *camera, reference_eye *out) {
    const float *m = camera->world_to_camera, *w = camera->window;
    double columns[3][3], determinant = 0;
    float farthest;
    for (int c = 0; c < 3; c++) { /* of the inverse */
        for (int r = 0; r < 3; r++) {
            int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            columns[c][r] =
                (double)m[4 * c1 + r1] * m[4 * c2 + r2] - (double)m[4 * c1 + r2] * m[4 * c2 + r1];
        }
    }
    for (int r = 0; r < 3; r++)
        determinant += m[r] * columns[0][r];
    for (int r = 0; r < 3; r++) {
        double origin = 0;
        for (int c = 0; c < 3; c++) {
            columns[c][r] /= determinant;
            origin -= columns[c][r] * m[4 * c + 3];
        }
        out->x[r] = (float)columns[0][r];
        out->y[r] = (float)columns[1][r];
        out->z[r] = (float)columns[2][r];
        out->origin[r] = (float)origin;
        if (!isfinite(out->x[r]) || !isfinite(out->y[r]) || !isfinite(out->z[r]) ||
            !isfinite(out->origin[r]))
            return slvi_fail(env, SLV_ERROR_ARGUMENT, "reference: the camera cannot be inverted");
    }
    out->perspective = camera->perspective;
    memcpy(out->window, w, sizeof out->window);
    slv_camera_depths(camera, reference->mesh.bounds_min, reference->mesh.bounds_max, &out->nearest,
                      &farthest);
    if (!reference->mesh.first[reference->mesh.nfaces])
        out->nearest = 0; /* there is nothing to be near */
    slv_camera_normal_matrix(camera, out->normal_matrix);
    if (!(w[1] > w[0] && w[3] > w[2]))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "reference: the camera's window is empty");
    if (!is_in_reach(out))
        return slvi_fail(env, SLV_ERROR_LIMIT,
                         "reference: the camera's rays begin or go further than %g away",
                         (double)EMBREE_FARTHEST);
    return SLV_OK;
}
