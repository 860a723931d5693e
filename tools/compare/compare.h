/* What the verb compare is made of. */
#ifndef SELVAGE_TOOLS_COMPARE_H
#define SELVAGE_TOOLS_COMPARE_H

#include "command/scene.h"
#include "compare/engine/report.h"

/* Tables on a terminal, and the answer; `folder` is where the report is. */
void compare_print(const report_data *report, const char *folder);
/* The cameras of view files, which end in the report's proportions. */
slv_result compare_read_views(const slv_env *env, const cli_list *views, report_data *report);

#endif
