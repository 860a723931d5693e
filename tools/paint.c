/* The verb paint: a script of strokes applied to a texture or a mesh. */
#include "command/output.h"
#include "command/ptx_name.h"
#include "command/scene.h"
#include "verbs.h"

#include <selvage/blank.h>
#include <selvage/ptx_writer.h>
#include <selvage/script.h>

#include <stdlib.h>
#include <string.h>

#define BLANK_FILL 0.7529412f /* #c0c0c0 */

struct paint {
    const char *paths[3], *mesh_path;
    bool json, progress, quiet, faces;
    int scheme, boundary;
    uint32_t compression, threads;
    /* What is painted on: floats, so that thin paint adds up; rounded when it is written. */
    slv_ptx *ptx; /* NULL: a mesh was named */
    slv_mesh *mesh;
    slv_paint_surface *surface;
    slv_painter *painter;
    slv_texture *texture;
    slv_ptx_writer_params writer;
    slv_script *script;
    slv_script_stats stats;
    slv_seam_certificate before, after;
};

/* The texels of a face as floats. */
static slv_result load_face(void *user, const slv_env *env, uint32_t face, const slv_ptx_face *info,
                            void *texels) {
    struct paint *p = user;
    bool constant = (info->flags & SLV_FACE_CONSTANT) != 0;
    size_t count = (size_t)p->writer.nchannels << (constant ? 0 : info->res.u + info->res.v);
    float *values = malloc(count * sizeof *values);
    if (!values)
        return output_fail(env, SLV_ERROR_MEMORY, "%s: face %u: no memory for its texels",
                           p->paths[0], face);
    slv_type_to_float(p->writer.type, texels, count, values);
    slv_result result = constant ? slv_texture_set_constant(p->texture, face, values)
                                 : slv_texture_set_face(p->texture, face, values);
    free(values);
    return result;
}

static slv_result load_ptx(const slv_env *env, struct paint *p) {
    slv_result result = slv_ptx_open(env, p->paths[0], &p->ptx);
    if (result)
        return result;
    const slv_ptx_info *info = slv_ptx_get_info(p->ptx);
    if (info->mesh_type != SLV_PTX_QUAD)
        return output_fail(env, SLV_ERROR_UNSUPPORTED, "%s: is of triangles: quads are painted on",
                           p->paths[0]);
    if ((result = p->mesh_path ? slv_mesh_load(env, cli_input(p->mesh_path), &p->mesh)
                               : scene_load_geometry(env, p->ptx, "--mesh FILE.obj", &p->mesh)) ||
        (p->mesh_path && (result = slv_ptx_match_mesh(env, p->ptx, p->mesh))))
        return result;
    p->writer = slv_ptx_writer_params_like(p->ptx);
    slv_res *res = calloc((size_t)info->nfaces + 1, sizeof *res);
    if (!res)
        return output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for %u faces", p->paths[0],
                           info->nfaces);
    for (uint32_t face = 0; face < info->nfaces && !result; face++) {
        slv_ptx_face f;
        if (!(result = slv_ptx_get_face(p->ptx, face, &f)))
            res[face] = f.res;
    }
    const slv_texture_desc desc = {.nfaces = info->nfaces,
                                   .type = SLV_TYPE_FLOAT,
                                   .nchannels = info->nchannels,
                                   .alpha_channel = info->alpha_channel,
                                   .res = res};
    if (!result && !(result = slv_texture_create(env, &desc, &p->texture)))
        result = slv_ptx_visit_faces(env, p->ptx, load_face, p);
    free(res);
    return result;
}

static slv_result load_mesh(const slv_env *env, struct paint *p) {
    static const float fill[3] = {BLANK_FILL, BLANK_FILL, BLANK_FILL};
    const slv_blank_params params = {
        .type = SLV_TYPE_FLOAT, .fill = fill, .scheme = (slv_scheme)p->scheme};
    slv_result result = slv_mesh_load(env, cli_input(p->paths[0]), &p->mesh);
    if (result || (result = slv_blank_create(env, p->mesh, &params, &p->texture, NULL)))
        return result;
    p->writer = (slv_ptx_writer_params){.mesh_type = SLV_PTX_QUAD,
                                        .type = SLV_TYPE_U8,
                                        .nchannels = 3,
                                        .alpha_channel = SLV_NO_ALPHA,
                                        .nfaces = slv_mesh_face_count(p->mesh)};
    return SLV_OK;
}

static slv_result certify(const slv_env *env, const struct paint *p, slv_seam_certificate *out) {
    const slv_canvas canvas = slv_texture_as_canvas(p->texture);
    return slv_seam_certify(env, &canvas, slv_paint_surface_adjacency(p->surface), out);
}

static void tell_unknown(void *user, const char *brush, const char *setting) {
    const struct paint *p = user;
    if (!p->quiet)
        cli_warning("%s: %s is not known, and left out", brush, setting);
}

