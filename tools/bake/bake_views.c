/* The cameras for whose pictures a texture is baked. */
#include "bake/bake_options.h"
#include "command/output.h"
#include "command/scene.h"

#include <stdlib.h>

enum { DEFAULT_SIDE = 512 }; /* as pictures have it whose file does not say */

slv_result bake_views_load(const slv_env *env, const char *path, const slv_mesh *mesh,
                           slv_bake_view **views, slv_bake_job *job) {
    scene_view file = {0};
    *views = NULL;
    if (!path)
        return SLV_OK;
    slv_result result = scene_load_view(env, path, &file);
    uint32_t count = file.ncameras ? file.ncameras : 1;
    if (!result && !file.has_camera)
        result = output_fail(env, SLV_ERROR_FORMAT, "%s: has no camera", path);
    if (!result && !(*views = calloc(count, sizeof **views)))
        result = output_fail(env, SLV_ERROR_MEMORY, "%s: no memory", path);
    uint32_t width = file.has_size ? file.size[0] : DEFAULT_SIDE,
             height = file.has_size ? file.size[1] : DEFAULT_SIDE;
    for (uint32_t i = 0; i < count && !result; i++) {
        const scene_view *view = file.ncameras ? &file.cameras[i] : &file;
        (*views)[i] = (slv_bake_view){scene_view_camera(view, mesh), width, height};
        if (view->whole_window)
            scene_fit_window((*views)[i].camera.window, (float)width / (float)height);
    }
    scene_view_free(&file);
    if (result)
        return result;
    job->views = *views;
    job->nviews = count;
    return result;
}
