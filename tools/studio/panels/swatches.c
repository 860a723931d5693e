/* Colours to come back to: a button for each, and one that keeps the brush's. */
#include "studio/studio.h"

enum { COLUMNS = 8, SIDE = 20 };

static void draw(GtkDrawingArea *area, cairo_t *cairo, int width, int height, gpointer user) {
    GdkRGBA rgba;
    (void)user;
    if (!gdk_rgba_parse(&rgba, g_object_get_data(G_OBJECT(area), "color")))
        return;
    gdk_cairo_set_source_rgba(cairo, &rgba);
    cairo_rectangle(cairo, 0, 0, width, height);
    cairo_fill(cairo);
}

static GtkWidget *make_swatch(const char *color) {
    GtkWidget *button = gtk_button_new(), *area = gtk_drawing_area_new();
    g_object_set_data_full(G_OBJECT(area), "color", g_strdup(color), g_free);
    gtk_drawing_area_set_draw_func(GTK_DRAWING_AREA(area), draw, NULL, NULL);
    gtk_widget_set_size_request(area, SIDE, SIDE);
    gtk_button_set_child(GTK_BUTTON(button), area);
    gtk_widget_add_css_class(button, "swatch");
    gtk_widget_set_focusable(button, FALSE);
    gtk_widget_set_tooltip_text(button, color);
    gtk_actionable_set_action_name(GTK_ACTIONABLE(button), "win.color");
    gtk_actionable_set_action_target(GTK_ACTIONABLE(button), "s", color);
    gtk_accessible_update_property(GTK_ACCESSIBLE(button), GTK_ACCESSIBLE_PROPERTY_LABEL, color,
                                   -1);
    return button;
}

/* Buttons are wide by default. */
static void make_narrow(GtkWidget *widget) {
    GtkCssProvider *css = gtk_css_provider_new();
    gtk_css_provider_load_from_data(css, ".swatch { padding: 2px; min-width: 0; min-height: 0; }",
                                    -1);
    gtk_style_context_add_provider_for_display(gtk_widget_get_display(widget),
                                               GTK_STYLE_PROVIDER(css),
                                               GTK_STYLE_PROVIDER_PRIORITY_APPLICATION);
    g_object_unref(css);
}

GtkWidget *studio_panel_swatches(studio_app *app) {
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 4),
              *add = gtk_button_new_from_icon_name("list-add-symbolic");
    app->swatch_list = gtk_grid_new();
    make_narrow(app->swatch_list);
    gtk_widget_set_hexpand(app->swatch_list, TRUE);
    gtk_widget_set_valign(add, GTK_ALIGN_START);
    gtk_actionable_set_action_name(GTK_ACTIONABLE(add), "win.swatch-add");
    gtk_widget_set_tooltip_text(add, "Keep the brush's colour here (A)");
    gtk_accessible_update_property(GTK_ACCESSIBLE(add), GTK_ACCESSIBLE_PROPERTY_LABEL,
                                   "Keep the colour as a swatch", -1);
    gtk_accessible_update_property(GTK_ACCESSIBLE(app->swatch_list), GTK_ACCESSIBLE_PROPERTY_LABEL,
                                   "Swatches", -1);
    gtk_box_append(GTK_BOX(box), app->swatch_list);
    gtk_box_append(GTK_BOX(box), add);
    return box;
}

void studio_panel_swatches_sync(studio_app *app) {
    GtkGrid *grid = GTK_GRID(app->swatch_list);
    for (int i = 0; i < STUDIO_SWATCHES; i++) {
        GtkWidget *old = gtk_grid_get_child_at(grid, i % COLUMNS, i / COLUMNS);
        if (old && strcmp(gtk_widget_get_tooltip_text(old), app->swatches[i]) == 0)
            continue;
        if (old)
            gtk_grid_remove(grid, old);
        if (*app->swatches[i])
            gtk_grid_attach(grid, make_swatch(app->swatches[i]), i % COLUMNS, i / COLUMNS, 1, 1);
    }
}
