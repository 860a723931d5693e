/* Lines of strokes and fills, and files of brushes. */
#include "studio/brush/brush.h"

#include <dirent.h>
#include <jansson.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { DEEPEST = 4, MOST = 4096 };

static bool add_brush(studio_brushes *brushes, const char *name, const char *path) {
    studio_brush *list = realloc(brushes->list, (brushes->count + 1) * sizeof *list);
    if (!list)
        return false;
    brushes->list = list;
    list[brushes->count] = (studio_brush){strdup(name), path ? strdup(path) : NULL};
    if (!list[brushes->count].name || (path && !list[brushes->count].path))
        return false;
    brushes->count++;
    return true;
}

/* Files of a folder and of those in it; the name has the last folder's in it. */
static void find_in(studio_brushes *brushes, const char *folder, int depth) {
    DIR *stream = depth < DEEPEST ? opendir(folder) : NULL;
    const char *last = strrchr(folder, '/');
    for (struct dirent *entry; stream && (entry = readdir(stream)) && brushes->count < MOST;) {
        char path[PATH_MAX], name[512];
        struct stat status;
        size_t length = strlen(entry->d_name);
        if (entry->d_name[0] == '.' ||
            snprintf(path, sizeof path, "%s/%s", folder, entry->d_name) >= (int)sizeof path ||
            stat(path, &status) != 0)
            continue;
        if (S_ISDIR(status.st_mode)) {
            find_in(brushes, path, depth + 1);
        } else if (cli_ends_with(entry->d_name, ".myb")) {
            snprintf(name, sizeof name, "%.*s (%.200s)", (int)(length - 4), entry->d_name,
                     last ? last + 1 : folder);
            for (char *c = name; *c; c++)
                *c = *c == '_' ? ' ' : *c;
            if (!add_brush(brushes, name, path))
                break;
        }
    }
    if (stream)
        closedir(stream);
}

/* Those of the older version first, which all libraries of MyPaint's know. */
static int by_name(const void *a, const void *b) {
    const studio_brush *x = a, *y = b;
    int names = strcmp(x->name, y->name);
    return names ? names : strcmp(x->path, y->path);
}

/* Of one name the first: both versions may be installed. */
static void drop_repeated(studio_brushes *brushes) {
    uint32_t kept = 1;
    for (uint32_t i = 1; i < brushes->count; i++) {
        studio_brush *brush = &brushes->list[i];
        if (strcmp(brush->name, brushes->list[kept - 1].name) != 0) {
            brushes->list[kept++] = *brush;
        } else {
            free(brush->name);
            free(brush->path);
        }
    }
    brushes->count = kept;
}

void studio_brushes_find(studio_brushes *brushes) {
    const char *dirs = getenv("XDG_DATA_DIRS");
    char all[4096], path[PATH_MAX], *save = NULL;
    *brushes = (studio_brushes){0};
    if (!add_brush(brushes, "round", NULL))
        return;
    snprintf(all, sizeof all, "%s", dirs && *dirs ? dirs : "/usr/local/share:/usr/share");
    for (char *dir = strtok_r(all, ":", &save); dir; dir = strtok_r(NULL, ":", &save))
        for (int version = 1; version <= 2; version++) {
            snprintf(path, sizeof path, "%s/mypaint-data/%d.0/brushes", dir, version);
            find_in(brushes, path, 0);
        }
    qsort(brushes->list + 1, brushes->count - 1, sizeof *brushes->list, by_name);
    drop_repeated(brushes);
}

void studio_brushes_free(studio_brushes *brushes) {
    for (uint32_t i = 0; i < brushes->count; i++) {
        free(brushes->list[i].name);
        free(brushes->list[i].path);
    }
    free(brushes->list);
    *brushes = (studio_brushes){0};
}

void studio_swatches_default(studio_swatch list[STUDIO_SWATCHES]) {
    static const studio_swatch some[] = {"#000000", "#ffffff", "#808080", "#cc261a",
                                         "#e6a117", "#3f9142", "#2a6fbb", "#7a4b2a"};
    memset(list, 0, STUDIO_SWATCHES * sizeof *list);
    memcpy(list, some, sizeof some);
}

void studio_swatches_add(studio_swatch list[STUDIO_SWATCHES], const float color[3]) {
    studio_swatch added;
    int at = 0;
    unsigned byte[3];
    for (int c = 0; c < 3; c++)
        byte[c] = (unsigned)(fminf(fmaxf(color[c], 0), 1) * 255 + 0.5f);
    snprintf(added, sizeof added, "#%02x%02x%02x", byte[0] & 255, byte[1] & 255, byte[2] & 255);
    while (at < STUDIO_SWATCHES - 1 && *list[at] && strcmp(list[at], added) != 0)
        at++;
    memmove(list + 1, list, (size_t)at * sizeof *list);
    memcpy(list[0], added, sizeof added);
}

studio_paint studio_paint_default(void) {
    return (studio_paint){.radius = 20,
                          .opacity = 1,
                          .hardness = 0.5f,
                          .color = {0.8f, 0.15f, 0.1f},
                          .other = {1, 1, 1}};
}

static float to_light(float s) {
    return s <= 0.04045f ? s / 12.92f : powf((s + 0.055f) / 1.055f, 2.4f);
}

