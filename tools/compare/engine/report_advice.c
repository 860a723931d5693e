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

static const char *name_of(const report_data *report, uint32_t k) {
    return report->strategies[k].strategy->name;
}

void report_write_tied(FILE *stream, const report_data *report, const report_advice *advice) {
    uint32_t left = advice->ntied - 1;
    const char *before = "";
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        if (!advice->tied[k] || k == advice->take)
            continue;
        left--;
        fprintf(stream, "%s%s", before, name_of(report, k));
        before = left == 1 ? " and " : ", ";
    }
}

void report_write_advice(FILE *stream, const report_data *report, const report_advice *advice) {
    const report_strategy *take = &report->strategies[advice->take];
    uint32_t baseline = report_baseline(report), second = report->nstrategies;
    fprintf(stream, "take <strong>%s</strong>", name_of(report, advice->take));
    for (uint32_t k = 0; k < report->nstrategies; k++)
        if (k != advice->take && !advice->tied[k] &&
            (second == report->nstrategies || advice->low[k] < advice->low[second]))
            second = k;
    if (advice->ntied > 1) {
        fputs(", which is tied with ", stream);
        report_write_tied(stream, report, advice);
    }
    fprintf(stream, ": %.2f points", advice->low[advice->take]);
    if (second < report->nstrategies)
        fprintf(stream, ", and the next, %s, has %.2f", name_of(report, second),
                advice->low[second]);
    fprintf(stream, ". It takes %.2f times the memory of the bare texels",
            report_memory_ratio(take));
    if (advice->take != baseline)
        fprintf(stream, " and %.2f (%.2f to %.2f) times the frame time of %s", take->ratio.median,
                take->ratio.low, take->ratio.high, name_of(report, baseline));
    fputs(".", stream);
}

void report_write_rule(FILE *stream, const report_data *report, const report_advice *advice) {
    fputs("<details class=\"small\"><summary>The rule, and all points</summary>\n<p>Fewer points "
          "are better. For every doubling of a figure over the least of all there are",
          stream);
    for (int f = 0; f < REPORT_FACTORS; f++) {
        report_weight weight = report_weight_of((report_factor)f);
        fprintf(stream, "%s %g for %s", f ? f + 1 < REPORT_FACTORS ? "," : " and" : "",
                weight.points, weight.title);
    }
    fprintf(stream,
            ". Errors (RMS) below %.2f/255 and jumps below 1/255 count as that, since nobody sees "
            "them. Time counts as far as it is certain: the lower end of a strategy's interval "
            "over the upper end of the quickest's, and only what that is above %.2f. All else is "
            "the same in every run. Strategies are tied where their sums overlap by the intervals "
            "of time, or differ by no more than %.2f; of those tied, the one with the fewest "
            "points besides time is named.</p>\n",
            255 * report_weight_of(REPORT_ERROR_SEAMS).floor, REPORT_TIME_MARGIN,
            REPORT_SAME_POINTS);
    fputs("<table><thead><tr><th scope=\"col\">points for</th>", stream);
    for (int f = 0; f < REPORT_FACTORS; f++)
        fprintf(stream, "<th scope=\"col\">%s</th>", report_weight_of((report_factor)f).title);
    fputs("<th scope=\"col\">sum</th></tr></thead>\n<tbody>\n", stream);
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        fprintf(stream, "<tr><th scope=\"row\">%s</th>", name_of(report, k));
        for (int f = 0; f < REPORT_FACTORS; f++)
            fprintf(stream, "<td>%.2f</td>", advice->points[k][f]);
        fprintf(stream, "<td%s>%.2f", advice->tied[k] ? " class=\"good\"" : "", advice->low[k]);
        if (advice->high[k] > advice->low[k])
            fprintf(stream, "<small>to %.2f</small>", advice->high[k]);
        fputs("</td></tr>\n", stream);
    }
    fputs("</tbody></table></details>\n", stream);
}
