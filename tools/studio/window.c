/* The window: what lies where, opening files, words to the user. */
#include "studio/commands/commands.h"

#include <locale.h>
#include <stdarg.h>
#include <string.h>

/* ---- words ---- */

void studio_log(studio_app *app, const char *format, ...) {
    va_list args;
    if (!app->log)
        return;
    va_start(args, format);
    fprintf(app->log, "{\"t\":%.4f,", (double)g_get_monotonic_time() * 1e-6);
    vfprintf(app->log, format, args);
    fputs("}\n", app->log);
    fflush(app->log);
    va_end(args);
}

void studio_log_place(studio_app *app, const char *name, GtkWidget *widget) {
    double x = 0, y = 0, nx, ny;
    gtk_widget_translate_coordinates(widget, GTK_WIDGET(app->window), 0, 0, &x, &y);
    gtk_native_get_surface_transform(GTK_NATIVE(app->window), &nx, &ny);
    studio_log(app, "\"event\":\"%s\",\"x\":%.0f,\"y\":%.0f,\"width\":%d,\"height\":%d", name,
               x + nx, y + ny, gtk_widget_get_width(widget), gtk_widget_get_height(widget));
}

void studio_say(studio_app *app, const char *text, const char *button, const char *action) {
    app->bar_action = action;
    gtk_label_set_text(GTK_LABEL(app->bar_text), text ? text : "");
    gtk_button_set_label(GTK_BUTTON(app->bar_button), button ? button : "");
    gtk_widget_set_visible(app->bar_button, button != NULL);
    gtk_widget_set_visible(app->bar, text != NULL);
    if (text)
        studio_log(app, "\"event\":\"said\"");
}

bool studio_failed(studio_app *app, slv_result result) {
    if (!result)
        return false;
    studio_say(app, *app->document.message ? app->document.message : slv_result_string(result),
               NULL, NULL);
    studio_log(app, "\"event\":\"failed\",\"result\":%d", (int)result);
    return true;
}

void studio_page(studio_app *app, const char *page, const char *text) {
    if (page)
        gtk_stack_set_visible_child_name(app->stack, page);
    if (text)
        gtk_label_set_text(GTK_LABEL(app->page_text), text);
}

static void bar_pressed(GtkButton *button, gpointer user) {
    studio_app *app = user;
    const char *action = app->bar_action;
    (void)button;
    studio_say(app, NULL, NULL, NULL);
    if (action)
        studio_actions_run(app, action, NULL);
}

static void bar_closed(GtkButton *button, gpointer user) {
    (void)button;
    studio_say(user, NULL, NULL, NULL);
}

static GtkWidget *make_bar(studio_app *app) {
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 8);
    GtkWidget *close = gtk_button_new_from_icon_name("window-close-symbolic");
    app->bar = box;
    app->bar_text = gtk_label_new("");
    app->bar_button = gtk_button_new_with_label("");
    gtk_label_set_wrap(GTK_LABEL(app->bar_text), TRUE);
    gtk_label_set_xalign(GTK_LABEL(app->bar_text), 0);
    gtk_label_set_selectable(GTK_LABEL(app->bar_text), FALSE);
    gtk_widget_set_hexpand(app->bar_text, TRUE);
    gtk_widget_set_margin_start(app->bar_text, 8);
    gtk_widget_set_tooltip_text(close, "Close the message");
    gtk_widget_add_css_class(box, "background");
    gtk_widget_set_valign(box, GTK_ALIGN_START);
    gtk_box_append(GTK_BOX(box), app->bar_text);
    gtk_box_append(GTK_BOX(box), app->bar_button);
    gtk_box_append(GTK_BOX(box), close);
    gtk_widget_set_visible(box, FALSE);
    g_signal_connect(app->bar_button, "clicked", G_CALLBACK(bar_pressed), app);
    g_signal_connect(close, "clicked", G_CALLBACK(bar_closed), app);
    return box;
}

/* ---- opening ---- */

