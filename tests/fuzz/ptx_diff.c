/* Two .ptx files of any bytes, compared. */
#include "kit/fuzz_kit.h"

#include "diff/diff.h"

static void compare(const slv_env *env, slv_ptx *const files[2], bool same) {
    uint32_t na = slv_ptx_get_info(files[0])->nfaces, nb = slv_ptx_get_info(files[1])->nfaces;
    struct diff d = {.files = {files[0], files[1]}, .nfaces = na > nb ? na : nb};
    slv_ptx_diff_params params = {.tolerance = na & 1 ? 0.1f : 0};
    d.faces = calloc((size_t)d.nfaces + 1, sizeof *d.faces);
    FUZZ_REQUIRE(d.faces, "no memory");
    if (FUZZ_CALL(slv_ptx_diff(env, files[0], files[1], &params, d.faces)))
        goto done;
    uint32_t shown = 0;
    for (uint32_t face = 0; face < d.nfaces; face++) {
        const slv_face_diff *f = &d.faces[face];
        FUZZ_REQUIRE(!same || !f->what, "face %u differs from itself by %u", face, f->what);
        FUZZ_REQUIRE(!(f->what & SLV_DIFF_ADJACENCY) || (f->edge >= 0 && f->edge < 4), "edge %d",
                     f->edge);
        if (!(f->what & SLV_DIFF_TEXELS) || shown++ > 8)
            continue;
        uint32_t a = slv_ptx_get_info(files[0])->nchannels,
                 b = slv_ptx_get_info(files[1])->nchannels;
        uint64_t count = (uint64_t)(a < b ? a : b) << (f->compared.u + f->compared.v);
        float *values =
            count * sizeof *values <= FUZZ_MAX_BYTES ? malloc(count * sizeof *values) : NULL;
        if (values)
            FUZZ_CALL(slv_ptx_diff_texels(env, files[0], files[1], face, f, values));
        free(values);
    }
    int code = diff_files(&d);
    FUZZ_REQUIRE(code == EXIT_OK ? fuzz_errors == 0 : fuzz_errors == 1, "%d lines, code %d",
                 fuzz_errors, code);
    FUZZ_REQUIRE(!same || !d.nnotes, "a file differs from itself: %s", d.notes[0]);
    fuzz_errors = 0;
done:
    for (uint32_t i = 0; i < d.nnotes; i++)
        free(d.notes[i]);
    free(d.notes);
    free(d.faces);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    slv_env env = fuzz_env();
    struct fuzz_bytes bytes[2];
    slv_ptx *files[2] = {NULL, NULL};
    fuzz_pair(data, size, bytes);
    for (int i = 0; i < 2; i++)
        files[i] = fuzz_open(&env, &bytes[i], false);
    if (files[0] && files[1] && fuzz_unpacked(files[0]) <= FUZZ_MAX_BYTES &&
        fuzz_unpacked(files[1]) <= FUZZ_MAX_BYTES)
        compare(&env, files, bytes[0].data == bytes[1].data);
    slv_ptx_close(files[0]);
    slv_ptx_close(files[1]);
    return 0;
}
