/* The verb session: a painting session that is made, painted on, undone, saved and exported. */
#include "command/line_log.h"
#include "command/output.h"
#include "command/ptx_name.h"
#include "command/scene.h"
#include "command/seams.h"
#include "verbs.h"

#include <selvage/session.h>

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct session {
    const char *path, *new_from, *replay, *script, *merge, *export, *edits, *between;
    bool certify, save, as_saved, json, progress, quiet;
    uint32_t layer, undo, redo, scale, threads, edited, merged;
    int scheme;
    slv_session *session;
    line_log log;
    uint32_t pair[2]; /* of --between */
    json_t *seams;    /* with --certify and --json: what is said of them */
};

/* A session for the mesh in a .ptx, whose texels are its lowest layer. */
static slv_result make(const slv_env *env, struct session *s) {
    slv_ptx *ptx = NULL;
    slv_mesh *mesh = NULL;
    slv_texture *texture = NULL;
    const slv_session_params params = {.scheme = (slv_scheme)s->scheme, .made_of = s->new_from};
    slv_result result;
    if (!(result = slv_ptx_open(env, s->new_from, &ptx)) &&
        !(result = scene_load_geometry(env, ptx, "a .ptx with the mesh inside", &mesh)) &&
        !(result = slv_ptx_load_texture(env, ptx, &texture)))
        result = slv_session_create_from(env, s->path, mesh, texture, &params, &s->session);
    slv_texture_destroy(texture);
    slv_mesh_destroy(mesh);
    slv_ptx_close(ptx);
    return result;
}

/* Says a certificate, or puts it down. */
static slv_result tell_seams(const slv_env *env, struct session *s, const char *of,
                             const slv_seam_certificate *seams) {
    if (!s->json && !s->quiet)
        seams_print(of, seams);
    if (s->json && json_array_append_new(s->seams, json_pack("{s:s, s:o}", "of", of, "seams",
                                                             seams_json(seams))) != 0)
        return output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for what is to be printed",
                           s->path);
    return SLV_OK;
}

/* Of all layers together. */
static slv_result certify_result(const slv_env *env, struct session *s, const char *when) {
    slv_document *document = slv_session_document(s->session);
    slv_seam_certificate seams;
    slv_result result = slv_document_flatten(document);
    if (result)
        return result;
    const slv_canvas canvas = slv_texture_as_canvas(slv_document_texture(document));
    if ((result = slv_seam_certify(env, &canvas, slv_session_adjacency(s->session), &seams)))
        return result;
    return tell_seams(env, s, when, &seams);
}

/* Of each layer by itself, and of the two that are asked for. */
static slv_result certify_layers(const slv_env *env, struct session *s) {
    const slv_adjacency *adjacency = slv_session_adjacency(s->session);
    slv_document *document = slv_session_document(s->session);
    slv_canvas canvas, other;
    slv_seam_certificate seams;
    char when[64];
    slv_result result = SLV_OK;
    for (uint32_t i = 0; i < slv_document_layer_count(document) && !result; i++) {
        uint32_t id = slv_document_layer_at(document, i);
        snprintf(when, sizeof when, "of layer %u", (unsigned)id);
        if (!(result = slv_document_canvas(document, id, false, &canvas)) &&
            !(result = slv_seam_certify(env, &canvas, adjacency, &seams)))
            result = tell_seams(env, s, when, &seams);
    }
    if (result || !s->between)
        return result;
    snprintf(when, sizeof when, "between layers %u and %u", (unsigned)s->pair[0],
             (unsigned)s->pair[1]);
    if (!(result = slv_document_canvas(document, s->pair[0], false, &canvas)) &&
        !(result = slv_document_canvas(document, s->pair[1], false, &other)) &&
        !(result = slv_seam_certify_two(env, &canvas, &other, adjacency, &seams)))
        result = tell_seams(env, s, when, &seams);
    return result;
}

/* Each line of the script is an entry of the history; it ends with the first that is wrong. */
static slv_result certify_line(const slv_env *env, struct session *s, uint64_t *lines) {
    slv_session_info info;
    char when[48];
    slv_session_get_info(s->session, &info);
    if (info.lines == *lines)
        return SLV_OK; /* it has changed nothing */
    *lines = info.lines;
    snprintf(when, sizeof when, "after line %llu", (unsigned long long)s->log.line);
    return certify_result(env, s, when);
}

