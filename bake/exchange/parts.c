/* The record of a merge: one entry of metadata, as JSON. */
#include "exchange/parts.h"
#include "base/json.h"

#include "exchange/index.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { MOST_PARTS = 65536, MOST_NAMED = 4096 };

json_t *slvi_parts_entry(const slv_env *env, const char *key, const char *merged) {
    return json_pack("[o, o]", slvi_index_text(env, key), slvi_index_text(env, merged));
}

/* What may be another one in each file. */
static json_t *describe_params(const slv_ptx_writer_params *params) {
    return json_pack("{s:s, s:o, s:o, s:o, s:b}", "data_type", slv_type_name(params->type),
                     "border_u", json_string(slvi_index_border((int)params->border_u)), "border_v",
                     json_string(slvi_index_border((int)params->border_v)), "edge_filter",
                     json_string(slvi_index_filter((int)params->edge_filter)), "reductions",
                     (int)!params->no_reductions);
}

json_t *slvi_parts_describe(const slv_env *env, const char *path,
                            const slv_ptx_writer_params *params, uint32_t nverts, json_t *meta) {
    const char *slash = strrchr(path, '/');
    return json_pack("{s:o, s:I, s:I, s:o, s:o}", "name",
                     slvi_index_text(env, slash ? slash + 1 : path), "faces",
                     (json_int_t)params->nfaces, "vertices", (json_int_t)nverts, "was",
                     describe_params(params), "meta", meta);
}

slv_result slvi_parts_record(const slv_env *env, const char *path,
                             const slv_ptx_writer_params *merged, json_t *parts,
                             slv_ptx_writer *writer) {
    json_t *root =
        json_pack("{s:i, s:o, s:o}", "schema", 1, "is", describe_params(merged), "parts", parts);
    char *text = root ? json_dumps(root, JSON_COMPACT) : NULL;
    json_decref(root);
    if (!text)
        return slvi_fail(env, SLV_ERROR_MEMORY, "%s: no memory to record its parts", path);
    slv_ptx_meta meta = {.key = SLV_PARTS_KEY,
                         .type = SLV_META_STRING,
                         .count = (uint32_t)strlen(text),
                         .values = text};
    slv_result result = slv_ptx_writer_set_meta(writer, &meta);
    free(text);
    return result;
}

/* What the part was, where the file still is what the merge made of it: whoever changed it since
 * wanted the change. */
static void read_changes(const json_t *was, const json_t *is, const slv_ptx_writer_params *now,
                         slv_exchange_params *out) {
    slv_type type;
    const char *name = json_string_value(json_object_get(was, "data_type")),
               *merged = json_string_value(json_object_get(is, "data_type"));
    int u = slvi_index_value(slvi_index_border, json_object_get(was, "border_u")),
        v = slvi_index_value(slvi_index_border, json_object_get(was, "border_v")),
        filter = slvi_index_value(slvi_index_filter, json_object_get(was, "edge_filter"));
    const json_t *reductions = json_object_get(was, "reductions");
    if (name && merged && strcmp(merged, slv_type_name(now->type)) == 0 &&
        slv_type_from_name(name, &type)) {
        out->changes |= SLV_EXCHANGE_TYPE;
        out->type = type;
    }
    if (u >= 0 && slvi_index_value(slvi_index_border, json_object_get(is, "border_u")) ==
                      (int)now->border_u) {
        out->changes |= SLV_EXCHANGE_BORDER_U;
        out->border_u = (slv_border_mode)u;
    }
    if (v >= 0 && slvi_index_value(slvi_index_border, json_object_get(is, "border_v")) ==
                      (int)now->border_v) {
        out->changes |= SLV_EXCHANGE_BORDER_V;
        out->border_v = (slv_border_mode)v;
    }
    if (filter >= 0 && slvi_index_value(slvi_index_filter, json_object_get(is, "edge_filter")) ==
                           (int)now->edge_filter) {
        out->changes |= SLV_EXCHANGE_EDGE_FILTER;
        out->edge_filter = (slv_edge_filter)filter;
    }
    if (json_is_boolean(reductions) &&
        json_is_true(json_object_get(is, "reductions")) == !now->no_reductions) {
        out->changes |= SLV_EXCHANGE_REDUCTIONS;
        out->no_reductions = json_is_false(reductions);
    }
}

/* A record may come from anybody: what it calls a file must be a file in the folder. */
static bool is_safe(const char *name) {
    size_t length = name ? strlen(name) : 0;
    return length > 0 && length < 256 && !strchr(name, '/') && name[0] != '.' &&
           slv_ptx_is_name(name);
}

/* The old name, unless it is none for a file or another part has it. */
static void choose_name(slvi_parts *parts, uint32_t index, const char *wanted) {
    slvi_part *part = &parts->list[index];
    bool good = is_safe(wanted) && parts->count <= MOST_NAMED;
    for (uint32_t i = 0; i < index && good; i++)
        good = strcasecmp(parts->list[i].name, wanted) != 0;
    if (good)
        snprintf(part->name, sizeof part->name, "%s", wanted);
    else
        snprintf(part->name, sizeof part->name, "part_%04u.ptx", index);
}

