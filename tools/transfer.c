/* The verb transfer: texels of one model on a changed one. */
#include "command/numbers.h"
#include "command/output.h"
#include "command/ptx_name.h"
#include "command/salvage.h"
#include "command/scene.h"
#include "verbs.h"

#include <selvage/cache.h>
#include <selvage/transfer.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CACHE_BYTES (UINT64_C(256) << 20)

struct transfer {
    const char *paths[2], *from, *to, *scale_from;
    float distance, scale;
    bool force, distance_given, blank, no_copies, faces, json, progress, quiet, salvage,
        scheme_given;
    int scheme;
    uint32_t compression, threads;
    slv_transfer_face *list;
    uint32_t nfaces, counts[4];
    float covered;
};

static void print_face(const struct transfer *t, uint32_t face) {
    const slv_transfer_face *f = &t->list[face];
    printf("  face %u: %s", face, slv_transfer_kind_name(f->kind));
    if (f->source >= 0)
        printf(f->kind == SLV_TRANSFER_COPIED ? " from face %d" : ", its middle from face %d",
               f->source);
    if (f->turn || f->flipped)
        printf(", turned by %u%s", f->turn, f->flipped ? " and flipped" : "");
    if (f->kind == SLV_TRANSFER_PARTLY)
        printf(", %.1f%% of it", 100 * (double)f->covered);
    if (f->kind != SLV_TRANSFER_COPIED)
        printf(", up to %g away", (double)f->distance);
    putchar('\n');
}

static void print_result(const struct transfer *t) {
    output_terminal(stdout, t->paths[1], strlen(t->paths[1]), SIZE_MAX);
    printf(": %u faces: %u copied, %u resampled, %u partly, %u too far away\n"
           "  %.4g%% of the surface covered\n",
           t->nfaces, t->counts[0], t->counts[1], t->counts[2], t->counts[3],
           100 * (double)t->covered);
    for (uint32_t face = 0; face < t->nfaces; face++)
        if (t->faces)
            print_face(t, face);
}

static json_t *transfer_json(const struct transfer *t) {
    json_t *faces = json_array();
    for (uint32_t face = 0; face < t->nfaces; face++) {
        const slv_transfer_face *f = &t->list[face];
        if (json_array_append_new(
                faces, json_pack("{s:I, s:s, s:o, s:I, s:b, s:o, s:o, s:o}", "face",
                                 (json_int_t)face, "did", slv_transfer_kind_name(f->kind), "source",
                                 f->source < 0 ? json_null() : json_integer(f->source), "turn",
                                 (json_int_t)f->turn, "flipped", (int)f->flipped, "covered",
                                 output_json_number((double)f->covered), "distance",
                                 output_json_number((double)f->distance), "area",
                                 output_json_number((double)f->area)))) {
            json_decref(faces);
            return NULL;
        }
    }
    return json_pack("{s:i, s:o, s:I, s:I, s:I, s:I, s:I, s:o, s:o}", "schema", 1, "path",
                     output_json_name(t->paths[1]), "faces", (json_int_t)t->nfaces, "copied",
                     (json_int_t)t->counts[SLV_TRANSFER_COPIED], "resampled",
                     (json_int_t)t->counts[SLV_TRANSFER_RESAMPLED], "partly",
                     (json_int_t)t->counts[SLV_TRANSFER_PARTLY], "far",
                     (json_int_t)t->counts[SLV_TRANSFER_FAR], "covered",
                     output_json_number((double)t->covered), "face_list", faces);
}

/* Where faces go: the writer, made once their number and kind are known. */
struct result {
    const struct transfer *t;
    const slv_env *env;
    const slv_ptx *ptx;
    const slv_mesh *mesh;
    const slv_res *res;
    slv_ptx_writer *writer;
};

