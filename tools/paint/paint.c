/* The verb paint: a script of strokes applied to a texture, a mesh or a session. */
#include "paint/paint.h"
#include "command/output.h"
#include "command/ptx_name.h"
#include "command/seams.h"
#include "verbs.h"

#include <stdlib.h>
#include <string.h>

struct paint {
    const char *paths[3], *record;
    bool json, progress, quiet, faces, certify, scheme_given, boundary_given, camera_given;
    bool to_session, in_place;
    int scheme, boundary;
    uint32_t compression, threads, layer, size[2];
    float azimuth, elevation, fov;
    easel easel;
    record pictures;
    slv_script_stats stats;
    slv_seam_certificate before, after;
    json_t *lines; /* with --certify and --json: what is said of each */
};

static slv_result certify(const slv_env *env, struct paint *p, slv_seam_certificate *out) {
    slv_texture *texture;
    slv_result result = easel_texture(&p->easel, &texture);
    if (result)
        return result;
    const slv_canvas canvas = slv_texture_as_canvas(texture);
    return slv_seam_certify(env, &canvas, easel_adjacency(&p->easel), out);
}

static void tell_unknown(void *user, const char *brush, const char *setting) {
    const struct paint *p = user;
    if (!p->quiet)
        cli_warning("%s: %s is not known, and left out", brush, setting);
}

/* What a line has left: its picture and its certificate, if they are asked for. */
static slv_result look(const slv_env *env, struct paint *p, uint64_t number) {
    slv_script_stats stats;
    char when[48];
    easel_stats(&p->easel, &stats);
    if (stats.operations == p->stats.operations)
        return SLV_OK; /* it has painted nothing */
    p->stats = stats;
    slv_result result = p->record ? record_picture(env, &p->pictures, &p->easel) : SLV_OK;
    if (result || !p->certify || (result = certify(env, p, &p->after)))
        return result;
    snprintf(when, sizeof when, "after line %llu", (unsigned long long)number);
    if (!p->json && !p->quiet)
        seams_print(when, &p->after);
    if (p->json &&
        json_array_append_new(p->lines, json_pack("{s:I, s:o}", "line", (json_int_t)number, "seams",
                                                  seams_json(&p->after))) != 0)
        result = output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for what is to be printed",
                             p->paths[1]);
    return result;
}

/* Line by line. */
static slv_result run_script(const slv_env *env, struct paint *p) {
    char *text = NULL;
    size_t size = 0;
    slv_result result = slv_text_load(env, cli_input(p->paths[1]), &text, &size);
    if (result || (result = easel_begin(env, &p->easel, p->paths[1], tell_unknown, p))) {
        slv_free(text);
        return result;
    }
    cli_progress progress = cli_progress_fleeting("paint", p->progress, p->quiet || p->json);
    uint64_t number = 1;
    for (size_t at = 0; at < size && !result; number++) {
        const char *end = memchr(text + at, '\n', size - at);
        size_t length = end ? (size_t)(end - (text + at)) : size - at;
        if (!(result = easel_run(&p->easel, number, text + at, length)))
            result = look(env, p, number);
        at += length + 1;
        if (!result && !cli_progress_report(&progress, at < size ? at : size, size))
            result = output_fail(env, SLV_ERROR_CANCELLED, "%s: stopped at line %llu", p->paths[1],
                                 (unsigned long long)number);
    }
    cli_progress_end(&progress);
    slv_free(text);
    easel_stats(&p->easel, &p->stats);
    return result;
}

static const char *result_name(const struct paint *p) {
    return p->in_place ? p->paths[0] : p->paths[2];
}

static void print_result(const struct paint *p) {
    const slv_script_stats *s = &p->stats;
    uint32_t nfaces = easel_faces(&p->easel);
    output_terminal(stdout, result_name(p), strlen(result_name(p)), SIZE_MAX);
    printf(": %llu operations, %llu dabs, %u of %u faces touched, %llu texels\n",
           (unsigned long long)s->operations, (unsigned long long)s->dabs, s->faces, nfaces,
           (unsigned long long)s->texels);
    if (s->missed)
        printf("  %llu dabs found no surface\n", (unsigned long long)s->missed);
    if (p->record)
        printf("  %u pictures\n", p->pictures.next);
    seams_print("before", &p->before);
    seams_print("after", &p->after);
    for (uint32_t face = 0; p->faces && face < nfaces; face++)
        if (easel_touched(&p->easel, face))
            printf("  face %u\n", face);
}

