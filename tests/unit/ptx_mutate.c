/* Spoilt files: any answer is fine that is one line or a texture, and comes soon. */
#include "kit/ptx_kit.h"

static uint64_t seed = 11;
static int error_lines;

static void count_errors(void *user, slv_log_level level, const char *message) {
    test_log(user, level, message);
    error_lines += level == SLV_LOG_ERROR;
}

static void use(const uint8_t *bytes, size_t size) {
    slv_env env = {.log = count_errors, .max_bytes = 1 << 24, .threads = 2};
    struct memory_file file = {bytes, size, 0};
    slv_stream_in source = {memory_read, memory_close, &file, size};
    slv_ptx *ptx = NULL;
    error_lines = 0;
    slv_result result = slv_ptx_open_stream(&env, "spoilt", &source, &ptx);
    CHECK(error_lines == (result ? 1 : 0));
    if (result) {
        CHECK(!ptx && file.closed == 1);
        return;
    }
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    size_t pixel = slv_type_size(info->type) * info->nchannels;
    slv_texture *texture = NULL;
    slv_adjacency *adjacency = NULL;
    slv_mesh *mesh = NULL;
    error_lines = 0;
    result = slv_ptx_load_texture(&env, ptx, &texture);
    CHECK_MSG(error_lines == (result ? 1 : 0), "%d lines: %s", error_lines, test_last_log);
    slv_texture_destroy(texture);
    if (slv_ptx_load_adjacency(&env, ptx, &adjacency) == SLV_OK)
        CHECK(slv_adjacency_face_count(adjacency) ==
              (info->mesh_type == SLV_PTX_TRIANGLE ? 3 : 1) * info->nfaces);
    slv_adjacency_destroy(adjacency);
    test_ignore(slv_ptx_load_mesh(&env, ptx, &mesh));
    slv_mesh_destroy(mesh);
    for (uint32_t i = 0; i < info->nmeta; i++) {
        const slv_ptx_meta *meta = slv_ptx_get_meta(ptx, i);
        CHECK(!meta || slv_ptx_find_meta(ptx, meta->key) == meta);
    }
    for (uint32_t i = 0; i < 8 && info->nfaces; i++) {
        slv_ptx_face face;
        uint32_t id = test_random(&seed) % info->nfaces;
        if (slv_ptx_get_face(ptx, id, &face))
            break; /* the face table is damaged, which opening does not look at */
        slv_res res = {(int8_t)(test_random(&seed) % (uint32_t)(face.res.u + 1)),
                       (int8_t)(test_random(&seed) % (uint32_t)(face.res.v + 1))};
        if (res.u + res.v > 16)
            continue;
        void *out = malloc(pixel << (res.u + res.v));
        test_ignore(slv_ptx_read_face(ptx, id, res, out));
        free(out);
    }
    slv_ptx_close(ptx);
}

static void spoil(const char *path) {
    size_t size = 0;
    uint8_t *original = read_whole(path, &size);
    REQUIRE(original != NULL);
    if (size > 60000) {
        free(original);
        return;
    }
    uint8_t *bytes = malloc(size);
    for (int round = 0; round < 300; round++) {
        memcpy(bytes, original, size);
        size_t length = size;
        uint32_t changes = 1 + test_random(&seed) % 4;
        for (uint32_t i = 0; i < changes; i++) {
            /* the headers have the most to say */
            size_t range = round % 3 == 0 ? size : round % 3 == 1 ? 104 : size < 400 ? size : 400;
            size_t at = test_random(&seed) % range;
            switch (test_random(&seed) % 4) {
            case 0:
                bytes[at] = (uint8_t)test_random(&seed);
                break;
            case 1:
                bytes[at] ^= (uint8_t)(1u << test_random(&seed) % 8);
                break;
            case 2:
                bytes[at] = test_random(&seed) % 2 ? 0xff : 0;
                break;
            default:
                if (i == 0 && round % 4 == 0)
                    length = 1 + test_random(&seed) % size;
                else
                    memmove(bytes + at, bytes + test_random(&seed) % (size - size / 8),
                            size / 8 < size - at ? size / 8 : size - at);
            }
        }
        use(bytes, length);
    }
    free(bytes);
    free(original);
}

int main(void) {
    CHECK(each_sample(spoil) > 0);
    return test_end();
}
