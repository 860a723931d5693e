/* Actions of files: opening, saving, pictures, the end. */
#include "studio/commands/commands.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>

/* ---- the end, and what is not saved ---- */

static gboolean destroy(gpointer user) {
    studio_app *app = user;
    gtk_window_destroy(app->window);
    return G_SOURCE_REMOVE;
}

/* The window goes when the question that this may be the answer of has gone. */
static void finish(studio_app *app) {
    app->closing = true;
    if (app->report)
        g_subprocess_send_signal(app->report, SIGTERM);
    studio_settings_save(app);
    studio_leave(app);
    g_idle_add(destroy, app);
}

void studio_leave(studio_app *app) {
    if (app->thrown_away || !studio_document_is_unsaved(&app->document))
        studio_do_discard(app, "");
    app->thrown_away = false;
    studio_area_forget(app);
    studio_document_close(&app->document);
}

/* Forgets the session of what is open, and its folder. */
void studio_do_discard(studio_app *app, const char *target) {
    char *path = NULL;
    (void)target;
    if (!app->document.session || !app->document.working)
        return;
    path = g_strdup(slv_session_path(app->document.session));
    studio_area_forget(app);
    slv_env env = app->document.env;
    studio_document_close(&app->document);
    studio_failed(app, slv_session_remove(&env, path));
    g_free(path);
}

static void (*then)(studio_app *app); /* after the answer: one question at a time */
static bool saves_first;              /* that is, after it was said where to */

static void saved_before(studio_app *app, int answer) {
    if (answer == 0) {
        studio_do_save(app, "");
        saves_first = !app->document.target;
        if (studio_document_is_unsaved(&app->document))
            return; /* where to is asked, or it failed */
    } else if (answer == 1) {
        app->thrown_away = true; /* as soon as there is something else */
    } else {
        g_free((char *)(uintptr_t)app->pending);
        app->pending = NULL;
        return;
    }
    then(app);
}

/* Does something that ends what is open, and asks before if there is unsaved work. */
static void end_then(studio_app *app, void (*what)(studio_app *app)) {
    static const char *const answers[] = {"_Save", "Do _Not Save", "_Cancel"};
    then = what;
    if (studio_document_is_unsaved(&app->document))
        studio_ask(app, "There is work that has not been saved.",
                   app->document.working
                       ? "Without saving it is thrown away."
                       : "It stays in the session's journal, and is there when it is opened again.",
                   answers, saved_before);
    else
        what(app);
}

void studio_do_quit(studio_app *app, const char *target) {
    (void)target;
    studio_open_cancel(app);
    end_then(app, finish);
}

/* ---- opening ---- */

static void open_pending(studio_app *app) {
    char *path = (char *)(uintptr_t)app->pending;
    app->pending = NULL;
    if (path)
        studio_open(app, path);
    g_free(path);
}

void studio_do_open_path(studio_app *app, const char *target) {
    g_free((char *)(uintptr_t)app->pending);
    app->pending = g_strdup(target);
    end_then(app, open_pending);
}

static void opened(studio_app *app, const char *path) {
    studio_actions_run(app, "open-path", path);
}

void studio_do_open(studio_app *app, const char *target) {
    (void)target;
    studio_choose_file(app, "Open a .ptx or a mesh", GTK_FILE_CHOOSER_ACTION_OPEN, NULL, opened);
}

void studio_do_open_cancel(studio_app *app, const char *target) {
    (void)target;
    studio_open_cancel(app);
}

void studio_do_open_session(studio_app *app, const char *target) {
    (void)target;
    studio_choose_file(app, "Open a session", GTK_FILE_CHOOSER_ACTION_SELECT_FOLDER, NULL, opened);
}

/* ---- saving ---- */

static bool tell_saved(studio_app *app, slv_result result, const char *what) {
    if (studio_failed(app, result))
        return false;
    studio_log(app, "\"event\":\"%s\"", what);
    studio_say(app, NULL, NULL, NULL);
    return true;
}

/* Beside what was opened, under a name of its own. */
static char *suggestion(const studio_app *app, const char *ending) {
    const char *path = app->document.target ? app->document.target : app->document.path;
    const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
    int length = dot && dot > slash ? (int)(dot - path) : (int)strlen(path);
    return g_strdup_printf("%.*s%s", length, path, ending);
}

static void save_there(studio_app *app, const char *path) {
    studio_actions_run(app, "save-to", path);
}

void studio_do_save_to(studio_app *app, const char *target) {
    const bool goes_on = saves_first;
    saves_first = false;
    const bool saved = tell_saved(app, studio_document_save_as(&app->document, target), "saved");
    app->dirty = true;
    studio_area_redraw(app, true); /* that it is saved shows before a fine picture does */
    if (app->document.target)
        studio_settings_opened(app, app->document.target);
    if (saved && goes_on)
        then(app);
}

