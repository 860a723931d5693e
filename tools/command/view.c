/* Reads view files. */
#include "command/fields.h"
#include "command/output.h"
#include "command/scene.h"
#include "command/words.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_BYTES = 64 << 20 };

#define DEGREE 0.017453292519943295f

/* Says what is wrong with a view file. */
static slv_result bad_view(const slv_env *env, const char *path, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static slv_result bad_view(const slv_env *env, const char *path, const char *format, ...) {
    char text[256];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return output_fail(env, SLV_ERROR_FORMAT, "%s: %s", path, text);
}

static bool read_floats(const json_t *array, size_t count, float *out) {
    if (!json_is_array(array) || json_array_size(array) != count)
        return false;
    for (size_t i = 0; i < count; i++) {
        const json_t *value = json_array_get(array, i);
        if (!json_is_number(value) || !isfinite((float)json_number_value(value)))
            return false;
        out[i] = (float)json_number_value(value);
    }
    return true;
}

/* Names a field that says nothing beside the others. */
static void warn_of(const slv_env *env, const char *path, const json_t *root, const char *field,
                    const char *why) {
    char line[512];
    snprintf(line, sizeof line, "%.300s: the field '%s' is not used %s", path, field, why);
    if (json_object_get(root, field) && env->log)
        env->log(env->log_user, SLV_LOG_WARNING, line);
}

/* The window in units of tan(fov / 2), and without one the square of -1 to 1. */
static slv_result read_window(const slv_env *env, const char *path, const json_t *root,
                              scene_view *out) {
    const json_t *window = json_object_get(root, "screen_window"),
                 *fov = json_object_get(root, "fov");
    float *w = out->camera.window;
    bool scaled = fov && out->camera.perspective;
    if (!out->camera.perspective)
        warn_of(env, path, root, "fov", "without perspective");
    for (int side = 0; side < 4; side++)
        w[side] = side & 1 ? 1 : -1;
    out->whole_window = scaled && !window;
    if (!out->whole_window && !read_floats(window, 4, w))
        return bad_view(env, path, "screen_window is not four numbers: left, right, bottom, top");
    for (int side = 0; scaled && side < 4; side++)
        w[side] *= tanf(out->fov * DEGREE / 2);
    if (!(w[1] - w[0] > FLT_MIN) || !(w[3] - w[2] > FLT_MIN))
        return bad_view(env, path, "screen_window is empty");
    return SLV_OK;
}

/* Of an orbit a view may say how it is projected. */
static slv_result read_projection(const slv_env *env, const char *path, const json_t *root,
                                  scene_view *out) {
    const json_t *fov = json_object_get(root, "fov"),
                 *projection = json_object_get(root, "projection");
    const char *word = json_string_value(projection);
    if (fov && (!json_is_number(fov) || !(json_number_value(fov) >= 0.01) ||
                !(json_number_value(fov) <= 179)))
        return bad_view(env, path, "fov is not a number of degrees from 0.01 to 179");
    if ((projection || !fov) && (projection || json_object_get(root, "world_to_camera")) &&
        (!word || (strcmp(word, "orthographic") != 0 && strcmp(word, "perspective") != 0)))
        return bad_view(env, path, "projection is neither orthographic nor perspective");
    out->camera.perspective = !word || word[0] == 'p';
    out->fov = out->camera.perspective ? (float)json_number_value(fov) : 0;
    out->has_fov = fov || !out->camera.perspective;
    return SLV_OK;
}

static slv_result read_camera(const slv_env *env, const char *path, const json_t *root,
                              scene_view *out) {
    const json_t *matrix = json_object_get(root, "world_to_camera");
    slv_result result;
    for (size_t r = 0; matrix && r < 4; r++) {
        const json_t *row = json_array_get(matrix, r);
        if (json_array_size(matrix) != 4 ||
            !read_floats(row, 4, out->camera.world_to_camera + 4 * r))
            return bad_view(env, path, "world_to_camera is not four rows of four numbers");
        for (size_t c = 0; c < 4; c++)
            out->world_to_camera[4 * r + c] = json_number_value(json_array_get(row, c));
    }
    if ((result = read_projection(env, path, root, out)))
        return result;
    if (!matrix) {
        warn_of(env, path, root, "screen_window", "without world_to_camera");
        if (!out->camera.perspective)
            warn_of(env, path, root, "fov", "without perspective");
        return SLV_OK;
    }
    if ((result = read_window(env, path, root, out)))
        return result;
    const float *m = out->camera.world_to_camera;
    double determinant = (double)m[0] * ((double)m[5] * m[10] - (double)m[6] * m[9]) -
                         (double)m[1] * ((double)m[4] * m[10] - (double)m[6] * m[8]) +
                         (double)m[2] * ((double)m[4] * m[9] - (double)m[5] * m[8]);
    if (!isfinite(determinant) || fabs(determinant) < 1e-30 || m[12] != 0 || m[13] != 0 ||
        m[14] != 0 || m[15] != 1)
        return bad_view(env, path,
                        "world_to_camera cannot be inverted, or its last row is not 0 0 0 1");
    out->has_camera = true;
    return SLV_OK;
}

/* Each camera has its own fields, and the file's for those that it leaves out. */
static slv_result read_cameras(const slv_env *env, const char *path, const json_t *root,
                               scene_view *out) {
    const json_t *list = json_object_get(root, "cameras");
    size_t count = json_array_size(list);
    slv_result result = SLV_OK;
    if (!list)
        return read_camera(env, path, root, out);
    if (!count || count > FRAMES_MOST)
        return bad_view(env, path, "cameras is not a list of 1 to %d", FRAMES_MOST);
    if (!(out->cameras = calloc(count, sizeof *out->cameras)))
        return output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for its cameras", path);
    out->ncameras = (uint32_t)count;
    for (size_t i = 0; i < count && !result; i++) {
        json_t *camera = json_array_get(list, i), *merged = json_object();
        if (!json_is_object(camera))
            result = bad_view(env, path, "camera %zu is not an object", i + 1);
        else if (!merged || json_object_update(merged, (json_t *)(uintptr_t)root) ||
                 json_object_update(merged, camera))
            result = output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for its cameras", path);
        else if (!json_object_get(merged, "world_to_camera"))
            result = bad_view(env, path, "camera %zu has no world_to_camera", i + 1);
        if (!result)
            fields_warn(env, path, camera, "world_to_camera|projection|screen_window|fov");
        if (!result)
            result = read_camera(env, path, merged, &out->cameras[i]);
        json_decref(merged);
    }
    if (result)
        return result;
    const scene_view *first = &out->cameras[0];
    out->camera = first->camera;
    memcpy(out->world_to_camera, first->world_to_camera, sizeof out->world_to_camera);
    out->has_camera = true;
    out->whole_window = first->whole_window;
    out->has_fov = first->has_fov;
    out->fov = first->fov;
    return SLV_OK;
}

void scene_view_free(scene_view *view) {
    free(view->cameras);
    view->cameras = NULL;
    view->ncameras = 0;
}

slv_camera scene_view_camera(const scene_view *view, const slv_mesh *mesh) {
    const double *origin = slv_mesh_get_view(mesh)->origin, *m = view->world_to_camera;
    slv_camera camera = view->camera;
    for (int r = 0; r < 3; r++, m += 4)
        camera.world_to_camera[4 * r + 3] =
            (float)(m[3] + m[0] * origin[0] + m[1] * origin[1] + m[2] * origin[2]);
    return camera;
}

void scene_fit_window(float w[4], float aspect) {
    float width = w[1] - w[0], height = w[3] - w[2];
    bool narrow = width < height * aspect;
    float more = narrow ? (height * aspect - width) / 2 : (width / aspect - height) / 2;
    float *side = narrow ? w : w + 2;
    side[0] -= more;
    side[1] += more;
}

/* Leaves the value alone where the file says nothing. */
static bool read_weight(const json_t *shading, const char *key, float *out) {
    const json_t *value = json_object_get(shading, key);
    double number = json_number_value(value);
    if (!value)
        return true;
    if (!json_is_number(value) || !(number >= 0 && number <= 1000))
        return false;
    *out = (float)number;
    return true;
}

/* A path that a view file names: from the folder that the view lies in. */
static bool join_path(const char *view, const char *name, char out[DISPLACE_PATH]) {
    const char *slash = strrchr(view, '/');
    int folder =
        name[0] == '/' || !slash || strcmp(view, cli_input("-")) == 0 ? 0 : (int)(slash + 1 - view);
    return snprintf(out, DISPLACE_PATH, "%.*s%s", folder, view, name) < DISPLACE_PATH;
}

slv_result scene_load_light(const slv_env *env, const char *path, float turn, slv_light *out) {
    slv_image image = {0};
    slv_result result = slv_image_load(env, path, &image);
    if (result)
        return result;
    slv_light_from_image(&image, out);
    *out = slv_light_turn(out, turn);
    slv_image_free(&image);
    return SLV_OK;
}

/* Of the model `image`. */
static slv_result read_light(const slv_env *env, const char *path, const json_t *shading,
                             scene_view *out) {
    const char *light = json_string_value(json_object_get(shading, "light"));
    const json_t *turn = json_object_get(shading, "turn");
    if (out->shading != SLV_SHADE_IMAGE) {
        warn_of(env, path, shading, "light", "but by the model image");
        warn_of(env, path, shading, "turn", "but by the model image");
        return SLV_OK;
    }
    if (!light || !join_path(path, light, out->light))
        return bad_view(env, path, "shading: light is not the name of an image");
    out->light_turn = (float)json_number_value(turn);
    if (turn && (!json_is_number(turn) || !(fabsf(out->light_turn) <= 3600)))
        return bad_view(env, path, "shading: turn is not a number of degrees");
    return SLV_OK;
}

static slv_result read_shading(const slv_env *env, const char *path, const json_t *root,
                               scene_view *out) {
    const json_t *shading = json_object_get(root, "shading"),
                 *name = json_object_get(shading, "model");
    const char *model = json_string_value(name);
    char hint[SLV_WORDS_HINT];
    if (!shading)
        return SLV_OK;
    if (!json_is_object(shading))
        return bad_view(env, path, "shading is not an object, such as {\"model\": \"unlit\"}");
    if (!model)
        return bad_view(env, path, "shading: model is not one of the words %s", names_shadings());
    if (!slv_shading_from_name(model, &out->shading))
        return bad_view(env, path, "unknown shading model '%s', expected %s%s", model,
                        names_shadings(), slv_words_hint(model, names_shadings(), hint));
    out->ka = 0.2f;
    out->kd = 0.8f;
    if (!read_weight(shading, "ka", &out->ka) || !read_weight(shading, "kd", &out->kd))
        return bad_view(env, path, "ka and kd are numbers from 0 to 1000");
    out->has_shading = true;
    return read_light(env, path, shading, out);
}

static slv_result read_alpha(const slv_env *env, const char *path, const json_t *root,
                             scene_view *out) {
    const json_t *alpha = json_object_get(root, "alpha"), *mode = json_object_get(alpha, "mode"),
                 *premultiplied = json_object_get(alpha, "premultiplied");
    const char *word = json_string_value(mode);
    char hint[SLV_WORDS_HINT];
    if (!alpha)
        return SLV_OK;
    if (!json_is_object(alpha))
        return bad_view(env, path, "alpha is not an object, such as {\"mode\": \"mask\"}");
    fields_warn(env, path, alpha, "mode|premultiplied");
    if (mode && !word)
        return bad_view(env, path, "alpha: mode is not one of the words %s", names_alpha_modes());
    const int index = word ? words_index(names_alpha_modes(), word, strlen(word)) : 0;
    if (index < 0)
        return bad_view(env, path, "alpha: unknown mode '%s', expected %s%s", word,
                        names_alpha_modes(), slv_words_hint(word, names_alpha_modes(), hint));
    if (premultiplied && !json_is_boolean(premultiplied))
        return bad_view(env, path, "alpha: premultiplied is neither true nor false");
    out->has_alpha = word != NULL;
    out->alpha = (slv_alpha_mode)index;
    out->premultiplied = json_is_true(premultiplied);
    return SLV_OK;
}

static slv_result read_surface(const slv_env *env, const char *path, const json_t *root,
                               scene_view *out) {
    char hint[SLV_WORDS_HINT];
    const json_t *boundary_value = json_object_get(root, "boundary"),
                 *scheme_value = json_object_get(root, "scheme");
    const char *boundary = json_string_value(boundary_value),
               *scheme = json_string_value(scheme_value);
    if ((boundary_value && !boundary) || (scheme_value && !scheme))
        return bad_view(env, path, "boundary and scheme are words in quotes");
    if (boundary && !slv_boundary_from_name(boundary, &out->boundary))
        return bad_view(env, path, "unknown boundary '%s', expected %s%s", boundary,
                        names_boundaries(), slv_words_hint(boundary, names_boundaries(), hint));
    out->has_scheme = scheme != NULL;
    if (scheme && !slv_scheme_from_name(scheme, &out->scheme))
        return bad_view(env, path, "scheme '%s' is not supported, expected %s%s", scheme,
                        names_schemes(), slv_words_hint(scheme, names_schemes(), hint));
    return SLV_OK;
}

static slv_result read_displacement_numbers(const slv_env *env, const char *path,
                                            const json_t *root, displace_settings *d) {
    const json_t *channel = json_object_get(root, "channel"), *lerp = json_object_get(root, "lerp");
    const struct {
        const char *key;
        float *to;
    } numbers[] = {{"scale", &d->scale}, {"bias", &d->bias}};
    if (json_is_integer(channel) && json_integer_value(channel) >= 0)
        snprintf(d->channel, sizeof d->channel, "%" JSON_INTEGER_FORMAT,
                 json_integer_value(channel));
    else if (json_is_string(channel) && json_string_length(channel) < DISPLACE_CHANNEL)
        strcpy(d->channel, json_string_value(channel));
    else if (channel)
        return bad_view(env, path, "displacement: channel is neither a number nor a name");
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        const json_t *value = json_object_get(root, numbers[i].key);
        float number = (float)json_number_value(value);
        if (value && (!json_is_number(value) || !isfinite(number)))
            return bad_view(env, path, "displacement: %s is not a number", numbers[i].key);
        *numbers[i].to = value ? number : *numbers[i].to;
    }
    if (lerp && !json_is_boolean(lerp))
        return bad_view(env, path, "displacement: lerp is neither true nor false");
    d->filter.lerp = lerp ? json_is_true(lerp) : d->filter.lerp;
    return SLV_OK;
}

