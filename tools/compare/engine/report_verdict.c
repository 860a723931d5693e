/* The rules for what the seam jumps and the memory say. */
#include "compare/engine/report_verdict.h"

#include <math.h>

bool report_jump_hidden(double jump) {
    /* equal up to the rounding of a difference of two floats */
    return jump <= 1.0 / 255 * (1 + 1e-5);
}

double report_memory_ratio(const report_strategy *row) {
    return row->stats.texel_bytes ? (double)row->stats.gpu_bytes / (double)row->stats.texel_bytes
                                  : 0;
}

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

static bool reaches(const report_strategy *row, report_outcome outcome) {
    if (outcome == REPORT_SEAMLESS)
        return report_jump_hidden((double)row->seams[0].max);
    if (outcome == REPORT_EQUAL_ONLY)
        return row->seams[0].nequal && report_jump_hidden((double)row->seams[0].equal_max);
    return true;
}

/* Less memory, and if it is the same smaller jumps: not time, which is another in every run. */
static bool cheaper(const report_strategy *a, const report_strategy *b) {
    return a->stats.gpu_bytes != b->stats.gpu_bytes ? a->stats.gpu_bytes < b->stats.gpu_bytes
                                                    : a->seams[0].max < b->seams[0].max;
}

report_verdict report_judge(const report_data *report) {
    report_verdict verdict = {.outcome = REPORT_ALL_VISIBLE};
    bool edges = false;
    verdict.baseline = report_baseline(report);
    for (uint32_t i = 0; i < report->nstrategies; i++)
        edges |= report->strategies[i].seams[0].nedges > 0;
    if (!edges)
        verdict.outcome = REPORT_NO_SEAMS;
    for (report_outcome wanted = REPORT_EQUAL_ONLY; edges && wanted >= REPORT_SEAMLESS; wanted--)
        for (uint32_t i = 0; i < report->nstrategies; i++)
            if (reaches(&report->strategies[i], wanted))
                verdict.outcome = wanted;
    bool found = false;
    for (uint32_t i = 0; i < report->nstrategies; i++) {
        const report_strategy *row = &report->strategies[i],
                              *best = &report->strategies[verdict.best];
        if (!reaches(row, verdict.outcome))
            continue;
        bool better = verdict.outcome == REPORT_ALL_VISIBLE ? row->seams[0].max < best->seams[0].max
                                                            : cheaper(row, best);
        if (!found || better)
            verdict.best = i;
        found = true;
    }
    return verdict;
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
        left += i != verdict->best && reaches(&report->strategies[i], verdict->outcome);
    if (!left)
        return;
    fputs(verdict->outcome == REPORT_EQUAL_ONLY ? " Also without a visible seam there"
                                                : " Also without a visible seam",
          stream);
    const char *before = ":";
    for (uint32_t i = 0; i < report->nstrategies; i++) {
        const report_strategy *row = &report->strategies[i];
        if (i == verdict->best || !reaches(row, verdict->outcome))
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
