/* What is advised, and what seam jumps and memory say, in sentences. */
#include "compare/report/report_words.h"

#include <math.h>

void report_write_jump(FILE *stream, double jump) {
    double steps = jump * 255;
    if (!isfinite(steps))
        fputs("not finite", stream);
    else if (steps == 0)
        fputs("0", stream);
    else if (steps < 0.01)
        fputs("&lt; 0.01", stream);
    else
        fprintf(stream, steps < 9.995 ? "%.2f" : "%.1f", steps);
}

static const char *name_of(const report_strategy *row) {
    return row->strategy->name;
}

static void write_cost(FILE *stream, const report_data *report, const report_verdict *verdict) {
    const report_strategy *best = &report->strategies[verdict->best];
    if (verdict->best == verdict->baseline)
        fprintf(stream, "%.2f ms a frame", best->median_ms);
    else
        fprintf(stream, "%.2f times the frame time of %s", best->ratio.median,
                name_of(&report->strategies[verdict->baseline]));
    fprintf(stream, " and %.2f times the memory of the bare texels", report_memory_ratio(best));
}

/* The other strategies that do as well, which somebody may have reasons to take. */
static void write_others(FILE *stream, const report_data *report, const report_verdict *verdict) {
    uint32_t left = 0;
    for (uint32_t i = 0; i < report->nstrategies; i++)
        left += i != verdict->best && report_reaches(&report->strategies[i], verdict->outcome);
    if (!left)
        return;
    fputs(verdict->outcome == REPORT_EQUAL_ONLY ? " Also without a visible seam there"
                                                : " Also without a visible seam",
          stream);
    const char *before = ":";
    for (uint32_t i = 0; i < report->nstrategies; i++) {
        const report_strategy *row = &report->strategies[i];
        if (i == verdict->best || !report_reaches(row, verdict->outcome))
            continue;
        left--;
        fprintf(stream, "%s %s, at %.2f times", before, name_of(row), row->ratio.median);
        before = left == 1 ? "; and" : ";";
    }
    fputs(".", stream);
}

/* Where resolutions differ, another strategy may do better than the smallest at equal ones. */
static void write_closest(FILE *stream, const report_data *report, const report_verdict *verdict) {
    uint32_t closest = verdict->best;
    for (uint32_t i = 0; i < report->nstrategies; i++)
        if (report->strategies[i].seams[0].max < report->strategies[closest].seams[0].max)
            closest = i;
    if (closest == verdict->best)
        return;
    fprintf(stream, " Over all edges %s comes closest, with a largest jump of ",
            name_of(&report->strategies[closest]));
    report_write_jump(stream, (double)report->strategies[closest].seams[0].max);
    fprintf(stream, "/255 at %.2f times the frame time.", report->strategies[closest].ratio.median);
}

static void write_minified(FILE *stream, const report_strategy *best) {
    uint32_t worst = 0;
    for (uint32_t level = 1; level < REPORT_LEVELS; level++)
        if (!worst || best->seams[level].max > best->seams[worst].max)
            worst = level;
    if (report_jump_hidden((double)best->seams[worst].max))
        return;
    fprintf(stream, " Seen from further away, the largest jump of %s is ", name_of(best));
    report_write_jump(stream, (double)best->seams[worst].max);
    fprintf(stream, "/255, where a pixel covers %u texels.", 1u << worst);
}

static const char *opening(report_outcome outcome, bool alone) {
    switch (outcome) {
    case REPORT_NO_SEAMS:
        return "No two faces share an edge, so there are no seams; the one with the least memory "
               "is ";
    case REPORT_EQUAL_ONLY:
        return "No strategy hides every seam where faces of different resolution meet. Between "
               "faces of equal resolution ";
    case REPORT_ALL_VISIBLE:
        return alone ? "" : "Every strategy leaves a visible seam here; the smallest is that of ";
    case REPORT_SEAMLESS:
        break;
    }
    return "";
}

