/* What the numbers of a report say, in sentences. */
#ifndef SELVAGE_TOOLS_REPORT_WORDS_H
#define SELVAGE_TOOLS_REPORT_WORDS_H

#include "compare/engine/report_advice.h"
#include "compare/engine/report_verdict.h"

#include <stdio.h>

/* As HTML, names in <strong>. */
void report_write_verdict(FILE *stream, const report_data *report, const report_verdict *verdict);
/* A sentence or two, names in <strong>; and the rule in words and numbers, with all points. */
void report_write_advice(FILE *stream, const report_data *report, const report_advice *advice);
void report_write_rule(FILE *stream, const report_data *report, const report_advice *advice);
/* The names of those tied with the one to take: "hybrid and htex". Plain text. */
void report_write_tied(FILE *stream, const report_data *report, const report_advice *advice);
/* A jump of 0..1 in steps of 1/255, two or three digits. */
void report_write_jump(FILE *stream, double jump);

#endif
