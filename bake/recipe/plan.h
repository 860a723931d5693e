/* How many texels each face of a bake is given. */
#ifndef SLV_BAKE_PLAN_H
#define SLV_BAKE_PLAN_H

#include "recipe/encode.h"

#include <selvage/bake.h>

/* For slvi_free; fills the texels and the smallest and largest face of the report. */
slv_result slvi_bake_plan(const slv_env *env, const slv_mesh *mesh, const slv_bake_source *source,
                          const slv_bake_job *job, const encoder *e, slv_res **out,
                          slv_bake_report *report);

#endif
