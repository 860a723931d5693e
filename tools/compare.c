#include "compare_reference.h"
#include "output.h"
#include "report.h"
#include "scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct compare {
    const char *arguments[1];
    uint32_t narguments;
    const char *mesh, *out, *strategies, *focus;
    int scheme, boundary, shading, context, adjacency, reference, filter;
    bool quick, quiet, size_given, frames_given;
    uint32_t size[2], msaa, aniso, frames, tess, threads, samples;
    float azimuth, elevation, fov, orbit;
};

struct session {
    const struct compare *options;
    slv_env env;
    scene_data scene;
    slv_gl *gl;
    slv_gl_texture *texture;
    slv_gl_renderer *renderer;
    report_data *report;
};

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Comma-separated names into the report's list; false names the first that is unknown. */
static bool parse_strategies(const char *list, report_data *report, char *bad, size_t bad_size) {
    while (*list) {
        char name[32];
        size_t length = strcspn(list, ",");
        slv_strategy strategy;
        snprintf(name, sizeof name, "%.*s", (int)(length < 31 ? length : 31), list);
        if (!slv_strategy_from_name(name, &strategy)) {
            snprintf(bad, bad_size, "%s", name);
            return false;
        }
        bool there = false;
        for (uint32_t i = 0; i < report->nstrategies; i++)
            there |= report->strategies[i].strategy == strategy;
        if (!there)
            report->strategies[report->nstrategies++].strategy = strategy;
        list += length + (list[length] == ',');
    }
    return report->nstrategies > 0;
}

/* Whether to go on with a long loop. */
static slv_result interruption(void) {
    if (!cli_interrupted())
        return SLV_OK;
    cli_error("interrupted; nothing was written");
    return SLV_ERROR_CANCELLED;
}

static slv_frame frame_at(const struct session *s, double turn, slv_strategy strategy) {
    const struct compare *o = s->options;
    slv_frame frame = {.width = s->report->width,
                       .height = s->report->height,
                       .msaa = s->report->msaa,
                       .strategy = strategy,
                       .shading = (slv_shading)o->shading};
    frame.camera = slv_camera_orbit(s->scene.bounds_min, s->scene.bounds_max,
                                    o->azimuth + (float)turn * o->orbit, o->elevation, o->fov,
                                    (float)frame.width / (float)frame.height);
    return frame;
}

/* Every strategy draws each frame before the next, starting from another one each time, so that
 * whatever else the machine does falls on all alike. The first frame of each compiles shaders and
 * is not counted. */
static slv_result time_frames(struct session *s) {
    report_data *report = s->report;
    uint32_t n = report->nstrategies;
    slv_result result = SLV_OK;
    double *times = calloc((size_t)n * report->frames, sizeof *times);
    if (!times) {
        cli_error("no memory for the timings");
        return SLV_ERROR_MEMORY;
    }
    cli_progress progress =
        cli_progress_begin("timing frames", (uint64_t)n * (report->frames + 1), s->options->quiet);
    for (uint32_t i = 0; !result && !(result = interruption()) && i <= report->frames; i++) {
        for (uint32_t k = 0; !result && k < n; k++) {
            uint32_t which = (k + i) % n;
            double seconds = 0;
            slv_frame frame =
                frame_at(s, (double)i / report->frames, report->strategies[which].strategy);
            result = slv_gl_renderer_draw(s->renderer, &s->env, s->texture, &frame, NULL, &seconds);
            if (i)
                times[which * report->frames + i - 1] = seconds * 1e3;
            cli_progress_update(&progress, (uint64_t)i * n + k + 1);
        }
    }
    cli_progress_end(&progress);
    uint32_t baseline = 0;
    for (uint32_t k = 0; !result && k < n; k++) {
        report_strategy *row = &report->strategies[k];
        double *list = times + (size_t)k * report->frames;
        qsort(list, report->frames, sizeof *list, by_value);
        row->median_ms = list[report->frames / 2];
        row->min_ms = list[0];
        row->max_ms = list[report->frames - 1];
        baseline = row->strategy == SLV_STRATEGY_CLAMP ? k : baseline;
    }
    for (uint32_t k = 0; !result && k < n; k++)
        report->strategies[k].ratio =
            report->strategies[k].median_ms / report->strategies[baseline].median_ms;
    free(times);
    return result;
}

