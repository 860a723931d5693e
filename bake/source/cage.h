/* Cages: meshes like the one that is baked, a little outside of it, from which rays go inwards. */
#ifndef SLV_BAKE_CAGE_H
#define SLV_BAKE_CAGE_H

#include <selvage/surface.h>

typedef struct bake_cage {
    slv_surface *surface; /* NULL: none */
    float offset[3];      /* from its frame to the mesh's */
} bake_cage;

/* SLV_ERROR_MISMATCH, and where, if it is not made of the mesh's polygons. `cage` may be NULL. */
slv_result slvi_cage_create(const slv_env *env, const slv_mesh *mesh, const slv_mesh *cage,
                            slv_scheme scheme, bake_cage *out);
/* Makes a box as large that the mesh `given` is in it as well, moved by `offset` (may be NULL). */
void slvi_cage_bound(const bake_cage *cage, const slv_mesh *given, const float *offset,
                     float low[3], float high[3]);
void slvi_cage_destroy(bake_cage *cage);
/* Where it is over points of the mesh, in the mesh's frame. */
slv_result slvi_cage_points(const bake_cage *cage, size_t count, const slv_surface_point *points,
                            float *positions);

#endif
