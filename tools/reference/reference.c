/* The verb reference: a picture by rays, and how its error falls with their number. */
#include "command/latlong.h"
#include "command/output.h"
#include "command/scene.h"
#include "reference/convergence.h"
#include "verbs.h"

#include <selvage/folder.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

struct reference {
    const char *ptx;
    scene_options scene;
    const char *out, *error, *convergence;
    int filter;
    uint32_t samples, seed, bits;
    bool json, quiet;
};

struct outcome {
    slv_reference_stats stats;
    double seconds;
    uint32_t width, height, segments;
    convergence convergence;
};

/* The picture's name, or the texture's with .exr */
static const char *output_path(const struct reference *r, char *buffer, size_t size) {
    if (r->out)
        return r->out;
    const char *name = strrchr(r->ptx, '/');
    name = name ? name + 1 : r->ptx;
    const char *dot = strrchr(name, '.');
    snprintf(buffer, size, "%.*s.exr", dot && dot != name ? (int)(dot - name) : (int)strlen(name),
             name);
    return buffer;
}

static slv_result render(const struct reference *r, const slv_env *env,
                         const slv_reference *reference, const slv_reference_frame *frame,
                         slv_image *image, slv_image *error, slv_reference_stats *stats,
                         double *seconds) {
    char what[64];
    snprintf(what, sizeof what, "%u samples per pixel", frame->samples);
    cli_progress progress = cli_progress_begin(what, 1, r->scene.progress, r->quiet || r->json);
    slv_reference_frame watched = *frame;
    cli_catch_interrupts();
    double start = cli_now();
    watched.progress = (slv_progress){cli_progress_report, &progress};
    slv_result result = slv_reference_render(reference, env, &watched, image, error, stats);
    *seconds = cli_now() - start;
    if (!result)
        cli_progress_end(&progress);
    return result;
}

/* The same picture with fewer samples, each time others, held against the one with the most. */
static slv_result converge(const struct reference *r, const slv_env *env,
                           const slv_reference *reference, const slv_reference_frame *frame,
                           const slv_image *best, struct outcome *o) {
    convergence *c = &o->convergence;
    slv_result result = SLV_OK;
    *c = convergence_begin(frame->samples);
    for (uint32_t i = 0; i + 1 < c->count && !result; i++) {
        slv_reference_frame fewer = *frame;
        slv_reference_stats stats;
        slv_image image = {0};
        fewer.samples = c->rows[i].samples;
        fewer.seed = frame->seed + 1 + i;
        result = render(r, env, reference, &fewer, &image, NULL, &stats, &c->rows[i].seconds);
        if (!result) {
            c->rows[i].estimate = stats.error;
            c->rows[i].measured = convergence_distance(&image, best);
        }
        slv_image_free(&image);
    }
    c->rows[c->count - 1].seconds = o->seconds;
    c->rows[c->count - 1].estimate = o->stats.error;
    return result;
}

/* The table and the plot, beside their place until the end. */
static slv_result study(const struct reference *r, const slv_env *env,
                        const slv_reference *reference, const slv_reference_frame *frame,
                        const slv_image *best, struct outcome *o) {
    slv_folder *folder;
    slv_result result = converge(r, env, reference, frame, best, o);
    if (result || (result = slv_folder_begin(env, r->convergence, &folder)))
        return result;
    return slv_folder_end(folder, NULL,
                          convergence_write(env, slv_folder_path(folder), &o->convergence));
}

/* Rays know no footprints: there are as many lookups as it takes. */
static slv_result look_up(void *user, const slv_env *env, const latlong_points *p) {
    slv_surface_point *points = malloc(p->count * sizeof *points);
    float *rgb = malloc(3 * (size_t)p->count * sizeof *rgb);
    slv_result result =
        points && rgb ? SLV_OK : output_fail(env, SLV_ERROR_MEMORY, "no memory for a map");
    for (uint32_t i = 0; i < p->count && !result; i++)
        points[i] = (slv_surface_point){p->faces[i], p->uv[2 * i], p->uv[2 * i + 1]};
    if (!result)
        result = slv_reference_lookup(user, p->count, points, rgb);
    for (uint32_t i = 0; i < p->count && !result; i++)
        for (int c = 0; c < 4; c++)
            p->values[4 * (size_t)i + c] = c < 3 ? rgb[3 * (size_t)i + c] : 1;
    free(points);
    free(rgb);
    return result;
}

