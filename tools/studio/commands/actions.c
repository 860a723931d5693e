/* All that can be done, in one table: its name, where it is in the menus, its keys. */
#include "studio/commands/commands.h"

#include <stdlib.h>
#include <string.h>

/* An action by itself; one that is on or off; one value of several, a row for each. */
typedef struct row {
    const char *menu, *label, *name, *target, *keys;
    studio_command run;
    studio_state state; /* NULL: it has none */
    bool needs;         /* something that is open */
} row;

#define STRATEGY(key)                                                                              \
    { "Strategy", NULL, "strategy", NULL, key, studio_set_strategy, studio_get_strategy, false }

static const row rows[] = {
    {"File", "Open…", "open", NULL, "<Control>o", studio_do_open, NULL, false},
    {"File", "Open Session…", "open-session", NULL, "<Control><Shift>o", studio_do_open_session,
     NULL, false},
    {"File", "Stop Opening", "open-cancel", NULL, "<Control>period", studio_do_open_cancel, NULL,
     false},
    {"File", "Save", "save", NULL, "<Control>s", studio_do_save, NULL, true},
    {"File", "Save As…", "save-as", NULL, "<Control><Shift>s", studio_do_save_as, NULL, true},
    {"File", "Export .ptx…", "export", NULL, "<Control>e", studio_do_export, NULL, true},
    {"File", "Open View…", "open-view", NULL, "F8", studio_do_open_view, NULL, true},
    {"File", "Save View…", "save-view", NULL, "F9", studio_do_save_view, NULL, true},
    {"File", "Screenshot…", "screenshot", NULL, "F12", studio_do_screenshot, NULL, true},
    {"File", "Turntable…", "turntable", NULL, "<Shift>F12", studio_do_turntable, NULL, true},
    {"File", "Quit", "quit", NULL, "<Control>q", studio_do_quit, NULL, false},
    {"Edit", "Undo", "undo", NULL, "<Control>z", studio_do_undo, NULL, true},
    {"Edit", "Redo", "redo", NULL, "<Control><Shift>z", studio_do_redo, NULL, true},
    {"Edit", "Turn the View", "tool", "view", "v", studio_set_tool, studio_get_tool, true},
    {"Edit", "Paint", "tool", "paint", "b", studio_set_tool, studio_get_tool, true},
    {"Edit", "Erase", "tool", "erase", "e", studio_set_tool, studio_get_tool, true},
    {"Edit", "Fill", "tool", "fill", "g", studio_set_tool, studio_get_tool, true},
    {"Edit", "Fill with a Gradient", "tool", "gradient", "<Shift>g", studio_set_tool,
     studio_get_tool, true},
    {"Edit", "Pick a Colour", "tool", "pick", "i", studio_set_tool, studio_get_tool, true},
    {"Edit", "Select Faces", "tool", "select", "s", studio_set_tool, studio_get_tool, true},
    {"Edit", "Place the Stencil", "tool", "stencil", "y", studio_set_tool, studio_get_tool, true},
    {"Edit", "Resolution Brush", "tool", "texels", "r", studio_set_tool, studio_get_tool, true},
    {"Edit", "Select No Faces", "select-none", NULL, "<Control><Shift>a", studio_do_select_none,
     NULL, true},
    {"Edit", "Stencil…", "stencil", NULL, "<Control>y", studio_do_stencil, NULL, true},
    {"Edit", "No Stencil", "stencil-none", NULL, "<Shift>y", studio_do_stencil_none, NULL, true},
    {"Edit", "Double the Face's Texels", "texels-more", NULL, "<Control>plus <Control>equal",
     studio_do_texels_more, NULL, true},
    {"Edit", "Halve the Face's Texels", "texels-fewer", NULL, "<Control>minus",
     studio_do_texels_fewer, NULL, true},
    {"Edit", "Aim for the Face's Density", "density-take", NULL, "<Control>t",
     studio_do_density_take, NULL, true},
    {"Edit", "Aim for More Texels", "density-more", NULL, "<Control>bracketright",
     studio_do_density_more, NULL, true},
    {"Edit", "Aim for Fewer Texels", "density-less", NULL, "<Control>bracketleft",
     studio_do_density_less, NULL, true},
    {"Edit", "Double and Halve Instead", "density-none", NULL, "<Control><Shift>t",
     studio_do_density_none, NULL, true},
    {"Edit", "Larger Brush", "brush-larger", NULL, "bracketright", studio_do_brush_larger, NULL,
     false},
    {"Edit", "Smaller Brush", "brush-smaller", NULL, "bracketleft", studio_do_brush_smaller, NULL,
     false},
    {"Edit", "Keep the Colour as a Swatch", "swatch-add", NULL, "a", studio_do_swatch_add, NULL,
     false},
    {"Edit", "Exchange the Colours", "colors-swap", NULL, "<Shift>x", studio_do_colors_swap, NULL,
     false},
    {"Edit", "Round Gradients", "gradient-round", NULL, "<Control>g", studio_do_gradient_round,
     studio_get_gradient_round, false},
    {"Edit", "Mirror", "mirror", NULL, "x", studio_do_mirror, studio_get_mirror, false},
    {"Edit", "Project from the View", "project", NULL, "p", studio_do_project, studio_get_project,
     false},
    {"Layer", "Add", "layer-add", NULL, "<Control><Shift>n", studio_do_layer_add, NULL, true},
    {"Layer", "Duplicate", "layer-duplicate", NULL, "<Control>j", studio_do_layer_duplicate, NULL,
     true},
    {"Layer", "Remove", "layer-remove", NULL, "<Control>Delete", studio_do_layer_remove, NULL,
     true},
    {"Layer", "Raise", "layer-raise", NULL, "<Control>Up", studio_do_layer_raise, NULL, true},
    {"Layer", "Lower", "layer-lower", NULL, "<Control>Down", studio_do_layer_lower, NULL, true},
    {"Layer", "Merge Down", "layer-merge", NULL, "<Control>m", studio_do_layer_merge, NULL, true},
    {"Layer", "Hide", "layer-hide", NULL, "<Control>h", studio_do_layer_hide, studio_get_layer_hide,
     true},
    {"Layer", "Lock", "layer-lock", NULL, "<Control>l", studio_do_layer_lock, studio_get_layer_lock,
     true},
    {"Layer", "Add Mask", "mask-add", NULL, "<Control><Shift>k", studio_do_mask_add, NULL, true},
    {"Layer", "Remove Mask", "mask-remove", NULL, "<Control><Shift>Delete", studio_do_mask_remove,
     NULL, true},
    {"Layer", "Paint on the Mask", "mask-paint", NULL, "<Control>k", studio_do_mask_paint,
     studio_get_mask_paint, true},
    {"View", "Frame", "frame", NULL, "f", studio_do_frame, NULL, true},
    {"View", "Front", "face-front", NULL, "KP_1", studio_do_front, NULL, true},
    {"View", "Right", "face-right", NULL, "KP_3", studio_do_right, NULL, true},
    {"View", "Top", "face-top", NULL, "KP_7", studio_do_top, NULL, true},
    {"View", "Orthographic", "orthographic", NULL, "o", studio_do_orthographic,
     studio_get_orthographic, true},
    {"View", "Go to Bookmark 1", "bookmark", "1", "F5", studio_do_bookmark, NULL, true},
    {"View", "Go to Bookmark 2", "bookmark", "2", "F6", studio_do_bookmark, NULL, true},
    {"View", "Go to Bookmark 3", "bookmark", "3", "F7", studio_do_bookmark, NULL, true},
    {"View", "Set Bookmark 1", "bookmark-set", "1", "<Shift>F5", studio_do_bookmark_set, NULL,
     true},
    {"View", "Set Bookmark 2", "bookmark-set", "2", "<Shift>F6", studio_do_bookmark_set, NULL,
     true},
    {"View", "Set Bookmark 3", "bookmark-set", "3", "<Shift>F7", studio_do_bookmark_set, NULL,
     true},
    {"View", "Dark", "dark", NULL, "<Control>d", studio_do_dark, studio_get_dark, false},
    {"Look", "Brighter", "exposure-up", NULL, "period", studio_do_brighter, NULL, false},
    {"Look", "Darker", "exposure-down", NULL, "comma", studio_do_darker, NULL, false},
    {"Look", "Encoding: sRGB", "encoding", "srgb", "<Control>1", studio_set_encoding,
     studio_get_encoding, false},
    {"Look", "Encoding: Numbers as They Are", "encoding", "linear", "<Control>2",
     studio_set_encoding, studio_get_encoding, false},
    {"Look", "Encoding: Colour Map", "encoding", "data", "<Control>3", studio_set_encoding,
     studio_get_encoding, false},
    {"Look", "Shading: Headlight", "shading", "headlight", "h", studio_set_shading,
     studio_get_shading, false},
    {"Look", "Shading: Both Sides", "shading", "headlight-abs", "<Shift>h", studio_set_shading,
     studio_get_shading, false},
    {"Look", "Shading: Squared", "shading", "headlight-cos2", "<Shift>u", studio_set_shading,
     studio_get_shading, false},
    {"Look", "Shading: Unlit", "shading", "unlit", "u", studio_set_shading, studio_get_shading,
     false},
    {"Look", "Shading: Image", "shading", "image", "<Shift>i", studio_set_shading,
     studio_get_shading, false},
    {"Look", "Light from an Image…", "light", NULL, "<Control>i", studio_do_light, NULL, false},
    {"Look", "Turn the Light to the Left", "light-left", NULL, "braceleft", studio_do_light_left,
     NULL, false},
    {"Look", "Turn the Light to the Right", "light-right", NULL, "braceright",
     studio_do_light_right, NULL, false},
    {"Look", "Next Channel", "channel-next", NULL, "c", studio_do_channel, NULL, true},
    {"Overlay", "No Overlay", "overlay", "none", "<Alt>0", studio_set_overlay, studio_get_overlay,
     false},
    {"Overlay", "Faces", "overlay", "faces", "<Alt>1", studio_set_overlay, studio_get_overlay,
     false},
    {"Overlay", "Resolution", "overlay", "resolution", "<Alt>2", studio_set_overlay,
     studio_get_overlay, false},
    {"Overlay", "Levels", "overlay", "levels", "<Alt>3", studio_set_overlay, studio_get_overlay,
     false},
    {"Overlay", "Widened Faces", "overlay", "widened", "<Alt>4", studio_set_overlay,
     studio_get_overlay, false},
    {"Overlay", "Damaged Faces", "overlay", "damaged", "<Alt>5", studio_set_overlay,
     studio_get_overlay, false},
    {"Overlay", "Seams", "seams", NULL, "l", studio_do_seams, studio_get_seams, false},
    {"Overlay", "Wireframe", "wires", NULL, "w", studio_do_wires, studio_get_wires, false},
    {"Surface", "Finer Surface", "segments-more", NULL, "Page_Up", studio_do_segments_more, NULL,
     true},
    {"Surface", "Coarser Surface", "segments-fewer", NULL, "Page_Down", studio_do_segments_fewer,
     NULL, true},
    {"Surface", "Displace by a File…", "displace", NULL, "<Control><Shift>d", studio_do_displace,
     NULL, true},
    {"Surface", "Displace by the Next Channel", "displace-channel", NULL, "<Shift>c",
     studio_do_displace_channel, NULL, true},
    {"Surface", "Displace Further", "displace-more", NULL, "<Shift>Page_Up",
     studio_do_displace_more, NULL, true},
    {"Surface", "Displace Less", "displace-less", NULL, "<Shift>Page_Down", studio_do_displace_less,
     NULL, true},
    {"Surface", "Displace Nothing", "displace-none", NULL, "<Alt>d", studio_do_displace_none, NULL,
     true},
    {"Lookups", "Anisotropy 1", "anisotropy", "1", "F2", studio_set_anisotropy,
     studio_get_anisotropy, false},
    {"Lookups", "Anisotropy 4", "anisotropy", "4", "F3", studio_set_anisotropy,
     studio_get_anisotropy, false},
    {"Lookups", "Anisotropy 16", "anisotropy", "16", "F4", studio_set_anisotropy,
     studio_get_anisotropy, false},
    {"Lookups", "Even Levels", "even-levels", NULL, "<Shift>l", studio_do_even_levels,
     studio_get_even_levels, false},
    {"Lookups", "Coarser Levels", "bias-up", NULL, "greater", studio_do_bias_up, NULL, true},
    {"Lookups", "Finer Levels", "bias-down", NULL, "less", studio_do_bias_down, NULL, true},
    {"Lookups", "Levels as They Are", "bias-none", NULL, "equal", studio_do_bias_none, NULL, true},
    {"Lookups", "1 Sample a Pixel", "msaa", "1", "<Shift>F2", studio_set_msaa, studio_get_msaa,
     false},
    {"Lookups", "4 Samples a Pixel", "msaa", "4", "<Shift>F3", studio_set_msaa, studio_get_msaa,
     false},
    {"Lookups", "8 Samples a Pixel", "msaa", "8", "<Shift>F4", studio_set_msaa, studio_get_msaa,
     false},
    STRATEGY("1"),
    STRATEGY("2"),
    STRATEGY("3"),
    STRATEGY("4"),
    STRATEGY("5"),
    STRATEGY("6"),
    STRATEGY("7"),
    STRATEGY("8"),
    {"Compare", "One Strategy", "compare", "whole", "Escape", studio_set_compare,
     studio_get_compare, false},
    {"Compare", "Split", "compare", "split", "bar backslash", studio_set_compare,
     studio_get_compare, false},
    {"Compare", "Difference", "compare", "difference", "d", studio_set_compare, studio_get_compare,
     false},
    {"Compare", "Flicker", "compare", "flicker", "k", studio_set_compare, studio_get_compare,
     false},
    {"Compare", "Another One on the Other Side", "other-next", NULL, "t", studio_do_other_next,
     NULL, false},
    {"Compare", "Seam Jump", "seam-jump", NULL, "j", studio_do_seam_jump, NULL, true},
    {"Compare", "Report on All Strategies", "report", NULL, "<Control>r", studio_do_report, NULL,
     true},
    {"Compare", "Report on an Orbit from Here", "report-orbit", NULL, "<Control><Shift>r",
     studio_do_report_orbit, NULL, true},
    {"Help", "Keyboard Shortcuts", "shortcuts", NULL, "<Control>question F1", studio_do_shortcuts,
     NULL, false},
    {"Help", "About", "about", NULL, "<Shift>F1", studio_do_about, NULL, false},
    /* without a place in the menus: from lists, tools and messages */
    {NULL, "Fill a face", "fill-face", "", NULL, studio_do_fill_face, NULL, true},
    {NULL, "Fill with a gradient", "fill-gradient", "", NULL, studio_do_fill_gradient, NULL, true},
    {NULL, "Select a face", "select-face", "", NULL, studio_do_select_face, NULL, true},
    {NULL, "Twice the texels of faces", "faces-finer", "", NULL, studio_do_faces_finer, NULL, true},
    {NULL, "Half the texels of faces", "faces-coarser", "", NULL, studio_do_faces_coarser, NULL,
     true},
    {NULL, "Density of faces", "faces-density", "", NULL, studio_do_faces_density, NULL, true},
    {NULL, "Pick a colour", "pick-color", NULL, NULL, studio_do_pick_color, NULL, true},
    {NULL, "Paint through an image", "stencil-path", "", NULL, studio_do_stencil_path, NULL, true},
    {NULL, "Displace by a file", "displace-path", "", NULL, studio_do_displace_path, NULL, true},
    {NULL, "Light from an image", "light-path", "", NULL, studio_do_light_path, NULL, false},
    {NULL, "Show damaged faces", "damaged-show", NULL, NULL, studio_do_damaged_show, NULL, true},
    {NULL, "Take a colour", "color", "", NULL, studio_do_color, NULL, false},
    {NULL, "Go to a place of the history", "history", "", NULL, studio_do_history, NULL, true},
    {NULL, "Choose a layer", "layer", "", NULL, studio_set_layer, NULL, true},
    {NULL, "Show a layer", "layer-show", "", NULL, studio_do_layer_show, NULL, true},
    {NULL, "Name a layer", "layer-name", "", NULL, studio_do_layer_name, NULL, true},
    {NULL, "Opacity of a layer", "layer-opacity", "", NULL, studio_do_layer_opacity, NULL, true},
    {NULL, "Blend mode of a layer", "layer-blend", "", NULL, studio_do_layer_blend, NULL, true},
    {NULL, "Choose a brush", "brush", "", NULL, studio_set_brush, NULL, false},
    {NULL, "Open a file", "open-path", "", NULL, studio_do_open_path, NULL, false},
    {NULL, "Save a screenshot", "screenshot-to", "", NULL, studio_do_screenshot_to, NULL, true},
    {NULL, "Save a turntable", "turntable-to", "", NULL, studio_do_turntable_to, NULL, true},
    {NULL, "Pictures of a turntable", "turntable-count", "", NULL, studio_do_turntable_count, NULL,
     false},
    {NULL, "Stop the turntable", "turntable-cancel", NULL, NULL, studio_do_turntable_cancel, NULL,
     false},
    {NULL, "Save to a path", "save-to", "", NULL, studio_do_save_to, NULL, true},
    {NULL, "Export to a path", "export-to", "", NULL, studio_do_export_to, NULL, true},
    {NULL, "Stop the stroke", "stroke-stop", NULL, NULL, studio_do_stroke_stop, NULL, false},
    {NULL, "Stop the report", "report-cancel", NULL, NULL, studio_do_report_cancel, NULL, false},
    {NULL, "Show the report", "report-show", NULL, NULL, studio_do_report_show, NULL, false},
    {NULL, "Throw unsaved work away", "discard", NULL, NULL, studio_do_discard, NULL, true},
};
enum { ROWS = sizeof rows / sizeof *rows };

