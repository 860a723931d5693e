/* The verb wrap: one texture coordinate a vertex, and no vertices that are there twice. */
#include "command/names.h"
#include "command/output.h"
#include "verbs.h"

#include <selvage/wrap.h>

#include <inttypes.h>
#include <string.h>

enum { VERTEX_BYTES = 32 }; /* of position, normal and texture coordinates in floats */

struct wrap_options {
    const char *paths[2];
    int map, axis;
    bool axis_given, keep, json, progress, quiet;
};

static void print_limits(const slv_wrap_report *r) {
    if (r->nkept)
        printf(
            "  %u vertices stay beside others at their place, since an edge would have more than "
            "two sides, or two that run the same way: the first is %d\n",
            r->nkept, r->first_kept + 1);
    if (r->ncollapsed)
        printf("  %u polygons had no three vertices left, and are gone: the first was %d\n",
               r->ncollapsed, r->first_collapsed + 1);
    if (r->nwide)
        printf("  %u polygons span half of the map or more, and will be taken the wrong way: the "
               "first is %d\n",
               r->nwide, r->first_wide + 1);
    if (r->nmany)
        printf("  %u vertices have no single value, as at poles and where charts end: the first is "
               "%d, of polygon %d\n",
               r->nmany, r->first_many + 1, r->many_poly + 1);
    if (r->nends)
        printf(
            "  %u of these lie where the map ends %g after it begins along %s, which is no whole "
            "number of repetitions: the first is %d, of polygon %d\n",
            r->nends, (double)r->end_apart, r->end_axis ? "v" : "u", r->first_end + 1,
            r->end_poly + 1);
    if (r->nfar)
        printf("  %u polygons have texture coordinates (vt) beyond 65536, which are left as they "
               "are: the first is %d\n",
               r->nfar, r->first_far + 1);
    if (r->nbare)
        printf("  %u polygons have no texture coordinates (vt), which --map makes: the first is "
               "%d\n",
               r->nbare, r->first_bare + 1);
    if (r->nclose)
        printf("  %u vertices at open edges are beside another that is too far away to be welded: "
               "the first is %d, %.2g from %d\n",
               r->nclose, r->first_close + 1, (double)r->close_apart, r->close_to + 1);
}

/* Numbers of vertices and polygons as files count them, 0 where there is none. */
static json_t *report_json(const struct wrap_options *o, const slv_wrap_report *r,
                           uint32_t nbefore) {
    const struct {
        const char *name;
        int64_t value;
    } numbers[] = {
        {"vertices_before", nbefore},
        {"vertices", r->nverts},
        {"welded", r->nwelded},
        {"drawn_before", r->ndrawn_before},
        {"drawn", r->ndrawn},
        {"bytes_saved", ((int64_t)r->ndrawn_before - (int64_t)r->ndrawn) * VERTEX_BYTES},
        {"kept", r->nkept},
        {"first_kept", r->nkept ? r->first_kept + 1 : 0},
        {"close", r->nclose},
        {"first_close", r->nclose ? r->first_close + 1 : 0},
        {"collapsed", r->ncollapsed},
        {"first_collapsed", r->ncollapsed ? r->first_collapsed + 1 : 0},
        {"seam_u", r->nseam[0]},
        {"seam_v", r->nseam[1]},
        {"wide", r->nwide},
        {"first_wide", r->nwide ? r->first_wide + 1 : 0},
        {"many_valued", r->nmany},
        {"first_many_valued", r->nmany ? r->first_many + 1 : 0},
        {"ends", r->nends},
        {"first_end", r->nends ? r->first_end + 1 : 0},
        {"far", r->nfar},
        {"first_far", r->nfar ? r->first_far + 1 : 0},
        {"bare", r->nbare},
        {"first_bare", r->nbare ? r->first_bare + 1 : 0},
    };
    json_t *json = json_pack("{s:i, s:o, s:s}", "schema", 1, "path", output_json_name(o->paths[1]),
                             "round", slv_wrap_round_name(r->round));
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers && json; i++)
        json_object_set_new(json, numbers[i].name, json_integer((json_int_t)numbers[i].value));
    if (json && r->nends) {
        json_object_set_new(json, "end_apart", json_real((double)r->end_apart));
        json_object_set_new(json, "end_axis", json_string(r->end_axis ? "v" : "u"));
    }
    return json;
}