void studio_do_save_as(studio_app *app, const char *target) {
    char *name = suggestion(app, ".selvage");
    (void)target;
    saves_first = false;
    studio_choose_file(app, "Save the session, or a .ptx", GTK_FILE_CHOOSER_ACTION_SAVE, name,
                       save_there);
    g_free(name);
}

void studio_do_save(studio_app *app, const char *target) {
    if (!app->document.session)
        studio_say(app, "Nothing has been changed.", NULL, NULL);
    else if (!app->document.target)
        studio_do_save_as(app, target);
    else
        (void)tell_saved(app, studio_document_save(&app->document), "saved");
}

static void export_there(studio_app *app, const char *path) {
    studio_actions_run(app, "export-to", path);
}

void studio_do_export_to(studio_app *app, const char *target) {
    (void)tell_saved(app, studio_document_export(&app->document, target), "exported");
}

void studio_do_export(studio_app *app, const char *target) {
    char *name = suggestion(app, "-painted.ptx");
    (void)target;
    studio_choose_file(app, "Export the flattened layers", GTK_FILE_CHOOSER_ACTION_SAVE, name,
                       export_there);
    g_free(name);
}

/* ---- views and pictures ---- */

static void load_view(studio_app *app, const char *path) {
    if (studio_failed(app, studio_view_load(app, path)))
        return;
    studio_log(app, "\"event\":\"view-opened\"");
    studio_area_redraw(app, false);
}

void studio_do_open_view(studio_app *app, const char *target) {
    if (*target)
        load_view(app, target);
    else
        studio_choose_file(app, "Open a view", GTK_FILE_CHOOSER_ACTION_OPEN, NULL, load_view);
}

static void save_view(studio_app *app, const char *path) {
    if (!studio_failed(app, studio_view_save(app, path)))
        studio_log(app, "\"event\":\"view-saved\"");
}

void studio_do_save_view(studio_app *app, const char *target) {
    char *name = suggestion(app, "-view.json");
    if (*target)
        save_view(app, target);
    else
        studio_choose_file(app, "Save the view", GTK_FILE_CHOOSER_ACTION_SAVE, name, save_view);
    g_free(name);
}

static void shoot(studio_app *app, const char *path) {
    studio_actions_run(app, "screenshot-to", path);
}

void studio_do_screenshot_to(studio_app *app, const char *target) {
    studio_turntable_stop(app);
    app->screenshot = g_strdup(target);
    studio_area_redraw(app, false);
}

void studio_do_screenshot(studio_app *app, const char *target) {
    char *name = suggestion(app, ".png");
    (void)target;
    studio_choose_file(app, "Save a picture of the view", GTK_FILE_CHOOSER_ACTION_SAVE, name,
                       shoot);
    g_free(name);
}

static void turn(studio_app *app, const char *path) {
    studio_actions_run(app, "turntable-to", path);
}

void studio_do_turntable_to(studio_app *app, const char *target) {
    studio_failed(app, studio_turntable_begin(app, target));
}

void studio_do_turntable_count(studio_app *app, const char *target) {
    app->turns = (uint32_t)CLAMP(strtoul(target, NULL, 10), 1, STUDIO_TURNS);
}

static void turns_told(studio_app *app, uint32_t count) {
    char *name = suggestion(app, "-####.png"), text[16];
    snprintf(text, sizeof text, "%u", count);
    studio_actions_run(app, "turntable-count", text);
    studio_choose_file(app, "Save pictures from all around, numbered", GTK_FILE_CHOOSER_ACTION_SAVE,
                       name, turn);
    g_free(name);
}

void studio_do_turntable(studio_app *app, const char *target) {
    (void)target;
    studio_ask_number(app, "How many pictures from all around?", app->turns, STUDIO_TURNS,
                      turns_told);
}

void studio_do_turntable_cancel(studio_app *app, const char *target) {
    (void)target;
    studio_turntable_stop(app);
    studio_area_redraw(app, false);
}

/* ---- help ---- */

void studio_do_shortcuts(studio_app *app, const char *target) {
    (void)target;
    gtk_window_present(GTK_WINDOW(studio_actions_shortcuts(app)));
}

void studio_do_about(studio_app *app, const char *target) {
    uint32_t version = slv_version();
    char text[64];
    (void)target;
    snprintf(text, sizeof text, "%u.%u.%u", version >> 16, version >> 8 & 255, version & 255);
    gtk_show_about_dialog(app->window, "program-name", "Selvage Studio", "version", text,
                          "comments", "See, compare and paint per-face textures", "license-type",
                          GTK_LICENSE_APACHE_2_0, NULL);
}
