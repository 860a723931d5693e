/* The picture in the window: OpenGL, the pointer, and refining at rest. */
#include "studio/studio.h"

#include <math.h>
#include <string.h>

/* A picture is refined so long after the last motion, in milliseconds. */
enum { REST = 150 };
#define SLOWEST                                                                                    \
    (1 / 28.0) /* seconds of a picture, beyond which those that move are drawn smaller */

/* ---- redrawing ---- */

static gboolean at_rest(gpointer user) {
    studio_app *app = user;
    app->rest = 0;
    app->stale = true;
    gtk_gl_area_queue_render(app->area);
    return G_SOURCE_REMOVE;
}

void studio_area_redraw(studio_app *app, bool moving) {
    if (moving)
        app->moved = g_get_monotonic_time();
    app->refined = false;
    app->stale = true;
    gtk_gl_area_queue_render(app->area);
}

static bool is_moving(const studio_app *app) {
    return app->drag != STUDIO_DRAG_NONE ||
           (app->moved && g_get_monotonic_time() - app->moved < REST * 1000);
}

slv_camera studio_area_camera(const studio_app *app, uint32_t *width, uint32_t *height) {
    GtkWidget *widget = GTK_WIDGET(app->area);
    int scale = gtk_widget_get_scale_factor(widget);
    *width = (uint32_t)MAX(1, gtk_widget_get_width(widget) * scale);
    *height = (uint32_t)MAX(1, gtk_widget_get_height(widget) * scale);
    return studio_camera_get(&app->camera, (float)*width / (float)*height);
}

static void frame_if_new(studio_app *app) {
    uint32_t width, height;
    if (app->framed)
        return;
    studio_area_camera(app, &width, &height);
    studio_camera_frame(&app->camera, app->document.scene.bounds_min,
                        app->document.scene.bounds_max, (float)width / (float)height);
    app->framed = true;
}

static void write_screenshot(studio_app *app) {
    slv_image image = {0};
    char *path = app->screenshot;
    app->screenshot = NULL;
    slv_result result = studio_picture_read(app->picture, &image);
    if (!result)
        result = slv_image_save(&app->document.env, path, &image,
                                &(slv_image_params){.encoding = SLV_ENCODE_RAW});
    slv_image_free(&image);
    if (studio_failed(app, result)) {
        studio_turntable_stop(app);
    } else {
        studio_log(app, "\"event\":\"screenshot\"");
        studio_turntable_next(app);
    }
    g_free(path);
}

/* A smaller picture while it moves, if that is what it takes; larger again where there is time.
 * What the window takes to be put together counts as well. */
static void adapt(GdkFrameClock *clock, gpointer user) {
    studio_app *app = user;
    (void)clock;
    if (app->ready == STUDIO_READY_SAID) { /* the words are on the screen now */
        app->ready = STUDIO_READY_SHOWN;
        gtk_gl_area_queue_render(app->area);
    }
    if (!app->began)
        return;
    const double whole = (double)(g_get_monotonic_time() - app->began) * 1e-6,
                 seconds = fmax(whole, app->stats.seconds);
    app->began = 0;
    if (seconds > SLOWEST && app->scale > 0.3f)
        app->scale *= 0.8f;
    else if (seconds < SLOWEST / 2 && app->scale < 1)
        app->scale = fminf(1, app->scale * 1.1f);
}

/* Labels must not change their size while the window is drawn, and need not with each picture. */
static gboolean follow(gpointer user) {
    studio_app *app = user;
    app->follow = 0;
    if (!app->closing) {
        studio_panel_inspector_sync(app);
        studio_log_place(app, "history", app->history);
        studio_log_place(app, "swatches", app->swatch_list);
        studio_log_place(app, "opacity", app->layer_opacity);
    }
    return G_SOURCE_REMOVE;
}

static void follow_soon(studio_app *app) {
    if (!app->follow)
        app->follow = g_timeout_add(100, follow, app);
}

static gboolean say_preparing(gpointer user) {
    studio_app *app = user;
    if (app->closing || app->ready != STUDIO_READY_WANTED)
        return G_SOURCE_REMOVE;
    app->ready = STUDIO_READY_SAID;
    gtk_label_set_text(GTK_LABEL(app->status),
                       "Making ready: shaders are compiled and texels go to the GPU…");
    gtk_widget_queue_draw(app->status);
    studio_log(app, "\"event\":\"preparing\"");
    return G_SOURCE_REMOVE;
}

