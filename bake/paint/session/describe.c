/* session.json: what a document was made as; and where the files of a session are. */
#include "session/session_data.h"

#include "base/file.h"
#include "base/json.h"
#include "base/log.h"
#include "base/output.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

slv_result slvi_session_path(const slv_env *env, const char *folder, const char *name, char **out) {
    size_t size = strlen(folder) + strlen(name) + 2;
    slv_result result = slvi_alloc(env, "session", size, 1, out);
    if (!result)
        snprintf(*out, size, "%s/%s", folder, name);
    return result;
}

slv_result slvi_session_state_path(const slv_session *session, uint64_t state, char **out) {
    char name[40];
    snprintf(name, sizeof name, "state-%" PRIu64, state);
    return slvi_session_path(&session->env, session->path, name, out);
}

/* Runs of faces with the same resolution: log2 of width and height, and how many. */
static json_t *runs_of(const slv_texture_desc *flat) {
    json_t *runs = json_array();
    for (uint32_t f = 0, end; f < flat->nfaces; f = end) {
        const slv_res res = flat->res[f];
        for (end = f + 1;
             end < flat->nfaces && flat->res[end].u == res.u && flat->res[end].v == res.v;)
            end++;
        if (json_array_append_new(
                runs, json_pack("[iiI]", (int)res.u, (int)res.v, (json_int_t)(end - f))) != 0) {
            json_decref(runs);
            return NULL;
        }
    }
    return runs;
}

/* And back; false if they are not those of all faces. */
static bool read_runs(const json_t *runs, uint32_t nfaces, slv_res *res) {
    json_t *run;
    size_t i;
    uint32_t face = 0;
    json_array_foreach(runs, i, run) {
        json_int_t u = json_integer_value(json_array_get(run, 0)),
                   v = json_integer_value(json_array_get(run, 1)),
                   count = json_integer_value(json_array_get(run, 2));
        if (json_array_size(run) != 3 || u < 0 || v < 0 || u > SLV_MAX_LOG2_RES ||
            v > SLV_MAX_LOG2_RES || count < 1 || count > nfaces - face)
            return false;
        for (json_int_t k = 0; k < count; k++)
            res[face++] = (slv_res){(int8_t)u, (int8_t)v};
    }
    return json_is_array(runs) && face == nfaces;
}

/* As a full path, which is right from wherever it is read; a name that JSON cannot hold is left
 * out. False if memory ran out. */
static bool add_origin(json_t *root, const char *made_of) {
    json_t *name = NULL;
    errno = 0;
    char *full = realpath(made_of, NULL);
    bool good = full || errno != ENOMEM;
    if (good)
        good = slvi_json_text(full ? full : made_of, &name) != SLV_ERROR_MEMORY;
    free(full);
    return good && (!name || json_object_set_new(root, "made_of", name) == 0);
}

slv_result slvi_session_describe(const slv_env *env, const char *path,
                                 const slv_session_params *params) {
    const slv_texture_desc *flat = &params->document.flat;
    json_t *background = json_array();
    for (uint32_t c = 0; params->document.background && c < flat->nchannels; c++)
        json_array_append_new(background, json_real((double)params->document.background[c]));
    json_t *root = json_pack(
        "{s:s, s:i, s:s, s:I, s:s, s:i, s:i, s:s, s:s, s:s, s:o, s:o}", "kind", "selvage session",
        "version", 1, "mesh", "mesh.obj", "faces", (json_int_t)flat->nfaces, "type",
        slv_type_name(flat->type), "channels", (int)flat->nchannels, "alpha",
        (int)flat->alpha_channel, "encoding", slv_texture_encoding_name(flat->encoding), "working",
        slv_type_name(params->document.working), "scheme", slv_scheme_name(params->scheme),
        "background", background, "res", runs_of(flat));
    bool complete = root && (!params->made_of || add_origin(root, params->made_of));
    char *text = complete ? json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) : NULL;
    slv_result result = text ? slvi_output_write(env, path, text, strlen(text))
                             : slvi_fail(env, SLV_ERROR_MEMORY, "%s: no memory", path);
    free(text);
    json_decref(root);
    return result;
}

