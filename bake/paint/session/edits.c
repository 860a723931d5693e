/* What is done to a document as JSON, and done again. */
#include "session/session_data.h"

#include "base/json.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/names.h"
#include "base/words.h"

#include <selvage/ptx.h>

#include <string.h>

static const char *const op_names[SLVI_OP_COUNT] = {
    "add-layer", "remove-layer", "move-layer", "duplicate-layer", "merge-down", "set-layer",
    "add-mask",  "remove-mask",  "resize",     "select",          "load"};

/* What each has besides. */
static const char *const op_keys[SLVI_OP_COUNT] = {
    [SLVI_OP_ADD] = "layer|above|name|opacity|blend|hidden|locked|type|fill|res",
    [SLVI_OP_REMOVE] = "layer",
    [SLVI_OP_MOVE] = "layer|index",
    [SLVI_OP_DUPLICATE] = "layer|copy",
    [SLVI_OP_MERGE] = "layer",
    [SLVI_OP_SET] = "layer|name|opacity|blend|hidden|locked",
    [SLVI_OP_ADD_MASK] = "layer|value",
    [SLVI_OP_REMOVE_MASK] = "layer",
    [SLVI_OP_RESIZE] = "layer|faces|res",
    [SLVI_OP_SELECT] = "faces|layer",
    [SLVI_OP_LOAD] = "layer|file"};

/* A list that has all of its values, or NULL. */
static json_t *whole(json_t *list, uint32_t count) {
    if (json_array_size(list) == count)
        return list;
    json_decref(list);
    return NULL;
}

static json_t *res_of(uint32_t count, const slv_res *res) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < count; i++)
        json_array_append_new(list, json_pack("[ii]", (int)res[i].u, (int)res[i].v));
    return whole(list, count);
}

static json_t *faces_of(uint32_t count, const uint32_t *faces) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < count; i++)
        json_array_append_new(list, json_integer(faces ? faces[i] : i));
    return whole(list, count);
}

static json_t *fill_of(uint32_t count, const float *values) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < count; i++)
        json_array_append_new(list, json_real((double)values[i]));
    return whole(list, count);
}

/* What is put into an object; a value that is not there is want of memory. */
typedef struct putter {
    json_t *to;
    bool lacked;
} putter;

static void put(putter *p, const char *key, json_t *value) {
    p->lacked |= json_object_set_new(p->to, key, value) != 0;
}

/* False if the name is not UTF-8. */
static bool put_props(putter *p, const slv_layer_props *props) {
    json_t *name;
    slv_result result = slvi_json_text(props->name, &name);
    put(p, "name", name);
    put(p, "opacity", json_real((double)props->opacity));
    put(p, "blend", json_string(slv_blend_name(props->blend)));
    put(p, "hidden", json_boolean(props->hidden));
    put(p, "locked", json_boolean(props->locked));
    return result != SLV_ERROR_ARGUMENT;
}

slv_result slvi_edit_to_json(const slv_env *env, const slvi_op *op, uint32_t nfaces, json_t **out) {
    putter p = {.to = json_object()};
    bool good = true, props = op->kind == SLVI_OP_ADD || op->kind == SLVI_OP_SET;
    put(&p, "op", json_string(op_names[op->kind]));
    put(&p, "layer", json_integer(op->id));
    if (props)
        good = put_props(&p, &op->props);
    switch (op->kind) {
    case SLVI_OP_ADD:
        put(&p, "above", json_integer(op->other));
        put(&p, "type", json_string(slv_type_name(op->type)));
        if (op->fill)
            put(&p, "fill", fill_of(op->count, op->fill));
        if (op->res)
            put(&p, "res", res_of(nfaces, op->res));
        break;
    case SLVI_OP_RESIZE:
        put(&p, "res", res_of(op->count, op->res));
        put(&p, "faces", faces_of(op->count, op->faces));
        break;
    case SLVI_OP_SELECT:
        put(&p, "faces", faces_of(op->count, op->faces));
        break;
    case SLVI_OP_MOVE:
        put(&p, "index", json_integer(op->index));
        break;
    case SLVI_OP_DUPLICATE:
        put(&p, "copy", json_integer(op->other));
        break;
    case SLVI_OP_ADD_MASK:
        put(&p, "value", json_real((double)op->value));
        break;
    default:
        break;
    }
    *out = p.to;
    if (good && !p.lacked)
        return SLV_OK;
    json_decref(p.to);
    *out = NULL;
    return good ? slvi_fail(env, SLV_ERROR_MEMORY, "journal: no memory for a line")
                : slvi_fail(env, SLV_ERROR_ARGUMENT, "journal: the name of layer %u is not UTF-8",
                            (unsigned)op->id);
}