static slv_result bad_record(const slv_env *env, const slv_ptx *ptx, const char *what) {
    return slvi_fail(env, SLV_ERROR_FORMAT, "%s: the record of its parts: %s", slv_ptx_name(ptx),
                     what);
}

static slv_result read_list(const slv_env *env, const slv_ptx *ptx, slvi_parts *out) {
    const json_t *list = json_object_get(out->root, "parts"),
                 *is = json_object_get(out->root, "is");
    const slv_ptx_writer_params now = slv_ptx_writer_params_like(ptx);
    const slv_ptx_meta *positions = slv_ptx_find_meta(ptx, slvi_geometry_keys[SLVI_POSITIONS]);
    uint64_t nfaces = 0, nverts = 0;
    size_t count = json_array_size(list);
    if (!count || count > MOST_PARTS)
        return bad_record(env, ptx, "it has none, or too many");
    slv_result result = slvi_alloc(env, slv_ptx_name(ptx), count, sizeof *out->list, &out->list);
    if (result)
        return result;
    out->count = (uint32_t)count;
    for (uint32_t i = 0; i < count; i++) {
        const json_t *item = json_array_get(list, i), *faces = json_object_get(item, "faces"),
                     *verts = json_object_get(item, "vertices");
        slvi_part *part = &out->list[i];
        json_int_t n = json_integer_value(faces), v = json_integer_value(verts);
        if (!json_is_integer(faces) || n < 0 || n > (json_int_t)now.nfaces || v < 0 ||
            v > INT32_MAX)
            return bad_record(env, ptx, "a number of faces or vertices that cannot be");
        part->first = (uint32_t)nfaces;
        part->count = (uint32_t)n;
        part->vertices = (slvi_vertices){(uint32_t)nverts, (uint32_t)v};
        part->meta = json_object_get(item, "meta");
        nfaces += (uint64_t)n;
        nverts += (uint64_t)v;
        if (nfaces > now.nfaces || nverts > INT32_MAX)
            break;
        choose_name(out, i, json_string_value(json_object_get(item, "name")));
        read_changes(json_object_get(item, "was"), is, &now, &part->changes);
    }
    if (nfaces != now.nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "%s: the record of its parts is of another number of faces than %u",
                         slv_ptx_name(ptx), now.nfaces);
    for (uint32_t i = 0; i < count; i++)
        out->list[i].has_vertices = positions && positions->count == 3 * nverts;
    return SLV_OK;
}

slv_result slvi_parts_read(const slv_env *env, const slv_ptx *ptx, slvi_parts *out) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    slv_result result = SLV_OK;
    json_error_t error;
    *out = (slvi_parts){.root = NULL};
    for (uint32_t i = 0; i < info->nmeta && !result && !out->root; i++) {
        const slv_ptx_meta *meta;
        if ((result = slv_ptx_load_meta(ptx, i, &meta)) || strcmp(meta->key, SLV_PARTS_KEY) != 0)
            continue;
        result = meta->type == SLV_META_STRING
                     ? slvi_json_load(meta->values, meta->count, 0, &out->root, &error)
                     : SLV_ERROR_FORMAT;
        if (result == SLV_ERROR_MEMORY)
            slvi_fail(env, result, "%s: no memory for the record of parts", slv_ptx_name(ptx));
        else if (result)
            result = bad_record(env, ptx, "it cannot be read");
    }
    if (!result && !out->root)
        result =
            slvi_fail(env, SLV_ERROR_UNSUPPORTED, "%s: has no record of parts", slv_ptx_name(ptx));
    return result ? result : read_list(env, ptx, out);
}

slv_result slvi_parts_at(const slv_env *env, const slv_ptx *ptx, const uint32_t *at,
                         uint32_t nparts, slvi_parts *out) {
    uint32_t nfaces = slv_ptx_get_info(ptx)->nfaces;
    *out = (slvi_parts){.root = NULL};
    slv_result result = slvi_alloc(env, slv_ptx_name(ptx), nparts, sizeof *out->list, &out->list);
    if (result)
        return result;
    out->count = nparts;
    for (uint32_t i = 0; i < nparts; i++) {
        uint32_t end = i + 1 < nparts ? at[i + 1] : nfaces;
        if (end <= at[i] || end > nfaces || (!i && at[0]))
            return slvi_fail(env, SLV_ERROR_ARGUMENT,
                             "%s: parts begin at face 0 and at larger ones, of %u",
                             slv_ptx_name(ptx), nfaces);
        out->list[i].first = at[i];
        out->list[i].count = end - at[i];
        choose_name(out, i, NULL);
    }
    return SLV_OK;
}

void slvi_parts_free(slvi_parts *parts) {
    json_decref(parts->root);
    slvi_free(parts->list);
}