/* False: what the picture needs first is made with the next one. */
static bool is_ready(studio_app *app, const studio_shot *shot) {
    if (app->ready == STUDIO_READY_SHOWN ||
        studio_picture_is_ready(app->picture, &app->document, shot)) {
        app->ready = STUDIO_READY;
        return true;
    }
    if (app->ready == STUDIO_READY) {
        app->ready = STUDIO_READY_WANTED;
        g_idle_add_full(G_PRIORITY_HIGH_IDLE, say_preparing, app, NULL); /* before pictures */
    }
    studio_failed(app, studio_picture_keep(app->picture, &app->document, shot));
    return false;
}

/* A ring as large as the brush. */
static void put_cursor(const studio_app *app, studio_shot *shot) {
    const bool held = app->drag == STUDIO_DRAG_BRUSH;
    if (app->drag == STUDIO_DRAG_GRADIENT) { /* how far it reaches */
        shot->cursor[0] = (float)app->held[0];
        shot->cursor[1] = (float)app->held[1];
        shot->cursor[2] = (float)hypot(app->x - app->held[0], app->y - app->held[1]);
        return;
    }
    if (!studio_sizing_has_brush(app) || !app->pointer_inside || app->screenshot)
        return;
    shot->cursor[0] = (float)(held ? app->held[0] : app->x);
    shot->cursor[1] = (float)(held ? app->held[1] : app->y);
    shot->cursor[2] = app->paint.radius;
}

static gboolean render(GtkGLArea *area, GdkGLContext *context, gpointer user) {
    studio_app *app = user;
    studio_shot shot = {.look = app->look, .background = {0.03f, 0.03f, 0.035f, 1}};
    (void)area;
    (void)context;
    if (!app->picture || !app->document.texture)
        return TRUE;
    gint64 start = g_get_monotonic_time();
    if (app->dirty && studio_failed(app, studio_document_refresh(&app->document)))
        return TRUE;
    if (app->dirty)
        studio_seam_forget(app);
    app->dirty = false;
    frame_if_new(app);
    shot.camera = studio_area_camera(app, &shot.width, &shot.height);
    if (app->turntable.count) /* of another place, in the window as it is now */
        memcpy(shot.camera.world_to_camera, app->turntable.cameras[app->turned].world_to_camera,
               sizeof shot.camera.world_to_camera);
    shot.coarse = is_moving(app);
    shot.light = slv_light_turn(&app->light, app->look.light_turn);
    put_cursor(app, &shot);
    shot.stencil = app->paint.stencil.path && !app->screenshot ? &app->paint.stencil : NULL;
    g_autofree uint8_t *meant = studio_texels_meant(app);
    shot.meant = meant;
    if (!app->stale && app->refined && !app->screenshot) {
        shot.again = true;
        studio_failed(app, studio_picture_draw(app->picture, &app->document, &shot, &app->stats));
        return TRUE;
    }
    if (!is_ready(app, &shot))
        return TRUE;
    app->stale = false;
    shot.scale = shot.coarse ? app->scale : 1;
    slv_result result = studio_picture_draw(app->picture, &app->document, &shot, &app->stats);
    if (result) {
        if (result == SLV_ERROR_GL)
            studio_log(app, "\"event\":\"gl-error\"");
        studio_failed(app, result);
        return TRUE;
    }
    double seconds = (double)(g_get_monotonic_time() - start) * 1e-6;
    app->began = shot.coarse ? start : 0;
    if (shot.coarse && !app->rest)
        app->rest = g_timeout_add(REST, at_rest, app);
    app->refined = !shot.coarse;
    app->frames++;
    studio_log(app,
               "\"event\":\"frame\",\"number\":%u,\"ms\":%.2f,\"draw_ms\":%.2f,\"scale\":%.2f,"
               "\"input_ms\":%u,\"refined\":%s",
               app->frames, 1e3 * seconds, 1e3 * app->stats.seconds, (double)shot.scale,
               app->input ? (guint32)(g_get_monotonic_time() / 1000) - app->input : 0,
               app->refined ? "true" : "false");
    app->input = 0;
    if (app->refined && app->screenshot)
        write_screenshot(app);
    if (app->refined)
        studio_seam_soon(app);
    follow_soon(app);
    return TRUE;
}

