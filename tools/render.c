/* The verb render: pictures. */
#include "command/ids.h"
#include "command/latlong.h"
#include "command/output.h"
#include "command/salvage.h"
#include "command/scene.h"
#include "verbs.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

struct render {
    const char *ptx;
    scene_options scene;
    const char *out;
    int strategy, context, pass, layout, binding;
    bool raw, quiet, json, compress, even_given, strategy_given;
    int plain_levels;
    uint32_t msaa, aniso, bits;
};

/* The picture's name, or the texture's with .png */
static const char *output_path(const struct render *r, char *buffer, size_t size) {
    if (r->out)
        return r->out;
    const char *name = strrchr(r->ptx, '/');
    name = name ? name + 1 : r->ptx;
    const char *dot = strrchr(name, '.');
    snprintf(buffer, size, "%.*s.png", dot && dot != name ? (int)(dot - name) : (int)strlen(name),
             name);
    return buffer;
}

/* What draws pictures, one after the other. */
struct drawing {
    const struct render *render;
    scene_shot shot;
    slv_gl *gl;
    slv_gl_texture *texture; /* or */
    slv_gl_images *images;
    slv_gl_renderer *renderer;
    slv_image_params file;
    json_t *pictures; /* what --json says of each */
};

static slv_result add_picture(const slv_env *env, struct drawing *d, const char *path,
                              const slv_image *image, bool empty, double seconds) {
    if (!d->render->json)
        return SLV_OK;
    json_t *triangles = d->renderer
                            ? json_integer((json_int_t)slv_gl_renderer_triangles(d->renderer))
                            : json_null();
    if (!d->pictures ||
        json_array_append_new(
            d->pictures,
            json_pack("{s:o, s:I, s:I, s:o, s:b, s:o}", "picture", output_json_name(path), "width",
                      (json_int_t)image->width, "height", (json_int_t)image->height, "triangles",
                      triangles, "empty", (int)empty, "seconds", output_json_number(seconds))) != 0)
        return output_fail(env, SLV_ERROR_MEMORY, "%s: no memory to describe it", path);
    return SLV_OK;
}

/* All that is known of what was drawn, whichever way. */
static json_t *drawing_json(const struct drawing *d, double seconds) {
    const struct render *r = d->render;
    const slv_strategy *strategy = slv_strategy_at((uint32_t)r->strategy);
    const bool ids = r->pass != 0;
    /* with --uv what is named first is the mesh */
    const char *texture = r->scene.uv ? r->scene.uv : r->ptx,
               *mesh = r->scene.uv ? r->ptx : r->scene.mesh;
    const uint64_t bytes = d->images    ? slv_gl_images_bytes(d->images)
                           : d->texture ? slv_gl_texture_get_stats(d->texture, strategy).gpu_bytes
                                        : 0;
    return json_pack("{s:i, s:o, s:o, s:s, s:o, s:I, s:I, s:I, s:o, s:o, s:O}", "schema", 1,
                     "texture", output_json_name(texture), "mesh",
                     mesh ? output_json_name(mesh) : json_null(), "pass", ids ? "ids" : "color",
                     "strategy", d->texture ? json_string(strategy->name) : json_null(), "msaa",
                     (json_int_t)(r->msaa && !ids ? r->msaa : 1), "anisotropy",
                     (json_int_t)r->aniso, "gpu_bytes", (json_int_t)bytes, "renderer",
                     d->gl ? json_string(slv_gl_get_info(d->gl)->renderer) : json_null(), "seconds",
                     output_json_number(seconds), "pictures", d->pictures);
}

