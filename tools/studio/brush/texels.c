/* The resolution brush: a drag touches faces, which have more texels, or fewer, when it ends. */
#include "studio/studio.h"

void studio_texels_touch(studio_app *app) {
    slv_screen_dab dab = {
        .x = (float)app->x, .y = (float)app->y, .radius = app->paint.radius, .hardness = 1};
    dab.camera = studio_area_camera(app, &dab.width, &dab.height);
    if (studio_failed(app, studio_document_cover(&app->document, &dab, app->touched)))
        app->drag = STUDIO_DRAG_NONE;
    studio_area_redraw(app, true);
}

void studio_texels_begin(studio_app *app, bool fewer) {
    app->document.message[0] = 0;
    if (studio_failed(app, studio_document_need_session(&app->document)))
        return;
    app->fewer = fewer;
    app->touched =
        g_new0(uint8_t, slv_mesh_face_count(studio_document_mesh(&app->document)) + (size_t)1);
    app->drag = STUDIO_DRAG_TEXELS;
    studio_texels_touch(app);
}

void studio_texels_end(studio_app *app) {
    const uint32_t nfaces = slv_mesh_face_count(studio_document_mesh(&app->document));
    GString *faces = g_string_new("");
    for (uint32_t f = 0; f < nfaces; f++)
        if (app->touched[f])
            g_string_append_printf(faces, "%u ", f);
    g_free(app->touched);
    app->touched = NULL;
    app->drag = STUDIO_DRAG_NONE;
    if (faces->len && app->density > 0) {
        char density[G_ASCII_DTOSTR_BUF_SIZE];
        g_string_prepend_c(faces, ' ');
        g_string_prepend(faces, g_ascii_dtostr(density, sizeof density, (double)app->density));
        studio_actions_run(app, "faces-density", faces->str);
    } else if (faces->len) {
        studio_actions_run(app, app->fewer ? "faces-coarser" : "faces-finer", faces->str);
    }
    g_string_free(faces, TRUE);
}

/* Those of the drag, or else the selection. */
uint8_t *studio_texels_meant(const studio_app *app) {
    const slv_document *layers = studio_document_layers(&app->document);
    if (!layers)
        return NULL;
    const uint32_t nfaces = slv_document_get_desc(layers)->nfaces;
    uint8_t *meant = app->touched ? g_memdup2(app->touched, nfaces) : g_new(uint8_t, nfaces);
    bool all = !app->touched;
    for (uint32_t f = 0; !app->touched && f < nfaces; f++) {
        meant[f] = slv_document_selected(layers, f);
        all = all && meant[f];
    }
    if (all) {
        g_free(meant);
        return NULL;
    }
    return meant;
}
