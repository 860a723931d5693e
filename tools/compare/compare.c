/* The verb compare: its options, and the order of what it does. */
#include "compare/compare.h"
#include "command/output.h"
#include "command/words.h"
#include "compare/engine/experiment.h"
#include "compare/report/report_files.h"
#include "verbs.h"

#include <selvage/folder.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct compare {
    const char *arguments[1];
    uint32_t narguments;
    const char *mesh, *out, *strategies, *focus, *msaa, *references, *uv;
    cli_list views;
    int scheme, boundary, shading, context, adjacency, encoding, alpha, straight, round,
        plain_levels, layout;
    bool quick, quiet, json, progress, resume, compress, even_given, size_given, frames_given,
        reference_frames_given, samples_given, scheme_given;
    uint32_t size[2], aniso, frames, tess, threads, samples, accumulate, reference_frames;
    float azimuth, elevation, fov, orbit, tilt, dolly;
};

struct session {
    const struct compare *options;
    slv_env env;
    scene_data scene;
    slv_gl *gl;
    slv_gl_texture *texture, *blocks;
    slv_gl_renderer *renderer;
    report_data *report;
    experiment experiment;
    char title[64];
    cli_progress shown;
    bool shows, measuring; /* frames of the orbit */
};

/* The next of some comma-separated words; NULL after the last. */
static const char *next_word(const char *list, char *word, size_t size) {
    size_t length = strcspn(list, ",");
    if (!*list)
        return NULL;
    snprintf(word, size, "%.*s", (int)(length < size ? length : size - 1), list);
    return list + length + (list[length] == ',');
}

/* Names into the report's list; false leaves the first that is unknown in `word`. If `list` is NULL
 * all that there are, but for those that are only of use in comparisons. */
static bool parse_strategies(const char *list, report_data *report, char *word, size_t size) {
    for (uint32_t s = 0; !list && s < slv_strategy_count(); s++)
        if (!slv_strategy_at(s)->comparison && report->nstrategies < REPORT_MAX_STRATEGIES)
            report->strategies[report->nstrategies++].strategy = slv_strategy_at(s);
    while (list && (list = next_word(list, word, size))) {
        const slv_strategy *strategy = slv_strategy_find(word);
        if (!strategy)
            return false;
        if (report_find(report, word) == report->nstrategies &&
            report->nstrategies < REPORT_MAX_STRATEGIES)
            report->strategies[report->nstrategies++].strategy = strategy;
    }
    return report->nstrategies > 0;
}

static bool parse_references(const char *list, report_data *report) {
    char word[32];
    report->reference.first = REPORT_SOURCES;
    if (strcmp(list, "none") == 0)
        return true;
    if (!*list)
        return false;
    while ((list = next_word(list, word, sizeof word))) {
        int s = 0;
        while (s < REPORT_SOURCES && strcmp(word, report_source_name((report_source)s)) != 0)
            s++;
        if (s == REPORT_SOURCES)
            return false;
        report->reference.used[s] = true;
        if ((report_source)s < report->reference.first)
            report->reference.first = (report_source)s;
    }
    return true;
}

static bool report_stage(void *user, uint64_t done, uint64_t total) {
    struct session *s = user;
    bool goes_on = s->measuring && total < report_frame_count(s->report);
    if (!s->shows) {
        if (goes_on)
            snprintf(s->title, sizeof s->title, "measuring the other %u frames", (uint32_t)total);
        s->shown = cli_progress_begin(s->title, total, s->options->progress,
                                      s->options->quiet || s->options->json);
        s->shows = true;
    } else if (done) {
        cli_progress_update(&s->shown, done);
    }
    if (done == total)
        cli_progress_end(&s->shown);
    return !cli_interrupted();
}

/* What is going on from here, as the terminal shows it. */
static void begin_stage(struct session *s, const char *title) {
    snprintf(s->title, sizeof s->title, "%s", title);
    s->shows = false;
    s->experiment.progress = (slv_progress){report_stage, s};
}

