/* What is done to a session's document, which goes into the journal: edits, and lines of scripts.
 */
#include "session/session_data.h"

#include "base/file.h"
#include "base/json.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/output.h"
#include "history/history.h"
#include "script/script_data.h"

#include <selvage/ptx.h>

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- what is done to the document ---- */

static slv_result keep_edit(slv_session *session, json_t *edit) {
    if (session->params.unkept) {
        json_decref(edit);
        return SLV_OK;
    }
    if (json_array_append_new(session->edits, edit) == 0)
        return SLV_OK;
    return slvi_fail(&session->env, SLV_ERROR_MEMORY, "%s: no memory for a line",
                     session->journal.path);
}

/* Puts a texture beside the journal, on the disk before the line that names it. */
static slv_result keep_texture(slv_session *session, const slv_texture *texture, json_t *edit) {
    char name[64], *path = NULL;
    snprintf(name, sizeof name, "texture-%" PRIu64 "-%zu.ptx", session->journal.next,
             json_array_size(session->edits));
    slv_result result = slvi_session_path(&session->env, session->path, name, &path);
    if (!result &&
        !(result = slv_ptx_save(&session->env, path, texture, session->adjacency, NULL))) {
        int file = open(path, O_RDONLY | O_CLOEXEC);
        if (file < 0 || (!session->params.relaxed && fsync(file) != 0))
            result = slvi_fail(&session->env, SLV_ERROR_IO, "%s: %s", path, strerror(errno));
        if (file >= 0)
            close(file);
    }
    if (!result && json_object_set_new(edit, "file", json_string(name)) != 0)
        result = slvi_fail(&session->env, SLV_ERROR_MEMORY, "%s: no memory for a line", path);
    slvi_free(path);
    return result;
}

static slv_result watch_edit(void *user, const slvi_op *op) {
    slv_session *session = user;
    json_t *edit = NULL;
    slv_result result = SLV_OK;
    if (session->replaying || session->params.unkept)
        return SLV_OK;
    result = slvi_edit_to_json(&session->env, op, session->document->flat.nfaces, &edit);
    if (!result && op->texture && (result = keep_texture(session, op->texture, edit)))
        json_decref(edit);
    return result ? result : keep_edit(session, edit);
}

static void watch_cancel(void *user) {
    slv_session *session = user;
    json_array_clear(session->edits);
}

static slv_result watch_close(void *user, const char *name) {
    slv_session *session = user;
    json_t *line = NULL;
    if (session->replaying || session->params.unkept || !json_array_size(session->edits))
        return SLV_OK;
    if (json_array_size(session->edits) == 1)
        line = json_incref(json_array_get(session->edits, 0));
    else
        line = json_pack("{s:s, s:s, s:O}", "op", "group", "name", name, "edits", session->edits);
    slv_result result = slvi_journal_append(&session->journal, line);
    json_decref(line);
    json_array_clear(session->edits);
    return result;
}

static slv_result watch_step(void *user, bool redo) {
    slv_session *session = user;
    if (session->replaying || session->params.unkept)
        return SLV_OK;
    json_t *line = json_pack("{s:s}", "op", redo ? "redo" : "undo");
    slv_result result = slvi_journal_append(&session->journal, line);
    json_decref(line);
    return result;
}

static slv_result watch_paint(void *user, uint32_t layer, bool mask) {
    slv_session *session = user;
    (void)mask;
    if (session->replaying || session->running)
        return SLV_OK;
    return slvi_fail(&session->env, SLV_ERROR_ARGUMENT,
                     "%s: layer %u is painted on through its session only", session->path,
                     (unsigned)layer);
}

/* ---- strokes and fills ---- */

slv_result slv_session_painter(slv_session *session, slv_painter **out) {
    const slv_paint_surface_params params = {.scheme = session->params.scheme};
    slv_result result = SLV_OK;
    *out = NULL;
    if (!session->surface)
        result = slv_paint_surface_create(&session->env, session->mesh, &params, &session->surface);
    if (!result && !session->painter)
        result = slv_painter_create(&session->env, session->surface, &session->painter);
    *out = session->painter;
    return result;
}

static slv_result find_layer(void *user, uint32_t id, bool mask, slv_canvas *out) {
    slv_session *session = user;
    return slv_document_canvas(session->document, id, mask, out);
}

