/* The verb render: one picture. */
#include "command/ids.h"
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
    int strategy, context, pass;
    bool raw, quiet, compress;
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

/* Face numbers in place of colours; no OpenGL is needed for them. */
static int draw_ids(const slv_env *env, const struct render *r, const scene_shot *shot,
                    const char *path) {
    bool exr = slv_image_format_of_name(path) == SLV_IMAGE_EXR;
    const slv_image_params file = {.encoding = SLV_ENCODE_RAW, .bits = exr ? 32 : 8};
    slv_image image = {0};
    bool nothing = true;
    int code = EXIT_FAILED;
    if (ids_draw(env, shot, exr, &image) ||
        output_image(env, path, &image, file, r->scene.progress, r->quiet))
        goto done;
    size_t n = image.nchannels, count = (size_t)image.width * image.height;
    for (size_t i = 0; i < count && nothing; i++)
        nothing = exr ? image.pixels[i] < 0 : image.pixels[n * i + 3] == 0;
    if (nothing)
        scene_warn_of_nothing(path);
    if (!r->quiet)
        printf("%s: %u x %u, the face of each pixel\n", path, image.width, image.height);
    code = EXIT_OK;
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
                       .ka = shot->ka,
                       .kd = shot->kd,
                       .float_target = r->bits == 32,
                       .alpha = shot->scene.alpha};
    memcpy(frame.background, shot->background, sizeof frame.background);
    return frame;
}

/* The image, or images, of a mesh with texture coordinates. */
static int draw_images(const slv_env *env, const struct render *r, const scene_shot *shot,
                       const char *path) {
    const slv_frame frame = frame_of(r, shot);
    const bool data = slv_bake_source_get_desc(shot->scene.uv)->encoding == SLV_TEXTURE_DATA;
    const slv_image_params file = {.bits = r->bits,
                                   .encoding = r->raw || data ? SLV_ENCODE_RAW : SLV_ENCODE_SRGB};
    slv_gl *gl = NULL;
    slv_gl_images *images = NULL;
    slv_gl_renderer *renderer = NULL;
    slv_image image = {0};
    int code = EXIT_FAILED;
    if (slv_gl_create(env, (slv_gl_backend)r->context, &gl) ||
        slv_gl_images_create(gl, env, &shot->scene.images, r->aniso, &images) ||
        slv_gl_renderer_create_with(gl, env, shot->scene.mesh, shot->scene.surface,
                                    &shot->tessellation, &renderer) ||
        slv_gl_renderer_draw_images(renderer, env, images, &frame, &image, NULL) ||
        output_image(env, path, &image, file, r->scene.progress, r->quiet))
        goto done;
    if (is_empty(&image, frame.background))
        scene_warn_of_nothing(path);
    if (!r->quiet)
        printf("%s: %u x %u, %u image(s) by texture coordinates, %ux MSAA, %ux anisotropy, %.1f MB "
               "on the GPU, %s\n",
               path, frame.width, frame.height, shot->scene.images.ntiles,
               frame.msaa ? frame.msaa : 1, r->aniso, (double)slv_gl_images_bytes(images) / 1e6,
               slv_gl_get_info(gl)->renderer);
    code = EXIT_OK;
done:
    slv_image_free(&image);
    slv_gl_renderer_destroy(renderer);
    slv_gl_images_destroy(images);
    slv_gl_destroy(gl);
    return code;
}

