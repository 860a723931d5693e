/* Actions of what moves the surface: a file, a channel of the texture, how far. */
#include "studio/commands/commands.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void displace(studio_app *app, const displace_settings *settings) {
    char text[512];
    if (studio_failed(app, studio_document_displace(&app->document, settings)))
        return;
    const displace_settings *d = &app->document.displace;
    char *base = g_path_get_basename(d->texture);
    snprintf(text, sizeof text, "Moved by channel %s of %s: 1 is %.4g.", d->channel, base,
             (double)d->scale);
    studio_say(app, d->given ? text : NULL, d->given ? "Move Nothing" : NULL, "displace-none");
    g_free(base);
    studio_area_redraw(app, false);
}

/* A twentieth of what there is, until somebody says how far. */
static displace_settings settings_of(const studio_app *app, const char *path, uint32_t channel) {
    const float *low = app->document.scene.bounds_min, *high = app->document.scene.bounds_max;
    displace_settings d = {.given = true, .filter = {.filter = SLV_FILTER_BSPLINE, .lerp = true}};
    for (int c = 0; c < 3; c++)
        d.scale = fmaxf(d.scale, (high[c] - low[c]) / 20);
    snprintf(d.texture, sizeof d.texture, "%s", path);
    snprintf(d.channel, sizeof d.channel, "%u", channel);
    return d;
}

void studio_do_displace_path(studio_app *app, const char *target) {
    const displace_settings d = settings_of(app, target, 0);
    displace(app, &d);
}

static void chosen(studio_app *app, const char *path) {
    studio_actions_run(app, "displace-path", path);
}

void studio_do_displace(studio_app *app, const char *target) {
    (void)target;
    studio_choose_file(app, "A .ptx that moves the surface", GTK_FILE_CHOOSER_ACTION_OPEN, NULL,
                       chosen);
}

/* Each channel of the file that is open, then none. */
void studio_do_displace_channel(studio_app *app, const char *target) {
    const studio_document *d = &app->document;
    const uint32_t count = slv_texture_get_desc(d->texture)->nchannels;
    bool own = d->displace.given && d->path && strcmp(d->displace.texture, d->path) == 0;
    uint32_t channel = own ? 1 + (uint32_t)strtoul(d->displace.channel, NULL, 10) : 0;
    (void)target;
    if (d->kind != STUDIO_PTX) {
        studio_say(app, "A mesh or a session has no file of texels: choose one.", "Choose a .ptx",
                   "displace");
    } else if (channel >= count) {
        studio_do_displace_none(app, "");
    } else {
        const displace_settings settings = settings_of(app, d->path, channel);
        displace(app, &settings);
    }
}

static void scale(studio_app *app, float factor) {
    displace_settings d = app->document.displace;
    d.scale *= factor;
    if (d.given)
        displace(app, &d);
    else
        studio_say(app, "Nothing moves the surface.", "Choose a .ptx", "displace");
}

void studio_do_displace_more(studio_app *app, const char *target) {
    (void)target;
    scale(app, 1.25f);
}

void studio_do_displace_less(studio_app *app, const char *target) {
    (void)target;
    scale(app, 0.8f);
}

void studio_do_displace_none(studio_app *app, const char *target) {
    const displace_settings none = {0};
    (void)target;
    displace(app, &none);
}