slv_result slvi_session_script(slv_session *session, uint32_t layer, bool mask, slv_script **out) {
    const slv_type type = session->document->flat.type;
    const slv_script_params params = {.name = session->journal.path,
                                      .folder = session->path,
                                      .user = session,
                                      .layer = find_layer,
                                      .integers = type == SLV_TYPE_U8 || type == SLV_TYPE_U16};
    slv_painter *painter;
    slv_canvas canvas;
    slv_result result = slv_session_painter(session, &painter);
    *out = NULL;
    if (!result && !(result = slv_document_canvas(session->document, layer, mask, &canvas)))
        result = slv_script_create(painter, &canvas, &params, out);
    return result;
}

slv_result slvi_session_note(slv_session *session, const slv_script *script) {
    uint32_t nfaces = session->document->flat.nfaces;
    slv_script_stats stats, *all = &session->stats;
    slv_script_get_stats(script, &stats);
    slv_result result = session->touched || !stats.faces || session->replaying
                            ? SLV_OK
                            : slvi_alloc(&session->env, "session", nfaces, 1, &session->touched);
    if (result || session->replaying)
        return result;
    const uint32_t *faces = slvi_script_faces(script);
    for (uint32_t i = 0; i < stats.faces; i++) {
        all->faces += !session->touched[faces[i]];
        session->touched[faces[i]] = 1;
    }
    all->operations += stats.operations;
    all->dabs += stats.dabs;
    all->missed += stats.missed;
    all->texels += stats.texels;
    return SLV_OK;
}

void slv_session_get_stats(const slv_session *session, slv_script_stats *out) {
    *out = session->stats;
}

bool slv_session_touched(const slv_session *session, uint32_t face) {
    return session->touched && face < session->document->flat.nfaces && session->touched[face];
}