/* One error line for an interruption, wherever it is noticed. */
static void tell_of_interruption(const struct session *s) {
    if (s->measuring)
        cli_error("interrupted after %u of %u frames; --resume goes on from there",
                  s->experiment.finished, report_frame_count(s->report));
    else
        cli_error("interrupted; --resume goes on from there");
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

/* FNV-1a of a file, so that a run is not resumed with another one. */
static json_t *fingerprint(const char *path) {
    unsigned char block[65536];
    uint64_t hash = 0xcbf29ce484222325u;
    char text[32] = "";
    struct stat status;
    /* what came through a pipe cannot be read again */
    bool regular = path && stat(path, &status) == 0 && S_ISREG(status.st_mode);
    FILE *stream = regular ? fopen(path, "rb") : NULL;
    for (size_t n; stream && (n = fread(block, 1, sizeof block, stream)) > 0;)
        for (size_t i = 0; i < n; i++)
            hash = (hash ^ block[i]) * 0x100000001b3u;
    if (stream) {
        fclose(stream);
        snprintf(text, sizeof text, "%016llx", (unsigned long long)hash);
    }
    return json_string(text);
}

/* All that the numbers of a frame depend on. */
static json_t *conditions(const struct session *s) {
    const struct compare *o = s->options;
    const report_data *r = s->report;
    json_t *views = json_array();
    for (uint32_t c = 0; c < r->ncameras; c++)
        json_array_append_new(views, fingerprint(r->cameras[c].path));
    json_t *strategies = json_array(), *rates = json_array(), *references = json_array();
    for (uint32_t k = 0; k < r->nstrategies; k++)
        json_array_append_new(strategies, json_string(r->strategies[k].strategy->name));
    for (uint32_t i = 0; i < r->nrates; i++)
        json_array_append_new(rates, json_pack("[I, I]", (json_int_t)r->rates[i].msaa,
                                               (json_int_t)r->rates[i].frames));
    for (int k = 0; k < REPORT_SOURCES; k++)
        if (r->reference.used[k])
            json_array_append_new(references, json_string(report_source_name((report_source)k)));
    return json_pack(
        "{s:i, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:[I,I], s:I, s:b, s:I, s:I, s:I, s:I, "
        "s:[f,f,f,f,f,f],"
        " s:o, s:[i,i,i], s:o, s:[i,b], s:s, s:s}",
        "schema", 2, "version", (json_int_t)slv_version(), "driver",
        output_json_text(r->gl.renderer, strlen(r->gl.renderer)), "texture", fingerprint(r->ptx),
        "mesh", fingerprint(r->mesh), "strategies", strategies, "msaa", rates, "reference",
        references, "size", (json_int_t)r->width, (json_int_t)r->height, "aniso",
        (json_int_t)r->anisotropy, "even-levels", (int)r->even_levels, "frames",
        (json_int_t)r->frames, "reference-frames", (json_int_t)r->reference.frames,
        "reference-samples", (json_int_t)r->reference.samples, "tess", (json_int_t)r->segments,
        "orbit", (double)r->path.azimuth, (double)r->path.turn, (double)r->path.elevation,
        (double)r->path.tilt, (double)r->path.fov, (double)r->path.dolly, "focus",
        o->focus ? output_json_text(o->focus, strlen(o->focus)) : json_null(), "surface",
        o->scheme_given ? o->scheme : -1, o->boundary, o->shading, "views", views, "alpha",
        o->alpha, !o->straight, "texture-encoding",
        slv_texture_encoding_name((slv_texture_encoding)o->encoding), "layout",
        slv_gl_layout_name((slv_gl_layout)o->layout));
}

/* Before anything is measured, since textures other than 8-bit are refused. */
static slv_result upload_blocks(struct session *s, slv_gl_texture_params upload) {
    s->report->compressed = s->options->compress;
    upload.compression = SLV_GL_COMPRESSION_BLOCKS;
    return s->options->compress ? slv_gl_texture_create(s->gl, &s->env, s->scene.texture,
                                                        s->scene.adjacency, &upload, &s->blocks)
                                : SLV_OK;
}

static slv_result prepare(struct session *s) {
    const struct compare *o = s->options;
    report_data *report = s->report;
    scene_params params = {.ptx = o->arguments[0],
                           .mesh = o->mesh,
                           .adjacency = o->adjacency,
                           .focus = o->focus,
                           .scheme = (slv_scheme)o->scheme,
                           .scheme_given = o->scheme_given,
                           .encoding = (slv_texture_encoding)o->encoding,
                           .boundary = (slv_boundary)o->boundary,
                           .alpha = (slv_alpha_mode)o->alpha,
                           .premultiplied = !o->straight};
    const slv_strategy *strategies[REPORT_MAX_STRATEGIES + 1];
    slv_gl_texture_params upload = {.strategies = strategies,
                                    .anisotropy = o->aniso,
                                    .layout = (slv_gl_layout)o->layout,
                                    .encoding = (slv_texture_encoding)o->encoding};
    slv_result result;
    for (uint32_t k = 0; k < report->nstrategies; k++)
        strategies[upload.nstrategies++] = report->strategies[k].strategy;
    if (report->reference.used[REPORT_SUPERSAMPLED])
        strategies[upload.nstrategies++] = report_supersampled_with();
    if ((result = scene_load(&s->env, &params, &s->scene)) ||
        (result = slv_gl_create(&s->env, (slv_gl_backend)o->context, &s->gl)) ||
        (result = experiment_find_rates(&s->env, s->gl, o->accumulate, report)) ||
        (result = compare_read_views(&s->env, &o->views, report)))
        return result;
    upload.border_u = s->scene.border_u;
    upload.border_v = s->scene.border_v;
    if (o->alpha && !s->scene.alpha)
        scene_warn_of_alpha(o->arguments[0], (slv_alpha_mode)o->alpha);
    upload.edge_filter = s->scene.edge_filter;
    report->gl = *slv_gl_get_info(s->gl);
    report->nfaces = slv_mesh_face_count(s->scene.mesh);
    report->nresolutions = count_resolutions(s->scene.texture);
    if (slv_texture_get_encoding(s->scene.texture, upload.encoding) == SLV_TEXTURE_DATA)
        report->pictures = SLV_ENCODE_RAW;
    if (o->uv && (result = compare_load_image(&s->env, o->uv, upload.encoding,
                                              (slv_wrap_round)o->round, &s->scene, report)))
        return result;
    if (o->aniso > report->gl.max_anisotropy)
        report->anisotropy = report->gl.max_anisotropy;
    report->even_levels = o->even_given ? !o->plain_levels : s->scene.even;
    upload.even_levels = report->even_levels;
    orbit *path = &report->path;
    *path = (orbit){.azimuth = o->azimuth,
                    .turn = o->orbit,
                    .elevation = o->elevation,
                    .tilt = o->tilt,
                    .fov = o->fov,
                    .dolly = o->dolly,
                    .aspect = (float)report->width / (float)report->height};
    memcpy(path->bounds_min, s->scene.bounds_min, sizeof path->bounds_min);
    memcpy(path->bounds_max, s->scene.bounds_max, sizeof path->bounds_max);
    slv_camera first = orbit_camera(path, 0);
    report->segments = o->tess;
    const slv_tessellation_params surface = experiment_tessellation(report, &s->scene, &first);
    if ((result = slv_gl_texture_create(s->gl, &s->env, s->scene.texture, s->scene.adjacency,
                                        &upload, &s->texture)) ||
        (result = upload_blocks(s, upload)) ||
        (result = slv_gl_renderer_create_with(s->gl, &s->env, s->scene.mesh, s->scene.surface,
                                              &surface, &s->renderer)))
        return result;
    s->experiment = (experiment){.env = &s->env,
                                 .scene = &s->scene,
                                 .gl = s->gl,
                                 .texture = s->texture,
                                 .renderer = s->renderer,
                                 .shading = (slv_shading)o->shading,
                                 .encoding = upload.encoding,
                                 .report = report};
    return SLV_OK;
}

/* A link to where none is yet becomes one, too. */
static slv_result make_folder(const slv_env *env, const char *path) {
    slv_folder *folder;
    slv_result result = slv_folder_begin(env, path, &folder);
    return result ? result : slv_folder_end(folder, NULL, SLV_OK);
}

/* Nothing to resume from is nothing to keep. */
static void remove_empty(const char *path, const char *folder) {
    struct stat status;
    if (stat(path, &status) == 0 && status.st_size == 0)
        remove(path);
    if (folder)
        remove(folder); /* which fails if anything is in it */
}

static slv_result measure_frames(struct session *s) {
    char path[1100], older[1100];
    slv_result result;
    struct stat status;
    bool there = stat(s->options->out, &status) == 0;
    json_t *given = conditions(s);
    snprintf(path, sizeof path, "%s/frames.jsonl", s->options->out);
    snprintf(older, sizeof older, "%s/frames.old.jsonl", s->options->out);
    if (!s->options->resume)
        rename(path, older); /* there may be hours in it, and --resume forgotten */
    begin_stage(s, "measuring frames");
    s->measuring = true;
    if (!given)
        result = output_fail(&s->env, SLV_ERROR_MEMORY, "%s: no memory for it", path);
    else if (!(result = make_folder(&s->env, s->options->out)) &&
             (result = experiment_run(&s->experiment, path, given, s->options->resume)))
        remove_empty(path, there ? NULL : s->options->out);
    json_decref(given);
    return result;
}

/* Figures of the background alone are none. */
static void warn_of_nothing(const report_data *report) {
    if (report->reference.frames && !report_covered(report->reference.npixels))
        scene_warn_of_nothing(report->ptx);
    for (uint32_t c = 0; c < report->ncameras; c++)
        if (report->cameras[c].empty)
            scene_warn_of_nothing(report->cameras[c].path);
}

static slv_result run(struct session *s) {
    slv_result result = prepare(s);
    /* until here there is nothing that an interrupt could lose */
    cli_catch_interrupts();
    if (result || (result = measure_frames(s)))
        goto done;
    s->measuring = false;
    warn_of_nothing(s->experiment.report);
    begin_stage(s, "measuring seams");
    if ((result = experiment_measure_seams(&s->experiment)))
        goto done;
    begin_stage(s, "drawing views");
    if ((result = experiment_draw_pictures(&s->experiment)))
        goto done;
    begin_stage(s, "drawing from blocks");
    if (s->blocks && (result = experiment_draw_compressed(&s->experiment, s->blocks)))
        goto done;
    begin_stage(s, "drawing maps");
    if (s->scene.uv && !(result = experiment_compare_maps(&s->experiment, &s->scene.images,
                                                          (slv_wrap_round)s->options->round)))
        compare_warn_of_other_content(s->experiment.report);
done:
    if (result == SLV_ERROR_CANCELLED)
        tell_of_interruption(s);
    return result;
}

static void end_session(struct session *s) {
    slv_reference_destroy(s->experiment.reference);
    slv_gl_renderer_destroy(s->renderer);
    slv_gl_texture_destroy(s->texture);
    slv_gl_texture_destroy(s->blocks);
    slv_gl_destroy(s->gl);
    scene_free(&s->scene);
}

static slv_result write_report(const slv_env *env, const char *folder, const report_data *report) {
    char json[1300], html[1300];
    slv_result result;
    snprintf(json, sizeof json, "%s/report.json", folder);
    snprintf(html, sizeof html, "%s/report.html", folder);
    if ((result = report_write_pictures(env, folder, report)) ||
        (result = report_write_tables(env, folder, report)) ||
        (result = report_write_json(env, json, report)))
        return result;
    return report_write_html(env, html, report);
}

static void choose(const struct compare *o, report_data *report) {
    report->ptx = o->arguments[0];
    report->mesh = o->mesh;
    report->frames = o->frames_given ? o->frames : o->quick ? 9 : 60;
    report->width = o->size_given ? o->size[0] : o->quick ? 480 : 960;
    report->height = o->size_given ? o->size[1] : o->quick ? 270 : 540;
    report->anisotropy = o->aniso;
    report->nviews = o->quick ? 2 : REPORT_MAX_VIEWS;
    report_reference *r = &report->reference;
    if (r->first == REPORT_SOURCES)
        return;
    r->samples = o->samples_given ? o->samples : o->quick ? 64 : 256;
    r->frames = o->reference_frames_given ? o->reference_frames : o->quick ? 2 : 12;
    r->frames = r->frames < report->frames ? r->frames : report->frames;
}

/* What report.json says, and where the report is. */
static int print_json(const struct compare *o, const report_data *report) {
    char path[1300];
    snprintf(path, sizeof path, "%s/report.html", o->out);
    json_t *root = report_json(report);
    if (root && json_object_set_new(root, "report", output_json_name(path)) != 0) {
        json_decref(root);
        root = NULL;
    }
    return output_print_json(o->out, root);
}

/* Inputs may lie in the report's folder, but not where it puts a file. */
static slv_result check_outputs(const slv_env *env, const struct compare *o) {
    static const char *const names[] = {"report.html", "report.json", "frames.jsonl",
                                        "frames.old.jsonl"};
    const char *inputs[3 + CLI_LIST_ROOM] = {o->arguments[0], o->mesh, o->uv};
    slv_result result = output_try_folder(env, o->out);
    for (uint32_t v = 0; v < o->views.count; v++)
        inputs[3 + v] = o->views.items[v];
    for (size_t i = 0; i < sizeof names / sizeof *names && !result; i++) {
        char path[1300];
        snprintf(path, sizeof path, "%s/%s", o->out, names[i]);
        result = output_check_inputs(env, path, inputs, 3 + o->views.count);
    }
    return result;
}

static int compare(const struct compare *o, report_data *report) {
    struct session session = {.options = o, .env = cli_env(o->threads), .report = report};
    slv_folder *folder;
    double start = cli_now();
    /* whether it can be written is known before minutes are spent */
    if (check_outputs(&session.env, o))
        return EXIT_FAILED;
    choose(o, report);
    slv_result result = run(&session);
    report->seconds = cli_now() - start;
    if (!result && !(result = slv_folder_begin(&session.env, o->out, &folder)))
        result = slv_folder_end(folder, "report.html",
                                write_report(&session.env, slv_folder_path(folder), report));
    int code = result ? EXIT_FAILED : EXIT_OK;
    if (!code && !o->quiet && report_disturbed(report))
        cli_warning("other programs took %.1f of the processors while frames were drawn: the times "
                    "are not to be trusted",
                    report->others);
    end_session(&session);
    if (!code && o->json)
        code = print_json(o, report);
    else if (!code && !o->quiet)
        compare_print(report, o->out);
    report_free(report);
    return code;
}

static const char *problem(const struct compare *o, report_data *report) {
    if (o->fov < 0 || (o->fov > 0 && o->fov < 0.01f) || o->fov > 170)
        return "--fov: expected 0 (orthographic) or 0.01 to 170";
    if (!(o->dolly >= 1 && o->dolly <= 100))
        return "--dolly: expected 1 to 100";
    if (!experiment_parse_rates(o->msaa ? o->msaa : o->quick ? "1,4" : "1,2,4,8", report))
        return "--msaa: expected some of 1, 2, 4, 8 with commas between";
    if (o->round && !o->uv)
        return "--round is of texture coordinates: it takes --uv";
    if (o->uv && !o->mesh)
        return "--uv: texture coordinates are the mesh's: it takes --mesh";
    if (o->accumulate & (o->accumulate - 1))
        return "--accumulate: expected a power of two";
    if (o->tess & (o->tess - 1))
        return "--tess: expected a power of two from 2 to 128";
    if (!parse_references(o->references                    ? o->references
                          : o->shading == SLV_SHADE_LEVELS ? "none"
                                                           : "raycast",
                          report))
        return "--reference: expected none, or some of raycast,mitchell,supersampled";
    if (o->shading == SLV_SHADE_IMAGE)
        return "--shading: render and reference draw in the light of an image, compare does not";
    if (report->reference.first < REPORT_SOURCES && o->shading == SLV_SHADE_LEVELS)
        return "--reference: the shading by levels has none";
    return NULL;
}

static int unknown_strategy(const cli_command *command, const char *word) {
    char names[SCENE_STRATEGIES_SIZE], hint[SLV_WORDS_HINT];
    scene_strategies(names, sizeof names);
    return cli_usage(command, "--strategies: unknown strategy '%s', expected some of %s%s", word,
                     names, slv_words_hint(word, names, hint));
}

/* What is left out if nothing is said. */
static const char *default_strategies(char *text, size_t size) {
    size_t length = (size_t)snprintf(text, size, "comma-separated (all");
    const char *before = " but ";
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        if (!slv_strategy_at(s)->comparison || length >= size)
            continue;
        length += (size_t)snprintf(text + length, size - length, "%s%s", before,
                                   slv_strategy_at(s)->name);
        before = ", ";
    }
    if (length < size)
        snprintf(text + length, size - length, ")");
    return text;
}