/* All directions of an environment. */
static slv_result make_map(const struct reference *r, const slv_env *env, const scene_shot *shot,
                           slv_reference *reference, const char *path, struct outcome *o) {
    const slv_image_params file = {.bits = r->bits ? r->bits : 32};
    uint32_t side = (uint32_t)ceil(sqrt(r->samples));
    slv_image image = {0};
    double start = cli_now();
    slv_result result = latlong_draw(env, shot->scene.mesh, shot->width, shot->height, side,
                                     look_up, reference, &image);
    o->seconds = cli_now() - start;
    o->stats = (slv_reference_stats){.samples = (uint64_t)side * side * o->width * o->height,
                                     .ncovered = (uint64_t)o->width * o->height,
                                     .error = NAN,
                                     .worst = NAN};
    if (!result)
        result = output_image(env, path, &image, file, r->scene.progress, r->quiet || r->json);
    slv_image_free(&image);
    return result;
}

/* The surface and the camera as they are now, and what is asked of them. */
static slv_result make_picture(const struct reference *r, const slv_env *env,
                               const scene_shot *shot, const char *path, struct outcome *o) {
    const slv_image_params file = {.bits = r->bits ? r->bits : 32}, wide = {.bits = 32};
    slv_reference *reference = NULL;
    slv_image image = {0}, error = {0};
    slv_result result;
    const slv_reference_params params = {.tessellation = &shot->tessellation,
                                         .encoding = (slv_texture_encoding)r->scene.encoding,
                                         .alpha = shot->scene.alpha,
                                         .border_u = shot->scene.border_u,
                                         .border_v = shot->scene.border_v,
                                         .edge_filter = shot->scene.edge_filter,
                                         .images = shot->scene.uv ? &shot->scene.images : NULL};
    slv_reference_frame frame = {.camera = shot->camera,
                                 .width = shot->width,
                                 .height = shot->height,
                                 .shading = shot->shading,
                                 .light = &shot->light,
                                 .ka = shot->ka,
                                 .kd = shot->kd,
                                 .filter = (slv_pixel_filter)r->filter,
                                 .samples = r->samples,
                                 .seed = r->seed};
    memcpy(frame.background, shot->background, sizeof frame.background);
    o->width = shot->width;
    o->height = shot->height;
    o->segments = shot->tessellation.segments;
    const bool forced = r->scene.progress, quiet = r->quiet || r->json;
    if ((result =
             slv_reference_create(env, shot->scene.mesh, shot->scene.surface, shot->scene.texture,
                                  shot->scene.adjacency, &params, &reference)))
        goto done;
    if (r->scene.latlong) {
        result = make_map(r, env, shot, reference, path, o);
        goto done;
    }
    if ((result = render(r, env, reference, &frame, &image, &error, &o->stats, &o->seconds)) ||
        (result = output_image(env, path, &image, file, forced, quiet)) ||
        (r->error && (result = output_image(env, r->error, &error, wide, forced, quiet))) ||
        (r->convergence && (result = study(r, env, reference, &frame, &image, o))))
        goto done;
    if (!o->stats.ncovered)
        scene_warn_of_nothing(path);
done:
    slv_image_free(&image);
    slv_image_free(&error);
    slv_reference_destroy(reference);
    return result;
}

static double speed(const struct outcome *o) {
    return o->seconds > 0 ? (double)o->stats.samples / 1e6 / o->seconds : NAN;
}

