/* Questions, and files to choose. */
#include "studio/studio.h"

typedef struct question {
    studio_app *app;
    studio_answer_fn answer;
    studio_path_fn path;
    studio_number_fn number;
    GtkWidget *field; /* of a number */
    int last;
} question;

static void answered(GtkDialog *dialog, int response, gpointer user) {
    question *q = user;
    int answer = response >= 0 ? response : q->last;
    gtk_window_destroy(GTK_WINDOW(dialog));
    q->app->asking = false;
    studio_log(q->app, "\"event\":\"answer\",\"answer\":%d", answer);
    q->answer(q->app, answer);
    g_free(q);
}

void studio_ask(studio_app *app, const char *text, const char *more, const char *const answers[3],
                studio_answer_fn done) {
    question *q = g_new0(question, 1);
    GtkWidget *dialog =
        gtk_message_dialog_new(app->window, GTK_DIALOG_MODAL | GTK_DIALOG_DESTROY_WITH_PARENT,
                               GTK_MESSAGE_QUESTION, GTK_BUTTONS_NONE, "%s", text);
    gtk_message_dialog_format_secondary_text(GTK_MESSAGE_DIALOG(dialog), "%s", more);
    *q = (question){.app = app, .answer = done};
    for (int i = 0; i < 3 && answers[i]; i++) {
        gtk_dialog_add_button(GTK_DIALOG(dialog), answers[i], i);
        q->last = i;
    }
    gtk_dialog_set_default_response(GTK_DIALOG(dialog), 0);
    app->asking = true;
    g_signal_connect(dialog, "response", G_CALLBACK(answered), q);
    gtk_window_present(GTK_WINDOW(dialog));
    studio_log(app, "\"event\":\"question\"");
}

static void numbered(GtkDialog *dialog, int response, gpointer user) {
    question *q = user;
    GtkSpinButton *spin = GTK_SPIN_BUTTON(q->field);
    gtk_spin_button_update(spin);
    uint32_t number = (uint32_t)gtk_spin_button_get_value_as_int(spin);
    gtk_window_destroy(GTK_WINDOW(dialog));
    q->app->asking = false;
    studio_log(q->app, "\"event\":\"answer\",\"answer\":%d", response == 0 ? (int)number : 0);
    if (response == 0)
        q->number(q->app, number);
    g_free(q);
}

void studio_ask_number(studio_app *app, const char *text, uint32_t value, uint32_t most,
                       studio_number_fn done) {
    question *q = g_new0(question, 1);
    GtkWidget *dialog =
        gtk_message_dialog_new(app->window, GTK_DIALOG_MODAL | GTK_DIALOG_DESTROY_WITH_PARENT,
                               GTK_MESSAGE_QUESTION, GTK_BUTTONS_NONE, "%s", text);
    GtkWidget *field = gtk_spin_button_new_with_range(1, most, 1);
    *q = (question){.app = app, .number = done, .field = field};
    gtk_spin_button_set_value(GTK_SPIN_BUTTON(field), value);
    gtk_accessible_update_property(GTK_ACCESSIBLE(field), GTK_ACCESSIBLE_PROPERTY_LABEL, text, -1);
    gtk_text_set_activates_default(GTK_TEXT(gtk_editable_get_delegate(GTK_EDITABLE(field))), TRUE);
    gtk_box_append(GTK_BOX(gtk_message_dialog_get_message_area(GTK_MESSAGE_DIALOG(dialog))), field);
    gtk_dialog_add_button(GTK_DIALOG(dialog), "_OK", 0);
    gtk_dialog_add_button(GTK_DIALOG(dialog), "_Cancel", 1);
    gtk_dialog_set_default_response(GTK_DIALOG(dialog), 0);
    app->asking = true;
    g_signal_connect(dialog, "response", G_CALLBACK(numbered), q);
    gtk_window_present(GTK_WINDOW(dialog));
    gtk_widget_grab_focus(field);
    studio_log(app, "\"event\":\"question\"");
}

static void chosen(GtkNativeDialog *dialog, int response, gpointer user) {
    question *q = user;
    q->app->asking = false;
    if (response == GTK_RESPONSE_ACCEPT) {
        GFile *file = gtk_file_chooser_get_file(GTK_FILE_CHOOSER(dialog));
        char *path = file ? g_file_get_path(file) : NULL;
        if (path)
            q->path(q->app, path);
        g_free(path);
        g_clear_object(&file);
    }
    g_object_unref(dialog);
    g_free(q);
}

/* Where the last file was, or else where the program was started: a list of recent files, which
 * choosers begin with, is empty at first. */
static void begin_in_folder(studio_app *app, GtkFileChooser *chooser, const char *name) {
    const char *last = name ? name : app->document.path ? app->document.path : app->recent[0];
    char *folder = last ? g_path_get_dirname(last) : g_get_current_dir();
    GFile *file = g_file_new_for_path(folder);
    gtk_file_chooser_set_current_folder(chooser, file, NULL);
    g_object_unref(file);
    g_free(folder);
}

void studio_choose_file(studio_app *app, const char *title, GtkFileChooserAction action,
                        const char *name, studio_path_fn done) {
    question *q = g_new0(question, 1);
    GtkFileChooserNative *dialog =
        gtk_file_chooser_native_new(title, app->window, action, NULL, NULL);
    *q = (question){.app = app, .path = done};
    begin_in_folder(app, GTK_FILE_CHOOSER(dialog), name);
    if (name && action == GTK_FILE_CHOOSER_ACTION_SAVE) {
        char *base = g_path_get_basename(name);
        gtk_file_chooser_set_current_name(GTK_FILE_CHOOSER(dialog), base);
        g_free(base);
    }
    app->asking = true;
    g_signal_connect(dialog, "response", G_CALLBACK(chosen), q);
    gtk_native_dialog_set_modal(GTK_NATIVE_DIALOG(dialog), TRUE);
    gtk_native_dialog_show(GTK_NATIVE_DIALOG(dialog));
    studio_log(app, "\"event\":\"chooser\"");
}