/* Face numbers in place of colours; no OpenGL is needed for them. */
static int draw_ids(const slv_env *env, struct drawing *d, const char *path) {
    const struct render *r = d->render;
    double start = cli_now();
    bool exr = slv_image_format_of_name(path) == SLV_IMAGE_EXR;
    const slv_image_params file = {.encoding = SLV_ENCODE_RAW, .bits = exr ? 32 : 8};
    slv_image image = {0};
    bool nothing = true;
    int code = EXIT_FAILED;
    if (ids_draw(env, &d->shot, exr, &image))
        goto done;
    double seconds = cli_now() - start;
    if (output_image(env, path, &image, file, r->scene.progress, r->quiet))
        goto done;
    size_t n = image.nchannels, count = (size_t)image.width * image.height;
    for (size_t i = 0; i < count && nothing; i++)
        nothing = exr ? image.pixels[i] < 0 : image.pixels[n * i + 3] == 0;
    if (nothing)
        scene_warn_of_nothing(path);
    if (!r->quiet)
        printf("%s: %u x %u, the face of each pixel\n", path, image.width, image.height);
    code = add_picture(env, d, path, &image, nothing, seconds) ? EXIT_FAILED : EXIT_OK;
done:
    slv_image_free(&image);
    return code;
}

/* Whether a picture is background and nothing else. */
static bool is_empty(const slv_image *image, const float background[4]) {
    size_t npixels = (size_t)image->width * image->height;
    for (size_t i = 0; i < 4 * npixels; i++)
        if (!(fabsf(image->pixels[i] - background[i % 4]) < 0.01f))
            return false;
    return true;
}

static slv_frame frame_of(const struct render *r, const scene_shot *shot) {
    slv_frame frame = {.camera = shot->camera,
                       .width = shot->width,
                       .height = shot->height,
                       .msaa = r->msaa,
                       .strategy = slv_strategy_at((uint32_t)r->strategy),
                       .shading = shot->shading,
                       .light = &shot->light,
                       .ka = shot->ka,
                       .kd = shot->kd,
                       .float_target = r->bits == 32,
                       .alpha = shot->scene.alpha};
    memcpy(frame.background, shot->background, sizeof frame.background);
    return frame;
}

static slv_result begin(const slv_env *env, struct drawing *d) {
    const struct render *r = d->render;
    const slv_strategy *strategy = slv_strategy_at((uint32_t)r->strategy);
    const scene_data *scene = &d->shot.scene;
    slv_gl_texture_params upload = {.strategies = &strategy,
                                    .nstrategies = 1,
                                    .anisotropy = r->aniso,
                                    .even_levels = r->even_given ? !r->plain_levels : scene->even,
                                    .layout = (slv_gl_layout)r->layout,
                                    .binding = (slv_gl_binding)r->binding,
                                    .compression = r->compress ? SLV_GL_COMPRESSION_BLOCKS
                                                               : SLV_GL_COMPRESSION_NONE,
                                    .encoding = (slv_texture_encoding)r->scene.encoding,
                                    .border_u = scene->border_u,
                                    .border_v = scene->border_v,
                                    .edge_filter = scene->edge_filter};
    if (r->raw && !upload.encoding)
        upload.encoding = SLV_TEXTURE_DATA;
    const slv_texture_encoding encoding =
        scene->uv ? slv_bake_source_get_desc(scene->uv)->encoding
                  : slv_texture_get_encoding(scene->texture, upload.encoding);
    d->file.encoding = r->raw || encoding == SLV_TEXTURE_DATA ? SLV_ENCODE_RAW : SLV_ENCODE_SRGB;
    slv_result result = slv_gl_create(env, (slv_gl_backend)r->context, &d->gl);
    if (result)
        return result;
    return scene->uv ? slv_gl_images_create(d->gl, env, &scene->images, r->aniso, &d->images)
                     : slv_gl_texture_create(d->gl, env, scene->texture, scene->adjacency, &upload,
                                             &d->texture);
}

