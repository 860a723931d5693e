/* Two .ptx files of any bytes, joined into one. */
#include "kit/fuzz_kit.h"

#include "merge/merge.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    const cli_command command = {.name = "merge"};
    slv_env env = fuzz_env();
    struct fuzz_bytes bytes[2];
    static const char *const names[2] = {"a.ptx", "b.ptx"};
    char paths[3][300];
    static struct merge m;
    uint64_t unpacked = 0;
    memset(&m, 0, sizeof m);
    m.quiet = true;
    m.npaths = 2;
    fuzz_pair(data, size, bytes);
    for (int i = 0; i < 2; i++) {
        slv_ptx *ptx = fuzz_open(&env, &bytes[i], false);
        unpacked += ptx ? fuzz_unpacked(ptx) : 0;
        slv_ptx_close(ptx);
        fuzz_write(names[i], bytes[i].data, bytes[i].size);
        snprintf(paths[i], sizeof paths[i], "%s", fuzz_path(names[i]));
        m.paths[i] = paths[i];
    }
    snprintf(paths[2], sizeof paths[2], "%s", fuzz_path("out.ptx"));
    m.out = paths[2];
    bool merged = false;
    if (unpacked <= FUZZ_MAX_WRITTEN) {
        merged = merge_files(&command, &env, &m) == EXIT_OK;
        FUZZ_REQUIRE(merged ? !fuzz_errors : fuzz_errors == 1, "%d lines: %s", fuzz_errors,
                     fuzz_last);
        fuzz_errors = 0;
    }
    if (merged) {
        slv_ptx *ptx = NULL;
        slv_mesh *mesh = NULL;
        FUZZ_REQUIRE(!FUZZ_CALL(slv_ptx_open(&env, m.out, &ptx)) &&
                         !FUZZ_CALL(slv_ptx_load_tables(ptx)),
                     "not readable: %s", fuzz_last);
        if (m.geometry)
            FUZZ_REQUIRE(!FUZZ_CALL(slv_ptx_load_mesh(&env, ptx, &mesh)),
                         "the joined geometry is not one: %s", fuzz_last);
        slv_mesh_destroy(mesh);
        slv_ptx_close(ptx);
    }
    fuzz_clear(2 + merged);
    return 0;
}
