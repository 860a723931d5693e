/* However lookups are asked for, of files of any kind at once: one by one, in batches of any
 * length, sorted, of texels that are there or not, or that are thrown away meanwhile, the bytes are
 * the same, and nothing beyond a row's values is written.
 *
 * test_unit_filter_ways [SEED [ROUNDS]] */
#include "kit/filter_kit.h"

#include <selvage/ptx_writer.h>

enum { FILES = 6, MOST_CHANNELS = 7, MOST = 61, ROOM = MOST * (MOST_CHANNELS + 3) + 8 };

enum { FILLER_SIDE = 8, FILLER_FACES = FILLER_SIDE * FILLER_SIDE, FILLER_CHANNELS = 3 };

static const float mark = -12345;
static char filler[1100];
static uint64_t evictions;
static uint64_t printed = UINT64_C(14695981039346656037);

typedef struct files {
    char paths[FILES][1100];
    uint32_t nfaces[FILES], nchannels[FILES];
    uint32_t count;
} files;

static void fill_texels(slv_type type, size_t count, bool odd, uint64_t *random, void *out) {
    for (size_t i = 0; i < count; i++) {
        uint32_t r = test_random(random);
        float x = (float)(r % 1024) / 1023.0f;
        if (type > SLV_TYPE_U16 && odd && r >> 20 % 31 == 0)
            x = r & 1024 ? INFINITY : r & 2048 ? -1e30f : 1e-40f;
        slv_type_from_float(type, &x, 1, (uint8_t *)out + i * slv_type_size(type));
    }
}

/* Every face is next to `face + step` of a torus, or to anything where that makes no sense. */
static void write_file(files *f, uint32_t number, uint64_t *random) {
    slv_env env = test_env();
    uint32_t nx = 1 + test_random(random) % 4, ny = 1 + test_random(random) % 4;
    uint32_t nchannels = 1 + test_random(random) % MOST_CHANNELS,
             nonsense = test_random(random) % 3;
    bool triangles = test_random(random) % 8 == 0, odd = test_random(random) % 4 == 0;
    uint32_t nfaces = nx * ny, wide = test_random(random) % 10;
    slv_type type = (slv_type)(test_random(random) % 4);
    slv_ptx_writer_params params = {
        .mesh_type = triangles ? SLV_PTX_TRIANGLE : SLV_PTX_QUAD,
        .type = type,
        .nchannels = nchannels,
        .alpha_channel = SLV_NO_ALPHA,
        .nfaces = nfaces,
        .border_u = (slv_border_mode)(test_random(random) % 3),
        .border_v = (slv_border_mode)(test_random(random) % 3),
        .edge_filter = test_random(random) % 4 ? SLV_EDGE_FILTER_NONE : SLV_EDGE_FILTER_TANVEC};
    slv_ptx_writer *writer = NULL;
    char name[32];
    snprintf(name, sizeof name, "ways-%u.ptx", number);
    snprintf(f->paths[number], sizeof f->paths[number], "%s", scratch_path(name));
    REQUIRE(slv_ptx_writer_create(&env, f->paths[number], &params, &writer) == SLV_OK);
    for (uint32_t face = 0; face < nfaces; face++) {
        uint32_t x = face % nx, y = face / nx;
        slv_ptx_face info = {
            .res = {(int8_t)(test_random(random) % 7), (int8_t)(test_random(random) % 7)},
            .adjacency = {{(int32_t)(x + (y + ny - 1) % ny * nx), (int32_t)((x + 1) % nx + y * nx),
                           (int32_t)(x + (y + 1) % ny * nx), (int32_t)((x + nx - 1) % nx + y * nx)},
                          {2, 3, 0, 1}}};
        if (wide == 0 && face == 0)
            info.res = (slv_res){9, 8};
        if (wide > 5)
            info.res = (slv_res){(int8_t)(wide - 4), (int8_t)(wide - 4)};
        if (triangles)
            info.res.v = info.res.u;
        for (int e = 0; e < 4; e++) {
            if (test_random(random) % 10 == 0)
                info.adjacency.face[e] = SLV_BOUNDARY;
            if (nonsense == 2 || triangles) {
                info.adjacency.face[e] = (int32_t)(test_random(random) % (nfaces + 1)) - 1;
                info.adjacency.edge[e] = (uint8_t)(test_random(random) % (triangles ? 3 : 4));
            }
        }
        if (nonsense && test_random(random) % 4 == 0)
            info.flags |= SLV_FACE_SUBFACE;
        size_t bytes = kit_texels(info.res) * nchannels * slv_type_size(type);
        uint8_t *texels = malloc(bytes);
        REQUIRE(texels);
        fill_texels(type, kit_texels(info.res) * nchannels, odd, random, texels);
        if (test_random(random) % 6 == 0)
            info.flags |= SLV_FACE_CONSTANT;
        CHECK_MSG(slv_ptx_writer_write_face(writer, face, &info, texels) == SLV_OK, "%s",
                  test_last_log);
        free(texels);
    }
    CHECK_MSG(slv_ptx_writer_finish(writer) == SLV_OK, "%s", test_last_log);
    slv_ptx_writer_destroy(writer);
    f->nfaces[number] = nfaces;
    f->nchannels[number] = nchannels;
    f->count = number + 1;
}

