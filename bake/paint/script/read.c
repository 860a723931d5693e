/* The keys of a script's lines. */
#include "script/script_data.h"

#include "base/log.h"
#include "base/names.h"
#include "base/words.h"

#include <math.h>
#include <string.h>

static const char *const op_names[SLVI_SCRIPT_OPS] = {"stroke", "fill", "set"};

static bool read_flag(json_t *value, bool *out) {
    *out = json_is_true(value);
    return json_is_boolean(value);
}

static slv_result read_op(slvi_reading *r, const char *key, json_t *value) {
    int op;
    if (!slvi_name_find(op_names, SLVI_SCRIPT_OPS, json_string_value(value), &op))
        return slvi_script_wrong(r, key, "stroke, fill or set");
    r->line->op = (slvi_script_op)op;
    return SLV_OK;
}

static slv_result read_brush(slvi_reading *r, const char *key, json_t *value) {
    (void)key;
    return slvi_script_brush_of(r->script, r->number, value, &r->line->stroke.brush);
}

static slv_result read_radius(slvi_reading *r, const char *key, json_t *value) {
    return slvi_script_number(value, 1e-18, 1e18, &r->line->stroke.radius)
               ? SLV_OK
               : slvi_script_wrong(r, key, "a number, more than 0 and at most 1e18");
}

static slv_result read_unit(slvi_reading *r, const char *key, json_t *value) {
    return slv_size_unit_from_name(json_string_value(value), &r->line->stroke.unit)
               ? SLV_OK
               : slvi_script_wrong(r, key, "world, pixels or texels");
}

static slv_result read_color(slvi_reading *r, const char *key, json_t *value) {
    slv_paint *paint = &r->line->stroke.paint;
    memset(paint->color, 0, sizeof paint->color);
    if (!slvi_script_numbers(value, 1, SLV_PAINT_CHANNELS, paint->color))
        return slvi_script_wrong(r, key, "1 to 8 numbers, as the texture stores them");
    for (size_t c = 0; c < json_array_size(value); c++)
        if (r->script->params.integers && !(paint->color[c] >= 0 && paint->color[c] <= 1)) {
            slvi_logf(&r->script->env, SLV_LOG_WARNING,
                      "%s: line %llu: color: %g becomes %d: numbers go from 0 to 1 here",
                      r->script->name, (unsigned long long)r->number, (double)paint->color[c],
                      paint->color[c] > 1);
            break;
        }
    for (size_t c = json_array_size(value); c < SLV_PAINT_CHANNELS; c++)
        paint->color[c] = 1; /* alpha, where it is not given */
    return SLV_OK;
}

static slv_result read_opacity(slvi_reading *r, const char *key, json_t *value) {
    return slvi_script_number(value, 0, 1, &r->line->stroke.paint.opacity)
               ? SLV_OK
               : slvi_script_wrong(r, key, "a number from 0 to 1");
}

static slv_result read_blend(slvi_reading *r, const char *key, json_t *value) {
    return slv_blend_from_name(json_string_value(value), &r->line->stroke.paint.blend)
               ? SLV_OK
               : slvi_script_wrong(
                     r, key,
                     "normal, multiply, screen, overlay, darken, lighten, add, color, replace or "
                     "subtract");
}

static slv_result read_erase(slvi_reading *r, const char *key, json_t *value) {
    return read_flag(value, &r->line->stroke.paint.erase)
               ? SLV_OK
               : slvi_script_wrong(r, key, "true or false");
}

static slv_result read_lock(slvi_reading *r, const char *key, json_t *value) {
    return read_flag(value, &r->line->stroke.paint.lock_alpha)
               ? SLV_OK
               : slvi_script_wrong(r, key, "true or false");
}

static slv_result read_channels(slvi_reading *r, const char *key, json_t *value) {
    float range[2];
    if (!slvi_script_numbers(value, 2, 2, range) || !json_is_integer(json_array_get(value, 0)) ||
        !json_is_integer(json_array_get(value, 1)) || !(range[0] >= 0 && range[0] < 65536) ||
        !(range[1] >= 0 && range[1] <= SLV_PAINT_CHANNELS))
        return slvi_script_wrong(r, key, "the first channel and how many, 1 to 8");
    if (range[0] + range[1] > (float)r->script->nchannels || range[0] >= r->script->nchannels)
        return slvi_fail(&r->script->env, SLV_ERROR_FORMAT,
                         "%s: line %llu: %s: there are no channels %g to %g, the last is %u",
                         r->script->name, (unsigned long long)r->number, key, (double)range[0],
                         (double)(range[0] + fmaxf(range[1], 1) - 1), r->script->nchannels - 1);
    r->line->stroke.paint.first_channel = (uint32_t)range[0];
    r->line->stroke.paint.nchannels = (uint32_t)range[1];
    return SLV_OK;
}

