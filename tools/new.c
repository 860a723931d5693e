/* The verb new: a texture for a mesh that has none. */
#include "command/numbers.h"
#include "command/output.h"
#include "command/ptx_name.h"
#include "command/scene.h"
#include "verbs.h"

#include <selvage/blank.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_CHANNELS = 64 };
#define DEFAULT_FILL "#c0c0c0"

struct new_options {
    const char *paths[2], *fill, *bytes, *texels;
    const char *names; /* of channels, or their number */
    uint32_t size[2], min[2], max[2], channels, alpha, compression, threads;
    float density;
    bool size_given, max_given, density_given, alpha_given, square, json, progress, quiet;
    int type, scheme, encoding;
    float values[MOST_CHANNELS];
};

/* Colours are light and are stored as the texture stores them; a list of as many numbers as there
 * are channels is taken as it stands. */
static bool read_fill(struct new_options *o, bool srgb) {
    float color[4];
    uint32_t n = 0;
    double number = 0;
    for (uint32_t c = 0; c < o->channels; c++)
        o->values[c] = o->alpha_given && c == o->alpha;
    if (!o->fill && o->channels < 3)
        return true;
    if (!o->fill)
        o->fill = DEFAULT_FILL;
    const char *at = o->fill, *end = at;
    for (; n < MOST_CHANNELS && value_ratio(at, &number, &end); at = end + 1) {
        o->values[n++] = (float)number;
        if (*end != ',')
            break;
    }
    if (n && *end == 0 && (n == o->channels || n == 1) && !(n == 3 && srgb)) {
        for (uint32_t c = n; c < o->channels; c++)
            o->values[c] = o->alpha_given && c == o->alpha ? 1 : o->values[0];
        return true;
    }
    if (!value_color(o->fill, color))
        return false;
    for (uint32_t c = 0, k = 0; c < o->channels; c++)
        o->values[c] = o->alpha_given && c == o->alpha ? color[3] : k < 3 ? color[k++] : 0;
    if (srgb)
        slv_texels_encode(o->channels, o->alpha_given ? (int32_t)o->alpha : SLV_NO_ALPHA, o->values,
                          1);
    return true;
}

static void print_result(const struct new_options *o, const slv_blank_stats *stats,
                         uint32_t nfaces) {
    output_terminal(stdout, o->paths[1], strlen(o->paths[1]), SIZE_MAX);
    printf(": %u faces, %u channels of %s, %llu texels, %.4g MiB unpacked\n"
           "  faces of %ux%u to %ux%u texels",
           nfaces, o->channels, slv_type_name((slv_type)o->type), (unsigned long long)stats->texels,
           (double)stats->bytes / 1048576, 1u << stats->smallest.u, 1u << stats->smallest.v,
           1u << stats->largest.u, 1u << stats->largest.v);
    if (stats->density > 0)
        printf(", %.4g texels a unit of length", (double)stats->density);
    if (stats->nlimited)
        printf(", less on %u faces, which have the largest size", stats->nlimited);
    putchar('\n');
}

static json_t *new_json(const struct new_options *o, const slv_blank_stats *stats,
                        uint32_t nfaces) {
    return json_pack("{s:i, s:o, s:I, s:I, s:s, s:I, s:I, s:[i,i], s:[i,i], s:o, s:I}", "schema", 1,
                     "path", output_json_name(o->paths[1]), "faces", (json_int_t)nfaces, "channels",
                     (json_int_t)o->channels, "type", slv_type_name((slv_type)o->type), "texels",
                     (json_int_t)stats->texels, "bytes", (json_int_t)stats->bytes, "smallest",
                     1 << stats->smallest.u, 1 << stats->smallest.v, "largest",
                     1 << stats->largest.u, 1 << stats->largest.v, "density",
                     stats->density > 0 ? output_json_number((double)stats->density) : json_null(),
                     "limited", (json_int_t)stats->nlimited);
}

