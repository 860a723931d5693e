/* The frames of the orbit: drawn, measured, and added up. */
#include "compare/engine/experiment.h"
#include "command/output.h"
#include "compare/engine/busy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The sums of a run so far. */
typedef struct totals {
    report_data *report;
    double *ms; /* rates x strategies x frames */
    bool *done; /* frames */
    uint32_t ndone;
    double squares[REPORT_SOURCES], seconds, others;
} totals;

/* The pictures of one moment: of every strategy at one rate, and of the references. */
typedef struct moment {
    slv_frame frame;
    slv_image references[REPORT_SOURCES];
    slv_image images[REPORT_MAX_STRATEGIES];
    uint8_t *labels;
} moment;

static double *times_of(const totals *t, uint32_t rate, uint32_t strategy) {
    return t->ms + ((size_t)rate * t->report->nstrategies + strategy) * t->report->frames;
}

/* A frame of a camera that was given speaks for itself, and is not added to the orbit. */
static void add_camera(report_data *report, const experiment_frame *frame) {
    report_camera *camera = &report->cameras[frame->index - report->frames];
    const double *ms = frame->ms[report->shown];
    camera->empty = frame->referenced && !report_covered(frame->npixels);
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        camera->ms[k] = ms[k];
        camera->ratio[k] = ms[k] / ms[report_baseline(report)];
        if (frame->referenced)
            camera->errors[k] = frame->errors[report->reference.first][report->shown][k];
    }
}

static slv_result add_frame(void *user, const experiment_frame *frame) {
    totals *t = user;
    report_data *report = t->report;
    if (t->done[frame->index])
        return SLV_OK;
    t->done[frame->index] = true;
    t->ndone++;
    t->seconds += frame->seconds;
    t->others += frame->others;
    if (frame->index >= report->frames) {
        add_camera(report, frame);
        return SLV_OK;
    }
    report->reference.frames += frame->referenced;
    for (int label = 0; label < REPORT_LABELS; label++)
        report->reference.npixels[label] += frame->npixels[label];
    for (int s = 0; s < REPORT_SOURCES; s++)
        t->squares[s] += frame->referenced ? frame->estimate[s] * frame->estimate[s] : 0;
    for (uint32_t r = 0; r < report->nrates; r++) {
        report_errors_merge(&report->apart[r], &frame->apart[r]);
        for (uint32_t k = 0; k < report->nstrategies; k++) {
            report_cell *cell = &report->strategies[k].rates[r];
            times_of(t, r, k)[frame->index] = frame->ms[r][k];
            report_tally_merge(&cell->flicker, &frame->flicker[r][k]);
            for (int s = 0; s < REPORT_SOURCES; s++)
                report_errors_merge(&cell->errors[s], &frame->errors[s][r][k]);
        }
    }
    return SLV_OK;
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* How long a strategy takes over the baseline, frame by frame: what the machine does besides falls
 * on both. `ratios` has room for all frames. */
static void find_ratio(const totals *t, uint32_t rate, uint32_t strategy, double *ratios) {
    report_data *report = t->report;
    const double *own = times_of(t, rate, strategy),
                 *other = times_of(t, rate, report_baseline(report));
    for (uint32_t i = 0; i < report->frames; i++)
        ratios[i] = own[i] / other[i];
    report->strategies[strategy].rates[rate].ratio = interval_of(ratios, report->frames);
}

static void finish(totals *t, double *ratios) {
    report_data *report = t->report;
    uint32_t frames = report->frames;
    report->others = t->seconds > 0 ? t->others / t->seconds : 0;
    for (uint32_t r = 0; r < report->nrates; r++) {
        for (uint32_t k = 0; k < report->nstrategies; k++)
            find_ratio(t, r, k, ratios);
        for (uint32_t k = 0; k < report->nstrategies; k++) {
            report_cell *cell = &report->strategies[k].rates[r];
            double *list = times_of(t, r, k);
            qsort(list, frames, sizeof *list, by_value);
            cell->median_ms = list[frames / 2];
            cell->min_ms = list[0];
            cell->max_ms = list[frames - 1];
        }
    }
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        report_strategy *row = &report->strategies[k];
        const report_cell *cell = &row->rates[report->shown];
        row->median_ms = cell->median_ms;
        row->min_ms = cell->min_ms;
        row->max_ms = cell->max_ms;
        row->ratio = cell->ratio;
    }
    for (int s = 0; s < REPORT_SOURCES; s++)
        report->reference.estimate[s] = sqrt(t->squares[s] / report->reference.frames);
}