static json_t *paint_json(const struct paint *p) {
    const slv_script_stats *s = &p->stats;
    const char *name = result_name(p);
    uint32_t nfaces = easel_faces(&p->easel);
    json_t *faces = json_array();
    for (uint32_t face = 0; face < nfaces; face++)
        if (easel_touched(&p->easel, face) && json_array_append_new(faces, json_integer(face))) {
            json_decref(faces);
            return NULL;
        }
    return json_pack("{s:i, s:o, s:I, s:I, s:I, s:I, s:I, s:o, s:I, s:O, s:o, s:o}", "schema", 1,
                     "path", output_json_name(name), "operations", (json_int_t)s->operations,
                     "dabs", (json_int_t)s->dabs, "missed", (json_int_t)s->missed, "texels",
                     (json_int_t)s->texels, "faces", (json_int_t)nfaces, "touched", faces,
                     "pictures", (json_int_t)p->pictures.next, "lines", p->lines, "seams_before",
                     seams_json(&p->before), "seams_after", seams_json(&p->after));
}

/* Whether all that is to be written can be, before the work. */
static slv_result check_outputs(const slv_env *env, const struct paint *p) {
    const char *const inputs[] = {p->paths[0], p->paths[1], p->easel.mesh_path};
    char name[FRAMES_PATH];
    slv_result result = SLV_OK;
    if (p->to_session && slv_session_is(p->paths[2]))
        return output_fail(env, SLV_ERROR_IO, "%s: is there already", p->paths[2]);
    if (p->to_session)
        result = output_try_folder(env, p->paths[2]);
    else if (!p->in_place && !(result = output_check_in_place(env, p->paths[2], inputs, 3)))
        result = output_try(env, p->paths[2]);
    if (!result && p->record && !frames_name(p->record, 0, name))
        return output_fail(env, SLV_ERROR_IO, "%s: its name is too long", p->record);
    return result || !p->record ? result : output_check(env, name, inputs, 3);
}

static slv_result open_easel(const slv_env *env, struct paint *p) {
    easel *e = &p->easel;
    if (!slv_session_is(e->name))
        return p->to_session ? easel_make_session(env, e, p->paths[2]) : easel_open(env, e);
    slv_result result = easel_open_session(env, e, p->layer, !p->in_place && !p->to_session);
    if (result || p->in_place)
        return result;
    const char *const made_of[] = {slv_session_made_of(e->session)};
    return p->to_session ? slv_session_save_as(e->session, p->paths[2])
                         : output_check_inputs(env, p->paths[2], made_of, 1);
}

static slv_result work(const slv_env *env, struct paint *p) {
    easel *e = &p->easel;
    record *r = &p->pictures;
    slv_result result;
    if ((result = certify(env, p, &p->before)) ||
        (p->record &&
         ((result = record_begin(env, r, e)) || (result = record_picture(env, r, e)))) ||
        (result = run_script(env, p)) || (result = certify(env, p, &p->after)))
        return result;
    if (p->to_session)
        return slv_session_save(e->session);
    e->writer.compression = (int)p->compression;
    return p->in_place ? SLV_OK : easel_save(env, e, p->paths[2], p->progress, p->quiet || p->json);
}

static int run_paint(struct paint *p) {
    slv_env env = cli_env(p->threads);
    easel *e = &p->easel;
    int code = EXIT_FAILED;
    bool made = false;
    e->name = p->paths[0];
    e->scheme = (slv_scheme)p->scheme;
    e->boundary = (slv_boundary)p->boundary;
    p->pictures = (record){.out = p->record,
                           .azimuth = p->azimuth,
                           .elevation = p->elevation,
                           .fov = p->fov,
                           .frame = {.width = p->size[0], .height = p->size[1]}};
    p->lines = json_array();
    if (check_outputs(&env, p))
        goto done;
    /* what is only read is lost by nobody */
    if (p->to_session)
        cli_catch_interrupts();
    if (open_easel(&env, p))
        goto done;
    cli_catch_interrupts();
    made = p->to_session;
    if (work(&env, p))
        goto done;
    made = false;
    code = EXIT_OK;
    if (p->json && output_print_json(result_name(p), paint_json(p)))
        code = EXIT_FAILED;
    else if (!p->json && !p->quiet)
        print_result(p);
done:
    record_end(&p->pictures);
    easel_close(e);
    if (made && slv_session_remove(&env, p->paths[2]))
        code = EXIT_FAILED;
    json_decref(p->lines);
    return code;
}