static void print_outcome(const struct reference *r, const char *path, const struct outcome *o) {
    const convergence *c = &o->convergence;
    char segments[32] = "";
    if (o->segments)
        snprintf(segments, sizeof segments, " %u segments,", o->segments);
    printf("%s: %u x %u, %u samples per pixel, %s filter,%s %.1f s, %.1f million "
           "samples a second\n",
           path, o->width, o->height, r->samples, r->filter == SLV_PIXEL_BOX ? "box" : "mitchell",
           segments, o->seconds, speed(o));
    if (!isnan(o->stats.error))
        printf("its own error, estimated: %.2e RMS, %.2e in the worst pixel\n", o->stats.error,
               o->stats.worst);
    if (!c->count)
        return;
    printf("%10s %10s %14s %14s\n", "samples", "seconds", "estimated RMS", "measured RMS");
    for (uint32_t i = 0; i < c->count; i++)
        printf("%10u %10.2f %14.3e %14.3e\n", c->rows[i].samples, c->rows[i].seconds,
               c->rows[i].estimate, c->rows[i].measured);
    printf("the estimated error falls as 1/N^%.2f\n", convergence_order(c));
}

/* Returns an exit code. */
static int make(const cli_command *command, const struct reference *r, const slv_env *env,
                const char *const inputs[5], const char *path, struct outcome *o) {
    scene_shot shot;
    char name[FRAMES_PATH];
    const frames_list *frames = &shot.scene.frames;
    int code = scene_load_shot(command, env, r->ptx, &r->scene, &shot);
    if (!code && frames->count && (r->error || r->convergence || r->json))
        code = cli_usage(command, "--error, --convergence and --json are of one picture");
    for (uint32_t i = 0; i < frames->count && !code; i++)
        code = scene_frame_name(env, frames, i, path, name) || output_check(env, name, inputs, 6)
                   ? EXIT_FAILED
                   : EXIT_OK;
    shot.tessellation.pixels = SLV_TESSELLATION_PIXELS / 4; /* what others are measured against */
    for (uint32_t i = 0; !code && (i < frames->count || (i == 0 && !frames->count)); i++) {
        if (scene_frame_name(env, frames, i, path, name) || scene_frame_set(env, i, &shot) ||
            make_picture(r, env, &shot, name, o))
            code = EXIT_FAILED;
        else if (!r->json && !r->quiet)
            print_outcome(r, name, o);
    }
    scene_free(&shot.scene);
    return code;
}

static json_t *convergence_json(const convergence *c) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < c->count; i++) {
        const convergence_row *row = &c->rows[i];
        if (json_array_append_new(list, json_pack("{s:I, s:o, s:o, s:o}", "samples",
                                                  (json_int_t)row->samples, "seconds",
                                                  output_json_number(row->seconds), "estimated_rms",
                                                  output_json_number(row->estimate), "measured_rms",
                                                  output_json_number(row->measured)))) {
            json_decref(list);
            return NULL;
        }
    }
    return list;
}

static json_t *outcome_json(const struct reference *r, const char *path, const struct outcome *o) {
    return json_pack(
        "{s:i, s:o, s:o, s:I, s:I, s:I, s:s, s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:o}", "schema", 1,
        "texture", output_json_name(r->ptx), "picture", output_json_name(path), "width",
        (json_int_t)o->width, "height", (json_int_t)o->height, "segments", (json_int_t)o->segments,
        "filter", r->filter == SLV_PIXEL_BOX ? "box" : "mitchell", "samples",
        (json_int_t)r->samples, "covered_pixels", (json_int_t)o->stats.ncovered, "estimated_rms",
        output_json_number(o->stats.error), "estimated_worst", output_json_number(o->stats.worst),
        "seconds", output_json_number(o->seconds), "million_samples_per_second",
        output_json_number(speed(o)), "convergence", convergence_json(&o->convergence), "order",
        o->convergence.count ? output_json_number(convergence_order(&o->convergence))
                             : json_null());
}

static int run(const cli_command *command, const struct reference *r, const char *path) {
    struct outcome outcome = {.seconds = 0};
    slv_env env = cli_env(r->scene.threads);
    const char *const inputs[] = {r->ptx,        r->scene.mesh,
                                  r->scene.view, r->scene.displace.texture,
                                  r->scene.uv,   r->scene.light};
    const bool known = !r->scene.frames && !r->scene.turntable;
    /* whether all can be written is known before hours are spent */
    if ((known && output_check(&env, path, inputs, 6)) ||
        (r->error && output_check(&env, r->error, inputs, 6)) ||
        (r->convergence && output_try_folder(&env, r->convergence)))
        return EXIT_FAILED;
    int code = make(command, r, &env, inputs, path, &outcome);
    if (code)
        return code;
    return r->json ? output_print_json(path, outcome_json(r, path, &outcome)) : EXIT_OK;
}

