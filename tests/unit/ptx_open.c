/* What opening says of files that are not what they should be. */
#include "kit/ptx_kit.h"

static int error_lines;

static void count_errors(void *user, slv_log_level level, const char *message) {
    test_log(user, level, message);
    error_lines += level == SLV_LOG_ERROR;
}

/* Opens bytes in memory and reads everything; returns the first result that is not SLV_OK. */
static slv_result open_bytes(const uint8_t *bytes, size_t size) {
    slv_env env = {.log = count_errors, .max_bytes = 1 << 26, .threads = 2};
    struct memory_file file = {bytes, size, 0};
    slv_stream_in source = {memory_read, memory_close, &file, size};
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL;
    error_lines = 0;
    slv_result result = slv_ptx_open_stream(&env, "bytes.ptx", &source, &ptx);
    if (!result)
        result = slv_ptx_load_texture(&env, ptx, &texture);
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
    CHECK(file.closed == 1);
    CHECK_MSG(error_lines == (result ? 1 : 0), "%d lines for result %d: %s", error_lines, result,
              test_last_log);
    return result;
}

static void missing(void) {
    slv_env env = test_env();
    slv_ptx *ptx = NULL;
    CHECK(slv_ptx_open(&env, "/nowhere/x.ptx", &ptx) == SLV_ERROR_IO && !ptx);
    CHECK(strstr(test_last_log, "/nowhere/x.ptx: "));
    CHECK(slv_ptx_open(&env, "/", &ptx) == SLV_ERROR_IO);
    CHECK(slv_ptx_open(NULL, "/nowhere/x.ptx", &ptx) == SLV_ERROR_IO);
    CHECK(open_bytes((const uint8_t *)"", 0) == SLV_ERROR_FORMAT);
    CHECK(open_bytes((const uint8_t *)"PNG, really", 11) == SLV_ERROR_FORMAT);
    CHECK(strstr(test_last_log, "bytes.ptx: not a .ptx file"));
    slv_ptx_close(NULL);
}

struct change {
    size_t at, size;
    uint64_t value;
    slv_result result;
    const char *words;
};

static void changed_headers(const uint8_t *original, size_t size) {
    static const struct change changes[] = {
        {4, 4, 2, SLV_ERROR_UNSUPPORTED, "version 2"},
        {8, 4, 2, SLV_ERROR_FORMAT, "mesh type 2"},
        {12, 4, 4, SLV_ERROR_FORMAT, "data type 4"},
        {20, 2, 0, SLV_ERROR_FORMAT, "no channels"},
        {22, 2, 0, SLV_ERROR_FORMAT, "0 levels"},
        {22, 2, 500, SLV_ERROR_FORMAT, "500 levels"},
        {24, 4, 0xffffffff, SLV_ERROR_FORMAT, "4294967295 faces"},
        {24, 4, 0x7fffffff, SLV_ERROR_FORMAT, "face table"},
        {24, 4, 1, SLV_ERROR_FORMAT, "level 0 has 4 faces"},
        {28, 4, 0xfffffff0, SLV_ERROR_FORMAT, "truncated"},
        {32, 4, 0xfffffff0, SLV_ERROR_FORMAT, "face table"},
        {36, 4, 0xfffffff0, SLV_ERROR_FORMAT, "constant data"},
        {40, 4, 7, SLV_ERROR_FORMAT, "level list"},
        {48, 8, UINT64_MAX, SLV_ERROR_FORMAT, "level data"},
        {56, 4, 0xfffffff0, SLV_ERROR_FORMAT, "metadata"},
        {60, 4, 0xfffffff0, SLV_ERROR_FORMAT, "metadata"},
        {64, 2, 9, SLV_ERROR_FORMAT, "border mode"},
        {72, 4, 0xfffffff0, SLV_ERROR_FORMAT, "large metadata"},
        {76, 4, 0xfffffff0, SLV_ERROR_FORMAT, "large metadata"},
        {80, 8, UINT64_MAX - 3, SLV_ERROR_FORMAT, "large metadata"},
        {88, 8, UINT64_MAX - 3, SLV_ERROR_FORMAT, "edit section"},
    };
    uint8_t *bytes = malloc(size);
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        const struct change *c = &changes[i];
        memcpy(bytes, original, size);
        for (size_t k = 0; k < c->size; k++)
            bytes[c->at + k] = (uint8_t)(c->value >> (8 * k));
        slv_result result = open_bytes(bytes, size);
        CHECK_MSG(result == c->result && strstr(test_last_log, c->words),
                  "offset %zu: result %d, \"%s\", not \"%s\"", c->at, result, test_last_log,
                  c->words);
    }
    free(bytes);
}

