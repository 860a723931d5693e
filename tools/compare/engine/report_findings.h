/* Whether what Toth found in 2013 is found here: rules on numbers. */
#ifndef SELVAGE_TOOLS_REPORT_FINDINGS_H
#define SELVAGE_TOOLS_REPORT_FINDINGS_H

#include "compare/engine/report.h"

typedef enum report_judgement {
    REPORT_UNMEASURED, /* a strategy, rate or reference is missing */
    REPORT_REPRODUCED,
    REPORT_REFUTED,
    REPORT_UNDECIDED, /* a difference of at most 2 % */
} report_judgement;

enum { REPORT_FINDINGS = 7 };

typedef struct report_finding {
    const char *claim;
    report_judgement judgement;
    char numbers[256];
} report_finding;

/* By the RMS error of all pixels, outlines included, against the supersampled reference, which is
 * Toth's own, or else the first that there is. */
void report_find_out(const report_data *report, report_finding findings[REPORT_FINDINGS]);
const char *report_judgement_name(report_judgement judgement);

#endif