static void make_lookups(const files *f, const slv_file_id *ids, size_t count, bool bad,
                         uint64_t *random, slv_lookup *out) {
    static const float odd[] = {0, -0.0f, 1, -1, 1e-42f, 1e30f, INFINITY, -INFINITY, NAN, 2, 0.5f};
    uint32_t file = test_random(random) % f->count, kind = test_random(random) % 5;
    if (kind == 4) /* all of what does not fit */
        file = f->count - 1;
    for (size_t i = 0; i < count; i++) {
        if (kind == 3 || (kind == 2 && i % 11 == 0))
            file = test_random(random) % f->count;
        out[i] = kit_lookup_any(ids[file], f->nfaces[file], random);
        if (kind == 0)
            out[i].face = (uint32_t)(i / 20) % f->nfaces[file];
        float *fields[6] = {&out[i].u,   &out[i].v,   &out[i].uw1,
                            &out[i].vw1, &out[i].uw2, &out[i].vw2};
        if (test_random(random) % 8 == 0)
            *fields[test_random(random) % 6] = odd[test_random(random) % (bad ? 11 : 6)];
        if (bad && test_random(random) % 20 == 0)
            out[i].face = f->nfaces[file];
        if (bad && test_random(random) % 30 == 0)
            out[i].file = test_random(random) % 2 ? 0 : 60000;
    }
}

static void note_bytes(const float *values, size_t count) {
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        printed = (printed ^ (isnan(values[i]) ? 0 : bits)) * UINT64_C(1099511628211);
    }
}

