/* Tiles of faces against the whole face: all types, meshes and resolutions, files of others,
 * damage, and how much memory it takes. */
#include "kit/ptx_kit.h"

#include <selvage/ptx_writer.h>

#include <malloc.h>

static uint64_t seed = 11;
static uint32_t nerrors;

static void count_errors(void *user, slv_log_level level, const char *message) {
    test_log(user, level, message);
    nerrors += level == SLV_LOG_ERROR;
}

/* What malloc has given out; zero under AddressSanitizer. */
static size_t heap_bytes(void) {
    struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

static uint32_t below(uint32_t end) {
    return test_random(&seed) % end;
}

/* Finite values of any type: bytes below 60 make small halves and floats. */
static void fill(uint8_t *texels, size_t size) {
    uint32_t kind = below(3);
    for (size_t i = 0; i < size; i++)
        texels[i] = (uint8_t)(kind ? test_random(&seed) % 60 : i / 9 % 50);
}

static slv_ptx *open_file(const char *path, bool premultiply) {
    slv_env env = test_env();
    slv_ptx_open_params params = {.premultiply = premultiply};
    slv_ptx *ptx = NULL;
    REQUIRE(slv_ptx_open_with(&env, path, &params, &ptx) == SLV_OK);
    return ptx;
}

/* Every tile of a face at one resolution and size, in an order of its own. */
static void compare_tiles(const slv_ptx *ptx, slv_ptx_reader *reader, uint32_t face, slv_res res,
                          slv_res size, const uint8_t *whole, uint8_t *tile) {
    size_t pixel = slv_ptx_get_info(ptx)->nchannels * slv_type_size(slv_ptx_get_info(ptx)->type);
    uint32_t log2_count = (uint32_t)(res.u - size.u + res.v - size.v), count = 1u << log2_count;
    uint32_t mix = below(2) ? 0 : below(count), nread = count < 150 ? count : 150;
    for (uint32_t turn = 0; turn < nread; turn++) {
        uint32_t i = turn ^ mix;
        uint32_t x = (i & ((1u << (res.u - size.u)) - 1)) << size.u;
        uint32_t y = i >> (res.u - size.u) << size.v;
        REQUIRE(slv_ptx_reader_read_tile(reader, face, res, size, x, y, tile) == SLV_OK);
        size_t row = pixel << size.u;
        bool same = true;
        for (size_t v = 0; v < (size_t)1 << size.v && same; v++)
            same = !memcmp(tile + v * row, whole + ((((size_t)y + v) << res.u) + x) * pixel, row);
        CHECK_MSG(same, "%s: face %u at %d,%d: the tile of %d,%d at %u,%u", slv_ptx_name(ptx), face,
                  res.u, res.v, size.u, size.v, x, y);
    }
}

static slv_res random_res(slv_res most, bool square) {
    slv_res res = {(int8_t)(most.u - (int)below((uint32_t)most.u + 1)),
                   (int8_t)(most.v - (int)below((uint32_t)most.v + 1))};
    if (below(2)) /* the usual: both sides halved as often */
        res.v = (int8_t)(most.v - (most.u - res.u));
    if (res.v < 0 || square)
        res.v = square ? res.u : 0;
    if (below(3) == 0)
        res = most;
    return res;
}

/* The texels as the format defines them, one whole level after the other: slv_ptx_reader_read
 * cannot vouch for tiles that the same code makes. NULL where the stored texels are all that there
 * is. */
static uint8_t *reduce_whole(const slv_ptx *ptx, uint32_t face, slv_res res) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    bool triangle = info->mesh_type == SLV_PTX_TRIANGLE;
    size_t pixel = info->nchannels * slv_type_size(info->type);
    slv_ptx_face f;
    slv_ptx_block block;
    REQUIRE(slv_ptx_get_face(ptx, face, &f) == SLV_OK);
    int du = f.res.u - res.u, dv = f.res.v - res.v;
    uint8_t *texels = malloc(pixel << (res.u + res.v));
    bool stored = false;
    if (du == dv && du < (int)info->nlevels) {
        REQUIRE(slv_ptx_get_block(ptx, face, (uint32_t)du, &block) == SLV_OK);
        stored = block.stored;
    }
    if (stored || (f.flags & SLV_FACE_CONSTANT) || (res.u == 0 && res.v == 0)) {
        REQUIRE(slv_ptx_read_face(ptx, face, res, texels) == SLV_OK);
        return texels;
    }
    bool along_u = du > dv || (du == dv && (res.u & 1));
    slv_res finer = {(int8_t)(res.u + (triangle || along_u)),
                     (int8_t)(res.v + (triangle || !along_u))};
    uint8_t *from = reduce_whole(ptx, face, finer);
    if (triangle)
        slv_ptx_reduce(info->mesh_type, info->type, info->nchannels, finer, from, texels);
    else {
        size_t step = along_u ? 1 : (size_t)1 << finer.u;
        for (size_t y = 0; y < (size_t)1 << res.v; y++)
            for (size_t x = 0; x < (size_t)1 << res.u; x++) {
                size_t at = along_u ? (y << finer.u) + 2 * x : (2 * y << finer.u) + x;
                for (uint32_t c = 0; c < info->nchannels; c++) {
                    size_t a = at * info->nchannels + c, b = a + step * info->nchannels;
                    size_t to = ((y << res.u) + x) * info->nchannels + c;
                    float pair[2];
                    uint16_t *half = (uint16_t *)(void *)from;
                    switch (info->type) {
                    case SLV_TYPE_U8:
                        texels[to] = (uint8_t)((from[a] + from[b]) / 2);
                        break;
                    case SLV_TYPE_U16:
                        ((uint16_t *)(void *)texels)[to] = (uint16_t)((half[a] + half[b]) / 2);
                        break;
                    case SLV_TYPE_HALF:
                        slv_type_to_float(SLV_TYPE_HALF, half + a, 1, pair);
                        slv_type_to_float(SLV_TYPE_HALF, half + b, 1, pair + 1);
                        pair[0] = 0.5f * (pair[0] + pair[1]);
                        slv_type_from_float(SLV_TYPE_HALF, pair, 1,
                                            (uint16_t *)(void *)texels + to);
                        break;
                    case SLV_TYPE_FLOAT:
                        ((float *)(void *)texels)[to] =
                            0.5f * (((float *)(void *)from)[a] + ((float *)(void *)from)[b]);
                        break;
                    }
                }
            }
    }
    free(from);
    return texels;
}