/* Metadata that is not geometry goes along; entries of the source file stay where they are. */
static slv_result copy_meta(const struct result *r) {
    for (uint32_t i = 0; i < slv_ptx_get_info(r->ptx)->nmeta; i++) {
        const slv_ptx_meta *entry;
        slv_result result = slv_ptx_load_meta(r->ptx, i, &entry);
        if (!result && strcmp(entry->key, "PtexFaceVertCounts") != 0 &&
            strcmp(entry->key, "PtexFaceVertIndices") != 0 &&
            strcmp(entry->key, "PtexVertPositions") != 0)
            result = slv_ptx_writer_set_meta(r->writer, entry);
        if (result)
            return result;
    }
    return SLV_OK;
}

static slv_result begin(void *user, const slv_texture_desc *desc) {
    struct result *r = user;
    slv_ptx_writer_params params = slv_ptx_writer_params_like(r->ptx);
    cli_catch_interrupts();
    params.nfaces = desc->nfaces;
    params.mesh_type = SLV_PTX_QUAD;
    params.compression = (int)r->t->compression;
    r->res = desc->res;
    slv_result result = slv_ptx_writer_create(r->env, r->t->paths[1], &params, &r->writer);
    if (!result && !(result = slv_ptx_writer_set_mesh(r->writer, r->mesh)))
        result = copy_meta(r);
    return result;
}

static slv_result put(void *user, const slv_env *env, uint32_t face, bool constant,
                      const void *texels) {
    const struct result *r = user;
    const slv_ptx_face info = {
        .res = r->res[face],
        .flags = constant ? SLV_FACE_CONSTANT : 0,
        .adjacency.face = {SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY}};
    (void)env; /* the writer's own log is serialised */
    return slv_ptx_writer_write_face(r->writer, face, &info, texels);
}

/* What texels are read from. */
struct texels {
    slv_cache *cache;
    slv_adjacency *adjacency; /* of triangles, with the texture of their sub-faces */
    slv_texture *texture;
    slv_source source;
};

static void close_texels(struct texels *from) {
    slv_source_close(&from->source);
    slv_cache_destroy(from->cache);
    slv_texture_destroy(from->texture);
    slv_adjacency_destroy(from->adjacency);
}

/* Triangles are carried over as the sub-faces that surfaces have of them. */
static slv_result open_triangles(const slv_env *env, const slv_ptx *ptx, const slv_mesh *mesh,
                                 struct texels *from) {
    const slv_texture_source_params params = {.name = slv_ptx_name(ptx)};
    slv_texture_encoding encoding;
    slv_texture *triangles = NULL;
    slv_result result = slv_ptx_get_encoding(ptx, &encoding);
    if (!result && !(result = slv_ptx_match_mesh(env, ptx, mesh)) &&
        !(result = slv_mesh_adjacency(env, mesh, &from->adjacency)) &&
        !(result = scene_check_memory(env, ptx, NULL)) &&
        !(result = slv_ptx_load_texture(env, ptx, &triangles)) &&
        !(result = slv_triangle_texture(env, triangles, from->adjacency, encoding, &from->texture)))
        result = slv_texture_as_source(env, from->texture, from->adjacency, &params, &from->source);
    slv_texture_destroy(triangles);
    return result;
}

/* The file behind a cache: of its texels no more than that is in memory. */
static slv_result open_texels(const slv_env *env, const slv_ptx *ptx, const slv_mesh *mesh,
                              struct texels *from) {
    const slv_cache_params params = {.max_bytes = CACHE_BYTES};
    slv_source texels;
    slv_file_id file;
    if (slv_ptx_get_info(ptx)->mesh_type == SLV_PTX_TRIANGLE)
        return open_triangles(env, ptx, mesh, from);
    slv_result result = slv_cache_create(env, &params, &from->cache);
    if (!result && !(result = slv_ptx_as_source(env, ptx, &texels)) &&
        !(result = slv_cache_open_source(from->cache, &texels, NULL, &file)))
        result = slv_cache_as_source(from->cache, file, &from->source);
    return result;
}

