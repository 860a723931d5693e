/* Actions that change the document: history, layers, faces, and what is painted with. */
#include "studio/commands/commands.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The document after something was done to it, well or not. */
void studio_edited(studio_app *app, slv_result result) {
    studio_failed(app, result);
    app->dirty = true;
    studio_failed(app, studio_document_refresh(&app->document));
    studio_area_redraw(app, false);
}

/* The layers, with a session made if need be; NULL: it has been said why there are none. */
slv_document *studio_layers_of(studio_app *app) {
    return studio_failed(app, studio_document_need_session(&app->document))
               ? NULL
               : studio_document_layers(&app->document);
}

/* ---- history ---- */

static void step(studio_app *app, bool redo) {
    slv_document *layers = studio_document_layers(&app->document);
    slv_history_info info = {0};
    if (layers)
        slv_document_history(layers, &info);
    if (redo ? !info.redos : !info.undos)
        studio_say(app, redo ? "There is nothing to redo." : "There is nothing to undo.", NULL,
                   NULL);
    else
        studio_edited(app, redo ? slv_document_redo(layers) : slv_document_undo(layers));
}

void studio_do_undo(studio_app *app, const char *target) {
    (void)target;
    step(app, false);
}

/* What is left of a stroke is stopped before actions of its kind are run. */
void studio_do_stroke_stop(studio_app *app, const char *target) {
    (void)app;
    (void)target;
}

void studio_do_redo(studio_app *app, const char *target) {
    (void)target;
    step(app, true);
}

/* To where so many entries of the history are done. */
void studio_do_history(studio_app *app, const char *target) {
    slv_document *layers = studio_document_layers(&app->document);
    slv_history_info info = {0};
    uint32_t wanted = (uint32_t)strtoul(target, NULL, 10);
    slv_result result = SLV_OK;
    if (!layers)
        return;
    slv_document_history(layers, &info);
    for (uint32_t i = info.undos; i > wanted && !result; i--)
        result = slv_document_undo(layers);
    for (uint32_t i = info.undos; i < wanted && i < info.undos + info.redos && !result; i++)
        result = slv_document_redo(layers);
    studio_edited(app, result);
}

/* ---- layers ---- */

/* That is painted on; false: there is none. */
bool studio_layer_now(const studio_app *app, slv_layer_info *info, uint32_t *index) {
    slv_document *layers = studio_document_layers(&app->document);
    if (!layers || !slv_document_layer(layers, app->document.layer, info))
        return false;
    *index = 0;
    while (slv_document_layer_at(layers, *index) != info->id)
        ++*index;
    return true;
}

void studio_do_layer_add(studio_app *app, const char *target) {
    slv_document *layers = studio_layers_of(app);
    slv_layer_props props = {.opacity = 1};
    uint32_t id;
    (void)target;
    if (!layers)
        return;
    snprintf(props.name, sizeof props.name, "layer %u", slv_document_layer_count(layers) + 1);
    const slv_layer_params params = {.props = &props, .above = app->document.layer};
    slv_result result = slv_document_add_layer(layers, &params, &id);
    if (!result)
        app->document.layer = id;
    studio_edited(app, result);
}

void studio_do_layer_duplicate(studio_app *app, const char *target) {
    slv_document *layers = studio_layers_of(app);
    uint32_t id;
    (void)target;
    if (!layers)
        return;
    slv_result result = slv_document_duplicate_layer(layers, app->document.layer, &id);
    if (!result)
        app->document.layer = id;
    studio_edited(app, result);
}

void studio_do_layer_remove(studio_app *app, const char *target) {
    slv_document *layers = studio_layers_of(app);
    (void)target;
    if (layers)
        studio_edited(app, slv_document_remove_layer(layers, app->document.layer));
}

static void move(studio_app *app, int by) {
    slv_document *layers = studio_layers_of(app);
    slv_layer_info info;
    uint32_t index;
    if (!layers || !studio_layer_now(app, &info, &index))
        return;
    int64_t to = (int64_t)index + by;
    if (to >= 0 && to < slv_document_layer_count(layers))
        studio_edited(app, slv_document_move_layer(layers, info.id, (uint32_t)to));
}

void studio_do_layer_raise(studio_app *app, const char *target) {
    (void)target;
    move(app, 1);
}

void studio_do_layer_lower(studio_app *app, const char *target) {
    (void)target;
    move(app, -1);
}

void studio_do_layer_merge(studio_app *app, const char *target) {
    slv_document *layers = studio_layers_of(app);
    (void)target;
    if (layers)
        studio_edited(app, slv_document_merge_down(layers, app->document.layer));
}