static slv_result measure_seams(struct session *s) {
    report_data *report = s->report;
    slv_result result = SLV_OK;
    cli_progress progress = cli_progress_begin(
        "measuring seams", report->nstrategies * REPORT_LEVELS, s->options->quiet);
    for (uint32_t k = 0; !result && k < report->nstrategies; k++) {
        report_strategy *row = &report->strategies[k];
        row->stats = slv_gl_texture_get_stats(s->texture, row->strategy);
        for (uint32_t level = 0; !result && !(result = interruption()) && level < REPORT_LEVELS;
             level++) {
            slv_gl_seam_params params = {.samples = s->options->quick ? 9 : 17, .level = level};
            result = slv_gl_texture_seam_jump(s->texture, &s->env, row->strategy,
                                              s->scene.adjacency, &params, &row->seams[level]);
            cli_progress_update(&progress, k * REPORT_LEVELS + level + 1);
        }
    }
    cli_progress_end(&progress);
    return result;
}

static slv_result draw_views(struct session *s) {
    report_data *report = s->report;
    slv_result result = SLV_OK;
    for (uint32_t v = 0; v < report->nviews; v++) {
        for (uint32_t k = 0; !result && k < report->nstrategies; k++) {
            slv_frame frame =
                frame_at(s, (double)v / report->nviews, report->strategies[k].strategy);
            result = slv_gl_renderer_draw(s->renderer, &s->env, s->texture, &frame,
                                          &report->strategies[k].views[v], NULL);
        }
    }
    return result;
}

static float pixel_difference(const slv_image *a, const slv_image *b, size_t pixel) {
    float difference = 0;
    for (int c = 0; c < 3; c++) {
        float one = fabsf(a->pixels[4 * pixel + c] - b->pixels[4 * pixel + c]);
        if (!(one <= difference)) /* a NaN differs from everything */
            difference = isnan(one) ? INFINITY : one;
    }
    return difference;
}

/* Black, blue, red, yellow, white. */
static void heat_color(float value, float *rgba) {
    static const float stops[5][3] = {
        {0, 0, 0}, {0.02f, 0.05f, 0.5f}, {0.8f, 0.03f, 0.05f}, {1, 0.7f, 0.02f}, {1, 1, 1}};
    float at = fminf(fmaxf(value, 0), 1) * 4;
    int i = at >= 4 ? 3 : (int)at;
    for (int c = 0; c < 3; c++)
        rgba[c] = stops[i][c] + (at - (float)i) * (stops[i + 1][c] - stops[i][c]);
    rgba[3] = 1;
}

static slv_result compare_pair(struct session *s, report_pair *pair) {
    const report_strategy *a = &s->report->strategies[pair->a],
                          *b = &s->report->strategies[pair->b];
    double sum = 0, squares = 0;
    uint64_t covered = 0, over_1 = 0, over_4 = 0;
    slv_result result =
        slv_image_create(&s->env, s->report->width, s->report->height, 4, &pair->heat);
    if (result)
        return result;
    for (uint32_t v = 0; v < s->report->nviews; v++) {
        size_t npixels = (size_t)s->report->width * s->report->height;
        for (size_t i = 0; i < npixels; i++) {
            float alpha = a->views[v].pixels[4 * i + 3],
                  d = pixel_difference(&a->views[v], &b->views[v], i);
            if (v == 0)
                heat_color(d * 255 / 16, pair->heat.pixels + 4 * i);
            if (alpha < 0.999f)
                continue;
            covered++;
            sum += d;
            over_1 += d > 1.0f / 255;
            over_4 += d > 4.0f / 255;
            pair->max = fmax(pair->max, d);
            for (int c = 0; c < 3; c++) {
                double one = a->views[v].pixels[4 * i + c] - b->views[v].pixels[4 * i + c];
                squares += one * one;
            }
        }
    }
    double n = covered ? (double)covered : 1;
    pair->mean = sum / n;
    pair->over_1 = (double)over_1 / n;
    pair->over_4 = (double)over_4 / n;
    pair->psnr = squares > 0 ? -10 * log10(squares / (3 * n)) : INFINITY;
    return SLV_OK;
}

static slv_result compare_pictures(struct session *s) {
    report_data *report = s->report;
    slv_result result = SLV_OK;
    for (uint32_t a = 0; !result && a < report->nstrategies; a++) {
        for (uint32_t b = a + 1; !result && b < report->nstrategies; b++) {
            report_pair *pair = &report->pairs[report->npairs++];
            pair->a = a;
            pair->b = b;
            result = compare_pair(s, pair);
        }
    }
    return result;
}