/* Strategies fill their rows in the order of the library's table. */
static bool words_of(int i, const char **label, const char **target) {
    int first = 0;
    while (rows[first].label)
        first++;
    const slv_strategy *strategy = rows[i].label ? NULL : slv_strategy_at((uint32_t)(i - first));
    *label = strategy ? strategy->name : rows[i].label;
    *target = strategy ? strategy->name : rows[i].target;
    return *label != NULL;
}

static const row *find(const char *name) {
    for (int i = 0; i < ROWS; i++)
        if (strcmp(rows[i].name, name) == 0)
            return &rows[i];
    return NULL;
}

static bool waits_for_opening(const row *r) {
    return r->run != studio_do_open_cancel && r->run != studio_do_quit;
}

/* Keys that are held come once more before a question has the keyboard, or before the window that
 * they close has gone. */
static void run(studio_app *app, const row *r, const char *target) {
    if (app->closing || app->asking || (app->loading && waits_for_opening(r)) ||
        app->drag == STUDIO_DRAG_STROKE || app->touched || (r->needs && !app->document.texture))
        return;
    studio_log(app, "\"event\":\"action\",\"name\":\"%s\",\"target\":\"%s\"", r->name,
               strchr(target, '"') || strchr(target, '\\') ? "" : target);
    app->document.message[0] = 0;
    r->run(app, target);
    studio_sync(app);
    studio_log(app, "\"event\":\"done\",\"name\":\"%s\"", r->name);
}

