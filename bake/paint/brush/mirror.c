/* What planes reflect: points of the surface, cameras, and how paint is laid. */
#include "brush/mirror.h"

static void reflect(const slv_mirror *m, float v[3], bool is_point) {
    double n = 0, d = 0;
    for (int k = 0; k < 3; k++) {
        n += (double)m->normal[k] * (double)m->normal[k];
        d += (double)m->normal[k] * ((double)v[k] - (is_point ? (double)m->point[k] : 0));
    }
    for (int k = 0; k < 3; k++)
        v[k] = (float)((double)v[k] - 2 * d / n * (double)m->normal[k]);
}

/* A camera that sees the reflected world as the other one sees the world: its matrix takes the
 * reflection first. */
static void reflect_camera(const slv_mirror *m, slv_camera *camera) {
    float *w = camera->world_to_camera;
    double n = 0, at = 0;
    for (int k = 0; k < 3; k++) {
        n += (double)m->normal[k] * (double)m->normal[k];
        at += (double)m->normal[k] * (double)m->point[k];
    }
    for (int row = 0; row < 3; row++) {
        double along = 0;
        for (int k = 0; k < 3; k++)
            along += (double)w[4 * row + k] * (double)m->normal[k];
        for (int k = 0; k < 3; k++)
            w[4 * row + k] = (float)((double)w[4 * row + k] - 2 * along / n * (double)m->normal[k]);
        w[4 * row + 3] = (float)((double)w[4 * row + 3] + 2 * along * at / n);
    }
}

bool slvi_mirror_point(const slvi_mirrors *mirrors, unsigned which, float reach,
                       slv_surface_point *at, float axis[3]) {
    float p[3], normal[3], direction[3];
    slv_paint_hit hit;
    if (!slv_paint_surface_at(mirrors->surface, *at, p, normal, NULL))
        return false;
    for (unsigned i = 0; i < mirrors->count; i++)
        if (which >> i & 1) {
            reflect(&mirrors->list[i], p, true);
            reflect(&mirrors->list[i], normal, false);
            reflect(&mirrors->list[i], axis, false);
        }
    for (int k = 0; k < 3; k++) { /* from as far above, so far down again and as far below */
        p[k] += reach * normal[k];
        direction[k] = -reach * normal[k];
    }
    if (!slv_paint_surface_hit(mirrors->surface, p, direction, &hit) || !(hit.distance <= 2))
        return false;
    *at = hit.point;
    return true;
}

void slvi_mirror_camera(const slvi_mirrors *mirrors, unsigned which, slv_camera *camera) {
    for (unsigned i = 0; i < mirrors->count; i++)
        if (which >> i & 1)
            reflect_camera(&mirrors->list[i], camera);
}

bool slvi_mirror_lay(const slvi_mirrors *mirrors, unsigned which, float reach, slv_lay *lay,
                     slv_camera *facing) {
    slv_ink *ink = &lay->ink;
    slv_mask *mask = &lay->mask;
    slvi_mirror_camera(mirrors, which, &ink->camera);
    if (mask->facing) {
        *facing = *mask->facing;
        slvi_mirror_camera(mirrors, which, facing);
        mask->facing = facing;
    }
    for (unsigned i = 0; i < mirrors->count; i++)
        if (which >> i & 1) {
            reflect(&mirrors->list[i], ink->from, true);
            reflect(&mirrors->list[i], ink->to, true);
            reflect(&mirrors->list[i], mask->towards, false);
        }
    ink->flip = slvi_mirror_turns(which);
    return ink->kind != SLV_INK_CLONE ||
           slvi_mirror_point(mirrors, which, reach, &ink->source, ink->axis);
}
