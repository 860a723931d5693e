/* Checking and mending a .ptx of any bytes: the verdict on a mended copy must be a good one. */
#include "kit/fuzz_kit.h"

#include <selvage/ptx_check.h>

static slv_ptx_report *check(const slv_env *env, const char *name, uint32_t control,
                             const slv_mesh *mesh) {
    slv_ptx_check_params params = {.mesh = mesh,
                                   .seams = control & 1,
                                   .seam_tolerance = control & 2 ? 0.25f : 0,
                                   .no_texels = control & 4,
                                   .max_findings = control & 8 ? 3 : 0};
    slv_ptx_report *report = NULL;
    if (FUZZ_CALL(slv_ptx_check(env, fuzz_path(name), &params, &report)))
        return NULL;
    for (uint32_t i = 0; i < report->nfindings; i++) {
        const slv_check_finding *f = &report->findings[i];
        FUZZ_REQUIRE(memchr(f->message, 0, sizeof f->message), "a message without an end");
        FUZZ_REQUIRE(f->kind < SLV_CHECK_KINDS && report->counts[f->kind], "a finding of no kind");
        FUZZ_REQUIRE(!i || f[-1].kind <= f->kind, "findings are not in order");
    }
    return report;
}

/* What the mesh inside says is used as if it were given from outside. */
static slv_mesh *mesh_inside(const slv_env *env, const slv_ptx *ptx) {
    slv_mesh *mesh = NULL;
    return FUZZ_CALL(slv_ptx_load_mesh(env, ptx, &mesh)) ? NULL : mesh;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    uint32_t control = fuzz_control(data, &size);
    slv_env env = fuzz_env();
    struct fuzz_bytes bytes = {data, size};
    slv_ptx *ptx = fuzz_open(&env, &bytes, false);
    slv_mesh *mesh = ptx && control & 16 ? mesh_inside(&env, ptx) : NULL;
    slv_ptx_report *report = NULL, *after = NULL;
    bool mended = false;
    uint64_t unpacked = ptx ? fuzz_unpacked(ptx) : 0;
    if (unpacked > FUZZ_MAX_BYTES)
        control |= 4;
    fuzz_write("in.ptx", data, size);
    report = check(&env, "in.ptx", control, mesh);
    if (ptx && unpacked <= FUZZ_MAX_WRITTEN) {
        mended = !FUZZ_CALL(slv_ptx_repair(&env, ptx, mesh, fuzz_path("out.ptx"), NULL));
        FUZZ_REQUIRE(mended == fuzz_exists("out.ptx"), "half a copy");
    }
    if (mended) {
        after = check(&env, "out.ptx", control, mesh);
        FUZZ_REQUIRE(after && after->opened && !after->counts[SLV_CHECK_STRUCTURE] &&
                         !after->counts[SLV_CHECK_TEXELS] && !after->counts[SLV_CHECK_REDUCTIONS],
                     "the copy is damaged: %s",
                     after && after->nfindings ? after->findings[0].message : fuzz_last);
    }
    slv_ptx_report_destroy(report);
    slv_ptx_report_destroy(after);
    slv_mesh_destroy(mesh);
    slv_ptx_close(ptx);
    fuzz_clear(1 + mended);
    return 0;
}