/* What was asked for while a stroke took longer than the hand. */
typedef struct asked {
    const row *row;
    char target[];
} asked;

void studio_actions_run(studio_app *app, const char *name, const char *target) {
    const row *found = find(name);
    target = target ? target : "";
    if (found && app->stroke.lifted &&
        (found->run == studio_do_undo || found->run == studio_do_quit ||
         found->run == studio_do_stroke_stop)) {
        studio_stroke_stop(app);
    } else if (found && app->stroke.lifted) {
        asked *later = g_malloc(sizeof *later + strlen(target) + 1);
        later->row = found;
        strcpy(later->target, target);
        g_queue_push_tail(&app->asked, later);
        return;
    }
    if (found)
        run(app, found, target);
}

void studio_actions_run_asked(studio_app *app) {
    asked *next;
    while (!app->stroke.lifted && (next = g_queue_pop_head(&app->asked))) {
        run(app, next->row, next->target);
        g_free(next);
    }
}

static void activate(GSimpleAction *action, GVariant *parameter, gpointer user) {
    const char *name = g_action_get_name(G_ACTION(action));
    const char *target = parameter ? g_variant_get_string(parameter, NULL) : NULL;
    studio_actions_run(user, name, target);
}

/* The state of menus follows the model. */
static void show_state(studio_app *app, const row *r) {
    GAction *action = g_action_map_lookup_action(G_ACTION_MAP(app->window), r->name);
    bool open = app->document.texture != NULL && !app->loading;
    const bool can = r->run == studio_do_open_cancel ? app->opening != NULL : open || !r->needs;
    g_simple_action_set_enabled(G_SIMPLE_ACTION(action), can);
    if (r->state && r->target == NULL && r->label)
        g_simple_action_set_state(G_SIMPLE_ACTION(action),
                                  g_variant_new_boolean(r->state(app) != NULL));
    else if (r->state)
        g_simple_action_set_state(G_SIMPLE_ACTION(action), g_variant_new_string(r->state(app)));
}

