/* The verb unbake: a texture back as UV images. */
#include "command/output.h"
#include "command/salvage.h"
#include "verbs.h"

#include <selvage/bake.h>

#include <string.h>

struct unbake_options {
    const char *paths[2], *mesh;
    uint32_t size[2], threads, bits;
    bool json, progress, quiet, salvage, scheme_given;
    int filter, encoding, normals, scheme, round;
};

static int print_result(const struct unbake_options *o, const slv_unbake_report *r) {
    if (o->json)
        return output_print_json(
            o->paths[1], json_pack("{s:i, s:o, s:I, s:I, s:I, s:I, s:I, s:I}", "schema", 1, "path",
                                   output_json_name(o->paths[1]), "images", (json_int_t)r->images,
                                   "width", (json_int_t)r->width, "height", (json_int_t)r->height,
                                   "inside", (json_int_t)r->inside, "shared", (json_int_t)r->shared,
                                   "faces_without", (json_int_t)r->without));
    if (o->quiet)
        return EXIT_OK;
    output_terminal(stdout, o->paths[1], strlen(o->paths[1]), SIZE_MAX);
    printf(": %u image%s of %ux%u, %llu pixels inside of islands\n", r->images,
           r->images == 1 ? "" : "s", r->width, r->height, (unsigned long long)r->inside);
    return EXIT_OK;
}

static void warn(const struct unbake_options *o, const slv_unbake_report *r) {
    if (r->without)
        cli_warning("%s: %u faces have no texture coordinates, and are in no image", o->mesh,
                    r->without);
    if (r->shared)
        cli_warning("%s: texture coordinates overlap in %llu pixels, where the face of the lower "
                    "number shows",
                    o->mesh, (unsigned long long)r->shared);
}

static int run_unbake(const struct unbake_options *o) {
    slv_env env = cli_env(o->threads);
    slv_ptx *ptx = NULL;
    slv_mesh *mesh = NULL;
    slv_unbake_report report;
    int code = EXIT_FAILED;
    cli_progress progress = cli_progress_fleeting("unbake", o->progress, o->quiet || o->json);
    const slv_unbake_params params = {.width = o->size[0],
                                      .height = o->size[1],
                                      .bits = o->bits,
                                      .filter = (slv_filter)o->filter,
                                      .encoding = (slv_texture_encoding)o->encoding,
                                      .normals = (slv_unbake_normals)o->normals,
                                      .scheme = (slv_scheme)o->scheme,
                                      .round_u = o->round & 1,
                                      .round_v = o->round >> 1 & 1,
                                      .progress = {cli_progress_report, &progress}};
    const char *const inputs[] = {o->paths[0], o->mesh};
    if (output_check(&env, o->paths[1], inputs, 2))
        return code;
    cli_catch_interrupts();
    if (!salvage_open(&env, o->paths[0], o->salvage, &ptx) &&
        !slv_mesh_load(&env, cli_input(o->mesh), &mesh)) {
        slv_result result = slv_unbake(&env, ptx, mesh, &params, o->paths[1], &report);
        cli_progress_end(&progress);
        if (!result) {
            warn(o, &report);
            code = print_result(o, &report);
            if (!report.inside)
                code = cli_error("%s: is written, but no face of %s has the middle of a pixel",
                                 o->paths[1], o->mesh);
            if (salvage_tell(ptx))
                code = EXIT_FAILED;
        }
    }
    slv_mesh_destroy(mesh);
    slv_ptx_close(ptx);
    return code;
}

int verb_unbake(int argc, char **argv) {
    struct unbake_options o = {.filter = SLV_FILTER_BILINEAR};
    uint32_t narguments = 0;
    const cli_option options[] = {
        CLI_OUT(&o.paths[1], "the image to write, or the images of a set, <UDIM> in the name",
                "OUT.png|OUT.exr"),
        {"--mesh|-m", CLI_TEXT, &o.mesh, "the mesh, with the texture coordinates", "FILE.obj", 0, 0,
         NULL},
        {"--size", CLI_SIZE, o.size,
         "pixels of each image (a power of two, about as dense as the texture)", "1024x1024", 1,
         32768, NULL},
        {"--bits", CLI_UINT, &o.bits, "PNG 8 or 16, EXR 16 or 32 (what the texture's type needs)",
         NULL, 8, 32, NULL},
        {"--filter", CLI_CHOICE, &o.filter, "how texels are looked up (bilinear)", names_filters(),
         0, 0, NULL},
        CLI_TEXTURE_ENCODING(&o.encoding),
        {"--tangent", CLI_CHOICE, &o.normals,
         "what the texture holds becomes a normal map in MikkTSpace's frame (values: it does not)",
         names_unbake_normals(), 0, 0, NULL},
        {"--scheme", CLI_CHOICE, &o.scheme,
         "the surface that --tangent face-normal was baked for (catmark)", names_schemes(), 0, 0,
         &o.scheme_given},
        {"--round", CLI_CHOICE, &o.round,
         "texture coordinates that go round, one value a vertex (selvage wrap)", names_rounds(), 0,
         0, NULL},
        CLI_SALVAGE(&o.salvage),
        CLI_JSON(&o.json),
        CLI_PROGRESS(&o.progress),
        CLI_THREADS(&o.threads),
        CLI_QUIET(&o.quiet, "print nothing on success"),
    };
    const cli_command command = {
        .name = "unbake",
        .summary = "a texture back as UV images",
        .arguments = "IN.ptx OUT.png|-o OUT.png --mesh MESH.obj",
        .reads = "a texture of quads, and its mesh with texture coordinates",
        .writes = "a PNG or EXR image, or one for each tile of a set",
        .examples =
            "  selvage unbake cow.ptx --mesh cow.obj -o cow.png\n"
            "  selvage unbake cow.ptx --mesh cow.obj -o 'colour.<UDIM>.exr' --size 4096\n"
            "  selvage unbake normals.ptx --mesh cow.obj --tangent object-normal -o map.png\n",
        CLI_TAKES(options, 1, 1, o.paths, &narguments),
        .output = &o.paths[1],
        .output_needed = true};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (!o.mesh)
        return cli_usage(&command, "--mesh is missing: what is inside of a .ptx has no texture "
                                   "coordinates");
    if (slv_image_format_of_name(o.paths[1]) == SLV_IMAGE_NONE)
        return cli_usage(&command, "%s: images are written as .png or .exr", o.paths[1]);
    if (o.scheme_given && o.normals != SLV_UNBAKE_FACE_NORMALS)
        return cli_usage(&command, "--scheme: goes with --tangent face-normal");
    if (o.round && (o.normals || strstr(o.paths[1], SLV_BAKE_UDIM)))
        return cli_usage(&command, "--round: goes with one image, no set of tiles, and without "
                                   "--tangent");
    if (o.bits && o.bits != 8 && o.bits != 16 && o.bits != 32)
        return cli_usage(&command, "--bits: 8, 16 or 32");
    if (CLI_STANDARD_ONCE(&command, o.paths[0], o.mesh))
        return EXIT_USAGE;
    return run_unbake(&o);
}