static int run_wrap(const struct wrap_options *o) {
    slv_env env = cli_env(0);
    const slv_wrap_params params = {
        .map = (slv_wrap_map)o->map, .axis = o->axis, .keep_vertices = o->keep};
    cli_progress progress = cli_progress_fleeting("wrap", o->progress, o->quiet || o->json);
    slv_wrap_report report;
    slv_mesh *mesh = NULL, *made = NULL;
    int code = EXIT_FAILED;
    if (output_check(&env, o->paths[1], o->paths, 1) ||
        slv_mesh_load(&env, cli_input(o->paths[0]), &mesh) ||
        !cli_progress_report(&progress, 10, 30) ||
        slv_mesh_wrap(&env, mesh, &params, &report, &made) ||
        !cli_progress_report(&progress, 20, 30))
        goto done;
    if (!slv_mesh_get_view(made)->npolys) {
        (void)output_fail(&env, SLV_ERROR_UNSUPPORTED,
                          "%s: no polygon has vertices at three places, and nothing is left",
                          o->paths[0]);
        goto done;
    }
    cli_catch_interrupts();
    if (slv_mesh_save_obj(&env, made, o->paths[1]))
        goto done;
    cli_progress_report(&progress, 30, 30);
    cli_progress_end(&progress);
    uint32_t before = slv_mesh_get_view(mesh)->nverts;
    code = EXIT_OK;
    if (o->json)
        code = output_print_json(o->paths[1], report_json(o, &report, before));
    else if (!o->quiet) {
        output_terminal(stdout, o->paths[1], strlen(o->paths[1]), SIZE_MAX);
        printf(": %u vertices of %u, %u duplicates welded\n"
               "  as drawn, one for each texture coordinate: %u of %u, %" PRId64
               " bytes saved at %d each\n"
               "  %u polygons go over the end of u, %u over that of v: ",
               report.nverts, before, report.nwelded, report.ndrawn, report.ndrawn_before,
               ((int64_t)report.ndrawn_before - (int64_t)report.ndrawn) * VERTEX_BYTES,
               VERTEX_BYTES, report.nseam[0], report.nseam[1]);
        if (report.round)
            printf("draw it with --round %s\n", slv_wrap_round_name(report.round));
        else
            printf("it does not go round, or has one value a vertex already\n");
        print_limits(&report);
    }
done:
    cli_progress_end(&progress);
    slv_mesh_destroy(made);
    slv_mesh_destroy(mesh);
    return code;
}

int verb_wrap(int argc, char **argv) {
    struct wrap_options o = {.axis = 1};
    uint32_t narguments = 0;
    const cli_option options[] = {
        CLI_OUT(&o.paths[1], "the file to write", "OUT.obj"),
        {"--map", CLI_CHOICE, &o.map,
         "the mesh's own coordinates, or new ones: around an axis, a torus, from pole to pole "
         "(keep)",
         "keep|cylinder|torus|sphere", 0, 0, NULL},
        {"--axis", CLI_CHOICE, &o.axis, "what new ones go around, through the middle (y)", "x|y|z",
         0, 0, &o.axis_given},
        {"--keep-vertices", CLI_FLAG, &o.keep, "weld nothing", NULL, 0, 0, NULL},
        CLI_JSON(&o.json),
        CLI_PROGRESS(&o.progress),
        CLI_QUIET(&o.quiet, "print nothing on success"),
    };
    const cli_command command = {
        .name = "wrap",
        .summary = "texture coordinates that go round with one value a vertex",
        .arguments = "MESH.obj OUT.obj|-o OUT.obj",
        .reads = "a mesh, OBJ or PLY",
        .writes = "the mesh with one texture coordinate a vertex, without duplicated vertices",
        .examples = "  selvage wrap vase.obj round.obj\n"
                    "  selvage wrap tube.obj round.obj --map cylinder --axis z\n",
        CLI_TAKES(options, 1, 1, o.paths, &narguments),
        .output = &o.paths[1],
        .output_needed = true};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (o.axis_given && o.map == 0)
        return cli_usage(&command,
                         "--axis: the mesh's own coordinates have none; --map is missing");
    if (!cli_ends_with(o.paths[1], ".obj"))
        return cli_usage(&command, "%s: the name of what is written must end in .obj", o.paths[1]);
    return run_wrap(&o);
}
