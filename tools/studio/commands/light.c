/* Actions of the light: an image of all directions, and how it is turned. */
#include "studio/commands/commands.h"

#include <math.h>

/* In place of the light that there is; false: it has been said why not. */
bool studio_light_load(studio_app *app, const char *path) {
    slv_light light;
    if (studio_failed(app, scene_load_light(&app->document.env, path, 0, &light)))
        return false;
    app->light = light;
    g_free(app->light_path);
    app->light_path = g_canonicalize_filename(path, NULL);
    app->look.shading = SLV_SHADE_IMAGE;
    return true;
}

void studio_light_recall(studio_app *app) {
    if (app->look.shading != SLV_SHADE_IMAGE || app->light_path)
        return;
    if (!app->light_kept || !studio_light_load(app, app->light_kept))
        app->look.shading = SLV_SHADE_HEADLIGHT;
    g_clear_pointer(&app->light_kept, g_free);
}

void studio_do_light_path(studio_app *app, const char *target) {
    if (studio_light_load(app, target))
        app->look.light_turn = 0;
    studio_area_redraw(app, false);
}

static void chosen(studio_app *app, const char *path) {
    studio_actions_run(app, "light-path", path);
}

void studio_do_light(studio_app *app, const char *target) {
    (void)target;
    studio_choose_file(app, "An image of all directions that lights the surface (.exr, .png)",
                       GTK_FILE_CHOOSER_ACTION_OPEN, app->light_path, chosen);
}

static void turn(studio_app *app, float by) {
    if (app->look.shading != SLV_SHADE_IMAGE)
        studio_say(app, "The light is at the eye.", "Light from an Image", "light");
    app->look.light_turn = fmodf(app->look.light_turn + by, 360);
    studio_area_redraw(app, false);
}

void studio_do_light_left(studio_app *app, const char *target) {
    (void)target;
    turn(app, -15);
}

void studio_do_light_right(studio_app *app, const char *target) {
    (void)target;
    turn(app, 15);
}
