/* Actions of the stencil: an image before the picture, which strokes take their colours from. */
#include "studio/commands/commands.h"

#include <math.h>

/* As large as fits, in the middle. */
static void put_stencil(studio_app *app, const char *path, float aspect) {
    uint32_t width, height;
    studio_area_camera(app, &width, &height);
    g_free(app->paint.stencil.path);
    app->paint.stencil = (studio_stencil){.path = g_strdup(path),
                                          .width = fminf((float)width, (float)height * aspect),
                                          .aspect = aspect};
    app->tool = STUDIO_STENCIL;
    studio_say(
        app,
        "Drag moves the stencil, with Shift it turns, the wheel sizes it; B paints through it.",
        NULL, NULL);
}

/* Read here so that an image that is none is said now, and not by the first stroke. */
void studio_do_stencil_path(studio_app *app, const char *target) {
    slv_image image = {0};
    if (studio_failed(app, slv_image_load(&app->document.env, target, &image)))
        return;
    put_stencil(app, target, (float)image.width / (float)image.height);
    slv_image_free(&image);
    studio_area_redraw(app, false);
}

static void chosen(studio_app *app, const char *path) {
    studio_actions_run(app, "stencil-path", path);
}

void studio_do_stencil(studio_app *app, const char *target) {
    (void)target;
    studio_choose_file(app, "An image to paint through (.png, .exr)", GTK_FILE_CHOOSER_ACTION_OPEN,
                       NULL, chosen);
}

void studio_do_stencil_none(studio_app *app, const char *target) {
    (void)target;
    g_free(app->paint.stencil.path);
    app->paint.stencil = (studio_stencil){0};
    if (app->tool == STUDIO_STENCIL)
        app->tool = STUDIO_PAINT;
    studio_area_redraw(app, false);
}
