/* The verb bake: a texture out of images, rays, a detailed mesh, the surface or patterns. */
#include "bake/bake_options.h"
#include "command/output.h"
#include "command/ptx_name.h"
#include "command/team.h"
#include "verbs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { INPUTS = 256 };

/* Nothing that is read may be written, nor two things be one. */
static int check_outputs(const slv_env *env, const bake_options *o, const slv_bake_recipe *recipe,
                         const char *part) {
    const char *inputs[INPUTS] = {o->paths[0], o->recipe};
    uint32_t n = 2;
    for (uint32_t i = 0; slv_bake_recipe_file(recipe, i) && n < INPUTS; i++)
        inputs[n++] = slv_bake_recipe_file(recipe, i);
    if (output_check(env, o->paths[1], inputs, n) ||
        (o->miss_map && output_check(env, o->miss_map, inputs, n)) ||
        (o->resume && output_check(env, part, inputs, n)))
        return EXIT_FAILED;
    if (o->miss_map && strcmp(o->miss_map, o->paths[1]) == 0)
        return cli_error("%s: is named for the texture and for the miss map", o->miss_map);
    return EXIT_OK;
}

static int bake_it(const bake_options *o, const slv_env *env, slv_bake_recipe *recipe,
                   cli_team *team) {
    slv_bake_job job = *slv_bake_recipe_job(recipe);
    slv_mesh *mesh = NULL;
    slv_bake_source *source = NULL;
    slv_bake_report report;
    slv_bake_view *views = NULL;
    char part[4096], *key = bake_recipe_key(recipe, o);
    int code = EXIT_FAILED;
    bool writes = !team->module || !team->team.rank;
    cli_progress progress =
        cli_progress_fleeting("bake", o->progress && writes, o->quiet || o->json || !writes);
    job.team = team->module ? &team->team : NULL;
    job.miss_map = o->miss_map;
    job.progress = (slv_progress){cli_progress_report, &progress};
    job.resume = o->resume ? part : NULL;
    job.resume_key = key;
    if ((size_t)snprintf(part, sizeof part, "%s.part", o->paths[1]) >= sizeof part)
        code = cli_error("%s: the name is too long", o->paths[1]);
    else if (!key)
        code = cli_error("no memory for the recipe");
    else if (!writes || !check_outputs(env, o, recipe, part)) {
        /* an interrupt while all is read and rays are set up kills: there is nothing to tidy up */
        if (!slv_mesh_load(env, cli_input(o->paths[0]), &mesh) &&
            !bake_views_load(env, slv_bake_recipe_views(recipe), mesh, &views, &job) &&
            !slv_bake_recipe_source(env, recipe, mesh, &source)) {
            if (writes)
                bake_mesh_tell(env, o->paths[0], mesh);
            cli_catch_interrupts();
            slv_result result = slv_bake_save(env, mesh, source, &job, o->paths[1], &report);
            cli_progress_end(&progress);
            team->complete = !result;
            if (!result && !writes)
                code = EXIT_OK;
            else if (!result)
                code = bake_report_tell(o, recipe, &report, source);
        }
    }
    slv_bake_source_destroy(source);
    slv_mesh_destroy(mesh);
    free(views);
    free(key);
    return code;
}

static int run_bake(const cli_command *command, const bake_options *o) {
    cli_team team;
    int started = cli_team_begin(&team);
    if (started >= 0)
        return started;
    slv_env env = cli_team_env(&team, o->threads);
    slv_bake_recipe *recipe = NULL;
    int code = bake_recipe_make(command, &env, o, &recipe);
    if (code < 0 && o->print_recipe)
        code = puts(slv_bake_recipe_text(recipe)) < 0 ? EXIT_FAILED : EXIT_OK;
    if (code < 0)
        code = bake_it(o, &env, recipe, &team);
    slv_bake_recipe_destroy(recipe);
    return cli_team_end(&team, code);
}