/* Changes a property of a layer, which may be another than that which is painted on. */
static void set_props(studio_app *app, uint32_t id, const slv_layer_props *props) {
    slv_layer_info info;
    slv_document *layers = studio_document_layers(&app->document);
    if (slv_document_layer(layers, id, &info) && memcmp(&info.props, props, sizeof *props) != 0)
        studio_edited(app, slv_document_set_layer(layers, id, props));
}

void studio_do_layer_hide(studio_app *app, const char *target) {
    slv_layer_info info;
    uint32_t index;
    (void)target;
    if (!studio_layers_of(app) || !studio_layer_now(app, &info, &index))
        return;
    info.props.hidden = !info.props.hidden;
    set_props(app, info.id, &info.props);
}

const char *studio_get_layer_hide(const studio_app *app) {
    slv_layer_info info;
    uint32_t index;
    return studio_layer_now(app, &info, &index) && info.props.hidden ? "on" : NULL;
}

void studio_do_layer_lock(studio_app *app, const char *target) {
    slv_layer_info info;
    uint32_t index;
    (void)target;
    if (!studio_layers_of(app) || !studio_layer_now(app, &info, &index))
        return;
    info.props.locked = !info.props.locked;
    set_props(app, info.id, &info.props);
}

const char *studio_get_layer_lock(const studio_app *app) {
    slv_layer_info info;
    uint32_t index;
    return studio_layer_now(app, &info, &index) && info.props.locked ? "on" : NULL;
}

void studio_do_layer_show(studio_app *app, const char *target) {
    slv_document *layers = studio_document_layers(&app->document);
    slv_layer_info info;
    if (!layers || !slv_document_layer(layers, (uint32_t)strtoul(target, NULL, 10), &info))
        return;
    info.props.hidden = !info.props.hidden;
    set_props(app, info.id, &info.props);
}

void studio_do_layer_name(studio_app *app, const char *target) {
    slv_layer_info info;
    uint32_t index;
    if (!studio_layer_now(app, &info, &index))
        return;
    memset(info.props.name, 0, sizeof info.props.name);
    g_utf8_strncpy(info.props.name, target, 15); /* of up to four bytes */
    set_props(app, info.id, &info.props);
}

void studio_do_layer_opacity(studio_app *app, const char *target) {
    slv_layer_info info;
    uint32_t index;
    if (!studio_layer_now(app, &info, &index))
        return;
    info.props.opacity = CLAMP((float)g_ascii_strtod(target, NULL), 0, 1);
    set_props(app, info.id, &info.props);
}

void studio_do_layer_blend(studio_app *app, const char *target) {
    slv_layer_info info;
    uint32_t index;
    if (studio_layer_now(app, &info, &index) && slv_blend_from_name(target, &info.props.blend))
        set_props(app, info.id, &info.props);
}

void studio_set_layer(studio_app *app, const char *target) {
    app->document.layer = (uint32_t)strtoul(target, NULL, 10);
    app->document.mask = false;
}

void studio_do_mask_add(studio_app *app, const char *target) {
    slv_document *layers = studio_layers_of(app);
    (void)target;
    if (layers)
        studio_edited(app, slv_document_add_mask(layers, app->document.layer, 1));
}

void studio_do_mask_remove(studio_app *app, const char *target) {
    slv_document *layers = studio_layers_of(app);
    (void)target;
    if (layers)
        studio_edited(app, slv_document_remove_mask(layers, app->document.layer));
}

void studio_do_mask_paint(studio_app *app, const char *target) {
    slv_layer_info info;
    uint32_t index;
    (void)target;
    if (studio_layer_now(app, &info, &index) && info.has_mask)
        app->document.mask = !app->document.mask;
    else
        studio_say(app, "This layer has no mask.", "Add a Mask", "mask-add");
}

const char *studio_get_mask_paint(const studio_app *app) {
    return app->document.mask ? "on" : NULL;
}

/* ---- faces ---- */

/* Under the pointer. */
bool studio_face_under(studio_app *app, slv_paint_hit *hit) {
    uint32_t width, height;
    slv_camera camera = studio_area_camera(app, &width, &height);
    if (studio_document_pick(&app->document, &camera, width, height, (float)app->x, (float)app->y,
                             hit))
        return true;
    studio_say(app, "There is no face under the pointer.", NULL, NULL);
    return false;
}

void studio_do_select_none(studio_app *app, const char *target) {
    slv_document *layers = studio_layers_of(app);
    (void)target;
    if (layers)
        studio_edited(app, slv_document_select(layers, 0, NULL));
}

