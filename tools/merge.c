/* The verb merge: several .ptx files into one. */
#include "command/output.h"
#include "command/ptx_name.h"
#include "verbs.h"

#include <selvage/exchange.h>

#include <string.h>

enum { MAX_FILES = 1024 };

struct merge {
    const char *paths[MAX_FILES];
    uint32_t npaths;
    const char *out;
    int type;
    bool type_given, json, progress, quiet, no_reductions;
    uint32_t compression, threads;
    uint32_t first_faces[MAX_FILES + 1];
    slv_exchange_stats stats;
    bool geometry;
};

static json_t *merge_json(const struct merge *m) {
    const slv_ptx_writer_params *wrote = &m->stats.wrote;
    json_t *parts = json_array();
    for (uint32_t i = 0; i < m->npaths; i++)
        if (json_array_append_new(
                parts, json_pack("{s:o, s:I, s:I}", "path", output_json_name(m->paths[i]),
                                 "first_face", (json_int_t)m->first_faces[i], "faces",
                                 (json_int_t)(m->first_faces[i + 1] - m->first_faces[i])))) {
            json_decref(parts);
            return NULL;
        }
    return json_pack("{s:i, s:o, s:I, s:s, s:I, s:I, s:I, s:I, s:I, s:b, s:o}", "schema", 1, "path",
                     output_json_name(m->out), "faces", (json_int_t)wrote->nfaces, "data_type",
                     slv_type_name(wrote->type), "channels", (json_int_t)wrote->nchannels, "texels",
                     (json_int_t)m->stats.texels, "texel_bytes",
                     (json_int_t)(m->stats.texels * wrote->nchannels * slv_type_size(wrote->type)),
                     "file_bytes", (json_int_t)output_file_bytes(m->out), "clipped_values",
                     (json_int_t)m->stats.clipped, "geometry", (int)m->geometry, "parts", parts);
}

static int print_result(const struct merge *m) {
    if (m->json)
        return output_print_json(m->out, merge_json(m));
    if (m->quiet)
        return EXIT_OK;
    for (uint32_t i = 0; i < m->npaths; i++) {
        uint32_t first = m->first_faces[i], end = m->first_faces[i + 1];
        if (first == end)
            printf("  no faces: ");
        else
            printf("  faces %u to %u: ", first, end - 1);
        output_terminal(stdout, cli_shown(m->paths[i]), strlen(cli_shown(m->paths[i])), SIZE_MAX);
        putchar('\n');
    }
    return EXIT_OK;
}

static int run_merge(struct merge *m) {
    slv_env env = cli_env(m->threads);
    cli_progress progress = cli_progress_fleeting("merge", m->progress, m->quiet || m->json);
    const slv_merge_params params = {.changes = (m->type_given ? SLV_EXCHANGE_TYPE : 0) |
                                                (m->no_reductions ? SLV_EXCHANGE_REDUCTIONS : 0),
                                     .type = (slv_type)m->type,
                                     .no_reductions = true,
                                     .compression = (int)m->compression,
                                     .progress = {cli_progress_report, &progress}};
    if (output_check(&env, m->out, m->paths, m->npaths))
        return EXIT_FAILED;
    cli_catch_interrupts();
    slv_result result = slv_merge(&env, m->paths, m->npaths, &params, m->out, m->first_faces,
                                  &m->geometry, &m->stats);
    cli_progress_end(&progress);
    m->first_faces[m->npaths] = m->stats.wrote.nfaces;
    return result ? EXIT_FAILED : print_result(m);
}

int verb_merge(int argc, char **argv) {
    struct merge m = {.out = NULL};
    const cli_option options[] = {
        CLI_OUT(&m.out, "the file to write; as an argument it must not exist yet", "OUT.ptx"),
        CLI_TYPE(&m.type, "data type (one that holds those of all)", &m.type_given),
        {"--no-reductions", CLI_FLAG, &m.no_reductions, "store no reductions", NULL, 0, 0, NULL},
        CLI_COMPRESSION(&m.compression),
        {"--json", CLI_FLAG, &m.json, "print where the faces went as JSON", NULL, 0, 0, NULL},
        CLI_PROGRESS(&m.progress),
        CLI_THREADS(&m.threads),
        CLI_QUIET(&m.quiet, "print nothing on success"),
    };
    const cli_command command = {.name = "merge",
                                 .summary = "join several .ptx files into one",
                                 .arguments = "A.ptx B.ptx ... OUT.ptx|-o OUT.ptx",
                                 .reads = "textures, all of quads or all of triangles",
                                 .writes = "a texture",
                                 .examples =
                                     "  selvage merge body.ptx head.ptx -o figure.ptx\n"
                                     "  selvage merge part*.ptx -o all.ptx --type half --json\n",
                                 CLI_TAKES(options, 1, MAX_FILES, m.paths, &m.npaths),
                                 .output = &m.out,
                                 .output_needed = true,
                                 .output_is_new = true};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (!ptx_name_is_safe(m.out))
        return ptx_name_usage(&command, m.out);
    return run_merge(&m);
}