static void check_face(const slv_ptx *ptx, slv_ptx_reader *reader, uint32_t face, int rounds) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    bool square = info->mesh_type == SLV_PTX_TRIANGLE;
    size_t pixel = info->nchannels * slv_type_size(info->type);
    slv_ptx_face f;
    REQUIRE(slv_ptx_get_face(ptx, face, &f) == SLV_OK);
    for (int round = 0; round < rounds; round++) {
        slv_res res = random_res(f.res, square);
        uint8_t *expected = reduce_whole(ptx, face, res), *whole, *tile;
        size_t bytes = pixel << (res.u + res.v);
        whole = malloc(bytes);
        tile = malloc(bytes);
        REQUIRE(slv_ptx_reader_read(reader, face, res, whole) == SLV_OK);
        CHECK_MSG(!memcmp(whole, expected, bytes), "%s: face %u at %d,%d", slv_ptx_name(ptx), face,
                  res.u, res.v);
        for (int again = 0; again < 3; again++)
            compare_tiles(ptx, reader, face, res, random_res(res, square), expected, tile);
        free(expected);
        free(whole);
        free(tile);
    }
}

static void check_averages(const slv_ptx *ptx) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    size_t pixel = info->nchannels * slv_type_size(info->type);
    const uint8_t *averages = slv_ptx_get_averages(ptx);
    uint8_t *texel = malloc(pixel);
    REQUIRE(averages);
    for (uint32_t face = 0; face < info->nfaces; face++) {
        REQUIRE(slv_ptx_read_face(ptx, face, (slv_res){0, 0}, texel) == SLV_OK);
        CHECK_MSG(!memcmp(texel, averages + face * pixel, pixel), "face %u", face);
    }
    free(texel);
}

