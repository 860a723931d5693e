/* The verb bake: a texture out of images, rays, a detailed mesh, the surface or patterns. */
#include "command/numbers.h"
#include "command/output.h"
#include "command/ptx_name.h"
#include "verbs.h"

#include <selvage/bake.h>

#include <string.h>

struct bake_options {
    const char *paths[2], *uv, *detail, *bytes, *texels, *miss_map;
    uint32_t size[2], min[2], max[2], compression, threads;
    float density, match, max_miss, error, frequency, distance, front, back;
    uint32_t seed, samples;
    bool size_given, max_given, density_given, match_given, error_given, type_given, pattern_given;
    bool surface_given, rays_given, detail_kind_given, front_given, back_given;
    bool no_reductions, reductions_given, json, progress, quiet;
    int type, scheme, encoding, wrap, pattern, surface, rays, detail_kind, reductions;
};

static void print_misses(FILE *stream, const slv_bake_report *report) {
    const char *between = "";
    for (int i = 1; i < SLV_BAKE_MISSES; i++)
        if (report->misses[i]) {
            fprintf(stream, "%s%s %llu", between, slv_bake_miss_name((slv_bake_miss)i),
                    (unsigned long long)report->misses[i]);
            between = ", ";
        }
}

static uint64_t missing(const slv_bake_report *report) {
    return report->texels - report->misses[SLV_BAKE_HIT];
}

static void print_result(const struct bake_options *o, const slv_bake_report *report,
                         const slv_bake_source *source) {
    uint32_t ntiles = 0;
    const slv_bake_tile *tiles = slv_bake_source_tiles(source, &ntiles);
    output_terminal(stdout, o->paths[1], strlen(o->paths[1]), SIZE_MAX);
    printf(": %llu faces (%llu constant), %u channels of %s, %llu texels, %.4g MiB unpacked\n"
           "  faces of %ux%u to %ux%u texels\n",
           (unsigned long long)report->faces, (unsigned long long)report->constant_faces,
           slv_bake_source_get_desc(source)->nchannels, slv_type_name(report->type),
           (unsigned long long)report->texels, (double)report->bytes / 1048576,
           1u << report->smallest.u, 1u << report->smallest.v, 1u << report->largest.u,
           1u << report->largest.v);
    if (o->error_given)
        printf("  within %.4g of the source at samples, %.4g between them\n", (double)report->error,
               (double)report->error_bound);
    if (report->faces_over)
        printf("  %llu faces are not within %g even with a texel for each pixel\n",
               (unsigned long long)report->faces_over, (double)o->error);
    for (uint32_t i = 0; i < ntiles; i++)
        if (tiles[i].number && tiles[i].width)
            printf("  tile %u: %ux%u, %u faces\n", tiles[i].number, tiles[i].width, tiles[i].height,
                   tiles[i].faces);
    if (missing(report)) {
        printf("  without a value: ");
        print_misses(stdout, report);
        putchar('\n');
    }
}

static json_t *bake_json(const struct bake_options *o, const slv_bake_report *report,
                         const slv_bake_source *source) {
    json_t *misses = json_object(), *list = json_array();
    uint32_t ntiles = 0;
    const slv_bake_tile *tiles = slv_bake_source_tiles(source, &ntiles);
    for (int i = 1; i < SLV_BAKE_MISSES; i++)
        json_object_set_new(misses, slv_bake_miss_name((slv_bake_miss)i),
                            json_integer((json_int_t)report->misses[i]));
    for (uint32_t i = 0; i < ntiles; i++)
        json_array_append_new(
            list, json_pack("{s:o, s:I, s:I, s:I}", "tile",
                            tiles[i].number ? json_integer(tiles[i].number) : json_null(), "width",
                            (json_int_t)tiles[i].width, "height", (json_int_t)tiles[i].height,
                            "faces", (json_int_t)tiles[i].faces));
    return json_pack(
        "{s:i, s:o, s:I, s:I, s:I, s:s, s:s, s:I, s:I, s:[i,i], s:[i,i], s:I, s:o, "
        "s:o, s:o, s:o, s:o}",
        "schema", 1, "path", output_json_text(o->paths[1], strlen(o->paths[1])), "faces",
        (json_int_t)report->faces, "constant_faces", (json_int_t)report->constant_faces, "channels",
        (json_int_t)slv_bake_source_get_desc(source)->nchannels, "type",
        slv_type_name(report->type), "encoding", slv_texture_encoding_name(report->encoding),
        "texels", (json_int_t)report->texels, "bytes", (json_int_t)report->bytes, "smallest",
        1 << report->smallest.u, 1 << report->smallest.v, "largest", 1 << report->largest.u,
        1 << report->largest.v, "missing", (json_int_t)missing(report), "misses", misses, "tiles",
        list, "error", o->error_given ? output_json_number((double)report->error) : json_null(),
        "error_bound",
        o->error_given ? output_json_number((double)report->error_bound) : json_null(),
        "faces_over", o->error_given ? json_integer((json_int_t)report->faces_over) : json_null());
}

