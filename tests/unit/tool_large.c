/* Files that are larger than the memory there is: pictures of what they need of them, transfers
 * through a cache, lookups in what address space is left; what cannot be done is said at once. */
#include "kit/tool_kit.h"

#include <selvage/image.h>

#include <sys/resource.h>

enum { FACES = 17, MIB = 1 << 20 };

static slv_mesh *strip(void) {
    slv_env env = test_env();
    char text[8192];
    size_t size = 0;
    slv_mesh *mesh = NULL;
    for (int i = 0; i <= FACES; i++)
        size += (size_t)snprintf(text + size, sizeof text - size, "v %d 0 0\nv %d 1 0\n", i, i);
    for (int i = 0; i < FACES; i++)
        size += (size_t)snprintf(text + size, sizeof text - size, "f %d %d %d %d\n", 2 * i + 1,
                                 2 * i + 3, 2 * i + 4, 2 * i + 2);
    REQUIRE(!slv_mesh_parse_obj(&env, "strip", text, size, &mesh));
    return mesh;
}

/* Grey that grows to the right and upwards, the same at any resolution. */
static void write_ramp(const char *name, const slv_mesh *mesh, int log2) {
    slv_env env = test_env();
    const slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                          .nchannels = 1,
                                          .alpha_channel = SLV_NO_ALPHA,
                                          .nfaces = FACES,
                                          .compression = 1};
    slv_ptx_writer *writer = NULL;
    size_t side = (size_t)1 << log2;
    uint8_t *texels = malloc(side * side);
    REQUIRE(texels && !slv_ptx_writer_create(&env, tool_path(name), &params, &writer));
    REQUIRE(!slv_ptx_writer_set_mesh(writer, mesh));
    for (uint32_t face = 0; face < FACES; face++) {
        const slv_ptx_face info = {.res = {(int8_t)log2, (int8_t)log2}};
        for (size_t y = 0; y < side; y++)
            for (size_t x = 0; x < side; x++)
                texels[y * side + x] = (uint8_t)(face * 8 + (x * 16 + y * 64) / side);
        REQUIRE(!slv_ptx_writer_write_face(writer, face, &info, texels));
    }
    REQUIRE(!slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
    free(texels);
}

/* The exit code of a command that may have so much address space; what it says stays in a file. */
static int limited(uint64_t bytes, const char *arguments) {
    int status = 0;
    fflush(NULL);
    pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        const struct rlimit limit = {bytes, bytes};
        int code = setrlimit(RLIMIT_AS, &limit) == 0 ? tool("%s", arguments) : 99;
        tool_write_file("said", tool_out, strlen(tool_out));
        _exit(code);
    }
    REQUIRE(waitpid(child, &status, 0) == child);
    size_t size = 0;
    uint8_t *said = read_whole(tool_path("said"), &size);
    REQUIRE(said && size < sizeof tool_out);
    memcpy(tool_out, said, size);
    tool_out[size] = 0;
    free(said);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* What the process takes by itself. */
static uint64_t taken(void) {
    FILE *stream = fopen("/proc/self/statm", "r");
    unsigned long long pages = 0;
    REQUIRE(stream && fscanf(stream, "%llu", &pages) == 1);
    fclose(stream);
    return pages * (uint64_t)sysconf(_SC_PAGESIZE);
}

#define LIMITED(code, mib, arguments)                                                              \
    do {                                                                                           \
        int code_ = limited((uint64_t)(mib)*MIB, arguments);                                       \
        CHECK_MSG(code_ == (code), "%s: exit code %d, expected %d:\n%s", arguments, code_, (code), \
                  tool_out);                                                                       \
    } while (0)

static double rmse(const char *a, const char *b) {
    slv_env env = test_env();
    slv_image images[2] = {{0}, {0}};
    double sum = 0;
    REQUIRE(!slv_image_load(&env, tool_path(a), &images[0]));
    REQUIRE(!slv_image_load(&env, tool_path(b), &images[1]));
    size_t count = (size_t)images[0].width * images[0].height * images[0].nchannels;
    REQUIRE(images[1].width == images[0].width && images[1].nchannels == images[0].nchannels);
    for (size_t i = 0; i < count; i++) {
        double difference = (double)images[0].pixels[i] - (double)images[1].pixels[i];
        sum += difference * difference;
    }
    slv_image_free(&images[0]);
    slv_image_free(&images[1]);
    return sqrt(sum / (double)count);
}

