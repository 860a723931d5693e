/* The brush: which one, its size, opacity and hardness, its colour. */
#include "studio/studio.h"

#include <math.h>
#include <string.h>

enum { SIZE, OPACITY, HARDNESS, SLIDERS };

static const struct {
    const char *label;
    double low, high, step;
} sliders[SLIDERS] = {{"Size", 1, 200, 1}, {"Opacity", 0, 1, 0.01}, {"Hardness", 0.02, 1, 0.01}};

static void slid(GtkRange *range, gpointer user) {
    studio_app *app = user;
    if (app->syncing)
        return;
    app->paint.radius = (float)gtk_range_get_value(GTK_RANGE(app->sliders[SIZE]));
    app->paint.opacity = (float)gtk_range_get_value(GTK_RANGE(app->sliders[OPACITY]));
    app->paint.hardness = (float)gtk_range_get_value(GTK_RANGE(app->sliders[HARDNESS]));
    (void)range;
}

static void colored(GtkColorButton *button, GParamSpec *spec, gpointer user) {
    studio_app *app = user;
    GdkRGBA rgba;
    (void)spec;
    if (app->syncing)
        return;
    float *color =
        GTK_WIDGET(button) == app->color_buttons[0] ? app->paint.color : app->paint.other;
    gtk_color_chooser_get_rgba(GTK_COLOR_CHOOSER(button), &rgba);
    color[0] = rgba.red;
    color[1] = rgba.green;
    color[2] = rgba.blue;
}

static void chosen(GtkListBox *list, GtkListBoxRow *row, gpointer user) {
    studio_app *app = user;
    (void)list;
    if (row && !app->syncing)
        studio_actions_run(app, "brush", g_object_get_data(G_OBJECT(row), "brush"));
}

static gboolean matches(GtkListBoxRow *row, gpointer user) {
    const char *wanted = gtk_editable_get_text(GTK_EDITABLE(user));
    const char *name = g_object_get_data(G_OBJECT(row), "brush");
    char *a = g_utf8_casefold(name, -1), *b = g_utf8_casefold(wanted, -1);
    gboolean found = strstr(a, b) != NULL;
    g_free(a);
    g_free(b);
    return found;
}

static void searched(GtkSearchEntry *entry, gpointer user) {
    (void)entry;
    gtk_list_box_invalidate_filter(GTK_LIST_BOX(user));
}

/* The pictures that MyPaint has of its brushes lie beside them. */
static GtkWidget *preview(const studio_brush *brush) {
    GtkWidget *image = NULL;
    if (brush->path) {
        char *path = g_strdup_printf("%.*s_prev.png", (int)(strlen(brush->path) - 4), brush->path);
        if (g_file_test(path, G_FILE_TEST_EXISTS))
            image = gtk_image_new_from_file(path);
        g_free(path);
    }
    return image ? image : gtk_image_new_from_icon_name("media-record-symbolic");
}

static void fill_list(studio_app *app) {
    for (uint32_t i = 0; i < app->brushes.count; i++) {
        const studio_brush *brush = &app->brushes.list[i];
        GtkWidget *row = gtk_list_box_row_new(), *box = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 6);
        GtkWidget *label = gtk_label_new(brush->name);
        gtk_label_set_ellipsize(GTK_LABEL(label), PANGO_ELLIPSIZE_END);
        gtk_box_append(GTK_BOX(box), preview(brush));
        gtk_box_append(GTK_BOX(box), label);
        gtk_list_box_row_set_child(GTK_LIST_BOX_ROW(row), box);
        g_object_set_data(G_OBJECT(row), "brush", brush->name);
        gtk_accessible_update_property(GTK_ACCESSIBLE(row), GTK_ACCESSIBLE_PROPERTY_LABEL,
                                       brush->name, -1);
        gtk_list_box_append(GTK_LIST_BOX(app->brushes_list), row);
    }
}

/* Three hundred rows would be in the way of the first picture. */
static gboolean find_brushes(gpointer user) {
    studio_app *app = user;
    if (app->closing)
        return G_SOURCE_REMOVE;
    studio_brushes_find(&app->brushes);
    app->syncing = true;
    fill_list(app);
    app->syncing = false;
    return G_SOURCE_REMOVE;
}

