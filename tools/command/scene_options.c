/* The options of the verbs that make one picture, and the view that they ask for. */
#include "command/lists.h"
#include "command/output.h"
#include "command/salvage.h"
#include "command/scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

scene_options scene_options_default(void) {
    return (scene_options){
        .size = {512, 512}, .azimuth = 30, .elevation = 20, .fov = 35, .straight = 1};
}

void scene_options_rows(scene_options *o, cli_option *out) {
    const cli_option rows[SCENE_OPTION_ROWS - DISPLACE_OPTION_ROWS] = {
        CLI_MESH(&o->mesh),
        SCENE_VIEW(CLI_TEXT, &o->view, "camera, size and shading from a view file"),
        SCENE_AZIMUTH(&o->azimuth,
                      "degrees around the y axis, from +z (30); replaces the view's camera, as do "
                      "the next three",
                      &o->orbit_given),
        SCENE_ELEVATION(&o->elevation, &o->orbit_given),
        SCENE_FOCUS(&o->focus, &o->orbit_given),
        SCENE_FOV(&o->fov, &o->fov_given),
        {"--size", CLI_SIZE, o->size, "pixels (512x512, or the view's)", NULL, 1, 16384,
         &o->size_given},
        SCENE_SCHEME(&o->scheme, &o->scheme_given),
        SCENE_BOUNDARY(&o->boundary, "boundary rule (the view's, the mesh's, or edge-and-corner)",
                       &o->boundary_given),
        SCENE_TESS(&o->tess, "each face as many as the picture needs"),
        SCENE_SHADING(&o->shading, "shading (headlight, or the view's)", &o->shading_given),
        SCENE_LIGHT(&o->light, &o->light_turn, &o->light_turn_given),
        {"--background", CLI_COLOR, o->background,
         "linear r,g,b[,a], #rrggbb or a name (transparent)", NULL, 0, 0, NULL},
        {"--channels|--channel|-c", CLI_TEXT, &o->channels,
         "which to show, by name or number: r,g,b or rgb or 0-2; one is grey (as there are, up "
         "to 4)",
         "LIST", 0, 0, NULL},
        SCENE_ADJACENCY(&o->adjacency),
        CLI_TEXTURE_ENCODING(&o->encoding),
        CLI_PROGRESS(&o->progress),
        CLI_THREADS(&o->threads),
    };
    memcpy(out, rows, sizeof rows);
    displace_options_rows(&o->displace, out + sizeof rows / sizeof *rows);
}

const char *scene_options_problem(const scene_options *o) {
    if (o->fov < 0 || (o->fov > 0 && o->fov < 0.01f) || o->fov > 170)
        return "--fov: expected 0 (orthographic) or 0.01 to 170";
    if (o->tess & (o->tess - 1))
        return "--tess: expected a power of two from 2 to 128";
    if (o->light && o->shading_given && o->shading != SLV_SHADE_IMAGE)
        return "--light is of --shading image";
    if (o->frames && o->turntable)
        return "--frames and --turntable: each says which pictures there are";
    if (o->round && !o->uv)
        return "--round is of texture coordinates: it takes --uv";
    if (o->latlong && (o->mesh || o->uv))
        return "--latlong is of six faces, which need no --mesh and no --uv";
    if (o->latlong && (o->orbit_given || o->fov_given || o->tess || o->frames || o->turntable ||
                       o->shading_given || o->light || o->light_turn_given))
        return "--latlong shows all directions at once, as they are: no option of a camera, of "
               "light or "
               "of a surface says anything";
    if (o->environment && (o->mesh || o->uv))
        return "--environment: six faces need no --mesh and no --uv";
    if (o->uv && (o->mesh || o->channels || o->adjacency || o->salvage))
        return "--uv: the argument is the mesh, and an image has no --mesh, --channels, "
               "--adjacency or --salvage";
    return NULL;
}

