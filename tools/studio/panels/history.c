/* All that was done, the oldest first, and whether it is saved: choosing a row goes to there. */
#include "studio/studio.h"

#include <string.h>

enum { HEIGHT = 102, MOST = 400 }; /* rows; what is older can be reached by undoing */

static void chosen(GtkListBox *list, GtkListBoxRow *row, gpointer user) {
    studio_app *app = user;
    char target[16];
    (void)list;
    if (!row || app->syncing)
        return;
    snprintf(target, sizeof target, "%u",
             app->history_first + (unsigned)gtk_list_box_row_get_index(row));
    studio_actions_run(app, "history", target);
}

static const studio_button buttons[] = {{"edit-undo-symbolic", "win.undo", "Undo"},
                                        {"edit-redo-symbolic", "win.redo", "Redo"}};

GtkWidget *studio_panel_history(studio_app *app) {
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_VERTICAL, 4),
              *head = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 6),
              *scrolled = gtk_scrolled_window_new();
    app->history = gtk_list_box_new();
    g_signal_connect(app->history, "row-selected", G_CALLBACK(chosen), app);
    gtk_accessible_update_property(GTK_ACCESSIBLE(app->history), GTK_ACCESSIBLE_PROPERTY_LABEL,
                                   "History", -1);
    gtk_scrolled_window_set_child(GTK_SCROLLED_WINDOW(scrolled), app->history);
    gtk_scrolled_window_set_has_frame(GTK_SCROLLED_WINDOW(scrolled), TRUE);
    gtk_widget_set_size_request(scrolled, -1, HEIGHT);
    app->saved = gtk_label_new("");
    gtk_label_set_xalign(GTK_LABEL(app->saved), 0);
    gtk_label_set_wrap(GTK_LABEL(app->saved), TRUE);
    gtk_box_append(GTK_BOX(head), studio_actions_buttons(buttons, G_N_ELEMENTS(buttons)));
    gtk_box_append(GTK_BOX(head), app->saved);
    gtk_box_append(GTK_BOX(box), head);
    gtk_box_append(GTK_BOX(box), scrolled);
    return box;
}

/* The words of a row, for g_free: what there was at first, then entry by entry. */
static char *words_of(slv_document *layers, const slv_history_info *info, uint32_t row) {
    const char *name = row ? slv_document_history_name(layers, row - 1) : NULL;
    if (!row)
        return g_strdup(info->lost ? "older than can be undone" : "as it was opened");
    if (!*name)
        name = "change";
    return row > info->undos ? g_strdup_printf("%s (undone)", name) : g_strdup(name);
}

/* Rows stay what they are, so that the one with the keyboard's focus does. */
static void show_row(GtkListBox *list, int index, const char *words) {
    GtkListBoxRow *row = gtk_list_box_get_row_at_index(list, index);
    GtkWidget *label = row ? gtk_list_box_row_get_child(row) : gtk_label_new(NULL);
    if (!row) {
        gtk_label_set_xalign(GTK_LABEL(label), 0);
        gtk_list_box_append(list, label);
    }
    if (strcmp(gtk_label_get_text(GTK_LABEL(label)), words) != 0)
        gtk_label_set_text(GTK_LABEL(label), words);
}

static void show_rows(studio_app *app, slv_document *layers, const slv_history_info *info) {
    GtkListBox *list = GTK_LIST_BOX(app->history);
    uint32_t all = layers ? 1 + info->undos + info->redos : 0, rows = MIN(all, MOST);
    GtkListBoxRow *row;
    /* the last ones, unless what is done now is before them */
    app->history_first = MIN(all - rows, info->undos);
    for (uint32_t i = 0; i < rows; i++) {
        char *words = words_of(layers, info, app->history_first + i);
        show_row(list, (int)i, words);
        g_free(words);
    }
    while ((row = gtk_list_box_get_row_at_index(list, (int)rows)))
        gtk_list_box_remove(list, GTK_WIDGET(row));
    if (rows)
        gtk_list_box_select_row(
            list, gtk_list_box_get_row_at_index(list, (int)(info->undos - app->history_first)));
}

/* The row of what is done now is to be seen, when the list has its new size. */
static gboolean scroll(gpointer user) {
    studio_app *app = user;
    GtkListBoxRow *row =
        app->closing ? NULL : gtk_list_box_get_selected_row(GTK_LIST_BOX(app->history));
    double x, y;
    app->history_scroll = 0;
    if (row && gtk_widget_translate_coordinates(GTK_WIDGET(row), app->history, 0, 0, &x, &y)) {
        GtkAdjustment *adjustment = gtk_list_box_get_adjustment(GTK_LIST_BOX(app->history));
        gtk_adjustment_clamp_page(adjustment, y, y + gtk_widget_get_height(GTK_WIDGET(row)));
    }
    return G_SOURCE_REMOVE;
}

void studio_panel_history_sync(studio_app *app) {
    slv_document *layers = studio_document_layers(&app->document);
    slv_history_info info = {0};
    if (layers)
        slv_document_history(layers, &info);
    show_rows(app, layers, &info);
    if (!app->history_scroll)
        app->history_scroll = g_idle_add_full(G_PRIORITY_LOW, scroll, app, NULL);
    gtk_label_set_text(GTK_LABEL(app->saved), !app->document.texture ? ""
                                              : !layers              ? "Nothing has been changed"
                                              : studio_document_is_unsaved(&app->document)
                                                  ? "In the journal, not saved yet"
                                                  : "Saved");
}