static bool read_integer(const json_t *root, const char *key, json_int_t low, json_int_t high,
                         json_int_t *out) {
    const json_t *value = json_object_get(root, key);
    *out = json_integer_value(value);
    return json_is_integer(value) && *out >= low && *out <= high;
}

static const char *read_root(const json_t *root, slv_session_params *out) {
    slv_texture_desc *flat = &out->document.flat;
    json_int_t version, faces, channels, alpha;
    const char *kind = json_string_value(json_object_get(root, "kind"));
    if (!kind || strcmp(kind, "selvage session") != 0)
        return "kind";
    if (!read_integer(root, "version", 1, 1, &version))
        return "version";
    if (!read_integer(root, "faces", 1, UINT32_MAX, &faces))
        return "faces";
    if (!read_integer(root, "channels", 1, SLVI_MOST_CHANNELS, &channels))
        return "channels";
    if (!read_integer(root, "alpha", SLV_NO_ALPHA, channels - 1, &alpha))
        return "alpha";
    flat->nfaces = (uint32_t)faces;
    flat->nchannels = (uint32_t)channels;
    flat->alpha_channel = (int32_t)alpha;
    const struct {
        const char *key;
        bool known;
    } words[] = {
        {"type", slv_type_from_name(json_string_value(json_object_get(root, "type")), &flat->type)},
        {"working", slv_type_from_name(json_string_value(json_object_get(root, "working")),
                                       &out->document.working)},
        {"encoding", slv_texture_encoding_from_name(
                         json_string_value(json_object_get(root, "encoding")), &flat->encoding)},
        {"scheme",
         slv_scheme_from_name(json_string_value(json_object_get(root, "scheme")), &out->scheme)}};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (!words[i].known)
            return words[i].key;
    const json_t *background = json_object_get(root, "background");
    size_t count = json_array_size(background);
    return !json_is_array(background) || (count && count != flat->nchannels) ? "background" : NULL;
}

slv_result slvi_session_read_description(const slv_env *env, const char *path,
                                         slv_session_params *out, bool *began) {
    char *text = NULL;
    size_t size = 0;
    float *background = NULL;
    slv_res *res = NULL;
    slv_result result = slvi_file_read(env, path, &text, &size);
    if (result)
        return result;
    json_error_t error;
    json_t *root;
    result = slvi_json_load(text, size, JSON_REJECT_DUPLICATES, &root, &error);
    slvi_free(text);
    if (result == SLV_ERROR_MEMORY)
        return slvi_fail(env, result, "%s: no memory to read it", path);
    const char *wrong = root ? read_root(root, out) : "the file";
    const json_t *list = json_object_get(root, "background");
    if (wrong)
        result = slvi_fail(env, SLV_ERROR_FORMAT, "%s: %s is not what it should be", path, wrong);
    else if (!(result = slvi_alloc(env, path, out->document.flat.nfaces, sizeof *res, &res)))
        result = slvi_alloc(env, path, SLVI_MOST_CHANNELS, sizeof *background, &background);
    const json_t *runs = json_object_get(root, "res");
    *began = runs != NULL;
    if (!result && runs && !read_runs(runs, out->document.flat.nfaces, res))
        result = slvi_fail(env, SLV_ERROR_FORMAT, "%s: res is not what it should be", path);
    const char *origin = json_string_value(json_object_get(root, "made_of"));
    char *made_of = NULL;
    if (!result && origin && !(result = slvi_alloc(env, path, strlen(origin) + 1, 1, &made_of)))
        memcpy(made_of, origin, strlen(origin) + 1);
    for (size_t c = 0; !result && c < json_array_size(list); c++)
        background[c] = (float)json_number_value(json_array_get(list, c));
    out->document.flat.res = res;
    out->document.background = background;
    out->made_of = made_of;
    json_decref(root);
    return result;
}

void slvi_session_free_description(slv_session_params *params) {
    union {
        const void *is;
        void *was;
    } res = {params->document.flat.res}, background = {params->document.background},
      made_of = {params->made_of};
    slvi_free(res.was);
    slvi_free(background.was);
    slvi_free(made_of.was);
}