/* More than 80 lines because its table has a row for each option, and reads best in one piece. */
int verb_compare(int argc, char **argv) {
    const char *out = NULL;
    struct compare o = {.aniso = 16,
                        .accumulate = 1,
                        .elevation = 20,
                        .azimuth = 30,
                        .orbit = 360,
                        .tilt = 15,
                        .dolly = 2.5f,
                        .fov = 35,
                        .straight = 1};
    char left_out[SCENE_STRATEGIES_SIZE];
    const cli_option options[] = {
        CLI_MESH(&o.mesh),
        CLI_OUT(&out,
                "folder for report.html, report.json, tables and pictures "
                "(selvage-report)",
                "DIR"),
        {"--strategies|-s", CLI_TEXT, &o.strategies, default_strategies(left_out, sizeof left_out),
         "LIST", 0, 0, NULL},
        {"--frames", CLI_UINT, &o.frames, "frames of the orbit (60, quick 9)", NULL, 1, 100000,
         &o.frames_given},
        SCENE_VIEW(CLI_TEXTS, &o.views,
                   "also measure the camera of this view file, beside the orbit; may be given "
                   "again"),
        {"--uv", CLI_TEXT, &o.uv,
         "also compare with this image, or set of tiles (name.<UDIM>.exr), through the mesh's "
         "texture coordinates",
         "IMAGE", 0, 0, NULL},
        SCENE_ROUND(&o.round),
        {"--resume", CLI_FLAG, &o.resume, "go on with a run that was stopped", NULL, 0, 0, NULL},
        {"--size", CLI_SIZE, o.size, "pixels (960x540, quick 480x270)", NULL, 48, 16384,
         &o.size_given},
        {"--msaa", CLI_TEXT, &o.msaa,
         "samples per pixel, those that the driver has (1,2,4,8, quick 1,4)", "LIST", 0, 0, NULL},
        {"--accumulate", CLI_UINT, &o.accumulate,
         "make rates the driver lacks by averaging at most this many shifted pictures (1)", NULL, 1,
         64, NULL},
        SCENE_ANISO(&o.aniso, "anisotropy, 1 (trilinear) to 16 (16)"),
        SCENE_LAYOUT(&o.layout),
        SCENE_EVEN_LEVELS(&o.plain_levels, &o.even_given),
        {"--compress", CLI_FLAG, &o.compress,
         "8-bit textures: also drawn from blocks on the GPU (BC1 and its kin)", NULL, 0, 0, NULL},
        SCENE_AZIMUTH(&o.azimuth, "where the orbit starts, degrees from +z (30)", NULL),
        {"--orbit", CLI_FLOAT, &o.orbit, "how far it goes (360)", "DEG", 0, 0, NULL},
        SCENE_ELEVATION(&o.elevation, NULL),
        {"--tilt", CLI_FLOAT, &o.tilt, "how far the elevation swings (15)", "DEG", 0, 0, NULL},
        {"--dolly", CLI_FLOAT, &o.dolly,
         "how many times nearer and further the camera goes than where it frames the mesh (2.5)",
         "X", 0, 0, NULL},
        SCENE_FOCUS(&o.focus, NULL),
        SCENE_FOV(&o.fov, NULL),
        SCENE_SHADING(&o.shading, "shading (headlight)", NULL),
        SCENE_SCHEME(&o.scheme, &o.scheme_given),
        SCENE_BOUNDARY(&o.boundary, "boundary rule (the mesh's, or edge-and-corner)", NULL),
        SCENE_TESS(&o.tess, "each face as many as the picture needs"),
        SCENE_ALPHA(&o.alpha, &o.straight, "ignore", NULL, NULL),
        SCENE_ADJACENCY(&o.adjacency),
        CLI_TEXTURE_ENCODING(&o.encoding),
        {"--reference", CLI_TEXT, &o.references,
         "what pictures are held against (raycast): none, or some of "
         "raycast,mitchell,supersampled",
         "LIST", 0, 0, NULL},
        {"--reference-frames", CLI_UINT, &o.reference_frames,
         "for how many frames of the orbit (12, quick 2)", NULL, 1, 100000,
         &o.reference_frames_given},
        {"--reference-samples", CLI_UINT, &o.samples, "rays per pixel (256, quick 64)", NULL, 2,
         SLV_REFERENCE_MAX_SAMPLES, &o.samples_given},
        {"--quick", CLI_FLAG, &o.quick, "fewer frames, smaller pictures", NULL, 0, 0, NULL},
        SCENE_CONTEXT(&o.context),
        CLI_PROGRESS(&o.progress),
        CLI_THREADS(&o.threads),
        CLI_JSON(&o.json),
        CLI_QUIET(&o.quiet, "no progress, no table"),
    };
    const cli_command command = {
        .name = "compare",
        .summary = "measure the seam strategies against each other on one camera orbit",
        .arguments = "FILE.ptx [DIR]",
        .reads = "a texture; a mesh, view files and images if they are named",
        .writes = "a folder: report.html, report.json, frames.jsonl, tables and pictures",
        .examples =
            "  selvage compare scene.ptx --mesh scene.obj --out report\n"
            "  selvage compare teapot.ptx --quick --strategies clamp,traverse --msaa 2\n"
            "  selvage compare vase.ptx --mesh vase.obj --uv vase.png --round u\n"
            "  selvage compare scene.ptx --frames 1000 --reference raycast,supersampled \\\n"
            "    --reference-frames 1000 --accumulate 8 --resume\n",
        CLI_TAKES(options, 1, 1, o.arguments, &o.narguments),
        .output = &out};
    char word[32] = "";
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    o.out = out ? out : "selvage-report";
    report_data *report = calloc(1, sizeof *report);
    if (!report)
        return cli_error("out of memory");
    const char *wrong = problem(&o, report);
    if (wrong)
        code = cli_usage(&command, "%s", wrong);
    else if (!parse_strategies(o.strategies, report, word, sizeof word))
        code = unknown_strategy(&command, word);
    else
        code = compare(&o, report);
    free(report);
    return code;
}