typedef struct studio_opening {
    studio_document document;
    char *path, *mesh;
    slv_result result;
    bool failed; /* there was no memory to begin with */
} opening;

static void load(GTask *task, gpointer source, gpointer data, GCancellable *cancellable) {
    opening *o = data;
    (void)source;
    (void)cancellable;
    o->result = o->failed ? SLV_ERROR_MEMORY : studio_document_open(&o->document, o->path, o->mesh);
    g_task_return_boolean(task, TRUE);
}

static void unfinished_answered(studio_app *app, int answer) {
    if (answer == 0) {
        studio_area_forget(app);
        studio_failed(app, studio_document_recover(&app->document));
        studio_log(app, "\"event\":\"recovered\"");
    } else if (answer == 1) {
        studio_failed(app, studio_document_discard(&app->document));
    } else {
        studio_document_close(&app->document);
        studio_page(app, "start", NULL);
    }
    studio_area_redraw(app, false);
    studio_sync(app);
}

/* What was done before and not saved. */
static void offer(studio_app *app) {
    static const char *const answers[] = {"_Bring It Back", "_Throw It Away", "_Do Not Open"};
    slv_session_info info;
    char *path = studio_document_unfinished(&app->document), text[160];
    if (path)
        studio_ask(app, "There is unfinished work on this file.",
                   "The program ended before it was saved.", answers, unfinished_answered);
    g_free(path);
    if (app->document.scene.ndamaged) {
        snprintf(text, sizeof text,
                 "%u of %u faces could not be read, and are filled as far as the file allows.",
                 app->document.scene.ndamaged,
                 slv_mesh_face_count(studio_document_mesh(&app->document)));
        studio_say(app, text, "Show Them", "damaged-show");
    }
    if (app->document.kind != STUDIO_SESSION)
        return;
    slv_session_get_info(app->document.session, &info);
    if (!info.recovered)
        return;
    snprintf(text, sizeof text,
             "%llu things that had not been saved were brought back from the journal.",
             (unsigned long long)info.recovered);
    studio_say(app, text, NULL, NULL);
    studio_log(app, "\"event\":\"recovered\"");
}

/* Which step it is at, how much of that is done if anybody knows, and for how long it has gone on.
 */
static gboolean tell_opening(gpointer user) {
    static const char *const steps[STUDIO_STEPS] = {"reading the file", "finding how faces meet",
                                                    "making the surface", "reading texels"};
    studio_app *app = user;
    char text[96];
    if (app->closing || !app->opening)
        return G_SOURCE_REMOVE;
    const studio_work *work = app->opening->document.work;
    const int step = work ? atomic_load(&work->step) : 0;
    const double part = work ? 1e-3 * atomic_load(&work->part) : 0;
    snprintf(text, sizeof text, "%d of %d: %s, for %.0f s", step + 1, STUDIO_STEPS, steps[step],
             (double)(g_get_monotonic_time() - app->moved) * 1e-6);
    gtk_progress_bar_set_fraction(GTK_PROGRESS_BAR(app->opening_bar), (step + part) / STUDIO_STEPS);
    gtk_progress_bar_set_text(GTK_PROGRESS_BAR(app->opening_bar), text);
    studio_log(app, "\"event\":\"opening\",\"step\":%d,\"part\":%.3f", step + 1, part);
    return G_SOURCE_CONTINUE;
}