static void tell(const struct drawing *d, const slv_frame *frame, const char *path) {
    const char *renderer = slv_gl_get_info(d->gl)->renderer;
    const uint32_t msaa = frame->msaa ? frame->msaa : 1, aniso = d->render->aniso;
    if (d->images) {
        const slv_uv_images *images = &d->shot.scene.images;
        uint32_t there = 0; /* of a set, some tiles may not be */
        for (uint32_t i = 0; i < images->ntiles; i++)
            there += images->tiles[i].width > 0;
        printf("%s: %u x %u, %u image%s by texture coordinates, %ux MSAA, %ux anisotropy, %.1f MB "
               "on the GPU, %s\n",
               path, frame->width, frame->height, there, there == 1 ? "" : "s", msaa, aniso,
               (double)slv_gl_images_bytes(d->images) / 1e6, renderer);
        return;
    }
    slv_gl_texture_stats stats = slv_gl_texture_get_stats(d->texture, frame->strategy);
    printf("%s: %u x %u, %s, %ux MSAA, %ux anisotropy, %" PRIu64
           " triangles, %.1f MB on the GPU, %s\n",
           path, frame->width, frame->height, frame->strategy->name, msaa, aniso,
           slv_gl_renderer_triangles(d->renderer), (double)stats.gpu_bytes / 1e6, renderer);
    if (d->render->compress)
        printf("compressed: texels are off by %.4f RMS, %.3f at most\n", stats.block_rms,
               stats.block_max);
}

/* One picture of the surface and the camera as they are now. */
static slv_result draw_picture(const slv_env *env, struct drawing *d, const char *path) {
    const struct render *r = d->render;
    const scene_shot *shot = &d->shot;
    const slv_frame frame = frame_of(r, shot);
    slv_image image = {0};
    double start = cli_now();
    slv_result result =
        d->renderer ? slv_gl_renderer_tessellate(d->renderer, env, shot->scene.mesh,
                                                 shot->scene.surface, &shot->tessellation)
                    : slv_gl_renderer_create_with(d->gl, env, shot->scene.mesh, shot->scene.surface,
                                                  &shot->tessellation, &d->renderer);
    if (result)
        return result;
    result = d->images
                 ? slv_gl_renderer_draw_images(d->renderer, env, d->images, &frame, &image, NULL)
                 : slv_gl_renderer_draw(d->renderer, env, d->texture, &frame, &image, NULL);
    double seconds = cli_now() - start;
    if (!result &&
        !(result = output_image(env, path, &image, d->file, r->scene.progress, r->quiet))) {
        bool empty = is_empty(&image, frame.background);
        if (empty)
            scene_warn_of_nothing(path);
        if (!r->quiet)
            tell(d, &frame, path);
        result = add_picture(env, d, path, &image, empty, seconds);
    }
    slv_image_free(&image);
    return result;
}

struct look {
    slv_gl_texture *texture;
    const slv_strategy *strategy;
};

static slv_result look_up(void *user, const slv_env *env, const latlong_points *p) {
    const struct look *look = user;
    slv_result result = slv_gl_texture_lookup(look->texture, env, look->strategy, p->count,
                                              p->faces, p->uv, p->dx, p->dy, p->values);
    for (uint32_t i = 0; i < p->count; i++)
        p->values[4 * (size_t)i + 3] = 1;
    return result;
}

/* All directions of an environment. */
static slv_result draw_map(const slv_env *env, struct drawing *d, const char *path) {
    const struct render *r = d->render;
    const scene_shot *shot = &d->shot;
    const slv_frame frame = frame_of(r, shot);
    struct look look = {d->texture, frame.strategy};
    slv_image image = {0};
    double start = cli_now();
    slv_result result = latlong_draw(env, shot->scene.mesh, shot->width, shot->height,
                                     r->msaa > 1 ? 2 : 1, look_up, &look, &image);
    double seconds = cli_now() - start;
    if (!result)
        result = output_image(env, path, &image, d->file, r->scene.progress, r->quiet);
    if (!result)
        result = add_picture(env, d, path, &image, false, seconds);
    if (!result && !r->quiet)
        printf("%s: %u x %u, %s, %u lookups per pixel, %ux anisotropy, %s\n", path, image.width,
               image.height, frame.strategy->name, r->msaa > 1 ? 4 : 1, r->aniso,
               slv_gl_get_info(d->gl)->renderer);
    slv_image_free(&image);
    return result;
}

