/* Distances of pixels added up, and the names and the end of a report. */
#include "compare/engine/report.h"

#include <math.h>
#include <string.h>

double report_error_step(uint32_t i) {
    return exp2(-10 + 0.25 * i);
}

const slv_strategy *report_supersampled_with(void) {
    return slv_strategy_default();
}

const char *report_source_name(report_source source) {
    static const char *const names[REPORT_SOURCES] = {"raycast", "mitchell", "supersampled"};
    return names[source];
}

const char *report_label_name(report_label label) {
    static const char *const names[REPORT_LABELS] = {"outline", "interior", "edge", "regular",
                                                     "extraordinary"};
    return names[label];
}

uint32_t report_find(const report_data *report, const char *name) {
    uint32_t k = 0;
    while (k < report->nstrategies && strcmp(report->strategies[k].strategy->name, name) != 0)
        k++;
    return k;
}

report_paper_strategies report_of_paper(const report_data *report) {
    report_paper_strategies found = {.clamp = report_find(report, "clamp"),
                                     .traverse = report_find(report, "traverse"),
                                     .discard = report_find(report, "discard")};
    found.both = found.traverse < report->nstrategies && found.discard < report->nstrategies;
    return found;
}

uint32_t report_baseline(const report_data *report) {
    uint32_t clamp = report_of_paper(report).clamp;
    return clamp < report->nstrategies ? clamp : 0;
}

uint32_t report_frame_count(const report_data *report) {
    return report->frames + report->ncameras;
}

uint64_t report_covered(const uint64_t npixels[REPORT_LABELS]) {
    uint64_t covered = 0;
    for (int label = REPORT_INTERIOR; label < REPORT_LABELS; label++)
        covered += npixels[label];
    return covered;
}

bool report_disturbed(const report_data *report) {
    return report->others > 0.1;
}

uint32_t report_colour(const slv_strategy *strategy) {
    uint32_t k = 0;
    while (slv_strategy_at(k) && slv_strategy_at(k) != strategy)
        k++;
    return k;
}

double report_distance(const float *a, const float *b) {
    double squares = 0;
    for (int c = 0; c < 3; c++) {
        double one = (double)a[c] - (double)b[c];
        squares += one * one;
    }
    return squares >= 0 ? sqrt(squares) : INFINITY;
}

void report_tally_add(report_tally *tally, double distance) {
    tally->npixels++;
    tally->squares += distance * distance;
    tally->max = distance > tally->max ? distance : tally->max;
    tally->over[0] += distance > 1.0 / 255;
    tally->over[1] += distance > 4.0 / 255;
    tally->over[2] += distance > 16.0 / 255;
}

void report_tally_merge(report_tally *to, const report_tally *from) {
    to->npixels += from->npixels;
    to->squares += from->squares;
    to->max = fmax(to->max, from->max);
    for (int k = 0; k < 3; k++)
        to->over[k] += from->over[k];
}

void report_errors_add(report_errors *errors, report_label label, double distance) {
    report_tally_add(&errors->labels[label], distance);
    for (uint32_t i = 0; i < REPORT_ERROR_STEPS && distance > report_error_step(i); i++)
        errors->curve[i]++;
}

void report_errors_merge(report_errors *to, const report_errors *from) {
    for (int label = 0; label < REPORT_LABELS; label++)
        report_tally_merge(&to->labels[label], &from->labels[label]);
    for (uint32_t i = 0; i < REPORT_ERROR_STEPS; i++)
        to->curve[i] += from->curve[i];
}

report_tally report_errors_part(const report_errors *errors, unsigned labels) {
    report_tally sum = {0};
    for (int label = 0; label < REPORT_LABELS; label++)
        if (labels >> label & 1)
            report_tally_merge(&sum, &errors->labels[label]);
    return sum;
}

double report_rms(const report_tally *tally) {
    return tally->npixels ? sqrt(tally->squares / (double)tally->npixels) : NAN;
}

double report_share(const report_errors *errors, uint32_t i) {
    report_tally all = report_errors_part(errors, REPORT_ALL);
    return all.npixels ? (double)errors->curve[i] / (double)all.npixels : 0;
}

void report_free(report_data *report) {
    if (!report)
        return;
    for (uint32_t i = 0; i < REPORT_MAX_STRATEGIES; i++) {
        for (uint32_t v = 0; v < REPORT_MAX_VIEWS; v++)
            slv_image_free(&report->strategies[i].views[v]);
        for (uint32_t s = 0; s < REPORT_MAX_SPOTS; s++)
            slv_image_free(&report->strategies[i].spots[s]);
        slv_image_free(&report->strategies[i].heat);
    }
    for (uint32_t s = 0; s < REPORT_MAX_SPOTS; s++)
        slv_image_free(&report->reference.spots[s]);
    for (uint32_t v = 0; v < REPORT_MAX_VIEWS; v++)
        slv_image_free(&report->reference.views[v]);
    for (uint32_t i = 0; i < REPORT_MAX_STRATEGIES * REPORT_MAX_STRATEGIES; i++)
        slv_image_free(&report->pairs[i].heat);
    for (uint32_t i = 0; i < REPORT_MAX_MAPS; i++) {
        slv_image_free(&report->maps.rows[i].view);
        slv_image_free(&report->maps.rows[i].spot);
    }
    slv_image_free(&report->maps.view);
    slv_image_free(&report->maps.close_up);
}
