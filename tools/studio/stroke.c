/* Strokes of the pen. Samples wait in a line while dabs are made, a slice of time at once, so that
 * the window answers however many texels lie under a brush. */
#include "studio/studio.h"

#include <stdlib.h>
#include <string.h>

enum { SLICE = 30, LONG = 500 }; /* milliseconds: of work at once; and after which it is said */

static slv_result begin(studio_app *app, bool eraser) {
    uint32_t width, height;
    slv_camera camera = studio_area_camera(app, &width, &height);
    studio_paint paint = app->paint;
    slv_result result = studio_document_need_session(&app->document);
    if (result)
        return result;
    paint.erase = paint.erase || eraser || app->tool == STUDIO_ERASE;
    char *line = studio_paint_line(&paint, &app->document, &camera, width, height);
    result = line ? slv_session_stroke_begin(app->document.session, app->document.layer,
                                             app->document.mask, NULL, line, strlen(line))
                  : SLV_ERROR_MEMORY;
    free(line);
    return result;
}

/* Nothing waits any more, and the pointer is free. */
static void let_go(studio_app *app) {
    studio_stroke *s = &app->stroke;
    if (s->work)
        g_source_remove(s->work);
    if (s->waiting)
        g_array_free(s->waiting, TRUE);
    if (s->said)
        studio_say(app, NULL, NULL, NULL);
    *s = (studio_stroke){0};
    app->drag = STUDIO_DRAG_NONE;
}

static slv_result end(studio_app *app) {
    slv_stroke_stats stats = {0};
    slv_result result = slv_session_stroke_end(app->document.session, &stats);
    studio_log(app, "\"event\":\"stroke\",\"dabs\":%llu,\"missed\":%llu,\"texels\":%llu",
               (unsigned long long)stats.dabs, (unsigned long long)stats.missed,
               (unsigned long long)stats.texels);
    return result;
}

static gboolean work_on(gpointer user);

/* What waits, until the slice is over. */
static void work(studio_app *app) {
    studio_stroke *s = &app->stroke;
    const gint64 start = g_get_monotonic_time();
    guint done = 0;
    slv_result result = SLV_OK;
    while (!result && done < s->waiting->len &&
           g_get_monotonic_time() - start < (gint64)SLICE * 1000)
        result = slv_session_stroke_add(app->document.session,
                                        &g_array_index(s->waiting, slv_stroke_sample, done++), 1);
    g_array_remove_range(s->waiting, 0, done);
    const bool ends = !result && s->lifted && !s->waiting->len;
    if (ends)
        result = end(app);
    app->dirty = true;
    studio_area_redraw(app, true);
    if (result || ends) {
        let_go(app);
        studio_failed(app, result);
        studio_sync(app);
        studio_actions_run_asked(app);
    } else if (s->waiting->len && !s->work) {
        s->work = g_idle_add(work_on, app); /* after what is on the screen is another */
    }
}

static gboolean work_on(gpointer user) {
    studio_app *app = user;
    studio_stroke *s = &app->stroke;
    s->work = 0;
    if (s->lifted && !s->said && g_get_monotonic_time() - s->lifted > (gint64)LONG * 1000) {
        s->said = true;
        studio_say(app, "The stroke covers very many texels, and is still being painted.",
                   "Stop Here", "stroke-stop");
    }
    work(app);
    return G_SOURCE_REMOVE;
}

void studio_stroke_pen(studio_app *app, studio_pen what, const slv_stroke_sample *samples,
                       uint32_t count, bool eraser) {
    studio_stroke *s = &app->stroke;
    app->document.message[0] = 0;
    if (what == STUDIO_PEN_DOWN) {
        if (app->drag != STUDIO_DRAG_NONE || studio_failed(app, begin(app, eraser)))
            return;
        s->waiting = g_array_new(FALSE, FALSE, sizeof *samples);
        app->drag = STUDIO_DRAG_STROKE;
    }
    if (app->drag != STUDIO_DRAG_STROKE || s->lifted)
        return;
    g_array_append_vals(s->waiting, samples, count);
    if (what == STUDIO_PEN_UP)
        s->lifted = g_get_monotonic_time();
    work(app);
}

void studio_stroke_stop(studio_app *app) {
    if (!app->stroke.lifted)
        return;
    g_array_set_size(app->stroke.waiting, 0);
    work(app);
}