/* The brush's, and the one that gradients end with. */
static GtkWidget *make_colors(studio_app *app) {
    static const char *const words[2] = {"Colour of the brush", "Colour that gradients end with"};
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 4);
    for (int i = 0; i < 2; i++) {
        GtkWidget *button = gtk_color_button_new();
        app->color_buttons[i] = button;
        gtk_widget_set_hexpand(button, i == 0);
        gtk_widget_set_tooltip_text(button, words[i]);
        gtk_color_button_set_title(GTK_COLOR_BUTTON(button), words[i]);
        gtk_accessible_update_property(GTK_ACCESSIBLE(button), GTK_ACCESSIBLE_PROPERTY_LABEL,
                                       words[i], -1);
        g_signal_connect(button, "notify::rgba", G_CALLBACK(colored), app);
        gtk_box_append(GTK_BOX(box), button);
    }
    return box;
}

GtkWidget *studio_panel_brush(studio_app *app) {
    GtkWidget *grid = gtk_grid_new(), *search = gtk_search_entry_new(),
              *scrolled = gtk_scrolled_window_new();
    gtk_grid_set_column_spacing(GTK_GRID(grid), 6);
    gtk_grid_set_row_spacing(GTK_GRID(grid), 2);
    for (int i = 0; i < SLIDERS; i++) {
        GtkWidget *label = gtk_label_new(sliders[i].label);
        GtkWidget *scale = gtk_scale_new_with_range(GTK_ORIENTATION_HORIZONTAL, sliders[i].low,
                                                    sliders[i].high, sliders[i].step);
        app->sliders[i] = scale;
        gtk_label_set_xalign(GTK_LABEL(label), 0);
        gtk_widget_set_hexpand(scale, TRUE);
        gtk_scale_set_draw_value(GTK_SCALE(scale), TRUE);
        gtk_scale_set_value_pos(GTK_SCALE(scale), GTK_POS_RIGHT);
        gtk_accessible_update_property(GTK_ACCESSIBLE(scale), GTK_ACCESSIBLE_PROPERTY_LABEL,
                                       sliders[i].label, -1);
        gtk_grid_attach(GTK_GRID(grid), label, 0, i, 1, 1);
        gtk_grid_attach(GTK_GRID(grid), scale, 1, i, 1, 1);
        g_signal_connect(scale, "value-changed", G_CALLBACK(slid), app);
    }
    gtk_grid_attach(GTK_GRID(grid), gtk_label_new("Colour"), 0, SLIDERS, 1, 1);
    gtk_grid_attach(GTK_GRID(grid), make_colors(app), 1, SLIDERS, 1, 1);
    app->brushes_list = gtk_list_box_new();
    gtk_list_box_set_filter_func(GTK_LIST_BOX(app->brushes_list), matches, search, NULL);
    g_signal_connect(search, "search-changed", G_CALLBACK(searched), app->brushes_list);
    g_signal_connect(app->brushes_list, "row-selected", G_CALLBACK(chosen), app);
    gtk_accessible_update_property(GTK_ACCESSIBLE(search), GTK_ACCESSIBLE_PROPERTY_LABEL,
                                   "Search brushes", -1);
    gtk_scrolled_window_set_child(GTK_SCROLLED_WINDOW(scrolled), app->brushes_list);
    gtk_widget_set_size_request(scrolled, -1, 160);
    gtk_grid_attach(GTK_GRID(grid), search, 0, SLIDERS + 1, 2, 1);
    gtk_grid_attach(GTK_GRID(grid), scrolled, 0, SLIDERS + 2, 2, 1);
    g_timeout_add_full(G_PRIORITY_LOW, 500, find_brushes, app, NULL);
    return grid;
}

void studio_panel_brush_sync(studio_app *app) {
    const float *colors[2] = {app->paint.color, app->paint.other};
    gtk_range_set_value(GTK_RANGE(app->sliders[SIZE]), (double)app->paint.radius);
    gtk_range_set_value(GTK_RANGE(app->sliders[OPACITY]), (double)app->paint.opacity);
    gtk_range_set_value(GTK_RANGE(app->sliders[HARDNESS]), (double)app->paint.hardness);
    for (int i = 0; i < 2; i++) {
        const GdkRGBA rgba = {colors[i][0], colors[i][1], colors[i][2], 1};
        gtk_color_chooser_set_rgba(GTK_COLOR_CHOOSER(app->color_buttons[i]), &rgba);
    }
}
