/* Whatever is asked, and whatever is in the file: a result or finite values, never a crash.
 *
 * test_unit_filter_hostile [SEED [ROUNDS]] */
#include "kit/filter_kit.h"

#include <selvage/ptx_writer.h>

enum { ROOM = 1100 };

static const slv_filter_params all_params[] = {
    {.filter = SLV_FILTER_POINT},
    {.filter = SLV_FILTER_BILINEAR},
    {.filter = SLV_FILTER_BOX},
    {.filter = SLV_FILTER_GAUSSIAN, .lerp = true},
    {.filter = SLV_FILTER_BICUBIC, .sharpness = 1, .lerp = true},
    {.filter = SLV_FILTER_BSPLINE, .blur = 1e30f},
    {.filter = SLV_FILTER_CATMULL_ROM, .width = 1e30f},
    {.filter = SLV_FILTER_MITCHELL, .width = 1e-30f, .first_channel = 2, .nchannels = 2},
    {.filter = SLV_FILTER_GAUSSIAN, .no_edge_blend = true, .blur = 0.3f},
    {.filter = SLV_FILTER_ANISOTROPIC},
    {.filter = SLV_FILTER_ANISOTROPIC, .width = 1e30f, .first_channel = 1, .nchannels = 2},
    {.filter = SLV_FILTER_ANISOTROPIC, .width = 1e-30f, .blur = 1e30f},
};
enum { PARAMS = sizeof all_params / sizeof *all_params };

static uint64_t seed = 1, rounds = 1;

static bool are_finite(const float *out, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!isfinite(out[i]))
            return false;
    return true;
}

static bool are_zero(const float *out, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (out[i] != 0)
            return false;
    return true;
}

static const float odd[] = {0,      -0.0f,     1,         -1,       0.5f,     1e-45f,    -1e-45f,
                            1e30f,  -1e30f,    3.4e38f,   -3.4e38f, INFINITY, -INFINITY, NAN,
                            1e-30f, 0.999999f, 1.000001f, 2,        -2,       1e9f,      65536};
enum { ODD = sizeof odd / sizeof *odd };

/* Rows that are too narrow for what is asked: an error, and nothing beyond them is written. */
static void ask_for_too_much(const char *path) {
    enum { ROWS = 21, MARK = -77 };
    uint64_t random = seed + 47;
    slv_cache *cache = kit_cache(0, 0);
    slv_file_id id = kit_open(cache, path);
    slv_ptx_info info;
    CHECK(slv_cache_get_info(cache, id, &info) == SLV_OK);
    for (int p = 0; p < PARAMS && info.nfaces; p++)
        for (int alike = 0; alike < 2; alike++) {
            slv_filter_params params = all_params[p];
            params.first_channel = 0;
            params.nchannels = alike ? 0 : (uint32_t)(test_random(&random) % 3);
            size_t asked = params.nchannels ? params.nchannels : info.nchannels;
            size_t stride = asked - 1;
            static float out[ROWS * ROOM + 8];
            static char workspace[ROWS * 64];
            slv_lookup lookups[ROWS];
            slv_result results[ROWS];
            slv_sampler *sampler = kit_sampler(cache, &params);
            CHECK(slv_sample_workspace(ROWS) <= sizeof workspace);
            for (int i = 0; i < ROWS; i++) {
                uint32_t face = alike ? 0 : (uint32_t)i % info.nfaces;
                lookups[i] = (slv_lookup){id, face, 0.3f, 0.6f, 0.1f, 0, 0, 0.1f};
            }
            for (int sorted = 0; sorted < 2; sorted++) {
                for (size_t i = 0; i < sizeof out / sizeof *out; i++)
                    out[i] = MARK;
                slv_result result =
                    sorted
                        ? slv_sample_sorted(sampler, lookups, ROWS, out, stride, results, workspace)
                        : slv_sample_batch(sampler, lookups, ROWS, out, stride, results);
                CHECK(result == SLV_ERROR_ARGUMENT);
                for (int i = 0; i < ROWS; i++)
                    CHECK(results[i] == SLV_ERROR_ARGUMENT);
                for (size_t i = ROWS * stride; i < sizeof out / sizeof *out; i++)
                    CHECK(out[i] == MARK);
            }
            slv_sampler_destroy(sampler);
        }
    slv_cache_destroy(cache);
}