static void loaded(GObject *source, GAsyncResult *task, gpointer user) {
    studio_app *app = user;
    opening *o = g_task_get_task_data(G_TASK(task));
    const bool wanted = !app->closing && app->opening == o;
    (void)source;
    if (wanted) {
        tell_opening(app);
        app->loading = false;
        app->opening = NULL;
    }
    if (wanted && !o->result) {
        studio_turntable_stop(app);
        studio_leave(app);
        studio_document_end(&app->document);
        o->document.serial += app->document.serial;
        app->document = o->document;
        app->framed = false;
        app->look.channel = 0;
        studio_seam_forget(app);
        app->look.encoding =
            studio_document_is_data(&app->document) ? STUDIO_LINEAR : app->encoding;
        studio_settings_opened(app, app->document.path);
        studio_page(app, "picture", NULL);
        studio_say(app, NULL, NULL, NULL);
        studio_light_recall(app);
        studio_log(app, "\"event\":\"opened\"");
        offer(app);
        studio_area_redraw(app, true); /* a coarse picture is there sooner */
    } else if (wanted) {
        snprintf(app->document.message, STUDIO_MESSAGE, "%s",
                 o->document.message ? o->document.message : "");
        app->thrown_away = false;
        studio_page(app, app->document.texture ? "picture" : "start", NULL);
        studio_failed(app, o->result);
    }
    if (!wanted || o->result) {
        studio_document_close(&o->document);
        studio_document_end(&o->document);
    }
    g_free(o->path);
    if (wanted)
        studio_sync(app);
    g_object_unref(app->application);
}

void studio_open_cancel(studio_app *app) {
    if (!app->opening)
        return;
    studio_document_cancel(&app->opening->document);
    app->opening = NULL; /* whoever opens it cleans up when that has ended */
    app->loading = false;
    app->thrown_away = false;
    studio_page(app, app->document.texture ? "picture" : "start", NULL);
    studio_log(app, "\"event\":\"cancelled\"");
    studio_area_redraw(app, false);
    studio_sync(app);
}

void studio_open(studio_app *app, const char *path) {
    opening *o = g_new0(opening, 1);
    GTask *task = g_task_new(NULL, NULL, loaded, app);
    o->path = g_strdup(path);
    o->mesh = app->mesh_path;
    app->mesh_path = NULL;
    o->failed = !studio_document_init(&o->document);
    app->loading = true;
    app->drag = STUDIO_DRAG_NONE; /* the picture goes, and with it what would end a drag */
    app->opening = o;
    app->moved = g_get_monotonic_time();
    char *base = g_path_get_basename(path), *text = g_strdup_printf("Opening %s…", base);
    gtk_label_set_text(GTK_LABEL(app->opening_text), text);
    g_free(text);
    g_free(base);
    tell_opening(app);
    g_timeout_add(100, tell_opening, app);
    studio_page(app, "loading", NULL);
    studio_sync(app);
    g_object_ref(app->application); /* stays until it is loaded */
    g_task_set_task_data(task, o, g_free);
    g_task_run_in_thread(task, load);
    g_object_unref(task);
}

static gboolean dropped(GtkDropTarget *target, const GValue *value, double x, double y,
                        gpointer user) {
    GdkFileList *list = g_value_get_boxed(value);
    GSList *files = gdk_file_list_get_files(list);
    char *path = files ? g_file_get_path(files->data) : NULL;
    (void)target;
    (void)x;
    (void)y;
    if (files && files->next)
        studio_say(user, "Files are opened one at a time: drop one of them.", NULL, NULL);
    else if (path)
        studio_actions_run(user, "open-path", path);
    g_free(path);
    g_slist_free(files);
    return path != NULL;
}

/* ---- showing what the model has ---- */

static void show_title(studio_app *app) {
    const studio_document *d = &app->document;
    const char *path = d->target ? d->target : d->path;
    char *base = path ? g_path_get_basename(path) : NULL;
    char *title = base ? g_strdup_printf("%s%s - Selvage Studio",
                                         studio_document_is_unsaved(d) ? "• " : "", base)
                       : g_strdup("Selvage Studio");
    gtk_window_set_title(app->window, title);
    g_free(title);
    g_free(base);
}

void studio_sync(studio_app *app) {
    if (app->closing || app->syncing)
        return;
    app->syncing = true;
    g_object_set(gtk_settings_get_default(), "gtk-application-prefer-dark-theme", app->dark, NULL);
    show_title(app);
    studio_actions_sync(app);
    studio_panel_brush_sync(app);
    studio_panel_swatches_sync(app);
    studio_panel_layers_sync(app);
    studio_panel_history_sync(app);
    studio_panel_inspector_sync(app);
    app->syncing = false;
}

/* ---- making ---- */

