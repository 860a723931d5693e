/* Two .ptx files of any bytes, joined into one. */
#include "kit/fuzz_kit.h"

#include <selvage/exchange.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    slv_env env = fuzz_env();
    struct fuzz_bytes bytes[2];
    static const char *const names[2] = {"a.ptx", "b.ptx"};
    char paths[3][300];
    const char *in[2];
    uint64_t unpacked = 0;
    fuzz_pair(data, size, bytes);
    for (int i = 0; i < 2; i++) {
        slv_ptx *ptx = fuzz_open(&env, &bytes[i], false);
        unpacked += ptx ? fuzz_unpacked(ptx) : 0;
        slv_ptx_close(ptx);
        fuzz_write(names[i], bytes[i].data, bytes[i].size);
        snprintf(paths[i], sizeof paths[i], "%s", fuzz_path(names[i]));
        in[i] = paths[i];
    }
    snprintf(paths[2], sizeof paths[2], "%s", fuzz_path("out.ptx"));
    bool merged = false, geometry = false;
    if (unpacked <= FUZZ_MAX_WRITTEN)
        merged = !FUZZ_CALL(slv_merge(&env, in, 2, NULL, paths[2], NULL, &geometry, NULL));
    if (merged) {
        slv_ptx *ptx = NULL;
        slv_mesh *mesh = NULL;
        FUZZ_REQUIRE(!FUZZ_CALL(slv_ptx_open(&env, paths[2], &ptx)) &&
                         !FUZZ_CALL(slv_ptx_load_tables(ptx)),
                     "not readable: %s", fuzz_last);
        if (geometry)
            FUZZ_REQUIRE(!FUZZ_CALL(slv_ptx_load_mesh(&env, ptx, &mesh)),
                         "the joined geometry is not one: %s", fuzz_last);
        slv_mesh_destroy(mesh);
        slv_ptx_close(ptx);
    }
    fuzz_clear(2 + merged);
    return 0;
}