static slv_result read_displacement(const slv_env *env, const char *path, const json_t *root,
                                    displace_settings *d) {
    const json_t *object = json_object_get(root, "displacement"),
                 *filter = json_object_get(object, "filter"),
                 *space = json_object_get(object, "space");
    const char *texture = json_string_value(json_object_get(object, "texture")),
               *words[] = {json_string_value(filter), json_string_value(space)};
    char hint[SLV_WORDS_HINT];
    if (!object)
        return SLV_OK;
    if (!json_is_object(object))
        return bad_view(env, path, "displacement is not an object");
    fields_warn(env, path, object, "texture|channel|scale|bias|filter|lerp|space");
    *d = (displace_settings){
        .given = true, .scale = 1, .filter = {.filter = SLV_FILTER_BSPLINE, .lerp = true}};
    if (!texture || !join_path(path, texture, d->texture))
        return bad_view(env, path, "displacement: texture is not the name of a file");
    if (filter && (!words[0] || !slv_filter_from_name(words[0], &d->filter.filter)))
        return bad_view(env, path, "displacement: unknown filter '%s', expected %s%s",
                        words[0] ? words[0] : "", names_filters(),
                        slv_words_hint(words[0] ? words[0] : "", names_filters(), hint));
    if (space && (!words[1] || !slv_displacement_space_from_name(words[1], &d->space)))
        return bad_view(env, path, "displacement: unknown space '%s', expected %s%s",
                        words[1] ? words[1] : "", names_spaces(),
                        slv_words_hint(words[1] ? words[1] : "", names_spaces(), hint));
    return read_displacement_numbers(env, path, object, d);
}