static int run_new(struct new_options *o, slv_blank_params *params) {
    slv_env env = cli_env(o->threads);
    slv_mesh *mesh = NULL;
    slv_blank_stats stats;
    int code = EXIT_FAILED;
    cli_progress progress = cli_progress_fleeting("new", o->progress, o->quiet || o->json);
    const char *const inputs[] = {o->paths[0]};
    params->progress = (slv_progress){cli_progress_report, &progress};
    if (output_check(&env, o->paths[1], inputs, 1) ||
        slv_mesh_load(&env, cli_input(o->paths[0]), &mesh))
        return code;
    cli_catch_interrupts();
    uint32_t nfaces = slv_mesh_face_count(mesh);
    slv_result result = slv_blank_save(&env, mesh, params, o->paths[1], &stats);
    cli_progress_end(&progress);
    if (!result)
        code = EXIT_OK;
    if (!result && o->json && output_print_json(o->paths[1], new_json(o, &stats, nfaces)))
        code = EXIT_FAILED;
    else if (!result && !o->json && !o->quiet)
        print_result(o, &stats, nfaces);
    slv_mesh_destroy(mesh);
    return code;
}

/* A number, or the letters of colours and alpha, each once: `a` is alpha then. */
static int read_channels(const cli_command *command, struct new_options *o) {
    const char *text = o->names ? o->names : "3", *rest;
    char *end;
    unsigned long count = strtoul(text, &end, 10);
    if (*text >= '0' && *text <= '9' && !*end && count >= 1 && count <= MOST_CHANNELS) {
        o->channels = (uint32_t)count;
        return EXIT_OK;
    }
    o->channels = 0;
    for (rest = text; *rest && strchr("rgbay,", *rest); rest++) {
        if (*rest == ',')
            continue;
        if (strchr(rest + 1, *rest))
            break;
        if (*rest == 'a' && !o->alpha_given) {
            o->alpha = o->channels;
            o->alpha_given = true;
        }
        o->channels++;
    }
    if (*rest || !o->channels)
        return cli_usage(command,
                         "--channels: '%s' is neither a number from 1 to %d nor names such as rgb, "
                         "rgba and y",
                         text, MOST_CHANNELS);
    return EXIT_OK;
}

/* What the options ask for; says what is wrong with them. */
static int make_params(const cli_command *command, struct new_options *o, slv_blank_params *p) {
    uint64_t bytes = 0;
    if (read_channels(command, o))
        return EXIT_USAGE;
    if (o->size_given + o->density_given + (o->bytes != NULL) + (o->texels != NULL) > 1)
        return cli_usage(command, "--size, --density, --bytes and --texels: one of them");
    if (o->size_given && !value_resolution(o->size, &p->res))
        return cli_usage(command, "--size %ux%u: expected powers of two", o->size[0], o->size[1]);
    if (!value_resolution(o->min, &p->min_res) ||
        (o->max_given && !value_resolution(o->max, &p->max_res)))
        return cli_usage(command, "--min-size and --max-size: expected powers of two");
    if (o->max_given && (p->min_res.u > p->max_res.u || p->min_res.v > p->max_res.v))
        return cli_usage(command, "--min-size %ux%u is larger than --max-size %ux%u", o->min[0],
                         o->min[1], o->max[0], o->max[1]);
    if (o->density_given && !(o->density > 0))
        return cli_usage(command, "--density: expected more than 0");
    if (o->texels && !value_count(o->texels, &p->max_texels))
        return cli_usage(command, "--texels: expected a number, 4M, not '%s'", o->texels);
    if (o->bytes && !value_count(o->bytes, &bytes))
        return cli_usage(command, "--bytes: expected a number, 64M, not '%s'", o->bytes);
    if (o->alpha_given && o->alpha >= o->channels)
        return cli_usage(command, "--alpha %u: there are %u channels", o->alpha, o->channels);
    p->uniform = o->size_given;
    p->max_given = o->max_given;
    p->density = o->density;
    p->square = o->square;
    p->type = (slv_type)o->type;
    p->nchannels = o->channels;
    p->alpha_channel = o->alpha_given ? (int32_t)o->alpha + 1 : 0;
    p->encoding = (slv_texture_encoding)o->encoding;
    p->scheme = (slv_scheme)o->scheme;
    p->compression = (int)o->compression;
    p->fill = o->values;
    if (o->bytes) {
        bytes /= o->channels * slv_type_size(p->type);
        p->max_texels = bytes ? bytes : 1;
    }
    slv_texture_encoding encoding = p->encoding ? p->encoding : slv_type_encoding(p->type);
    if (!read_fill(o, encoding == SLV_TEXTURE_SRGB))
        return cli_usage(command, "--fill: expected a colour or a value for each channel, not '%s'",
                         o->fill);
    return -1;
}