static void check_table_bytes(const char *path) {
    slv_ptx *ptx = open_file(path, false);
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    uint64_t before = slv_ptx_table_bytes(ptx), full = slv_ptx_full_table_bytes(ptx);
    uint64_t averages = (uint64_t)info->nfaces * info->nchannels * slv_type_size(info->type);
    CHECK(full >= before + averages + 24 * (uint64_t)info->nfaces);
    CHECK(slv_ptx_get_averages(ptx) && slv_ptx_table_bytes(ptx) == before + averages);
    REQUIRE(slv_ptx_load_tables(ptx) == SLV_OK);
    CHECK(slv_ptx_table_bytes(ptx) == full && slv_ptx_full_table_bytes(ptx) == full);
    slv_ptx_close(ptx);
}

static void check_file(const char *path, bool premultiply, int rounds) {
    slv_env env = test_env();
    slv_ptx *ptx = open_file(path, premultiply);
    slv_ptx_reader *reader = NULL;
    REQUIRE(slv_ptx_reader_create(&env, ptx, &reader) == SLV_OK);
    for (uint32_t face = 0; face < slv_ptx_get_info(ptx)->nfaces; face++)
        check_face(ptx, reader, face, rounds);
    check_averages(ptx);
    slv_ptx_reader_destroy(reader);
    slv_ptx_close(ptx);
}

static void write_face(slv_ptx_writer *writer, const slv_ptx_writer_params *p, uint32_t face,
                       slv_res res) {
    size_t size = (slv_type_size(p->type) * p->nchannels) << (res.u + res.v);
    slv_ptx_face info = {.res = res, .adjacency.face = {-1, -1, -1, -1}};
    uint8_t *texels = malloc(size);
    fill(texels, size);
    if (below(3) == 0) /* so that there are constant tiles */
        memset(texels, 7, size / 2);
    if (below(9) == 0)
        memset(texels, 9, size);
    REQUIRE(slv_ptx_writer_write_face(writer, face, &info, texels) == SLV_OK);
    free(texels);
}

static void random_file(slv_ptx_mesh_type mesh_type, slv_type type, uint32_t nchannels) {
    slv_env env = test_env();
    slv_ptx_writer_params p = {.mesh_type = mesh_type,
                               .type = type,
                               .nchannels = nchannels,
                               .alpha_channel = (int32_t)below(nchannels + 1) - 1,
                               .nfaces = 6,
                               .no_reductions = below(2)};
    slv_ptx_writer *writer = NULL;
    const char *path = scratch_path("tiles.ptx");
    for (int edit = 0; edit < 2; edit++) {
        REQUIRE((edit ? slv_ptx_writer_edit(&env, path, NULL, &writer)
                      : slv_ptx_writer_create(&env, path, &p, &writer)) == SLV_OK);
        for (uint32_t face = 0; face < p.nfaces; face += 1 + 2 * (uint32_t)edit) {
            slv_res res = {(int8_t)below(face ? 8 : 10), (int8_t)below(face ? 8 : 10)};
            if (face == 0) /* large enough for tiles */
                res = (slv_res){(int8_t)(9 - below(2)), 9};
            if (mesh_type == SLV_PTX_TRIANGLE)
                res.v = res.u;
            write_face(writer, &p, face, res);
        }
        REQUIRE(slv_ptx_writer_finish(writer) == SLV_OK);
        slv_ptx_writer_destroy(writer);
        for (int premultiply = 0; premultiply < 2; premultiply++)
            if (!test_skip((uint32_t)(premultiply + edit), 2))
                check_file(path, premultiply, (int)test_effort(2));
        check_table_bytes(path);
    }
    remove(path);
}

static void check_sample(const char *path) {
    check_file(path, false, (int)test_effort(2));
    check_file(path, true, (int)test_effort(1));
    check_table_bytes(path);
}

