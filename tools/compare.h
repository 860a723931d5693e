/* The parts of a comparison besides the frames of its orbit. */
#ifndef SELVAGE_TOOLS_COMPARE_H
#define SELVAGE_TOOLS_COMPARE_H

#include "experiment.h"

/* Views, their differences, places to look at closely, and what the references show there. */
slv_result compare_draw_pictures(experiment *e);

/* The outcome as tables on stdout. */
void compare_print(const report_data *report, const char *folder);

#endif
