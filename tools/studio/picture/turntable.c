/* Turntables: as many numbered pictures as selvage render --turntable makes, of the same cameras.
 */
#include "studio/studio.h"

void studio_turntable_stop(studio_app *app) {
    frames_free(&app->turntable);
    g_free(app->turntable_path);
    g_free(app->screenshot);
    app->turntable_path = app->screenshot = NULL;
}

static void ask_for_picture(studio_app *app) {
    char path[FRAMES_PATH], text[64];
    snprintf(text, sizeof text, "Picture %u of %u of the turntable.", app->turned + 1,
             app->turntable.count);
    studio_say(app, text, "Cancel", "turntable-cancel");
    frames_name(app->turntable_path, app->turntable.numbers[app->turned], path);
    app->screenshot = g_strdup(path);
    studio_area_redraw(app, false);
}

slv_result studio_turntable_begin(studio_app *app, const char *path) {
    uint32_t width, height;
    char name[FRAMES_PATH];
    studio_turntable_stop(app);
    const slv_camera camera = studio_area_camera(app, &width, &height);
    if (!frames_name(path, app->turns, name)) {
        studio_say(app, "The name of the pictures is too long.", NULL, NULL);
        return SLV_OK;
    }
    slv_result result =
        frames_turntable(&app->document.env, &camera, app->document.scene.bounds_min,
                         app->document.scene.bounds_max, app->turns, &app->turntable);
    if (result)
        return result;
    app->turned = 0;
    app->turntable_path = g_strdup(path);
    ask_for_picture(app);
    return SLV_OK;
}

static void finish(studio_app *app) {
    char text[64];
    snprintf(text, sizeof text, "%u pictures have been written.", app->turntable.count);
    studio_turntable_stop(app);
    studio_say(app, text, NULL, NULL);
    studio_log(app, "\"event\":\"turntable\"");
    studio_area_redraw(app, false);
}

static gboolean go_on(gpointer user) {
    studio_app *app = user;
    if (app->closing || !app->turntable.count || app->screenshot)
        return G_SOURCE_REMOVE;
    if (++app->turned < app->turntable.count)
        ask_for_picture(app);
    else
        finish(app);
    return G_SOURCE_REMOVE;
}

/* Nothing changes its size while the window is drawn. */
void studio_turntable_next(studio_app *app) {
    if (app->turntable.count)
        g_idle_add(go_on, app);
}
