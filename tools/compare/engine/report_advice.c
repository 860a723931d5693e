/* The rule for what to advise. */
#include "compare/engine/report_advice.h"

#include "compare/engine/report_verdict.h"

#include <math.h>

report_weight report_weight_of(report_factor factor) {
    static const report_weight weights[REPORT_FACTORS] = {
        [REPORT_ERROR_INSIDE] = {"error inside faces", 1, 0.25 / 255},
        [REPORT_ERROR_SEAMS] = {"error at seams", 1, 0.25 / 255},
        [REPORT_CLOSE_UP] = {"largest jump close up", 0.25, 1.0 / 255},
        [REPORT_MEMORY] = {"memory", 0.5, 1},
        [REPORT_TIME] = {"time", 0.25, 0},
    };
    return weights[factor];
}

/* Points of a figure that is never better than `least`. */
static double points_of(report_factor factor, double figure, double least) {
    report_weight weight = report_weight_of(factor);
    figure = fmax(figure, weight.floor);
    least = fmax(least, weight.floor);
    return figure > least ? weight.points * log2(figure / least) : 0; /* NaN is not above */
}

static double time_points(double ratio, double least) {
    return points_of(REPORT_TIME, ratio / REPORT_TIME_MARGIN, least);
}

/* Sums by both ends of the times; returns the points besides time of each in `exact`. */
static void add_points(report_advice *advice, const report_figures *figures, uint32_t count,
                       double exact[REPORT_MAX_STRATEGIES]) {
    double least[REPORT_TIME], low = INFINITY, high = INFINITY;
    for (int f = 0; f < REPORT_TIME; f++) {
        least[f] = INFINITY;
        for (uint32_t k = 0; k < count; k++)
            least[f] = fmin(least[f], figures[k].exact[f]);
    }
    for (uint32_t k = 0; k < count; k++) {
        low = fmin(low, figures[k].time.low);
        high = fmin(high, figures[k].time.high);
    }
    for (uint32_t k = 0; k < count; k++) {
        exact[k] = 0;
        for (int f = 0; f < REPORT_TIME; f++) {
            advice->points[k][f] = points_of((report_factor)f, figures[k].exact[f], least[f]);
            exact[k] += advice->points[k][f];
        }
        advice->points[k][REPORT_TIME] = time_points(figures[k].time.low, high);
        advice->low[k] = exact[k] + advice->points[k][REPORT_TIME];
        advice->high[k] = exact[k] + time_points(figures[k].time.high, low);
    }
}

report_advice report_advise_figures(const report_figures *figures, uint32_t count) {
    report_advice advice = {.measured = false};
    double exact[REPORT_MAX_STRATEGIES];
    uint32_t best = 0;
    for (uint32_t k = 0; k < count; k++)
        advice.measured |= !isnan(figures[k].exact[REPORT_ERROR_INSIDE]) ||
                           !isnan(figures[k].exact[REPORT_ERROR_SEAMS]);
    add_points(&advice, figures, count, exact);
    for (uint32_t k = 1; k < count; k++)
        best = advice.low[k] < advice.low[best] ? k : best;
    advice.take = best;
    for (uint32_t k = 0; k < count; k++) {
        advice.tied[k] = advice.low[k] <= advice.high[best] + REPORT_SAME_POINTS;
        advice.ntied += advice.tied[k];
        if (advice.tied[k] && exact[k] < exact[advice.take])
            advice.take = k;
    }
    return advice;
}

static double rms_of(const report_errors *errors, unsigned labels) {
    report_tally tally = report_errors_part(errors, labels);
    return report_rms(&tally);
}

double report_seam_error(const report_data *report, report_source source, uint32_t rate,
                         uint32_t strategy) {
    if (source >= REPORT_SOURCES || !report->reference.used[source])
        return NAN;
    return rms_of(&report->strategies[strategy].rates[rate].errors[source], REPORT_SEAMS);
}

static report_figures figures_of(const report_strategy *row, const report_errors *errors,
                                 interval time) {
    const slv_gl_seam *seam = &row->seams[0];
    return (report_figures){
        .exact = {[REPORT_ERROR_INSIDE] =
                      errors ? rms_of(errors, 1 << REPORT_INTERIOR) : (double)NAN,
                  [REPORT_ERROR_SEAMS] = errors ? rms_of(errors, REPORT_SEAMS) : (double)NAN,
                  [REPORT_CLOSE_UP] = seam->nedges ? (double)seam->max : (double)NAN,
                  [REPORT_MEMORY] = (double)row->stats.gpu_bytes},
        .time = time};
}

report_advice report_advise(const report_data *report) {
    report_figures figures[REPORT_MAX_STRATEGIES];
    report_source source = report->reference.first;
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        const report_strategy *row = &report->strategies[k];
        figures[k] = figures_of(
            row, source < REPORT_SOURCES ? &row->rates[report->shown].errors[source] : NULL,
            row->ratio);
    }
    return report_advise_figures(figures, report->nstrategies);
}

report_advice report_advise_cameras(const report_data *report) {
    report_figures figures[REPORT_MAX_STRATEGIES];
    if (!report->ncameras || report->reference.first == REPORT_SOURCES)
        return (report_advice){.measured = false};
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        report_errors errors = {0};
        double ratios[REPORT_MAX_CAMERAS];
        for (uint32_t c = 0; c < report->ncameras; c++) {
            const report_camera *camera = &report->cameras[c];
            report_errors_merge(&errors, &camera->errors[k]);
            ratios[c] = camera->ratio[k];
        }
        figures[k] =
            figures_of(&report->strategies[k], &errors, interval_of(ratios, report->ncameras));
    }
    return report_advise_figures(figures, report->nstrategies);
}