static void cut(const uint8_t *bytes, size_t size) {
    for (size_t length = 0; length < size; length += length < 512 ? 1 : 97) {
        CHECK_MSG(open_bytes(bytes, length) == SLV_ERROR_FORMAT, "%zu of %zu bytes: %s", length,
                  size, test_last_log);
        CHECK(length < 4 || strstr(test_last_log, "truncated") || strstr(test_last_log, "offset") ||
              strstr(test_last_log, "beyond"));
    }
    CHECK(open_bytes(bytes, size) == SLV_OK);
}

/* Two writers' sessions of edits, one of them on a file without metadata: the records begin where
 * the header says. */
static void edits_without_metadata(void) {
    slv_env env = test_env();
    slv_res res = {1, 1};
    slv_texture_desc desc = {1, SLV_TYPE_U8, 1, SLV_NO_ALPHA, &res, SLV_TEXTURE_AUTO};
    slv_texture *texture = NULL;
    size_t size = 0;
    const char *path = scratch_path("edited.ptx");
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    REQUIRE(slv_texture_set_face(texture, 0, "\1\2\3\4") == SLV_OK);
    REQUIRE(slv_ptx_save(&env, path, texture, NULL, NULL) == SLV_OK);
    uint8_t *file = read_whole(path, &size);
    REQUIRE(file != NULL);
    uint8_t edit[5 + 4 + 20 + 4 + 1] = {0, 29, 0, 0, 0};
    edit[9] = 2; /* 4 x 2 texels, constant */
    edit[10] = 1;
    edit[12] = SLV_FACE_CONSTANT;
    memset(edit + 13, 0xff, 16);
    edit[33] = 77;
    for (int barrier = 0; barrier < 2; barrier++) {
        size_t start = size - (barrier ? 0 : 8), total = start + sizeof edit;
        uint8_t *bytes = malloc(total), out[8];
        memcpy(bytes, file, start);
        memcpy(bytes + start, edit, sizeof edit);
        memset(bytes + 88, 0, 16);
        bytes[88] = sizeof edit;
        bytes[96] = (uint8_t)start;
        bytes[97] = (uint8_t)(start >> 8);
        struct memory_file memory = {bytes, total, 0};
        slv_stream_in source = {memory_read, NULL, &memory, total};
        slv_ptx *ptx = NULL;
        slv_ptx_face face;
        REQUIRE(slv_ptx_open_stream(&env, "edited", &source, &ptx) == SLV_OK);
        CHECK(slv_ptx_get_info(ptx)->has_edits);
        REQUIRE(slv_ptx_get_face(ptx, 0, &face) == SLV_OK);
        CHECK(face.res.u == 2 && face.res.v == 1);
        CHECK(face.flags == (SLV_FACE_CONSTANT | SLV_FACE_EDITED));
        REQUIRE(slv_ptx_read_face(ptx, 0, face.res, out) == SLV_OK);
        CHECK(out[0] == 77 && out[7] == 77);
        slv_ptx_close(ptx);
        free(bytes);
    }
    free(file);
    slv_texture_destroy(texture);
    remove(path);
}

int main(void) {
    char path[2048];
    size_t size = 0;
    REQUIRE(data_folder() != NULL);
    missing();
    edits_without_metadata();
    snprintf(path, sizeof path, "%s/meta_u8_3.ptx", data_folder());
    uint8_t *bytes = read_whole(path, &size);
    REQUIRE(bytes != NULL);
    changed_headers(bytes, size);
    cut(bytes, size);
    free(bytes);
    return test_end();
}
