/* The ray-cast pictures of a comparison, and how far the strategies are from them. */
#ifndef SELVAGE_TOOLS_COMPARE_REFERENCE_H
#define SELVAGE_TOOLS_COMPARE_REFERENCE_H

#include "report.h"
#include "scene.h"

/* Casts report->nviews pictures with the cameras and shading of `frames`, with the filter and
 * number of samples that report->reference says, and measures every strategy's views against them.
 */
slv_result compare_reference(const slv_env *env, const scene_data *scene, const slv_frame *frames,
                             bool quiet, report_data *report);

/* The errors as a table on stdout; nothing without a reference. */
void compare_print_errors(const report_data *report);

#endif