/* Faces at the resolutions that were asked for are those that a reader gives. */
static void other_resolutions(void) {
    slv_env env = test_env();
    slv_ptx *ptx = tool_open("small.ptx");
    slv_texture *texture = NULL;
    slv_res res[FACES];
    static uint8_t expected[1 << 12];
    for (int i = 0; i < FACES; i++)
        res[i] = (slv_res){(int8_t)(i % 7), (int8_t)(6 - i % 5)};
    REQUIRE(!slv_ptx_load_texture_at(&env, ptx, res, &texture));
    for (uint32_t face = 0; face < FACES; face++) {
        REQUIRE(!slv_ptx_read_face(ptx, face, res[face], expected));
        if (!slv_texture_is_constant(texture, face))
            CHECK(memcmp(expected, slv_texture_texels(texture, face),
                         (size_t)1 << (res[face].u + res[face].v)) == 0);
    }
    slv_texture_destroy(texture);
    res[3].u = 7;
    CHECK(slv_ptx_load_texture_at(&env, ptx, res, &texture) == SLV_ERROR_ARGUMENT);
    slv_ptx_close(ptx);
}

/* What is too large for the memory that there is is told with the file's name. */
static void check_large_meta(void) {
    enum { COUNT = 50 << 20 };
    slv_env env = test_env();
    slv_ptx_writer_params params = {.type = SLV_TYPE_U8, .nchannels = 1, .alpha_channel = -1};
    slv_ptx_writer *writer = NULL;
    slv_ptx_meta meta = {"zeros", SLV_META_INT32, COUNT, calloc(COUNT, 4)};
    params.mesh_type = SLV_PTX_QUAD;
    REQUIRE(meta.values && !slv_ptx_writer_create(&env, tool_path("meta.ptx"), &params, &writer));
    REQUIRE(!slv_ptx_writer_set_meta(writer, &meta) && !slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
    free((void *)(uintptr_t)meta.values);
    LIMITED(1, 250, "check meta.ptx");
    HAS("meta.ptx: metadata entry 0: ");
}

int main(void) {
    slv_env env = test_env();
    slv_mesh *mesh = strip();
    tool_begin();
    REQUIRE(!slv_mesh_save_obj(&env, mesh, tool_path("same.obj")));
    write_ramp("small.ptx", mesh, 6);
    other_resolutions();
    write_ramp("large.ptx", mesh, 12); /* 272 MiB of texels */
    slv_mesh_destroy(mesh);            /* forks end with what is there */
    RUNS(0, "render small.ptx -o small.png --size 256x128 --quiet");
    RUNS(0, "render large.ptx -o large.png --size 256x128 --quiet");
    CHECK(rmse("small.png", "large.png") < 0.004);
    RUNS(0, "reference small.ptx -o small.exr --size 64x32 --samples 8 --quiet");
    RUNS(0, "reference large.ptx -o large.exr --size 64x32 --samples 8 --quiet");
    CHECK(rmse("small.exr", "large.exr") < 0.004);
    if (!TEST_SANITIZED) {
        check_large_meta();
        LIMITED(1, 250, "render large.ptx -o x.png --shading levels --quiet");
        HAS("0.3 GiB of texels are needed in memory, where 0.2 GiB are to be had");
        LIMITED(1, 600, "convert small.ptx x.ptx --scale 256");
        HAS("16384 x 16384 texels of 1 channels are 1.0 GiB, the limit is 0.6 GiB");
        LIMITED(1, 600, "convert small.ptx x.png --scale 256");
        HAS("are 1.0 GiB, the limit");
        RUNS(0, "convert small.ptx pictures/");
        LIMITED(1, 600, "convert pictures x.ptx --scale 256");
        HAS("16384 x 16384 texels");
        LIMITED(0, 600, "transfer large.ptx moved.ptx --to same.obj --threads 1 --quiet");
        tool_write_file("q.txt", "point 0 0 0 1 0 0 0 0 .25 .25 0 0 0 0\n", 38);
        RUNS(0, "sample small.ptx --queries q.txt");
        LIMITED(0, 300, "sample small.ptx --queries q.txt");
        HAS("cache: of 1024 MiB of address space");
        HAS("it makes do with those");
        /* fewer lookups at a time, where there is no room for many */
        LIMITED(0, taken() / MIB + 24, "sample small.ptx --queries q.txt --threads 1");
        HAS(" -> 0.");
    }
    tool_end();
    return test_end();
}