void studio_actions_sync(studio_app *app) {
    for (int i = 0; i < ROWS; i++)
        if (find(rows[i].name) == &rows[i])
            show_state(app, &rows[i]);
}

static gboolean run_shortcut(GtkWidget *widget, GVariant *args, gpointer user) {
    const row *r = user;
    const char *label, *target;
    (void)args;
    studio_app *app = g_object_get_data(G_OBJECT(widget), "app");
    if (!words_of((int)(r - rows), &label, &target))
        return FALSE;
    studio_actions_run(app, r->name, target);
    return TRUE;
}

/* Keys come to what has the focus first, so that a letter typed into a field is no command. */
static void add_keys(studio_app *app, GtkEventController *controller, const row *r) {
    char **keys = r->keys ? g_strsplit(r->keys, " ", -1) : NULL;
    for (char **key = keys; key && *key; key++)
        gtk_shortcut_controller_add_shortcut(
            GTK_SHORTCUT_CONTROLLER(controller),
            gtk_shortcut_new(gtk_shortcut_trigger_parse_string(*key),
                             gtk_callback_action_new(run_shortcut, (gpointer)(intptr_t)r, NULL)));
    g_strfreev(keys);
    (void)app;
}

void studio_actions_add(studio_app *app) {
    GtkEventController *controller = gtk_shortcut_controller_new();
    g_object_set_data(G_OBJECT(app->window), "app", app);
    for (int i = 0; i < ROWS; i++) {
        const row *r = &rows[i];
        GSimpleAction *action = NULL;
        const char *label, *target;
        if (words_of(i, &label, &target))
            add_keys(app, controller, r);
        if (find(r->name) != r)
            continue;
        if (target && r->state)
            action = g_simple_action_new_stateful(r->name, G_VARIANT_TYPE_STRING,
                                                  g_variant_new_string(r->state(app)));
        else if (target)
            action = g_simple_action_new(r->name, G_VARIANT_TYPE_STRING);
        else if (r->state)
            action = g_simple_action_new_stateful(r->name, NULL, g_variant_new_boolean(FALSE));
        else
            action = g_simple_action_new(r->name, NULL);
        g_signal_connect(action, "activate", G_CALLBACK(activate), app);
        g_action_map_add_action(G_ACTION_MAP(app->window), G_ACTION(action));
        g_object_unref(action);
    }
    gtk_widget_add_controller(GTK_WIDGET(app->window), controller);
}