/* Line by line. */
static slv_result run_script(const slv_env *env, struct paint *p) {
    const slv_canvas canvas = slv_texture_as_canvas(p->texture);
    char *text = NULL, folder[4096];
    size_t size = 0;
    slv_result result = slv_text_load(env, cli_input(p->paths[1]), &text, &size);
    if (result)
        return result;
    snprintf(folder, sizeof folder, "%s", p->paths[1]);
    char *slash = strrchr(folder, '/');
    *(slash ? slash : folder) = 0;
    const slv_script_params params = {
        .name = p->paths[1], .folder = folder, .unknown = tell_unknown, .user = p};
    cli_progress progress = cli_progress_fleeting("paint", p->progress, p->quiet || p->json);
    result = slv_script_create(p->painter, &canvas, &params, &p->script);
    uint64_t number = 1;
    for (size_t at = 0; at < size && !result; number++) {
        const char *end = memchr(text + at, '\n', size - at);
        size_t length = end ? (size_t)(end - (text + at)) : size - at;
        result = slv_script_run(p->script, number, text + at, length);
        at += length + 1;
        if (!result && !cli_progress_report(&progress, at < size ? at : size, size))
            result = output_fail(env, SLV_ERROR_CANCELLED, "%s: stopped at line %llu", p->paths[1],
                                 (unsigned long long)number);
    }
    cli_progress_end(&progress);
    slv_free(text);
    if (!result)
        slv_script_get_stats(p->script, &p->stats);
    return result;
}

/* A face that was painted on, rounded; any other as it was. */
static slv_result write_face(const slv_env *env, const struct paint *p, slv_ptx_writer *writer,
                             uint32_t face) {
    slv_ptx_face info = {
        .res = slv_texture_get_desc(p->texture)->res[face],
        .adjacency.face = {SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY}};
    slv_result result = p->ptx ? slv_ptx_get_face(p->ptx, face, &info) : SLV_OK;
    bool painted = !p->ptx || slv_script_touched(p->script, face);
    if (result)
        return result;
    bool constant =
        painted ? slv_texture_is_constant(p->texture, face) : (info.flags & SLV_FACE_CONSTANT) != 0;
    size_t texels = (size_t)1 << (constant ? 0 : info.res.u + info.res.v);
    void *values = malloc(texels * p->writer.nchannels * slv_type_size(p->writer.type));
    if (!values)
        return output_fail(env, SLV_ERROR_MEMORY, "%s: face %u: no memory for its texels",
                           p->paths[2], face);
    info.flags = (uint8_t)((info.flags & SLV_FACE_SUBFACE) | (constant ? SLV_FACE_CONSTANT : 0));
    if (painted)
        slv_type_from_float(p->writer.type, slv_texture_texels(p->texture, face),
                            texels * p->writer.nchannels, values);
    else
        result = slv_ptx_read_face(p->ptx, face, constant ? (slv_res){0, 0} : info.res, values);
    if (!result)
        result = slv_ptx_writer_write_face(writer, face, &info, values);
    free(values);
    return result;
}

static slv_result save(const slv_env *env, struct paint *p) {
    slv_ptx_writer *writer = NULL;
    cli_progress progress = cli_progress_fleeting("write", p->progress, p->quiet || p->json);
    p->writer.compression = (int)p->compression;
    p->writer.progress = (slv_progress){cli_progress_report, &progress};
    slv_result result = slv_ptx_writer_create(env, p->paths[2], &p->writer, &writer);
    for (uint32_t i = 0; p->ptx && !result && i < slv_ptx_get_info(p->ptx)->nmeta; i++) {
        const slv_ptx_meta *meta;
        if (!(result = slv_ptx_load_meta(p->ptx, i, &meta)))
            result = slv_ptx_writer_set_meta(writer, meta);
    }
    if (!result && !p->ptx)
        result = slv_ptx_writer_set_mesh(writer, p->mesh);
    for (uint32_t face = 0; !result && face < p->writer.nfaces; face++)
        result = write_face(env, p, writer, face);
    if (!result)
        result = slv_ptx_writer_finish(writer);
    slv_ptx_writer_destroy(writer);
    cli_progress_end(&progress);
    return result;
}

static void print_certificate(const char *when, const slv_seam_certificate *c) {
    printf("  seams %s: at most %.4g apart (%.3g/255), %.3g in the mean", when, c->largest,
           255 * c->largest, c->mean);
    if (c->face >= 0)
        printf("; the most at face %d edge %u, %.3f along it", (int)c->face, c->edge, (double)c->t);
    printf(", %llu places\n", (unsigned long long)c->places);
}