static GtkWidget *make_start(studio_app *app) {
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_VERTICAL, 16), *button;
    GtkWidget *text = gtk_label_new("Open a .ptx, a mesh or a painting session, or drop one here.");
    (void)app;
    gtk_widget_set_halign(box, GTK_ALIGN_CENTER);
    gtk_widget_set_valign(box, GTK_ALIGN_CENTER);
    button = gtk_button_new_with_label("Open…");
    gtk_actionable_set_action_name(GTK_ACTIONABLE(button), "win.open");
    gtk_widget_set_halign(button, GTK_ALIGN_CENTER);
    gtk_box_append(GTK_BOX(box), text);
    gtk_box_append(GTK_BOX(box), button);
    return box;
}

static void cancel_pressed(GtkButton *button, gpointer user) {
    (void)button;
    studio_open_cancel(user);
}

static GtkWidget *make_loading(studio_app *app) {
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_VERTICAL, 16),
              *cancel = gtk_button_new_with_label("Cancel");
    app->opening_text = gtk_label_new("");
    app->opening_bar = gtk_progress_bar_new();
    gtk_progress_bar_set_show_text(GTK_PROGRESS_BAR(app->opening_bar), TRUE);
    gtk_label_set_ellipsize(GTK_LABEL(app->opening_text), PANGO_ELLIPSIZE_MIDDLE);
    gtk_widget_set_halign(box, GTK_ALIGN_CENTER);
    gtk_widget_set_valign(box, GTK_ALIGN_CENTER);
    gtk_widget_set_halign(cancel, GTK_ALIGN_CENTER);
    g_signal_connect(cancel, "clicked", G_CALLBACK(cancel_pressed), app);
    gtk_box_append(GTK_BOX(box), app->opening_text);
    gtk_box_append(GTK_BOX(box), app->opening_bar);
    gtk_box_append(GTK_BOX(box), cancel);
    return box;
}

/* The tools, which a new user looks for first. */
static GtkWidget *make_tools(void) {
    static const char *const words[STUDIO_TOOLS] = {
        "View", "Paint", "Erase", "Fill", "Gradient", "Pick", "Select", "Stencil", "Texels"};
    static const char *const tips[STUDIO_TOOLS] = {
        "Turn the view: drag; Shift pans, the wheel zooms (V)",
        "Paint with the brush (B)",
        "Take paint away (E)",
        "Fill a face (G)",
        "Fill with a gradient: drag from where it begins to where it ends (Shift+G)",
        "Take up a colour from the surface (I)",
        "Choose the faces that take paint (S)",
        "Place the image that is painted through: drag moves it, Shift turns, the wheel sizes (Y)",
        "Give faces twice as many texels each way, with Shift half as many (R)"};
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 0);
    gtk_widget_add_css_class(box, "linked");
    for (int i = 0; i < STUDIO_TOOLS; i++) {
        GtkWidget *button = gtk_toggle_button_new_with_label(words[i]);
        gtk_actionable_set_action_name(GTK_ACTIONABLE(button), "win.tool");
        gtk_actionable_set_action_target(GTK_ACTIONABLE(button), "s", studio_tool_names[i]);
        gtk_widget_set_tooltip_text(button, tips[i]);
        gtk_widget_set_focusable(button, FALSE);
        gtk_box_append(GTK_BOX(box), button);
    }
    return box;
}

static GtkWidget *make_save(void) {
    GtkWidget *button = gtk_button_new_with_label("Save");
    gtk_actionable_set_action_name(GTK_ACTIONABLE(button), "win.save");
    gtk_widget_set_tooltip_text(button, "Save what was painted (Ctrl+S)");
    gtk_widget_set_focusable(button, FALSE);
    return button;
}