static void store_u32(uint8_t *to, uint64_t value) {
    for (int i = 0; i < 4; i++)
        to[i] = (uint8_t)(value >> 8 * i);
}

/* A zlib stream that packs nothing. */
static size_t store_zlib(const uint8_t *in, size_t size, uint8_t *out) {
    uint32_t a = 1, b = 0;
    uint8_t *to = out;
    *to++ = 0x78;
    *to++ = 1;
    for (size_t i = 0; i < size; i++) {
        a = (a + in[i]) % 65521;
        b = (b + a) % 65521;
    }
    for (size_t at = 0, n; at < size; at += n, to += n) {
        n = size - at < 65535 ? size - at : 65535;
        uint8_t head[5] = {at + n == size, (uint8_t)n, (uint8_t)(n >> 8), (uint8_t)~n,
                           (uint8_t)(~n >> 8)};
        memcpy(to, head, 5);
        to += 5;
        memcpy(to, in + at, n);
    }
    uint8_t tail[4] = {(uint8_t)(b >> 8), (uint8_t)b, (uint8_t)(a >> 8), (uint8_t)a};
    memcpy(to, tail, 4);
    return (size_t)(to - out) + 4;
}

/* A face of 2^u x 2^u uint8 texels in a file of one. */
static void write_noise(const char *path, slv_ptx_mesh_type mesh_type, int8_t u) {
    slv_env env = test_env();
    slv_ptx_writer_params p = {.mesh_type = mesh_type,
                               .nchannels = 1,
                               .alpha_channel = SLV_NO_ALPHA,
                               .nfaces = 1,
                               .no_reductions = true};
    slv_ptx_face info = {.res = {u, u}, .adjacency.face = {-1, -1, -1, -1}};
    slv_ptx_writer *writer = NULL;
    size_t size = (size_t)1 << 2 * u;
    uint8_t *texels = malloc(size);
    for (size_t i = 0; i < size; i++)
        texels[i] = (uint8_t)test_random(&seed);
    REQUIRE(slv_ptx_writer_create(&env, path, &p, &writer) == SLV_OK);
    REQUIRE(slv_ptx_writer_write_face(writer, 0, &info, texels) == SLV_OK);
    REQUIRE(slv_ptx_writer_finish(writer) == SLV_OK);
    slv_ptx_writer_destroy(writer);
    free(texels);
}

static void write_bytes(const char *path, const uint8_t *bytes, size_t size) {
    FILE *stream = fopen(path, "wb");
    REQUIRE(stream && fwrite(bytes, 1, size, stream) == size);
    fclose(stream);
}

/* A large face without tiles, which our writer does not make: an edit put together here. */
static void large_without_tiles(slv_ptx_mesh_type mesh_type) {
    const char *path = scratch_path("untiled.ptx");
    size_t size = 0, count = 1 << 20;
    write_noise(path, mesh_type, 2);
    uint8_t *file = read_whole(path, &size), *differences = malloc(count);
    file = realloc(file, size + count + 4096);
    for (size_t i = 0; i < count; i++)
        differences[i] = (uint8_t)test_random(&seed);
    uint8_t *edit = file + size, *block = edit + 5 + 4 + 20 + 4 + 1;
    size_t packed = store_zlib(differences, count, block), bytes = packed + 34;
    memset(edit, 0xff, 34);
    edit[0] = 0;
    store_u32(edit + 1, bytes - 5);
    store_u32(edit + 5, 0);
    memcpy(edit + 9, (uint8_t[4]){10, 10, 0, 0}, 4);
    store_u32(edit + 29, packed | UINT32_C(2) << 30);
    edit[33] = 3;
    store_u32(file + 88, bytes);
    store_u32(file + 92, 0);
    store_u32(file + 96, size);
    store_u32(file + 100, 0);
    write_bytes(path, file, size + bytes);
    check_file(path, false, 6);
    free(file);
    free(differences);
    remove(path);
}

/* A source that counts. */
struct counted {
    struct memory_file file;
    uint64_t bytes;
};