/* The texture with some of its channels, in the order of the list. */
static slv_result pick_channels(const slv_env *env, const value_channel *list, uint32_t count,
                                slv_texture **texture) {
    const slv_texture_desc *desc = slv_texture_get_desc(*texture);
    size_t size = slv_type_size(desc->type), most = 1;
    slv_texture_desc wanted = *desc;
    slv_texture *picked = NULL;
    wanted.nchannels = count;
    wanted.alpha_channel = SLV_NO_ALPHA;
    for (uint32_t c = 0; c < count; c++)
        if (desc->alpha_channel >= 0 && list[c].source == desc->alpha_channel)
            wanted.alpha_channel = (int32_t)c;
    for (uint32_t f = 0; f < desc->nfaces; f++) {
        size_t n = slv_texture_is_constant(*texture, f)
                       ? 1
                       : (size_t)1 << (desc->res[f].u + desc->res[f].v);
        most = n > most ? n : most;
    }
    unsigned char *texels = malloc(most * count * size);
    slv_result result =
        texels ? slv_texture_create(env, &wanted, &picked)
               : output_fail(env, SLV_ERROR_MEMORY, "no memory for the texels of one face");
    for (uint32_t f = 0; f < desc->nfaces && !result; f++) {
        const unsigned char *from = slv_texture_texels(*texture, f);
        bool constant = slv_texture_is_constant(*texture, f);
        size_t n = constant ? 1 : (size_t)1 << (desc->res[f].u + desc->res[f].v);
        for (size_t i = 0; i < n; i++)
            for (uint32_t c = 0; c < count; c++)
                memcpy(texels + (i * count + c) * size,
                       from + (i * desc->nchannels + (uint32_t)list[c].source) * size, size);
        result = constant ? slv_texture_set_constant(picked, f, texels)
                          : slv_texture_set_face(picked, f, texels);
    }
    free(texels);
    if (result) {
        slv_texture_destroy(picked);
        return result;
    }
    slv_texture_destroy(*texture);
    *texture = picked;
    return SLV_OK;
}

/* The channels that are shown in place of all: those asked for, or three colours and an alpha that
 * stands elsewhere in the file. */
static const char *channels_shown(const scene_options *o, const slv_ptx_info *info, char text[80]) {
    uint32_t colours[3], count = 0, alpha = (uint32_t)info->alpha_channel;
    if (o->channels || !o->alpha || info->alpha_channel < 0 ||
        scene_alpha_of(info, SLV_ALPHA_BLEND))
        return o->channels;
    for (uint32_t c = 0; c < info->nchannels && count < 3; c++)
        if (c != alpha)
            colours[count++] = c;
    if (count == 2 || !count)
        return NULL;
    snprintf(text, 80, "%u,%u,%u,%u", colours[0], colours[count == 3], colours[2 * (count == 3)],
             alpha);
    return text;
}

/* Which channels are shown, and what is made of alpha. No list: as there are. */
static int choose_channels(const cli_command *command, const scene_options *o,
                           const slv_ptx_info *info, value_channel **list, uint32_t *count,
                           scene_data *scene) {
    char text[80];
    const char *channels = channels_shown(o, info, text);
    const value_channels file = {info->nchannels, info->alpha_channel};
    int code = EXIT_OK;
    if (channels)
        code = value_channel_list(command, "--channels", channels, file, false, list, count);
    if (!code && *count > 4)
        code = cli_usage(command, "--channels: '%s' are %u, and at most 4 can be shown", channels,
                         *count);
    scene->premultiplied = !o->straight;
    scene->raw = o->raw;
    scene->alpha = scene_alpha_of(info, (slv_alpha_mode)o->alpha);
    if (!code && channels) {
        bool last = (*count == 4 || *count == 2) && info->alpha_channel >= 0 &&
                    (*list)[*count - 1].source == info->alpha_channel;
        scene->alpha = last ? (slv_alpha_mode)o->alpha : SLV_ALPHA_IGNORE;
    }
    return code;
}

/* What was loaded with no more channels than are shown. */
static slv_result pick_all(const slv_env *env, const value_channel *list, uint32_t count,
                           scene_data *scene) {
    slv_result result = SLV_OK;
    if (scene->texture)
        result = pick_channels(env, list, count, &scene->texture);
    if (!result && scene->triangles)
        result = pick_channels(env, list, count, &scene->triangles);
    return result;
}

static slv_camera view_camera(const scene_view *view, const slv_mesh *mesh, float aspect) {
    slv_camera camera = scene_view_camera(view, mesh);
    if (view->whole_window)
        scene_fit_window(camera.window, aspect);
    return camera;
}

/* Options come first: of a file's camera nothing is left by an orbit. */
static slv_camera camera_of(const scene_options *o, const scene_view *view, const scene_data *scene,
                            float aspect) {
    if (!view->has_camera || o->orbit_given || o->fov_given) {
        bool told = view->has_fov && !view->has_camera && !o->fov_given;
        return slv_camera_orbit(scene->bounds_min, scene->bounds_max, o->azimuth, o->elevation,
                                told ? view->fov : o->fov, aspect);
    }
    return view_camera(view, scene->mesh, aspect);
}