static int draw(const cli_command *command, const struct render *r, const char *path) {
    slv_env env = cli_env(r->scene.threads);
    struct drawing d = {
        .render = r, .file = {.bits = r->bits}, .pictures = r->json ? json_array() : NULL};
    const double start = cli_now();
    const char *const inputs[] = {r->ptx,        r->scene.mesh,
                                  r->scene.view, r->scene.displace.texture,
                                  r->scene.uv,   r->scene.light};
    const frames_list *frames = &d.shot.scene.frames;
    const bool known = !r->scene.frames && !r->scene.turntable;
    char name[FRAMES_PATH];
    if (known && output_check(&env, path, inputs, 6))
        return EXIT_FAILED;
    int code = scene_load_shot(command, &env, r->ptx, &r->scene, &d.shot);
    for (uint32_t i = 0; i < frames->count && !code; i++)
        code = scene_frame_name(&env, frames, i, path, name) || output_check(&env, name, inputs, 6)
                   ? EXIT_FAILED
                   : EXIT_OK;
    if (code)
        goto done;
    code = EXIT_FAILED;
    if (!r->pass && begin(&env, &d))
        goto done;
    for (uint32_t i = 0; i < frames->count || (i == 0 && !frames->count); i++) {
        if (scene_frame_name(&env, frames, i, path, name) || scene_frame_set(&env, i, &d.shot) ||
            (r->pass            ? draw_ids(&env, &d, name) != EXIT_OK
             : r->scene.latlong ? draw_map(&env, &d, name) != SLV_OK
                                : draw_picture(&env, &d, name) != SLV_OK))
            goto done;
    }
    code = d.shot.salvaged && !r->pass ? EXIT_FAILED : EXIT_OK;
    if (r->json && output_print_json(path, drawing_json(&d, cli_now() - start)))
        code = EXIT_FAILED;
done:
    json_decref(d.pictures);
    slv_gl_renderer_destroy(d.renderer);
    slv_gl_texture_destroy(d.texture);
    slv_gl_images_destroy(d.images);
    slv_gl_destroy(d.gl);
    scene_free(&d.shot.scene);
    return code;
}

/* What is wrong with the options; NULL if nothing is. */
static const char *options_problem(const struct render *r) {
    const char *problem = scene_options_problem(&r->scene);
    if (problem)
        return problem;
    const struct {
        bool given;
        const char *problem;
    } faces[] = {{r->compress, "--compress is of per-face textures, not of --uv"},
                 {r->even_given, "--even-levels is of per-face textures, not of --uv"},
                 {r->layout != 0, "--layout is of per-face textures, not of --uv"},
                 {r->binding != 0, "--binding is of per-face textures, not of --uv"},
                 {r->strategy_given, "--strategy is of per-face textures, not of --uv"}};
    for (size_t i = 0; i < sizeof faces / sizeof *faces && r->scene.uv; i++)
        if (faces[i].given)
            return faces[i].problem;
    if (r->scene.latlong && r->pass)
        return "--pass ids is of a surface, not of --latlong";
    return r->msaa & (r->msaa - 1) ? "--msaa: expected 1, 2, 4 or 8" : NULL;
}