int verb_new(int argc, char **argv) {
    struct new_options o = {.min = {1, 1}};
    slv_blank_params params = {0};
    uint32_t narguments = 0;
    const cli_option options[] = {
        CLI_OUT(&o.paths[1], "the file to write", "OUT.ptx"),
        {"--size", CLI_SIZE, o.size, "every face as large, powers of two; sub-faces half of it",
         "64x64", 1, 65536, &o.size_given},
        {"--density|-d", CLI_FLOAT, &o.density, "texels per unit of length on the surface", "X", 0,
         0, &o.density_given},
        {"--texels", CLI_TEXT, &o.texels, "as dense as keeps within so many texels in all (4M)",
         "N", 0, 0, NULL},
        {"--bytes", CLI_TEXT, &o.bytes, "as dense as keeps within so many bytes, unpacked", "N", 0,
         0, NULL},
        {"--min-size", CLI_SIZE, o.min, "no face smaller (1x1)", NULL, 1, 65536, NULL},
        {"--max-size", CLI_SIZE, o.max, "no face larger (4096x4096)", NULL, 1, 65536, &o.max_given},
        {"--square", CLI_FLAG, &o.square, "oblong faces have square textures too", NULL, 0, 0,
         NULL},
        CLI_TYPE(&o.type, "data type (uint8)", NULL),
        {"--channels|-c", CLI_TEXT, &o.names, "how many, or their names: rgb, rgba, y (3)",
         "N|NAMES", 0, 0, NULL},
        {"--alpha", CLI_UINT, &o.alpha, "which channel is alpha, from 0 (none)", NULL, 0,
         MOST_CHANNELS - 1, &o.alpha_given},
        {"--fill", CLI_TEXT, &o.fill,
         "a colour: r,g,b in light, #rrggbb, a name; or a value for each channel (" DEFAULT_FILL
         "; less than three channels: 0)",
         "COLOR", 0, 0, NULL},
        CLI_TEXTURE_ENCODING(&o.encoding),
        {"--scheme", CLI_CHOICE, &o.scheme, "subdivision scheme whose lengths count (catmark)",
         names_schemes(), 0, 0, NULL},
        CLI_COMPRESSION(&o.compression),
        CLI_JSON(&o.json),
        CLI_PROGRESS(&o.progress),
        CLI_THREADS(&o.threads),
        CLI_QUIET(&o.quiet, "print nothing on success"),
    };
    const cli_command command = {
        .name = "new",
        .summary = "a blank texture for a mesh, to paint on",
        .arguments = "MESH.obj OUT.ptx|-o OUT.ptx",
        .reads = "a mesh, OBJ or PLY",
        .writes = "a texture of one colour with the mesh inside",
        .examples = "  selvage new cow.obj cow.ptx\n"
                    "  selvage new cow.obj cow.ptx --density 40 --fill '#c0b090'\n"
                    "  selvage new cow.obj rough.ptx --size 64 --channels 1 --fill 0.5\n"
                    "  selvage new cow.obj height.ptx --bytes 64M --type half --channels 1\n",
        CLI_TAKES(options, 1, 1, o.paths, &narguments),
        .output = &o.paths[1],
        .output_needed = true};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (!ptx_name_is_safe(o.paths[1]))
        return ptx_name_usage(&command, o.paths[1]);
    code = make_params(&command, &o, &params);
    return code >= 0 ? code : run_new(&o, &params);
}
