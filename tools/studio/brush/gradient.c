/* Gradients: a drag from one place of the surface to another fills what hangs together with the
 * first one, from the brush's colour to the other. */
#include "studio/commands/commands.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void studio_gradient_begin(studio_app *app) {
    app->drag = STUDIO_DRAG_GRADIENT;
    app->held[0] = app->x;
    app->held[1] = app->y;
    gtk_gl_area_queue_render(app->area);
}

/* The face under a place of the picture, and where that is on the surface that is painted on. */
static bool place(studio_app *app, double x, double y, slv_paint_hit *hit, float out[3]) {
    uint32_t width, height;
    const slv_camera camera = studio_area_camera(app, &width, &height);
    return studio_document_pick(&app->document, &camera, width, height, (float)x, (float)y, hit) &&
           studio_document_place(&app->document, hit->point, out);
}

/* The face, then the two places. */
void studio_gradient_end(studio_app *app) {
    slv_paint_hit first, last;
    float at[6];
    app->drag = STUDIO_DRAG_NONE;
    gtk_gl_area_queue_render(app->area);
    if (!place(app, app->held[0], app->held[1], &first, at) ||
        !place(app, app->x, app->y, &last, at + 3) || memcmp(at, at + 3, 3 * sizeof *at) == 0) {
        studio_say(app, "A gradient is dragged from one place of the surface to another.", NULL,
                   NULL);
        return;
    }
    GString *target = g_string_new(NULL);
    g_string_printf(target, "%d", (int)first.point.face);
    for (int i = 0; i < 6; i++) {
        char number[G_ASCII_DTOSTR_BUF_SIZE];
        g_string_append_printf(target, " %s", g_ascii_dtostr(number, sizeof number, (double)at[i]));
    }
    studio_actions_run(app, "fill-gradient", target->str);
    g_string_free(target, TRUE);
}

void studio_do_fill_gradient(studio_app *app, const char *target) {
    studio_gradient gradient = {.radial = app->paint.radial};
    char *at;
    const uint32_t face = (uint32_t)strtoul(target, &at, 10);
    for (int i = 0; i < 3; i++)
        gradient.from[i] = (float)g_ascii_strtod(at, &at);
    for (int i = 0; i < 3; i++)
        gradient.to[i] = (float)g_ascii_strtod(at, &at);
    studio_fill(app, face, SLV_SELECT_CONNECTED, &gradient);
}

void studio_do_gradient_round(studio_app *app, const char *target) {
    (void)target;
    app->paint.radial = !app->paint.radial;
}

const char *studio_get_gradient_round(const studio_app *app) {
    return app->paint.radial ? "on" : NULL;
}

void studio_do_colors_swap(studio_app *app, const char *target) {
    (void)target;
    for (int c = 0; c < 3; c++) {
        const float color = app->paint.color[c];
        app->paint.color[c] = app->paint.other[c];
        app->paint.other[c] = color;
    }
}