void studio_area_forget(studio_app *app) {
    if (!app->picture)
        return;
    gtk_gl_area_make_current(app->area);
    studio_picture_forget(app->picture);
}

/* ---- the context ---- */

/* Desktop OpenGL 4.5: from 4.14 on GTK would take OpenGL ES. */
static GdkGLContext *create_context(GtkGLArea *area, gpointer user) {
    GError *error = NULL;
    GtkNative *native = gtk_widget_get_native(GTK_WIDGET(area));
    GdkGLContext *context = gdk_surface_create_gl_context(gtk_native_get_surface(native), &error);
    (void)user;
    if (context) {
        gdk_gl_context_set_allowed_apis(context, GDK_GL_API_GL);
        gdk_gl_context_set_required_version(context, 4, 5);
        if (gdk_gl_context_realize(context, &error))
            return context;
        g_object_unref(context);
    }
    gtk_gl_area_set_error(area, error);
    g_clear_error(&error);
    return NULL;
}

static gboolean show_message(gpointer user) {
    studio_app *app = user;
    if (!app->closing) {
        studio_page(app, "message", NULL);
        studio_log(app, "\"event\":\"no-gl\"");
    }
    return G_SOURCE_REMOVE;
}

static void realize(GtkWidget *widget, gpointer user) {
    studio_app *app = user;
    char text[1024];
    const char *why = app->document.message;
    gtk_gl_area_make_current(app->area);
    const GError *error = gtk_gl_area_get_error(app->area);
    app->document.message[0] = 0;
    if (error) {
        why = error->message;
    } else if (!studio_picture_create(&app->document.env, &app->picture)) {
        app->painted = g_signal_connect(gtk_widget_get_frame_clock(widget), "after-paint",
                                        G_CALLBACK(adapt), app);
        studio_log(app, "\"event\":\"driver\",\"name\":\"%s\"",
                   studio_picture_info(app->picture)->renderer);
        return;
    }
    snprintf(text, sizeof text,
             "This display has no OpenGL 4.5, with which pictures are drawn here.\n%s\n\nWithout a "
             "window, selvage render draws pictures, selvage compare compares strategies, and "
             "selvage paint and selvage session paint.",
             why);
    studio_page(app, NULL, text);
    g_idle_add(show_message, app); /* not while the area is being realized */
}

static void unrealize(GtkWidget *widget, gpointer user) {
    studio_app *app = user;
    if (app->painted)
        g_signal_handler_disconnect(gtk_widget_get_frame_clock(widget), app->painted);
    app->painted = 0;
    gtk_gl_area_make_current(app->area);
    if (!gtk_gl_area_get_error(app->area))
        studio_picture_destroy(app->picture);
    app->picture = NULL;
}

static void resized(GtkGLArea *area, int width, int height, gpointer user) {
    studio_app *app = user;
    (void)width;
    (void)height;
    app->stale = true;
    studio_log_place(app, "area", GTK_WIDGET(area));
}

/* ---- the pointer ---- */

static double axis_of(const double *axes, GdkAxisFlags has, GdkAxisFlags flag, GdkAxisUse use,
                      double otherwise) {
    return has & flag ? axes[use] : otherwise;
}

/* What a pen says with an event, and which of it it can say. Mice have no axes, and asking an event
 * for one that it has not is fatal. */
static GdkAxisFlags axes_of(GdkEvent *event, double axes[GDK_AXIS_LAST]) {
    GdkDeviceTool *tool = gdk_event_get_device_tool(event);
    double *found = NULL;
    guint count = 0;
    if (!tool || !gdk_event_get_axes(event, &found, &count) || !found)
        return 0;
    memcpy(axes, found, MIN(count, (guint)GDK_AXIS_LAST) * sizeof *axes);
    return gdk_device_tool_get_axes(tool);
}

/* From the surface's coordinates to pixels of the area. */
static void place(const studio_app *app, double *x, double *y) {
    GtkWidget *widget = GTK_WIDGET(app->area);
    GtkNative *native = gtk_widget_get_native(widget);
    int scale = gtk_widget_get_scale_factor(widget);
    double nx, ny;
    gtk_native_get_surface_transform(native, &nx, &ny);
    gtk_widget_translate_coordinates(GTK_WIDGET(native), widget, *x - nx, *y - ny, x, y);
    *x *= scale;
    *y *= scale;
}

