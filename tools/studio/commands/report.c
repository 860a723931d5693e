/* The report: the command compares all strategies on what is open, beside the window. */
#include "studio/commands/commands.h"

#include <selvage/ptx.h>

#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Beside this program in a build, else where the command is installed. */
static char *find_command(void) {
    static const char *const places[] = {"selvage", "../../bin/selvage"};
    char own[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", own, sizeof own - 1);
    for (size_t i = 0; length > 0 && i < G_N_ELEMENTS(places); i++) {
        own[length] = 0;
        char *folder = g_path_get_dirname(own), *path = g_build_filename(folder, places[i], NULL);
        g_free(folder);
        if (access(path, X_OK) == 0)
            return path;
        g_free(path);
    }
    return NULL;
}

/* What is open, its mesh inside. */
static slv_result write_texture(studio_app *app, const char *path) {
    studio_document *d = &app->document;
    const slv_ptx_write_params params = {.mesh = studio_document_mesh(d)};
    if (d->session)
        return slv_session_export(d->session, path);
    return slv_ptx_save(&d->env, path, d->texture, studio_document_adjacency(d), &params);
}

static void ended(GObject *source, GAsyncResult *answer, gpointer user) {
    studio_app *app = user;
    GSubprocess *process = G_SUBPROCESS(source);
    char *words = NULL;
    bool fine = g_subprocess_communicate_utf8_finish(process, answer, NULL, &words, NULL) &&
                g_subprocess_get_successful(process);
    bool cancelled = app->report != process;
    if (!app->closing && !cancelled) {
        studio_log(app, "\"event\":\"%s\"", fine ? "report" : "report-failed");
        studio_say(app,
                   fine              ? app->report_path
                   : words && *words ? words
                                     : "The report has failed.",
                   fine ? "Show It" : NULL, fine ? "report-show" : NULL);
    }
    if (!cancelled)
        app->report = NULL;
    g_free(words);
    g_object_unref(process);
}

/* The orbit goes around as far away as the view is framed, from where it looks now. */
static void put_orbit(const studio_app *app, GPtrArray *arguments) {
    const studio_camera *c = &app->camera;
    const struct {
        const char *option;
        double value;
    } numbers[] = {{"--azimuth", (double)c->azimuth},
                   {"--elevation", (double)c->elevation},
                   {"--fov", c->orthographic ? 0 : (double)c->fov},
                   {"--orbit", 360},
                   {"--tilt", 0},
                   {"--dolly", 1}};
    for (size_t i = 0; i < G_N_ELEMENTS(numbers); i++) {
        g_ptr_array_add(arguments, g_strdup(numbers[i].option));
        g_ptr_array_add(arguments, g_strdup_printf("%.9g", numbers[i].value));
    }
}

static void run(studio_app *app, const char *command, const char *folder, bool orbit) {
    char *texture = g_build_filename(folder, "texture.ptx", NULL),
         *view = g_build_filename(folder, "view.json", NULL);
    g_free(app->report_path);
    app->report_path = g_build_filename(folder, "report.html", NULL);
    if (!studio_failed(app, write_texture(app, texture)) &&
        !studio_failed(app, orbit ? SLV_OK : studio_view_save(app, view))) {
        const char *const given[] = {command, "compare", texture, "--quick", "--out", folder};
        GPtrArray *arguments = g_ptr_array_new_with_free_func(g_free);
        for (size_t i = 0; i < G_N_ELEMENTS(given); i++)
            g_ptr_array_add(arguments, g_strdup(given[i]));
        if (orbit) {
            put_orbit(app, arguments);
        } else {
            g_ptr_array_add(arguments, g_strdup("--view"));
            g_ptr_array_add(arguments, g_strdup(view));
        }
        g_ptr_array_add(arguments, NULL);
        app->report = g_subprocess_newv(
            (const char *const *)arguments->pdata,
            G_SUBPROCESS_FLAGS_STDOUT_SILENCE | G_SUBPROCESS_FLAGS_STDERR_PIPE, NULL);
        g_ptr_array_unref(arguments);
    }
    if (app->report) {
        g_subprocess_communicate_utf8_async(app->report, NULL, NULL, ended, app);
        studio_say(app, "The strategies are being compared.", "Cancel", "report-cancel");
    }
    g_free(texture);
    g_free(view);
}

static void report(studio_app *app, bool orbit) {
    char *folder = g_dir_make_tmp("selvage-report-XXXXXX", NULL), *command = find_command();
    if (app->report || !folder || !command)
        studio_say(app,
                   app->report ? "A report is being made."
                               : "The command selvage is not to be found.",
                   NULL, NULL);
    else
        run(app, command, folder, orbit);
    g_free(folder);
    g_free(command);
}

void studio_do_report(studio_app *app, const char *target) {
    (void)target;
    report(app, false);
}

void studio_do_report_orbit(studio_app *app, const char *target) {
    (void)target;
    report(app, true);
}

void studio_do_report_cancel(studio_app *app, const char *target) {
    (void)target;
    if (app->report)
        g_subprocess_send_signal(app->report, SIGTERM);
    app->report = NULL;
}

void studio_do_report_show(studio_app *app, const char *target) {
    char *uri = app->report_path ? g_filename_to_uri(app->report_path, NULL, NULL) : NULL;
    (void)target;
    if (uri)
        gtk_show_uri(app->window, uri, GDK_CURRENT_TIME);
    g_free(uri);
}
