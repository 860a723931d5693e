/* Brushes: the numbers of a round one, and the files of MyPaint. */
#include "brush/brush_data.h"

#include "base/file.h"
#include "base/json.h"
#include "base/log.h"
#include "base/memory.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

#define MOST_BYTES (UINT64_C(4) << 20)
enum { MOST_UNKNOWN = 256, ROUND_RADIUS = 20 };

void slv_brush_destroy(slv_brush *brush) {
    if (!brush)
        return;
    for (uint32_t i = 0; i < brush->nunknown; i++)
        slvi_free(brush->unknown[i]);
    slvi_free(brush->unknown);
    slvi_free(brush->base);
    slvi_free(brush->curves);
    slvi_free(brush);
}

uint32_t slv_brush_unknown(const slv_brush *brush, const char *const **names) {
    if (names)
        *names = (const char *const *)(void *)brush->unknown;
    return brush->nunknown;
}

float slv_brush_radius(const slv_brush *brush) {
    return brush->radius;
}

slv_result slv_brush_create(const slv_env *env, const slv_brush_params *params, slv_brush **out) {
    slv_brush *brush = NULL;
    const slv_brush_params none = {0};
    const slv_brush_params *p = params ? params : &none;
    *out = NULL;
    if (!(p->hardness >= 0 && p->hardness <= 1) || !(p->spacing >= 0 && p->spacing <= 1000) ||
        !(p->aspect == 0 || (p->aspect >= 1 && p->aspect <= 1000)) || !isfinite(p->angle) ||
        !(p->pressure_radius >= 0 && p->pressure_radius <= 1) ||
        !(p->pressure_opacity >= 0 && p->pressure_opacity <= 1))
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "brush: hardness %g, spacing %g, aspect %g, angle %g, pressure %g and %g: "
                         "one is out of range",
                         (double)p->hardness, (double)p->spacing, (double)p->aspect,
                         (double)p->angle, (double)p->pressure_radius, (double)p->pressure_opacity);
    slv_result result = slvi_alloc(env, "brush", 1, sizeof *brush, &brush);
    if (result)
        return result;
    brush->env = slvi_env_or_default(env);
    brush->round = *p;
    brush->round.hardness = p->hardness > 0 ? p->hardness : 0.5f;
    brush->round.spacing = p->spacing > 0 ? fmaxf(p->spacing, 0.01f) : 0.2f;
    brush->round.aspect = p->aspect > 1 ? p->aspect : 1;
    brush->radius = ROUND_RADIUS;
    *out = brush;
    return SLV_OK;
}

static slv_result note_unknown(slv_brush *brush, const char *setting, const char *input) {
    char text[128];
    if (brush->nunknown == MOST_UNKNOWN)
        return SLV_OK;
    snprintf(text, sizeof text, input ? "%s: %s" : "%s", setting, input);
    slv_result result = slvi_grow(&brush->env, "brush", (uint64_t)brush->nunknown + 1,
                                  sizeof *brush->unknown, &brush->unknown);
    if (!result)
        result =
            slvi_alloc(&brush->env, "brush", strlen(text) + 1, 1, &brush->unknown[brush->nunknown]);
    if (!result)
        strcpy(brush->unknown[brush->nunknown++], text);
    return result;
}

static float keep_within(double value, float low, float high) {
    return value > (double)low ? (value < (double)high ? (float)value : high) : low;
}

static slv_result read_curve(slv_brush *brush, const char *name, int setting, const char *input,
                             json_t *points) {
    slvi_brush_curve curve = {setting, slvi_mypaint_input(input), 0, {0}};
    if (curve.input < 0)
        return note_unknown(brush, name, input);
    size_t count = json_array_size(points);
    if (count == 0)
        return SLV_OK;
    if (count == 1 || count > SLVI_BRUSH_POINTS)
        return note_unknown(brush, name, input);
    for (size_t i = 0; i < count; i++) {
        json_t *point = json_array_get(points, i);
        json_t *x = json_array_get(point, 0), *y = json_array_get(point, 1);
        if (!json_is_number(x) || !json_is_number(y))
            return note_unknown(brush, name, input);
        float at = keep_within(json_number_value(x), -1e6f, 1e6f);
        if (i && at < curve.points[2 * i - 2])
            return note_unknown(brush, name, input);
        curve.points[2 * i] = at;
        curve.points[2 * i + 1] = keep_within(json_number_value(y), -1000, 1000);
    }
    curve.count = (int)count;
    slv_result result = slvi_grow(&brush->env, "brush", (uint64_t)brush->ncurves + 1,
                                  sizeof *brush->curves, &brush->curves);
    if (!result)
        brush->curves[brush->ncurves++] = curve;
    return result;
}