/* Of an event, the motions that it stands for and itself, at most `most`. */
static uint32_t samples_of(studio_app *app, GdkEvent *event, slv_stroke_sample *out,
                           uint32_t most) {
    guint n = 0;
    uint32_t count = 0;
    GdkTimeCoord *history = gdk_event_get_event_type(event) == GDK_MOTION_NOTIFY
                                ? gdk_event_get_history(event, &n)
                                : NULL;
    for (guint i = 0; i <= n && count < most; i++) {
        double axes[GDK_AXIS_LAST] = {0}, x = 0, y = 0;
        GdkAxisFlags has = 0;
        guint32 time = gdk_event_get_time(event);
        if (i < n) {
            memcpy(axes, history[i].axes, sizeof axes);
            has = history[i].flags;
            time = history[i].time;
            x = axes[GDK_AXIS_X];
            y = axes[GDK_AXIS_Y];
            if (!(has & GDK_AXIS_FLAG_X) || !(has & GDK_AXIS_FLAG_Y))
                continue;
        } else {
            gdk_event_get_position(event, &x, &y);
            has = axes_of(event, axes);
        }
        place(app, &x, &y);
        if (app->drag != STUDIO_DRAG_STROKE && !count)
            app->start_time = time;
        out[count++] = (slv_stroke_sample){
            .x = (float)x,
            .y = (float)y,
            .pressure = (float)axis_of(axes, has, GDK_AXIS_FLAG_PRESSURE, GDK_AXIS_PRESSURE, 1),
            .tilt_x = (float)axis_of(axes, has, GDK_AXIS_FLAG_XTILT, GDK_AXIS_XTILT, 0),
            .tilt_y = (float)axis_of(axes, has, GDK_AXIS_FLAG_YTILT, GDK_AXIS_YTILT, 0),
            .time = MAX(0, (double)time - app->start_time) / 1000};
    }
    g_free(history);
    return count;
}

static bool is_eraser(GdkEvent *event) {
    GdkDeviceTool *tool = gdk_event_get_device_tool(event);
    return tool && gdk_device_tool_get_tool_type(tool) == GDK_DEVICE_TOOL_TYPE_ERASER;
}

static bool hit(studio_app *app, double x, double y, slv_paint_hit *out) {
    uint32_t width, height;
    slv_camera camera = studio_area_camera(app, &width, &height);
    return studio_document_pick(&app->document, &camera, width, height, (float)x, (float)y, out);
}

/* Tools of one click. */
static void click(studio_app *app, double x, double y) {
    slv_paint_hit at;
    char target[32];
    if (!hit(app, x, y, &at))
        return;
    snprintf(target, sizeof target, "%d", (int)at.point.face);
    if (app->tool == STUDIO_FILL)
        studio_actions_run(app, "fill-face", target);
    else if (app->tool == STUDIO_SELECT)
        studio_actions_run(app, "select-face", target);
    else
        studio_actions_run(app, "pick-color", NULL);
}

static bool on_divider(const studio_app *app, double x) {
    uint32_t width, height;
    studio_area_camera(app, &width, &height);
    return app->look.compare == STUDIO_SPLIT &&
           fabs(x - (double)(app->look.divider * (float)width)) < 8;
}

