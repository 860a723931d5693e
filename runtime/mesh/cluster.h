/* Surfaces of faces smaller than pixels, drawn with fewer triangles than faces. */
#ifndef SLV_MESH_CLUSTER_H
#define SLV_MESH_CLUSTER_H

#include "mesh/grid.h"

/* Draws vertices of such faces together where they share a part of a pixel of the camera's picture,
 * and gives edges that become one point 0 segments. `params` has been checked. */
slv_result slvi_cluster(const slv_env *env, slv_tessellation *grids,
                        const slv_tessellation_params *params);

#endif
