/* The layers, the topmost first. */
#include "studio/studio.h"

#include <stdlib.h>
#include <string.h>

static void chosen(GtkListBox *list, GtkListBoxRow *row, gpointer user) {
    studio_app *app = user;
    (void)list;
    if (row && !app->syncing)
        studio_actions_run(app, "layer", g_object_get_data(G_OBJECT(row), "id"));
}

static void shown(GtkCheckButton *button, gpointer user) {
    studio_app *app = user;
    if (!app->syncing)
        studio_actions_run(app, "layer-show", g_object_get_data(G_OBJECT(button), "id"));
}

static void renamed(GtkEditableLabel *label, GParamSpec *spec, gpointer user) {
    studio_app *app = user;
    (void)spec;
    if (!app->syncing && !gtk_editable_label_get_editing(label))
        studio_actions_run(app, "layer-name", gtk_editable_get_text(GTK_EDITABLE(label)));
}

static bool is_held(const studio_app *app) {
    GdkSurface *surface = gtk_native_get_surface(GTK_NATIVE(app->window));
    GdkSeat *seat = gdk_display_get_default_seat(gtk_widget_get_display(app->layer_opacity));
    GdkModifierType state = 0;
    gdk_surface_get_device_position(surface, gdk_seat_get_pointer(seat), NULL, NULL, &state);
    return state & GDK_BUTTON1_MASK;
}

static gboolean fade(gpointer user) {
    studio_app *app = user;
    char text[G_ASCII_DTOSTR_BUF_SIZE];
    if (!app->closing && is_held(app))
        return G_SOURCE_CONTINUE;
    app->fade = 0;
    if (!app->closing)
        studio_actions_run(
            app, "layer-opacity",
            g_ascii_dtostr(text, sizeof text, gtk_range_get_value(GTK_RANGE(app->layer_opacity))));
    return G_SOURCE_REMOVE;
}

/* When the slider is let go of: a drag is one thing to undo, however many values it goes through.
 */
static void faded(GtkRange *range, gpointer user) {
    studio_app *app = user;
    (void)range;
    if (!app->syncing && !app->fade)
        app->fade = g_timeout_add(50, fade, app);
}

static void blended(GtkDropDown *list, GParamSpec *spec, gpointer user) {
    studio_app *app = user;
    (void)spec;
    if (!app->syncing)
        studio_actions_run(app, "layer-blend",
                           slv_blend_name((slv_blend)gtk_drop_down_get_selected(list)));
}

static GtkWidget *make_row(studio_app *app, const slv_layer_info *info) {
    GtkWidget *row = gtk_list_box_row_new(), *box = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 6);
    GtkWidget *check = gtk_check_button_new();
    GtkWidget *label = gtk_editable_label_new(*info->props.name ? info->props.name : "layer");
    char *id = g_strdup_printf("%u", info->id);
    gtk_check_button_set_active(GTK_CHECK_BUTTON(check), !info->props.hidden);
    gtk_widget_set_tooltip_text(check, "Show this layer");
    gtk_widget_set_hexpand(label, TRUE);
    gtk_box_append(GTK_BOX(box), check);
    gtk_box_append(GTK_BOX(box), label);
    if (info->has_mask)
        gtk_box_append(GTK_BOX(box), gtk_label_new("mask"));
    if (info->props.locked)
        gtk_box_append(GTK_BOX(box), gtk_image_new_from_icon_name("changes-prevent-symbolic"));
    gtk_list_box_row_set_child(GTK_LIST_BOX_ROW(row), box);
    gtk_accessible_update_property(GTK_ACCESSIBLE(row), GTK_ACCESSIBLE_PROPERTY_LABEL,
                                   info->props.name, -1);
    g_object_set_data_full(G_OBJECT(check), "id", g_strdup(id), g_free);
    g_object_set_data_full(G_OBJECT(row), "id", id, g_free);
    g_signal_connect(check, "toggled", G_CALLBACK(shown), app);
    g_signal_connect(label, "notify::editing", G_CALLBACK(renamed), app);
    return row;
}