static gboolean press(studio_app *app, GdkEvent *event) {
    enum { MOST = 1 };
    slv_stroke_sample sample[MOST];
    GdkModifierType state = gdk_event_get_modifier_state(event);
    guint button = gdk_button_event_get_button(event);
    if (app->drag != STUDIO_DRAG_NONE || !app->document.texture)
        return TRUE;
    app->button = button;
    gtk_widget_grab_focus(GTK_WIDGET(app->area));
    samples_of(app, event, sample, MOST);
    app->x = (double)sample->x;
    app->y = (double)sample->y;
    bool turns = app->tool == STUDIO_VIEW || (state & GDK_ALT_MASK);
    bool places = app->tool == STUDIO_STENCIL && app->paint.stencil.path && !turns;
    if (button == 1 && on_divider(app, app->x))
        app->drag = STUDIO_DRAG_DIVIDER;
    else if (button == 1 && places)
        app->drag = state & GDK_SHIFT_MASK ? STUDIO_DRAG_STENCIL_TURN : STUDIO_DRAG_STENCIL;
    else if (button == 2 || (button == 1 && turns && (state & GDK_SHIFT_MASK)))
        app->drag = button == 2 && !(state & GDK_SHIFT_MASK) && !turns ? STUDIO_DRAG_ORBIT
                                                                       : STUDIO_DRAG_PAN;
    else if (button == 3)
        app->drag = turns ? STUDIO_DRAG_ZOOM : STUDIO_DRAG_ORBIT;
    else if (button == 1 && turns)
        app->drag = STUDIO_DRAG_ORBIT;
    else if (button == 1 && (state & GDK_CONTROL_MASK) && studio_sizing_has_brush(app))
        studio_sizing_begin(app);
    else if (button == 1 && (app->tool == STUDIO_PAINT || app->tool == STUDIO_ERASE))
        studio_stroke_pen(app, STUDIO_PEN_DOWN, sample, 1, is_eraser(event));
    else if (button == 1 && app->tool == STUDIO_GRADIENT)
        studio_gradient_begin(app);
    else if (button == 1 && app->tool == STUDIO_TEXELS)
        studio_texels_begin(app, (state & GDK_SHIFT_MASK) || is_eraser(event));
    else if (button == 1)
        click(app, app->x, app->y);
    return TRUE;
}

static void drag_view(studio_app *app, double dx, double dy) {
    uint32_t width, height;
    studio_area_camera(app, &width, &height);
    if (app->drag == STUDIO_DRAG_ORBIT)
        studio_camera_orbit(&app->camera, (float)dx, (float)dy);
    else if (app->drag == STUDIO_DRAG_PAN)
        studio_camera_pan(&app->camera, (float)dx, (float)dy, height);
    else if (app->drag == STUDIO_DRAG_ZOOM)
        studio_camera_zoom(&app->camera, expf((float)(dx - dy) * 0.005f));
    else
        app->look.divider = fminf(fmaxf((float)app->x / (float)width, 0), 1);
    studio_area_redraw(app, true);
}

/* Nothing but what goes over the picture is another then. */
static void drag_stencil(studio_app *app, double dx, double dy) {
    studio_stencil *stencil = &app->paint.stencil;
    if (app->drag == STUDIO_DRAG_STENCIL_TURN) {
        stencil->angle = fmodf(stencil->angle + 0.5f * (float)dx, 360);
    } else {
        stencil->at[0] += (float)dx;
        stencil->at[1] += (float)dy;
    }
    gtk_gl_area_queue_render(app->area);
}

static gboolean motion(studio_app *app, GdkEvent *event) {
    enum { MOST = 1024 };
    static slv_stroke_sample samples[MOST];
    uint32_t count = samples_of(app, event, samples, MOST);
    if (!count)
        return FALSE;
    const slv_stroke_sample *last = &samples[count - 1];
    double dx = (double)last->x - app->x, dy = (double)last->y - app->y;
    app->x = (double)last->x;
    app->y = (double)last->y;
    app->pressure = last->pressure;
    app->tilt[0] = last->tilt_x;
    app->tilt[1] = last->tilt_y;
    app->pointer_inside = true;
    if (app->drag == STUDIO_DRAG_STROKE && !app->stroke.lifted) {
        studio_log(app, "\"event\":\"samples\",\"count\":%u", count);
        studio_stroke_pen(app, STUDIO_PEN_MOVE, samples, count, false);
    } else if (app->drag == STUDIO_DRAG_TEXELS) {
        for (uint32_t i = 0; i < count && app->drag == STUDIO_DRAG_TEXELS; i++) {
            app->x = (double)samples[i].x;
            app->y = (double)samples[i].y;
            studio_texels_touch(app);
        }
    } else if (app->drag == STUDIO_DRAG_STENCIL || app->drag == STUDIO_DRAG_STENCIL_TURN) {
        drag_stencil(app, dx, dy);
    } else if (app->drag == STUDIO_DRAG_BRUSH) {
        studio_sizing_drag(app, dx, dy);
    } else if (app->drag == STUDIO_DRAG_GRADIENT) {
        gtk_gl_area_queue_render(app->area);
    } else if (app->drag != STUDIO_DRAG_NONE && app->drag != STUDIO_DRAG_STROKE) {
        drag_view(app, dx, dy);
    } else {
        follow_soon(app);
        gtk_gl_area_queue_render(app->area); /* the ring goes along */
    }
    return FALSE;
}