void slvi_session_make_bare(json_t *line) {
    static const char *const keys[] = {"layer", "mask", "n", "crc"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        json_object_del(line, keys[i]);
}

slv_result slvi_session_paint(slv_session *session, uint32_t layer, bool mask, json_t *line) {
    json_t *bare = json_copy(line);
    slv_script *script = NULL;
    slvi_session_make_bare(bare);
    char *text = json_dumps(bare, JSON_COMPACT | JSON_REAL_PRECISION(17));
    slv_result result = text ? slvi_session_script(session, layer, mask, &script)
                             : slvi_fail(&session->env, SLV_ERROR_MEMORY,
                                         "%s: no memory for a line", session->journal.path);
    if (!result)
        result = slv_script_run(script, session->journal.next, text, strlen(text));
    if (!result)
        result = slvi_session_note(session, script);
    slv_script_destroy(script);
    free(text);
    json_decref(bare);
    return result;
}

/* What a brush's file has that is not known is told once, when it is kept. */
static slv_result tell_unknown(const slv_session *session, const char *path, const char *text,
                               size_t size) {
    const char *const *names;
    slv_brush *brush = NULL;
    slv_result result = slv_brush_parse(&session->env, path, text, size, &brush);
    for (uint32_t i = 0; !result && i < slv_brush_unknown(brush, &names); i++)
        slvi_logf(&session->env, SLV_LOG_WARNING, "%s: %s is not known, and left out", path,
                  names[i]);
    slv_brush_destroy(brush);
    return result;
}

/* The name by which a session that keeps nothing finds a file from its own folder. */
static slv_result name_file(const slv_session *session, const char *path, json_t *holder,
                            const char *key) {
    char *whole = realpath(path, NULL);
    slv_result result =
        whole ? SLV_OK
              : slvi_fail(&session->env, slvi_io_error(errno), "%s: %s", path, strerror(errno));
    if (!result && json_object_set_new(holder, key, json_string(whole)) != 0)
        result = slvi_fail(&session->env, SLV_ERROR_ARGUMENT, "%s: its name is not UTF-8", path);
    free(whole);
    return result;
}

/* Copies a file that a line names, a brush or an image, into the session, and lets the line name
 * that. */
static slv_result keep_file(slv_session *session, const char *folder, const char *kind,
                            json_t *holder, const char *key) {
    const char *name = json_string_value(json_object_get(holder, key)), *base, *path;
    char *from = NULL, *to = NULL, *text = NULL, kept[96];
    size_t size = 0;
    slv_result result;
    if (!name)
        return SLV_OK;
    base = strrchr(name, '/') ? strrchr(name, '/') + 1 : name;
    if ((result =
             slvi_session_path(&session->env, folder && *name != '/' ? folder : "", name, &from)))
        return result;
    path = folder || *name == '/' ? from : name;
    if (session->params.unkept) {
        result = name_file(session, path, holder, key);
    } else if (!(result = slvi_file_read(&session->env, path, &text, &size))) {
        size_t mark =
            (size_t)snprintf(kept, sizeof kept, "%s-%08" PRIx32 "-", kind, slvi_crc(0, text, size));
        bool known = strncmp(base, kept, mark) == 0; /* it comes from a session */
        size_t length = strlen(base);
        /* the ending says what kind of image it is */
        base += !known && length > 60 ? length - 60 : 0;
        snprintf(kept + mark, sizeof kept - mark, "%.60s", known ? base + mark : base);
        result = slvi_session_path(&session->env, session->path, kept, &to);
    }
    if (!result && to && access(to, F_OK) != 0 &&
        (strcmp(kind, "brush") != 0 || !(result = tell_unknown(session, path, text, size))))
        result = slvi_output_write(&session->env, to, text, size);
    if (!result && to && json_object_set_new(holder, key, json_string(kept)) != 0)
        result = slvi_fail(&session->env, SLV_ERROR_ARGUMENT, "%s: its name is not UTF-8", from);
    slvi_free(from);
    slvi_free(to);
    slvi_free(text);
    return result;
}

static slv_result keep_files(slv_session *session, const char *folder, json_t *line) {
    static const char *const images[] = {"stamp", "image"};
    slv_result result = keep_file(session, folder, "brush", line, "brush");
    for (size_t i = 0; i < 2 && !result; i++) {
        json_t *image = json_object_get(line, images[i]);
        result = json_is_object(image) ? keep_file(session, folder, "image", image, "file")
                                       : keep_file(session, folder, "image", line, images[i]);
    }
    return result;
}

const char *slvi_session_name(const json_t *line) {
    const char *op = json_string_value(json_object_get(line, "op"));
    return op && strcmp(op, "fill") == 0                  ? "fill"
           : json_is_true(json_object_get(line, "erase")) ? "erase"
                                                          : "stroke";
}

slv_result slvi_session_keep(slv_session *session, uint32_t layer, bool mask, json_t *line) {
    slvi_session_make_bare(line);
    json_object_set_new(line, "layer", json_integer(layer));
    if (mask)
        json_object_set_new(line, "mask", json_true());
    return keep_edit(session, json_incref(line));
}

static slv_result run_line(slv_session *session, uint32_t layer, bool mask, json_t *line) {
    slvi_edit edit;
    slv_result result = slvi_edit_begin(session->document, slvi_session_name(line), &edit);
    if (result)
        return result;
    session->running = true;
    result = slvi_session_paint(session, layer, mask, line);
    session->running = false;
    if (!result)
        result = slvi_session_keep(session, layer, mask, line);
    return slvi_edit_end(session->document, &edit, NULL, result);
}

slv_result slvi_session_line(slv_session *session, const char *folder, const char *line,
                             size_t size, json_t **out) {
    json_error_t error;
    json_t *root;
    slv_result result = slvi_json_load(line, size, JSON_REJECT_DUPLICATES, &root, &error);
    *out = NULL;
    if (result == SLV_ERROR_MEMORY)
        return slvi_fail(&session->env, result, "%s: a line: no memory to read it", session->path);
    if (!json_is_object(root)) {
        json_decref(root);
        return slvi_fail(&session->env, SLV_ERROR_FORMAT, "%s: a line: %s", session->path,
                         root ? "expected an object" : error.text);
    }
    if ((result = keep_files(session, folder, root)))
        json_decref(root);
    else
        *out = root;
    return result;
}

/* The layer that a line names, or its mask; else those that are there already. */
static slv_result find_target(const slv_session *session, const json_t *line, uint32_t *layer,
                              bool *mask) {
    const json_t *own = json_object_get(line, "layer"), *own_mask = json_object_get(line, "mask");
    json_int_t id = json_integer_value(own);
    if (own && (!json_is_integer(own) || id < 1 || id > UINT32_MAX))
        return slvi_fail(&session->env, SLV_ERROR_FORMAT, "%s: a line: layer: expected its id",
                         session->path);
    if (own_mask && !json_is_boolean(own_mask))
        return slvi_fail(&session->env, SLV_ERROR_FORMAT,
                         "%s: a line: mask: expected true or false", session->path);
    *layer = own ? (uint32_t)id : *layer;
    *mask = own_mask ? json_is_true(own_mask) : *mask && !own;
    return SLV_OK;
}

/* What a line says is set, and what it says itself; also of the layer that it is for. */
static slv_result run_strokes(slv_session *session, uint32_t layer, bool mask, json_t *root) {
    json_t *all = json_copy(session->set);
    slv_result result = find_target(session, all, &layer, &mask);
    json_object_update(all, root);
    if (!result && !(result = find_target(session, root, &layer, &mask)))
        result = run_line(session, layer, mask, all);
    json_decref(all);
    return result;
}

/* What is set is looked at as the layer's that it is for. */
static slv_result run_set(slv_session *session, uint32_t layer, bool mask, json_t *root) {
    slv_result result = find_target(session, session->set, &layer, &mask);
    if (!result && !(result = find_target(session, root, &layer, &mask)) &&
        !(result = slvi_session_paint(session, layer, mask, root))) {
        json_object_del(root, "op");
        if (json_object_get(root, "layer"))
            json_object_del(session->set, "mask"); /* it was another layer's */
        json_object_update(session->set, root);
    }
    return result;
}

/* Edits, as the journal has them, their numbers and checksums left aside. */
static slv_result run_edit(slv_session *session, const char *folder, const char *op, json_t *root) {
    slv_document *document = session->document;
    const json_t *edits = json_object_get(root, "edits");
    size_t count = json_array_size(edits);
    bool group = strcmp(op, "group") == 0, undo = strcmp(op, "undo") == 0;
    slv_result result;
    if (!group && !undo && strcmp(op, "redo") != 0)
        return slvi_edit_apply(document, session->path, root, folder ? folder : ".");
    if ((result = slvi_edit_keys(&session->env, session->path, root, group ? "name|edits" : "")))
        return result;
    if (!group)
        return undo ? slv_document_undo(document) : slv_document_redo(document);
    if (!count)
        return slvi_fail(&session->env, SLV_ERROR_FORMAT,
                         "%s: edits: expected a list of operations of sessions", session->path);
    const char *name = json_string_value(json_object_get(root, "name"));
    if ((result = slv_document_begin(document, name)))
        return result;
    for (size_t i = 0; !result && i < count; i++) {
        json_t *edit = json_array_get(edits, i);
        const char *kind = json_string_value(json_object_get(edit, "op"));
        if (!kind || strcmp(kind, "stroke") == 0 || strcmp(kind, "fill") == 0)
            result = run_strokes(session, 0, false, edit);
        else
            result = slvi_edit_apply(document, session->path, edit, folder ? folder : ".");
    }
    if (!result)
        return slv_document_end(document);
    slv_document_cancel(document);
    return result;
}

slv_result slv_session_run(slv_session *session, uint32_t layer, bool mask, const char *folder,
                           const char *line, size_t size) {
    size_t blank = 0;
    json_t *root;
    while (blank < size && strchr(" \t\r\n", line[blank]))
        blank++;
    if (blank == size || line[blank] == '#')
        return SLV_OK;
    slv_result result = slvi_session_line(session, folder, line, size, &root);
    if (result)
        return result;
    const char *op = json_string_value(json_object_get(root, "op"));
    if (op && strcmp(op, "set") == 0) {
        result = run_set(session, layer, mask, root);
    } else if (op && strcmp(op, "stroke") != 0 && strcmp(op, "fill") != 0) {
        result = run_edit(session, folder, op, root);
    } else {
        result = run_strokes(session, layer, mask, root);
    }
    json_decref(root);
    return result;
}

/* ---- what is watched so ---- */

slv_result slvi_session_new_document(slv_session *session) {
    slv_document_destroy(session->document);
    slv_result result = slv_document_create(&session->env, &session->params.document,
                                            session->adjacency, &session->document);
    if (!result)
        session->document->watch =
            (slvi_watch){watch_edit, watch_close, watch_step, watch_paint, watch_cancel, session};
    return result;
}
