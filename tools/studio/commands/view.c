/* Actions of the view: camera, look, comparison. */
#include "studio/commands/commands.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const studio_tool_names[STUDIO_TOOLS] = {
    "view", "paint", "erase", "fill", "gradient", "pick", "select", "stencil", "texels"};

static uint32_t word_of(const char *const *names, uint32_t count, const char *word,
                        uint32_t otherwise) {
    for (uint32_t i = 0; i < count; i++)
        if (strcmp(names[i], word) == 0)
            return i;
    return otherwise;
}

/* The picture is another. */
static void changed(studio_app *app) {
    studio_area_redraw(app, false);
}

/* ---- the camera ---- */

void studio_do_frame(studio_app *app, const char *target) {
    (void)target;
    app->framed = false;
    changed(app);
}

static void look_from(studio_app *app, float azimuth, float elevation) {
    app->camera.azimuth = azimuth;
    app->camera.elevation = elevation;
    changed(app);
}

void studio_do_front(studio_app *app, const char *target) {
    (void)target;
    look_from(app, 0, 0);
}

void studio_do_right(studio_app *app, const char *target) {
    (void)target;
    look_from(app, 90, 0);
}

void studio_do_top(studio_app *app, const char *target) {
    (void)target;
    look_from(app, 0, 90);
}

void studio_do_orthographic(studio_app *app, const char *target) {
    (void)target;
    app->camera.orthographic = !app->camera.orthographic;
    changed(app);
}

const char *studio_get_orthographic(const studio_app *app) {
    return app->camera.orthographic ? "on" : NULL;
}

void studio_do_bookmark(studio_app *app, const char *target) {
    int i = atoi(target) - 1;
    if (i < 0 || i >= STUDIO_BOOKMARKS)
        return;
    if (!app->bookmarked[i]) {
        studio_say(app, "There is no such bookmark yet: Shift and its key set it.", NULL, NULL);
        return;
    }
    app->camera = app->bookmarks[i];
    changed(app);
}

void studio_do_bookmark_set(studio_app *app, const char *target) {
    int i = atoi(target) - 1;
    if (i < 0 || i >= STUDIO_BOOKMARKS)
        return;
    app->bookmarks[i] = app->camera;
    app->bookmarked[i] = true;
}

/* ---- the look ---- */

void studio_do_brighter(studio_app *app, const char *target) {
    (void)target;
    app->look.exposure = fminf(app->look.exposure + 0.25f, STUDIO_EXPOSURE);
    changed(app);
}

void studio_do_darker(studio_app *app, const char *target) {
    (void)target;
    app->look.exposure = fmaxf(app->look.exposure - 0.25f, -STUDIO_EXPOSURE);
    changed(app);
}

void studio_set_encoding(studio_app *app, const char *target) {
    app->look.encoding = (studio_encoding)word_of(studio_encoding_names, STUDIO_ENCODINGS, target,
                                                  app->look.encoding);
    if (!studio_document_is_data(&app->document))
        app->encoding = app->look.encoding;
    changed(app);
}

const char *studio_get_encoding(const studio_app *app) {
    return studio_encoding_names[app->look.encoding];
}

void studio_set_shading(studio_app *app, const char *target) {
    slv_shading shading;
    if (!slv_shading_from_name(target, &shading))
        return;
    if (shading == SLV_SHADE_IMAGE && !app->light_path && !app->light_kept) {
        studio_do_light(app, "");
        return;
    }
    app->look.shading = shading;
    studio_light_recall(app);
    changed(app);
}

const char *studio_get_shading(const studio_app *app) {
    return slv_shading_name(app->look.shading);
}

/* Colours, then each channel by itself, then colours again. */
void studio_do_channel(studio_app *app, const char *target) {
    uint32_t count = slv_texture_get_desc(app->document.texture)->nchannels;
    (void)target;
    app->look.channel = app->look.channel >= count ? 0 : app->look.channel + 1;
    changed(app);
}

void studio_set_overlay(studio_app *app, const char *target) {
    app->look.overlay =
        (studio_overlay)word_of(studio_overlay_names, STUDIO_OVERLAYS, target, app->look.overlay);
    changed(app);
}

void studio_do_damaged_show(studio_app *app, const char *target) {
    (void)target;
    studio_set_overlay(app, "damaged");
}

const char *studio_get_overlay(const studio_app *app) {
    return studio_overlay_names[app->look.overlay];
}

void studio_do_seams(studio_app *app, const char *target) {
    (void)target;
    app->look.seams = !app->look.seams;
    changed(app);
}

