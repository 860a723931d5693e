#include "scene.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

struct render {
    const char *arguments[2];
    uint32_t narguments;
    const char *mesh, *view, *out, *focus;
    int strategy, scheme, boundary, shading, context, adjacency;
    bool scheme_given, boundary_given, shading_given, size_given, orbit_given, raw, quiet;
    uint32_t size[2], msaa, aniso, tess, bits, threads, channel, nchannels;
    float azimuth, elevation, fov, background[4];
};

/* out from -o, or the second argument, or the texture's name with .png */
static const char *output_path(const struct render *r, char *buffer, size_t size) {
    if (r->out)
        return r->out;
    if (r->narguments > 1)
        return r->arguments[1];
    const char *name = strrchr(r->arguments[0], '/');
    name = name ? name + 1 : r->arguments[0];
    const char *dot = strrchr(name, '.');
    snprintf(buffer, size, "%.*s.png", dot && dot != name ? (int)(dot - name) : (int)strlen(name),
             name);
    return buffer;
}

static int draw(const struct render *r, const scene_view *view, const char *path) {
    slv_env env = cli_env(r->threads);
    scene_params params = {.ptx = r->arguments[0],
                           .mesh = r->mesh,
                           .adjacency = r->adjacency,
                           .focus = r->focus,
                           .scheme = r->scheme_given ? (slv_scheme)r->scheme : view->scheme,
                           .boundary =
                               r->boundary_given ? (slv_boundary)r->boundary : view->boundary};
    scene_data scene = {0};
    slv_gl *gl = NULL;
    slv_gl_texture *texture = NULL;
    slv_gl_renderer *renderer = NULL;
    slv_image image = {0};
    int code = EXIT_FAILED;
    slv_frame frame = {.msaa = r->msaa,
                       .strategy = (slv_strategy)r->strategy,
                       .shading = r->shading_given ? (slv_shading)r->shading : view->shading,
                       .ka = view->ka,
                       .kd = view->kd,
                       .float_target = r->bits == 32};
    const uint32_t *size = r->size_given || !view->has_size ? r->size : view->size;
    frame.width = size[0];
    frame.height = size[1];
    for (int c = 0; c < 4; c++)
        frame.background[c] = c < 3 ? r->background[c] * r->background[3] : r->background[3];
    slv_gl_texture_params upload = {.strategies = 1u << r->strategy,
                                    .anisotropy = r->aniso,
                                    .first_channel = r->channel,
                                    .nchannels = r->nchannels};
    slv_image_params file = {.encoding = r->raw ? SLV_ENCODE_RAW : SLV_ENCODE_SRGB,
                             .bits = r->bits};
    if (scene_load(&env, &params, &scene))
        goto done;
    frame.camera =
        view->has_camera && !r->orbit_given
            ? view->camera
            : slv_camera_orbit(scene.bounds_min, scene.bounds_max, r->azimuth, r->elevation, r->fov,
                               (float)frame.width / (float)frame.height);
    uint32_t segments =
        r->tess ? r->tess
                : slv_tessellation_for(scene.mesh, &frame.camera, frame.width, frame.height);
    if (slv_gl_create(&env, (slv_gl_backend)r->context, &gl) ||
        slv_gl_texture_create(gl, &env, scene.texture, scene.adjacency, &upload, &texture) ||
        slv_gl_renderer_create(gl, &env, scene.mesh, scene.surface, segments, &renderer) ||
        slv_gl_renderer_draw(renderer, &env, texture, &frame, &image, NULL) ||
        slv_image_save(&env, path, &image, &file))
        goto done;
    if (!r->quiet) {
        slv_gl_texture_stats stats = slv_gl_texture_get_stats(texture, frame.strategy);
        printf("%s: %u x %u, %s, %ux MSAA, %ux anisotropy, %u segments, %.1f MB on the GPU, %s\n",
               path, frame.width, frame.height, slv_strategy_name(frame.strategy),
               frame.msaa ? frame.msaa : 1, r->aniso, segments, (double)stats.gpu_bytes / 1e6,
               slv_gl_get_info(gl)->renderer);
    }
    code = EXIT_OK;
done:
    slv_image_free(&image);
    slv_gl_renderer_destroy(renderer);
    slv_gl_texture_destroy(texture);
    slv_gl_destroy(gl);
    scene_free(&scene);
    return code;
}