static gboolean release(studio_app *app, GdkEvent *event) {
    if (gdk_button_event_get_button(event) != app->button)
        return FALSE;
    if (app->drag == STUDIO_DRAG_STROKE) { /* it may go on for a while */
        studio_stroke_pen(app, STUDIO_PEN_UP, NULL, 0, false);
        return FALSE;
    }
    if (app->touched)
        studio_texels_end(app);
    else if (app->drag == STUDIO_DRAG_BRUSH)
        studio_sizing_end(app);
    else if (app->drag == STUDIO_DRAG_GRADIENT)
        studio_gradient_end(app);
    else if (app->drag != STUDIO_DRAG_NONE)
        studio_log(app, "\"event\":\"view\",\"azimuth\":%.3f,\"elevation\":%.3f,\"distance\":%.5g",
                   (double)app->camera.azimuth, (double)app->camera.elevation,
                   (double)app->camera.distance);
    app->drag = STUDIO_DRAG_NONE;
    studio_area_redraw(app, true);
    return FALSE;
}

static gboolean scroll(studio_app *app, GdkEvent *event) {
    double dx = 0, dy = 0;
    GdkScrollDirection direction = gdk_scroll_event_get_direction(event);
    if (direction == GDK_SCROLL_SMOOTH)
        gdk_scroll_event_get_deltas(event, &dx, &dy);
    else
        dy = direction == GDK_SCROLL_UP ? -1 : direction == GDK_SCROLL_DOWN ? 1 : 0;
    const float factor = powf(1.1f, (float)-dy);
    if (app->tool == STUDIO_STENCIL && app->paint.stencil.path) {
        app->paint.stencil.width = fminf(fmaxf(app->paint.stencil.width * factor, 4), 1e5f);
        gtk_gl_area_queue_render(app->area);
        return TRUE;
    }
    studio_camera_zoom(&app->camera, factor);
    studio_area_redraw(app, true);
    return TRUE;
}

static void leave(GtkEventControllerMotion *controller, gpointer user) {
    studio_app *app = user;
    (void)controller;
    app->pointer_inside = false;
    gtk_gl_area_queue_render(app->area);
}

static gboolean handle(GtkEventControllerLegacy *controller, GdkEvent *event, gpointer user) {
    studio_app *app = user;
    (void)controller;
    if (!app->input)
        app->input = gdk_event_get_time(event);
    switch (gdk_event_get_event_type(event)) {
    case GDK_BUTTON_PRESS:
        return press(user, event);
    case GDK_BUTTON_RELEASE:
        return release(user, event);
    case GDK_MOTION_NOTIFY:
        return motion(user, event);
    case GDK_SCROLL:
        return scroll(user, event);
    default:
        return FALSE;
    }
}

GtkWidget *studio_area_create(studio_app *app) {
    GtkWidget *widget = gtk_gl_area_new();
    GtkEventController *controller = gtk_event_controller_legacy_new(),
                       *crossing = gtk_event_controller_motion_new();
    app->area = GTK_GL_AREA(widget);
    app->scale = 1;
    gtk_gl_area_set_auto_render(app->area, FALSE);
    gtk_widget_set_hexpand(widget, TRUE);
    gtk_widget_set_vexpand(widget, TRUE);
    gtk_widget_set_focusable(widget, TRUE);
    gtk_accessible_update_property(GTK_ACCESSIBLE(widget), GTK_ACCESSIBLE_PROPERTY_LABEL,
                                   "The surface", -1);
    g_signal_connect(widget, "create-context", G_CALLBACK(create_context), app);
    g_signal_connect(widget, "realize", G_CALLBACK(realize), app);
    g_signal_connect(widget, "unrealize", G_CALLBACK(unrealize), app);
    g_signal_connect(widget, "render", G_CALLBACK(render), app);
    g_signal_connect(widget, "resize", G_CALLBACK(resized), app);
    g_signal_connect(controller, "event", G_CALLBACK(handle), app);
    g_signal_connect(crossing, "leave", G_CALLBACK(leave), app);
    gtk_widget_add_controller(widget, controller);
    gtk_widget_add_controller(widget, crossing);
    return widget;
}
