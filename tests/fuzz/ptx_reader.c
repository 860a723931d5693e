/* A .ptx file of any bytes: opened, and everything in it looked at. */
#include "kit/fuzz_kit.h"

static slv_result look(void *user, const slv_env *env, uint32_t face, const slv_ptx_face *info,
                       void *texels) {
    (void)user, (void)env, (void)face, (void)info, (void)texels;
    return SLV_OK;
}

static void read_some(const slv_ptx *ptx) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    uint32_t step = info->nfaces / 16 + 1;
    size_t pixel = slv_type_size(info->type) * info->nchannels;
    for (uint32_t face = 0; face < info->nfaces; face += step) {
        slv_ptx_face f;
        slv_ptx_block block;
        if (FUZZ_CALL(slv_ptx_get_face(ptx, face, &f)))
            return;
        for (uint32_t level = 0; level < info->nlevels; level++)
            FUZZ_CALL(slv_ptx_get_block(ptx, face, level, &block));
        slv_res wanted[4] = {{0, 0},
                             {(int8_t)(f.res.u / 2), f.res.v},
                             {(int8_t)(f.res.u - 1), (int8_t)(f.res.v - 1)},
                             {f.res.u, 0}};
        for (int i = 0; i < 4; i++) {
            if (wanted[i].u < 0 || wanted[i].v < 0 ||
                (pixel << (wanted[i].u + wanted[i].v)) > FUZZ_MAX_BYTES)
                continue;
            void *texels = malloc(pixel << (wanted[i].u + wanted[i].v));
            if (texels)
                FUZZ_CALL(slv_ptx_read_face(ptx, face, wanted[i], texels));
            free(texels);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    slv_env env = fuzz_env();
    struct fuzz_bytes bytes = {data, size};
    slv_texture *texture = NULL;
    slv_adjacency *adjacency = NULL;
    slv_mesh *mesh = NULL;
    slv_ptx *ptx = fuzz_open(&env, &bytes, size & 1);
    if (!ptx)
        return 0;
    FUZZ_CALL(slv_ptx_load_tables(ptx));
    read_some(ptx);
    if (fuzz_unpacked(ptx) <= 4 * FUZZ_MAX_BYTES)
        FUZZ_CALL(slv_ptx_visit_faces(&env, ptx, look, NULL));
    FUZZ_CALL(slv_ptx_load_texture(&env, ptx, &texture));
    FUZZ_CALL(slv_ptx_load_adjacency(&env, ptx, &adjacency));
    if (!FUZZ_CALL(slv_ptx_load_mesh(&env, ptx, &mesh)))
        FUZZ_CALL(slv_ptx_match_mesh(&env, ptx, mesh));
    for (uint32_t i = 0; i < slv_ptx_get_info(ptx)->nmeta; i++) {
        const slv_ptx_meta *meta = slv_ptx_get_meta(ptx, i);
        FUZZ_REQUIRE(fuzz_errors == !meta, "%d lines for metadata %u", fuzz_errors, i);
        fuzz_errors = 0;
    }
    slv_texture_destroy(texture);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    slv_ptx_close(ptx);
    return 0;
}
