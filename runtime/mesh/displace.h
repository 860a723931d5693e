/* Moves grids by a displacement. */
#ifndef SLV_MESH_DISPLACE_H
#define SLV_MESH_DISPLACE_H

#include "mesh/grid.h"

/* Room for the points of one face. */
typedef struct slvi_displace_scratch {
    float *uv, *values;
} slvi_displace_scratch;
slv_result slvi_displace_scratch_make(const slv_env *env, uint64_t points,
                                      slvi_displace_scratch *out);
void slvi_displace_scratch_free(slvi_displace_scratch *scratch);

/* Before faces are evaluated; then for each, whose limit is in `limit`; and when positions are
 * welded, for all. */
slv_result slvi_displace_begin(const slv_env *env, slvi_grid_job *job);
slv_result slvi_displace_face(const slvi_grid_job *job, uint32_t face,
                              const slv_surface_arrays *limit, slvi_displace_scratch *scratch);
slv_result slvi_displace_end(const slv_env *env, slvi_grid_job *job);

#endif
