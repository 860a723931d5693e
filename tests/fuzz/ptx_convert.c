/* A .ptx of any bytes, written anew: as it is, resized and in another type, or as a sheet. */
#include "kit/fuzz_kit.h"

#include "convert/convert.h"

/* What a conversion makes can be read. */
static void read_back(const slv_env *env) {
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL;
    FUZZ_REQUIRE(!FUZZ_CALL(slv_ptx_open(env, fuzz_path("out.ptx"), &ptx)) &&
                     !FUZZ_CALL(slv_ptx_load_tables(ptx)) &&
                     !FUZZ_CALL(slv_ptx_load_texture(env, ptx, &texture)),
                 "not readable: %s", fuzz_last);
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
}

static convert_options choose(uint32_t control, const slv_ptx_writer_params *source) {
    static const char *const scales[] = {NULL, "1/2", "2", "1/16"};
    convert_options options = {.scale = scales[control & 3],
                               .type_given = control & 4,
                               .type = (int)(control >> 3 & 3),
                               .channels = control & 32 ? "0,=0.5" : NULL,
                               .premultiply = control & 64 && source->alpha_channel >= 0,
                               .no_meta = control & 128,
                               .no_reductions = control & 256};
    if (control & 512) {
        options.max_given = true;
        options.max[0] = options.max[1] = 4;
    }
    return options;
}

static int convert(const slv_env *env, const slv_ptx *ptx, uint32_t control) {
    const cli_command command = {.name = "convert"};
    slv_ptx_writer_params source = slv_ptx_writer_params_like(ptx);
    convert_options options = choose(control, &source);
    convert_totals totals = {.progress.quiet = true};
    convert_plan plan = {0};
    int files = 0;
    FUZZ_REQUIRE(convert_plan_make(&command, &options, "fuzz", &source, &totals, &plan) == EXIT_OK,
                 "no plan");
    bool sheet = (control >> 10 & 3) == 3;
    int code = sheet ? convert_to_sheet(env, &options, &plan, ptx, fuzz_path("out.exr"))
                     : convert_to_ptx(env, &options, &plan, ptx, NULL, fuzz_path("out.ptx"));
    FUZZ_REQUIRE(fuzz_errors <= (code != EXIT_OK), "%d lines, code %d: %s", fuzz_errors, code,
                 fuzz_last);
    fuzz_errors = 0;
    if (code == EXIT_OK && !sheet)
        read_back(env);
    if (code == EXIT_OK)
        files = sheet ? 1 + (int)((plan.target.nchannels + 3) / 4) : 1;
    convert_plan_free(&plan);
    return files;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    uint32_t control = fuzz_control(data, &size);
    slv_env env = fuzz_env();
    struct fuzz_bytes bytes = {data, size};
    slv_ptx *ptx = fuzz_open(&env, &bytes, false);
    int files = 0;
    if (ptx && fuzz_unpacked(ptx) <= FUZZ_MAX_WRITTEN) {
        if ((control >> 10 & 3) == 0) {
            files = !FUZZ_CALL(slv_ptx_rewrite(&env, ptx, fuzz_path("out.ptx"), NULL));
            if (files)
                read_back(&env);
        } else if (!FUZZ_CALL(slv_ptx_load_tables(ptx))) {
            files = convert(&env, ptx, control);
        }
    }
    slv_ptx_close(ptx);
    fuzz_clear(files);
    return 0;
}