/* Says that more texels than may have no value. */
static int judge(const struct bake_options *o, const slv_bake_report *report) {
    if (!((double)missing(report) > (double)o->max_miss * (double)report->texels))
        return EXIT_OK;
    char text[256] = "";
    size_t used = 0;
    for (int i = 1; i < SLV_BAKE_MISSES; i++)
        if (report->misses[i])
            used += (size_t)snprintf(text + used, sizeof text - used, "%s%s %llu", used ? ", " : "",
                                     slv_bake_miss_name((slv_bake_miss)i),
                                     (unsigned long long)report->misses[i]);
    return cli_error("%s: is written, but %llu of %llu texels have no value (%s), more than "
                     "--max-miss %g; --miss-map shows where",
                     o->paths[1], (unsigned long long)missing(report),
                     (unsigned long long)report->texels, text, (double)o->max_miss);
}

static slv_result open_detail(const slv_env *env, const struct bake_options *o,
                              const slv_mesh *mesh, const slv_surface *surface,
                              slv_bake_source **source) {
    const slv_bake_detail detail = {.kind = (slv_bake_detail_kind)o->detail_kind,
                                    .front = o->front,
                                    .back = o->back,
                                    .samples = o->samples};
    slv_mesh *detailed = NULL;
    slv_result result = slv_mesh_load(env, cli_input(o->detail), &detailed);
    if (!result)
        result = slv_bake_from_detail(env, mesh, surface, detailed, &detail, source);
    slv_mesh_destroy(detailed);
    return result;
}

static slv_result open_source(const slv_env *env, const struct bake_options *o,
                              const slv_mesh *mesh, slv_surface **surface,
                              slv_bake_source **source) {
    const slv_surface_params how = {.scheme = (slv_scheme)o->scheme};
    const slv_bake_uv uv = {.encoding = (slv_texture_encoding)o->encoding,
                            .wrap = (slv_bake_wrap)o->wrap};
    const slv_bake_rays rays = {.kind = (slv_bake_rays_kind)o->rays,
                                .samples = o->samples,
                                .distance = o->distance,
                                .seed = o->seed};
    const slv_procedural pattern = {
        .pattern = (slv_pattern)o->pattern, .frequency = o->frequency, .seed = o->seed};
    if (o->uv)
        return slv_bake_from_uv(env, mesh, o->uv, &uv, source);
    slv_result result = slv_surface_create(env, mesh, &how, surface);
    if (result)
        return result;
    if (o->detail)
        return open_detail(env, o, mesh, *surface, source);
    if (o->rays_given)
        return slv_bake_from_rays(env, mesh, *surface, &rays, source);
    if (o->surface_given)
        return slv_bake_from_surface(env, *surface, (slv_bake_surface_kind)o->surface, source);
    return slv_bake_from_pattern(env, *surface, &pattern, source);
}

static int run_bake(const struct bake_options *o, slv_bake_job *job) {
    slv_env env = cli_env(o->threads);
    slv_mesh *mesh = NULL;
    slv_surface *surface = NULL;
    slv_bake_source *source = NULL;
    slv_bake_report report;
    int code = EXIT_FAILED;
    cli_progress progress = cli_progress_fleeting("bake", o->progress, o->quiet || o->json);
    const char *const inputs[] = {o->paths[0], o->uv, o->detail};
    job->progress = (slv_progress){cli_progress_report, &progress};
    if (output_check(&env, o->paths[1], inputs, 3) ||
        (o->miss_map && output_check(&env, o->miss_map, inputs, 3)))
        return code;
    if (o->miss_map && strcmp(o->miss_map, o->paths[1]) == 0)
        return cli_error("%s: is named for the texture and for the miss map", o->miss_map);
    cli_catch_interrupts();
    if (!slv_mesh_load(&env, cli_input(o->paths[0]), &mesh) &&
        !open_source(&env, o, mesh, &surface, &source)) {
        slv_result result = slv_bake_save(&env, mesh, source, job, o->paths[1], &report);
        cli_progress_end(&progress);
        if (!result) {
            code = judge(o, &report);
            if (o->json && output_print_json(o->paths[1], bake_json(o, &report, source)))
                code = EXIT_FAILED;
            else if (!o->json && !o->quiet)
                print_result(o, &report, source);
        }
    }
    slv_bake_source_destroy(source);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    return code;
}

