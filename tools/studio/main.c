/* The studio's program: a display, a window, a loop. */
#include "studio/studio.h"

#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Without a session bus nobody could ask for names and roles, or keep what file choosers remember,
 * and GTK would complain. */
static void find_bus(void) {
    char *bus = g_build_filename(g_get_user_runtime_dir(), "bus", NULL);
    if (!g_getenv("DBUS_SESSION_BUS_ADDRESS") && !g_file_test(bus, G_FILE_TEST_EXISTS)) {
        g_setenv("GTK_A11Y", "none", FALSE);
        g_setenv("GSETTINGS_BACKEND", "memory", FALSE);
    }
    g_free(bus);
}

/* Where OpenGL is done in software, the toolkit puts a window together in half the time without it.
 */
static void choose_renderer(void) {
    GdkGLContext *context = gdk_display_create_gl_context(gdk_display_get_default(), NULL);
    if (context && gdk_gl_context_realize(context, NULL)) {
        gdk_gl_context_make_current(context);
        if (studio_picture_in_software())
            g_setenv("GSK_RENDERER", "cairo", FALSE);
        gdk_gl_context_clear_current();
    }
    g_clear_object(&context);
}

/* For the log: when the window takes nothing for a good while, and how much of it the processors
 * worked here, since others may have had them. */
static gboolean watch(gpointer user) {
    enum { LONG = 500 * 1000 }; /* microseconds */
    studio_app *app = user;
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    const gint64 now = g_get_monotonic_time();
    const double worked = (double)time.tv_sec + (double)time.tv_nsec * 1e-9;
    if (app->watched && now - app->watched > LONG)
        studio_log(app, "\"event\":\"held\",\"seconds\":%.3f,\"worked\":%.3f",
                   (double)(now - app->watched) * 1e-6, worked - app->worked);
    app->watched = now;
    app->worked = worked;
    return G_SOURCE_CONTINUE;
}

static void activate(GtkApplication *application, gpointer user) {
    studio_app *app = user;
    const char *path = app->pending;
    (void)application;
    app->pending = NULL;
    choose_renderer();
    studio_window_create(app);
    studio_settings_load(app);
    studio_sync(app);
    gtk_window_present(app->window);
    studio_log(app, "\"event\":\"window\"");
    if (app->log)
        g_timeout_add(50, watch, app);
    if (path)
        studio_open(app, path);
    if (app->pen_path)
        studio_pen_play(app, app->pen_path);
}

/* Its arguments come from the verb, which has looked at them: --mesh, --log, --pen, --size, each
 * with its value, and a file */
static bool read_arguments(studio_app *app, int argc, char **argv) {
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--mesh") == 0 && i + 1 < argc) {
            app->mesh_path = argv[++i];
        } else if (strcmp(argv[i], "--pen") == 0 && i + 1 < argc) {
            app->pen_path = argv[++i];
        } else if (strcmp(argv[i], "--size") == 0 && i + 1 < argc) {
            if (sscanf(argv[++i], "%dx%d", &app->size[0], &app->size[1]) != 2)
                return false;
        } else if (strcmp(argv[i], "--log") == 0 && i + 1 < argc) {
            app->log = fopen(argv[++i], "w");
            if (!app->log) {
                perror(argv[i]);
                return false;
            }
        } else {
            app->pending = argv[i];
        }
    }
    return true;
}

int main(int argc, char **argv) {
    static studio_app app;
    cli_begin();
    if (!studio_document_init(&app.document))
        return EXIT_FAILED;
    app.look = studio_look_default();
    app.paint = studio_paint_default();
    studio_swatches_default(app.swatches);
    app.turns = 36;
    app.camera = (studio_camera){.azimuth = 30, .elevation = 20, .fov = 35, .distance = 1};
    if (!read_arguments(&app, argc, argv))
        return EXIT_FAILED;
    /* what is written to files has points in its numbers */
    gtk_disable_setlocale();
    setlocale(LC_CTYPE, "");
    find_bus();
    if (!gtk_init_check()) {
        cli_error("studio: there is no display to open a window on; without one, selvage render "
                  "draws, and selvage paint and selvage session paint");
        return EXIT_FAILED;
    }
    app.application = gtk_application_new(NULL, G_APPLICATION_NON_UNIQUE);
    g_signal_connect(app.application, "activate", G_CALLBACK(activate), &app);
    int code = g_application_run(G_APPLICATION(app.application), 0, NULL);
    app.closing = true;
    g_object_unref(app.application);
    studio_document_close(&app.document);
    studio_document_end(&app.document);
    studio_brushes_free(&app.brushes);
    g_queue_clear_full(&app.asked, g_free);
    g_free(app.paint.stencil.path);
    g_free(app.report_path);
    g_free(app.light_path);
    g_free(app.light_kept);
    studio_turntable_stop(&app);
    for (int i = 0; i < STUDIO_RECENT; i++)
        g_free(app.recent[i]);
    if (app.log)
        fclose(app.log);
    cli_end();
    return code ? EXIT_FAILED : EXIT_OK;
}