static void ask_badly(const char *path) {
    uint64_t random = seed + 43;
    slv_cache *cache = kit_cache(0, 0);
    slv_file_id id = kit_open(cache, path);
    slv_ptx_info info;
    static float out[ROOM];
    CHECK(slv_cache_get_info(cache, id, &info) == SLV_OK);
    bool whole = info.type == SLV_TYPE_U8 || info.type == SLV_TYPE_U16;
    for (int p = 0; p < PARAMS && info.nfaces; p++) {
        slv_sampler *sampler = kit_sampler(cache, &all_params[p]);
        for (int i = 0; i < 3000; i++) {
            slv_lookup l = kit_lookup_any(id, info.nfaces, &random);
            float *fields[6] = {&l.u, &l.v, &l.uw1, &l.vw1, &l.uw2, &l.vw2};
            uint32_t many = 1 + test_random(&random) % 6;
            for (uint32_t j = 0; j < many; j++)
                *fields[test_random(&random) % 6] = odd[test_random(&random) % ODD];
            bool sound = isfinite(l.u) && isfinite(l.v) && !isnan(l.uw1) && !isnan(l.vw1) &&
                         !isnan(l.uw2) && !isnan(l.vw2);
            out[0] = 7;
            slv_result result = slv_sample(sampler, &l, out);
            bool either =
                all_params[p].filter == SLV_FILTER_POINT && isfinite(l.u) && isfinite(l.v);
            CHECK_MSG(either || result == (sound ? SLV_OK : SLV_ERROR_ARGUMENT),
                      "%s, %s: %s for u %g v %g footprint %g %g %g %g", path,
                      slv_filter_name(all_params[p].filter), slv_result_string(result), (double)l.u,
                      (double)l.v, (double)l.uw1, (double)l.vw1, (double)l.uw2, (double)l.vw2);
            uint32_t n = slv_sampler_channels(sampler, id);
            CHECK_MSG(are_finite(out, n) && (!result || are_zero(out, n)) &&
                          (!whole || !n || fabsf(out[0]) < 4),
                      "%s, %s: %g for u %g v %g footprint %g %g %g %g", path,
                      slv_filter_name(all_params[p].filter), (double)out[0], (double)l.u,
                      (double)l.v, (double)l.uw1, (double)l.vw1, (double)l.uw2, (double)l.vw2);
        }
        slv_lookup wrong[] = {{.file = id, .face = info.nfaces},
                              {.file = id, .face = UINT32_MAX},
                              {.file = 0},
                              {.file = id + 1},
                              {.file = id ^ 0x10000},
                              {.file = UINT32_MAX},
                              {.file = 65535}};
        for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
            CHECK(slv_sample(sampler, &wrong[i], out) == SLV_ERROR_ARGUMENT);
        slv_sampler_destroy(sampler);
    }
    slv_filter_params beyond = {.filter = SLV_FILTER_BSPLINE, .first_channel = 70000};
    for (uint32_t n = 0; n < 4; n += 3) {
        beyond.nchannels = n;
        slv_sampler *sampler = kit_sampler(cache, &beyond);
        slv_lookup l = {.file = id, .u = 0.5f, .v = 0.5f};
        float here[4] = {5, 5, 5, 5};
        CHECK(slv_sampler_channels(sampler, id) == 0);
        CHECK(slv_sample(sampler, &l, here) == (info.nfaces ? SLV_OK : SLV_ERROR_ARGUMENT));
        CHECK(are_zero(here, n) && here[n] == 5);
        slv_sampler_destroy(sampler);
    }
    CHECK(slv_cache_close(cache, id) == SLV_OK && slv_cache_close(cache, id) == SLV_ERROR_ARGUMENT);
    CHECK(slv_cache_invalidate(cache, id) == SLV_ERROR_ARGUMENT);
    CHECK(slv_cache_prefetch(cache, id, 0) == SLV_ERROR_ARGUMENT);
    CHECK(slv_cache_get_info(cache, id, &info) == SLV_ERROR_ARGUMENT && info.nfaces == 0);
    slv_cache_destroy(cache);
}

