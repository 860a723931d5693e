/* The brush's size and opacity by dragging in the picture. */
#include "studio/studio.h"

#include <math.h>

bool studio_sizing_has_brush(const studio_app *app) {
    return app->tool == STUDIO_PAINT || app->tool == STUDIO_ERASE || app->tool == STUDIO_TEXELS;
}

void studio_sizing_begin(studio_app *app) {
    app->drag = STUDIO_DRAG_BRUSH;
    app->held[0] = app->x;
    app->held[1] = app->y;
}

/* All of the opacity is as far as two hundred pixels. */
void studio_sizing_drag(studio_app *app, double dx, double dy) {
    studio_paint *paint = &app->paint;
    paint->radius = fminf(fmaxf(paint->radius + (float)dx, 0.5f), 500);
    paint->opacity = fminf(fmaxf(paint->opacity - (float)dy / 200, 0), 1);
    app->syncing = true; /* the sliders follow, and change nothing by that */
    studio_panel_brush_sync(app);
    app->syncing = false;
    gtk_gl_area_queue_render(app->area);
}

void studio_sizing_end(studio_app *app) {
    studio_log(app, "\"event\":\"brush\",\"radius\":%.1f,\"opacity\":%.3f",
               (double)app->paint.radius, (double)app->paint.opacity);
}
