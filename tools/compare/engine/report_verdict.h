/* What the numbers of a report say, in a sentence or two. */
#ifndef SELVAGE_TOOLS_REPORT_VERDICT_H
#define SELVAGE_TOOLS_REPORT_VERDICT_H

#include "compare/engine/report.h"

#include <stdio.h>

typedef enum report_outcome {
    REPORT_NO_SEAMS,    /* the mesh has no shared edges */
    REPORT_SEAMLESS,    /* the best has no visible seam */
    REPORT_EQUAL_ONLY,  /* none between faces of equal resolution */
    REPORT_ALL_VISIBLE, /* every strategy shows seams */
} report_outcome;

typedef struct report_verdict {
    report_outcome outcome;
    uint32_t best; /* index of a strategy: the one with the least memory that reaches the outcome */
    uint32_t baseline; /* index of clamp, or 0 */
} report_verdict;

/* `report` has at least one strategy. */
report_verdict report_judge(const report_data *report);
/* As HTML, names in <strong>. */
void report_write_verdict(FILE *stream, const report_data *report, const report_verdict *verdict);

/* A jump of 0..1 in steps of 1/255, two or three digits. */
void report_write_jump(FILE *stream, double jump);
double report_memory_ratio(const report_strategy *row);
/* Whether a jump is below one step of an 8-bit texel. */
bool report_jump_hidden(double jump);

#endif