static slv_result run_script(const slv_env *env, struct session *s) {
    slv_document *document = slv_session_document(s->session);
    uint32_t count = slv_document_layer_count(document);
    uint32_t layer = s->layer ? s->layer : count ? slv_document_layer_at(document, count - 1) : 0;
    char *text = NULL, folder[4096];
    size_t size = 0;
    slv_session_info info;
    slv_result result = slv_text_load(env, cli_input(s->script), &text, &size);
    if (result)
        return result;
    slv_session_get_info(s->session, &info);
    snprintf(folder, sizeof folder, "%s", s->script);
    char *slash = strrchr(folder, '/');
    if (slash)
        *slash = 0;
    cli_progress progress = cli_progress_fleeting("paint", s->progress, s->quiet || s->json);
    for (size_t at = 0; at < size && !result;) {
        const char *end = memchr(text + at, '\n', size - at);
        size_t length = end ? (size_t)(end - (text + at)) : size - at;
        s->log.line++;
        int silenced = output_silence();
        result =
            slv_session_run(s->session, layer, false, slash ? folder : NULL, text + at, length);
        output_restore(silenced);
        if (!result && s->certify)
            result = certify_line(env, s, &info.lines);
        at += length + 1;
        if (!result && !cli_progress_report(&progress, at < size ? at : size, size))
            result = output_fail(env, SLV_ERROR_CANCELLED, "stopped");
    }
    s->log.line = 0;
    cli_progress_end(&progress);
    slv_free(text);
    return result;
}

static json_t *layer_json(const slv_layer_info *layer) {
    return json_pack("{s:I, s:o, s:f, s:s, s:b, s:b, s:b, s:s, s:I}", "id", (json_int_t)layer->id,
                     "name", output_json_text(layer->props.name, strlen(layer->props.name)),
                     "opacity", (double)layer->props.opacity, "blend",
                     slv_blend_name(layer->props.blend), "hidden", layer->props.hidden, "locked",
                     layer->props.locked, "mask", layer->has_mask, "type",
                     slv_type_name(layer->type), "bytes", (json_int_t)layer->bytes);
}

static json_t *session_json(const struct session *s, const slv_session_info *info,
                            const slv_history_info *history) {
    slv_document *document = slv_session_document(s->session);
    json_t *layers = json_array();
    slv_layer_info layer;
    for (uint32_t i = 0; slv_document_layer(document, slv_document_layer_at(document, i), &layer);
         i++)
        if (json_array_append_new(layers, layer_json(&layer))) {
            json_decref(layers);
            return NULL;
        }
    return json_pack("{s:i, s:o, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:O, s:o}", "schema",
                     1, "path", output_json_name(s->path), "faces",
                     (json_int_t)slv_document_get_desc(document)->nfaces, "lines",
                     (json_int_t)info->lines, "unsaved", (json_int_t)info->unsaved, "recovered",
                     (json_int_t)info->recovered, "torn_bytes", (json_int_t)info->torn_bytes,
                     "undos", (json_int_t)history->undos, "redos", (json_int_t)history->redos,
                     "exported_faces", (json_int_t)s->edited, "merged_faces", (json_int_t)s->merged,
                     "seams", s->seams, "layers", layers);
}

static void print_session(const struct session *s, const slv_session_info *info,
                          const slv_history_info *history) {
    slv_document *document = slv_session_document(s->session);
    slv_layer_info layer;
    output_terminal(stdout, s->path, strlen(s->path), SIZE_MAX);
    printf(": %u faces, %u layers, %" PRIu64 " lines, %" PRIu64 " since it was saved; %u to undo, "
           "%u to redo\n",
           slv_document_get_desc(document)->nfaces, slv_document_layer_count(document), info->lines,
           info->unsaved, history->undos, history->redos);
    if (info->recovered || info->torn_bytes)
        printf("  brought back from the journal: %" PRIu64 "; torn off its end: %" PRIu64
               " bytes\n",
               info->recovered, info->torn_bytes);
    for (uint32_t i = slv_document_layer_count(document); i--;)
        if (slv_document_layer(document, slv_document_layer_at(document, i), &layer)) {
            printf("  layer %u ", layer.id);
            output_terminal(stdout, layer.props.name, strlen(layer.props.name), 64);
            printf("%s%s, opacity %g%s%s%s, %" PRIu64 " bytes\n", *layer.props.name ? ": " : "",
                   slv_blend_name(layer.props.blend), (double)layer.props.opacity,
                   layer.props.hidden ? ", hidden" : "", layer.props.locked ? ", locked" : "",
                   layer.has_mask ? ", masked" : "", layer.bytes);
        }
    if (s->merge)
        printf("  %u faces merged\n", s->merged);
    if (s->edits)
        printf("  %u faces appended\n", s->edited);
}

