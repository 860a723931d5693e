/* The rules for what Toth found. */
#include "compare/engine/report_findings.h"

#include "compare/engine/report_advice.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

/* What counts as a difference, and what Toth's "roughly equivalent" is taken for. */
#define SLIGHT 1.02
#define ROUGHLY 1.1

const char *report_judgement_name(report_judgement judgement) {
    static const char *const names[] = {"not measured", "reproduced", "refuted", "undecided"};
    return names[judgement];
}

static void say(report_finding *finding, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static void say(report_finding *finding, const char *format, ...) {
    size_t length = strlen(finding->numbers);
    va_list args;
    va_start(args, format);
    vsnprintf(finding->numbers + length, sizeof finding->numbers - length, format, args);
    va_end(args);
}

static uint32_t find_rate(const report_data *report, uint32_t samples) {
    uint32_t r = 0;
    while (r < report->nrates && report->rates[r].samples != samples)
        r++;
    return r;
}

/* The two strategies and the reference that Toth's claims are about. */
typedef struct contest {
    const report_data *report;
    uint32_t traverse, discard;
    report_source source;
    bool both;
} contest;

static double seam_ratio(const contest *c, uint32_t rate) {
    return report_seam_error(c->report, c->source, rate, c->discard) /
           report_seam_error(c->report, c->source, rate, c->traverse);
}

/* Over all pixels, as Toth's curves are. */
static double error_ratio(const contest *c, uint32_t rate) {
    if (c->source == REPORT_SOURCES)
        return NAN;
    report_tally a = report_errors_part(
        &c->report->strategies[c->discard].rates[rate].errors[c->source], REPORT_ALL);
    report_tally b = report_errors_part(
        &c->report->strategies[c->traverse].rates[rate].errors[c->source], REPORT_ALL);
    return report_rms(&a) / report_rms(&b);
}

/* Whether a ratio that should be below 1 is; the strictest of several counts. */
static report_judgement below_one(double ratio) {
    if (isnan(ratio))
        return REPORT_UNMEASURED;
    return ratio < 1 / SLIGHT ? REPORT_REPRODUCED
           : ratio > SLIGHT   ? REPORT_REFUTED
                              : REPORT_UNDECIDED;
}

static report_judgement stricter(report_judgement a, report_judgement b) {
    static const int order[] = {0, 1, 3, 2}; /* by report_judgement */
    return order[a] > order[b] ? a : b;
}

static void judge_error(const contest *c, uint32_t samples, report_finding *finding) {
    uint32_t rate = find_rate(c->report, samples);
    if (!c->both || rate == c->report->nrates || isnan(error_ratio(c, rate)))
        return;
    double ratio = error_ratio(c, rate), at_seams = seam_ratio(c, rate);
    report_judgement one = samples < 4                              ? below_one(1 / ratio)
                           : samples > 4                            ? below_one(ratio)
                           : ratio < ROUGHLY && ratio > 1 / ROUGHLY ? REPORT_REPRODUCED
                                                                    : REPORT_REFUTED;
    finding->judgement = stricter(finding->judgement, one);
    say(finding, "%sat %ux the error of discard is %.3f times that of traverse",
        finding->numbers[0] ? "; " : "", samples, ratio);
    if (isfinite(at_seams))
        say(finding, " (%.3f at seams)", at_seams);
}

static void judge_apart(const contest *c, report_finding *finding) {
    const report_data *report = c->report;
    double before = INFINITY;
    if (!c->both || report->nrates < 2)
        return;
    finding->judgement = REPORT_REPRODUCED;
    for (uint32_t r = 0; r < report->nrates; r++) {
        report_tally all = report_errors_part(&report->apart[r], REPORT_ALL);
        double rms = report_rms(&all);
        if (!(rms < before) || rms == 0)
            finding->judgement = REPORT_REFUTED;
        before = rms;
        say(finding, "%s%.2f/255 RMS at %ux", r ? ", " : "", rms * 255, report->rates[r].samples);
    }
}

static double time_of(const contest *c, uint32_t strategy, uint32_t samples) {
    uint32_t rate = find_rate(c->report, samples);
    return rate < c->report->nrates ? c->report->strategies[strategy].rates[rate].median_ms
                                    : (double)NAN;
}

static void judge_time(const contest *c, uint32_t samples, uint32_t against,
                       report_finding *finding) {
    if (!c->both)
        return;
    double ratio = time_of(c, c->discard, samples) / time_of(c, c->traverse, against);
    if (isnan(ratio))
        return;
    finding->judgement = stricter(finding->judgement, below_one(ratio));
    say(finding, "%s%.2f times the time at %ux", finding->numbers[0] ? ", " : "", ratio, samples);
    if (samples != against)
        say(finding, " of traverse at %ux", against);
}

void report_find_out(const report_data *report, report_finding findings[REPORT_FINDINGS]) {
    static const char *const claims[REPORT_FINDINGS] = {
        "At one and two samples per pixel traverse is closer to the reference than discard.",
        "At four samples the two are roughly equal.",
        "At eight samples discard is slightly ahead.",
        "With more samples the two become more alike, but never the same.",
        "At equal rates discard is quicker than traverse.",
        "Discard at four samples is quicker than traverse at one.",
        "Discard at eight samples is quicker than traverse at two.",
    };
    report_paper_strategies k = report_of_paper(report);
    contest c = {.report = report,
                 .traverse = k.traverse,
                 .discard = k.discard,
                 .both = k.both,
                 .source = report->reference.used[REPORT_SUPERSAMPLED] ? REPORT_SUPERSAMPLED
                                                                       : report->reference.first};
    for (int i = 0; i < REPORT_FINDINGS; i++)
        findings[i] = (report_finding){.claim = claims[i]};
    judge_error(&c, 1, &findings[0]);
    judge_error(&c, 2, &findings[0]);
    judge_error(&c, 4, &findings[1]);
    judge_error(&c, 8, &findings[2]);
    judge_apart(&c, &findings[3]);
    for (uint32_t r = 0; r < report->nrates; r++)
        judge_time(&c, report->rates[r].samples, report->rates[r].samples, &findings[4]);
    judge_time(&c, 4, 1, &findings[5]);
    judge_time(&c, 8, 2, &findings[6]);
}