/* ---- doing it again ---- */

typedef struct reading {
    slv_document *document;
    const char *name; /* of the journal, for messages */
    const json_t *edit;
    slv_result result;
} reading;

/* What a key is to be. */
static void wrong(reading *r, const char *key) {
    static const struct {
        const char *key, *expected;
    } all[] = {{"layer", "a layer's id"},
               {"above", "the id of the layer below it, 0 for the topmost"},
               {"index", "a place from the lowest layer up, 0 first"},
               {"copy", "an id that no layer had, or 0"},
               {"name", "a text of less than 64 bytes"},
               {"opacity", "a number from 0 to 1"},
               {"value", "a number from 0 to 1"},
               {"blend", "normal, multiply, screen, overlay, darken, lighten, add, color, replace "
                         "or subtract"},
               {"hidden", "true or false"},
               {"locked", "true or false"},
               {"type", "uint8, uint16, half or float"},
               {"fill", "a number for each channel"},
               {"faces", "a list of faces"},
               {"res", "[log2 of width, log2 of height] of each face"},
               {"file", "the name of a texture beside the journal"}};
    size_t i = 0;
    while (i + 1 < SLVI_COUNT(all) && strcmp(all[i].key, key) != 0)
        i++;
    if (!r->result)
        r->result = slvi_fail(&r->document->env, SLV_ERROR_FORMAT, "%s: %s: expected %s", r->name,
                              key, all[i].expected);
}

static bool has(const reading *r, const char *key) {
    return json_object_get(r->edit, key) != NULL;
}

static uint32_t get_number(reading *r, const char *key) {
    const json_t *value = json_object_get(r->edit, key);
    json_int_t number = json_integer_value(value);
    if (!json_is_integer(value) || number < 0 || number > UINT32_MAX) {
        wrong(r, key);
        return 0;
    }
    return (uint32_t)number;
}

static float get_real(reading *r, const json_t *value, const char *key) {
    double number = json_number_value(value);
    if (!json_is_number(value) || !(number >= -3e38 && number <= 3e38)) {
        wrong(r, key);
        return 0;
    }
    return (float)number;
}

static void get_flag(reading *r, const char *key, bool *flag) {
    const json_t *value = json_object_get(r->edit, key);
    if (value && !json_is_boolean(value))
        wrong(r, key);
    *flag = value ? json_is_true(value) : *flag;
}

/* Those that a line says; the others stay. */
static void get_props(reading *r, slv_layer_props *props) {
    const json_t *blend = json_object_get(r->edit, "blend");
    if (has(r, "opacity"))
        props->opacity = get_real(r, json_object_get(r->edit, "opacity"), "opacity");
    get_flag(r, "hidden", &props->hidden);
    get_flag(r, "locked", &props->locked);
    if (blend && !slv_blend_from_name(json_string_value(blend), &props->blend))
        wrong(r, "blend");
    if (!has(r, "name"))
        return;
    const char *name = json_string_value(json_object_get(r->edit, "name"));
    if (!name || strlen(name) >= sizeof props->name)
        wrong(r, "name");
    else
        memcpy(props->name, name, strlen(name) + 1);
}

