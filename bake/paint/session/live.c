/* A stroke that is painted while its samples come, and goes into the journal when it ends. */
#include "session/session_data.h"

#include "base/log.h"
#include "history/history.h"
#include "script/script_data.h"

#include <math.h>
#include <string.h>

/* Ends what is open: with another result than SLV_OK all of it is taken back. */
static slv_result end(slv_session *session, slv_result result) {
    slvi_live_stroke *live = &session->live;
    slv_stroke_destroy(live->stroke);
    slv_script_destroy(live->script);
    json_decref(live->line);
    json_decref(live->samples);
    live->stroke = NULL;
    live->script = NULL;
    live->line = live->samples = NULL;
    session->running = false;
    return slvi_edit_end(session->document, &live->edit, NULL, result);
}

/* The line as scripts know it, and the layer that it is for, which the journal's has beside. */
static slv_result begin(slv_session *session, uint32_t layer, bool mask, json_t *line) {
    slvi_live_stroke *live = &session->live;
    slv_result result = slvi_session_script(session, layer, mask, &live->script);
    live->line = json_copy(session->set);
    slvi_session_make_bare(live->line);
    live->samples = json_array();
    live->last = -INFINITY;
    json_object_update(live->line, line);
    if (!result)
        result = slvi_script_stroke(live->script, session->journal.next, live->line, &live->stroke);
    if (!result)
        result = slvi_session_keep(session, layer, mask, live->line);
    return result;
}

slv_result slv_session_stroke_begin(slv_session *session, uint32_t layer, bool mask,
                                    const char *folder, const char *line, size_t size) {
    json_t *root;
    if (session->document->history.open)
        return slvi_fail(&session->env, SLV_ERROR_ARGUMENT,
                         "%s: a stroke cannot begin within an entry of the history", session->path);
    slv_result result = slvi_session_line(session, folder, line, size, &root);
    if (result)
        return result;
    if (!(result =
              slvi_edit_begin(session->document, slvi_session_name(root), &session->live.edit))) {
        session->running = true;
        if ((result = begin(session, layer, mask, root)))
            result = end(session, result);
    }
    json_decref(root);
    return result;
}

static slv_result none(const slv_session *session) {
    return slvi_fail(&session->env, SLV_ERROR_ARGUMENT, "%s: no stroke has begun", session->path);
}

static float within(float value, float low, float high) {
    return value < low ? low : value > high ? high : value; /* NaN stays */
}

/* What a pen says that is not calibrated, or comes late: the journal has it as scripts may. */
static slv_stroke_sample in_range(const slv_stroke_sample *given, double last) {
    slv_stroke_sample s = *given;
    s.pressure = within(s.pressure, 0, 1);
    s.tilt_x = within(s.tilt_x, -1, 1);
    s.tilt_y = within(s.tilt_y, -1, 1);
    s.time = s.time < last ? last : s.time;
    return s;
}

slv_result slv_session_stroke_add(slv_session *session, const slv_stroke_sample *samples,
                                  uint32_t count) {
    slvi_live_stroke *live = &session->live;
    slv_result result = SLV_OK;
    if (!live->stroke)
        return none(session);
    const bool in_picture = json_is_object(json_object_get(live->line, "camera"));
    for (uint32_t i = 0; !result && i < count; i++) {
        const slv_stroke_sample own = in_range(&samples[i], live->last), *s = &own;
        const double rest[] = {(double)s->pressure, s->time, (double)s->tilt_x, (double)s->tilt_y};
        json_t *list =
            in_picture ? json_pack("[f, f]", (double)s->x, (double)s->y)
                       : json_pack("[i, f, f]", (int)s->at.face, (double)s->at.u, (double)s->at.v);
        for (size_t k = 0; k < sizeof rest / sizeof *rest; k++)
            json_array_append_new(list, json_real(rest[k]));
        if (json_array_size(list) != (in_picture ? 6 : 7))
            result = slvi_fail(&session->env, SLV_ERROR_ARGUMENT,
                               "%s: sample %u of the stroke is not finite", session->path, i);
        if (result || json_array_append_new(live->samples, list) != 0) {
            json_decref(result ? list : NULL);
            result = result ? result
                            : slvi_fail(&session->env, SLV_ERROR_MEMORY,
                                        "%s: no memory for a stroke", session->path);
        }
        live->last = own.time;
        if (!result)
            result = slv_stroke_add(live->stroke, &own, 1);
    }
    return result ? end(session, result) : SLV_OK;
}

slv_result slv_session_stroke_end(slv_session *session, slv_stroke_stats *stats) {
    slvi_live_stroke *live = &session->live;
    slv_stroke_stats own;
    if (!live->stroke)
        return none(session);
    if (!json_array_size(live->samples)) {
        slv_session_stroke_cancel(session);
        return SLV_OK;
    }
    slv_result result = slv_stroke_end(live->stroke, stats ? stats : &own);
    json_object_set(live->line, "samples", live->samples);
    if (!result)
        result = slvi_session_note(session, live->script);
    return end(session, result);
}

void slv_session_stroke_cancel(slv_session *session) {
    if (session->live.stroke && end(session, SLV_ERROR_CANCELLED) == SLV_OK)
        session->live.stroke = NULL;
}
