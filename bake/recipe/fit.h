/* The least resolutions whose reconstruction stays near a source. */
#ifndef SLV_BAKE_FIT_H
#define SLV_BAKE_FIT_H

#include "recipe/encode.h"

#include <selvage/bake.h>

/* Chooses the resolution of each face, `res`, by job->max_error, and fills the errors of the
 * report.
 */
slv_result slvi_bake_fit(const slv_env *env, const slv_bake_source *source, const slv_bake_job *job,
                         const encoder *e, slv_res *res, slv_bake_report *report);

/* The same with the least error of which all faces together have at most `most` texels;
 * SLV_ERROR_LIMIT if there is none. */
slv_result slvi_bake_fit_within(const slv_env *env, const slv_bake_source *source,
                                const slv_bake_job *job, const encoder *e, uint64_t most,
                                slv_res *res, slv_bake_report *report);

#endif
