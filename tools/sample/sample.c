/* The verb sample: its options. */
#include "sample/sample.h"
#include "verbs.h"

#include <string.h>

static void keep_log(void *user, slv_log_level level, const char *message) {
    sample_log *log = user;
    if (log->mode == SAMPLE_LOG_KEEP && level == SLV_LOG_ERROR)
        snprintf(log->message, sizeof log->message, "%s", message);
    else if (log->mode == SAMPLE_LOG_PRINT && level == SLV_LOG_ERROR)
        cli_error("%s", message);
    else if (log->mode == SAMPLE_LOG_PRINT && level == SLV_LOG_WARNING)
        cli_warning("%s", message);
}

static slv_result open_texture(const slv_env *env, const sample_options *options,
                               sample_texture *texture, slv_ptx **ptx) {
    slv_texture_encoding encoding = (slv_texture_encoding)options->encoding;
    slv_source stored, light;
    slv_result result;
    if (encoding == SLV_TEXTURE_DATA || encoding == SLV_TEXTURE_LINEAR)
        return slv_cache_open(texture->cache, texture->path, &texture->file);
    if ((result = slv_ptx_open(env, texture->path, ptx)) ||
        (encoding == SLV_TEXTURE_AUTO && (result = slv_ptx_get_encoding(*ptx, &encoding))) ||
        (result = slv_ptx_as_source(env, *ptx, &stored)) ||
        (result = slv_source_decode(env, &stored, encoding, &light)))
        return result;
    return slv_cache_open_source(texture->cache, &light, NULL, &texture->file);
}

static int run_sample(const sample_options *options, const char *path) {
    sample_log log = {0};
    slv_env env = {.log = keep_log, .log_user = &log, .threads = options->threads};
    slv_cache_params params = {.max_bytes = (uint64_t)options->cache_mib << 20,
                               .premultiply = options->premultiply};
    sample_texture texture = {.path = path, .log = &log};
    sample_reader reader = {.descriptor = -1};
    slv_output *output = NULL;
    slv_ptx *ptx = NULL;
    const char *const inputs[] = {path, options->queries ? options->queries : "-"};
    FILE *stream = stdout;
    uint64_t failed = 0;
    int code = EXIT_FAILED;
    if (options->out && output_check_inputs(&env, options->out, inputs, 2))
        goto done;
    if (slv_cache_create(&env, &params, &texture.cache) ||
        open_texture(&env, options, &texture, &ptx) ||
        slv_cache_get_info(texture.cache, texture.file, &texture.info) ||
        sample_reader_open(options->queries, &reader))
        goto done;
    if (options->out) {
        /* what is half written shall go away on an interrupt too */
        cli_catch_interrupts();
        if (slv_output_open_stream(&env, options->out, &output))
            goto done;
        stream = slv_output_stream(output);
    }
    code =
        (options->bench ? sample_bench : sample_run)(options, &texture, &reader, stream, &failed);
    if (slv_output_end(output, code ? SLV_ERROR_CANCELLED : SLV_OK))
        code = EXIT_FAILED;
    if (failed > SAMPLE_COMPLAINTS)
        cli_error("%s: %llu lookups failed, the first %d are shown", reader.name,
                  (unsigned long long)failed, SAMPLE_COMPLAINTS);
    if (failed)
        code = EXIT_FAILED;
done:
    sample_reader_close(&reader);
    slv_cache_destroy(texture.cache);
    slv_ptx_close(ptx);
    return code;
}

int verb_sample(int argc, char **argv) {
    sample_options o = {.encoding = SLV_TEXTURE_DATA};
    const char *path = NULL;
    uint32_t narguments = 0;
    const cli_option options[] = {
        {"--queries|-i", CLI_TEXT, &o.queries, "the lookups, a line each (standard input)", "PATH",
         0, 0, NULL},
        CLI_OUT(&o.out, "write the answers there, whole or not at all", "PATH"),
        {"--json", CLI_FLAG, &o.json, "answer in JSON, for scripts", NULL, 0, 0, NULL},
        {"--premultiply", CLI_FLAG, &o.premultiply, "multiply colours by alpha first", NULL, 0, 0,
         NULL},
        {"--texture-encoding", CLI_CHOICE, &o.encoding,
         "what colours are: srgb is decoded before it is filtered (data: as they stand)",
         names_encodings(), 0, 0, NULL},
        {"--bench", CLI_FLAG, &o.bench,
         "repeat the lookups, and print how many a second there are instead of values", NULL, 0, 0,
         NULL},
        {"--cache", CLI_UINT, &o.cache_mib, "MiB that texels and tables may take (1024)", NULL, 8,
         65536, NULL},
        CLI_THREADS(&o.threads),
        CLI_PROGRESS(&o.progress),
        CLI_QUIET(&o.quiet, "no progress on a terminal either"),
    };
    const cli_command command = {
        .name = "sample",
        .summary = "filtered lookups in a .ptx, a line each",
        .arguments = "FILE.ptx [ANSWERS]",
        .reads = "a texture; lookups from --queries or standard input",
        .writes = "answers, to a file if it is named, else to standard output",
        .examples =
            "  echo 'bicubic 0 0.5 0 1 0 0 3 12 0.25 0.75 0.01 0 0 0.01' |\n"
            "    selvage sample teapot.ptx\n"
            "  selvage sample teapot.ptx --queries lookups.txt --out answers.txt\n"
            "  selvage sample teapot.ptx -i lookups.txt --json | jq '.lookups[0].values'\n"
            "  selvage sample teapot.ptx --queries lookups.txt --bench --threads 1\n\n"
            "A line says, in this order:\n"
            "  FILTER lerp sharpness noedgeblend width blur firstchan nchan\n"
            "  faceid u v uw1 vw1 uw2 vw2\n"
            "  FILTER is point, bilinear, box, gaussian, bicubic, bspline, catmullrom,\n"
            "  mitchell or anisotropic.\n"
            "  lerp and noedgeblend are 0 or 1; sharpness, 0 to 1, is of bicubic only.\n"
            "  nchan 0 means all.\n"
            "  uw1 vw1 and uw2 vw2 are the sides of the footprint, in units of the face.\n"
            "It comes back with ' -> ' and the values after it. What follows a '->' is not\n"
            "read; blank lines and those that begin with # are passed over.\n",
        CLI_TAKES(options, 1, 1, &path, &narguments),
        .output = &o.out,
        .output_is_new = true};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (o.out && cli_ends_with(o.out, ".ptx"))
        return cli_usage(&command, "'%s': answers are text, and no .ptx", o.out);
    if (!o.queries && strcmp(cli_input(path), cli_input("-")) == 0)
        return cli_usage(&command, "the standard input cannot be both the texture and the lookups: "
                                   "name these with --queries");
    if (CLI_STANDARD_ONCE(&command, path, o.queries))
        return EXIT_USAGE;
    if (o.premultiply && o.encoding != SLV_TEXTURE_DATA)
        return cli_usage(&command,
                         "--premultiply multiplies numbers as they stand: it goes with no "
                         "--texture-encoding");
    return run_sample(&o, path);
}