/* An argument is as wrong for texels that are in memory as for others. */
static void ask_twice(const char *path) {
    static float out[ROOM];
    slv_cache *cache = kit_cache(0, 0);
    slv_file_id id = kit_open(cache, path);
    slv_ptx_info info;
    CHECK(slv_cache_get_info(cache, id, &info) == SLV_OK);
    for (int p = 0; p < PARAMS && info.nfaces; p++) {
        slv_sampler *sampler = kit_sampler(cache, &all_params[p]);
        for (uint32_t face = 0; face < info.nfaces && face < 8; face++) {
            slv_lookup l = {.file = id, .face = face, .u = 0.4f, .v = 0.6f, .uw1 = NAN};
            slv_lookup there = {.file = id, .face = face, .u = 0.4f, .v = 0.6f};
            slv_result cold = slv_sample(sampler, &l, out);
            CHECK(slv_sample(sampler, &there, out) == SLV_OK);
            slv_result warm = slv_sample(sampler, &l, out);
            CHECK_MSG(cold == warm, "%s, %s: %s when cold, %s when warm", path,
                      slv_filter_name(all_params[p].filter), slv_result_string(cold),
                      slv_result_string(warm));
        }
        slv_sampler_destroy(sampler);
    }
    slv_cache_destroy(cache);
}

static void test_params(void) {
    slv_cache *cache = kit_cache(0, 0);
    static const slv_filter_params bad[] = {{.filter = SLV_FILTER_COUNT},
                                            {.filter = (slv_filter)-1},
                                            {.sharpness = -0.1f},
                                            {.sharpness = 1.1f},
                                            {.sharpness = NAN},
                                            {.width = -1},
                                            {.width = INFINITY},
                                            {.width = NAN},
                                            {.blur = -1},
                                            {.blur = INFINITY},
                                            {.blur = NAN}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        slv_sampler *sampler = (slv_sampler *)(void *)cache;
        CHECK(slv_sampler_create(cache, &bad[i], &sampler) == SLV_ERROR_ARGUMENT && !sampler);
    }
    slv_cache_destroy(cache);
}

/* Every face, with all filters. Returns how many lookups were answered. */
static uint64_t sample_everything(const char *path, uint32_t times, uint64_t *random) {
    static float out[ROOM];
    slv_cache *cache = kit_cache(1, 0);
    slv_file_id id;
    slv_ptx_info info;
    uint64_t answered = 0, failed = 0;
    if (slv_cache_open(cache, path, &id) || slv_cache_get_info(cache, id, &info)) {
        slv_cache_destroy(cache);
        return 0;
    }
    uint32_t nfaces = info.nfaces < 300 ? info.nfaces : 300;
    bool whole = info.type == SLV_TYPE_U8 || info.type == SLV_TYPE_U16;
    for (int p = 0; p < PARAMS; p++) {
        slv_filter_params params = all_params[p];
        slv_sampler *sampler;
        params.nchannels = 8;
        if (slv_sampler_create(cache, &params, &sampler))
            continue;
        for (uint32_t i = 0; i < nfaces * times; i++) {
            slv_lookup l = kit_lookup_any(id, nfaces, random);
            l.face = i / times;
            slv_result result = slv_sample(sampler, &l, out);
            /* what is not a number in the file may stay so */
            if (whole || result)
                CHECK_MSG(are_finite(out, 8) && (!result || are_zero(out, 8)), "%s face %u, %s: %g",
                          path, l.face, slv_filter_name(params.filter), (double)out[0]);
            answered += !result;
            /* tables that cannot be read are tried again each time */
            failed += result != SLV_OK;
            if (!answered && failed % 40 == 39)
                break;
        }
        slv_sampler_destroy(sampler);
    }
    slv_cache_destroy(cache);
    return answered;
}

static void flip(const char *path) {
    const char *damaged = scratch_path("flipped.ptx");
    size_t size = 0;
    uint64_t random = seed * 7919 + 47, answered = 0;
    uint8_t *bytes = read_whole(path, &size);
    REQUIRE(bytes);
    for (uint64_t turn = 0; turn < test_effort(4) * rounds && size; turn++) {
        uint32_t flips = 1 + test_random(&random) % 8;
        uint8_t *copy = malloc(size + 1);
        REQUIRE(copy);
        memcpy(copy, bytes, size);
        for (uint32_t i = 0; i < flips; i++)
            copy[test_random(&random) % (turn % 3     ? size
                                         : size < 200 ? size
                                                      : 200)] ^=
                (uint8_t)(1u << test_random(&random) % 8);
        FILE *stream = fopen(damaged, "wb");
        REQUIRE(stream && fwrite(copy, 1, size, stream) == size);
        fclose(stream);
        answered += sample_everything(damaged, 3, &random);
        free(copy);
    }
    CHECK(sample_everything(path, 1, &random) > 0 || answered == 0);
    unlink(damaged);
    free(bytes);
}