static GtkWidget *make_panels(studio_app *app) {
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_VERTICAL, 6),
              *scrolled = gtk_scrolled_window_new();
    gtk_box_append(GTK_BOX(box), studio_panel_brush(app));
    gtk_box_append(GTK_BOX(box), studio_panel_swatches(app));
    gtk_box_append(GTK_BOX(box), studio_panel_layers(app));
    gtk_box_append(GTK_BOX(box), studio_panel_history(app));
    gtk_box_append(GTK_BOX(box), studio_panel_inspector(app));
    gtk_widget_set_margin_start(box, 8);
    gtk_widget_set_margin_end(box, 8);
    gtk_widget_set_margin_top(box, 8);
    gtk_scrolled_window_set_child(GTK_SCROLLED_WINDOW(scrolled), box);
    gtk_scrolled_window_set_policy(GTK_SCROLLED_WINDOW(scrolled), GTK_POLICY_NEVER,
                                   GTK_POLICY_AUTOMATIC);
    gtk_widget_set_size_request(scrolled, 280, -1);
    gtk_widget_set_hexpand(scrolled, FALSE);
    return scrolled;
}

static gboolean close_asked(GtkWindow *window, gpointer user) {
    studio_app *app = user;
    (void)window;
    studio_actions_run(app, "quit", NULL);
    return TRUE;
}

static void make_pages(studio_app *app) {
    GtkWidget *message = gtk_label_new("");
    app->stack = GTK_STACK(gtk_stack_new());
    app->page_text = message;
    gtk_label_set_wrap(GTK_LABEL(message), TRUE);
    gtk_label_set_selectable(GTK_LABEL(message), TRUE);
    gtk_widget_set_margin_start(message, 40);
    gtk_widget_set_margin_end(message, 40);
    gtk_stack_add_named(app->stack, make_start(app), "start");
    gtk_stack_add_named(app->stack, make_loading(app), "loading");
    gtk_stack_add_named(app->stack, studio_area_create(app), "picture");
    gtk_stack_add_named(app->stack, message, "message");
}

void studio_window_create(studio_app *app) {
    GtkWidget *header = gtk_header_bar_new(), *all = gtk_box_new(GTK_ORIENTATION_VERTICAL, 0),
              *middle = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 0), *left = gtk_overlay_new();
    GtkDropTarget *drop = gtk_drop_target_new(GDK_TYPE_FILE_LIST, GDK_ACTION_COPY);
    app->window = GTK_WINDOW(gtk_application_window_new(app->application));
    make_pages(app);
    if (app->size[0])
        gtk_widget_set_size_request(GTK_WIDGET(app->area), app->size[0], app->size[1]);
    else
        gtk_window_set_default_size(app->window, 1280, 760);
    studio_actions_add(app);
    GMenuModel *menu = studio_actions_menu(app);
    GtkWidget *bar = gtk_popover_menu_bar_new_from_model(menu);
    gtk_header_bar_pack_start(GTK_HEADER_BAR(header), make_tools());
    gtk_header_bar_pack_end(GTK_HEADER_BAR(header), make_save());
    gtk_window_set_titlebar(app->window, header);
    /* over the picture, which keeps its size when something is said */
    gtk_overlay_set_child(GTK_OVERLAY(left), GTK_WIDGET(app->stack));
    gtk_overlay_add_overlay(GTK_OVERLAY(left), make_bar(app));
    gtk_box_append(GTK_BOX(middle), left);
    gtk_box_append(GTK_BOX(middle), make_panels(app));
    app->status = gtk_label_new("");
    gtk_label_set_xalign(GTK_LABEL(app->status), 0);
    gtk_label_set_ellipsize(GTK_LABEL(app->status), PANGO_ELLIPSIZE_END);
    gtk_widget_set_margin_start(app->status, 8);
    gtk_box_append(GTK_BOX(all), bar);
    gtk_box_append(GTK_BOX(all), middle);
    gtk_box_append(GTK_BOX(all), app->status);
    gtk_window_set_child(app->window, all);
    gtk_widget_add_controller(GTK_WIDGET(app->window), GTK_EVENT_CONTROLLER(drop));
    g_signal_connect(drop, "drop", G_CALLBACK(dropped), app);
    g_signal_connect(app->window, "close-request", G_CALLBACK(close_asked), app);
    g_object_unref(menu);
}