static slv_result read_settings(slv_brush *brush, json_t *settings) {
    const char *name, *input;
    json_t *setting, *points;
    slv_result result = SLV_OK;
    json_object_foreach(settings, name, setting) {
        int id = slvi_mypaint_setting(name);
        json_t *base = json_object_get(setting, "base_value");
        if (id < 0 || !json_is_number(base)) {
            if ((result = note_unknown(brush, name, NULL)))
                return result;
            continue;
        }
        float low, standard, high;
        slvi_mypaint_range(id, &low, &standard, &high);
        brush->base[id] = keep_within(json_number_value(base), low, high);
        json_object_foreach(
            json_object_get(setting, "inputs"), input,
            points) if ((result = read_curve(brush, name, id, input, points))) return result;
    }
    return SLV_OK;
}

/* What a file does not name is as libmypaint has it by default: of the curves there is one. */
static slv_result add_default_curve(slv_brush *brush, json_t *settings) {
    if (json_object_get(settings, "opaque_multiply"))
        return SLV_OK;
    json_t *line = json_pack("[[i,i],[i,i]]", 0, 0, 1, 1);
    slv_result result = read_curve(brush, "opaque_multiply",
                                   slvi_mypaint_setting("opaque_multiply"), "pressure", line);
    json_decref(line);
    return result;
}

static slv_result read_file(slv_brush *brush, const char *name, const char *text, size_t size) {
    json_error_t error;
    json_t *root;
    slv_result result = slvi_json_load(text, size, 0, &root, &error);
    if (result == SLV_ERROR_MEMORY)
        return slvi_fail(&brush->env, result, "%s: no memory to read it", name);
    if (result)
        return slvi_fail(&brush->env, SLV_ERROR_FORMAT, "%s: line %d: %s", name, error.line,
                         error.text);
    json_t *settings = json_object_get(root, "settings"),
           *version = json_object_get(root, "version");
    if (!json_is_object(settings))
        result = slvi_fail(&brush->env, SLV_ERROR_FORMAT, "%s: there are no settings in it", name);
    else if (!json_is_integer(version) || json_integer_value(version) != 3)
        result = slvi_fail(&brush->env, SLV_ERROR_UNSUPPORTED, "%s: expected a brush of version 3",
                           name);
    int count = slvi_mypaint_settings();
    if (!result)
        result = slvi_alloc(&brush->env, "brush", (uint64_t)count, sizeof(float), &brush->base);
    for (int i = 0; i < count && !result; i++) {
        float low, high;
        slvi_mypaint_range(i, &low, &brush->base[i], &high);
    }
    if (!result)
        result = read_settings(brush, settings);
    if (!result)
        result = add_default_curve(brush, settings);
    json_decref(root);
    return result;
}

slv_result slv_brush_parse(const slv_env *env, const char *name, const char *text, size_t size,
                           slv_brush **out) {
    slv_brush *brush = NULL;
    *out = NULL;
    if (!slvi_mypaint_settings())
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED,
                         "%s: brushes of MyPaint take a build with libmypaint", name);
    if (size > MOST_BYTES)
        return slvi_fail(env, SLV_ERROR_LIMIT, "%s: %zu bytes are too many for a brush", name,
                         size);
    slv_result result = slvi_alloc(env, "brush", 1, sizeof *brush, &brush);
    if (result)
        return result;
    brush->env = slvi_env_or_default(env);
    brush->is_file = true;
    if ((result = read_file(brush, name, text, size))) {
        slv_brush_destroy(brush);
        return result;
    }
    brush->radius = slvi_mypaint_radius(brush);
    *out = brush;
    return SLV_OK;
}

slv_result slv_brush_load(const slv_env *env, const char *path, slv_brush **out) {
    char *text = NULL;
    size_t size;
    *out = NULL;
    slv_result result = slvi_file_read(env, path, &text, &size);
    if (!result)
        result = slv_brush_parse(env, path, text, size, out);
    slvi_free(text);
    return result;
}
