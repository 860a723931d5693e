/* The cameras that a comparison measures beside its orbit. */
#include "compare/compare.h"

#include "command/output.h"

slv_result compare_read_views(const slv_env *env, const cli_list *views, report_data *report) {
    for (uint32_t i = 0; i < views->count; i++) {
        scene_view view;
        slv_result result = scene_load_view(env, cli_input(views->items[i]), &view);
        if (!result && view.ncameras)
            cli_warning("%s: of its %u cameras the first is used", views->items[i], view.ncameras);
        scene_view_free(&view);
        if (result)
            return result;
        if (!view.has_camera)
            return output_fail(env, SLV_ERROR_FORMAT, "%s: has no world_to_camera, so no camera",
                               views->items[i]);
        if (view.displacement.given)
            cli_warning("%s: the displacement is not used: only its camera is", views->items[i]);
        if (view.has_alpha || view.premultiplied)
            cli_warning("%s: alpha is not used: --alpha says it for all cameras", views->items[i]);
        /* all that the view shows, in the proportions of the comparison's pictures */
        scene_fit_window(view.camera.window, (float)report->width / (float)report->height);
        report->cameras[report->ncameras++] =
            (report_camera){.path = views->items[i], .camera = view.camera};
    }
    return SLV_OK;
}
