/* The nearest thing along a normal, both ways, that faces the same way. */
#ifndef SLV_BAKE_LOOK_H
#define SLV_BAKE_LOOK_H

#include "rays/ray_scene.h"

#include <selvage/bake.h>

typedef struct ray_look {
    const ray_scene *scene;
    float front, back; /* how far outwards and inwards */
    float size;        /* what coordinates reach: how exactly a point can be told */
} ray_look;

typedef struct ray_found {
    float distance; /* from the surface, negative inwards */
    uint32_t triangle;
    float weights[2];
    bool any, behind; /* behind: something of the wrong side was in the way */
} ray_found;

/* From a point of a surface with its unit normal. SLV_BAKE_HIT, or why there is nothing. */
slv_bake_miss slvi_ray_look(const ray_look *look, const float point[3], const float normal[3],
                            ray_found *out);
/* From a point of a cage through one of the surface and look->back beyond: the first thing that
 * faces the cage. */
slv_bake_miss slvi_ray_look_from(const ray_look *look, const float cage[3], const float point[3],
                                 ray_found *out);
/* The normal of a scene at a place: the smooth one if it has some, else the triangle's. */
void slvi_ray_normal(const ray_scene *scene, uint32_t triangle, const float weights[2],
                     float out[3]);

#endif
