/* The file of finished frames, which a run that was stopped goes on from. */
#include "command/output.h"
#include "compare/engine/experiment.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* jansson passes the failure of any part up to the root, as NULL. */
static json_t *append(json_t *list, json_t *item) {
    if (list && json_array_append_new(list, item) == 0)
        return list;
    json_decref(list);
    return NULL;
}

static json_t *tally_json(const report_tally *t) {
    /* a distance can be infinite, which JSON has no number for */
    return json_pack("[I, I, I, I, o, o]", (json_int_t)t->npixels, (json_int_t)t->over[0],
                     (json_int_t)t->over[1], (json_int_t)t->over[2], output_json_number(t->squares),
                     output_json_number(t->max));
}

json_t *experiment_errors_json(const report_errors *errors) {
    json_t *labels = json_array(), *curve = json_array();
    for (int label = 0; label < REPORT_LABELS; label++)
        labels = append(labels, tally_json(&errors->labels[label]));
    for (uint32_t i = 0; i < REPORT_ERROR_STEPS; i++)
        curve = append(curve, json_integer((json_int_t)errors->curve[i]));
    return json_pack("[o, o]", labels, curve);
}

static json_t *cells_json(const report_data *report, const experiment_frame *frame,
                          const report_errors (*errors)[REPORT_MAX_STRATEGIES]) {
    json_t *rates = json_array();
    for (uint32_t r = 0; r < report->nrates; r++) {
        json_t *row = json_array();
        for (uint32_t k = 0; k < report->nstrategies; k++)
            row = append(row, errors ? experiment_errors_json(&errors[r][k])
                                     : tally_json(&frame->flicker[r][k]));
        rates = append(rates, row);
    }
    return rates;
}

static json_t *frame_json(const report_data *report, const experiment_frame *frame) {
    json_t *times = json_array(), *apart = json_array(), *references = json_null();
    for (uint32_t r = 0; r < report->nrates; r++) {
        json_t *row = json_array();
        for (uint32_t k = 0; k < report->nstrategies; k++)
            row = append(row, json_real(frame->ms[r][k]));
        times = append(times, row);
        apart = append(apart, experiment_errors_json(&frame->apart[r]));
    }
    if (frame->referenced) {
        json_t *npixels = json_array();
        for (int label = 0; label < REPORT_LABELS; label++)
            npixels = append(npixels, json_integer((json_int_t)frame->npixels[label]));
        references =
            json_pack("{s:o, s:o}", "pixels", npixels, "flicker", cells_json(report, frame, NULL));
        for (int s = 0; s < REPORT_SOURCES && references; s++) {
            json_t *one =
                report->reference.used[s]
                    ? json_pack("{s:o, s:o}", "estimate", output_json_number(frame->estimate[s]),
                                "errors", cells_json(report, frame, frame->errors[s]))
                    : json_null();
            if (json_object_set_new(references, report_source_name((report_source)s), one)) {
                json_decref(references);
                references = NULL;
            }
        }
    }
    return json_pack("{s:I, s:o, s:o, s:o, s:o, s:o}", "frame", (json_int_t)frame->index, "ms",
                     times, "seconds", json_real(frame->seconds), "others",
                     json_real(frame->others), "apart", apart, "references", references);
}

static double read_number(const json_t *value) {
    return json_is_null(value) ? (double)INFINITY : json_number_value(value);
}

static bool read_tally(const json_t *array, report_tally *out) {
    if (json_array_size(array) != 6)
        return false;
    out->npixels = (uint64_t)json_integer_value(json_array_get(array, 0));
    for (size_t k = 0; k < 3; k++)
        out->over[k] = (uint64_t)json_integer_value(json_array_get(array, 1 + k));
    out->squares = read_number(json_array_get(array, 4));
    out->max = read_number(json_array_get(array, 5));
    return true;
}

static bool read_errors(const json_t *pair, report_errors *out) {
    const json_t *labels = json_array_get(pair, 0), *curve = json_array_get(pair, 1);
    if (json_array_size(labels) != REPORT_LABELS || json_array_size(curve) != REPORT_ERROR_STEPS)
        return false;
    for (size_t i = 0; i < REPORT_ERROR_STEPS; i++)
        out->curve[i] = (uint64_t)json_integer_value(json_array_get(curve, i));
    for (size_t label = 0; label < REPORT_LABELS; label++)
        if (!read_tally(json_array_get(labels, label), &out->labels[label]))
            return false;
    return true;
}

static bool read_references(const report_data *report, const json_t *from, experiment_frame *out) {
    const json_t *npixels = json_object_get(from, "pixels"),
                 *flicker = json_object_get(from, "flicker");
    if (json_array_size(npixels) != REPORT_LABELS)
        return false;
    for (size_t label = 0; label < REPORT_LABELS; label++)
        out->npixels[label] = (uint64_t)json_integer_value(json_array_get(npixels, label));
    for (uint32_t r = 0; r < report->nrates; r++)
        for (uint32_t k = 0; k < report->nstrategies; k++)
            if (!read_tally(json_array_get(json_array_get(flicker, r), k), &out->flicker[r][k]))
                return false;
    for (int s = 0; s < REPORT_SOURCES; s++) {
        const json_t *one = json_object_get(from, report_source_name((report_source)s));
        const json_t *errors = json_object_get(one, "errors"),
                     *estimate = json_object_get(one, "estimate");
        if (!report->reference.used[s])
            continue;
        out->estimate[s] = json_is_null(estimate) ? (double)NAN : json_number_value(estimate);
        for (uint32_t r = 0; r < report->nrates; r++)
            for (uint32_t k = 0; k < report->nstrategies; k++)
                if (!read_errors(json_array_get(json_array_get(errors, r), k),
                                 &out->errors[s][r][k]))
                    return false;
    }
    return true;
}