static char *first_key(const row *r) {
    return r->keys ? g_strndup(r->keys, strcspn(r->keys, " ")) : NULL;
}

GMenuModel *studio_actions_menu(studio_app *app) {
    GMenu *bar = g_menu_new(), *menu = NULL, *section = NULL;
    const char *now = "", *group = "";
    app->recent_menu = g_menu_new();
    for (int i = 0; i < ROWS && rows[i].menu; i++) {
        const row *r = &rows[i];
        const char *label, *target;
        if (!words_of(i, &label, &target))
            continue;
        if (strcmp(r->menu, now) != 0) {
            menu = g_menu_new();
            g_menu_append_submenu(bar, r->menu, G_MENU_MODEL(menu));
            g_object_unref(menu);
            group = "";
        }
        /* values of one action stand together */
        bool apart = strcmp(r->menu, now) != 0 ||
                     ((target || find(group)->target) && strcmp(r->name, group) != 0);
        if (apart) {
            section = g_menu_new();
            g_menu_append_section(menu, NULL, G_MENU_MODEL(section));
            g_object_unref(section);
        }
        now = r->menu;
        group = r->name;
        char *detailed = target ? g_strdup_printf("win.%s::%s", r->name, target)
                                : g_strdup_printf("win.%s", r->name);
        GMenuItem *item = g_menu_item_new(label, detailed);
        char *key = first_key(r);
        if (key)
            g_menu_item_set_attribute(item, "accel", "s", key);
        g_menu_append_item(section, item);
        if (strcmp(r->name, "open-session") == 0)
            g_menu_append_submenu(section, "Open Recent", G_MENU_MODEL(app->recent_menu));
        g_object_unref(item);
        g_free(detailed);
        g_free(key);
    }
    return G_MENU_MODEL(bar);
}