/* auto, or a ratio, which is then `scale`. */
static bool scale_is_good(struct transfer *t) {
    double scale = 1;
    const char *end = "";
    if (!t->scale_from || strcmp(t->scale_from, "auto") == 0)
        return true;
    bool good = value_ratio(t->scale_from, &scale, &end) && !*end && scale > 0 &&
                isfinite((float)scale) && (float)scale > 0;
    t->scale = (float)scale;
    return good;
}

static void choose_scale(struct transfer *t, const slv_mesh *source, const slv_mesh *target) {
    if (!t->scale_from)
        return;
    if (strcmp(t->scale_from, "auto") == 0) {
        t->scale = slv_transfer_find_scale(source, target);
        if (!t->quiet && !t->json)
            printf("the old model's coordinates times %g\n", (double)t->scale);
    }
}

/* Carries over, and puts the file in its place unless it has nothing of the old one. */
static int carry_over(const slv_env *env, struct transfer *t, const slv_ptx *ptx,
                      const slv_mesh *source, const slv_mesh *target) {
    cli_progress progress = cli_progress_fleeting("transfer", t->progress, t->quiet || t->json);
    const slv_transfer_params params = {.max_distance = t->distance,
                                        .blank = t->blank,
                                        .no_copies = t->no_copies,
                                        .scheme = (slv_scheme)t->scheme,
                                        .source_scale = t->scale,
                                        .progress = {cli_progress_report, &progress}};
    struct result r = {.t = t, .env = env, .ptx = ptx, .mesh = target};
    const slv_transfer_sink sink = {begin, put, &r};
    struct texels from = {0};
    slv_result result = open_texels(env, ptx, source, &from);
    if (!result)
        result = slv_transfer_from(env, source, &from.source, target, &params, &sink, t->list,
                                   &t->covered);
    cli_progress_end(&progress);
    if (!result && !(t->covered > 0) && !t->force)
        result = output_fail(env, SLV_ERROR_MISMATCH,
                             "%s: nothing of the new surface is near the old one, no file is "
                             "written: see --scale-from and --distance; --force writes it",
                             t->paths[1]);
    if (!result)
        result = slv_ptx_writer_finish(r.writer);
    slv_ptx_writer_destroy(r.writer);
    close_texels(&from);
    return result ? EXIT_FAILED : EXIT_OK;
}

static int run_transfer(struct transfer *t) {
    slv_env env = cli_env(t->threads);
    slv_ptx *ptx = NULL;
    slv_mesh *source = NULL, *target = NULL;
    int code = EXIT_FAILED;
    const char *const inputs[] = {t->paths[0], t->from, t->to};
    if (output_check_in_place(&env, t->paths[1], inputs, 3) || output_try(&env, t->paths[1]))
        goto done;
    if (slv_mesh_load(&env, cli_input(t->to), &target) ||
        salvage_open(&env, t->paths[0], t->salvage, &ptx))
        goto done;
    if (t->from ? slv_mesh_load(&env, cli_input(t->from), &source) ||
                      slv_ptx_match_mesh(&env, ptx, source)
                : scene_load_geometry(&env, ptx, "--from OLD.obj", &source))
        goto done;
    if (slv_ptx_get_info(ptx)->mesh_type == SLV_PTX_TRIANGLE && !t->scheme_given &&
        scene_is_of_triangles(target))
        t->scheme = SLV_SCHEME_LOOP;
    choose_scale(t, source, target);
    t->nfaces = slv_mesh_face_count(target);
    t->list = calloc((size_t)t->nfaces + 1, sizeof *t->list);
    if (!t->list) {
        cli_error("no memory for %u faces", t->nfaces);
        goto done;
    }
    code = carry_over(&env, t, ptx, source, target);
    if (code)
        goto done;
    for (uint32_t face = 0; face < t->nfaces; face++)
        t->counts[t->list[face].kind]++;
    if (t->json && output_print_json(t->paths[1], transfer_json(t)))
        code = EXIT_FAILED;
    else if (!t->json && !t->quiet)
        print_result(t);
    if (salvage_tell(ptx))
        code = EXIT_FAILED;
done:
    free(t->list);
    slv_mesh_destroy(source);
    slv_mesh_destroy(target);
    slv_ptx_close(ptx);
    return code;
}

