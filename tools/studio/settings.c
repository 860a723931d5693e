/* What is kept from one run to the next: looks, light, brush, size of the window, files that were
 * open. */
#include "studio/studio.h"

#include <string.h>

/* Of the brush, and of the other end of gradients. */
static const char *const colors[2][3] = {{"red", "green", "blue"},
                                         {"other-red", "other-green", "other-blue"}};

static char *path_of(void) {
    return g_build_filename(g_get_user_config_dir(), "selvage", "studio.ini", NULL);
}

static float number_of(GKeyFile *file, const char *key, float low, float high, float otherwise) {
    GError *error = NULL;
    double value = g_key_file_get_double(file, "studio", key, &error);
    bool fine = !error && value >= (double)low && value <= (double)high;
    g_clear_error(&error);
    return fine ? (float)value : otherwise;
}

static void show_recent(studio_app *app) {
    g_menu_remove_all(app->recent_menu);
    for (int i = 0; i < STUDIO_RECENT && app->recent[i]; i++) {
        GMenuItem *item = g_menu_item_new(app->recent[i], NULL);
        g_menu_item_set_action_and_target(item, "win.open-path", "s", app->recent[i]);
        g_menu_append_item(app->recent_menu, item);
        g_object_unref(item);
    }
}

static void load_look(studio_app *app, GKeyFile *file) {
    studio_look *look = &app->look;
    char *shading = g_key_file_get_string(file, "studio", "shading", NULL),
         *encoding = g_key_file_get_string(file, "studio", "encoding", NULL);
    if (shading)
        (void)slv_shading_from_name(shading, &look->shading);
    for (int i = 0; encoding && i < STUDIO_ENCODINGS; i++)
        if (strcmp(encoding, studio_encoding_names[i]) == 0)
            app->encoding = (studio_encoding)i;
    app->light_kept = g_key_file_get_string(file, "studio", "light", NULL);
    look->light_turn = number_of(file, "light-turn", -360, 360, look->light_turn);
    look->exposure = number_of(file, "exposure", -STUDIO_EXPOSURE, STUDIO_EXPOSURE, look->exposure);
    look->anisotropy = (uint32_t)number_of(file, "anisotropy", 1, 16, (float)look->anisotropy);
    look->msaa =
        1u << (uint32_t)number_of(file, "msaa-log2", 0, 3, (float)g_bit_nth_msf(look->msaa, -1));
    g_free(shading);
    g_free(encoding);
}

static void save_look(const studio_app *app, GKeyFile *file) {
    const studio_look *look = &app->look;
    const char *light = app->light_path ? app->light_path : app->light_kept;
    g_key_file_set_string(file, "studio", "shading", slv_shading_name(look->shading));
    g_key_file_set_string(file, "studio", "encoding", studio_encoding_names[app->encoding]);
    if (light)
        g_key_file_set_string(file, "studio", "light", light);
    g_key_file_set_double(file, "studio", "light-turn", (double)look->light_turn);
    g_key_file_set_double(file, "studio", "exposure", (double)look->exposure);
    g_key_file_set_integer(file, "studio", "anisotropy", (int)look->anisotropy);
    g_key_file_set_integer(file, "studio", "msaa-log2", g_bit_nth_msf(look->msaa, -1));
}

void studio_settings_load(studio_app *app) {
    GKeyFile *file = g_key_file_new();
    char *path = path_of();
    if (g_key_file_load_from_file(file, path, G_KEY_FILE_NONE, NULL)) {
        gsize count = 0;
        char **recent = g_key_file_get_string_list(file, "studio", "recent", &count, NULL);
        for (gsize i = 0; i < count && i < STUDIO_RECENT; i++)
            app->recent[i] = g_strdup(recent[i]);
        g_strfreev(recent);
        show_recent(app);
        char **swatches = g_key_file_get_string_list(file, "studio", "swatches", &count, NULL);
        for (gsize i = swatches ? MIN(count, STUDIO_SWATCHES) : 0; i--;) {
            GdkRGBA rgba;
            if (gdk_rgba_parse(&rgba, swatches[i]))
                studio_swatches_add(app->swatches,
                                    (const float[3]){rgba.red, rgba.green, rgba.blue});
        }
        g_strfreev(swatches);
        app->dark = g_key_file_get_boolean(file, "studio", "dark", NULL);
        app->paint.radius = number_of(file, "radius", 0.5f, 500, app->paint.radius);
        app->paint.opacity = number_of(file, "opacity", 0, 1, app->paint.opacity);
        app->paint.hardness = number_of(file, "hardness", 0.02f, 1, app->paint.hardness);
        for (int c = 0; c < 3; c++) {
            app->paint.color[c] = number_of(file, colors[0][c], 0, 1, app->paint.color[c]);
            app->paint.other[c] = number_of(file, colors[1][c], 0, 1, app->paint.other[c]);
        }
        load_look(app, file);
        app->turns = (uint32_t)number_of(file, "turns", 1, STUDIO_TURNS, (float)app->turns);
        int width = (int)number_of(file, "width", 640, 16384, 0),
            height = (int)number_of(file, "height", 400, 16384, 0);
        if (width && height && !app->size[0])
            gtk_window_set_default_size(app->window, width, height);
    }
    g_free(path);
    g_key_file_free(file);
}

void studio_settings_save(studio_app *app) {
    GKeyFile *file = g_key_file_new();
    char *path = path_of(), *folder = g_path_get_dirname(path);
    gsize count = 0;
    int width, height;
    while (count < STUDIO_RECENT && app->recent[count])
        count++;
    gtk_window_get_default_size(app->window, &width, &height);
    g_key_file_set_string_list(file, "studio", "recent", (const char *const *)app->recent, count);
    const char *swatches[STUDIO_SWATCHES];
    gsize kept = 0;
    while (kept < STUDIO_SWATCHES && *app->swatches[kept]) {
        swatches[kept] = app->swatches[kept];
        kept++;
    }
    g_key_file_set_string_list(file, "studio", "swatches", swatches, kept);
    g_key_file_set_boolean(file, "studio", "dark", app->dark);
    g_key_file_set_double(file, "studio", "radius", (double)app->paint.radius);
    g_key_file_set_double(file, "studio", "opacity", (double)app->paint.opacity);
    g_key_file_set_double(file, "studio", "hardness", (double)app->paint.hardness);
    for (int c = 0; c < 3; c++) {
        g_key_file_set_double(file, "studio", colors[0][c], (double)app->paint.color[c]);
        g_key_file_set_double(file, "studio", colors[1][c], (double)app->paint.other[c]);
    }
    save_look(app, file);
    g_key_file_set_integer(file, "studio", "turns", (int)app->turns);
    if (!app->size[0]) {
        g_key_file_set_integer(file, "studio", "width", width);
        g_key_file_set_integer(file, "studio", "height", height);
    }
    /* without a place for them they are not kept, which harms nobody */
    if (g_mkdir_with_parents(folder, 0700) == 0)
        (void)g_key_file_save_to_file(file, path, NULL);
    g_free(folder);
    g_free(path);
    g_key_file_free(file);
}

void studio_settings_opened(studio_app *app, const char *path) {
    char *first = g_strdup(path), *carried = first;
    for (int i = 0; i < STUDIO_RECENT && carried; i++) {
        char *now = app->recent[i];
        app->recent[i] = carried;
        carried = now;
        if (now && strcmp(now, first) == 0) {
            g_free(now);
            carried = NULL;
        }
    }
    g_free(carried);
    show_recent(app);
}
