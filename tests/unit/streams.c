/* Images and .ptx files through callbacks: the same bytes and the same values as through files, and
 * failures of the callbacks told as such. */
#include "kit/calls_kit.h"

#include <sys/stat.h>

/* Bytes in memory that a callback fills; `room` is where it refuses, 0: never. */
typedef struct sink {
    unsigned char *bytes;
    size_t size, room;
} sink;

static int sink_write(void *user, const void *bytes, size_t size) {
    sink *to = user;
    if (to->room && to->size + size > to->room)
        return 1;
    to->bytes = realloc(to->bytes, to->size + size);
    REQUIRE(to->bytes);
    memcpy(to->bytes + to->size, bytes, size);
    to->size += size;
    return 0;
}

typedef struct spring {
    const unsigned char *bytes;
    size_t size;
    int closed;
    bool fails;
} spring;

static int spring_read(void *user, uint64_t offset, void *buffer, size_t size) {
    const spring *from = user;
    if (from->fails || offset > from->size || size > from->size - offset)
        return 1;
    memcpy(buffer, from->bytes + offset, size);
    return 0;
}

static void spring_close(void *user) {
    ((spring *)user)->closed++;
}

static sink read_file(const char *path) {
    sink file = {NULL, 0, 0};
    struct stat status;
    FILE *stream = fopen(path, "rb");
    REQUIRE(stream && fstat(fileno(stream), &status) == 0);
    file.size = (size_t)status.st_size;
    file.bytes = malloc(file.size);
    REQUIRE(file.bytes && fread(file.bytes, 1, file.size, stream) == file.size);
    fclose(stream);
    return file;
}

static void check_equal(const char *what, sink a, sink b) {
    CHECK_MSG(a.size == b.size && !memcmp(a.bytes, b.bytes, a.size), "%s: %zu and %zu bytes", what,
              a.size, b.size);
}

static void check_image(const char *name) {
    slv_env env = test_env();
    sink streamed = {NULL, 0, 0}, refused = {NULL, 0, 40};
    slv_stream_out output = {sink_write, &streamed};
    slv_image image = {0}, same = {0};
    for (uint32_t i = 0; i < 19 * 21 * 4; i++)
        calls.image.pixels[i] = (float)(i % 97) / 97;
    REQUIRE(!slv_image_save(&env, calls_path(name), &calls.image, NULL));
    REQUIRE(!slv_image_save(&env, name, &calls.image, &(slv_image_params){.output = &output}));
    sink file = read_file(calls.out);
    check_equal(name, file, streamed);
    CHECK(access(name, F_OK) != 0);

    spring from = {file.bytes, file.size, 0, false};
    slv_stream_in input = {spring_read, spring_close, &from, file.size};
    REQUIRE(!slv_image_load_stream(&env, name, &input, &image));
    REQUIRE(!slv_image_load(&env, calls.out, &same));
    CHECK(image.width == 19 && image.height == 21 && image.nchannels == 4 && from.closed == 1);
    CHECK(!memcmp(image.pixels, same.pixels, 19 * 21 * 4 * sizeof(float)));
    slv_image_free(&image);
    slv_image_free(&same);
    from.fails = true;
    CHECK(slv_image_load_stream(&env, name, &input, &image) == SLV_ERROR_IO && from.closed == 2);
    CHECK(!image.pixels);
    output.user = &refused;
    CHECK(slv_image_save(&env, name, &calls.image, &(slv_image_params){.output = &output}) ==
          SLV_ERROR_IO);
    free(file.bytes);
    free(streamed.bytes);
    free(refused.bytes);
}

static slv_result save(const slv_env *env, const char *path, const slv_stream_out *output) {
    return slv_ptx_save(env, path, calls.texture, calls.adjacency,
                        &(slv_ptx_write_params){.mesh = calls.mesh, .output = output});
}

static slv_result rewrite(const slv_env *env, const char *path, const slv_stream_out *output) {
    slv_ptx *ptx = NULL;
    slv_result result = slv_ptx_open(env, calls.ptx, &ptx);
    if (!result)
        result = slv_ptx_rewrite(env, ptx, path, &(slv_ptx_writer_params){.output = output});
    slv_ptx_close(ptx);
    return result;
}

/* With so little memory for packed faces that they wait in a file without a name. */
static slv_result face_by_face(const slv_env *env, const char *path, const slv_stream_out *output) {
    enum { SIDE = 1 << 9, FACES = 5 };
    static unsigned char texels[SIDE * SIDE * 2];
    const slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                          .nchannels = 2,
                                          .alpha_channel = SLV_NO_ALPHA,
                                          .nfaces = FACES,
                                          .memory = 1,
                                          .output = output};
    const slv_ptx_face face = {.res = {9, 9}, .adjacency.face = {-1, -1, -1, -1}};
    slv_ptx_writer *writer = NULL;
    uint64_t random = 1;
    slv_result result = slv_ptx_writer_create(env, path, &params, &writer);
    for (uint32_t i = 0; !result && i < FACES; i++) {
        for (size_t k = 0; k < sizeof texels; k++)
            texels[k] = (unsigned char)test_random(&random);
        result = slv_ptx_writer_write_face(writer, i, &face, texels);
    }
    if (!result)
        result = slv_ptx_writer_finish(writer);
    slv_ptx_writer_destroy(writer);
    return result;
}

static void check_ptx(const char *what, slv_result (*write)(const slv_env *env, const char *path,
                                                            const slv_stream_out *output)) {
    slv_env env = test_env();
    sink streamed = {NULL, 0, 0}, refused = {NULL, 0, 1000};
    slv_stream_out output = {sink_write, &streamed};
    slv_ptx *ptx = NULL;
    REQUIRE(!write(&env, calls_path("file.ptx"), NULL));
    REQUIRE(!write(&env, "stream.ptx", &output));
    sink file = read_file(calls.out);
    check_equal(what, file, streamed);
    CHECK(access("stream.ptx", F_OK) != 0);
    spring from = {streamed.bytes, streamed.size, 0, false};
    slv_stream_in input = {spring_read, spring_close, &from, streamed.size};
    REQUIRE(!slv_ptx_open_stream(&env, "stream", &input, &ptx));
    CHECK(!slv_ptx_load_tables(ptx));
    slv_ptx_close(ptx);
    CHECK(from.closed == 1);
    output.user = &refused;
    CHECK(write(&env, "stream.ptx", &output) == SLV_ERROR_IO);
    free(file.bytes);
    free(streamed.bytes);
    free(refused.bytes);
}

int main(void) {
    slv_env env = test_env();
    slv_ptx_writer *writer = NULL;
    slv_stream_out nowhere = {sink_write, NULL};
    calls_begin();
    check_image("x.png");
    check_image("x.exr");
    check_ptx("save", save);
    check_ptx("rewrite", rewrite);
    check_ptx("face by face", face_by_face);
    CHECK(slv_ptx_writer_edit(&env, calls.ptx, &(slv_ptx_writer_params){.output = &nowhere},
                              &writer) == SLV_ERROR_ARGUMENT);
    CHECK(!writer);
    calls_end();
    return test_end();
}
