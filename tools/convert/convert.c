/* The verb convert: its options, and what it prints of what was done. */
#include "command/output.h"
#include "command/ptx_name.h"
#include "command/salvage.h"
#include "convert/convert_options.h"
#include "verbs.h"

#include <ctype.h>
#include <string.h>
#include <sys/stat.h>

static bool is_folder(const char *path) {
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

/* A new folder of a name with an ending is hardly meant: it is that of a picture of a kind that is
 * not written. */
static bool may_be_folder(const char *path) {
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path,
               *dot = strrchr(base, '.');
    size_t length = dot ? strlen(dot + 1) : 0;
    if (strcmp(path, "-") == 0)
        return false;
    if (length < 2 || length > 5 || dot == base || is_folder(path))
        return true;
    for (const char *c = dot + 1; *c; c++)
        if (!isalnum((unsigned char)*c))
            return true;
    return !isalpha((unsigned char)dot[1]);
}

typedef struct conversion {
    const convert_options *options;
    const char *const *paths; /* from, to */
    slv_exchange_stats stats;
    cli_progress progress, writing;
    uint64_t written; /* rows of the sheet that is being written */
} conversion;

static json_t *convert_json(const conversion *c, const char *made) {
    const slv_exchange_stats *stats = &c->stats;
    const slv_ptx_writer_params *wrote = &stats->wrote;
    const char *const *paths = c->paths;
    bool folder = is_folder(paths[1]);
    return json_pack(
        "{s:i, s:o, s:o, s:s, s:I, s:I, s:s, s:I, s:o, s:I, s:I, s:o, s:I}", "schema", 1, "source",
        output_json_name(paths[0]), "path", output_json_name(paths[1]), "made", made, "faces",
        (json_int_t)stats->faces, "resized_faces", (json_int_t)stats->resized, "data_type",
        slv_type_name(wrote->type), "channels", (json_int_t)wrote->nchannels, "alpha_channel",
        wrote->alpha_channel < 0 ? json_null() : json_integer(wrote->alpha_channel), "texels",
        (json_int_t)stats->texels, "texel_bytes",
        (json_int_t)(stats->texels * wrote->nchannels * slv_type_size(wrote->type)), "file_bytes",
        folder ? json_null() : json_integer((json_int_t)output_file_bytes(paths[1])),
        "clipped_values", (json_int_t)stats->clipped);
}

/* Saving large images takes longer than making them: each shows by itself how far it is. */
static bool report_writing(void *user, uint64_t done, uint64_t total) {
    conversion *c = user;
    const convert_options *o = c->options;
    if (done <= c->written || !c->written) {
        cli_progress_end(c->written ? &c->writing : &c->progress);
        c->writing = cli_progress_fleeting("writing", o->progress, o->quiet || o->json);
    }
    c->written = done;
    return cli_progress_report(&c->writing, done, total);
}

static int run_convert(const cli_command *command, conversion *c) {
    const convert_options *o = c->options;
    const char *from = c->paths[0], *to = c->paths[1];
    slv_env env = cli_env(o->threads);
    slv_exchange *source = NULL;
    slv_ptx *ptx = NULL; /* for salvage */
    slv_mesh *mesh = NULL;
    convert_request request = {.source = NULL};
    int code = EXIT_FAILED;
    slv_result result;
    bool to_ptx = ptx_name_is_safe(to), to_sheet = slv_image_format_of_name(to) != SLV_IMAGE_NONE;
    c->progress = cli_progress_fleeting("convert", o->progress, o->quiet || o->json);
    const char *const inputs[] = {from, o->mesh};
    if ((to_ptx ? output_check_in_place(&env, to, inputs, 2)
                : output_check_inputs(&env, to, inputs, 1)) ||
        (to_ptx || to_sheet ? output_try(&env, to) : output_try_folder(&env, to)))
        goto done;
    if (o->mesh && slv_mesh_load(&env, cli_input(o->mesh), &mesh))
        goto done;
    cli_catch_interrupts();
    if (!to_ptx && slv_exchange_is_index(from)) {
        code = cli_usage(command, "from images only a .ptx can be made, not '%s'", to);
        goto done;
    }
    if (o->salvage && !slv_exchange_is_index(from)) {
        if (salvage_open(&env, from, true, &ptx) || slv_exchange_open_ptx(&env, ptx, &source))
            goto done;
    } else if (slv_exchange_open(&env, from, &source)) {
        goto done;
    }
    if (slv_exchange_is_index(from))
        convert_warn_of_index(&env, from, is_folder(from));
    if ((code = convert_request_make(command, o, slv_exchange_get_params(source), &request)))
        goto done;
    request.params.mesh = mesh;
    request.params.progress = (slv_progress){cli_progress_report, &c->progress};
    request.params.sheet_progress = (slv_progress){report_writing, c};
    result = to_ptx     ? slv_exchange_to_ptx(&env, source, &request.params, to, &c->stats)
             : to_sheet ? slv_exchange_to_sheet(&env, source, &request.params, to, &c->stats)
                        : slv_exchange_to_folder(&env, source, &request.params, to, &c->stats);
    code = result ? EXIT_FAILED : EXIT_OK;
done:
    cli_progress_end(c->written ? &c->writing : &c->progress);
    if (!code && o->json)
        code = output_print_json(to, convert_json(c, to_ptx     ? "ptx"
                                                     : to_sheet ? "sheet"
                                                                : "folder"));
    if (!code && ptx)
        code = salvage_tell(ptx);
    convert_request_free(&request);
    slv_mesh_destroy(mesh);
    slv_exchange_close(source);
    slv_ptx_close(ptx);
    return code;
}

/* More than 80 lines because its table has a row for each option, and reads best in one piece. */
int verb_convert(int argc, char **argv) {
    convert_options o = {0};
    const char *paths[2] = {NULL, NULL};
    uint32_t narguments = 0;
    const cli_option options[] = {
        CLI_OUT(&paths[1], "what to write", "OUT"),
        CLI_TYPE(&o.type, "data type (the source's)", &o.type_given),
        {"--channels|--channel|-c", CLI_TEXT, &o.channels,
         "channels of the result, each one of the source's by name or number, or a value: b,g,r "
         "or 0-2,=1",
         "LIST", 0, 0, NULL},
        {"--alpha", CLI_TEXT, &o.alpha,
         "which channel of the result is alpha, by name or number, or none", "N", 0, 0, NULL},
        {"--premultiply", CLI_FLAG, &o.premultiply, "multiply colours by alpha", NULL, 0, 0, NULL},
        {"--unmultiply", CLI_FLAG, &o.unmultiply, "divide colours by alpha", NULL, 0, 0, NULL},
        {"--faces|-f", CLI_TEXT, &o.faces,
         "these only, renumbered from 0, with their part of the geometry: 12,40-60", "LIST", 0, 0,
         NULL},
        {"--scale", CLI_TEXT, &o.scale, "resize every face: 2, 1/2 or 0.5, 1/8", "X", 0, 0, NULL},
        {"--max", CLI_SIZE, o.max, "no face larger than this", NULL, 1, 1u << SLV_MAX_LOG2_RES,
         &o.max_given},
        {"--min", CLI_SIZE, o.min, "no face smaller than this", NULL, 1, 1u << SLV_MAX_LOG2_RES,
         &o.min_given},
        {"--res", CLI_TEXT, &o.res, "sizes of single faces: 12=64x64,13-20=8", "LIST", 0, 0, NULL},
        {"--border", CLI_CHOICE, &o.border, "border mode in u and v", names_borders(), 0, 0,
         &o.border_given},
        {"--border-u", CLI_CHOICE, &o.border_u, "border mode in u", names_borders(), 0, 0,
         &o.border_u_given},
        {"--border-v", CLI_CHOICE, &o.border_v, "border mode in v", names_borders(), 0, 0,
         &o.border_v_given},
        {"--edge-filter", CLI_CHOICE, &o.edge_filter, "edge filter mode", names_edge_filters(), 0,
         0, &o.edge_filter_given},
        CLI_REDUCTIONS(&o.reductions, "store reductions (plain)", &o.reductions_given),
        {"--no-reductions", CLI_FLAG, &o.no_reductions, "store none", NULL, 0, 0, NULL},
        CLI_COMPRESSION(&o.compression),
        CLI_SALVAGE(&o.salvage),
        CLI_TEXTURE_ENCODING(&o.encoding),
        {"--no-meta", CLI_FLAG, &o.no_meta, "leave metadata out", NULL, 0, 0, NULL},
        {"--mesh|-m", CLI_TEXT, &o.mesh,
         "control mesh whose geometry and adjacency go into OUT.ptx", "FILE.obj", 0, 0, NULL},
        {"--format", CLI_CHOICE, &o.format, "of a folder's images (png, or exr for half and float)",
         "png|exr", 0, 0, &o.format_given},
        {"--json", CLI_FLAG, &o.json, "print what was done as JSON", NULL, 0, 0, NULL},
        CLI_PROGRESS(&o.progress),
        CLI_THREADS(&o.threads),
        CLI_QUIET(&o.quiet, "no progress on a terminal either"),
    };
    const cli_command command = {
        .name = "convert",
        .summary = "change type, channels or size of a .ptx; images in and out",
        .arguments = "IN.ptx|FOLDER|INDEX.json OUT.ptx|FOLDER|SHEET.png|SHEET.exr|-o OUT",
        .reads = "a texture, or images with their index; a mesh if it is named",
        .writes = "a texture; or images with their index: a folder, or a sheet, PNG or EXR",
        .examples =
            "  selvage convert teapot.ptx small.ptx --scale 1/2 --max 64 --type half\n"
            "  selvage convert rgba.ptx bgr.ptx --channels 2,1,0\n"
            "  selvage convert rgb.ptx rgba.ptx --channels 0,1,2,=1 --alpha 3\n"
            "  selvage convert teapot.ptx faces/ && selvage convert faces/ again.ptx\n"
            "  selvage convert teapot.ptx sheet.exr && selvage convert sheet.json again.ptx\n",
        CLI_TAKES(options, 1, 1, paths, &narguments),
        .output = &paths[1],
        .output_needed = true};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (o.premultiply && o.unmultiply)
        return cli_usage(&command, "--premultiply and --unmultiply contradict each other");
    if (o.reductions_given && o.no_reductions)
        return cli_usage(&command, "--reductions and --no-reductions contradict each other");
    if (o.mesh && !ptx_name_is_safe(paths[1]))
        return cli_usage(&command, "--mesh: only a .ptx holds geometry");
    bool to_ptx = ptx_name_is_safe(paths[1]),
         to_sheet = slv_image_format_of_name(paths[1]) != SLV_IMAGE_NONE;
    if (o.format_given && (to_ptx || to_sheet))
        return cli_usage(&command, "--format: only for a folder of images, not '%s'", paths[1]);
    if (o.reductions && !to_ptx)
        return cli_usage(&command, "--reductions: only a .ptx has any, not '%s'", paths[1]);
    if (o.compression && !to_ptx)
        return cli_usage(&command, "--compression: only for a .ptx, not '%s'", paths[1]);
    if (!to_ptx && !to_sheet && !may_be_folder(paths[1]))
        return cli_usage(&command,
                         "'%s': expected a folder, .ptx, .png or .exr; if it is to be a folder, "
                         "write '%s/'",
                         paths[1], paths[1]);
    conversion c = {.options = &o, .paths = paths};
    return run_convert(&command, &c);
}
