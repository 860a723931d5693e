/* Strokes of the pen. Samples wait in a line while dabs are made, a slice of time at once, so that
 * the window answers however many texels lie under a brush. */
#include "studio/studio.h"

#include <stdlib.h>
#include <string.h>

enum { SLICE = 30, LONG = 500 }; /* milliseconds: of work at once; and after which it is said */

/* With a radius in pixels of the picture; or, where the surface that is seen is moved, so large as
 * a pixel is there, and samples lie on the surface. */
static slv_result begin(studio_app *app, float pixel) {
    uint32_t width, height;
    const slv_camera camera = studio_area_camera(app, &width, &height);
    studio_paint paint = app->paint;
    paint.erase = paint.erase || app->stroke.eraser || app->tool == STUDIO_ERASE;
    paint.radius *= pixel > 0 ? pixel : 1;
    char *line =
        studio_paint_line(&paint, &app->document, pixel > 0 ? NULL : &camera, width, height);
    slv_result result = line
                            ? slv_session_stroke_begin(app->document.session, app->document.layer,
                                                       app->document.mask, NULL, line, strlen(line))
                            : SLV_ERROR_MEMORY;
    free(line);
    app->stroke.begun = !result;
    return result;
}

/* How large a pixel is at a place that it shows. */
static float pixel_at(const slv_camera *camera, uint32_t height, const float at[3]) {
    const float *back = camera->world_to_camera + 8;
    const float depth = -(back[0] * at[0] + back[1] * at[1] + back[2] * at[2] + back[3]);
    return (camera->window[3] - camera->window[2]) / (float)height *
           (camera->perspective ? depth : 1);
}

/* What is painted on is the surface as it is without what displaces it, so that samples of one that
 * is displaced are told by where they lie on it. */
static slv_result add(studio_app *app, slv_stroke_sample sample) {
    uint32_t width, height;
    const slv_camera camera = studio_area_camera(app, &width, &height);
    slv_paint_hit hit;
    slv_result result = SLV_OK;
    if (studio_document_displacement(&app->document)) {
        if (!studio_document_pick(&app->document, &camera, width, height, sample.x, sample.y, &hit))
            return SLV_OK;
        sample.at = hit.point;
        if (!app->stroke.begun)
            result = begin(app, pixel_at(&camera, height, hit.position));
    } else if (!app->stroke.begun) {
        result = begin(app, 0);
    }
    return result ? result : slv_session_stroke_add(app->document.session, &sample, 1);
}

/* Whether there is something to paint on, and what is painted with can go there. */
static bool can_begin(studio_app *app) {
    app->document.message[0] = 0;
    if (studio_failed(app, studio_document_need_session(&app->document)))
        return false;
    if (!studio_document_displacement(&app->document) ||
        !(app->paint.project || app->paint.stencil.path))
        return true;
    studio_say(app,
               "What is projected from the view, or painted through an image, goes to the surface "
               "as it is without being moved.",
               "Move Nothing", "displace-none");
    return false;
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
    slv_result result =
        app->stroke.begun ? slv_session_stroke_end(app->document.session, &stats) : SLV_OK;
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
        result = add(app, g_array_index(s->waiting, slv_stroke_sample, done++));
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
    if (what == STUDIO_PEN_DOWN) {
        if (app->drag != STUDIO_DRAG_NONE || !can_begin(app))
            return;
        s->waiting = g_array_new(FALSE, FALSE, sizeof *samples);
        s->eraser = eraser;
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