static int counted_read(void *user, uint64_t offset, void *buffer, size_t size) {
    struct counted *counted = user;
    counted->bytes += size;
    return memory_read(&counted->file, offset, buffer, size);
}

/* However large the face, the memory is small; and nothing is read twice. */
static void little_memory(slv_ptx_mesh_type mesh_type) {
    slv_env env = test_env();
    struct counted counted = {{0}, 0};
    size_t size = 0;
    const char *path = scratch_path("large.ptx");
    write_noise(path, mesh_type, 12);
    uint8_t *bytes = read_whole(path, &size), tile[4096], whole[16];
    counted.file = (struct memory_file){bytes, size, 0};
    slv_stream_in source = {counted_read, NULL, &counted, size};
    slv_ptx *ptx = NULL;
    slv_ptx_reader *reader = NULL;
    REQUIRE(slv_ptx_open_stream(&env, path, &source, &ptx) == SLV_OK);
    REQUIRE(slv_ptx_load_tables(ptx) == SLV_OK);
    size_t heap = heap_bytes();
    env.max_bytes = 200 << 10; /* for each allocation of the reader */
    REQUIRE(slv_ptx_reader_create(&env, ptx, &reader) == SLV_OK);
    slv_res two = {2, 2}, one = {1, 1}, six = {6, 6}, full = {12, 12}, eleven = {11, 11};
    REQUIRE(slv_ptx_reader_read_tile(reader, 0, full, six, 256, 512, tile) == SLV_OK);
    CHECK(counted.bytes < 200 << 10);
    uint64_t before = counted.bytes;
    REQUIRE(slv_ptx_reader_read_tile(reader, 0, full, six, 320, 576, tile) == SLV_OK);
    if (mesh_type == SLV_PTX_QUAD)
        REQUIRE(slv_ptx_reader_read_tile(reader, 0, eleven, six, 192, 320, tile) == SLV_OK);
    CHECK(counted.bytes == before);
    REQUIRE(slv_ptx_reader_read_tile(reader, 0, two, two, 0, 0, whole) == SLV_OK);
    CHECK_MSG(heap_bytes() - heap < 640 << 10, "%zu", heap_bytes() - heap);
    CHECK_MSG(counted.bytes - before < size + size / 10, "%llu of %zu",
              (unsigned long long)(counted.bytes - before), size);
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t x = i % 2 * 2, y = i / 2 * 2;
        REQUIRE(slv_ptx_reader_read_tile(reader, 0, two, one, x, y, tile) == SLV_OK);
        CHECK(!memcmp(tile, whole + 4 * y + x, 2) && !memcmp(tile + 2, whole + 4 * y + 4 + x, 2));
    }
    slv_ptx_reader_destroy(reader);
    slv_ptx_close(ptx);

    ptx = open_file(path, false);
    env.max_bytes = 0;
    REQUIRE(slv_ptx_reader_create(&env, ptx, &reader) == SLV_OK);
    check_face(ptx, reader, 0, 3);
    slv_ptx_reader_destroy(reader);
    slv_ptx_close(ptx);
    free(bytes);
    remove(path);
}

