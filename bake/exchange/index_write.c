/* Writing the index of exported images. */
#include "base/json.h"
#include "exchange/index.h"

#include "exchange/geometry.h"

#include <selvage/file.h>

#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

json_t *slvi_index_text(const slv_env *env, const char *text) {
    slv_env silent = *env;
    size_t left = strlen(text), used = 0;
    char *clean;
    silent.log = NULL;
    if (slvi_alloc(&silent, "a name", left + 1, 3, &clean))
        return NULL;
    while (left) {
        size_t length = 0;
        json_t *character = NULL;
        while (!character && length < 4 && length < left)
            character = json_stringn(text, ++length);
        json_decref(character);
        memcpy(clean + used, character ? text : "\xEF\xBF\xBD", character ? length : 3);
        used += character ? length : 3;
        text += character ? length : 1;
        left -= character ? length : 1;
    }
    json_t *string = json_stringn(clean, used);
    slvi_free(clean);
    return string;
}

void slvi_index_image_name(char *out, size_t size, const char *stem, uint32_t group,
                           const char *extension) {
    if (group)
        snprintf(out, size, "%s.%u%s", stem, group, extension);
    else
        snprintf(out, size, "%s%s", stem, extension);
}

slv_texture_encoding slvi_index_pictures(const slvi_exchange_plan *plan, bool exr) {
    bool linear = plan->target.type == SLV_TYPE_U16 && plan->encoding == SLV_TEXTURE_LINEAR;
    return exr || linear ? SLV_TEXTURE_LINEAR : SLV_TEXTURE_SRGB;
}

slv_image_params slvi_index_image_params(const slvi_exchange_plan *plan, bool exr) {
    slv_type type = plan->target.type;
    bool linear = slvi_index_pictures(plan, exr) == SLV_TEXTURE_LINEAR;
    slv_image_params params = {.encoding = linear ? SLV_ENCODE_LINEAR : SLV_ENCODE_RAW, .bits = 16};
    if (type == SLV_TYPE_U8 && plan->encoding != SLV_TEXTURE_LINEAR)
        params.bits = 8;
    if (exr)
        params.bits = type == SLV_TYPE_HALF || type == SLV_TYPE_U8 ? 16 : 32;
    return params;
}

void slvi_index_to_image(const float *values, slv_res res, uint32_t nchannels, uint32_t group,
                         slv_image *image, uint32_t x, uint32_t y) {
    size_t w = (size_t)1 << res.u, h = (size_t)1 << res.v, n = image->nchannels;
    for (size_t row = 0; row < h; row++) {
        float *to = image->pixels + ((y + h - 1 - row) * image->width + x) * n;
        const float *from = values + row * w * nchannels + group * SLVI_INDEX_GROUP;
        for (size_t i = 0; i < w; i++, from += nchannels, to += n)
            memcpy(to, from, n * sizeof *to);
    }
}

/* JSON has no infinities and no NaN. */
static json_t *real_json(double value) {
    if (isfinite(value))
        return json_real(value);
    return json_string(isnan(value) ? "nan" : value > 0 ? "inf" : "-inf");
}

static json_t *value_json(const slv_ptx_meta *meta, uint32_t i) {
    switch (meta->type) {
    case SLV_META_STRING:
        return json_integer(((const uint8_t *)meta->values)[i]);
    case SLV_META_INT8:
        return json_integer(((const int8_t *)meta->values)[i]);
    case SLV_META_INT16:
        return json_integer(((const int16_t *)meta->values)[i]);
    case SLV_META_INT32:
        return json_integer(((const int32_t *)meta->values)[i]);
    case SLV_META_FLOAT:
        return real_json((double)((const float *)meta->values)[i]);
    case SLV_META_DOUBLE:
        break;
    }
    return real_json(((const double *)meta->values)[i]);
}

/* Text as text; a string that JSON cannot hold as its bytes. */
static json_t *meta_json(const slv_env *env, const slv_ptx_meta *meta) {
    json_t *key = slvi_index_text(env, meta->key);
    if (meta->type == SLV_META_STRING) {
        json_t *text = json_stringn(meta->values, meta->count);
        if (text)
            return json_pack("{s:o, s:s, s:o}", "key", key, "type", "string", "value", text);
    }
    json_t *values = json_array();
    for (uint32_t i = 0; i < meta->count; i++)
        if (json_array_append_new(values, value_json(meta, i))) {
            json_decref(values);
            json_decref(key);
            return NULL;
        }
    return json_pack("{s:o, s:o, s:o}", "key", key, "type",
                     json_string(slvi_index_meta((int)meta->type)), "values", values);
}