static int draw(const cli_command *command, const struct render *r, const char *path) {
    slv_env env = cli_env(r->scene.threads);
    const slv_strategy *strategy = slv_strategy_at((uint32_t)r->strategy);
    scene_shot shot;
    slv_gl *gl = NULL;
    slv_gl_texture *texture = NULL;
    slv_gl_renderer *renderer = NULL;
    slv_image image = {0};
    slv_gl_texture_params upload = {.strategies = &strategy,
                                    .nstrategies = 1,
                                    .anisotropy = r->aniso,
                                    .compression = r->compress ? SLV_GL_COMPRESSION_BLOCKS
                                                               : SLV_GL_COMPRESSION_NONE,
                                    .encoding = (slv_texture_encoding)r->scene.encoding};
    slv_image_params file = {.bits = r->bits};
    const char *const inputs[] = {r->ptx, r->scene.mesh, r->scene.view, r->scene.displace.texture,
                                  r->scene.uv};
    if (output_check(&env, path, inputs, 5))
        return EXIT_FAILED;
    int code = scene_load_shot(command, &env, r->ptx, &r->scene, &shot);
    if (code)
        goto done;
    if (r->pass || shot.scene.uv) {
        code = r->pass ? draw_ids(&env, r, &shot, path) : draw_images(&env, r, &shot, path);
        goto done;
    }
    code = EXIT_FAILED;
    upload.border_u = shot.scene.border_u;
    upload.border_v = shot.scene.border_v;
    if (r->raw && !upload.encoding)
        upload.encoding = SLV_TEXTURE_DATA;
    if (r->raw || slv_texture_get_encoding(shot.scene.texture, upload.encoding) == SLV_TEXTURE_DATA)
        file.encoding = SLV_ENCODE_RAW;
    const slv_frame frame = frame_of(r, &shot);
    if (slv_gl_create(&env, (slv_gl_backend)r->context, &gl) ||
        slv_gl_texture_create(gl, &env, shot.scene.texture, shot.scene.adjacency, &upload,
                              &texture) ||
        slv_gl_renderer_create_with(gl, &env, shot.scene.mesh, shot.scene.surface,
                                    &shot.tessellation, &renderer) ||
        slv_gl_renderer_draw(renderer, &env, texture, &frame, &image, NULL) ||
        output_image(&env, path, &image, file, r->scene.progress, r->quiet))
        goto done;
    if (is_empty(&image, frame.background))
        scene_warn_of_nothing(path);
    if (!r->quiet) {
        slv_gl_texture_stats stats = slv_gl_texture_get_stats(texture, frame.strategy);
        printf("%s: %u x %u, %s, %ux MSAA, %ux anisotropy, %" PRIu64
               " triangles, %.1f MB on the GPU, %s\n",
               path, frame.width, frame.height, frame.strategy->name, frame.msaa ? frame.msaa : 1,
               r->aniso, slv_gl_renderer_triangles(renderer), (double)stats.gpu_bytes / 1e6,
               slv_gl_get_info(gl)->renderer);
        if (r->compress)
            printf("compressed: texels are off by %.4f RMS, %.3f at most\n", stats.block_rms,
                   stats.block_max);
    }
    code = shot.scene.salvaged ? EXIT_FAILED : EXIT_OK;
done:
    slv_image_free(&image);
    slv_gl_renderer_destroy(renderer);
    slv_gl_texture_destroy(texture);
    slv_gl_destroy(gl);
    scene_free(&shot.scene);
    return code;
}

int verb_render(int argc, char **argv) {
    enum { OWN = 16 };
    struct render r = {.scene = scene_options_default(), .msaa = 4, .aniso = 1};
    char strategies[SCENE_STRATEGIES_SIZE], how[80];
    uint32_t narguments = 0;
    snprintf(how, sizeof how, "how a lookup crosses a seam (%s)", slv_strategy_default()->name);
    cli_option options[OWN + SCENE_OPTION_ROWS] = {
        CLI_OUT(&r.out, "picture, .png or .exr (the texture's name with .png)", "FILE"),
        {"--strategy|-s", CLI_CHOICE, &r.strategy, how,
         scene_strategies(strategies, sizeof strategies), 0, 0, NULL},
        {"--pass", CLI_CHOICE, &r.pass,
         "the picture, or the face of each pixel: EXR its number, -1 for none; PNG a colour that "
         "stands for it",
         "color|ids", 0, 0, NULL},
        {"--msaa", CLI_UINT, &r.msaa,
         "samples per pixel: 1, 2, 4, 8, as far as the driver goes (4)", NULL, 1, 64, NULL},
        SCENE_ANISO(&r.aniso, "anisotropy, 1 (trilinear) to 16 (1)"),
        {"--compress", CLI_FLAG, &r.compress,
         "8-bit textures: keep blocks on the GPU (BC1 and its kin)", NULL, 0, 0, NULL},
        {"--raw", CLI_FLAG, &r.raw,
         "numbers as they stand: nothing decoded (but by --texture-encoding) or encoded", NULL, 0,
         0, NULL},
        {"--bits", CLI_UINT, &r.bits, "PNG: 8 or 16 (8). EXR: 16 half or 32 float (16)", NULL, 8,
         32, NULL},
        SCENE_CONTEXT(&r.context),
        SCENE_ALPHA(&r.scene.alpha, &r.scene.premultiplied, "blend"),
        SCENE_ENVIRONMENT(&r.scene.environment),
        SCENE_UV(&r.scene.uv),
        SCENE_ROUND(&r.scene.round),
        CLI_SALVAGE(&r.scene.salvage),
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
            "  selvage render teapot.ptx --pass ids faces.exr\n"
            "  selvage render cow.obj --uv 'cow.<UDIM>.exr' -o cow.png\n",
        .options = options,
        .noptions = sizeof options / sizeof *options,
        .min_arguments = 1,
        .max_arguments = 1,
        .positional = &r.ptx,
        .npositional = &narguments,
        .output = &r.out};
    char buffer[512];
    while (slv_strategy_at((uint32_t)r.strategy) != slv_strategy_default())
        r.strategy++;
    r.scene.alpha = SLV_ALPHA_BLEND;
    scene_options_rows(&r.scene, options + OWN);
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    r.scene.raw = r.raw;
    const char *problem = scene_options_problem(&r.scene);
    if (problem)
        return cli_usage(&command, "%s", problem);
    if (r.scene.uv && r.compress)
        return cli_usage(&command, "--compress is of per-face textures, not of --uv");
    if (r.msaa & (r.msaa - 1))
        return cli_usage(&command, "--msaa: expected 1, 2, 4 or 8");
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