static slv_result read_size(slvi_reading *r, const char *key, json_t *value) {
    float size[2];
    if (!slvi_script_numbers(value, 2, 2, size) || !(size[0] >= 1 && size[0] <= 65536) ||
        !(size[1] >= 1 && size[1] <= 65536))
        return slvi_script_wrong(r, key, "the picture's width and height in pixels");
    r->line->stroke.width = (uint32_t)size[0];
    r->line->stroke.height = (uint32_t)size[1];
    return SLV_OK;
}

static slv_result read_camera(slvi_reading *r, const char *key, json_t *value) {
    if (json_is_null(value)) {
        r->line->stroke.in_picture = false;
        return SLV_OK;
    }
    r->line->camera = value;
    return json_is_object(value) ? SLV_OK : slvi_script_wrong(r, key, "an object, or null");
}

static slv_result read_project(slvi_reading *r, const char *key, json_t *value) {
    return read_flag(value, &r->line->stroke.project) ? SLV_OK
                                                      : slvi_script_wrong(r, key, "true or false");
}

static slv_result read_blur(slvi_reading *r, const char *key, json_t *value) {
    return slvi_script_number(value, 0, 16, &r->line->stroke.blur)
               ? SLV_OK
               : slvi_script_wrong(r, key, "0 to 16 radii");
}

static slv_result read_mirror(slvi_reading *r, const char *key, json_t *value) {
    static const char *const known[] = {"point", "normal"};
    slvi_line *line = r->line;
    size_t count = json_array_size(value);
    if ((!json_is_array(value) && !json_is_null(value)) || count > SLV_MIRRORS)
        return slvi_script_wrong(r, key, "a list of up to 3 planes, or null");
    for (size_t i = 0; i < count; i++) {
        json_t *plane = json_array_get(value, i);
        if (!slvi_script_knows(plane, known, SLVI_COUNT(known)) ||
            !slvi_script_numbers(json_object_get(plane, "point"), 3, 3, line->mirrors[i].point) ||
            !slvi_script_numbers(json_object_get(plane, "normal"), 3, 3, line->mirrors[i].normal))
            return slvi_script_wrong(r, key,
                                     "planes with a point and a normal, three numbers each");
        const float *n = line->mirrors[i].normal;
        if (!(fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]) > 0))
            return slvi_script_wrong(r, key, "normals of some length");
    }
    line->stroke.nmirrors = (uint32_t)count;
    return SLV_OK;
}

static slv_result read_samples(slvi_reading *r, const char *key, json_t *value) {
    r->line->samples = value;
    return json_is_array(value) && json_array_size(value)
               ? SLV_OK
               : slvi_script_wrong(r, key, "a list of samples");
}

static slv_result read_face(slvi_reading *r, const char *key, json_t *value) {
    json_int_t face = json_integer_value(value);
    if (!json_is_integer(value) || face < 0 || (uint64_t)face >= r->script->nfaces)
        return slvi_fail(&r->script->env, SLV_ERROR_FORMAT,
                         "%s: line %llu: %s: expected the number of a face, of %u that there are",
                         r->script->name, (unsigned long long)r->number, key, r->script->nfaces);
    r->line->face = face;
    return SLV_OK;
}

static slv_result read_select(slvi_reading *r, const char *key, json_t *value) {
    const char *name = json_string_value(value);
    r->line->by_color = name && strcmp(name, "color") == 0;
    return r->line->by_color || slv_select_from_name(json_string_value(value), &r->line->select)
               ? SLV_OK
               : slvi_script_wrong(r, key, "face, connected, angle or color");
}

static slv_result read_degrees(slvi_reading *r, const char *key, json_t *value) {
    return slvi_script_number(value, 0, 180, &r->line->degrees)
               ? SLV_OK
               : slvi_script_wrong(r, key, "a number from 0 to 180");
}

static slv_result read_at(slvi_reading *r, const char *key, json_t *value) {
    float *at = r->line->at;
    return slvi_script_numbers(value, 2, 2, at) && at[0] >= 0 && at[0] <= 1 && at[1] >= 0 &&
                   at[1] <= 1
               ? SLV_OK
               : slvi_script_wrong(r, key, "[u, v], 0 to 1");
}