/* One more face, or one fewer. */
void studio_do_select_face(studio_app *app, const char *target) {
    slv_document *layers = studio_layers_of(app);
    uint32_t face = (uint32_t)strtoul(target, NULL, 10), count = 0;
    uint32_t nfaces = layers ? slv_document_get_desc(layers)->nfaces : 0;
    bool all = true;
    if (face >= nfaces)
        return;
    uint32_t *faces = g_new(uint32_t, nfaces);
    for (uint32_t f = 0; all && f < nfaces; f++)
        all = slv_document_selected(layers, f);
    for (uint32_t f = 0; f < nfaces; f++) {
        bool was = !all && slv_document_selected(layers, f);
        if (f == face ? !was : was)
            faces[count++] = f;
    }
    studio_edited(app, slv_document_select(layers, count, faces));
    g_free(faces);
}

/* From a face on. */
void studio_fill(studio_app *app, uint32_t face, slv_select select,
                 const studio_gradient *gradient) {
    if (!studio_layers_of(app))
        return;
    char *line = studio_fill_line(&app->paint, &app->document, face, select, gradient);
    slv_result result = line ? slv_session_run(app->document.session, app->document.layer,
                                               app->document.mask, NULL, line, strlen(line))
                             : SLV_ERROR_MEMORY;
    free(line);
    studio_edited(app, result);
}

void studio_do_fill_face(studio_app *app, const char *target) {
    studio_fill(app, (uint32_t)strtoul(target, NULL, 10), SLV_SELECT_FACE, NULL);
}

/* ---- what is painted with ---- */

void studio_set_tool(studio_app *app, const char *target) {
    for (int i = 0; i < STUDIO_TOOLS; i++)
        if (strcmp(studio_tool_names[i], target) == 0)
            app->tool = (studio_tool)i;
    studio_say(app, NULL, NULL, NULL); /* what was said is of what was done before */
    /* so that the first stroke need not wait for the session, nor for its texels on the GPU */
    if (app->tool != STUDIO_VIEW && app->tool != STUDIO_PICK && !app->document.session &&
        studio_layers_of(app))
        studio_area_redraw(app, true);
}

const char *studio_get_tool(const studio_app *app) {
    return studio_tool_names[app->tool];
}

void studio_do_pick_color(studio_app *app, const char *target) {
    slv_paint_hit hit;
    const slv_texture *texture = app->document.texture;
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    (void)target;
    if (!studio_face_under(app, &hit))
        return;
    uint32_t face = (uint32_t)hit.point.face;
    slv_res res = slv_texture_is_constant(texture, face) ? (slv_res){0, 0} : desc->res[face];
    float texel[SLV_PAINT_CHANNELS] = {0};
    if (desc->nchannels > SLV_PAINT_CHANNELS)
        return;
    slv_texture_fetch(
        texture, face, MIN((uint32_t)(hit.point.u * (float)(1u << res.u)), (1u << res.u) - 1),
        MIN((uint32_t)(hit.point.v * (float)(1u << res.v)), (1u << res.v) - 1), texel);
    if (desc->nchannels < 3)
        texel[1] = texel[2] = texel[0];
    studio_paint_color(&app->document, texel, false, app->paint.color);
    app->tool = STUDIO_PAINT;
    (void)studio_layers_of(app);
}

void studio_do_color(studio_app *app, const char *target) {
    GdkRGBA rgba;
    if (!gdk_rgba_parse(&rgba, target))
        return;
    app->paint.color[0] = rgba.red;
    app->paint.color[1] = rgba.green;
    app->paint.color[2] = rgba.blue;
}

void studio_do_swatch_add(studio_app *app, const char *target) {
    (void)target;
    studio_swatches_add(app->swatches, app->paint.color);
}

void studio_do_brush_larger(studio_app *app, const char *target) {
    (void)target;
    app->paint.radius = fminf(app->paint.radius * 1.25f, 500);
}

void studio_do_brush_smaller(studio_app *app, const char *target) {
    (void)target;
    app->paint.radius = fmaxf(app->paint.radius / 1.25f, 0.5f);
}

void studio_do_mirror(studio_app *app, const char *target) {
    (void)target;
    app->paint.mirror = !app->paint.mirror;
}

const char *studio_get_mirror(const studio_app *app) {
    return app->paint.mirror ? "on" : NULL;
}

void studio_do_project(studio_app *app, const char *target) {
    (void)target;
    app->paint.project = !app->paint.project;
}

const char *studio_get_project(const studio_app *app) {
    return app->paint.project ? "on" : NULL;
}

void studio_set_brush(studio_app *app, const char *target) {
    for (uint32_t i = 0; i < app->brushes.count; i++)
        if (strcmp(app->brushes.list[i].name, target) == 0)
            app->paint.brush = app->brushes.list[i].path;
}