/* The places of the first view where the strategies disagree most, no two close together. */
static void find_spots(report_data *report) {
    enum { CELL = 24 };
    uint32_t nx = report->width / CELL, ny = report->height / CELL;
    for (uint32_t found = 0; found < REPORT_MAX_SPOTS; found++) {
        float best = 1.0f / 255;
        report_spot spot = {.zoom = 32};
        for (uint32_t cell = 0; cell < nx * ny; cell++) {
            float x = ((float)(cell % nx) + 0.5f) * CELL / (float)report->width;
            float y = ((float)(cell / nx) + 0.5f) * CELL / (float)report->height, sum = 0;
            bool near = false;
            for (uint32_t k = 0; k < report->nspots; k++)
                near |= hypotf(report->spots[k].x - x, report->spots[k].y - y) < 0.15f;
            for (uint32_t p = 0; !near && p < CELL * CELL; p++) {
                size_t at = (size_t)(cell / nx * CELL + p / CELL) * report->width +
                            cell % nx * CELL + p % CELL;
                for (uint32_t i = 0; i < report->npairs; i++) {
                    const slv_image *a = &report->strategies[report->pairs[i].a].views[0];
                    const slv_image *b = &report->strategies[report->pairs[i].b].views[0];
                    bool inside = a->pixels[4 * at + 3] > 0.999f;
                    sum += inside ? pixel_difference(a, b, at) : -1;
                }
            }
            if (!near && sum > best) {
                best = sum;
                spot.x = x;
                spot.y = y;
            }
        }
        if (best > 1.0f / 255)
            report->spots[report->nspots++] = spot;
    }
}

/* The same camera through a smaller window: a true magnification, not enlarged pixels. */
static slv_result draw_spots(struct session *s) {
    report_data *report = s->report;
    slv_result result = SLV_OK;
    for (uint32_t i = 0; i < report->nspots; i++) {
        const report_spot *spot = &report->spots[i];
        for (uint32_t k = 0; !result && k < report->nstrategies; k++) {
            slv_frame frame = frame_at(s, 0, report->strategies[k].strategy);
            float w[4];
            memcpy(w, frame.camera.window, sizeof w);
            float width = w[1] - w[0], height = w[3] - w[2];
            float x = w[0] + spot->x * width, y = w[3] - spot->y * height,
                  half = height / spot->zoom / 2;
            frame.camera.window[0] = x - half;
            frame.camera.window[1] = x + half;
            frame.camera.window[2] = y - half;
            frame.camera.window[3] = y + half;
            frame.width = frame.height = 240;
            result = slv_gl_renderer_draw(s->renderer, &s->env, s->texture, &frame,
                                          &report->strategies[k].spots[i], NULL);
        }
    }
    return result;
}

static slv_result cast_views(struct session *s) {
    report_data *report = s->report;
    slv_frame frames[REPORT_MAX_VIEWS];
    if (!s->options->reference)
        return SLV_OK;
    report->reference.filter = (slv_pixel_filter)s->options->filter;
    report->reference.samples = s->options->samples ? s->options->samples
                                : s->options->quick ? 64
                                                    : 256;
    for (uint32_t v = 0; v < report->nviews; v++)
        frames[v] = frame_at(s, (double)v / report->nviews, SLV_STRATEGY_CLAMP);
    return compare_reference(&s->env, &s->scene, frames, s->options->quiet, report);
}

static uint32_t count_resolutions(const slv_texture *texture) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    bool seen[SLV_MAX_LOG2_RES + 1][SLV_MAX_LOG2_RES + 1] = {{false}};
    uint32_t count = 0;
    for (uint32_t f = 0; f < desc->nfaces; f++) {
        bool *cell = &seen[desc->res[f].u][desc->res[f].v];
        count += !*cell;
        *cell = true;
    }
    return count;
}

static slv_result run(struct session *s) {
    const struct compare *o = s->options;
    report_data *report = s->report;
    scene_params params = {.ptx = o->arguments[0],
                           .mesh = o->mesh,
                           .adjacency = o->adjacency,
                           .focus = o->focus,
                           .scheme = (slv_scheme)o->scheme,
                           .boundary = (slv_boundary)o->boundary};
    slv_gl_texture_params upload = {.anisotropy = o->aniso};
    slv_result result;
    for (uint32_t k = 0; k < report->nstrategies; k++)
        upload.strategies |= 1u << report->strategies[k].strategy;
    if ((result = scene_load(&s->env, &params, &s->scene)) ||
        (result = slv_gl_create(&s->env, (slv_gl_backend)o->context, &s->gl)))
        return result;
    report->gl = *slv_gl_get_info(s->gl);
    report->nfaces = slv_mesh_face_count(s->scene.mesh);
    report->nresolutions = count_resolutions(s->scene.texture);
    if (o->aniso > report->gl.max_anisotropy)
        report->anisotropy = report->gl.max_anisotropy;
    slv_frame first = frame_at(s, 0, report->strategies[0].strategy);
    report->segments =
        o->tess ? o->tess
                : slv_tessellation_for(s->scene.mesh, &first.camera, report->width, report->height);
    if ((result = slv_gl_texture_create(s->gl, &s->env, s->scene.texture, s->scene.adjacency,
                                        &upload, &s->texture)) ||
        (result = slv_gl_renderer_create(s->gl, &s->env, s->scene.mesh, s->scene.surface,
                                         report->segments, &s->renderer)) ||
        (result = time_frames(s)) || (result = measure_seams(s)) || (result = draw_views(s)) ||
        (result = compare_pictures(s)) || (result = cast_views(s)))
        return result;
    find_spots(report);
    return draw_spots(s);
}