static void print_result(const struct paint *p) {
    const slv_script_stats *s = &p->stats;
    output_terminal(stdout, p->paths[2], strlen(p->paths[2]), SIZE_MAX);
    printf(": %llu operations, %llu dabs, %u of %u faces touched, %llu texels\n",
           (unsigned long long)s->operations, (unsigned long long)s->dabs, s->faces,
           p->writer.nfaces, (unsigned long long)s->texels);
    if (s->missed)
        printf("  %llu dabs found no surface\n", (unsigned long long)s->missed);
    print_certificate("before", &p->before);
    print_certificate("after", &p->after);
    for (uint32_t face = 0; p->faces && face < p->writer.nfaces; face++)
        if (slv_script_touched(p->script, face))
            printf("  face %u\n", face);
}

static json_t *certificate_json(const slv_seam_certificate *c) {
    return json_pack("{s:o, s:o, s:I, s:I, s:i}", "largest", output_json_number(c->largest), "mean",
                     output_json_number(c->mean), "places", (json_int_t)c->places, "face",
                     (json_int_t)c->face, "edge", c->edge);
}

static json_t *paint_json(const struct paint *p) {
    const slv_script_stats *s = &p->stats;
    json_t *faces = json_array();
    for (uint32_t face = 0; face < p->writer.nfaces; face++)
        if (slv_script_touched(p->script, face) &&
            json_array_append_new(faces, json_integer(face))) {
            json_decref(faces);
            return NULL;
        }
    return json_pack("{s:i, s:o, s:I, s:I, s:I, s:I, s:I, s:o, s:o, s:o}", "schema", 1, "path",
                     output_json_text(p->paths[2], strlen(p->paths[2])), "operations",
                     (json_int_t)s->operations, "dabs", (json_int_t)s->dabs, "missed",
                     (json_int_t)s->missed, "texels", (json_int_t)s->texels, "faces",
                     (json_int_t)p->writer.nfaces, "touched", faces, "seams_before",
                     certificate_json(&p->before), "seams_after", certificate_json(&p->after));
}

static int run_paint(struct paint *p) {
    slv_env env = cli_env(p->threads);
    int code = EXIT_FAILED;
    const slv_paint_surface_params how = {.scheme = (slv_scheme)p->scheme,
                                          .boundary = (slv_boundary)p->boundary};
    const char *const inputs[] = {p->paths[0], p->paths[1], p->mesh_path};
    if (output_check_in_place(&env, p->paths[2], inputs, 3) || output_try(&env, p->paths[2]) ||
        (ptx_name_is_safe(p->paths[0]) ? load_ptx(&env, p) : load_mesh(&env, p)) ||
        slv_paint_surface_create(&env, p->mesh, &how, &p->surface) ||
        slv_painter_create(&env, p->surface, &p->painter))
        goto done;
    cli_catch_interrupts();
    if (certify(&env, p, &p->before) || run_script(&env, p) || certify(&env, p, &p->after) ||
        save(&env, p))
        goto done;
    code = EXIT_OK;
    if (p->json && output_print_json(p->paths[2], paint_json(p)))
        code = EXIT_FAILED;
    else if (!p->json && !p->quiet)
        print_result(p);
done:
    slv_script_destroy(p->script);
    slv_painter_destroy(p->painter);
    slv_paint_surface_destroy(p->surface);
    slv_texture_destroy(p->texture);
    slv_mesh_destroy(p->mesh);
    slv_ptx_close(p->ptx);
    return code;
}

int verb_paint(int argc, char **argv) {
    struct paint p = {0};
    uint32_t narguments = 0;
    const cli_option options[] = {
        CLI_OUT(&p.paths[2], "the file to write", "OUT.ptx"),
        CLI_MESH(&p.mesh_path),
        SCENE_SCHEME(&p.scheme, NULL),
        SCENE_BOUNDARY(&p.boundary, "boundary rule (default: the mesh's)", NULL),
        {"--faces|-f", CLI_FLAG, &p.faces, "list the faces that were painted on", NULL, 0, 0, NULL},
        CLI_COMPRESSION(&p.compression),
        CLI_JSON(&p.json),
        CLI_PROGRESS(&p.progress),
        CLI_THREADS(&p.threads),
        CLI_QUIET(&p.quiet, "print nothing on success"),
    };
    const cli_command command = {
        .name = "paint",
        .summary = "apply a script of strokes to a texture",
        .arguments = "IN.ptx|MESH.obj SCRIPT.jsonl OUT.ptx|-o OUT.ptx",
        .reads = "a texture of quads, or a mesh, and a script of strokes, JSON lines",
        .writes = "the painted texture; of a mesh a new one",
        .examples = "  selvage paint cow.ptx strokes.jsonl painted.ptx\n"
                    "  selvage paint cow.obj strokes.jsonl painted.ptx --faces\n"
                    "  selvage paint cow.ptx - painted.ptx <strokes.jsonl\n",
        .options = options,
        .noptions = sizeof options / sizeof *options,
        .min_arguments = 2,
        .max_arguments = 2,
        .positional = p.paths,
        .npositional = &narguments,
        .output = &p.paths[2],
        .output_needed = true};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (!ptx_name_is_safe(p.paths[2]))
        return ptx_name_usage(&command, p.paths[2]);
    return run_paint(&p);
}
