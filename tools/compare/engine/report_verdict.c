/* The rules for what the seam jumps and the memory say. */
#include "compare/engine/report_verdict.h"

bool report_jump_hidden(double jump) {
    /* equal up to the rounding of a difference of two floats */
    return jump <= 1.0 / 255 * (1 + 1e-5);
}

double report_memory_ratio(const report_strategy *row) {
    return row->stats.texel_bytes ? (double)row->stats.gpu_bytes / (double)row->stats.texel_bytes
                                  : 0;
}

bool report_reaches(const report_strategy *row, report_outcome outcome) {
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
            if (report_reaches(&report->strategies[i], wanted))
                verdict.outcome = wanted;
    bool found = false;
    for (uint32_t i = 0; i < report->nstrategies; i++) {
        const report_strategy *row = &report->strategies[i],
                              *best = &report->strategies[verdict.best];
        if (!report_reaches(row, verdict.outcome))
            continue;
        bool better = verdict.outcome == REPORT_ALL_VISIBLE ? row->seams[0].max < best->seams[0].max
                                                            : cheaper(row, best);
        if (!found || better)
            verdict.best = i;
        found = true;
    }
    return verdict;
}