/* Faces that name any edge of any face, of any shape, and are sub-faces or not. */
static void test_nonsense(uint64_t number, slv_ptx_mesh_type type, slv_border_mode mode) {
    slv_env env = test_env();
    uint64_t random = seed * 104729 + number;
    uint32_t nfaces = 1 + test_random(&random) % 9, nchannels = 1 + test_random(&random) % 9;
    slv_ptx_writer_params params = {.mesh_type = type,
                                    .type = (slv_type)(test_random(&random) % 2),
                                    .nchannels = nchannels,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = nfaces,
                                    .border_u = mode,
                                    .border_v = (slv_border_mode)(test_random(&random) % 3),
                                    .edge_filter = test_random(&random) % 2 ? SLV_EDGE_FILTER_TANVEC
                                                                            : SLV_EDGE_FILTER_NONE};
    slv_ptx_writer *writer = NULL;
    const char *path = scratch_path("nonsense.ptx");
    REQUIRE(slv_ptx_writer_create(&env, path, &params, &writer) == SLV_OK);
    for (uint32_t face = 0; face < nfaces; face++) {
        slv_ptx_face info = {.flags = test_random(&random) % 2 ? SLV_FACE_SUBFACE : 0};
        uint32_t most = test_random(&random) % 7;
        info.res.u = (int8_t)(test_random(&random) % (most + 1));
        info.res.v =
            type == SLV_PTX_TRIANGLE ? info.res.u : (int8_t)(test_random(&random) % (most + 1));
        for (int e = 0; e < 4; e++) {
            info.adjacency.face[e] = (int32_t)(test_random(&random) % (nfaces + 1)) - 1;
            info.adjacency.edge[e] = (uint8_t)(test_random(&random) % (type ? 4 : 3));
        }
        size_t bytes = (kit_texels(info.res) * nchannels) * slv_type_size(params.type);
        uint8_t *texels = malloc(bytes);
        REQUIRE(texels);
        for (size_t i = 0; i < bytes; i++)
            texels[i] = (uint8_t)test_random(&random);
        slv_result result = slv_ptx_writer_write_face(writer, face, &info, texels);
        CHECK_MSG(result == SLV_OK, "%s", test_last_log);
        free(texels);
    }
    slv_result result = slv_ptx_writer_finish(writer);
    CHECK_MSG(result == SLV_OK, "%s", test_last_log);
    slv_ptx_writer_destroy(writer);
    uint64_t answered = sample_everything(path, 40, &random);
    CHECK_MSG(answered == (uint64_t)nfaces * 40 * PARAMS, "case %llu: %llu of %llu answered: %s",
              (unsigned long long)number, (unsigned long long)answered,
              (unsigned long long)nfaces * 40 * PARAMS, test_last_log);
    unlink(path);
}