/* More than 80 lines, because the table of its options is one piece. */
int verb_bake(int argc, char **argv) {
    bake_options o = {.min = {1, 1}};
    uint32_t narguments = 0;
    const cli_option options[] = {
        CLI_OUT(&o.paths[1], "the file to write", "OUT.ptx"),
        {"--uv", CLI_TEXT, &o.uv,
         "an image, PNG or EXR, through the mesh's texture coordinates; <UDIM> in its name stands "
         "for the number of a tile",
         "IMAGE", 0, 0, NULL},
        {"--vertex-color", CLI_FLAG, &o.vertex_color, "the colours of the mesh's own vertices",
         NULL, 0, 0, NULL},
        {"--texture", CLI_TEXT, &o.texture, "another texture of the mesh, or of --from's", "IN.ptx",
         0, 0, NULL},
        {"--from", CLI_TEXT, &o.from,
         "what is baked lies on this mesh (or the one inside a .ptx), and is carried over",
         "MESH.obj", 0, 0, NULL},
        {"--by", CLI_CHOICE, &o.by, "from --from's nearest place, or along normals (closest)",
         "closest|rays", 0, 0, &o.by_given},
        {"--points", CLI_TEXT, &o.points,
         "a coloured cloud of points, or a coloured scan, what is near the surface", "SCAN.ply", 0,
         0, NULL},
        {"--rays", CLI_CHOICE, &o.rays, "what rays find: open sky, where it is, how thick it is",
         names_bake_rays(), 0, 0, &o.rays_given},
        {"--distance", CLI_FLOAT, &o.distance,
         "what is further away does not count (--rays: it all does; --points and --from: 1/100 of "
         "the diagonal)",
         "X", 0, 0, &o.distance_given},
        {"--detail", CLI_TEXT, &o.detail, "a detailed mesh, along the normals of the surface",
         "HIGH.obj", 0, 0, NULL},
        {"--detail-kind", CLI_CHOICE, &o.detail_kind, "what of it (displacement)",
         names_bake_details(), 0, 0, &o.detail_kind_given},
        {"--front", CLI_FLOAT, &o.front, "how far rays reach outwards (1/20 of the diagonal)", "X",
         0, 0, &o.front_given},
        {"--back", CLI_FLOAT, &o.back, "how far they reach inwards (1/20 of the diagonal)", "X", 0,
         0, &o.back_given},
        {"--cage", CLI_TEXT, &o.cage,
         "a mesh like the first from which rays of --by rays, or for normals of --detail, begin",
         "CAGE.obj", 0, 0, NULL},
        {"--samples", CLI_UINT, &o.samples,
         "rays a texel (256); of --detail along each axis, to 16 (2)", NULL, 1, 65536, NULL},
        {"--surface", CLI_CHOICE, &o.surface, "what the surface itself is", names_bake_surfaces(),
         0, 0, &o.surface_given},
        {"--pattern", CLI_CHOICE, &o.pattern, "a pattern in space", names_patterns(), 0, 0,
         &o.pattern_given},
        {"--frequency", CLI_FLOAT, &o.frequency, "of the pattern, periods a unit of length (1)",
         "X", 0, 0, &o.frequency_given},
        {"--seed", CLI_UINT, &o.seed, "of the pattern, or of the rays (0)", NULL, 0, UINT32_MAX,
         &o.seed_given},
        {"--recipe", CLI_TEXT, &o.recipe,
         "what is baked and how large, as JSON; other options take the place of what it says",
         "FILE.json", 0, 0, NULL},
        {"--print-recipe", CLI_FLAG, &o.print_recipe,
         "print the recipe that the options stand for, and bake nothing", NULL, 0, 0, NULL},
        {"--resume", CLI_FLAG, &o.resume,
         "keep what is baked in OUT.ptx.part until all is, and go on from what is there", NULL, 0,
         0, NULL},
        {"--texture-encoding", CLI_CHOICE, &o.encoding,
         "what colours are (auto: what the file says, else srgb of integers)", names_encodings(), 0,
         0, &o.encoding_given},
        {"--wrap", CLI_CHOICE, &o.wrap,
         "beyond an image that is no tile (auto: repeat if texture coordinates leave 0..1, else "
         "clamp)",
         names_wraps(), 0, 0, &o.wrap_given},
        {"--round", CLI_CHOICE, &o.round,
         "texture coordinates that go round, one value a vertex (selvage wrap)", names_rounds(), 0,
         0, &o.round_given},
        {"--match", CLI_FLOAT, &o.match,
         "so many texels for a pixel, to the nearest power of two (1)", "X", 0, 0, &o.match_given},
        {"--error", CLI_FLOAT, &o.error,
         "the least resolution of each face within so much of the source: 2/255", "X", 0, 0,
         &o.error_given},
        {"--size", CLI_SIZE, o.size, "every face as large, powers of two; sub-faces half of it",
         "64x64", 1, 65536, &o.size_given},
        {"--density|-d", CLI_FLOAT, &o.density, "texels per unit of length on the surface", "X", 0,
         0, &o.density_given},
        {"--views", CLI_TEXT, &o.views,
         "as many texels as faces have pixels in the pictures of a view file's cameras",
         "FILE.json", 0, 0, NULL},
        {"--texels-per-pixel", CLI_FLOAT, &o.texels_per_pixel, "of --views (1)", "X", 0, 0, NULL},
        {"--texels", CLI_TEXT, &o.texels, "as dense as keeps within so many texels in all", "N", 0,
         0, NULL},
        {"--bytes", CLI_TEXT, &o.bytes, "as dense as keeps within so many bytes, unpacked", "N", 0,
         0, NULL},
        {"--least-error", CLI_FLAG, &o.least_error,
         "with --texels or --bytes: not evenly dense, but as near to the source as keeps within",
         NULL, 0, 0, NULL},
        {"--min-size", CLI_SIZE, o.min, "no face smaller (1x1)", NULL, 1, 65536, &o.min_given},
        {"--max-size", CLI_SIZE, o.max, "no face larger (4096x4096)", NULL, 1, 65536, &o.max_given},
        CLI_TYPE(&o.type, "data type (the images')", &o.type_given),
        {"--max-miss", CLI_FLOAT, &o.max_miss,
         "the share of texels that may have no value before the exit code is 1 (0)", "X", 0, 0,
         &o.max_miss_given},
        {"--max-over", CLI_FLOAT, &o.max_over,
         "the share of faces that may stay further from the source than --error before the exit "
         "code is 1 (0)",
         "X", 0, 0, &o.max_over_given},
        {"--miss-map", CLI_TEXT, &o.miss_map, "write a texture that shows which have none, and why",
         "FILE.ptx", 0, 0, NULL},
        {"--scheme", CLI_CHOICE, &o.scheme, "subdivision scheme of the surface (catmark)",
         names_schemes(), 0, 0, &o.scheme_given},
        CLI_REDUCTIONS(&o.reductions,
                       "whether faces agree where they meet, in reductions or in all levels (all, "
                       "where values can be averaged)",
                       &o.reductions_given),
        {"--no-reductions", CLI_FLAG, &o.no_reductions, "store full resolution only", NULL, 0, 0,
         NULL},
        CLI_COMPRESSION(&o.compression),
        CLI_JSON(&o.json),
        CLI_PROGRESS(&o.progress),
        CLI_THREADS(&o.threads),
        CLI_QUIET(&o.quiet, "print nothing on success"),
    };
    const cli_command command = {
        .name = "bake",
        .summary = "a texture out of UV images, rays, other meshes or patterns",
        .arguments = "MESH.obj OUT.ptx|-o OUT.ptx",
        .reads = "a mesh, OBJ or PLY; an image, the tiles of a set or a detailed mesh",
        .writes = "a texture with the mesh inside",
        .examples = "  selvage bake cow.obj --uv cow.png -o cow.ptx\n"
                    "  selvage bake cow.obj --uv 'colour.<UDIM>.exr' -o cow.ptx --match 2\n"
                    "  selvage bake cow.obj --uv cow.png -o cow.ptx --miss-map why.ptx\n"
                    "  selvage bake cow.obj --rays ao --texels 200k -o occlusion.ptx\n"
                    "  selvage bake cow.obj --detail sculpt.obj --type half -o height.ptx\n"
                    "  selvage bake cow.obj --recipe worn.json --density 40 -o cow.ptx\n"
                    "  selvage bake cow.obj --pattern noise --frequency 8 -o cow.ptx\n",
        CLI_TAKES(options, 1, 1, o.paths, &narguments),
        .output = &o.paths[1],
        .output_needed = true,
        .output_spared = &o.print_recipe,
        .exits = "0 success; 1 failure, or more texels without a value than --max-miss, or faces "
                 "further from the source than --max-over; 2 wrong usage"};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (o.paths[1] && !ptx_name_is_safe(o.paths[1]))
        return ptx_name_usage(&command, o.paths[1]);
    return run_bake(&command, &o);
}
