/* The files that tell of a comparison's outcome. */
#ifndef SELVAGE_TOOLS_REPORT_FILES_H
#define SELVAGE_TOOLS_REPORT_FILES_H

#include "compare/engine/report.h"

#include <jansson.h>

/* Pictures as PNG into `folder`: view0_clamp.png, seam0_clamp.png, difference_clamp_borders.png,
 * ... */
slv_result report_write_pictures(const slv_env *env, const char *folder, const report_data *report);
/* NULL if there is no memory for it. */
json_t *report_json(const report_data *report);
slv_result report_write_json(const slv_env *env, const char *path, const report_data *report);
/* What the report's tables and curves are made of, as CSV, and its table for papers. */
slv_result report_write_tables(const slv_env *env, const char *folder, const report_data *report);
/* One file with everything in it; needs no network and no neighbours. */
slv_result report_write_html(const slv_env *env, const char *path, const report_data *report);

#endif
