/* What the verb compare prints. */
#ifndef SELVAGE_TOOLS_COMPARE_H
#define SELVAGE_TOOLS_COMPARE_H

#include "compare/engine/report.h"

/* The outcome as tables on stdout. */
void compare_print(const report_data *report, const char *folder);

#endif
