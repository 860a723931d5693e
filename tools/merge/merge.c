#include "merge/merge.h"
#include "command/ptx_name.h"
#include "verbs.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

struct part {
    slv_ptx_writer *writer;
    convert_plan plan;
    uint32_t first;
};

static slv_result write_face(void *user, const slv_env *env, uint32_t face,
                             const slv_ptx_face *info, void *texels) {
    const struct part *part = user;
    slv_ptx_face moved = *info;
    const void *values = texels;
    void *own;
    slv_result result = convert_face(env, &part->plan, face, &moved, &values, &own);
    for (int edge = 0; edge < 4; edge++)
        if (moved.adjacency.face[edge] >= 0)
            moved.adjacency.face[edge] += (int32_t)part->first;
    if (!result)
        result = slv_ptx_writer_write_face(part->writer, part->first + face, &moved, values);
    free(own);
    return result;
}

static slv_result write_part(const cli_command *command, const slv_env *env, struct merge *m,
                             uint32_t index) {
    struct part part = {.writer = m->writer, .first = m->first_face[index]};
    convert_options options = {.type = (int)m->target.type, .type_given = true};
    slv_ptx_writer_params source = slv_ptx_writer_params_like(m->files[index]);
    slv_result result = SLV_ERROR_ARGUMENT;
    if (convert_plan_make(command, &options, m->paths[index], &source, &m->totals, &part.plan) ==
        EXIT_OK)
        result = slv_ptx_visit_faces(env, m->files[index], write_face, &part);
    convert_plan_free(&part.plan);
    return result;
}

/* Of two types the one that holds all values of both: integers by their size, else float, which
 * half is enough for beside uint8. */
static slv_type wider(slv_type a, slv_type b) {
    slv_type low = a < b ? a : b, high = a < b ? b : a;
    return low == SLV_TYPE_U16 && high == SLV_TYPE_HALF ? SLV_TYPE_FLOAT : high;
}

static slv_result plan_result(const slv_env *env, struct merge *m) {
    uint64_t nfaces = 0;
    m->target = slv_ptx_writer_params_like(m->files[0]);
    for (uint32_t i = 0; i < m->npaths; i++) {
        slv_ptx_writer_params part = slv_ptx_writer_params_like(m->files[i]);
        if (part.mesh_type != m->target.mesh_type)
            return output_fail(env, SLV_ERROR_MISMATCH, "%s: is of %s, %s is not", m->paths[i],
                               part.mesh_type == SLV_PTX_QUAD ? "quads" : "triangles", m->paths[0]);
        if (part.nchannels != m->target.nchannels || part.alpha_channel != m->target.alpha_channel)
            return output_fail(
                env, SLV_ERROR_MISMATCH,
                "%s: has %u channels and alpha %d, %s has %u and %d: convert it first", m->paths[i],
                part.nchannels, part.alpha_channel, m->paths[0], m->target.nchannels,
                m->target.alpha_channel);
        if (part.border_u != m->target.border_u || part.border_v != m->target.border_v ||
            part.edge_filter != m->target.edge_filter)
            cli_warning("%s: its border modes or edge filter differ: those of %s are taken",
                        m->paths[i], m->paths[0]);
        m->target.type = wider(m->target.type, part.type);
        m->first_face[i] = (uint32_t)nfaces;
        nfaces += part.nfaces;
        if (nfaces > INT32_MAX)
            return output_fail(env, SLV_ERROR_LIMIT, "%s: with it there are more than %d faces",
                               m->paths[i], INT32_MAX);
    }
    m->target.nfaces = (uint32_t)nfaces;
    m->target.no_reductions |= m->no_reductions;
    m->target.compression = (int)m->compression;
    if (m->type_given)
        m->target.type = (slv_type)m->type;
    return SLV_OK;
}

static json_t *merge_json(const struct merge *m) {
    json_t *parts = json_array();
    for (uint32_t i = 0; i < m->npaths; i++)
        if (json_array_append_new(parts,
                                  json_pack("{s:o, s:I, s:I}", "path",
                                            output_json_text(m->paths[i], strlen(m->paths[i])),
                                            "first_face", (json_int_t)m->first_face[i], "faces",
                                            (json_int_t)slv_ptx_get_info(m->files[i])->nfaces))) {
            json_decref(parts);
            return NULL;
        }
    return json_pack(
        "{s:i, s:o, s:I, s:s, s:I, s:I, s:I, s:I, s:I, s:b, s:o}", "schema", 1, "path",
        output_json_text(m->out, strlen(m->out)), "faces", (json_int_t)m->target.nfaces,
        "data_type", slv_type_name(m->target.type), "channels", (json_int_t)m->target.nchannels,
        "texels", (json_int_t)m->totals.texels, "texel_bytes",
        (json_int_t)(m->totals.texels * m->target.nchannels * slv_type_size(m->target.type)),
        "file_bytes", (json_int_t)output_file_bytes(m->out), "clipped_values",
        (json_int_t)m->totals.clipped, "geometry", (int)m->geometry, "parts", parts);
}