/* Long and thin, tiny, and huge but constant faces side by side; and more channels than most. */
static void test_shapes(uint32_t nchannels) {
    static const slv_res sizes[] = {{0, 0}, {13, 0}, {0, 13}, {1, 12}, {SLV_MAX_LOG2_RES, 15},
                                    {0, 1}, {9, 2},  {3, 3},  {12, 1}};
    enum { COUNT = sizeof sizes / sizeof *sizes };
    slv_env env = test_env();
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                    .type = SLV_TYPE_U8,
                                    .nchannels = nchannels,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = COUNT};
    slv_ptx_writer *writer = NULL;
    uint64_t random = 53;
    const char *path = scratch_path("shapes.ptx");
    REQUIRE(slv_ptx_writer_create(&env, path, &params, &writer) == SLV_OK);
    for (int32_t face = 0; face < COUNT; face++) {
        slv_ptx_face info = {
            .res = sizes[face],
            .adjacency = {{face, (face + 1) % COUNT, face, (face + COUNT - 1) % COUNT},
                          {2, 3, 0, 1}}};
        bool huge = info.res.u + info.res.v > 13 || nchannels > 100;
        size_t count = huge ? nchannels : kit_texels(info.res) * nchannels;
        uint8_t *texels = malloc(count);
        REQUIRE(texels);
        for (size_t i = 0; i < count; i++)
            texels[i] = (uint8_t)test_random(&random);
        if (huge && face != 7)
            info.flags = SLV_FACE_CONSTANT;
        else if (huge)
            info.res = (slv_res){0, 0};
        CHECK_MSG(slv_ptx_writer_write_face(writer, (uint32_t)face, &info, texels) == SLV_OK, "%s",
                  test_last_log);
        free(texels);
    }
    CHECK(slv_ptx_writer_finish(writer) == SLV_OK);
    slv_ptx_writer_destroy(writer);
    CHECK(sample_everything(path, 100, &random) == (uint64_t)COUNT * 100 * PARAMS);
    ask_badly(path);
    ask_for_too_much(path);
    unlink(path);
}

static void test_channels(void) {
    enum { COUNT = 1050 };
    slv_env env = test_env();
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                    .type = SLV_TYPE_FLOAT,
                                    .nchannels = COUNT,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = 2};
    slv_ptx_writer *writer = NULL;
    const char *path = scratch_path("channels.ptx");
    static float texels[16][COUNT], out[COUNT], part[8];
    uint64_t random = 59;
    REQUIRE(slv_ptx_writer_create(&env, path, &params, &writer) == SLV_OK);
    for (int32_t face = 0; face < 2; face++) {
        slv_ptx_face info = {.res = {2, 2},
                             .adjacency = {{1 - face, 1 - face, 1 - face, 1 - face}, {1, 0, 3, 2}}};
        for (int i = 0; i < 16; i++)
            for (int c = 0; c < COUNT; c++)
                texels[i][c] = (float)c + 0.5f * kit_unit(&random);
        CHECK(slv_ptx_writer_write_face(writer, (uint32_t)face, &info, texels) == SLV_OK);
    }
    CHECK(slv_ptx_writer_finish(writer) == SLV_OK);
    slv_ptx_writer_destroy(writer);
    slv_cache *cache = kit_cache(0, 0);
    slv_file_id id = kit_open(cache, path);
    slv_filter_params filter = {.filter = SLV_FILTER_BSPLINE};
    slv_sampler *all = kit_sampler(cache, &filter);
    for (int i = 0; i < 400; i++) {
        slv_lookup l = kit_lookup_any(id, 2, &random);
        CHECK(slv_sample(all, &l, out) == SLV_OK && are_finite(out, COUNT));
        for (int c = 2; c < COUNT; c++)
            CHECK(out[c] > (float)c - 0.01f && out[c] < (float)c + 0.51f);
        filter.first_channel = 2 + test_random(&random) % (COUNT + 10);
        filter.nchannels = 8;
        slv_sampler *some = kit_sampler(cache, &filter);
        CHECK(slv_sample(some, &l, part) == SLV_OK);
        for (uint32_t c = 0; c < 8; c++) {
            uint32_t at = filter.first_channel + c;
            CHECK(part[c] == 0 ? at >= COUNT
                               : at < COUNT && fabsf(part[c] - out[at]) <= 1e-6f * out[at]);
        }
        slv_sampler_destroy(some);
    }
    slv_sampler_destroy(all);
    slv_cache_destroy(cache);
    unlink(path);
}

int main(int argc, char **argv) {
    seed = argc > 1 ? strtoull(argv[1], NULL, 10) : 1;
    rounds = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    test_params();
    for (uint64_t i = 0; i < test_effort(TEST_SANITIZED ? 40 : 100) * rounds; i++)
        test_nonsense(i, i % 5 ? SLV_PTX_QUAD : SLV_PTX_TRIANGLE, (slv_border_mode)(i % 3));
    test_shapes(3);
    test_shapes(600);
    test_channels();
    CHECK(each_sample(ask_badly) > 0);
    CHECK(each_sample(ask_twice) > 0);
    CHECK(each_sample(flip) > 0);
    return test_end();
}
