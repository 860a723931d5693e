/* What the numbers of a report say, in a sentence or two. */
#ifndef SELVAGE_TOOLS_REPORT_VERDICT_H
#define SELVAGE_TOOLS_REPORT_VERDICT_H

#include "compare/engine/report.h"

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
/* Whether a strategy is one of those that make the outcome what it is. */
bool report_reaches(const report_strategy *row, report_outcome outcome);
double report_memory_ratio(const report_strategy *row);
/* Whether a jump is below one step of an 8-bit texel. */
bool report_jump_hidden(double jump);

#endif