static slv_result read_size(const slv_env *env, const char *path, const json_t *root,
                            scene_view *out) {
    float size[2];
    const json_t *array = json_object_get(root, "size");
    if (!array)
        return SLV_OK;
    if (!read_floats(array, 2, size) ||
        !(size[0] >= 1 && size[0] <= 16384 && size[1] >= 1 && size[1] <= 16384) ||
        size[0] != floorf(size[0]) || size[1] != floorf(size[1]))
        return bad_view(env, path, "size is not two whole numbers from 1 to 16384");
    out->size[0] = (uint32_t)size[0];
    out->size[1] = (uint32_t)size[1];
    out->has_size = true;
    return SLV_OK;
}

slv_result scene_load_view(const slv_env *env, const char *path, scene_view *out) {
    json_error_t error;
    slv_result result;
    memset(out, 0, sizeof *out);
    char *text;
    size_t length;
    slv_env small = *env;
    small.max_bytes = MAX_BYTES; /* a pipe may have no end */
    if ((result = slv_text_load(&small, path, &text, &length)))
        return result;
    json_t *root = json_loadb(text, length, JSON_REJECT_DUPLICATES, &error);
    slv_free(text);
    if (!root)
        return bad_view(env, path, "line %d: %s", error.line, error.text);
    if (json_is_object(root)) {
        fields_warn(env, path, root,
                    "size|world_to_camera|projection|screen_window|fov|shading|scheme|boundary|"
                    "displacement|cameras|alpha");
        fields_warn(env, path, json_object_get(root, "shading"), "model|ka|kd|light|turn");
    }
    if (!json_is_object(root))
        result = bad_view(env, path, "not a JSON object");
    else if (!(result = read_size(env, path, root, out)) &&
             !(result = read_cameras(env, path, root, out)) &&
             !(result = read_shading(env, path, root, out)) &&
             !(result = read_alpha(env, path, root, out)) &&
             !(result = read_displacement(env, path, root, &out->displacement)))
        result = read_surface(env, path, root, out);
    json_decref(root);
    if (result)
        scene_view_free(out);
    return result;
}
