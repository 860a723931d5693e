/* The camera turned round, from pixels to rays. */
#include "rays/reference_data.h"

#include <math.h>
#include <string.h>

bool slvi_reference_eye_make(const slv_reference *reference, const slv_camera *camera,
                             reference_eye *out) {
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
            return false;
    }
    out->perspective = camera->perspective;
    memcpy(out->window, w, sizeof out->window);
    slv_camera_depths(camera, reference->mesh.bounds_min, reference->mesh.bounds_max, &out->nearest,
                      &farthest);
    slv_camera_normal_matrix(camera, out->normal_matrix);
    return w[1] > w[0] && w[3] > w[2] && isfinite(w[1] - w[0]) && isfinite(w[3] - w[2]);
}