static bool is_session_name(const char *name) {
    const char *dot = strrchr(name, '.');
    return dot && strcmp(dot, ".selvage") == 0;
}

/* What is wrong with the arguments together, for cli_usage; NULL if nothing is. */
static const char *find_problem(const struct paint *p) {
    bool session = slv_session_is(p->paths[0]);
    if (!session && p->in_place)
        return "the file to write is missing; only a session is painted on in its place";
    if (session && (p->scheme_given || p->boundary_given || p->easel.mesh_path))
        return "a session has its own mesh and scheme";
    if (p->to_session && p->boundary_given)
        return "--boundary is not for sessions";
    if (p->layer && !session)
        return "--layer is of sessions";
    if (p->compression && (session || p->to_session))
        return "--compression is not for sessions";
    if (p->camera_given && !p->record)
        return "--azimuth, --elevation, --fov and --size are of the pictures of --record";
    if (p->record && slv_image_format_of_name(p->record) == SLV_IMAGE_NONE)
        return "--record: the pictures' name must end in .png or .exr";
    return NULL;
}

int verb_paint(int argc, char **argv) {
    struct paint p = {.azimuth = 30, .elevation = 20, .fov = 35, .size = {512, 512}};
    uint32_t narguments = 0;
    const cli_option options[] = {
        CLI_OUT(&p.paths[2], "the file or session to write; without it a session is painted on",
                "OUT"),
        CLI_MESH(&p.easel.mesh_path),
        SCENE_SCHEME(&p.scheme, &p.scheme_given),
        SCENE_BOUNDARY(&p.boundary, "boundary rule (default: the mesh's)", &p.boundary_given),
        {"--layer", CLI_UINT, &p.layer, "of a session: id of the layer to paint on (the topmost)",
         NULL, 1, UINT32_MAX, NULL},
        {"--record", CLI_TEXT, &p.record,
         "a picture before, numbered 0, and after each stroke and fill; #### stands for the number",
         "NAME.####.png", 0, 0, NULL},
        SCENE_AZIMUTH(&p.azimuth, "of the pictures: degrees around (30)", &p.camera_given),
        SCENE_ELEVATION(&p.elevation, &p.camera_given),
        SCENE_FOV(&p.fov, &p.camera_given),
        {"--size", CLI_SIZE, p.size, "pixels of the pictures (512x512)", NULL, 1, 16384,
         &p.camera_given},
        {"--certify", CLI_FLAG, &p.certify, "say how seams are after each stroke and fill", NULL, 0,
         0, NULL},
        {"--list-faces||--faces|-f", CLI_FLAG, &p.faces, "list the faces that were painted on",
         NULL, 0, 0, NULL},
        CLI_COMPRESSION(&p.compression),
        CLI_JSON(&p.json),
        CLI_PROGRESS(&p.progress),
        CLI_THREADS(&p.threads),
        CLI_QUIET(&p.quiet, "print nothing on success"),
    };
    const cli_command command = {
        .name = "paint",
        .summary = "apply a script of strokes to a texture or a session",
        .arguments = "IN.ptx|MESH.obj|IN.selvage SCRIPT.jsonl [OUT.ptx|OUT.selvage|-o OUT]",
        .reads = "a texture of quads, a mesh or a painting session, and a script of strokes, JSON "
                 "lines",
        .writes = "the painted texture, of a mesh a new one; or a session; or numbered pictures",
        .examples = "  selvage paint cow.ptx strokes.jsonl painted.ptx\n"
                    "  selvage paint cow.obj strokes.jsonl painted.ptx --list-faces\n"
                    "  selvage paint cow.ptx - painted.ptx <strokes.jsonl\n"
                    "  selvage paint cow.ptx strokes.jsonl cow.selvage\n"
                    "  selvage paint cow.selvage more.jsonl --record stage.####.png --certify\n",
        CLI_TAKES(options, 2, 2, p.paths, &narguments),
        .output = &p.paths[2]};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    p.in_place = !p.paths[2];
    p.to_session = p.paths[2] && is_session_name(p.paths[2]);
    const char *problem = find_problem(&p);
    if (problem)
        return cli_usage(&command, "%s", problem);
    if (!p.in_place && !p.to_session && !ptx_name_is_safe(p.paths[2]))
        return ptx_name_usage(&command, p.paths[2]);
    return run_paint(&p);
}