int verb_render(int argc, char **argv) {
    enum { OWN = 23 };
    struct render r = {.scene = scene_options_default(), .msaa = 4, .aniso = 1};
    r.scene.numbered = true;
    char strategies[SCENE_STRATEGIES_SIZE], how[80], buffer[512];
    uint32_t narguments = 0;
    snprintf(how, sizeof how, "how a lookup crosses a seam (%s)", slv_strategy_default()->name);
    cli_option options[OWN + SCENE_OPTION_ROWS] = {
        CLI_OUT(&r.out, "picture, .png or .exr (the texture's name with .png)", "FILE"),
        {"--strategy|-s", CLI_CHOICE, &r.strategy, how,
         scene_strategies(strategies, sizeof strategies), 0, 0, &r.strategy_given},
        {"--pass", CLI_CHOICE, &r.pass,
         "the picture, or the face of each pixel: EXR its number, -1 for none; PNG a colour that "
         "stands for it",
         "color|ids", 0, 0, NULL},
        {"--msaa", CLI_UINT, &r.msaa,
         "samples per pixel: 1, 2, 4, 8, as far as the driver goes (4)", NULL, 1, 64, NULL},
        SCENE_ANISO(&r.aniso, "anisotropy, 1 (trilinear) to 16 (1)"),
        SCENE_LAYOUT(&r.layout),
        {"--binding", CLI_CHOICE, &r.binding,
         "array textures: on units, or by the driver's handles", "auto|units|handles", 0, 0, NULL},
        SCENE_EVEN_LEVELS(&r.plain_levels, &r.even_given),
        {"--compress", CLI_FLAG, &r.compress,
         "8-bit textures: keep blocks on the GPU (BC1 and its kin)", NULL, 0, 0, NULL},
        {"--raw", CLI_FLAG, &r.raw,
         "numbers as they stand: nothing decoded (but by --texture-encoding) or encoded", NULL, 0,
         0, NULL},
        {"--bits", CLI_UINT, &r.bits, "PNG: 8 or 16 (8). EXR: 16 half or 32 float (16)", NULL, 8,
         32, NULL},
        SCENE_CONTEXT(&r.context),
        SCENE_ALPHA(&r.scene.alpha, &r.scene.straight, "blend, or the view's", &r.scene.alpha_given,
                    &r.scene.straight_given),
        SCENE_ENVIRONMENT(&r.scene.environment),
        SCENE_LATLONG(&r.scene.latlong),
        SCENE_UV(&r.scene.uv),
        SCENE_ROUND(&r.scene.round),
        SCENE_FRAMES(&r.scene.frames),
        SCENE_TURNTABLE(&r.scene.turntable),
        CLI_SALVAGE(&r.scene.salvage),
        CLI_JSON(&r.json),
        CLI_QUIET(&r.quiet, "print nothing on success"),
    };
    const cli_command command = {
        .name = "render",
        .summary = "draw a .ptx on its subdivision surface",
        .arguments = "FILE.ptx [OUT.png|OUT.exr]",
        .reads = "a texture; a mesh and a view file if they are named; with --uv a mesh and "
                 "images",
        .writes = "a picture, PNG or EXR, alpha where there is no surface",
        .examples =
            "  selvage render teapot.ptx -o teapot.png\n"
            "  selvage render cow.ptx --mesh cow.obj --azimuth 60 --strategy discard\n"
            "  selvage render teapot.ptx --view view.json --raw --out linear.exr --bits 32\n"
            "  selvage render teapot.ptx -o teapot.png --json | jq '.pictures[].triangles'\n"
            "  selvage render cow.obj --uv 'cow.<UDIM>.exr' -o cow.png\n",
        CLI_TAKES(options, 1, 1, &r.ptx, &narguments),
        .output = &r.out};
    while (slv_strategy_at((uint32_t)r.strategy) != slv_strategy_default())
        r.strategy++;
    r.scene.alpha = SLV_ALPHA_BLEND;
    scene_options_rows(&r.scene, options + OWN);
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    r.scene.raw = r.raw;
    r.quiet |= r.json;
    r.scene.quiet = r.quiet;
    const char *problem = options_problem(&r);
    if (problem)
        return cli_usage(&command, "%s", problem);
    const char *out = output_path(&r, buffer, sizeof buffer);
    slv_image_format format = slv_image_format_of_name(out);
    bool exr = format == SLV_IMAGE_EXR;
    if (format == SLV_IMAGE_NONE)
        return cli_usage(&command, "%s: the picture's name must end in .png or .exr", out);
    if (r.bits && r.bits != 16 && r.bits != (exr ? 32 : 8))
        return cli_usage(&command, "--bits: expected %s",
                         exr ? "16 or 32 for EXR" : "8 or 16 for PNG");
    return draw(&command, &r, out);
}