static slv_result read_tolerance(slvi_reading *r, const char *key, json_t *value) {
    return slvi_script_number(value, 0, 1e18, &r->line->tolerance)
               ? SLV_OK
               : slvi_script_wrong(r, key, "a number, 0 or more");
}

static const struct {
    const char *key;
    slv_result (*read)(slvi_reading *r, const char *key, json_t *value);
} keys[] = {{"op", read_op},
            {"brush", read_brush},
            {"radius", read_radius},
            {"unit", read_unit},
            {"color", read_color},
            {"opacity", read_opacity},
            {"blend", read_blend},
            {"erase", read_erase},
            {"lock_alpha", read_lock},
            {"channels", read_channels},
            {"size", read_size},
            {"camera", read_camera},
            {"project", read_project},
            {"blur", read_blur},
            {"mirror", read_mirror},
            {"samples", read_samples},
            {"face", read_face},
            {"select", read_select},
            {"degrees", read_degrees},
            {"at", read_at},
            {"tolerance", read_tolerance},
            {"stamp", slvi_script_read_stamp},
            {"image", slvi_script_read_image},
            {"gradient", slvi_script_read_gradient},
            {"clone", slvi_script_read_clone},
            {"where", slvi_script_read_where},
            {"symmetry", slvi_script_read_symmetry}};

/* Whether a camera has three directions, and a window of some size. */
static bool sees(const slv_camera *c) {
    const float *m = c->world_to_camera;
    double volume = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        volume += (double)m[i] *
                  ((double)m[4 + j] * (double)m[8 + k] - (double)m[4 + k] * (double)m[8 + j]);
    }
    return fabs(volume) > 0 && isfinite(volume) && c->window[0] != c->window[1] &&
           c->window[2] != c->window[3];
}

/* A matrix and a window, as in slv_camera; or an orbit around the surface. */
static slv_result make_camera(const slvi_reading *r) {
    slv_stroke_params *s = &r->line->stroke;
    json_t *camera = r->line->camera, *matrix = json_object_get(camera, "world_to_camera");
    float azimuth = 30, elevation = 20, fov = 35, low[3], high[3];
    static const char *const by_matrix[] = {"world_to_camera", "window", "perspective"},
                             *const by_orbit[] = {"azimuth", "elevation", "fov"};
    s->in_picture = true;
    if (!(matrix ? slvi_script_knows(camera, by_matrix, SLVI_COUNT(by_matrix))
                 : slvi_script_knows(camera, by_orbit, SLVI_COUNT(by_orbit))))
        return slvi_script_wrong(r, "camera",
                                 "world_to_camera, window and perspective, or azimuth, elevation "
                                 "and fov");
    if (!s->width || !s->height)
        return slvi_script_wrong(r, "camera", "a size of the picture beside it");
    if (matrix) {
        json_t *perspective = json_object_get(camera, "perspective");
        s->camera.perspective = json_is_true(perspective);
        return (!perspective || json_is_boolean(perspective)) &&
                       slvi_script_numbers(matrix, 16, 16, s->camera.world_to_camera) &&
                       slvi_script_numbers(json_object_get(camera, "window"), 4, 4,
                                           s->camera.window) &&
                       sees(&s->camera)
                   ? SLV_OK
                   : slvi_script_wrong(r, "camera",
                                       "world_to_camera of 16 numbers that turn and move, window "
                                       "of 4 with an area, and perspective true or false");
    }
    const struct {
        const char *key;
        float *value;
        double least, most;
        const char *expected;
    } angles[] = {{"azimuth", &azimuth, -360, 360, "degrees, -360 to 360"},
                  {"elevation", &elevation, -90, 90, "degrees, -90 to 90"},
                  {"fov", &fov, -170, 170, "degrees, up to 170; 0 is for parallel rays"}};
    for (size_t i = 0; i < SLVI_COUNT(angles); i++) {
        json_t *value = json_object_get(camera, angles[i].key);
        if (value && !slvi_script_number(value, angles[i].least, angles[i].most, angles[i].value))
            return slvi_script_wrong(r, angles[i].key, angles[i].expected);
    }
    slv_paint_surface_bounds(slv_painter_get_surface(r->script->painter), low, high);
    s->camera =
        slv_camera_orbit(low, high, azimuth, elevation, fov, (float)s->width / (float)s->height);
    return SLV_OK;
}

