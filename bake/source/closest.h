/* The nearest point of a surface given as triangles, through a tree of boxes. */
#ifndef SLV_BAKE_CLOSEST_H
#define SLV_BAKE_CLOSEST_H

#include <selvage/surface.h>

typedef struct slv_closest slv_closest;

typedef struct slv_closest_hit {
    slv_surface_point point; /* face -1: there is no triangle at all, or none that counts */
    float distance;
    float position[3];
} slv_closest_hit;

/* How finely faces are to be sampled. */
uint32_t slvi_closest_segments(const slv_mesh *mesh, slv_scheme scheme);
/* Samples every face of the surface on a grid of segments x segments. */
slv_result slvi_closest_create(const slv_env *env, const slv_surface *surface, uint32_t segments,
                               slv_closest **out);
void slvi_closest_destroy(slv_closest *closest);
/* If `normal` is not NULL, only triangles that face the same way count, and after some thousands
 * that do not no more are looked at. What is further away than `within` (which may be infinite)
 * need not be found. Thread-safe. */
slv_closest_hit slvi_closest_find(const slv_closest *closest, const float position[3],
                                  const float *normal, float within);
/* The length of the diagonal of the box around everything. */
float slvi_closest_diagonal(const slv_closest *closest);

#endif
