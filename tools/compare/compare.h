/* The parts of a comparison besides the frames of its orbit. */
#ifndef SELVAGE_TOOLS_COMPARE_H
#define SELVAGE_TOOLS_COMPARE_H

#include "compare/experiment.h"

/* Views, their differences, places to look at closely, and what the references show there. */
slv_result compare_draw_pictures(experiment *e);

/* The same views from a texture in blocks, and what that costs; after the above. */
slv_result compare_draw_compressed(const experiment *e, slv_gl_texture *blocks);

/* The outcome as tables on stdout. */
void compare_print(const report_data *report, const char *folder);

#endif