void report_write_verdict(FILE *stream, const report_data *report, const report_verdict *verdict) {
    const report_strategy *best = &report->strategies[verdict->best];
    const report_strategy *baseline = &report->strategies[verdict->baseline];
    const slv_gl_seam *seam = &best->seams[0];
    bool alone = report->nstrategies == 1;
    fputs(opening(verdict->outcome, alone), stream);
    fprintf(stream, "<strong>%s</strong>", name_of(best));
    switch (verdict->outcome) {
    case REPORT_NO_SEAMS:
        fputs(", at ", stream);
        write_cost(stream, report, verdict);
        fputs(".", stream);
        return;
    case REPORT_ALL_VISIBLE:
        fputs(alone ? " leaves visible seams here, at " : ", at ", stream);
        write_cost(stream, report, verdict);
        fputs(", with a largest jump of ", stream);
        report_write_jump(stream, (double)seam->max);
        fputs("/255.", stream);
        return;
    case REPORT_SEAMLESS:
        fputs(" has no visible seam in the least memory: ", stream);
        write_cost(stream, report, verdict);
        break;
    case REPORT_EQUAL_ONLY:
        fputs(" has no visible one in the least memory: ", stream);
        write_cost(stream, report, verdict);
        break;
    }
    fputs(", with a largest jump of ", stream);
    report_write_jump(stream,
                      (double)(verdict->outcome == REPORT_SEAMLESS ? seam->max : seam->equal_max));
    fputs("/255", stream);
    if (verdict->outcome == REPORT_EQUAL_ONLY) {
        fputs(" there and ", stream);
        report_write_jump(stream, (double)seam->max);
        fputs("/255 over all edges", stream);
    }
    if (verdict->best != verdict->baseline) {
        fputs(", where ", stream);
        fprintf(stream, "%s has ", name_of(baseline));
        report_write_jump(stream, (double)(verdict->outcome == REPORT_SEAMLESS
                                               ? baseline->seams[0].max
                                               : baseline->seams[0].equal_max));
        fputs("/255", stream);
    }
    fputs(".", stream);
    write_others(stream, report, verdict);
    if (verdict->outcome == REPORT_EQUAL_ONLY)
        write_closest(stream, report, verdict);
    write_minified(stream, best);
}

void report_write_tied(FILE *stream, const report_data *report, const report_advice *advice) {
    uint32_t left = advice->ntied - 1;
    const char *before = "";
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        if (!advice->tied[k] || k == advice->take)
            continue;
        left--;
        fprintf(stream, "%s%s", before, name_of(&report->strategies[k]));
        before = left == 1 ? " and " : ", ";
    }
}

void report_write_advice(FILE *stream, const report_data *report, const report_advice *advice) {
    const report_strategy *take = &report->strategies[advice->take];
    uint32_t baseline = report_baseline(report), second = report->nstrategies;
    fprintf(stream, "take <strong>%s</strong>", name_of(take));
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
        fprintf(stream, ", and the next, %s, has %.2f", name_of(&report->strategies[second]),
                advice->low[second]);
    fprintf(stream, ". It takes %.2f times the memory of the bare texels",
            report_memory_ratio(take));
    if (advice->take != baseline)
        fprintf(stream, " and %.2f (%.2f to %.2f) times the frame time of %s", take->ratio.median,
                take->ratio.low, take->ratio.high, name_of(&report->strategies[baseline]));
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
            ". Errors (RMS) below %.2f/255 and jumps below %g/255 count as that, since nobody sees "
            "them. Time counts as far as it is certain: the lower end of a strategy's interval "
            "over the upper end of the quickest's, and only what that is above %.2f. All else is "
            "the same in every run. Strategies are tied where their sums overlap by the intervals "
            "of time, or differ by no more than %.2f; of those tied, the one with the fewest "
            "points besides time is named.</p>\n",
            255 * report_weight_of(REPORT_ERROR_SEAMS).floor,
            255 * report_weight_of(REPORT_CLOSE_UP).floor, REPORT_TIME_MARGIN, REPORT_SAME_POINTS);
    fputs("<table><thead><tr><th scope=\"col\">points for</th>", stream);
    for (int f = 0; f < REPORT_FACTORS; f++)
        fprintf(stream, "<th scope=\"col\">%s</th>", report_weight_of((report_factor)f).title);
    fputs("<th scope=\"col\">sum</th></tr></thead>\n<tbody>\n", stream);
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        fprintf(stream, "<tr><th scope=\"row\">%s</th>", name_of(&report->strategies[k]));
        for (int f = 0; f < REPORT_FACTORS; f++)
            fprintf(stream, "<td>%.2f</td>", advice->points[k][f]);
        fprintf(stream, "<td%s>%.2f", advice->tied[k] ? " class=\"good\"" : "", advice->low[k]);
        if (advice->high[k] > advice->low[k])
            fprintf(stream, "<small>to %.2f</small>", advice->high[k]);
        fputs("</td></tr>\n", stream);
    }
    fputs("</tbody></table></details>\n", stream);
}