static bool read_frame(const report_data *report, const json_t *root, experiment_frame *out) {
    const json_t *index = json_object_get(root, "frame"), *times = json_object_get(root, "ms"),
                 *references = json_object_get(root, "references");
    memset(out, 0, sizeof *out);
    if (!json_is_integer(index) || json_integer_value(index) < 0 ||
        json_integer_value(index) >= report_frame_count(report))
        return false;
    out->index = (uint32_t)json_integer_value(index);
    out->seconds = json_number_value(json_object_get(root, "seconds"));
    out->others = json_number_value(json_object_get(root, "others"));
    for (uint32_t r = 0; r < report->nrates; r++) {
        const json_t *row = json_array_get(times, r);
        for (uint32_t k = 0; k < report->nstrategies; k++) {
            if (!json_is_number(json_array_get(row, k)))
                return false;
            out->ms[r][k] = json_number_value(json_array_get(row, k));
        }
        if (!read_errors(json_array_get(json_object_get(root, "apart"), r), &out->apart[r]))
            return false;
    }
    out->referenced = json_is_object(references);
    return !out->referenced || read_references(report, references, out);
}

/* One write, so that an interruption leaves a line behind that is whole or has no end. */
static slv_result write_line(const slv_env *env, experiment_state *state, json_t *root) {
    char *line = root ? json_dumps(root, JSON_COMPACT | JSON_REAL_PRECISION(17)) : NULL;
    slv_result result = SLV_OK;
    json_decref(root);
    if (!line)
        return output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for a frame", state->path);
    size_t length = strlen(line);
    line[length] = '\n';
    ssize_t written = write(state->file, line, length + 1);
    if (written != (ssize_t)(length + 1)) {
        result = output_fail(env, SLV_ERROR_IO, "%s: cannot be written: %s", state->path,
                             written < 0 ? strerror(errno) : "the disk may be full");
        if (ftruncate(state->file, (off_t)state->size) != 0)
            result = SLV_ERROR_IO; /* the next run drops what has no end */
    } else {
        state->size += length + 1;
    }
    free(line);
    return result;
}

slv_result experiment_state_append(const slv_env *env, experiment_state *state,
                                   const report_data *report, const experiment_frame *frame) {
    return write_line(env, state, frame_json(report, frame));
}

/* Which condition differs, for the message. */
static slv_result check_conditions(const slv_env *env, const char *path, const json_t *before,
                                   const json_t *now) {
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)(uintptr_t)now, key, value) {
        if (!json_equal(value, json_object_get(before, key)))
            return output_fail(env, SLV_ERROR_MISMATCH,
                               "%s: was begun with another '%s': begin anew without --resume", path,
                               key);
    }
    return SLV_OK;
}

/* Who reads the frames, and what they must belong to. */
typedef struct reader {
    const slv_env *env;
    const char *path;
    const json_t *conditions;
    const report_data *report;
    slv_result (*each)(void *user, const experiment_frame *frame);
    void *user;
} reader;

/* `*complete` is where the last line ends that has an end. */
static slv_result read_lines(const reader *r, char *text, size_t size, uint64_t *complete) {
    const slv_env *env = r->env;
    const char *path = r->path;
    experiment_frame *frame = malloc(sizeof *frame);
    slv_result result =
        frame ? SLV_OK : output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for a frame", path);
    uint32_t number = 0;
    for (char *line = text, *end;
         !result && (end = memchr(line, '\n', size - (size_t)(line - text))); line = end + 1) {
        json_t *root = json_loadb(line, (size_t)(end - line), 0, NULL);
        number++;
        if (number == 1 && json_is_object(root))
            result = check_conditions(env, path, root, r->conditions);
        else if (root && number > 1 && read_frame(r->report, root, frame))
            result = r->each(r->user, frame);
        else
            result = output_fail(env, SLV_ERROR_FORMAT,
                                 "%s: line %u is not what compare writes: begin anew without "
                                 "--resume",
                                 path, number);
        json_decref(root);
        *complete = (uint64_t)(end + 1 - text);
    }
    free(frame);
    return result;
}

slv_result experiment_state_open(const slv_env *env, const char *path, const json_t *conditions,
                                 bool resume,
                                 slv_result (*each)(void *user, const experiment_frame *frame),
                                 void *user, const report_data *report, experiment_state *out) {
    char *text = NULL;
    size_t size = 0;
    slv_result result = SLV_OK;
    const reader r = {env, path, conditions, report, each, user};
    *out = (experiment_state){.file = -1, .path = path};
    bool there = access(path, F_OK) == 0 || errno != ENOENT;
    if (resume && there &&
        ((result = slv_text_load(env, path, &text, &size)) ||
         (result = read_lines(&r, text, size, &out->size))))
        goto done;
    out->file = open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (out->file < 0 || ftruncate(out->file, (off_t)out->size) != 0)
        result = output_fail(env, SLV_ERROR_IO, "%s: cannot be written: %s", path, strerror(errno));
    else if (!out->size)
        result = write_line(env, out, json_deep_copy(conditions));
done:
    slv_free(text);
    return result;
}

void experiment_state_close(experiment_state *state) {
    if (state->file >= 0)
        close(state->file);
    state->file = -1;
}
