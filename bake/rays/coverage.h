/* How large faces are in pictures. */
#ifndef SLV_BAKE_COVERAGE_H
#define SLV_BAKE_COVERAGE_H

#include <selvage/bake.h>

/* Of each face how many pixels it is along u and v, two a face: the most in any of the views in
 * which some of it is seen; 0 if it is in none. */
slv_result slvi_coverage(const slv_env *env, const slv_mesh *mesh, slv_scheme scheme,
                         const slv_bake_view *views, uint32_t nviews, float *sizes);

#endif
