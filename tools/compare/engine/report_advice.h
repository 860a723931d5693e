/* Which strategy to use: a rule that weighs errors, memory and time in points. */
#ifndef SELVAGE_TOOLS_REPORT_ADVICE_H
#define SELVAGE_TOOLS_REPORT_ADVICE_H

#include "compare/engine/report.h"

/* What is weighed. All but time are the same in every run. */
typedef enum report_factor {
    REPORT_ERROR_INSIDE, /* RMS error of pixels that see one face */
    REPORT_ERROR_SEAMS,  /* of those at edges and vertices */
    REPORT_CLOSE_UP,     /* the largest jump of magnified lookups */
    REPORT_MEMORY,
    REPORT_TIME,
    REPORT_FACTORS
} report_factor;

/* A strategy has so many points for every time that its figure is twice the least of all, where
 * figures below `floor` count as that: nobody sees the difference. Fewer points are better. */
typedef struct report_weight {
    const char *title;
    double points, floor;
} report_weight;
report_weight report_weight_of(report_factor factor);

/* Time counts as far as it is certain: the lower end of a strategy's interval over the upper end of
 * the quickest's, over this margin. */
#define REPORT_TIME_MARGIN 1.25
/* Points that are no difference. */
#define REPORT_SAME_POINTS 0.05

/* One strategy. A figure that was not measured is NaN, and counts for nothing. */
typedef struct report_figures {
    double exact[REPORT_TIME]; /* by factor: linear values of 0..1, bytes */
    interval time;             /* ratio to the baseline */
} report_figures;

typedef struct report_advice {
    bool measured; /* false: no errors; the rest means nothing */
    uint32_t take, ntied;
    bool tied[REPORT_MAX_STRATEGIES]; /* as good as `take`, which is among them; ntied in all */
    double points[REPORT_MAX_STRATEGIES][REPORT_FACTORS];
    double low[REPORT_MAX_STRATEGIES], high[REPORT_MAX_STRATEGIES]; /* sums, by the ends of time */
} report_advice;

/* The strategy with the fewest points. Where another's reach down into the spread of its own they
 * are tied, and of those tied the one with the fewest points besides time is taken: so noise can
 * make a tie, but the winner of one does not change with it. */
report_advice report_advise_figures(const report_figures *figures, uint32_t count);

/* Of the orbit, and of the cameras that were given beside it. */
report_advice report_advise(const report_data *report);
report_advice report_advise_cameras(const report_data *report);

/* RMS error at seams of a strategy at a rate; NaN if not measured. */
double report_seam_error(const report_data *report, report_source source, uint32_t rate,
                         uint32_t strategy);

#endif