/* Which pictures there are to be. */
static slv_result list_frames(const slv_env *env, const scene_options *o, const scene_view *view,
                              const slv_camera *camera, float aspect, scene_data *scene) {
    frames_list *frames = &scene->frames;
    const float *low = scene->bounds_min, *high = scene->bounds_max;
    const bool orbit = o->orbit_given || o->fov_given;
    if (view->ncameras && (o->turntable || o->frames || orbit || !o->numbered))
        cli_warning("%s: of its %u cameras %s is used", o->view, view->ncameras,
                    orbit ? "none" : "the first");
    if (o->turntable)
        return frames_turntable(env, camera, low, high, o->turntable, frames);
    if (o->frames)
        return frames_find(env, o->frames, frames) ||
                       frames_check(env, scene->mesh, frames, o->progress, o->quiet)
                   ? SLV_ERROR_MISMATCH
                   : SLV_OK;
    if (!view->ncameras || !o->numbered || orbit)
        return SLV_OK;
    slv_result result = frames_turntable(env, camera, low, high, view->ncameras, frames);
    for (uint32_t i = 0; i < view->ncameras && !result; i++)
        frames->cameras[i] = view_camera(&view->cameras[i], scene->mesh, aspect);
    return result;
}

/* What is made of alpha: options come first here, too. */
static scene_options with_alpha(const scene_options *o, const scene_view *view) {
    scene_options out = *o;
    if (view->has_alpha && !o->alpha_given)
        out.alpha = (int)view->alpha;
    if (!o->straight_given)
        out.straight = !view->premultiplied;
    if (o->latlong) /* nothing lies behind */
        out.alpha = SLV_ALPHA_IGNORE;
    return out;
}

void scene_warn_of_alpha(const char *path, slv_alpha_mode wanted) {
    cli_warning("%s: what is shown has no alpha, so that --alpha %s changes nothing", path,
                slv_alpha_mode_name(wanted));
}

/* What is made of the alpha of an image, and a word where somebody asked for what there is not. */
static void settle_alpha(const scene_options *o, bool asked, const char *path, scene_data *scene) {
    if (o->uv)
        scene->alpha = scene->images.narrow ? SLV_ALPHA_IGNORE : (slv_alpha_mode)o->alpha;
    if (asked && o->alpha && !scene->alpha)
        scene_warn_of_alpha(path, (slv_alpha_mode)o->alpha);
}

/* How the picture looks, but for its camera. */
static void set_look(const scene_options *o, const scene_view *view, const uint32_t size[2],
                     scene_shot *out) {
    out->width = size[0];
    out->height = size[1];
    out->shading = o->light           ? SLV_SHADE_IMAGE
                   : o->shading_given ? (slv_shading)o->shading
                                      : view->shading;
    out->ka = view->ka;
    out->kd = view->kd;
    for (int c = 0; c < 4; c++)
        out->background[c] = c < 3 ? o->background[c] * o->background[3] : o->background[3];
}

/* The image that the surface is lit by, if one is asked for. */
static int load_light(const cli_command *command, const slv_env *env, const scene_options *o,
                      const scene_view *view, scene_shot *out) {
    const char *path = o->light ? cli_input(o->light) : view->light;
    if (out->shading != SLV_SHADE_IMAGE)
        return o->light_turn_given
                   ? cli_usage(command,
                               "--light-turn: there is no light to turn: --light names one")
                   : EXIT_OK;
    if (!*path)
        return cli_usage(command, "--shading image: nothing says by which: --light IMAGE does");
    return scene_load_light(env, path, o->light_turn_given ? o->light_turn : view->light_turn,
                            &out->light)
               ? EXIT_FAILED
               : EXIT_OK;
}

/* What moves the surface: the displacement that is asked for, or the sphere of an environment. */
static int move_surface(const cli_command *command, const slv_env *env, const char *ptx,
                        const scene_options *o, const scene_view *view, scene_shot *out) {
    scene_data *scene = &out->scene;
    int code =
        displace_begin(command, env, &o->displace, &view->displacement, ptx,
                       o->adjacency ? scene->adjacency : NULL, scene->mesh, &scene->displace);
    if (!code && scene->displace.moves && scene->environment)
        code = cli_error("%s: an environment is a sphere, and nothing displaces that", ptx);
    if (scene->environment) {
        out->tessellation.displacement = &scene->sphere;
        out->shading =
            o->shading_given || o->light || view->has_shading ? out->shading : SLV_SHADE_UNLIT;
    } else if (scene->displace.moves)
        out->tessellation.displacement = &scene->displace.displacement;
    return code;
}

