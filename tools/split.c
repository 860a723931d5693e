/* The verb split: one .ptx into the several that were merged, or from given faces on. */
#include "command/lists.h"
#include "command/output.h"
#include "verbs.h"

#include <selvage/exchange.h>

#include <stdlib.h>
#include <string.h>

struct split {
    const char *path, *out, *at;
    bool json, progress, quiet, failed;
    uint32_t compression, threads;
    json_t *parts;
};

/* A part that is written: kept until all are there. */
static void note_part(void *user, const char *name, uint32_t first, uint32_t nfaces) {
    struct split *s = user;
    s->failed |=
        json_array_append_new(
            s->parts, json_pack("{s:o, s:I, s:I}", "name", output_json_text(name, strlen(name)),
                                "first_face", (json_int_t)first, "faces", (json_int_t)nfaces)) != 0;
}

static void print_parts(const struct split *s) {
    for (size_t i = 0; i < json_array_size(s->parts); i++) {
        const json_t *part = json_array_get(s->parts, i);
        const char *name = json_string_value(json_object_get(part, "name"));
        json_int_t first = json_integer_value(json_object_get(part, "first_face")),
                   nfaces = json_integer_value(json_object_get(part, "faces"));
        if (nfaces)
            printf("  faces %lld to %lld: ", (long long)first, (long long)(first + nfaces - 1));
        else
            printf("  no faces: ");
        output_terminal(stdout, name, strlen(name), SIZE_MAX);
        putchar('\n');
    }
}

/* Where parts begin, from a list of faces; 0 may be left out. For free(). */
static int parse_beginnings(const cli_command *command, const struct split *s, uint32_t nfaces,
                            uint32_t **out, uint32_t *count) {
    value_ranges ranges;
    int code = value_faces(command, "--at", s->at, nfaces, &ranges);
    *out = NULL;
    *count = 0;
    if (!code && !(*out = calloc((size_t)ranges.count + 1, sizeof **out)))
        code = cli_error("no memory for %u parts", ranges.count);
    if (!code)
        *count = ranges.list[0].first > 0;
    for (uint32_t i = 0; i < ranges.count && !code; i++) {
        if (ranges.list[i].first != ranges.list[i].last ||
            (*count && ranges.list[i].first <= (*out)[*count - 1]))
            code =
                cli_usage(command, "--at: '%s': expected faces, each after the one before", s->at);
        (*out)[(*count)++] = ranges.list[i].first;
    }
    free(ranges.list);
    return code;
}

/* Whether the file tells of its parts; false with an error line if that cannot be read. */
static bool has_record(const struct split *s, const slv_ptx *ptx) {
    for (uint32_t i = 0; i < slv_ptx_get_info(ptx)->nmeta; i++) {
        const slv_ptx_meta *meta;
        if (slv_ptx_load_meta(ptx, i, &meta))
            return false;
        if (strcmp(meta->key, SLV_PARTS_KEY) == 0)
            return true;
    }
    cli_error("%s: was not made by merge, or has lost the record of its parts: say with --at "
              "where they begin",
              s->path);
    return false;
}

static int run_split(const cli_command *command, struct split *s) {
    slv_env env = cli_env(s->threads);
    cli_progress progress = cli_progress_fleeting("split", s->progress, s->quiet || s->json);
    slv_ptx *ptx = NULL;
    uint32_t *at = NULL, nparts = 0;
    int code = EXIT_FAILED;
    if (output_try_folder(&env, s->out) || slv_ptx_open(&env, s->path, &ptx))
        goto done;
    if (s->at && (code = parse_beginnings(command, s, slv_ptx_get_info(ptx)->nfaces, &at, &nparts)))
        goto done;
    code = EXIT_FAILED;
    if (!s->at && !has_record(s, ptx))
        goto done;
    cli_catch_interrupts();
    const slv_split_params params = {.at = at,
                                     .nparts = nparts,
                                     .compression = (int)s->compression,
                                     .progress = {cli_progress_report, &progress},
                                     .each = note_part,
                                     .user = s};
    if (slv_split(&env, ptx, &params, s->out, NULL))
        goto done;
    cli_progress_end(&progress);
    code = s->failed ? cli_error("%s: no memory to describe it", s->out) : EXIT_OK;
    if (!code && s->json)
        code = output_print_json(s->out, json_pack("{s:i, s:o, s:O}", "schema", 1, "path",
                                                   output_json_name(s->out), "parts", s->parts));
    else if (!code && !s->quiet)
        print_parts(s);
done:
    cli_progress_end(&progress);
    slv_ptx_close(ptx);
    free(at);
    return code;
}

int verb_split(int argc, char **argv) {
    struct split s = {.path = NULL};
    uint32_t narguments = 0;
    const cli_option options[] = {
        CLI_OUT(&s.out, "the folder to write into", "FOLDER"),
        {"--at", CLI_TEXT, &s.at, "where parts begin: 12,40 (as they were merged)", "LIST", 0, 0,
         NULL},
        CLI_COMPRESSION(&s.compression),
        CLI_JSON(&s.json),
        CLI_PROGRESS(&s.progress),
        CLI_THREADS(&s.threads),
        CLI_QUIET(&s.quiet, "print nothing on success"),
    };
    const cli_command command = {.name = "split",
                                 .summary = "take a .ptx apart again: the inverse of merge",
                                 .arguments = "FILE.ptx FOLDER|-o FOLDER",
                                 .reads = "a texture",
                                 .writes = "a folder of textures, all of them or none",
                                 .examples = "  selvage split figure.ptx parts\n"
                                             "  selvage split figure.ptx -o halves --at 320\n",
                                 CLI_TAKES(options, 1, 1, &s.path, &narguments),
                                 .output = &s.out,
                                 .output_needed = true};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    s.parts = json_array();
    code = s.parts ? run_split(&command, &s) : cli_error("out of memory");
    json_decref(s.parts);
    return code;
}
