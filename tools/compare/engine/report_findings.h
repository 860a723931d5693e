/* Which strategy to use, and whether what Toth found in 2013 is found here: rules on numbers. */
#ifndef SELVAGE_TOOLS_REPORT_FINDINGS_H
#define SELVAGE_TOOLS_REPORT_FINDINGS_H

#include "compare/engine/report.h"

/* Of the strategies whose RMS error at seams (pixels at edges and vertices, against the first
 * reference, at the rate that is shown) is at most REPORT_NEAR_BEST times the smallest, the
 * quickest; or of those that take at most REPORT_SAME_TIME times its time, the one with the least
 * memory. */
#define REPORT_NEAR_BEST 1.1
#define REPORT_SAME_TIME 1.05

typedef struct report_advice {
    bool measured; /* false: no reference, or no seams in the pictures; the rest means nothing */
    uint32_t take, closest, quickest; /* strategies: advised, of the smallest error, of all */
} report_advice;

report_advice report_advise(const report_data *report);
/* RMS error at seams of a strategy at a rate; NaN if not measured. */
double report_seam_error(const report_data *report, report_source source, uint32_t rate,
                         uint32_t strategy);
/* As HTML. */
void report_write_advice(FILE *stream, const report_data *report, const report_advice *advice);

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