static bool same(float a, float b) {
    return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

typedef struct answers {
    float values[ROOM];
    slv_result results[MOST], all;
} answers;

static void clear(answers *a) {
    for (size_t i = 0; i < ROOM; i++)
        a->values[i] = mark;
}

static void compare(const answers *a, const answers *b, size_t count, size_t stride, size_t asked,
                    const size_t *channels, const char *way, const char *filter) {
    for (size_t i = 0; i < count; i++) {
        CHECK_MSG(a->results[i] == b->results[i], "%s, %s, lookup %zu of %zu: %s and %s", filter,
                  way, i, count, slv_result_string(a->results[i]),
                  slv_result_string(b->results[i]));
        size_t n = asked ? asked : channels[i];
        for (size_t c = 0; c < n; c++)
            CHECK_MSG(same(a->values[i * stride + c], b->values[i * stride + c]),
                      "%s, %s, lookup %zu of %zu, channel %zu: %.9g and %.9g", filter, way, i,
                      count, c, (double)a->values[i * stride + c],
                      (double)b->values[i * stride + c]);
        for (size_t c = n; c < stride; c++) {
            float x = b->values[i * stride + c];
            CHECK_MSG(x == mark || (!asked && x == 0), "%s, %s: %g written behind a row", filter,
                      way, (double)x);
        }
    }
    for (size_t i = count * stride; i < ROOM; i++)
        CHECK(b->values[i] == mark);
}

enum { CACHES = 3 };

static void try_ways(const files *f, slv_cache *const *caches, slv_file_id ids[CACHES][FILES],
                     const slv_filter_params *params, uint64_t *random) {
    static slv_lookup lookups[CACHES][MOST];
    static answers one, other;
    static uint32_t workspace[2 * MOST];
    size_t count = test_random(random) % (MOST + 1), channels[MOST];
    size_t asked = params->nchannels,
           stride = (asked ? asked : MOST_CHANNELS) + test_random(random) % 4;
    const char *name = slv_filter_name(params->filter);
    uint64_t before = *random;
    bool bad = test_random(random) % 3 == 0;
    for (int i = 0; i < CACHES; i++) {
        *random = before;
        make_lookups(f, ids[i], count, bad, random, lookups[i]);
    }
    clear(&one);
    slv_sampler *sampler = kit_sampler(caches[0], params);
    one.all = SLV_OK;
    for (size_t i = 0; i < count; i++) {
        channels[i] = slv_sampler_channels(sampler, lookups[0][i].file);
        one.results[i] = slv_sample(sampler, &lookups[0][i], one.values + i * stride);
        one.all = one.all ? one.all : one.results[i];
        note_bytes(one.values + i * stride, asked ? asked : channels[i]);
    }
    slv_sampler_destroy(sampler);
    for (int i = 0; i < CACHES; i++) {
        sampler = kit_sampler(caches[i], params);
        for (int way = 0; way < 4; way++) {
            static const char *const ways[] = {"batch", "batch again", "sorted", "one by one"};
            clear(&other);
            if (i == 1 && way % 2 == 0)
                CHECK(slv_cache_invalidate(caches[i], 0) == SLV_OK);
            if (way < 2)
                other.all = slv_sample_batch(sampler, lookups[i], count, other.values, stride,
                                             other.results);
            else if (way == 2)
                other.all = slv_sample_sorted(sampler, lookups[i], count, other.values, stride,
                                              other.results, workspace);
            else {
                other.all = one.all;
                for (size_t k = 0; k < count; k++)
                    other.results[k] =
                        slv_sample(sampler, &lookups[i][k], other.values + k * stride);
            }
            CHECK(other.all == one.all);
            compare(&one, &other, count, stride, asked, channels, ways[way], name);
        }
        slv_sampler_destroy(sampler);
    }
}

static void test_files(uint64_t number) {
    files f = {0};
    uint64_t random = number * 7919 + 11;
    slv_cache *caches[CACHES];
    slv_file_id ids[CACHES][FILES];
    for (uint32_t i = 0; i + 1 < FILES; i++)
        write_file(&f, i, &random);
    memcpy(f.paths[f.count], filler, sizeof filler);
    f.nfaces[f.count] = FILLER_FACES;
    f.nchannels[f.count++] = FILLER_CHANNELS;
    for (int i = 0; i < CACHES; i++) {
        caches[i] = kit_cache(i == 2 ? 1 : 64 << 20, 0);
        for (uint32_t k = 0; k < FILES; k++)
            ids[i][k] = kit_open(caches[i], f.paths[k]);
    }
    for (uint32_t k = 0; k < FILES; k++)
        for (uint32_t face = 0; face < f.nfaces[k]; face++)
            CHECK(slv_cache_prefetch(caches[1], ids[1][k], face) == SLV_OK);
    for (int i = 0; i < 4 * SLV_FILTER_COUNT; i++) {
        slv_filter_params params = {.filter = (slv_filter)(i % SLV_FILTER_COUNT)};
        params.lerp = test_random(&random) % 2;
        params.no_edge_blend = test_random(&random) % 6 == 0;
        params.sharpness = kit_unit(&random);
        params.width = test_random(&random) % 2 ? 0 : 3 * kit_unit(&random);
        params.blur = test_random(&random) % 2 ? 0 : 0.3f * kit_unit(&random);
        params.first_channel = test_random(&random) % 3 ? 0 : test_random(&random) % 5;
        params.nchannels = test_random(&random) % 2 ? 0 : 1 + test_random(&random) % 7;
        try_ways(&f, caches, ids, &params, &random);
    }
    slv_cache_stats stats;
    slv_cache_get_stats(caches[2], &stats);
    evictions += stats.evictions;
    for (int i = 0; i < CACHES; i++)
        slv_cache_destroy(caches[i]);
    for (uint32_t k = 0; k + 1 < FILES; k++)
        unlink(f.paths[k]);
}

/* More than the smallest cache holds, in tiles. */
static void write_filler(void) {
    uint64_t random = 83;
    kit k;
    kit_grid(&k, FILLER_SIDE, FILLER_SIDE, true, 0, &random, NULL);
    kit_equal(&k, 8);
    kit_rough(&k, SLV_TYPE_U8, FILLER_CHANNELS, &random);
    snprintf(filler, sizeof filler, "%s", scratch_path("ways-filler.ptx"));
    kit_save(&k, filler, NULL);
    kit_free(&k);
}

int main(int argc, char **argv) {
    uint64_t seed = argc > 1 ? strtoull(argv[1], NULL, 10) : 1;
    uint64_t rounds = argc > 2 ? strtoull(argv[2], NULL, 10) : TEST_SANITIZED ? 4 : test_effort(10);
    write_filler();
    for (uint64_t i = 0; i < rounds; i++)
        test_files(seed * 1000 + i);
    unlink(filler);
    CHECK(evictions > rounds);
    fprintf(stderr, "values: %016llx\n", (unsigned long long)printed);
    return test_end();
}
