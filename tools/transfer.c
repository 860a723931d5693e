/* The verb transfer: texels of one model on a changed one. */
#include "command/output.h"
#include "command/ptx_name.h"
#include "command/salvage.h"
#include "command/scene.h"
#include "verbs.h"

#include <selvage/transfer.h>

#include <stdlib.h>
#include <string.h>

struct transfer {
    const char *paths[2], *from, *to;
    float distance;
    bool distance_given, blank, no_copies, faces, json, progress, quiet, salvage;
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
                     output_json_text(t->paths[1], strlen(t->paths[1])), "faces",
                     (json_int_t)t->nfaces, "copied", (json_int_t)t->counts[SLV_TRANSFER_COPIED],
                     "resampled", (json_int_t)t->counts[SLV_TRANSFER_RESAMPLED], "partly",
                     (json_int_t)t->counts[SLV_TRANSFER_PARTLY], "far",
                     (json_int_t)t->counts[SLV_TRANSFER_FAR], "covered",
                     output_json_number((double)t->covered), "face_list", faces);
}

/* Metadata that is not geometry goes along; entries of the source file stay where they are. */
static slv_result save(const slv_env *env, const struct transfer *t, const slv_ptx *ptx,
                       const slv_texture *texture, const slv_mesh *mesh) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    slv_adjacency *adjacency = NULL;
    slv_ptx_meta *meta = calloc((size_t)info->nmeta + 1, sizeof *meta);
    slv_ptx_write_params params = {.border_u = info->border_u,
                                   .border_v = info->border_v,
                                   .edge_filter = info->edge_filter,
                                   .no_reductions = info->nlevels < 2,
                                   .compression = (int)t->compression,
                                   .mesh = mesh,
                                   .meta = meta};
    slv_result result =
        meta ? SLV_OK
             : output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for its metadata", t->paths[1]);
    for (uint32_t i = 0; i < info->nmeta && !result; i++) {
        const slv_ptx_meta *entry;
        if (!(result = slv_ptx_load_meta(ptx, i, &entry)) &&
            strcmp(entry->key, "PtexFaceVertCounts") != 0 &&
            strcmp(entry->key, "PtexFaceVertIndices") != 0 &&
            strcmp(entry->key, "PtexVertPositions") != 0)
            meta[params.nmeta++] = *entry;
    }
    if (!result && !(result = slv_mesh_adjacency(env, mesh, &adjacency)))
        result = slv_ptx_save(env, t->paths[1], texture, adjacency, &params);
    slv_adjacency_destroy(adjacency);
    free(meta);
    return result;
}

static int run_transfer(struct transfer *t) {
    slv_env env = cli_env(t->threads);
    slv_ptx *ptx = NULL;
    slv_mesh *source = NULL, *target = NULL;
    slv_texture *texture = NULL, *moved = NULL;
    cli_progress progress = cli_progress_fleeting("transfer", t->progress, t->quiet || t->json);
    slv_transfer_params params = {.max_distance = t->distance,
                                  .blank = t->blank,
                                  .no_copies = t->no_copies,
                                  .scheme = (slv_scheme)t->scheme,
                                  .progress = {cli_progress_report, &progress}};
    int code = EXIT_FAILED;
    const char *const inputs[] = {t->paths[0], t->from, t->to};
    if (output_check_in_place(&env, t->paths[1], inputs, 3) || output_try(&env, t->paths[1]))
        goto done;
    if (slv_mesh_load(&env, cli_input(t->to), &target) ||
        salvage_open(&env, t->paths[0], t->salvage, &ptx))
        goto done;
    if (slv_ptx_get_info(ptx)->mesh_type != SLV_PTX_QUAD) {
        cli_error("%s: is of triangles; only quads can be transferred", t->paths[0]);
        goto done;
    }
    if (t->from ? slv_mesh_load(&env, cli_input(t->from), &source) ||
                      slv_ptx_match_mesh(&env, ptx, source)
                : scene_load_geometry(&env, ptx, "--from OLD.obj", &source))
        goto done;
    if (slv_ptx_load_texture(&env, ptx, &texture))
        goto done;
    t->nfaces = slv_mesh_face_count(target);
    t->list = calloc((size_t)t->nfaces + 1, sizeof *t->list);
    if (!t->list) {
        cli_error("no memory for %u faces", t->nfaces);
        goto done;
    }
    cli_catch_interrupts();
    if (slv_transfer(&env, source, texture, target, &params, t->list, &t->covered, &moved) ||
        save(&env, t, ptx, moved, target))
        goto done;
    cli_progress_end(&progress);
    for (uint32_t face = 0; face < t->nfaces; face++)
        t->counts[t->list[face].kind]++;
    code = EXIT_OK;
    if (t->json)
        code = output_print_json(t->paths[1], transfer_json(t));
    else if (!t->quiet)
        print_result(t);
    if (salvage_tell(ptx))
        code = EXIT_FAILED;
done:
    cli_progress_end(&progress);
    free(t->list);
    slv_texture_destroy(texture);
    slv_texture_destroy(moved);
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
        {"--blank", CLI_FLAG, &t.blank,
         "leave texels further away at zero instead of the nearest value", NULL, 0, 0, NULL},
        {"--no-copies", CLI_FLAG, &t.no_copies, "resample faces that match as well", NULL, 0, 0,
         NULL},
        {"--scheme", CLI_CHOICE, &t.scheme, "subdivision scheme (catmark)", "catmark|bilinear", 0,
         0, NULL},
        {"--faces|-f", CLI_FLAG, &t.faces, "say of every face what was done", NULL, 0, 0, NULL},
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
        .reads = "a texture of quads and the changed model; the old one if it is named",
        .writes = "a texture with the geometry of the changed model inside",
        .examples = "  selvage transfer cow.ptx cow2.ptx --to cow2.obj\n"
                    "  selvage transfer cow.ptx cow2.ptx --from cow.obj --to cow2.obj --faces\n"
                    "  selvage transfer cow.ptx cow2.ptx --to cow2.obj --distance 0.05 --blank\n",
        .options = options,
        .noptions = sizeof options / sizeof *options,
        .min_arguments = 1,
        .max_arguments = 1,
        .positional = t.paths,
        .npositional = &narguments,
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
    return run_transfer(&t);
}
