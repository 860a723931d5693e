/* A .ptx of any bytes, written anew: as it is, resized and in another type, or as a sheet. */
#include "kit/fuzz_kit.h"

#include <selvage/exchange.h>

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

static slv_exchange_params choose(uint32_t control, const slv_ptx_writer_params *source) {
    static const int scales[] = {0, -1, 1, -4};
    static const slv_exchange_channel channels[2] = {{.source = 0}, {.source = -1, .value = 0.5f}};
    slv_exchange_params params = {.scale_log2 = scales[control & 3],
                                  .changes = control & 4 ? SLV_EXCHANGE_TYPE : 0,
                                  .type = (slv_type)(control >> 3 & 3),
                                  .channels = control & 32 ? channels : NULL,
                                  .nchannels = 2,
                                  .premultiply = control & 64 && source->alpha_channel >= 0,
                                  .no_meta = control & 128,
                                  .no_reductions = true};
    if (control & 256)
        params.changes |= SLV_EXCHANGE_REDUCTIONS;
    if (control & 512) {
        params.changes |= SLV_EXCHANGE_MAX_RES;
        params.max_res = (slv_res){2, 2};
    }
    return params;
}

static int convert(const slv_env *env, const slv_ptx *ptx, uint32_t control) {
    slv_exchange *source = NULL;
    slv_exchange_stats stats;
    FUZZ_REQUIRE(!FUZZ_CALL(slv_exchange_open_ptx(env, ptx, &source)), "not opened");
    slv_exchange_params params = choose(control, slv_exchange_get_params(source));
    bool sheet = (control >> 10 & 3) == 3;
    bool written =
        !FUZZ_CALL(sheet ? slv_exchange_to_sheet(env, source, &params, fuzz_path("out.exr"), &stats)
                         : slv_exchange_to_ptx(env, source, &params, fuzz_path("out.ptx"), &stats));
    slv_exchange_close(source);
    if (!written)
        return 0;
    if (sheet)
        return 1 + (int)((stats.wrote.nchannels + 3) / 4);
    read_back(env);
    return 1;
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
