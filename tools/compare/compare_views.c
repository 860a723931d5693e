/* The cameras that a comparison measures beside its orbit. */
#include "compare/compare.h"

#include "command/output.h"

/* All that the view shows, in the proportions of the comparison's pictures. */
static void fit_window(slv_camera *camera, float aspect) {
    float *w = camera->window, width = w[1] - w[0], height = w[3] - w[2];
    bool narrow = width < height * aspect;
    float more = narrow ? (height * aspect - width) / 2 : (width / aspect - height) / 2;
    float *side = narrow ? w : w + 2;
    side[0] -= more;
    side[1] += more;
}

slv_result compare_read_views(const slv_env *env, const cli_list *views, report_data *report) {
    for (uint32_t i = 0; i < views->count; i++) {
        scene_view view;
        slv_result result = scene_load_view(env, cli_input(views->items[i]), &view);
        if (result)
            return result;
        if (!view.has_camera)
            return output_fail(env, SLV_ERROR_FORMAT, "%s: has no world_to_camera, so no camera",
                               views->items[i]);
        fit_window(&view.camera, (float)report->width / (float)report->height);
        report->cameras[report->ncameras++] =
            (report_camera){.path = views->items[i], .camera = view.camera};
    }
    return SLV_OK;
}