int verb_reference(int argc, char **argv) {
    enum { OWN = 17 };
    uint32_t narguments = 0;
    struct reference r = {.scene = scene_options_default(), .samples = 256};
    r.scene.numbered = true;
    cli_option options[OWN + SCENE_OPTION_ROWS] = {
        CLI_OUT(&r.out, "picture (the texture's name with .exr)", "FILE.exr"),
        {"--samples|-n", CLI_UINT, &r.samples, "rays per pixel, best a power of two (256)", NULL, 1,
         SLV_REFERENCE_MAX_SAMPLES, NULL},
        {"--filter", CLI_CHOICE, &r.filter,
         "how samples count: evenly within the pixel (box), or two pixels wide",
         names_pixel_filters(), 0, 0, NULL},
        {"--error", CLI_TEXT, &r.error, "the estimated error of every pixel", "FILE.exr", 0, 0,
         NULL},
        {"--convergence", CLI_TEXT, &r.convergence,
         "1, 4, 16, ... samples against the most: a table and a plot", "FOLDER", 0, 0, NULL},
        {"--seed", CLI_UINT, &r.seed, "other samples (0)", NULL, 0, UINT32_MAX, NULL},
        {"--bits", CLI_UINT, &r.bits, "16 half or 32 float (32)", NULL, 16, 32, NULL},
        SCENE_ALPHA(&r.scene.alpha, &r.scene.straight, "blend, or the view's", &r.scene.alpha_given,
                    &r.scene.straight_given),
        SCENE_ENVIRONMENT(&r.scene.environment),
        SCENE_LATLONG(&r.scene.latlong),
        SCENE_UV(&r.scene.uv),
        SCENE_ROUND(&r.scene.round),
        SCENE_FRAMES(&r.scene.frames),
        SCENE_TURNTABLE(&r.scene.turntable),
        CLI_JSON(&r.json),
        CLI_QUIET(&r.quiet, "print nothing on success"),
    };
    const cli_command command = {
        .name = "reference",
        .summary = "ray-cast a .ptx: the picture that strategies are measured against",
        .arguments = "FILE.ptx [OUT.exr]",
        .reads = "a texture; a mesh and a view file if they are named; with --uv a mesh and "
                 "images",
        .writes = "a picture, EXR, linear; another of its error and a folder if they are named",
        .examples =
            "  selvage reference teapot.ptx --samples 1024 -o teapot.exr\n"
            "  selvage reference cow.ptx --mesh cow.obj --view view.json --filter mitchell\n"
            "  selvage reference teapot.ptx --samples 4096 --convergence study\n",
        CLI_TAKES(options, 1, 1, &r.ptx, &narguments),
        .output = &r.out};
    char buffer[512];
    r.scene.alpha = SLV_ALPHA_BLEND;
    scene_options_rows(&r.scene, options + OWN);
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    const char *problem = scene_options_problem(&r.scene);
    if (problem)
        return cli_usage(&command, "%s", problem);
    if (r.scene.shading_given && r.scene.shading == SLV_SHADE_LEVELS)
        return cli_usage(&command, "--shading: levels are of lookups, and have no reference");
    if (r.scene.latlong && (r.filter || r.error || r.convergence))
        return cli_usage(&command, "--latlong is the mean over each pixel: no --filter, --error or "
                                   "--convergence");
    if (r.bits && r.bits != 16 && r.bits != 32)
        return cli_usage(&command, "--bits: expected 16 or 32");
    const char *path = output_path(&r, buffer, sizeof buffer);
    if (r.error && strcmp(path, r.error) == 0)
        return cli_usage(&command, "--error: %s is where the picture goes", path);
    if (slv_image_format_of_name(path) != SLV_IMAGE_EXR ||
        (r.error && slv_image_format_of_name(r.error) != SLV_IMAGE_EXR))
        return cli_usage(&command, "%s: the picture's name must end in .exr",
                         slv_image_format_of_name(path) == SLV_IMAGE_EXR ? r.error : path);
    r.scene.quiet = r.quiet || r.json;
    return run(&command, &r, path);
}
