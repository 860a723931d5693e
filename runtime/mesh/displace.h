/* Moves the grids of all faces by a displacement. */
#ifndef SLV_MESH_DISPLACE_H
#define SLV_MESH_DISPLACE_H

#include "mesh/face_grid.h"

/* Before faces are evaluated; then for each what was found of it; and when positions are welded,
 * for all. */
slv_result slvi_displace_begin(const slv_env *env, slvi_grid_job *job);
void slvi_displace_face(const slvi_grid_job *job, uint32_t face, const slvi_face_grid *grid);
slv_result slvi_displace_end(const slv_env *env, slvi_grid_job *job);

#endif
