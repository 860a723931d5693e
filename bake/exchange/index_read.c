/* Reading the index of images. */
#include "exchange/index.h"

#include "base/file.h"
#include "base/json.h"
#include "base/names.h"

#include <selvage/file.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *slvi_index_border(int value) {
    return slv_border_mode_name((slv_border_mode)value);
}

const char *slvi_index_filter(int value) {
    return slv_edge_filter_name((slv_edge_filter)value);
}

const char *slvi_index_meta(int value) {
    return slv_meta_type_name((slv_meta_type)value);
}

const char *slvi_index_mesh(int value) {
    return slv_ptx_mesh_type_name((slv_ptx_mesh_type)value);
}

const char *slvi_index_type(int value) {
    return slv_type_name((slv_type)value);
}

int slvi_index_value(slvi_index_names *names, const json_t *word) {
    const char *wanted = json_string_value(word);
    for (int value = 0; wanted; value++) {
        const char *name = names(value);
        if (strcmp(name, slv_border_mode_name((slv_border_mode)-1)) == 0)
            break; /* there are no more */
        if (strcmp(name, wanted) == 0)
            return value;
    }
    return -1;
}

static bool read_word(const json_t *root, const char *key, slvi_index_names *names, int *out) {
    *out = slvi_index_value(names, json_object_get(root, key));
    return *out >= 0;
}

static bool is_index(const json_t *root) {
    const char *kind = json_string_value(json_object_get(root, "kind"));
    return kind && strcmp(kind, SLVI_INDEX_KIND) == 0;
}

/* An integer of low..high. */
static bool read_integer(const json_t *item, json_int_t low, json_int_t high, json_int_t *out) {
    *out = json_integer_value(item);
    return json_is_integer(item) && *out >= low && *out <= high;
}

/* What an index says of the colours; older ones say nothing. */
static slv_result read_encoding(const slv_env *env, const char *path, const json_t *root,
                                const char *key, slv_texture_encoding *out) {
    const json_t *item = json_object_get(root, key);
    *out = SLV_TEXTURE_AUTO;
    if (!item || slv_texture_encoding_from_name(json_string_value(item), out))
        return SLV_OK;
    return slvi_fail(env, SLV_ERROR_FORMAT, "%s: %s is nothing that it can be", path, key);
}

static slv_result read_params(const slv_env *env, const char *path, const json_t *root,
                              slv_ptx_writer_params *out) {
    const char *wrong = NULL;
    int mesh = 0, type = 0, border_u = 0, border_v = 0, filter = 0;
    json_int_t schema = 0, channels = 0, alpha = SLV_NO_ALPHA;
    const json_t *alpha_item = json_object_get(root, "alpha_channel"),
                 *faces = json_object_get(root, "faces"), *meta = json_object_get(root, "meta");
    if (!read_integer(json_object_get(root, "schema"), 1, 1, &schema))
        wrong = "schema";
    else if (!is_index(root))
        wrong = "kind";
    else if (!read_word(root, "mesh_type", slvi_index_mesh, &mesh))
        wrong = "mesh_type";
    else if (!read_word(root, "data_type", slvi_index_type, &type))
        wrong = "data_type";
    else if (!read_word(root, "border_u", slvi_index_border, &border_u))
        wrong = "border_u";
    else if (!read_word(root, "border_v", slvi_index_border, &border_v))
        wrong = "border_v";
    else if (!read_word(root, "edge_filter", slvi_index_filter, &filter))
        wrong = "edge_filter";
    else if (!read_integer(json_object_get(root, "channels"), 1, 65535, &channels))
        wrong = "channels";
    else if (alpha_item && !json_is_null(alpha_item) &&
             !read_integer(alpha_item, 0, channels - 1, &alpha))
        wrong = "alpha_channel";
    else if (!json_is_array(faces) || json_array_size(faces) > INT32_MAX)
        wrong = "faces";
    else if (meta && !json_is_array(meta))
        wrong = "meta";
    if (wrong)
        return slvi_fail(env, SLV_ERROR_FORMAT, "%s: %s is missing, or is nothing that it can be",
                         path, wrong);
    *out = (slv_ptx_writer_params){.mesh_type = (slv_ptx_mesh_type)mesh,
                                   .type = (slv_type)type,
                                   .nchannels = (uint32_t)channels,
                                   .alpha_channel = (int32_t)alpha,
                                   .nfaces = (uint32_t)json_array_size(faces),
                                   .border_u = (slv_border_mode)border_u,
                                   .border_v = (slv_border_mode)border_v,
                                   .edge_filter = (slv_edge_filter)filter,
                                   .no_reductions =
                                       json_is_false(json_object_get(root, "reductions"))};
    return SLV_OK;
}