bool experiment_is_middle(uint32_t index, uint32_t frames, uint32_t wanted) {
    for (uint64_t k = 0; k < wanted; k++)
        if ((2 * k + 1) * frames / (2 * (uint64_t)wanted) == index)
            return true;
    return false;
}

/* Which frames have references: all of cameras, and of the orbit `wanted`. */
static bool is_referenced(const report_data *report, uint32_t index, uint32_t wanted) {
    return index < report->frames ? experiment_is_middle(index, report->frames, wanted)
                                  : report->reference.first < REPORT_SOURCES;
}

static void free_images(moment *m) {
    for (int k = 0; k < REPORT_MAX_STRATEGIES; k++)
        slv_image_free(&m->images[k]);
}

static void free_moment(moment *m) {
    free_images(m);
    for (int s = 0; s < REPORT_SOURCES; s++)
        slv_image_free(&m->references[s]);
    free(m->labels);
    memset(m, 0, sizeof *m);
}

/* The strategy that begins changes from frame to frame, so that whatever else the machine does
 * falls on all alike. */
static slv_result draw_all(experiment *e, moment *m, uint32_t rate, uint32_t turn, double *ms) {
    const report_data *report = e->report;
    slv_result result = SLV_OK;
    free_images(m);
    for (uint32_t k = 0; k < report->nstrategies && !result; k++) {
        uint32_t which = (k + turn) % report->nstrategies;
        m->frame.strategy = report->strategies[which].strategy;
        result = experiment_draw(e, &m->frame, &report->rates[rate], &m->images[which],
                                 ms ? &ms[which] : NULL);
        if (!result)
            result = experiment_ask(e);
    }
    return result;
}

static slv_result find_references(experiment *e, moment *m, experiment_frame *out) {
    slv_result result = experiment_classify(e, &m->frame, experiment_seam_label, &m->labels);
    size_t npixels = (size_t)m->frame.width * m->frame.height;
    for (size_t i = 0; i < npixels && !result; i++)
        out->npixels[m->labels[i]]++;
    for (int s = 0; s < REPORT_SOURCES && !result; s++)
        if (e->report->reference.used[s])
            result = experiment_reference(e, (report_source)s, &m->frame, &m->references[s],
                                          &out->estimate[s]);
    return result;
}

static void measure_apart(const experiment *e, const moment *m, report_errors *out) {
    report_paper_strategies k = report_of_paper(e->report);
    size_t npixels = (size_t)m->frame.width * m->frame.height;
    for (size_t i = 0; i < npixels && k.both; i++)
        report_errors_add(out, m->labels ? (report_label)m->labels[i] : REPORT_INTERIOR,
                          report_distance(m->images[k.traverse].pixels + 4 * i,
                                          m->images[k.discard].pixels + 4 * i));
}

static void measure_errors(const experiment *e, const moment *m, uint32_t rate,
                           experiment_frame *out) {
    size_t npixels = (size_t)m->frame.width * m->frame.height;
    for (int s = 0; s < REPORT_SOURCES; s++) {
        const float *b = m->references[s].pixels;
        for (uint32_t k = 0; k < e->report->nstrategies && b; k++)
            for (size_t i = 0; i < npixels; i++)
                report_errors_add(&out->errors[s][rate][k], (report_label)m->labels[i],
                                  report_distance(m->images[k].pixels + 4 * i, b + 4 * i));
    }
}

/* How much the error of every pixel inside has changed from one moment to the next. */
static void measure_flicker(const experiment *e, const moment *before, const moment *after,
                            report_source source, uint32_t rate, experiment_frame *out) {
    size_t npixels = (size_t)before->frame.width * before->frame.height;
    const float *r0 = before->references[source].pixels, *r1 = after->references[source].pixels;
    for (uint32_t k = 0; k < e->report->nstrategies; k++) {
        const float *a0 = before->images[k].pixels, *a1 = after->images[k].pixels;
        for (size_t i = 0; i < 4 * npixels; i += 4) {
            float e0[3], e1[3];
            if (before->labels[i / 4] == REPORT_OUTLINE || after->labels[i / 4] == REPORT_OUTLINE)
                continue;
            for (size_t c = 0; c < 3; c++) {
                e0[c] = a0[i + c] - r0[i + c];
                e1[c] = a1[i + c] - r1[i + c];
            }
            report_tally_add(&out->flicker[rate][k], report_distance(e0, e1));
        }
    }
}