static int print_result(const struct merge *m) {
    if (m->json)
        return output_print_json(m->out, merge_json(m));
    if (m->quiet)
        return EXIT_OK;
    for (uint32_t i = 0; i < m->npaths; i++) {
        printf("  faces %u to %u: ", m->first_face[i],
               m->first_face[i] + slv_ptx_get_info(m->files[i])->nfaces - 1);
        output_terminal(stdout, m->paths[i], strlen(m->paths[i]), SIZE_MAX);
        putchar('\n');
    }
    return EXIT_OK;
}

int merge_files(const cli_command *command, const slv_env *env, struct merge *m) {
    int code = EXIT_FAILED;
    m->totals.progress = cli_progress_fleeting("merge", m->progress, m->quiet || m->json);
    for (uint32_t i = 0; i < m->npaths; i++)
        if (slv_ptx_open(env, m->paths[i], &m->files[i]) || slv_ptx_load_tables(m->files[i]))
            goto done;
    if (plan_result(env, m) || slv_ptx_writer_create(env, m->out, &m->target, &m->writer) ||
        merge_meta(env, m))
        goto done;
    m->totals.progress.total = m->target.nfaces;
    for (uint32_t i = 0; i < m->npaths; i++)
        if (write_part(command, env, m, i))
            goto done;
    if (slv_ptx_writer_finish(m->writer))
        goto done;
    cli_progress_end(&m->totals.progress);
    convert_warn_clipped(&m->totals, m->target.type);
    code = print_result(m);
done:
    cli_progress_end(&m->totals.progress);
    slv_ptx_writer_destroy(m->writer);
    for (uint32_t i = 0; i < m->npaths; i++)
        slv_ptx_close(m->files[i]);
    return code;
}

int verb_merge(int argc, char **argv) {
    struct merge m = {.out = NULL};
    const cli_option options[] = {
        {"--out|-o|--output", CLI_TEXT, &m.out, "the file to write", "OUT.ptx", 0, 0, NULL},
        {"--type|-t", CLI_CHOICE, &m.type, "data type (one that holds those of all)", CONVERT_TYPES,
         0, 0, &m.type_given},
        {"--no-reductions", CLI_FLAG, &m.no_reductions, "store no reductions", NULL, 0, 0, NULL},
        {"--compression", CLI_UINT, &m.compression, "1 (fast) to 12 (small)", NULL, 1, 12, NULL},
        {"--json", CLI_FLAG, &m.json, "print where the faces went as JSON", NULL, 0, 0, NULL},
        {"--progress", CLI_FLAG, &m.progress, "say on stderr how far it is, terminal or not", NULL,
         0, 0, NULL},
        {"--threads", CLI_UINT, &m.threads, "worker threads (one per processor)", NULL, 1, 256,
         NULL},
        {"--quiet|-q", CLI_FLAG, &m.quiet, "print nothing on success", NULL, 0, 0, NULL},
    };
    const cli_command command = {.name = "merge",
                                 .summary = "join several .ptx files into one",
                                 .arguments = "A.ptx B.ptx ... -o OUT.ptx",
                                 .examples =
                                     "  selvage merge body.ptx head.ptx -o figure.ptx\n"
                                     "  selvage merge part*.ptx -o all.ptx --type half --json\n",
                                 .options = options,
                                 .noptions = sizeof options / sizeof *options,
                                 .min_arguments = 1,
                                 .max_arguments = MERGE_MAX_FILES,
                                 .positional = m.paths,
                                 .npositional = &m.npaths};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (!m.out)
        return cli_usage(&command, "--out is missing: where does the result go?");
    if (!ptx_name_is_safe(m.out))
        return ptx_name_usage(&command, m.out);
    slv_env env = cli_env(m.threads);
    code = merge_files(&command, &env, &m);
    if (fflush(stdout) != 0 || ferror(stdout))
        return code ? code : cli_error("cannot write the answer: %s", strerror(errno));
    return code;
}