bool slv_exchange_is_index(const char *path) {
    return slvi_is_folder(path) || slvi_name_ends(path, ".json") ||
           slvi_name_ends(path, ".json.gz");
}

slv_result slvi_index_open(const slv_env *env, const char *path, slv_exchange *source) {
    char *index = source->index_path, *folder = source->index_folder;
    json_error_t error;
    if (snprintf(index, SLVI_INDEX_NAME, "%s%s", path, slvi_is_folder(path) ? "/index.json" : "") >=
        SLVI_INDEX_NAME)
        return slvi_fail(env, SLV_ERROR_IO, "%s: the name is too long", path);
    memcpy(folder, index, SLVI_INDEX_NAME);
    char *slash = strrchr(folder, '/');
    slash ? (slash[1] = 0) : (folder[0] = 0);
    char *text;
    size_t size;
    slv_result result = slv_text_load(env, index, &text, &size);
    if (result)
        return result;
    result = slvi_json_load(text, size, JSON_REJECT_DUPLICATES, &source->index, &error);
    slv_free(text);
    if (result == SLV_ERROR_MEMORY)
        return slvi_fail(env, result, "%s: no memory to read it", index);
    if (result)
        return slvi_fail(env, SLV_ERROR_FORMAT, "%s:%d: %s", index, error.line, error.text);
    if ((result =
             read_encoding(env, index, source->index, "texture_encoding", &source->encoding)) ||
        (result =
             read_encoding(env, index, source->index, "images_encoding", &source->images_encoding)))
        return result;
    return read_params(env, index, source->index, &source->params);
}

static bool read_log2(const json_t *item, int8_t *out) {
    json_int_t size;
    if (!read_integer(item, 1, 1 << SLV_MAX_LOG2_RES, &size) || (size & (size - 1)))
        return false;
    for (*out = 0; (json_int_t)1 << *out < size;)
        ++*out;
    return true;
}

slv_result slvi_index_read_face(const slv_env *env, const char *path, const json_t *item,
                                uint32_t face, const slv_ptx_writer_params *params,
                                slv_ptx_face *out) {
    unsigned nedges = params->mesh_type == SLV_PTX_TRIANGLE ? 3 : 4;
    const json_t *faces = json_object_get(item, "adjacent_faces"),
                 *edges = json_object_get(item, "adjacent_edges");
    *out = (slv_ptx_face){.adjacency = {{-1, -1, -1, -1}, {0, 0, 0, 0}}};
    if (!read_log2(json_object_get(item, "width"), &out->res.u) ||
        !read_log2(json_object_get(item, "height"), &out->res.v))
        return slvi_fail(env, SLV_ERROR_FORMAT,
                         "%s: face %u: its width and height are not powers of two up to %u", path,
                         face, 1u << SLV_MAX_LOG2_RES);
    if (json_is_true(json_object_get(item, "constant")))
        out->flags |= SLV_FACE_CONSTANT;
    if (json_is_true(json_object_get(item, "subface")))
        out->flags |= SLV_FACE_SUBFACE;
    for (unsigned e = 0; e < nedges; e++) {
        const json_t *there = json_array_get(faces, e);
        json_int_t adjacent, edge;
        if (!there || json_is_null(there))
            continue;
        if (!read_integer(there, 0, (json_int_t)params->nfaces - 1, &adjacent) ||
            !read_integer(json_array_get(edges, e), 0, nedges - 1, &edge))
            return slvi_fail(env, SLV_ERROR_FORMAT,
                             "%s: face %u edge %u: its neighbour is no face and edge of the list",
                             path, face, e);
        out->adjacency.face[e] = (int32_t)adjacent;
        out->adjacency.edge[e] = (uint8_t)edge;
    }
    return SLV_OK;
}

