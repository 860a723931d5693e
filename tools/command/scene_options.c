/* The options of the verbs that make one picture, and the view that they ask for. */
#include "command/scene.h"

#include <string.h>

scene_options scene_options_default(void) {
    return (scene_options){.size = {512, 512}, .azimuth = 30, .elevation = 20, .fov = 35};
}

void scene_options_rows(scene_options *o, cli_option *out) {
    const cli_option rows[SCENE_OPTION_ROWS] = {
        CLI_MESH(&o->mesh),
        {"--view|-v", CLI_TEXT, &o->view, "camera, size and shading from a view file", "FILE.json",
         0, 0, NULL},
        {"--azimuth", CLI_FLOAT, &o->azimuth,
         "degrees around the y axis, from +z (30); replaces the view's camera", "DEG", 0, 0,
         &o->orbit_given},
        {"--elevation", CLI_FLOAT, &o->elevation, "degrees above the horizon (20)", "DEG", 0, 0,
         &o->orbit_given},
        {"--focus", CLI_TEXT, &o->focus,
         "frame this group (g, o) of the OBJ instead of the whole mesh", "GROUP", 0, 0, NULL},
        {"--fov", CLI_FLOAT, &o->fov, "vertical field of view; 0 is orthographic (35)", "DEG", 0, 0,
         &o->orbit_given},
        {"--size", CLI_SIZE, o->size, "pixels (512x512, or the view's)", NULL, 1, 16384,
         &o->size_given},
        {"--scheme", CLI_CHOICE, &o->scheme, "subdivision scheme (catmark)", SCENE_SCHEMES, 0, 0,
         &o->scheme_given},
        {"--boundary", CLI_CHOICE, &o->boundary,
         "boundary rule (the view's, the mesh's, or edge-and-corner)", SCENE_BOUNDARIES, 0, 0,
         &o->boundary_given},
        {"--tess", CLI_UINT, &o->tess,
         "segments per face edge, a power of two (by the size on screen)", NULL, 2, 128, NULL},
        {"--shading", CLI_CHOICE, &o->shading, "shading (headlight, or the view's)", SCENE_SHADINGS,
         0, 0, &o->shading_given},
        {"--background", CLI_COLOR, o->background, "linear colour (transparent)", NULL, 0, 0, NULL},
        {"--channel", CLI_UINT, &o->channel, "first channel to show (0)", NULL, 0, 65535, NULL},
        {"--channels", CLI_UINT, &o->nchannels, "how many: 1 is grey (as there are, up to 4)", NULL,
         1, 4, NULL},
        {"--adjacency", CLI_CHOICE, &o->adjacency,
         "neighbours: refuse if file and mesh differ (agree), or take the one's", SCENE_ADJACENCIES,
         0, 0, NULL},
        CLI_THREADS(&o->threads),
    };
    memcpy(out, rows, sizeof rows);
}

const char *scene_options_problem(const scene_options *o) {
    if (o->fov < 0 || (o->fov > 0 && o->fov < 0.01f) || o->fov > 170)
        return "--fov: expected 0 (orthographic) or 0.01 to 170";
    if (o->tess & (o->tess - 1))
        return "--tess: expected a power of two from 2 to 128";
    return NULL;
}

slv_result scene_load_shot(const slv_env *env, const char *ptx, const scene_options *o,
                           scene_shot *out) {
    scene_view view = {0};
    slv_result result;
    memset(out, 0, sizeof *out);
    if (o->view && (result = scene_load_view(env, cli_input(o->view), &view)))
        return result;
    scene_params params = {.ptx = ptx,
                           .mesh = o->mesh,
                           .adjacency = o->adjacency,
                           .focus = o->focus,
                           .salvage = o->salvage,
                           .scheme = o->scheme_given ? (slv_scheme)o->scheme : view.scheme,
                           .boundary =
                               o->boundary_given ? (slv_boundary)o->boundary : view.boundary};
    const uint32_t *size = o->size_given || !view.has_size ? o->size : view.size;
    out->width = size[0];
    out->height = size[1];
    out->shading = o->shading_given ? (slv_shading)o->shading : view.shading;
    out->ka = view.ka;
    out->kd = view.kd;
    for (int c = 0; c < 4; c++)
        out->background[c] = c < 3 ? o->background[c] * o->background[3] : o->background[3];
    if ((result = scene_load(env, &params, &out->scene)))
        return result;
    out->camera = view.has_camera && !o->orbit_given
                      ? scene_view_camera(&view, out->scene.mesh)
                      : slv_camera_orbit(out->scene.bounds_min, out->scene.bounds_max, o->azimuth,
                                         o->elevation, o->fov, (float)size[0] / (float)size[1]);
    out->segments =
        o->tess ? o->tess : slv_tessellation_for(out->scene.mesh, &out->camera, size[0], size[1]);
    return SLV_OK;
}