slv_result slvi_script_read(slv_script *script, uint64_t number, json_t *root, slvi_line *out) {
    slvi_reading r = {script, number, out};
    const char *key;
    json_t *value;
    slv_result result;
    if (!json_is_object(root))
        return slvi_script_wrong(&r, "line", "an object");
    out->camera = out->samples = NULL;
    out->face = -1;
    out->op = SLVI_SCRIPT_STROKE;
    json_object_foreach(root, key, value) {
        size_t i = 0;
        while (i < SLVI_COUNT(keys) && strcmp(keys[i].key, key) != 0)
            i++;
        if (i == SLVI_COUNT(keys)) {
            char known[512] = "", hint[SLV_WORDS_HINT];
            for (i = 0; i < SLVI_COUNT(keys); i++)
                slvi_words_add(known, sizeof known, keys[i].key);
            return slvi_fail(&script->env, SLV_ERROR_FORMAT, "%s: line %llu: unknown key '%.40s'%s",
                             script->name, (unsigned long long)number, key,
                             slv_words_hint(key, known, hint));
        }
        if ((result = keys[i].read(&r, key, value)))
            return result;
    }
    if (out->camera && (result = make_camera(&r)))
        return result;
    if (out->op != SLVI_SCRIPT_SET && (result = slvi_script_finish_lay(&r)))
        return result;
    if (out->samples && out->op != SLVI_SCRIPT_STROKE)
        return slvi_script_wrong(&r, "samples", "a stroke, which has \"op\": \"stroke\" or none");
    if (json_object_get(root, "face") && out->op == SLVI_SCRIPT_STROKE)
        return slvi_script_wrong(&r, "face", "a fill, which has \"op\": \"fill\"");
    if (out->op == SLVI_SCRIPT_STROKE && out->stroke.project && !out->stroke.in_picture)
        return slvi_script_wrong(&r, "project", "a camera and a size of the picture beside it");
    if (out->op == SLVI_SCRIPT_STROKE && !out->stroke.in_picture &&
        out->stroke.unit == SLV_SIZE_PIXELS)
        return slvi_script_wrong(&r, "unit", "world or texels: there is no picture with pixels");
    if (out->op == SLVI_SCRIPT_STROKE && !out->stroke.in_picture && !(out->stroke.radius > 0))
        return slvi_script_wrong(&r, "radius", "one, as there is no picture that a brush is for");
    if (out->op == SLVI_SCRIPT_FILL && out->face < 0)
        return slvi_script_wrong(&r, "face", "the face that a fill begins at");
    return SLV_OK;
}

slv_result slvi_script_sample(const slv_script *script, uint64_t number, const slvi_line *line,
                              size_t index, slv_stroke_sample *out) {
    json_t *list = json_array_get(line->samples, index);
    size_t place = line->stroke.in_picture ? 2 : 3;
    float v[8] = {0}; /* face u v, or x y; pressure, time, tilt x and y */
    double time = json_number_value(json_array_get(list, place + 1));
    bool fine = slvi_script_numbers(list, place, place + 4, v);
    *out = (slv_stroke_sample){.pressure = json_array_size(list) > place ? v[place]
                                                                         : 1, /* as a mouse does */
                               .time = time,
                               .tilt_x = v[place + 2],
                               .tilt_y = v[place + 3]};
    if (line->stroke.in_picture) {
        out->x = v[0];
        out->y = v[1];
    } else {
        json_int_t face = json_integer_value(json_array_get(list, 0));
        fine = fine && json_is_integer(json_array_get(list, 0)) && face >= 0 &&
               (uint64_t)face < script->nfaces && v[1] >= 0 && v[1] <= 1 && v[2] >= 0 && v[2] <= 1;
        out->at = (slv_surface_point){(int32_t)face, v[1], v[2]};
    }
    fine = fine && out->pressure >= 0 && out->pressure <= 1 && fabsf(out->tilt_x) <= 1 &&
           fabsf(out->tilt_y) <= 1;
    if (fine)
        return SLV_OK;
    return slvi_fail(&script->env, SLV_ERROR_FORMAT,
                     "%s: line %llu: sample %zu: expected %s, pressure, time, tilt x, tilt y]; "
                     "of %u faces, u, v and pressures from 0 to 1, tilts from -1 to 1",
                     script->name, (unsigned long long)number, index,
                     line->stroke.in_picture ? "[x, y" : "[face, u, v", script->nfaces);
}
