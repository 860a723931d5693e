/* View files, as selvage render and selvage compare read them. */
#include "studio/studio.h"

#include "command/output.h"

#include <jansson.h>
#include <string.h>

/* In the world of the mesh's file, whose origin the renderer's positions leave out. */
slv_result studio_view_save(studio_app *app, const char *path) {
    uint32_t width, height;
    const slv_env *env = &app->document.env;
    const slv_camera camera = studio_area_camera(app, &width, &height);
    const double *origin = slv_mesh_get_view(studio_document_mesh(&app->document))->origin;
    json_t *rows = json_array(), *window = json_array();
    for (int r = 0; r < 4; r++) {
        const float *m = camera.world_to_camera + 4 * r;
        double last = (double)m[3];
        for (int i = 0; r < 3 && i < 3; i++)
            last -= (double)m[i] * origin[i];
        json_array_append_new(
            rows, json_pack("[f, f, f, f]", (double)m[0], (double)m[1], (double)m[2], last));
    }
    for (int i = 0; i < 4; i++)
        json_array_append_new(window, json_real((double)camera.window[i]));
    json_t *root =
        json_pack("{s:[i, i], s:o, s:s, s:o, s:{s:s, s:f, s:f}}", "size", (int)width, (int)height,
                  "world_to_camera", rows, "projection",
                  camera.perspective ? "perspective" : "orthographic", "screen_window", window,
                  "shading", "model", slv_shading_name(app->look.shading), "ka", 0.2, "kd", 0.8);
    if (root && app->look.shading == SLV_SHADE_IMAGE)
        json_object_update_new(json_object_get(root, "shading"),
                               json_pack("{s:s, s:f}", "light", app->light_path, "turn",
                                         (double)app->look.light_turn));
    const displace_settings *d = &app->document.displace;
    if (root && d->given)
        json_object_set_new(root, "displacement",
                            json_pack("{s:s, s:s, s:f, s:f, s:s, s:b, s:s}", "texture", d->texture,
                                      "channel", d->channel, "scale", (double)d->scale, "bias",
                                      (double)d->bias, "filter", slv_filter_name(d->filter.filter),
                                      "lerp", d->filter.lerp, "space",
                                      slv_displacement_space_name(d->space)));
    /* the window shows colours alone, whatever there is of alpha */
    if (root && slv_texture_get_desc(app->document.texture)->alpha_channel != SLV_NO_ALPHA)
        json_object_set_new(root, "alpha",
                            json_pack("{s:s}", "mode", slv_alpha_mode_name(SLV_ALPHA_IGNORE)));
    char *text = root ? json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) : NULL;
    GError *error = NULL;
    slv_result result = SLV_OK;
    if (!text)
        result = output_fail(env, SLV_ERROR_MEMORY, "%s: no memory", path);
    else if (!g_file_set_contents(path, text, -1, &error))
        result = output_fail(env, SLV_ERROR_IO, "%s", error->message);
    g_clear_error(&error);
    free(text);
    json_decref(root);
    return result;
}

slv_result studio_view_load(studio_app *app, const char *path) {
    scene_view view;
    slv_result result = scene_load_view(&app->document.env, path, &view);
    if (result)
        return result;
    scene_view_free(&view);
    if (!view.has_camera)
        return output_fail(&app->document.env, SLV_ERROR_FORMAT, "%s: has no camera", path);
    const slv_camera camera = scene_view_camera(&view, studio_document_mesh(&app->document));
    studio_camera_set(&app->camera, &camera, app->document.scene.bounds_min,
                      app->document.scene.bounds_max);
    if (view.has_shading && view.shading != SLV_SHADE_IMAGE)
        app->look.shading = view.shading;
    else if (view.has_shading && studio_light_load(app, view.light))
        app->look.light_turn = view.light_turn;
    app->framed = true;
    /* a view without one shows what is not moved */
    if (!view.displacement.given && !app->document.displace.given)
        return SLV_OK;
    return studio_document_displace(&app->document, &view.displacement);
}
