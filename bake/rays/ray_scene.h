/* Triangles that rays are cast at. */
#ifndef SLV_BAKE_RAY_SCENE_H
#define SLV_BAKE_RAY_SCENE_H

#include "rays/embree.h"

#include <selvage/tessellation.h>

typedef struct ray_scene {
    RTCDevice device;
    RTCScene scene;
    float *points;       /* 3 a vertex, and one to spare, which Embree reads */
    float *normals;      /* 3 a vertex, or NULL */
    float *own_normals;  /* of the mesh itself, 9 a triangle, zeros where it has none; or NULL */
    uint32_t *triangles; /* 3 vertices each */
    uint64_t nvertices, ntriangles;
    float low[3], high[3];
} ray_scene;

/* The limit surface as a tessellation has it. `progress` is asked whether to go on, or NULL. */
slv_result slvi_ray_scene_of_surface(const slv_env *env, const slv_tessellation *tessellation,
                                     const slv_progress *progress, ray_scene *out);
/* The polygons of a mesh as they stand, holes left out, relative to `origin`; with the mesh's own
 * normals, and where it has none the vertices', each the mean of its polygons' by their angles. */
slv_result slvi_ray_scene_of_polygons(const slv_env *env, const slv_mesh *mesh,
                                      const double origin[3], ray_scene *out);
void slvi_ray_scene_free(ray_scene *scene);

/* Whether anything lies on a ray within `distance`. `direction` has length 1. */
bool slvi_ray_is_blocked(const ray_scene *scene, const float origin[3], const float direction[3],
                         float distance);
/* So for many rays; those that meet something end there, at less than 0. */
void slvi_rays_block(const ray_scene *scene, struct RTCRay *rays, uint32_t count);
/* The first thing on a ray: its distance, or infinity. The triangle and the place in it may be
 * NULL.
 */
float slvi_ray_cast(const ray_scene *scene, const float origin[3], const float direction[3],
                    float distance, uint32_t *triangle, float weights[2]);

#endif