static void end_session(struct session *s) {
    slv_gl_renderer_destroy(s->renderer);
    slv_gl_texture_destroy(s->texture);
    slv_gl_destroy(s->gl);
    scene_free(&s->scene);
}

static int write_report(const slv_env *env, const char *folder, const report_data *report) {
    char json[1100], html[1100];
    snprintf(json, sizeof json, "%s/report.json", folder);
    snprintf(html, sizeof html, "%s/report.html", folder);
    if (report_write_pictures(env, folder, report) || report_write_json(env, json, report) ||
        report_write_html(env, html, report))
        return EXIT_FAILED;
    return EXIT_OK;
}

static void print_summary(const report_data *report, const char *folder) {
    printf("%-13s %10s %8s %10s %12s %12s\n", "strategy", "frame ms", "ratio", "GPU MB", "max jump",
           "mean jump");
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        const report_strategy *row = &report->strategies[k];
        printf("%-13s %10.2f %8.2f %10.1f %12.5f %12.6f\n", slv_strategy_name(row->strategy),
               row->median_ms, row->ratio, (double)row->stats.gpu_bytes / 1e6,
               (double)row->seams[0].max, (double)row->seams[0].mean);
    }
    printf("(%s; %u frames of %u x %u, %ux MSAA, %ux anisotropy; jumps of magnified lookups, full "
           "scale is 1)\n",
           report->gl.renderer, report->frames, report->width, report->height, report->msaa,
           report->anisotropy);
    compare_print_errors(report);
    printf("report: %s/report.html\n", folder);
}

static int compare(const struct compare *o, report_data *report) {
    struct session session = {.options = o, .env = cli_env(o->threads), .report = report};
    char beside[1024];
    double start = cli_now();
    if (output_folder_begin(o->out, beside, sizeof beside))
        return EXIT_FAILED; /* before minutes are spent */
    cli_catch_interrupts();
    report->ptx = o->arguments[0];
    report->mesh = o->mesh;
    report->frames = o->frames_given ? o->frames : o->quick ? 8 : 60;
    report->width = o->size_given ? o->size[0] : o->quick ? 640 : 960;
    report->height = o->size_given ? o->size[1] : o->quick ? 360 : 540;
    report->msaa = o->msaa;
    report->anisotropy = o->aniso;
    report->nviews = o->quick ? 2 : REPORT_MAX_VIEWS;
    slv_result result = run(&session);
    end_session(&session);
    report->seconds = cli_now() - start;
    int code = result ? EXIT_FAILED : write_report(&session.env, beside, report);
    code = output_folder_end(o->out, beside, code);
    if (!code && !o->quiet)
        print_summary(report, o->out);
    report_free(report);
    return code;
}