int verb_transfer(int argc, char **argv) {
    struct transfer t = {.scheme = SLV_SCHEME_CATMARK};
    uint32_t narguments = 0;
    const cli_option options[] = {
        CLI_OUT(&t.paths[1], "the file to write", "OUT.ptx"),
        {"--to", CLI_TEXT, &t.to, "the changed model", "NEW.obj", 0, 0, NULL},
        {"--from", CLI_TEXT, &t.from,
         "the model that IN.ptx was painted on; default: the geometry inside", "OLD.obj", 0, 0,
         NULL},
        {"--distance", CLI_FLOAT, &t.distance,
         "how near the old surface a texel must be, in mesh units, more than 0 (1/100 of its "
         "diagonal)",
         "X", 0, 0, &t.distance_given},
        {"--scale-from", CLI_TEXT, &t.scale_from,
         "what the old model's coordinates are multiplied by, to be in the new one's units; auto "
         "finds it from their sizes (1)",
         "auto|X", 0, 0, NULL},
        {"--force", CLI_FLAG, &t.force, "write a file of which nothing is covered", NULL, 0, 0,
         NULL},
        {"--blank", CLI_FLAG, &t.blank,
         "leave texels further away at zero instead of the nearest value", NULL, 0, 0, NULL},
        {"--no-copies", CLI_FLAG, &t.no_copies, "resample faces that match as well", NULL, 0, 0,
         NULL},
        {"--scheme", CLI_CHOICE, &t.scheme,
         "subdivision scheme (catmark; between meshes of triangles, of a texture of such, loop)",
         names_schemes(), 0, 0, &t.scheme_given},
        {"--list-faces||--faces|-f", CLI_FLAG, &t.faces, "say of every face what was done", NULL, 0,
         0, NULL},
        CLI_COMPRESSION(&t.compression),
        CLI_SALVAGE(&t.salvage),
        CLI_JSON(&t.json),
        CLI_PROGRESS(&t.progress),
        CLI_THREADS(&t.threads),
        CLI_QUIET(&t.quiet, "print nothing on success"),
    };
    const cli_command command = {
        .name = "transfer",
        .summary = "carry texels over to a changed model",
        .arguments = "IN.ptx OUT.ptx|-o OUT.ptx --to NEW.obj",
        .reads = "a texture and the changed model; the old one if it is named",
        .writes = "a texture with the geometry of the changed model inside",
        .examples =
            "  selvage transfer cow.ptx cow2.ptx --to cow2.obj\n"
            "  selvage transfer cow.ptx cow2.ptx --from cow.obj --to cow2.obj --list-faces\n"
            "  selvage transfer cow.ptx cow2.ptx --to cow2.obj --distance 0.05 --blank\n",
        CLI_TAKES(options, 1, 1, t.paths, &narguments),
        .output = &t.paths[1],
        .output_needed = true};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (!t.to)
        return cli_usage(&command, "--to is missing: onto which model?");
    if (!ptx_name_is_safe(t.paths[1]))
        return ptx_name_usage(&command, t.paths[1]);
    if (t.distance_given && !(t.distance > 0))
        return cli_usage(&command, "--distance: expected more than 0");
    if (!scale_is_good(&t))
        return cli_usage(&command, "--scale-from: expected auto or a number more than 0, not '%s'",
                         t.scale_from);
    if (CLI_STANDARD_ONCE(&command, t.paths[0], t.to, t.from))
        return EXIT_USAGE;
    return run_transfer(&t);
}