static bool read_real(const json_t *item, double *out) {
    static const char *const words[] = {"nan", "inf", "-inf"};
    static const double values[] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    int which = 0;
    bool word = slvi_name_find(words, SLVI_COUNT(words), json_string_value(item), &which);
    *out = word ? values[which] : json_number_value(item);
    return word || json_is_number(item);
}

static bool read_value(const json_t *item, slv_meta_type type, uint32_t i, void *values) {
    json_int_t integer = 0;
    double real = 0;
    switch (type) {
    case SLV_META_STRING:
        /* a string ends at its first zero byte: what follows would be lost */
        if (!read_integer(item, 1, UINT8_MAX, &integer))
            return false;
        ((uint8_t *)values)[i] = (uint8_t)integer;
        return true;
    case SLV_META_INT8:
        if (!read_integer(item, INT8_MIN, INT8_MAX, &integer))
            return false;
        ((int8_t *)values)[i] = (int8_t)integer;
        return true;
    case SLV_META_INT16:
        if (!read_integer(item, INT16_MIN, INT16_MAX, &integer))
            return false;
        ((int16_t *)values)[i] = (int16_t)integer;
        return true;
    case SLV_META_INT32:
        if (!read_integer(item, INT32_MIN, INT32_MAX, &integer))
            return false;
        ((int32_t *)values)[i] = (int32_t)integer;
        return true;
    case SLV_META_FLOAT:
        if (!read_real(item, &real))
            return false;
        ((float *)values)[i] = (float)real;
        return true;
    case SLV_META_DOUBLE:
        break;
    }
    if (!read_real(item, &real))
        return false;
    ((double *)values)[i] = real;
    return true;
}

static slv_result read_entry(const slv_env *env, const char *path, const json_t *item,
                             slv_ptx_writer *writer) {
    const char *key = json_string_value(json_object_get(item, "key"));
    const json_t *list = json_object_get(item, "values"), *text = json_object_get(item, "value");
    slv_ptx_meta meta = {.key = key};
    int type;
    if (!key || !read_word(item, "type", slvi_index_meta, &type) ||
        (!json_is_array(list) && !(type == SLV_META_STRING && json_is_string(text))))
        return slvi_fail(env, SLV_ERROR_FORMAT,
                         "%s: a metadata entry lacks its key, type or values", path);
    meta.type = (slv_meta_type)type;
    if (json_is_string(text)) {
        meta.count = (uint32_t)json_string_length(text);
        meta.values = json_string_value(text);
        return slv_ptx_writer_set_meta(writer, &meta);
    }
    meta.count = (uint32_t)json_array_size(list);
    void *values;
    slv_result result = slvi_alloc(env, path, meta.count, sizeof(double), &values);
    if (result)
        return result;
    for (uint32_t i = 0; i < meta.count && !result; i++)
        if (!read_value(json_array_get(list, i), meta.type, i, values))
            result = slvi_fail(env, SLV_ERROR_FORMAT, "%s: metadata %.100s: value %u is no %s",
                               path, key, i, json_string_value(json_object_get(item, "type")));
    meta.values = values;
    if (!result)
        result = slv_ptx_writer_set_meta(writer, &meta);
    slvi_free(values);
    return result;
}

slv_result slvi_index_read_meta(const slv_env *env, const char *path, const json_t *root,
                                slv_ptx_writer *writer) {
    const json_t *list = json_object_get(root, "meta");
    slv_result result = SLV_OK;
    for (size_t i = 0; i < json_array_size(list) && !result; i++)
        result = read_entry(env, path, json_array_get(list, i), writer);
    return result;
}
