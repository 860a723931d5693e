/* How many segments each face needs for a picture. */
#ifndef SLV_MESH_RATES_H
#define SLV_MESH_RATES_H

#include "mesh/face_grid.h"

/* Writes the segments of every face that has any, and into job->spacing (which has room) how fine
 * its displacement is looked up: a pixel. `params` has been checked. */
slv_result slvi_choose_rates(const slv_env *env, slvi_grid_job *job,
                             const slv_tessellation_params *params);

#endif