static const studio_button buttons[] = {
    {"list-add-symbolic", "win.layer-add", "Add a layer"},
    {"list-remove-symbolic", "win.layer-remove", "Remove the layer"},
    {"go-up-symbolic", "win.layer-raise", "Raise the layer"},
    {"go-down-symbolic", "win.layer-lower", "Lower the layer"},
    {"edit-copy-symbolic", "win.layer-duplicate", "Duplicate the layer"}};

GtkWidget *studio_panel_layers(studio_app *app) {
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_VERTICAL, 4), *head;
    const char *names[SLV_BLEND_COUNT + 1] = {NULL};
    for (int i = 0; i < SLV_BLEND_COUNT; i++)
        names[i] = slv_blend_name((slv_blend)i);
    head = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 6);
    app->layer_blend = gtk_drop_down_new_from_strings(names);
    app->layer_opacity = gtk_scale_new_with_range(GTK_ORIENTATION_HORIZONTAL, 0, 1, 0.01);
    gtk_widget_set_hexpand(app->layer_opacity, TRUE);
    gtk_widget_set_tooltip_text(app->layer_opacity, "Opacity of the layer");
    gtk_widget_set_tooltip_text(app->layer_blend, "How the layer goes over those below");
    gtk_box_append(GTK_BOX(head), app->layer_blend);
    gtk_box_append(GTK_BOX(head), app->layer_opacity);
    app->layers = gtk_list_box_new();
    gtk_box_append(GTK_BOX(box), studio_actions_buttons(buttons, G_N_ELEMENTS(buttons)));
    gtk_box_append(GTK_BOX(box), head);
    gtk_box_append(GTK_BOX(box), app->layers);
    g_signal_connect(app->layers, "row-selected", G_CALLBACK(chosen), app);
    g_signal_connect(app->layer_opacity, "value-changed", G_CALLBACK(faded), app);
    g_signal_connect(app->layer_blend, "notify::selected", G_CALLBACK(blended), app);
    return box;
}

/* Rows are made anew where the layers are others: whoever edits a name keeps its row. */
static bool same_rows(studio_app *app, char *now, size_t size) {
    slv_document *layers = studio_document_layers(&app->document);
    slv_layer_info info;
    size_t at = 0;
    now[0] = 0;
    for (uint32_t i = 0;
         layers && slv_document_layer(layers, slv_document_layer_at(layers, i), &info) && at < size;
         i++)
        at += (size_t)snprintf(now + at, size - at, "%u%d%d%d%s\n", info.id, info.props.hidden,
                               info.props.locked, info.has_mask, info.props.name);
    const char *before = g_object_get_data(G_OBJECT(app->layers), "rows");
    return before && strcmp(before, now) == 0;
}

void studio_panel_layers_sync(studio_app *app) {
    slv_document *layers = studio_document_layers(&app->document);
    slv_layer_info info;
    static char now[1 << 16];
    GtkWidget *child;
    bool same = same_rows(app, now, sizeof now);
    while (!same && (child = gtk_widget_get_first_child(app->layers)))
        gtk_list_box_remove(GTK_LIST_BOX(app->layers), child);
    uint32_t count = layers ? slv_document_layer_count(layers) : 0;
    for (uint32_t i = count; i--;) {
        if (!slv_document_layer(layers, slv_document_layer_at(layers, i), &info))
            continue;
        GtkWidget *row = NULL;
        if (same)
            row = GTK_WIDGET(
                gtk_list_box_get_row_at_index(GTK_LIST_BOX(app->layers), (int)(count - 1 - i)));
        else
            gtk_list_box_append(GTK_LIST_BOX(app->layers), row = make_row(app, &info));
        if (info.id != app->document.layer)
            continue;
        gtk_list_box_select_row(GTK_LIST_BOX(app->layers), GTK_LIST_BOX_ROW(row));
        gtk_range_set_value(GTK_RANGE(app->layer_opacity), (double)info.props.opacity);
        gtk_drop_down_set_selected(GTK_DROP_DOWN(app->layer_blend), (guint)info.props.blend);
    }
    g_object_set_data_full(G_OBJECT(app->layers), "rows", g_strdup(now), g_free);
    gtk_widget_set_sensitive(app->layer_opacity, layers != NULL);
    gtk_widget_set_sensitive(app->layer_blend, layers != NULL);
}
