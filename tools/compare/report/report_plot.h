/* Curves as SVG within the page. */
#ifndef SELVAGE_TOOLS_REPORT_PLOT_H
#define SELVAGE_TOOLS_REPORT_PLOT_H

#include "compare/engine/report.h"

typedef struct report_curve {
    const char *name;
    unsigned color; /* of the page's palette */
    const report_errors *errors;
} report_curve;

/* The share of all pixels further away than a distance, both axes logarithmic. `title` may hold
 * HTML. */
void report_write_plot(FILE *stream, const char *title, const char *label,
                       const report_curve *curves, uint32_t ncurves);

#endif