slv_result slvi_index_no_memory(const slv_env *env, const slvi_exchange_plan *plan) {
    return slvi_fail(env, SLV_ERROR_MEMORY, "%s: no memory to describe the faces", plan->path);
}

slv_result slvi_index_create(const slv_env *env, const slv_ptx *ptx, const slvi_exchange_plan *plan,
                             bool meta, json_t **out) {
    const slv_ptx_writer_params *target = &plan->target;
    json_t *list = json_array();
    *out = NULL;
    for (uint32_t i = 0; meta && i < slv_ptx_get_info(ptx)->nmeta; i++) {
        const slv_ptx_meta *entry;
        slv_result result = slv_ptx_load_meta(ptx, i, &entry);
        bool of_all = !result && plan->faces &&
                      (slvi_geometry_key(entry->key) >= 0 || !strcmp(entry->key, SLV_PARTS_KEY));
        if (of_all) /* and some faces are written */
            continue;
        if (!result && json_array_append_new(list, meta_json(env, entry)))
            result = slvi_index_no_memory(env, plan);
        if (result) {
            json_decref(list);
            return result;
        }
    }
    *out = json_pack("{s:i, s:s, s:o, s:s, s:I, s:o, s:s, s:o, s:o, s:o, s:b, s:o, s:[]}", "schema",
                     1, "kind", SLVI_INDEX_KIND, "mesh_type",
                     json_string(slvi_index_mesh((int)target->mesh_type)), "data_type",
                     slv_type_name(target->type), "channels", (json_int_t)target->nchannels,
                     "alpha_channel",
                     target->alpha_channel < 0 ? json_null() : json_integer(target->alpha_channel),
                     "texture_encoding", slv_texture_encoding_name(plan->encoding), "border_u",
                     json_string(slvi_index_border((int)target->border_u)), "border_v",
                     json_string(slvi_index_border((int)target->border_v)), "edge_filter",
                     json_string(slvi_index_filter((int)target->edge_filter)), "reductions",
                     (int)!target->no_reductions, "meta", list, "faces");
    return *out ? SLV_OK : slvi_index_no_memory(env, plan);
}

json_t *slvi_index_face(const slv_ptx_face *face, unsigned nedges) {
    json_t *faces = json_array(), *edges = json_array();
    int failed = 0;
    for (unsigned e = 0; e < nedges; e++) {
        int32_t there = face->adjacency.face[e];
        failed |= json_array_append_new(faces, there < 0 ? json_null() : json_integer(there));
        failed |= json_array_append_new(edges, there < 0 ? json_null()
                                                         : json_integer(face->adjacency.edge[e]));
    }
    if (failed) {
        json_decref(faces);
        json_decref(edges);
        return NULL;
    }
    return json_pack(
        "{s:I, s:I, s:b, s:b, s:o, s:o}", "width", (json_int_t)1 << face->res.u, "height",
        (json_int_t)1 << face->res.v, "constant", (face->flags & SLV_FACE_CONSTANT) != 0, "subface",
        (face->flags & SLV_FACE_SUBFACE) != 0, "adjacent_faces", faces, "adjacent_edges", edges);
}

slv_result slvi_index_write(const slv_env *env, const char *path, json_t *root) {
    slv_output *output = NULL;
    slv_result result = slv_output_open(env, path, &output);
    FILE *stream = result ? NULL : slv_output_stream(output);
    if (stream && json_dumpf(root, stream, JSON_INDENT(1) | JSON_REAL_PRECISION(17)) != 0 &&
        !ferror(stream))
        result = slvi_fail(env, SLV_ERROR_MEMORY, "%s: no memory to write it", path);
    json_decref(root);
    return slv_output_end(output, result);
}

slv_result slvi_index_may_be(const slv_env *env, const char *path) {
    json_error_t error;
    struct stat status;
    if ((stat(path, &status) != 0 && errno == ENOENT) ||
        (S_ISREG(status.st_mode) && !status.st_size))
        return SLV_OK; /* nothing is lost */
    char *text;
    size_t size;
    slv_result result = slv_text_load(env, path, &text, &size);
    if (result)
        return result;
    json_t *root;
    result = slvi_json_load(text, size, 0, &root, &error);
    slv_free(text);
    const char *kind = json_string_value(json_object_get(root, "kind"));
    bool good = kind && strcmp(kind, SLVI_INDEX_KIND) == 0;
    if (result == SLV_ERROR_MEMORY)
        slvi_fail(env, result, "%s: no memory to read it", path);
    else if (!good)
        result =
            slvi_fail(env, SLV_ERROR_IO,
                      "%s: is there already and is no index of a sheet: name another sheet", path);
    json_decref(root);
    return result;
}