const char *studio_get_seams(const studio_app *app) {
    return app->look.seams ? "on" : NULL;
}

void studio_do_wires(studio_app *app, const char *target) {
    (void)target;
    app->look.wires = !app->look.wires;
    changed(app);
}

const char *studio_get_wires(const studio_app *app) {
    return app->look.wires ? "on" : NULL;
}

static void set_segments(studio_app *app, bool more) {
    uint32_t now = app->look.segments ? app->look.segments : app->stats.segments;
    now = now ? now : 8;
    app->look.segments = more ? MIN(now * 2, 128) : MAX(now / 2, 2);
    changed(app);
}

void studio_do_segments_more(studio_app *app, const char *target) {
    (void)target;
    set_segments(app, true);
}

void studio_do_segments_fewer(studio_app *app, const char *target) {
    (void)target;
    set_segments(app, false);
}

void studio_set_anisotropy(studio_app *app, const char *target) {
    app->look.anisotropy = (uint32_t)CLAMP(atoi(target), 1, 16);
    changed(app);
}

const char *studio_get_anisotropy(const studio_app *app) {
    return app->look.anisotropy > 4 ? "16" : app->look.anisotropy > 1 ? "4" : "1";
}

void studio_do_even_levels(studio_app *app, const char *target) {
    (void)target;
    app->look.other_levels = !app->look.other_levels;
    changed(app);
}

const char *studio_get_even_levels(const studio_app *app) {
    return app->document.scene.even != app->look.other_levels ? "on" : NULL;
}

void studio_set_msaa(studio_app *app, const char *target) {
    app->look.msaa = atoi(target) > 4 ? 8 : atoi(target) > 1 ? 4 : 1;
    changed(app);
}

const char *studio_get_msaa(const studio_app *app) {
    return app->look.msaa > 4 ? "8" : app->look.msaa > 1 ? "4" : "1";
}

static void set_bias(studio_app *app, float by) {
    char text[64];
    app->look.level_bias = CLAMP(app->look.level_bias + by, -8, 8);
    snprintf(text, sizeof text, "Lookups take levels %+.1f from their own.",
             (double)app->look.level_bias);
    studio_say(app, app->look.level_bias != 0 ? text : NULL, "Reset", "bias-none");
    changed(app);
}

void studio_do_bias_up(studio_app *app, const char *target) {
    (void)target;
    set_bias(app, 0.5f);
}

void studio_do_bias_down(studio_app *app, const char *target) {
    (void)target;
    set_bias(app, -0.5f);
}

void studio_do_bias_none(studio_app *app, const char *target) {
    (void)target;
    set_bias(app, -app->look.level_bias);
}

void studio_do_dark(studio_app *app, const char *target) {
    (void)target;
    app->dark = !app->dark;
}

const char *studio_get_dark(const studio_app *app) {
    return app->dark ? "on" : NULL;
}

/* ---- strategies ---- */

static uint32_t strategy_of(const char *name, uint32_t otherwise) {
    for (uint32_t i = 0; i < slv_strategy_count(); i++)
        if (strcmp(slv_strategy_at(i)->name, name) == 0)
            return i;
    return otherwise;
}

void studio_set_strategy(studio_app *app, const char *target) {
    app->look.strategy = strategy_of(target, app->look.strategy);
    changed(app);
}

const char *studio_get_strategy(const studio_app *app) {
    return slv_strategy_at(app->look.strategy)->name;
}

static gboolean flicker(gpointer user) {
    studio_app *app = user;
    if (app->look.compare != STUDIO_FLICKER || app->closing) {
        app->flicker = 0;
        return G_SOURCE_REMOVE;
    }
    app->look.second = !app->look.second;
    studio_area_redraw(app, false);
    return G_SOURCE_CONTINUE;
}

void studio_set_compare(studio_app *app, const char *target) {
    app->look.compare =
        (studio_compare)word_of(studio_compare_names, STUDIO_COMPARES, target, app->look.compare);
    if (app->look.compare == STUDIO_FLICKER && app->flicker == 0) {
        app->flicker = g_timeout_add(500, flicker, app);
    }
    changed(app);
}

const char *studio_get_compare(const studio_app *app) {
    return studio_compare_names[app->look.compare];
}

void studio_do_other_next(studio_app *app, const char *target) {
    (void)target;
    app->look.other = (app->look.other + 1) % slv_strategy_count();
    changed(app);
}

void studio_do_seam_jump(studio_app *app, const char *target) {
    (void)target;
    studio_seam_ask(app);
}