int scene_load_shot(const cli_command *command, const slv_env *env, const char *ptx,
                    const scene_options *options, scene_shot *out) {
    scene_view view = {0};
    memset(out, 0, sizeof *out);
    if (CLI_STANDARD_ONCE(command, ptx, options->mesh, options->uv, options->view,
                          options->displace.texture, options->light))
        return EXIT_USAGE;
    if (options->view && scene_load_view(env, cli_input(options->view), &view))
        return EXIT_FAILED;
    const scene_options asked = with_alpha(options, &view), *o = &asked;
    scene_params params = {.ptx = ptx,
                           .mesh = o->mesh,
                           .adjacency = o->adjacency,
                           .focus = o->focus,
                           .salvage = o->salvage,
                           .environment = o->environment || o->latlong,
                           .moves = o->frames != NULL,
                           .scheme_given = o->scheme_given || view.has_scheme,
                           .encoding = (slv_texture_encoding)o->encoding,
                           .scheme = o->scheme_given ? (slv_scheme)o->scheme : view.scheme,
                           .boundary =
                               o->boundary_given ? (slv_boundary)o->boundary : view.boundary};
    static const uint32_t map[2] = {512, 256};
    const uint32_t *size = o->size_given      ? o->size
                           : view.has_size    ? view.size
                           : options->latlong ? map
                                              : o->size;
    if (o->latlong && (view.has_camera || view.has_fov || view.has_shading))
        cli_warning(
            "%s: camera and shading are not used: --latlong shows all directions as they are",
            o->view);
    set_look(o, &view, size, out);
    int code = load_light(command, env, o, &view, out);
    if (code) {
        scene_view_free(&view);
        return code;
    }
    slv_ptx *file = NULL;
    slv_res *res = NULL;
    value_channel *channels = NULL;
    uint32_t nchannels = 0;
    const slv_bake_uv uv = {.encoding = (slv_texture_encoding)o->encoding,
                            .round_u = o->round & 1,
                            .round_v = o->round >> 1};
    params.mesh = o->uv ? ptx : o->mesh;
    if (o->uv ? scene_load_images(env, &params, &uv, cli_input(o->uv), &out->scene)
              : scene_load_model(env, &params, &file, &out->scene)) {
        scene_view_free(&view);
        return EXIT_FAILED;
    }
    const float aspect = (float)size[0] / (float)size[1];
    out->camera = camera_of(o, &view, &out->scene, aspect);
    out->tessellation = (slv_tessellation_params){
        .segments = o->tess, .camera = &out->camera, .width = size[0], .height = size[1]};
    code = list_frames(env, o, &view, &out->camera, aspect, &out->scene) ? EXIT_FAILED : EXIT_OK;
    code = code ? code : move_surface(command, env, ptx, o, &view, out);
    if (!code && !o->uv)
        code =
            choose_channels(command, o, slv_ptx_get_info(file), &channels, &nchannels, &out->scene);
    if (!code && !o->uv &&
        /* from elsewhere other faces are near */
        ((!out->scene.frames.cameras && scene_choose_detail(env, file, out, &res)) ||
         scene_load_texels(env, file, res, params.encoding, &out->scene) ||
         (channels && pick_all(env, channels, nchannels, &out->scene))))
        code = EXIT_FAILED;
    out->salvaged = !code && !o->uv && salvage_tell(file) != EXIT_OK;
    if (!code)
        settle_alpha(o, o->alpha_given || view.has_alpha, ptx, &out->scene);
    scene_view_free(&view);
    free(channels);
    free(res);
    slv_ptx_close(file);
    return code;
}

slv_result scene_frame_name(const slv_env *env, const frames_list *frames, uint32_t index,
                            const char *out, char path[FRAMES_PATH]) {
    bool fits = frames->count ? frames_name(out, frames->numbers[index], path)
                              : snprintf(path, FRAMES_PATH, "%s", out) < FRAMES_PATH;
    return fits ? SLV_OK
                : output_fail(env, SLV_ERROR_ARGUMENT, "the name of the pictures is too long");
}

slv_result scene_frame_set(const slv_env *env, uint32_t index, scene_shot *shot) {
    const frames_list *frames = &shot->scene.frames;
    if (frames->cameras)
        shot->camera = frames->cameras[index];
    return frames->meshes ? frames_move(env, frames, index, shot->scene.mesh, shot->scene.surface)
                          : SLV_OK;
}

void scene_warn_of_nothing(const char *path) {
    cli_warning("%s: nothing of the surface is in view", path);
}