static void wrong_arguments(void) {
    static const struct {
        uint32_t face;
        slv_res res, size;
        uint32_t x, y;
    } wrong[] = {{1, {3, 3}, {1, 1}, 0, 0},    {0, {3, 5}, {1, 1}, 0, 0},
                 {0, {-1, 0}, {0, 0}, 0, 0},   {0, {3, 3}, {4, 3}, 0, 0},
                 {0, {3, 3}, {-1, 2}, 0, 0},   {0, {3, 3}, {1, 1}, 1, 0},
                 {0, {3, 3}, {2, 2}, 0, 2},    {0, {3, 3}, {1, 1}, 8, 0},
                 {0, {3, 3}, {0, 0}, 0, 8},    {0, {3, 3}, {1, 1}, 0, UINT32_C(1) << 31},
                 {0, {3, 3}, {127, 127}, 0, 0}};
    for (int triangle = 0; triangle < 2; triangle++) {
        const char *path = scratch_path("wrong.ptx");
        slv_env env = {.log = count_errors};
        slv_ptx_reader *reader = NULL;
        uint8_t texels[64];
        write_noise(path, triangle ? SLV_PTX_TRIANGLE : SLV_PTX_QUAD, 4);
        slv_ptx *ptx = open_file(path, false);
        REQUIRE(slv_ptx_reader_create(&env, ptx, &reader) == SLV_OK);
        for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
            nerrors = 0;
            CHECK_MSG(slv_ptx_reader_read_tile(reader, wrong[i].face, wrong[i].res, wrong[i].size,
                                               wrong[i].x, wrong[i].y,
                                               texels) == SLV_ERROR_ARGUMENT &&
                          nerrors == 1 && strstr(test_last_log, "face"),
                      "case %zu", i);
        }
        nerrors = 0;
        slv_result result =
            slv_ptx_reader_read_tile(reader, 0, (slv_res){3, 3}, (slv_res){2, 1}, 4, 2, texels);
        CHECK(result == (triangle ? SLV_ERROR_ARGUMENT : SLV_OK) && nerrors == (uint32_t)triangle);
        slv_ptx_reader_destroy(reader);
        slv_ptx_close(ptx);
        remove(path);
    }
}

/* One damaged tile of four, then a damaged table. */
static void damage(void) {
    const char *path = scratch_path("damaged.ptx");
    slv_env env = {.log = count_errors};
    slv_res full = {9, 9}, half = {8, 8}, small = {4, 4};
    size_t size = 0;
    uint8_t texels[256];
    slv_ptx_block block;
    slv_ptx *ptx = NULL;
    slv_ptx_reader *reader = NULL;
    write_noise(path, SLV_PTX_QUAD, 9);
    ptx = open_file(path, false);
    REQUIRE(slv_ptx_get_block(ptx, 0, 0, &block) == SLV_OK && block.encoding == SLV_PTX_TILED);
    slv_ptx_close(ptx);
    uint8_t *bytes = read_whole(path, &size);
    bytes[block.position + block.bytes - 100] ^= 5;
    for (int table = 0; table < 2; table++) {
        if (table)
            bytes[block.position] = 77;
        write_bytes(path, bytes, size);
        ptx = open_file(path, false);
        REQUIRE(slv_ptx_reader_create(&env, ptx, &reader) == SLV_OK);
        for (int again = 0; again < 2; again++) {
            nerrors = 0;
            slv_result good = slv_ptx_reader_read_tile(reader, 0, full, small, 0, 0, texels);
            CHECK(good == (table ? SLV_ERROR_FORMAT : SLV_OK) && nerrors == (uint32_t)table);
            nerrors = 0;
            CHECK(slv_ptx_reader_read_tile(reader, 0, full, small, 496, 496, texels) ==
                      SLV_ERROR_FORMAT &&
                  nerrors == 1 && strstr(test_last_log, "face 0"));
            nerrors = 0;
            CHECK(slv_ptx_reader_read_tile(reader, 0, half, small, 240, 240, texels) ==
                      SLV_ERROR_FORMAT &&
                  nerrors == 1);
        }
        slv_ptx_reader_destroy(reader);
        slv_ptx_close(ptx);
    }
    free(bytes);
    remove(path);
}

int main(void) {
    for (uint32_t type = 0; type < 4; type++)
        for (uint32_t nchannels = 1 + type % 2; nchannels <= 5; nchannels += 2)
            for (int mesh_type = 0; mesh_type < 2; mesh_type++)
                random_file((slv_ptx_mesh_type)mesh_type, (slv_type)type, nchannels);
    CHECK(each_sample(check_sample) > 0);
    large_without_tiles(SLV_PTX_QUAD);
    large_without_tiles(SLV_PTX_TRIANGLE);
    little_memory(SLV_PTX_QUAD);
    little_memory(SLV_PTX_TRIANGLE);
    wrong_arguments();
    damage();
    return test_end();
}