int verb_compare(int argc, char **argv) {
    struct compare o = {.out = "selvage-report",
                        .strategies = "clamp,borders,traverse,discard,hybrid",
                        .msaa = 4,
                        .aniso = 16,
                        .elevation = 20,
                        .azimuth = 30,
                        .orbit = 360,
                        .fov = 35};
    const cli_option options[] = {
        {"--mesh|-m", CLI_TEXT, &o.mesh, "control mesh; default: the geometry inside the .ptx",
         "FILE.obj", 0, 0, NULL},
        {"--out|-o|--output", CLI_TEXT, &o.out,
         "folder for report.html, report.json and pictures (selvage-report)", "DIR", 0, 0, NULL},
        {"--strategies|-s", CLI_TEXT, &o.strategies,
         "comma-separated (clamp,borders,traverse,discard,hybrid)", "LIST", 0, 0, NULL},
        {"--frames", CLI_UINT, &o.frames, "frames of the orbit (60, quick 8)", NULL, 1, 100000,
         &o.frames_given},
        {"--size", CLI_SIZE, o.size, "pixels (960x540, quick 640x360)", NULL, 48, 16384,
         &o.size_given},
        {"--msaa", CLI_UINT, &o.msaa,
         "samples per pixel: 1, 2, 4, 8, as far as the driver goes (4)", NULL, 1, 64, NULL},
        {"--aniso", CLI_UINT, &o.aniso, "anisotropy, 1 (trilinear) to 16 (16)", NULL, 1, 16, NULL},
        {"--azimuth", CLI_FLOAT, &o.azimuth, "where the orbit starts, degrees from +z (30)", "DEG",
         0, 0, NULL},
        {"--orbit", CLI_FLOAT, &o.orbit, "how far it goes (360)", "DEG", 0, 0, NULL},
        {"--elevation", CLI_FLOAT, &o.elevation, "degrees above the horizon (20)", "DEG", 0, 0,
         NULL},
        {"--focus", CLI_TEXT, &o.focus,
         "frame this group (g, o) of the OBJ instead of the whole mesh", "GROUP", 0, 0, NULL},
        {"--fov", CLI_FLOAT, &o.fov, "vertical field of view; 0 is orthographic (35)", "DEG", 0, 0,
         NULL},
        {"--shading", CLI_CHOICE, &o.shading, "shading (headlight)", SCENE_SHADINGS, 0, 0, NULL},
        {"--scheme", CLI_CHOICE, &o.scheme, "subdivision scheme (catmark)", SCENE_SCHEMES, 0, 0,
         NULL},
        {"--boundary", CLI_CHOICE, &o.boundary, "boundary rule (the mesh's, or edge-and-corner)",
         SCENE_BOUNDARIES, 0, 0, NULL},
        {"--tess", CLI_UINT, &o.tess,
         "segments per face edge, a power of two (by the size on screen)", NULL, 2, 128, NULL},
        {"--adjacency", CLI_CHOICE, &o.adjacency,
         "neighbours: refuse if file and mesh differ (agree), or take the one's", SCENE_ADJACENCIES,
         0, 0, NULL},
        {"--reference", CLI_CHOICE, &o.reference, "hold the pictures against ray-cast ones (none)",
         "none|raycast", 0, 0, NULL},
        {"--reference-samples", CLI_UINT, &o.samples, "rays per pixel (256)", NULL, 2,
         SLV_REFERENCE_MAX_SAMPLES, NULL},
        {"--reference-filter", CLI_CHOICE, &o.filter, "how they count (box)", "box|mitchell", 0, 0,
         NULL},
        {"--quick", CLI_FLAG, &o.quick, "fewer frames, smaller pictures", NULL, 0, 0, NULL},
        {"--context", CLI_CHOICE, &o.context, "where OpenGL comes from (auto)", SCENE_CONTEXTS, 0,
         0, NULL},
        {"--threads", CLI_UINT, &o.threads, "worker threads (one per processor)", NULL, 1, 256,
         NULL},
        {"--quiet|-q", CLI_FLAG, &o.quiet, "no progress, no table", NULL, 0, 0, NULL},
    };
    const cli_command command = {
        .name = "compare",
        .summary = "measure the seam strategies against each other on one camera orbit",
        .arguments = "FILE.ptx",
        .examples =
            "  selvage compare scene.ptx --mesh scene.obj --out report\n"
            "  selvage compare teapot.ptx --quick --strategies clamp,traverse,discard --msaa 2\n",
        .options = options,
        .noptions = sizeof options / sizeof *options,
        .min_arguments = 1,
        .max_arguments = 1,
        .positional = o.arguments,
        .npositional = &o.narguments};
    char bad[32] = "";
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    report_data *report = calloc(1, sizeof *report);
    if (!report)
        return cli_error("out of memory");
    if (o.fov < 0 || (o.fov > 0 && o.fov < 0.01f) || o.fov > 170)
        code = cli_usage(&command, "--fov: expected 0 (orthographic) or 0.01 to 170");
    else if (o.msaa & (o.msaa - 1))
        code = cli_usage(&command, "--msaa: expected 1, 2, 4 or 8");
    else if (o.tess & (o.tess - 1))
        code = cli_usage(&command, "--tess: expected a power of two from 2 to 128");
    else if (o.reference && o.shading == SLV_SHADE_LEVELS)
        code = cli_usage(&command, "--reference: the shading by levels has none");
    else if (!parse_strategies(o.strategies, report, bad, sizeof bad))
        code = cli_usage(&command,
                         "--strategies: unknown strategy '%s', expected some of " SCENE_STRATEGIES,
                         bad);
    else
        code = compare(&o, report);
    free(report);
    return code;
}
