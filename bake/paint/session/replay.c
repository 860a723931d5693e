/* A session done again from its beginning, in another one of other resolutions. */
#include "session/session_data.h"

#include "base/json.h"
#include "base/log.h"
#include "base/memory.h"

#include <selvage/ptx.h>

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct replaying {
    const slv_session *from;
    slv_session *to;
    int scale; /* log2 */
} replaying;

static slv_result no_memory(const replaying *r) {
    return slvi_fail(&r->from->env, SLV_ERROR_MEMORY, "%s: no memory for a line", r->from->path);
}

/* A side of a face as it is there; out of range it stays, and is refused by whom it is given. */
static json_t *scaled_res(const replaying *r, int u, int v) {
    return json_pack("[ii]", u + r->scale, v + r->scale);
}

/* The edit that gives a layer its resolutions there, after a texture was loaded into it. */
static slv_result resize_loaded(const replaying *r, const json_t *load, json_t **out) {
    const slv_env *env = &r->from->env;
    const char *file = json_string_value(json_object_get(load, "file"));
    char *path = NULL;
    slv_ptx *ptx = NULL;
    json_t *faces = json_array(), *res = json_array();
    slv_result result =
        file && !strchr(file, '/')
            ? slvi_session_path(env, r->from->path, file, &path)
            : slvi_fail(env, SLV_ERROR_FORMAT, "%s: file is not what it should be", r->from->path);
    *out = NULL;
    if (!result)
        result = slv_ptx_open(env, path, &ptx);
    for (uint32_t f = 0; !result && f < slv_ptx_get_info(ptx)->nfaces; f++) {
        slv_ptx_face info;
        if ((result = slv_ptx_get_face(ptx, f, &info)))
            break;
        if (json_array_append_new(faces, json_integer(f)) != 0 ||
            json_array_append_new(res, scaled_res(r, info.res.u, info.res.v)) != 0)
            result = no_memory(r);
    }
    if (!result && !(*out = json_pack("{s:s, s:O, s:O, s:O}", "op", "resize", "layer",
                                      json_object_get(load, "layer"), "faces", faces, "res", res)))
        result = no_memory(r);
    json_decref(faces);
    json_decref(res);
    slv_ptx_close(ptx);
    slvi_free(path);
    return result;
}

/* An edit or a stroke at other resolutions: what is counted in texels. */
static slv_result scale_edit(const replaying *r, json_t *edit) {
    json_t *res = json_object_get(edit, "res"), *radius = json_object_get(edit, "radius"), *pair;
    const char *unit = json_string_value(json_object_get(edit, "unit"));
    size_t i;
    bool fine = true;
    json_array_foreach(res, i, pair) {
        int u = (int)json_integer_value(json_array_get(pair, 0)),
            v = (int)json_integer_value(json_array_get(pair, 1));
        fine &= json_array_set_new(res, i, scaled_res(r, u, v)) == 0;
    }
    if (unit && strcmp(unit, "texels") == 0 && json_is_number(radius))
        fine &= json_object_set_new(edit, "radius",
                                    json_real(ldexp(json_number_value(radius), r->scale))) == 0;
    return fine ? SLV_OK : no_memory(r);
}

static bool is_load(const json_t *edit) {
    const char *op = json_string_value(json_object_get(edit, "op"));
    return op && strcmp(op, "load") == 0;
}

/* A line at other resolutions: a group, in which layers that were loaded are resized. */
static slv_result scale_line(const replaying *r, json_t *line, json_t **out) {
    json_t *edits = json_object_get(line, "edits"), *list = json_array(), *edit, *resize;
    const char *name = json_string_value(json_object_get(line, "name"));
    size_t i;
    slv_result result = SLV_OK;
    *out = NULL;
    if (!json_is_array(edits) && !is_load(line)) {
        json_decref(list);
        result = scale_edit(r, line);
        *out = result ? NULL : json_incref(line);
        return result;
    }
    edits = json_is_array(edits) ? json_incref(edits) : json_pack("[O]", line);
    json_array_foreach(edits, i, edit) {
        if (result || (result = scale_edit(r, edit)))
            break;
        if (json_array_append(list, edit) != 0)
            result = no_memory(r);
        if (!result && r->scale && is_load(edit) && !(result = resize_loaded(r, edit, &resize)) &&
            json_array_append_new(list, resize) != 0)
            result = no_memory(r);
    }
    json_decref(edits);
    if (!result && !(*out = json_pack("{s:s, s:s, s:O}", "op", "group", "name",
                                      name ? name : "load", "edits", list)))
        result = no_memory(r);
    json_decref(list);
    return result;
}

