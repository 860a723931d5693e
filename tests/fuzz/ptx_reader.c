/* A .ptx file of any bytes: opened, and everything in it looked at. Built with -fsanitize=fuzzer;
 * with FUZZ_REPLAY it is a program that replays files. */
#include <selvage/ptx_writer.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_BYTES (1 << 24)

struct bytes {
    const uint8_t *data;
    size_t size;
};

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int read_bytes(void *user, uint64_t offset, void *buffer, size_t size) {
    const struct bytes *bytes = user;
    if (offset > bytes->size || size > bytes->size - offset)
        return -1;
    memcpy(buffer, bytes->data + offset, size);
    return 0;
}

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
        if (slv_ptx_get_face(ptx, face, &f))
            return;
        for (uint32_t level = 0; level < info->nlevels; level++)
            slv_ptx_get_block(ptx, face, level, &block);
        slv_res wanted[4] = {{0, 0},
                             {(int8_t)(f.res.u / 2), f.res.v},
                             {(int8_t)(f.res.u - 1), (int8_t)(f.res.v - 1)},
                             {f.res.u, 0}};
        for (int i = 0; i < 4; i++) {
            if (wanted[i].u < 0 || wanted[i].v < 0 ||
                (pixel << (wanted[i].u + wanted[i].v)) > MAX_BYTES)
                continue;
            void *texels = malloc(pixel << (wanted[i].u + wanted[i].v));
            if (texels)
                slv_ptx_read_face(ptx, face, wanted[i], texels);
            free(texels);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    slv_env env = {.threads = 1, .max_bytes = MAX_BYTES};
    struct bytes bytes = {data, size};
    slv_ptx_source source = {read_bytes, NULL, &bytes, size};
    slv_ptx_open_params params = {.premultiply = size & 1, .source = &source};
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL;
    slv_adjacency *adjacency = NULL;
    slv_mesh *mesh = NULL;
    if (slv_ptx_open_with(&env, "fuzz.ptx", &params, &ptx))
        return 0;
    slv_ptx_load_tables(ptx);
    read_some(ptx);
    slv_ptx_visit_faces(&env, ptx, look, NULL);
    slv_ptx_load_texture(&env, ptx, &texture);
    slv_ptx_load_adjacency(&env, ptx, &adjacency);
    if (!slv_ptx_load_mesh(&env, ptx, &mesh))
        slv_ptx_match_mesh(&env, ptx, mesh);
    for (uint32_t i = 0; i < slv_ptx_get_info(ptx)->nmeta; i++)
        slv_ptx_get_meta(ptx, i);
    slv_texture_destroy(texture);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    slv_ptx_close(ptx);
    return 0;
}

#ifdef FUZZ_REPLAY
int main(int argc, char **argv) {
    for (int i = 1; i < argc; i++) {
        FILE *stream = fopen(argv[i], "rb");
        if (!stream) {
            perror(argv[i]);
            return 1;
        }
        uint8_t *data = malloc(1 << 22);
        size_t size = data ? fread(data, 1, 1 << 22, stream) : 0;
        uint8_t *exact = malloc(size ? size : 1); /* so that reading past the end is noticed */
        if (data && exact) {
            memcpy(exact, data, size);
            LLVMFuzzerTestOneInput(exact, size);
        }
        free(data);
        free(exact);
        fclose(stream);
    }
    return 0;
}
#endif