static float from_light(float l) {
    return l <= 0.0031308f ? 12.92f * l : 1.055f * powf(l, 1 / 2.4f) - 0.055f;
}

void studio_paint_color(const studio_document *d, const float rgb[3], bool to_texels,
                        float out[3]) {
    bool light =
        d->texture && slv_texture_get_encoding(d->texture, SLV_TEXTURE_AUTO) == SLV_TEXTURE_LINEAR;
    for (int c = 0; c < 3; c++) {
        float value = fminf(fmaxf(rgb[c], 0), 1);
        out[c] = !light ? value : to_texels ? to_light(value) : from_light(value);
    }
}

static json_t *numbers(const float *values, int count) {
    json_t *list = json_array();
    for (int i = 0; i < count; i++)
        json_array_append_new(list, json_real((double)values[i]));
    return list;
}

static uint32_t colors_of(const studio_document *d) {
    const slv_texture_desc *desc = slv_texture_get_desc(d->texture);
    return desc->nchannels - (desc->alpha_channel != SLV_NO_ALPHA);
}

/* Of a texture with more than three colours the first three, with fewer their brightness. */
static json_t *put_color(const studio_document *d, const float rgb[3]) {
    const uint32_t colors = colors_of(d);
    float color[3];
    studio_paint_color(d, rgb, true, color);
    if (colors < 3)
        color[0] = color[1] = 0.2126f * color[0] + 0.7152f * color[1] + 0.0722f * color[2];
    return numbers(color, colors < 3 ? (int)colors : 3);
}

static void put_paint(json_t *line, const studio_paint *paint, const studio_document *d) {
    json_object_set_new(line, "color", put_color(d, paint->color));
    if (colors_of(d) > 3)
        json_object_set_new(line, "channels", json_pack("[i, i]", 0, 3));
    json_object_set_new(line, "opacity", json_real((double)paint->opacity));
    json_object_set_new(line, "blend", json_string(slv_blend_name(paint->blend)));
    json_object_set_new(line, "erase", json_boolean(paint->erase));
    json_object_set_new(line, "lock_alpha", json_boolean(paint->lock_alpha));
}

/* What is of the picture alone. */
static void put_picture(json_t *line, const studio_paint *paint, const slv_camera *camera,
                        uint32_t width, uint32_t height) {
    const studio_stencil *stencil = &paint->stencil;
    json_object_set_new(line, "unit", json_string("pixels"));
    json_object_set_new(line, "size", json_pack("[i, i]", (int)width, (int)height));
    json_object_set_new(line, "camera",
                        json_pack("{s:o, s:o, s:b}", "world_to_camera",
                                  numbers(camera->world_to_camera, 16), "window",
                                  numbers(camera->window, 4), "perspective", camera->perspective));
    json_object_set_new(line, "project", json_boolean(paint->project));
    if (stencil->path)
        json_object_set_new(line, "image",
                            json_pack("{s:s, s:[f, f], s:f, s:f}", "file", stencil->path, "at",
                                      (double)(0.5f * (float)width + stencil->at[0]),
                                      (double)(0.5f * (float)height + stencil->at[1]), "width",
                                      (double)stencil->width, "angle", (double)stencil->angle));
}

char *studio_paint_line(const studio_paint *paint, const studio_document *d,
                        const slv_camera *camera, uint32_t width, uint32_t height) {
    json_t *line = json_object();
    put_paint(line, paint, d);
    if (paint->brush)
        json_object_set_new(line, "brush", json_string(paint->brush));
    else
        json_object_set_new(line, "brush",
                            json_pack("{s:f, s:f, s:f}", "hardness", (double)paint->hardness,
                                      "pressure_radius", (double)paint->pressure_radius,
                                      "pressure_opacity", (double)paint->pressure_opacity));
    json_object_set_new(line, "radius", json_real((double)paint->radius));
    if (camera)
        put_picture(line, paint, camera, width, height);
    if (paint->mirror) {
        float x = (d->scene.bounds_min[0] + d->scene.bounds_max[0]) / 2;
        json_object_set_new(line, "mirror",
                            json_pack("[{s:[f, f, f], s:[f, f, f]}]", "point", (double)x, 0.0, 0.0,
                                      "normal", 1.0, 0.0, 0.0));
    }
    char *text = json_dumps(line, JSON_COMPACT | JSON_REAL_PRECISION(17));
    json_decref(line);
    return text;
}

char *studio_fill_line(const studio_paint *paint, const studio_document *d, uint32_t face,
                       slv_select select, const studio_gradient *gradient) {
    json_t *line = json_pack("{s:s, s:i, s:s}", "op", "fill", "face", (int)face, "select",
                             slv_select_name(select));
    put_paint(line, paint, d);
    if (gradient)
        json_object_set_new(line, "gradient",
                            json_pack("{s:o, s:o, s:o, s:b}", "from", numbers(gradient->from, 3),
                                      "to", numbers(gradient->to, 3), "color",
                                      put_color(d, paint->other), "radial", gradient->radial));
    char *text = json_dumps(line, JSON_COMPACT | JSON_REAL_PRECISION(17));
    json_decref(line);
    return text;
}