static slv_result replay_line(const replaying *r, const slvi_journal_text *text, uint64_t i) {
    const slvi_journal_line *line = &text->lines[i];
    char *copy = NULL, *scaled = NULL; /* the first with the brace that closes it */
    size_t size = line->size + 1;
    json_t *root = NULL, *out = NULL;
    json_error_t error;
    slv_result result = slvi_alloc_plain(&r->from->env, "journal", size, 1, &copy);
    if (result)
        return result;
    memcpy(copy, text->text + line->at, size - 1);
    copy[size - 1] = '}';
    if ((result = slvi_json_load(copy, size, JSON_REJECT_DUPLICATES, &root, &error)))
        result = slvi_fail(&r->from->env, result, "%s: line %" PRIu64 ": %s", r->from->journal.path,
                           line->number, error.text);
    if (!result && !(result = scale_line(r, root, &out)) &&
        !(scaled = json_dumps(out, JSON_COMPACT | JSON_REAL_PRECISION(17))))
        result = no_memory(r);
    if (!result)
        result = slv_session_run(r->to, 0, false, r->from->path, scaled, strlen(scaled));
    free(scaled);
    json_decref(out);
    json_decref(root);
    slvi_free(copy);
    return result;
}

/* Lines that were not undone. */
static slv_result replay_all(const replaying *r) {
    const slv_session *from = r->from;
    slvi_journal_text text = {0};
    uint64_t *live = NULL, count = 0, undone = 0;
    bool whole = true;
    slv_result result = slvi_journal_scan(&from->journal, &text);
    if (!result)
        result = slvi_alloc(&from->env, "journal", text.count, sizeof *live, &live);
    if (!result && (!slvi_journal_survivors(&text, 0, live, &count, &undone, &whole) || !whole))
        result = slvi_fail(&from->env, SLV_ERROR_FORMAT,
                           "%s: lines are missing, and it cannot be done again from its beginning",
                           from->journal.path);
    for (uint64_t i = 0; i < count && !result; i++)
        result = replay_line(r, &text, live[i]);
    slvi_journal_free(&text);
    slvi_free(live);
    return result;
}

slv_result slv_session_replay(const slv_env *env, const char *from, const char *path, int scale,
                              slv_session **out) {
    const slv_session_params look = {.unkept = true};
    slv_session *source = NULL;
    slv_res *res = NULL;
    *out = NULL;
    slv_result result = slv_session_open(env, from, &look, &source);
    if (result)
        return result;
    slv_session_params params = source->params;
    uint32_t nfaces = params.document.flat.nfaces;
    params.unkept = false;
    /* before any was resized, as it says; it was not, if it does not */
    const slv_res *began = source->began ? params.document.flat.res : source->document->flat.res;
    result = slvi_alloc(&source->env, "session", nfaces, sizeof *res, &res);
    for (uint32_t f = 0; f < nfaces && !result; f++) {
        int u = began[f].u + scale, v = began[f].v + scale;
        if (u < 0 || v < 0 || u > SLV_MAX_LOG2_RES || v > SLV_MAX_LOG2_RES)
            result =
                slvi_fail(&source->env, SLV_ERROR_LIMIT,
                          "%s: face %u would have 2^%d x 2^%d texels", path, (unsigned)f, u, v);
        else
            res[f] = (slv_res){(int8_t)u, (int8_t)v};
    }
    params.document.flat.res = res;
    params.document.scratch = NULL;
    if (!result && !(result = slv_session_create(env, path, source->mesh, &params, out))) {
        const replaying r = {source, *out, scale};
        if ((result = replay_all(&r)) || (result = slv_session_save(*out))) {
            slv_session_destroy(*out);
            *out = NULL;
            if (slv_session_remove(env, path))
                slvi_logf(env, SLV_LOG_WARNING, "%s: stays behind", path);
        }
    }
    slvi_free(res);
    slv_session_destroy(source);
    return result;
}