GtkWidget *studio_actions_buttons(const studio_button *buttons, size_t count) {
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 0);
    gtk_widget_add_css_class(box, "linked");
    for (size_t i = 0; i < count; i++) {
        GtkWidget *button = gtk_button_new_from_icon_name(buttons[i].icon);
        gtk_actionable_set_action_name(GTK_ACTIONABLE(button), buttons[i].action);
        gtk_widget_set_tooltip_text(button, buttons[i].tip);
        gtk_accessible_update_property(GTK_ACCESSIBLE(button), GTK_ACCESSIBLE_PROPERTY_LABEL,
                                       buttons[i].tip, -1);
        gtk_box_append(GTK_BOX(box), button);
    }
    return box;
}

/* A section for each menu, in groups that a small display has room for: the toolkit divides none.
 */
GtkWidget *studio_actions_shortcuts(studio_app *app) {
    enum { GROUP = 16 };
    static const char group[] =
        "<child><object class=\"GtkShortcutsGroup\"><property name=\"title\">";
    GString *xml = g_string_new("<interface><object class=\"GtkShortcutsWindow\" id=\"window\">"
                                "<property name=\"modal\">1</property>");
    const char *now = "";
    int count = 0;
    for (int i = 0; i < ROWS && rows[i].menu; i++) {
        const char *label, *target;
        if (!words_of(i, &label, &target) || !rows[i].keys)
            continue;
        const bool begins = strcmp(rows[i].menu, now) != 0;
        if (begins)
            g_string_append_printf(xml,
                                   "%s<child><object class=\"GtkShortcutsSection\">"
                                   "<property name=\"section-name\">%s</property>"
                                   "<property name=\"title\">%s</property>"
                                   "<property name=\"max-height\">%d</property>%s%s</property>",
                                   *now ? "</object></child></object></child>" : "", rows[i].menu,
                                   rows[i].menu, GROUP + 1, group, rows[i].menu);
        else if (count % GROUP == 0)
            g_string_append_printf(xml, "</object></child>%s </property>", group);
        count = begins ? 1 : count + 1;
        now = rows[i].menu;
        char *line = g_markup_printf_escaped(
            "<child><object class=\"GtkShortcutsShortcut\"><property name=\"accelerator\">%s"
            "</property><property name=\"title\">%s</property></object></child>",
            rows[i].keys, label);
        g_string_append(xml, line);
        g_free(line);
    }
    g_string_append(xml, "</object></child></object></child></object></interface>");
    GtkBuilder *builder = gtk_builder_new_from_string(xml->str, -1);
    GtkWidget *window = GTK_WIDGET(gtk_builder_get_object(builder, "window"));
    gtk_window_set_transient_for(GTK_WINDOW(window), app->window);
    g_object_ref(window);
    g_object_unref(builder);
    g_string_free(xml, TRUE);
    return window;
}