/* The next moment: one frame of an orbit of EXPERIMENT_STEPS later, however many are drawn. */
static slv_result find_next(experiment *e, double t, report_source source, moment *next) {
    double estimate;
    next->frame = experiment_frame_at(e, t + 1.0 / EXPERIMENT_STEPS, NULL);
    slv_result result = experiment_classify(e, &next->frame, experiment_seam_label, &next->labels);
    return result ? result
                  : experiment_reference(e, source, &next->frame, &next->references[source],
                                         &estimate);
}

/* Draws with every strategy at a rate, and notes what other programs did meanwhile. */
static slv_result time_all(experiment *e, moment *m, uint32_t rate, experiment_frame *out) {
    busy_sample before = busy_now();
    slv_result result = draw_all(e, m, rate, out->index, out->ms[rate]);
    busy_sample after = busy_now();
    out->seconds += after.clock - before.clock;
    out->others += busy_others(&before, &after) * (after.clock - before.clock);
    return result;
}

static slv_result measure_frame(experiment *e, uint32_t index, bool referenced,
                                experiment_frame *out) {
    const report_data *report = e->report;
    bool given = index >= report->frames;
    double t = (double)index / report->frames;
    moment here = {.frame = experiment_frame_at(e, given ? 0 : t, NULL)}, next = {.labels = NULL};
    slv_result result = SLV_OK;
    memset(out, 0, sizeof *out);
    out->index = index;
    out->referenced = referenced;
    if (given)
        here.frame.camera = report->cameras[index - report->frames].camera;
    bool flickers = referenced && !given && report->reference.first != REPORT_SUPERSAMPLED;
    if (referenced && (result = find_references(e, &here, out)))
        goto done;
    if (flickers && (result = find_next(e, t, report->reference.first, &next)))
        goto done;
    for (uint32_t r = 0; r < report->nrates; r++) {
        if ((result = time_all(e, &here, r, out)))
            goto done;
        measure_apart(e, &here, &out->apart[r]);
        if (!referenced)
            continue;
        measure_errors(e, &here, r, out);
        if (!flickers)
            continue;
        if ((result = draw_all(e, &next, r, 0, NULL)))
            goto done;
        measure_flicker(e, &here, &next, report->reference.first, r, out);
    }
done:
    free_moment(&here);
    free_moment(&next);
    return result;
}

/* The first picture of each kind compiles shaders and lays out triangles. */
static slv_result warm_up(experiment *e) {
    slv_result result = SLV_OK;
    for (uint32_t r = 0; r < e->report->nrates && !result; r++) {
        for (uint32_t k = 0; k < e->report->nstrategies && !result; k++) {
            slv_frame frame = experiment_frame_at(e, 0, e->report->strategies[k].strategy);
            result = experiment_draw(e, &frame, &e->report->rates[r], NULL, NULL);
        }
    }
    return result;
}

static slv_result run_frames(experiment *e, totals *t, experiment_state *state,
                             experiment_frame *frame, uint32_t wanted) {
    const report_data *report = e->report;
    uint32_t count = report_frame_count(report);
    if (t->ndone == count)
        return SLV_OK;
    slv_result result = experiment_begin(e, count - t->ndone);
    if (!result)
        result = warm_up(e);
    for (uint32_t i = 0; i < count && !result; i++) {
        if (t->done[i])
            continue;
        if (!(result = experiment_ask(e)) &&
            !(result = measure_frame(e, i, is_referenced(report, i, wanted), frame)) &&
            !(result = experiment_state_append(e->env, state, report, frame)) &&
            !(result = add_frame(t, frame)))
            result = experiment_step(e);
    }
    return result;
}

slv_result experiment_run(experiment *e, const char *path, const json_t *conditions, bool resume) {
    report_data *report = e->report;
    totals t = {
        .report = report,
        .ms = calloc((size_t)report->nrates * report->nstrategies * report->frames, sizeof *t.ms),
        .done = calloc(report_frame_count(report), sizeof *t.done)};
    double *ratios = calloc(report->frames, sizeof *ratios);
    experiment_frame *frame = malloc(sizeof *frame);
    experiment_state state = {.file = -1};
    uint32_t wanted = report->reference.frames;
    slv_result result;
    report->reference.frames = 0; /* counted as they come in */
    if (!t.ms || !t.done || !ratios || !frame) {
        result = output_fail(e->env, SLV_ERROR_MEMORY, "no memory for %u frames", report->frames);
        goto done;
    }
    if ((result = experiment_state_open(e->env, path, conditions, resume, add_frame, &t, report,
                                        &state)) ||
        (result = run_frames(e, &t, &state, frame, wanted)))
        goto done;
    finish(&t, ratios);
done:
    e->finished = t.ndone;
    experiment_state_close(&state);
    free(frame);
    free(ratios);
    free(t.ms);
    free(t.done);
    return result;
}