/* Takes what another session has on faces that this one has not. */
static slv_result merge(const slv_env *env, struct session *s) {
    const slv_session_params look = {.unkept = true};
    slv_session *other = NULL;
    int silenced = output_silence();
    slv_result result = slv_session_open(env, s->merge, &look, &other);
    output_restore(silenced);
    if (!result)
        result = slv_session_merge(s->session, other, &s->merged);
    slv_session_destroy(other);
    return result;
}

static int log2_of(uint32_t scale) {
    int log2 = 0;
    while (scale >> log2 > 1)
        log2++;
    return log2;
}

/* Undo and redo: all that was asked for, or nothing. */
static slv_result go_back(const slv_env *env, struct session *s) {
    slv_document *document = slv_session_document(s->session);
    slv_history_info history;
    slv_result result = SLV_OK;
    slv_document_history(document, &history);
    if (s->undo > history.undos)
        return output_fail(env, SLV_ERROR_ARGUMENT, "%s: %u to undo, of %u that there are", s->path,
                           s->undo, history.undos);
    if (s->redo > history.redos + s->undo)
        return output_fail(env, SLV_ERROR_ARGUMENT, "%s: %u to redo, of %u that there are", s->path,
                           s->redo, history.redos + s->undo);
    for (uint32_t i = 0; !result && i < s->undo; i++)
        result = slv_document_undo(document);
    for (uint32_t i = 0; !result && i < s->redo; i++)
        result = slv_document_redo(document);
    return result;
}

/* Of a session that is not ours to write to, what is there can be looked at. */
static bool is_only_read(const struct session *s) {
    char journal[4096];
    int length = snprintf(journal, sizeof journal, "%s/journal", s->path);
    bool reads = !s->script && !s->undo && !s->redo && !s->merge && !s->save && !s->as_saved;
    return reads && length > 0 && (size_t)length < sizeof journal && slv_session_is(s->path) &&
           (access(s->path, W_OK) != 0 ||
            (access(journal, F_OK) == 0 && access(journal, W_OK) != 0));
}

static slv_result work(const slv_env *env, struct session *s) {
    const slv_session_params how = {.as_saved = s->as_saved, .unkept = is_only_read(s)};
    const bool makes = s->new_from || s->replay;
    if (makes)
        cli_catch_interrupts();
    int silenced = output_silence();
    slv_result result =
        s->new_from ? make(env, s)
        : s->replay ? slv_session_replay(env, s->replay, s->path, log2_of(s->scale), &s->session)
                    : slv_session_open(env, s->path, &how, &s->session);
    output_restore(silenced);
    if (!makes) /* what is only read is lost by nobody */
        cli_catch_interrupts();
    const char *const inputs[] = {result ? NULL : slv_session_made_of(s->session)};
    if (!result && s->export)
        result = output_check_inputs(env, s->export, inputs, 1);
    if (!result && s->certify)
        result = certify_result(env, s, "before");
    if (!result)
        result = go_back(env, s);
    if (!result && s->script)
        result = run_script(env, s);
    if (!result && s->merge)
        result = merge(env, s);
    if (!result && s->certify && !(result = certify_result(env, s, "after")))
        result = certify_layers(env, s);
    if (!result && s->save)
        result = slv_session_save(s->session);
    if (!result && s->export)
        result = slv_session_export(s->session, s->export);
    if (!result && s->edits)
        result = slv_session_export_edits(s->session, s->edits, &s->edited);
    return result;
}

static int run_session(struct session *s) {
    const slv_env outer = cli_env(s->threads), env = line_log_begin(&s->log, &outer, s->script);
    slv_session_info info;
    slv_history_info history;
    const char *const inputs[] = {s->new_from, s->script, s->path, s->merge, s->replay};
    int code = EXIT_FAILED;
    if (s->export && (output_check(&env, s->export, inputs, 5) || output_try(&env, s->export)))
        return code;
    s->seams = json_array();
    if (!work(&env, s)) {
        code = EXIT_OK;
        slv_session_get_info(s->session, &info);
        slv_document_history(slv_session_document(s->session), &history);
        if (s->json && output_print_json(s->path, session_json(s, &info, &history)))
            code = EXIT_FAILED;
        else if (!s->json && !s->quiet)
            print_session(s, &info, &history);
    }
    json_decref(s->seams);
    slv_session_destroy(s->session);
    return code;
}

