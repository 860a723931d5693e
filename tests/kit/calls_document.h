/* Calls of calls_kit.h that have to do with painted documents. */
#ifndef CALLS_DOCUMENT_H
#define CALLS_DOCUMENT_H

#include "kit/calls_data.h"

#include <selvage/document.h>
#include <selvage/session.h>

#include <unistd.h>

/* All that is done to a layer's texels, within an entry that is open. */
static inline slv_result calls_paint_layer(slv_document *document, uint32_t id) {
    const float coverage[4] = {1, 1, 0, 0.5f};
    const slv_patch patch = {.rect = {0, 0, 2, 2}, .coverage = coverage, .texel_area = 1};
    const slv_patches patches = {1, &patch, 4};
    float texels[2 * 2 * 5];
    slv_canvas canvas;
    slv_result result = slv_document_canvas(document, id, false, &canvas);
    if (result || (result = canvas.fns->begin(canvas.user, &patches)) ||
        (result = canvas.fns->read(canvas.user, 0, patch.rect, texels)))
        return result;
    return canvas.fns->write(canvas.user, 0, patch.rect, texels);
}

static inline slv_result calls_edit(slv_document *document, uint32_t id) {
    const slv_layer_props props = {.name = "low", .opacity = 0.5f, .blend = SLV_BLEND_MULTIPLY};
    const slv_res res = {3, 2};
    const uint32_t face = 1;
    uint32_t copy;
    slv_result result;
    if ((result = slv_document_load_layer(document, id, calls.texture)) ||
        (result = slv_document_set_layer(document, id, &props)) ||
        (result = slv_document_add_mask(document, id, 0.5f)) ||
        (result = slv_document_duplicate_layer(document, id, &copy)) ||
        (result = slv_document_move_layer(document, copy, 0)) ||
        (result = slv_document_resize(document, copy, 1, &face, &res)) ||
        (result = slv_document_resize(document, 0, 1, &face, &res)) ||
        (result = slv_document_merge_down(document, id)) ||
        (result = slv_document_remove_mask(document, copy)) ||
        (result = slv_document_select(document, 1, &face)) ||
        (result = slv_document_remove_layer(document, copy)))
        return result;
    return slv_document_undo(document);
}

static inline slv_result call_document(const slv_env *env) {
    slv_document_params params = {.flat = *slv_texture_get_desc(calls.texture),
                                  .scratch = test_parent()};
    slv_document *document = NULL;
    slv_source source = {0};
    uint32_t id;
    slv_result result = slv_document_create(env, &params, calls.adjacency, &document);
    if (!result && !(result = slv_document_add_layer(document, NULL, &id)) &&
        !(result = slv_document_begin(document, "stroke")) &&
        !(result = calls_paint_layer(document, id)) && !(result = slv_document_end(document)) &&
        !(result = slv_document_undo(document)) && !(result = slv_document_redo(document)) &&
        !(result = slv_document_flatten(document)) && !(result = calls_edit(document, id)))
        result = slv_document_as_source(document, "flat", &source);
    slv_source_close(&source);
    slv_document_destroy(document);
    return result;
}

/* Before each run: no session is there. */
static inline void calls_prepare_session(void) {
    static const char *const names[] = {"made.selvage", "moved.selvage", "again.selvage"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        test_remove(calls_path(names[i]));
}

/* A stroke that is made while it shows. */
static inline slv_result calls_stroke(slv_session *session) {
    static const char pen[] = "{\"radius\":0.3,\"color\":[1,0,0]}";
    const slv_stroke_sample samples[] = {{.at = {0, 0.2f, 0.5f}, .pressure = 1},
                                         {.at = {0, 0.8f, 0.5f}, .pressure = 1, .time = 1}};
    slv_result result = slv_session_stroke_begin(session, 1, false, NULL, pen, sizeof pen - 1);
    if (!result && !(result = slv_session_stroke_add(session, samples, 2)))
        result = slv_session_stroke_end(session, NULL);
    slv_session_stroke_cancel(session);
    return result;
}

static inline slv_result call_session_moves(const slv_env *env) {
    const slv_session_params params = {.relaxed = true};
    slv_session *session = NULL;
    slv_result result = slv_session_create_from(env, calls_path("made.selvage"), calls.mesh,
                                                calls.texture, &params, &session);
    if (!result && !(result = calls_stroke(session)))
        result = slv_session_save_as(session, calls_path("moved.selvage"));
    slv_session_destroy(session);
    session = NULL;
    if (!result) {
        char from[512];
        snprintf(from, sizeof from, "%s", calls_path("moved.selvage"));
        result = slv_session_replay(env, from, calls_path("again.selvage"), 1, &session);
        slv_session_destroy(session);
    }
    return result ? result : slv_session_remove(env, calls_path("made.selvage"));
}

static inline slv_result call_session(const slv_env *env) {
    static const char fill[] = "{\"op\":\"fill\",\"face\":1,\"color\":[1,0,0]}";
    const slv_session_params params = {.document = {.flat = *slv_texture_get_desc(calls.texture)}};
    slv_session *session = NULL;
    slv_painter *painter;
    slv_result result =
        slv_session_create(env, calls_path("made.selvage"), calls.mesh, &params, &session);
    if (!result && !(result = slv_session_painter(session, &painter)) &&
        !(result = slv_document_add_layer(slv_session_document(session), NULL, NULL)) &&
        !(result = slv_session_save(session)) &&
        !(result = slv_session_run(session, 1, false, NULL, fill, sizeof fill - 1)) &&
        !(result = slv_document_load_layer(slv_session_document(session), 1, calls.texture)) &&
        !(result = slv_session_export(session, calls_path("whole.ptx")))) {
        slv_session_destroy(session);
        if (!(result = slv_session_open(env, calls_path("made.selvage"), NULL, &session)))
            result = slv_session_export_edits(session, calls_path("whole.ptx"), NULL);
        if (!result) /* with itself: all is the same */
            result = slv_session_merge(session, session, NULL);
    }
    slv_session_destroy(session);
    return result;
}

#endif