/* Lists of faces and resolutions, for slvi_free. */
static uint32_t *get_faces(reading *r, uint32_t *count) {
    const json_t *list = json_object_get(r->edit, "faces");
    uint32_t *faces = NULL;
    *count = (uint32_t)json_array_size(list);
    if (!json_is_array(list) || json_array_size(list) > r->document->flat.nfaces)
        wrong(r, "faces");
    if (!r->result)
        r->result = slvi_alloc(&r->document->env, "journal", *count, sizeof *faces, &faces);
    for (uint32_t i = 0; !r->result && i < *count; i++) {
        json_int_t face = json_integer_value(json_array_get(list, i));
        if (face < 0 || face >= r->document->flat.nfaces)
            wrong(r, "faces");
        faces[i] = (uint32_t)face;
    }
    return faces;
}

static slv_res *get_res(reading *r, uint32_t count) {
    const json_t *list = json_object_get(r->edit, "res");
    slv_res *res = NULL;
    if (json_array_size(list) != count)
        wrong(r, "res");
    if (!r->result)
        r->result = slvi_alloc(&r->document->env, "journal", count, sizeof *res, &res);
    for (uint32_t i = 0; !r->result && i < count; i++) {
        const json_t *pair = json_array_get(list, i);
        json_int_t u = json_integer_value(json_array_get(pair, 0)),
                   v = json_integer_value(json_array_get(pair, 1));
        if (json_array_size(pair) != 2 || u < 0 || v < 0 || u > SLV_MAX_LOG2_RES ||
            v > SLV_MAX_LOG2_RES)
            wrong(r, "res");
        else
            res[i] = (slv_res){(int8_t)u, (int8_t)v};
    }
    return res;
}

static void add_layer(reading *r) {
    slv_layer_props props = {.opacity = 1};
    slv_layer_params params = {.props = &props,
                               .above = has(r, "above") ? get_number(r, "above") : 0,
                               .id = has(r, "layer") ? get_number(r, "layer") : 0};
    const json_t *fill = json_object_get(r->edit, "fill");
    float texel[SLVI_MOST_CHANNELS] = {0};
    slv_res *res = NULL;
    get_props(r, &props);
    if (has(r, "type") &&
        !slv_type_from_name(json_string_value(json_object_get(r->edit, "type")), &params.type))
        wrong(r, "type");
    if (fill && json_array_size(fill) != r->document->nchannels)
        wrong(r, "fill");
    for (uint32_t c = 0; fill && !r->result && c < r->document->nchannels; c++)
        texel[c] = get_real(r, json_array_get(fill, c), "fill");
    if (!r->result && json_object_get(r->edit, "res"))
        res = get_res(r, r->document->flat.nfaces);
    params.fill = fill ? texel : NULL;
    params.res = res;
    if (!r->result)
        r->result = slv_document_add_layer(r->document, &params, NULL);
    slvi_free(res);
}

static void resize(reading *r) {
    uint32_t count = 0, id = get_number(r, "layer"), *faces = get_faces(r, &count);
    slv_res *res = r->result ? NULL : get_res(r, count);
    if (!r->result)
        r->result = slv_document_resize(r->document, id, count, faces, res);
    slvi_free(faces);
    slvi_free(res);
}

static void choose(reading *r) {
    uint32_t count = 0, *faces = get_faces(r, &count);
    if (!r->result)
        r->result = slv_document_select(r->document, count, faces);
    slvi_free(faces);
}