static bool read_pair(const char *text, uint32_t pair[2]) {
    int length = 0;
    return sscanf(text, "%9" SCNu32 ",%9" SCNu32 "%n", &pair[0], &pair[1], &length) == 2 &&
           !text[length];
}

int verb_session(int argc, char **argv) {
    struct session s = {0};
    uint32_t narguments = 0;
    const cli_option options[] = {
        {"--new", CLI_TEXT, &s.new_from, "make it, for the mesh in a .ptx and on its texels",
         "IN.ptx", 0, 0, NULL},
        {"--replay", CLI_TEXT, &s.replay, "make it, with all that was done in another one",
         "OTHER.selvage", 0, 0, NULL},
        {"--scale", CLI_UINT, &s.scale,
         "with --replay: at so many times the resolution, a power of two (1)", NULL, 1, 65536,
         NULL},
        {"--script", CLI_TEXT, &s.script,
         "what to do, JSON lines: strokes, fills, layers, masks, sizes of faces", "SCRIPT.jsonl", 0,
         0, NULL},
        {"--layer", CLI_UINT, &s.layer, "id of the layer to paint on (the topmost)", NULL, 1,
         UINT32_MAX, NULL},
        {"--undo", CLI_UINT, &s.undo, "undo so many things first", NULL, 0, UINT32_MAX, NULL},
        {"--redo", CLI_UINT, &s.redo, "then redo so many", NULL, 0, UINT32_MAX, NULL},
        {"--merge", CLI_TEXT, &s.merge, "take what it has painted on other faces, and save",
         "OTHER.selvage", 0, 0, NULL},
        {"--save", CLI_FLAG, &s.save, "save it when all is done", NULL, 0, 0, NULL},
        {"--export|--out|-o", CLI_TEXT, &s.export, "write the flattened layers", "OUT.ptx", 0, 0,
         NULL},
        {"--edits", CLI_TEXT, &s.edits, "append what a .ptx has otherwise to it", "FILE.ptx", 0, 0,
         NULL},
        {"--certify", CLI_FLAG, &s.certify,
         "say how seams are: before and after, after each line, and of each layer", NULL, 0, 0,
         NULL},
        {"--between", CLI_TEXT, &s.between,
         "with --certify: and how well two layers fit to each other", "ID,ID", 0, 0, NULL},
        {"--as-saved", CLI_FLAG, &s.as_saved, "forget what was done since it was saved", NULL, 0, 0,
         NULL},
        SCENE_SCHEME(&s.scheme, NULL),
        CLI_JSON(&s.json),
        CLI_THREADS(&s.threads),
        CLI_PROGRESS(&s.progress),
        CLI_QUIET(&s.quiet, "print nothing on success"),
    };
    const cli_command command = {
        .name = "session",
        .summary = "paint in layers that nothing can lose",
        .arguments = "NAME.selvage",
        .reads = "a painting session, or with --new a texture of quads with its mesh inside",
        .writes = "the session, and with --export or --edits a .ptx",
        .examples = "  selvage session cow.selvage --new cow.ptx\n"
                    "  selvage session cow.selvage --script strokes.jsonl --save\n"
                    "  echo '{\"op\":\"add-layer\",\"name\":\"rust\"}' |\n"
                    "      selvage session cow.selvage --script - --save\n"
                    "  selvage session cow.selvage --undo 1 --export painted.ptx\n"
                    "  selvage session cow.selvage --certify --between 1,2\n"
                    "  selvage session large.selvage --replay cow.selvage --scale 2\n",
        CLI_TAKES(options, 1, 1, &s.path, &narguments)};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (s.new_from && s.replay)
        return cli_usage(&command, "--new and --replay: one of them");
    if (s.scale && (!s.replay || (s.scale & (s.scale - 1))))
        return cli_usage(&command,
                         s.replay ? "--scale: expected a power of two" : "--scale is of --replay");
    if (s.between && (!s.certify || !read_pair(s.between, s.pair)))
        return cli_usage(&command, s.certify ? "--between: expected the ids of two layers, as 1,2"
                                             : "--between is of --certify");
    if (s.export && !ptx_name_is_safe(s.export))
        return ptx_name_usage(&command, s.export);
    return run_session(&s);
}
