/* What a camera sees: where points lie in its picture, and what hides them. */
#include "surface/view.h"

/* How much nearer to the eye than a point another surface must be to hide it, in parts of its
 * distance. */
#define SHADOW 1e-4

bool slvi_view_make(const slv_paint_surface *s, const slv_camera *camera, uint32_t width,
                    uint32_t height, slvi_view *out) {
    float origin[3], direction[3], o[3], d[3];
    *out = (slvi_view){.camera = *camera, .width = width, .height = height};
    for (int k = 0; k < 12; k++)
        out->matrix[k] = (double)camera->world_to_camera[k];
    float middle[2] = {(float)width / 2, (float)height / 2};
    if (!slv_paint_surface_ray(s, camera, width, height, middle[0], middle[1], origin, direction) ||
        !slv_paint_surface_ray(s, camera, width, height, middle[0] + 1, middle[1], o, d))
        return false;
    for (int k = 0; k < 3; k++)
        out->towards[k] = -(double)direction[k];
    /* the eye is where its two rays meet: so far behind where they begin as these are apart */
    double spread = 0, apart = 0;
    for (int k = 0; k < 3; k++) {
        spread += ((double)d[k] - (double)direction[k]) * ((double)d[k] - (double)direction[k]);
        apart += ((double)o[k] - (double)origin[k]) * ((double)d[k] - (double)direction[k]);
    }
    for (int k = 0; k < 3 && camera->perspective; k++)
        out->eye[k] = (double)origin[k] - apart / spread * (double)direction[k];
    return true;
}

bool slvi_view_project(const slvi_view *v, const double p[3], double out[2]) {
    double c[3];
    const float *w = v->camera.window;
    for (int r = 0; r < 3; r++)
        c[r] = v->matrix[4 * r] * p[0] + v->matrix[4 * r + 1] * p[1] + v->matrix[4 * r + 2] * p[2] +
               v->matrix[4 * r + 3];
    double depth = v->camera.perspective ? -c[2] : 1;
    if (!(depth > 0))
        return false;
    out[0] = (c[0] / depth - (double)w[0]) / ((double)w[1] - (double)w[0]) * v->width;
    out[1] = ((double)w[3] - c[1] / depth) / ((double)w[3] - (double)w[2]) * v->height;
    return true;
}

bool slvi_view_faces(const slv_paint_surface *s, const slvi_view *v, uint32_t tri,
                     const double point[3]) {
    double normal[3], towards[3];
    for (int i = 0; i < 3; i++)
        towards[i] = v->camera.perspective ? v->eye[i] - point[i] : v->towards[i];
    slvi_tri_normal(s, tri, normal);
    return slvi_dot(normal, towards) > 0;
}

bool slvi_view_sees(const slv_painter *p, const slvi_view *v, const double point[3]) {
    float o[3], d[3];
    double pixel[2], to_point = 0, length = 0;
    slv_paint_hit hit;
    if (!slvi_view_project(v, point, pixel) ||
        !slv_paint_surface_ray(p->surface, &v->camera, v->width, v->height, (float)pixel[0],
                               (float)pixel[1], o, d) ||
        !slv_paint_surface_hit(p->surface, o, d, &hit))
        return true; /* on a silhouette the ray misses what is there */
    for (int k = 0; k < 3; k++) {
        to_point += (point[k] - (double)o[k]) * (double)d[k];
        length += (double)d[k] * (double)d[k];
    }
    return (double)hit.distance >= to_point / length * (1 - SHADOW) - 1e-6 * (double)p->size;
}