static slv_result apply(reading *r, slvi_op_kind kind) {
    slv_document *document = r->document;
    slv_layer_info info = {0};
    uint32_t id = get_number(r, "layer"), other = 0;
    float value = 0;
    if (kind == SLVI_OP_MOVE || kind == SLVI_OP_DUPLICATE)
        other = get_number(r, kind == SLVI_OP_MOVE ? "index" : "copy");
    else if (kind == SLVI_OP_SET && slv_document_layer(document, id, &info))
        get_props(r, &info.props);
    else if (kind == SLVI_OP_ADD_MASK)
        value = get_real(r, json_object_get(r->edit, "value"), "value");
    if (r->result)
        return r->result;
    switch (kind) {
    case SLVI_OP_REMOVE:
        return slv_document_remove_layer(document, id);
    case SLVI_OP_MOVE:
        return slv_document_move_layer(document, id, other);
    case SLVI_OP_DUPLICATE:
        return slvi_document_duplicate(document, id, other, NULL);
    case SLVI_OP_MERGE:
        return slv_document_merge_down(document, id);
    case SLVI_OP_SET:
        return slv_document_set_layer(document, id, &info.props);
    case SLVI_OP_ADD_MASK:
        return slv_document_add_mask(document, id, value);
    default:
        return slv_document_remove_mask(document, id);
    }
}

/* A texture that was put into a layer lies beside the journal. */
static slv_result load(reading *r, const char *folder) {
    const slv_env *env = &r->document->env;
    const char *file = json_string_value(json_object_get(r->edit, "file"));
    uint32_t id = get_number(r, "layer");
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL;
    char *path = NULL;
    if (!file || strchr(file, '/'))
        wrong(r, "file");
    if (!r->result && !(r->result = slvi_session_path(env, folder, file, &path)) &&
        !(r->result = slv_ptx_open(env, path, &ptx)) &&
        !(r->result = slv_ptx_load_texture(env, ptx, &texture)))
        r->result = slv_document_load_layer(r->document, id, texture);
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
    slvi_free(path);
    return r->result;
}

/* Whether a word is one of a list, "a|b|c". */
static bool is_of(const char *word, const char *words) {
    size_t length = strlen(word);
    for (; *words; words += strcspn(words, "|"), words += *words == '|')
        if (strcspn(words, "|") == length && strncmp(words, word, length) == 0)
            return true;
    return false;
}

slv_result slvi_edit_keys(const slv_env *env, const char *name, json_t *edit, const char *known) {
    char hint[SLV_WORDS_HINT];
    const char *key;
    json_t *value;
    json_object_foreach(edit, key, value) {
        if (!is_of(key, "op|n|crc") && !is_of(key, known))
            return slvi_fail(env, SLV_ERROR_FORMAT, "%s: unknown key '%.40s'%s", name, key,
                             slv_words_hint(key, known, hint));
    }
    return SLV_OK;
}

/* An operation that there is not. */
static slv_result wrong_op(const reading *r, const char *op) {
    char known[256] = "stroke|fill|set|group|undo|redo", hint[SLV_WORDS_HINT];
    for (size_t i = 0; i < SLVI_OP_COUNT; i++)
        slvi_words_add(known, sizeof known, op_names[i]);
    return slvi_fail(&r->document->env, SLV_ERROR_FORMAT,
                     "%s: op: expected an operation of sessions%s", r->name,
                     op && !is_of(op, known) ? slv_words_hint(op, known, hint) : "");
}

slv_result slvi_edit_apply(slv_document *document, const char *name, json_t *edit,
                           const char *folder) {
    reading r = {document, name, edit, SLV_OK};
    const char *op = json_string_value(json_object_get(edit, "op"));
    int kind;
    if (!slvi_name_find(op_names, SLVI_OP_COUNT, op, &kind))
        return wrong_op(&r, op);
    if ((r.result = slvi_edit_keys(&document->env, name, edit, op_keys[kind])))
        return r.result;
    if (kind == SLVI_OP_ADD)
        add_layer(&r);
    else if (kind == SLVI_OP_RESIZE)
        resize(&r);
    else if (kind == SLVI_OP_SELECT)
        choose(&r);
    else if (kind == SLVI_OP_LOAD)
        return load(&r, folder);
    else
        return apply(&r, (slvi_op_kind)kind);
    return r.result;
}