static int make_job(const cli_command *command, struct bake_options *o, slv_bake_job *job) {
    uint64_t count = 0;
    if ((o->uv != NULL) + o->pattern_given + o->rays_given + o->surface_given +
            (o->detail != NULL) !=
        1)
        return cli_usage(command, "--uv IMAGE, --rays, --detail MESH, --surface or --pattern: one "
                                  "of them says what is baked");
    if (o->detail_kind_given && !o->detail)
        return cli_usage(command, "--detail-kind: --detail MESH is missing");
    if ((o->front_given && !(o->front > 0)) || (o->back_given && !(o->back > 0)) ||
        !(o->distance >= 0))
        return cli_usage(command, "--front, --back and --distance: expected more than 0");
    if (cli_both_standard(o->paths[0], o->detail))
        return cli_usage(command, "both meshes are the standard input, which is one");
    if (o->size_given + o->density_given + o->match_given + o->error_given + (o->bytes != NULL) +
            (o->texels != NULL) >
        1)
        return cli_usage(command, "--size, --density, --match, --error, --bytes and --texels: one "
                                  "of them");
    if (o->size_given && !value_resolution(o->size, &job->res))
        return cli_usage(command, "--size %ux%u: expected powers of two", o->size[0], o->size[1]);
    if (!value_resolution(o->min, &job->min_res) ||
        (o->max_given && !value_resolution(o->max, &job->max_res)))
        return cli_usage(command, "--min-size and --max-size: expected powers of two");
    if ((o->density_given && !(o->density > 0)) || (o->match_given && !(o->match > 0)) ||
        (o->error_given && !(o->error > 0)))
        return cli_usage(command, "--density, --match and --error: expected more than 0");
    if (o->texels && !value_count(o->texels, &job->max_texels))
        return cli_usage(command, "--texels: expected a number, 4M, not '%s'", o->texels);
    if (o->bytes && !value_count(o->bytes, &count))
        return cli_usage(command, "--bytes: expected a number, 64M, not '%s'", o->bytes);
    if (!(o->max_miss >= 0 && o->max_miss <= 1))
        return cli_usage(command, "--max-miss: expected a share, 0 to 1");
    if (o->miss_map && !ptx_name_is_safe(o->miss_map))
        return ptx_name_usage(command, o->miss_map);
    if (!o->uv && o->match_given)
        return cli_usage(command, "--match: only images have a resolution to match");
    job->uniform = o->size_given;
    job->density = o->density;
    job->match = o->match;
    job->max_error = o->error;
    job->max_bytes = count;
    job->type_given = o->type_given;
    job->type = (slv_type)o->type;
    job->scheme = (slv_scheme)o->scheme;
    job->no_reductions = o->no_reductions;
    job->seams_given = o->reductions_given;
    job->seams = (slv_ptx_seams)o->reductions;
    job->compression = (int)o->compression;
    job->miss_map = o->miss_map;
    return -1;
}

