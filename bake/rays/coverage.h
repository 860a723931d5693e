/* How large faces are in pictures. */
#ifndef SLV_BAKE_COVERAGE_H
#define SLV_BAKE_COVERAGE_H

#include <selvage/bake.h>

/* Of each face how many pixels it is along u and v, two a face: the most in any of the views in
 * which some of it is seen; 0 if it is in none. By the job's views and surface; its progress is
 * asked whether to go on. */
slv_result slvi_coverage(const slv_env *env, const slv_mesh *mesh, const slv_bake_job *job,
                         float *sizes);

#endif
