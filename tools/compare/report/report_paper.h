/* The table of times and errors, to be pasted into papers. */
#ifndef SELVAGE_TOOLS_REPORT_PAPER_H
#define SELVAGE_TOOLS_REPORT_PAPER_H

#include "compare/engine/report.h"

void report_write_latex(FILE *stream, const report_data *report);
void report_write_markdown(FILE *stream, const report_data *report);
void report_write_csv(FILE *stream, const report_data *report);

#endif