/* More than 80 lines, because the table of its options is one piece. */
int verb_bake(int argc, char **argv) {
    struct bake_options o = {.min = {1, 1}};
    slv_bake_job job = {0};
    uint32_t narguments = 0;
    const cli_option options[] = {
        CLI_OUT(&o.paths[1], "the file to write", "OUT.ptx"),
        {"--uv", CLI_TEXT, &o.uv,
         "an image, PNG or EXR, through the mesh's texture coordinates; <UDIM> in its name stands "
         "for the number of a tile",
         "IMAGE", 0, 0, NULL},
        {"--rays", CLI_CHOICE, &o.rays, "what rays find: open sky, where it is, how thick it is",
         names_bake_rays(), 0, 0, &o.rays_given},
        {"--distance", CLI_FLOAT, &o.distance, "what is further away does not count (it all does)",
         "X", 0, 0, NULL},
        {"--detail", CLI_TEXT, &o.detail, "a detailed mesh, along the normals of the surface",
         "HIGH.obj", 0, 0, NULL},
        {"--detail-kind", CLI_CHOICE, &o.detail_kind, "what of it (displacement)",
         names_bake_details(), 0, 0, &o.detail_kind_given},
        {"--front", CLI_FLOAT, &o.front, "how far rays reach outwards (1/20 of the diagonal)", "X",
         0, 0, &o.front_given},
        {"--back", CLI_FLOAT, &o.back, "how far they reach inwards (1/20 of the diagonal)", "X", 0,
         0, &o.back_given},
        {"--samples", CLI_UINT, &o.samples,
         "rays a texel (256); of --detail along each axis, to 16 (2)", NULL, 1, 65536, NULL},
        {"--surface", CLI_CHOICE, &o.surface, "what the surface itself is", names_bake_surfaces(),
         0, 0, &o.surface_given},
        {"--pattern", CLI_CHOICE, &o.pattern, "a pattern in space", names_patterns(), 0, 0,
         &o.pattern_given},
        {"--frequency", CLI_FLOAT, &o.frequency, "of the pattern, periods a unit of length (1)",
         "X", 0, 0, NULL},
        {"--seed", CLI_UINT, &o.seed, "of the pattern, or of the rays (0)", NULL, 0, UINT32_MAX,
         NULL},
        CLI_TEXTURE_ENCODING(&o.encoding),
        {"--wrap", CLI_CHOICE, &o.wrap,
         "beyond an image that is no tile (auto: repeat if texture coordinates leave 0..1, else "
         "clamp)",
         names_wraps(), 0, 0, NULL},
        {"--match", CLI_FLOAT, &o.match,
         "so many texels for a pixel, to the nearest power of two (1)", "X", 0, 0, &o.match_given},
        {"--error", CLI_FLOAT, &o.error,
         "the least resolution of each face within so much of the source: 2/255", "X", 0, 0,
         &o.error_given},
        {"--size", CLI_SIZE, o.size, "every face as large, powers of two; sub-faces half of it",
         "64x64", 1, 65536, &o.size_given},
        {"--density|-d", CLI_FLOAT, &o.density, "texels per unit of length on the surface", "X", 0,
         0, &o.density_given},
        {"--texels", CLI_TEXT, &o.texels, "as dense as keeps within so many texels in all", "N", 0,
         0, NULL},
        {"--bytes", CLI_TEXT, &o.bytes, "as dense as keeps within so many bytes, unpacked", "N", 0,
         0, NULL},
        {"--min-size", CLI_SIZE, o.min, "no face smaller (1x1)", NULL, 1, 65536, NULL},
        {"--max-size", CLI_SIZE, o.max, "no face larger (4096x4096)", NULL, 1, 65536, &o.max_given},
        CLI_TYPE(&o.type, "data type (the images')", &o.type_given),
        {"--max-miss", CLI_FLOAT, &o.max_miss,
         "the share of texels that may have no value before the exit code is 1 (0)", "X", 0, 0,
         NULL},
        {"--miss-map", CLI_TEXT, &o.miss_map, "write a texture that shows which have none, and why",
         "FILE.ptx", 0, 0, NULL},
        {"--scheme", CLI_CHOICE, &o.scheme, "subdivision scheme of the surface (catmark)",
         names_schemes(), 0, 0, NULL},
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
        .summary = "a texture out of UV images, rays, a detailed mesh or patterns",
        .arguments = "MESH.obj OUT.ptx|-o OUT.ptx",
        .reads = "a mesh, OBJ or PLY; an image, the tiles of a set or a detailed mesh",
        .writes = "a texture with the mesh inside",
        .examples = "  selvage bake cow.obj --uv cow.png -o cow.ptx\n"
                    "  selvage bake cow.obj --uv 'colour.<UDIM>.exr' -o cow.ptx --match 2\n"
                    "  selvage bake cow.obj --uv cow.png -o cow.ptx --miss-map why.ptx\n"
                    "  selvage bake cow.obj --rays ao --texels 200k -o occlusion.ptx\n"
                    "  selvage bake cow.obj --detail sculpt.obj --type half -o height.ptx\n"
                    "  selvage bake cow.obj --pattern noise --frequency 8 -o cow.ptx\n",
        .options = options,
        .noptions = sizeof options / sizeof *options,
        .min_arguments = 1,
        .max_arguments = 1,
        .positional = o.paths,
        .npositional = &narguments,
        .output = &o.paths[1],
        .output_needed = true,
        .exits = "0 success; 1 failure, or more texels without a value than --max-miss; 2 wrong "
                 "usage"};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (!ptx_name_is_safe(o.paths[1]))
        return ptx_name_usage(&command, o.paths[1]);
    code = make_job(&command, &o, &job);
    return code >= 0 ? code : run_bake(&o, &job);
}