int verb_render(int argc, char **argv) {
    struct render r = {.strategy = SLV_STRATEGY_TRAVERSE,
                       .size = {512, 512},
                       .msaa = 4,
                       .aniso = 1,
                       .azimuth = 30,
                       .elevation = 20,
                       .fov = 35};
    const cli_option options[] = {
        {"--mesh|-m", CLI_TEXT, &r.mesh, "control mesh; default: the geometry inside the .ptx",
         "FILE.obj", 0, 0, NULL},
        {"--out|-o|--output", CLI_TEXT, &r.out,
         "picture, .png or .exr; default: the texture's name with .png", "FILE", 0, 0, NULL},
        {"--strategy|-s", CLI_CHOICE, &r.strategy, "how a lookup crosses a seam (traverse)",
         SCENE_STRATEGIES, 0, 0, NULL},
        {"--view|-v", CLI_TEXT, &r.view, "camera, size and shading from a view file", "FILE.json",
         0, 0, NULL},
        {"--azimuth", CLI_FLOAT, &r.azimuth,
         "degrees around the y axis, from +z (30); replaces the view's camera", "DEG", 0, 0,
         &r.orbit_given},
        {"--elevation", CLI_FLOAT, &r.elevation, "degrees above the horizon (20)", "DEG", 0, 0,
         &r.orbit_given},
        {"--focus", CLI_TEXT, &r.focus,
         "frame this group (g, o) of the OBJ instead of the whole mesh", "GROUP", 0, 0, NULL},
        {"--fov", CLI_FLOAT, &r.fov, "vertical field of view; 0 is orthographic (35)", "DEG", 0, 0,
         &r.orbit_given},
        {"--size", CLI_SIZE, r.size, "pixels (512x512, or the view's)", NULL, 1, 16384,
         &r.size_given},
        {"--msaa", CLI_UINT, &r.msaa,
         "samples per pixel: 1, 2, 4, 8, as far as the driver goes (4)", NULL, 1, 64, NULL},
        {"--aniso", CLI_UINT, &r.aniso, "anisotropy, 1 (trilinear) to 16 (1)", NULL, 1, 16, NULL},
        {"--scheme", CLI_CHOICE, &r.scheme, "subdivision scheme (catmark)", SCENE_SCHEMES, 0, 0,
         &r.scheme_given},
        {"--boundary", CLI_CHOICE, &r.boundary,
         "boundary rule (the view's, the mesh's, or edge-and-corner)", SCENE_BOUNDARIES, 0, 0,
         &r.boundary_given},
        {"--tess", CLI_UINT, &r.tess,
         "segments per face edge, a power of two (by the size on screen)", NULL, 2, 128, NULL},
        {"--shading", CLI_CHOICE, &r.shading, "shading (headlight, or the view's)", SCENE_SHADINGS,
         0, 0, &r.shading_given},
        {"--raw", CLI_FLAG, &r.raw, "PNG: shaded values x 255 (or 65535), without display encoding",
         NULL, 0, 0, NULL},
        {"--bits", CLI_UINT, &r.bits, "PNG: 8 or 16 (8). EXR: 16 half or 32 float (16)", NULL, 8,
         32, NULL},
        {"--background", CLI_COLOR, r.background, "linear colour (transparent)", NULL, 0, 0, NULL},
        {"--channel", CLI_UINT, &r.channel, "first channel to show (0)", NULL, 0, 65535, NULL},
        {"--channels", CLI_UINT, &r.nchannels, "how many: 1 is grey (as there are, up to 4)", NULL,
         1, 4, NULL},
        {"--adjacency", CLI_CHOICE, &r.adjacency,
         "neighbours: refuse if file and mesh differ (agree), or take the one's", SCENE_ADJACENCIES,
         0, 0, NULL},
        {"--context", CLI_CHOICE, &r.context, "where OpenGL comes from (auto)", SCENE_CONTEXTS, 0,
         0, NULL},
        {"--threads", CLI_UINT, &r.threads, "worker threads (one per processor)", NULL, 1, 256,
         NULL},
        {"--quiet|-q", CLI_FLAG, &r.quiet, "print nothing on success", NULL, 0, 0, NULL},
    };
    const cli_command command = {
        .name = "render",
        .summary = "draw a .ptx on its subdivision surface",
        .arguments = "FILE.ptx [OUT.png|OUT.exr]",
        .examples =
            "  selvage render teapot.ptx -o teapot.png\n"
            "  selvage render cow.ptx --mesh cow.obj --azimuth 60 --strategy discard --msaa 4 "
            "--aniso 16\n"
            "  selvage render teapot.ptx --view view.json --raw --out linear.exr --bits 32\n",
        .options = options,
        .noptions = sizeof options / sizeof *options,
        .min_arguments = 1,
        .max_arguments = 2,
        .positional = r.arguments,
        .npositional = &r.narguments};
    scene_view view = {0};
    char buffer[512];
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (r.fov < 0 || (r.fov > 0 && r.fov < 0.01f) || r.fov > 170)
        return cli_usage(&command, "--fov: expected 0 (orthographic) or 0.01 to 170");
    if (r.msaa & (r.msaa - 1))
        return cli_usage(&command, "--msaa: expected 1, 2, 4 or 8");
    if (r.tess & (r.tess - 1))
        return cli_usage(&command, "--tess: expected a power of two from 2 to 128");
    const char *out = output_path(&r, buffer, sizeof buffer), *extension = strrchr(out, '.');
    bool exr = extension && strcasecmp(extension, ".exr") == 0;
    if (!exr && (!extension || strcasecmp(extension, ".png") != 0))
        return cli_error("%s: the picture's name must end in .png or .exr", out);
    if (r.bits && r.bits != 16 && r.bits != (exr ? 32 : 8))
        return cli_usage(&command, "--bits: expected %s",
                         exr ? "16 or 32 for EXR" : "8 or 16 for PNG");
    if (r.out && r.narguments > 1)
        return cli_usage(&command, "two names for the picture: %s and %s", r.arguments[1], r.out);
    slv_env env = cli_env(r.threads);
    if (r.view && scene_load_view(&env, r.view, &view))
        return EXIT_FAILED;
    return draw(&r, &view, out);
}
