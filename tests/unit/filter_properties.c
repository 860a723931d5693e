/* What must hold of every filter, whatever the texture. */
#include "kit/filter_kit.h"

#include <selvage/ptx_writer.h>

enum { SIDE = 5, LOG2 = 5, ROOM = 4, MANY = 200 };

static const slv_filter_params all_params[] = {
    {.filter = SLV_FILTER_POINT},
    {.filter = SLV_FILTER_BILINEAR},
    {.filter = SLV_FILTER_BOX},
    {.filter = SLV_FILTER_GAUSSIAN},
    {.filter = SLV_FILTER_GAUSSIAN, .lerp = true},
    {.filter = SLV_FILTER_BICUBIC, .sharpness = 0.5f},
    {.filter = SLV_FILTER_BICUBIC, .sharpness = 0.9f, .lerp = true},
    {.filter = SLV_FILTER_BSPLINE},
    {.filter = SLV_FILTER_CATMULL_ROM},
    {.filter = SLV_FILTER_MITCHELL, .width = 2, .blur = 0.05f},
    {.filter = SLV_FILTER_BSPLINE, .no_edge_blend = true},
    {.filter = SLV_FILTER_ANISOTROPIC},
    {.filter = SLV_FILTER_ANISOTROPIC, .width = 3, .blur = 0.1f, .no_edge_blend = true},
};
enum { PARAMS = sizeof all_params / sizeof *all_params };

static void sample_constant(const char *path, const char *what, float value, uint64_t *random) {
    slv_cache *cache = kit_cache(0, 0);
    slv_file_id id = kit_open(cache, path);
    slv_ptx_info info;
    CHECK(slv_cache_get_info(cache, id, &info) == SLV_OK);
    for (int p = 0; p < PARAMS; p++) {
        slv_sampler *sampler = kit_sampler(cache, &all_params[p]);
        float worst = 0;
        for (uint32_t i = 0; i < test_effort(MANY); i++) {
            slv_lookup l = kit_lookup_any(id, info.nfaces, random);
            float out[ROOM] = {-1};
            CHECK(slv_sample(sampler, &l, out) == SLV_OK);
            worst = fmaxf(worst, fabsf(out[0] - value));
        }
        CHECK_MSG(worst <= 2e-6f, "%s, %s: %g away from the constant", what,
                  slv_filter_name(all_params[p].filter), (double)worst);
        slv_sampler_destroy(sampler);
    }
    slv_cache_destroy(cache);
}

/* One value everywhere, but as texels: constant faces would be too easy. */
static void write_flat(kit *k, const char *path, slv_border_mode mode, float value) {
    slv_env env = test_env();
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                    .type = SLV_TYPE_FLOAT,
                                    .nchannels = 2,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = k->nfaces,
                                    .border_u = mode,
                                    .border_v = mode};
    slv_ptx_writer *writer = NULL;
    REQUIRE(slv_ptx_writer_create(&env, path, &params, &writer) == SLV_OK);
    REQUIRE(slv_ptx_writer_set_adjacency(writer, k->adjacency) == SLV_OK);
    for (uint32_t face = 0; face < k->nfaces; face++) {
        size_t count = kit_texels(k->res[face]);
        float *texels = malloc(2 * count * sizeof *texels);
        REQUIRE(texels);
        for (size_t i = 0; i < count; i++) {
            texels[2 * i] = value;
            texels[2 * i + 1] = (float)i; /* so that the face is not constant */
        }
        slv_ptx_face info = {.res = k->res[face]};
        REQUIRE(slv_ptx_writer_write_face(writer, face, &info, texels) == SLV_OK);
        free(texels);
    }
    REQUIRE(slv_ptx_writer_finish(writer) == SLV_OK);
    slv_ptx_writer_destroy(writer);
}

static void test_constants(void) {
    uint64_t random = 3;
    char path[1100];
    snprintf(path, sizeof path, "%s", scratch_path("constant.ptx"));
    for (int shape = 0; shape < 13; shape++)
        for (int mixed = 0; mixed < 2; mixed++) {
            kit k;
            char what[64];
            slv_border_mode mode = shape & 1 ? SLV_BORDER_PERIODIC : SLV_BORDER_CLAMP;
            snprintf(what, sizeof what, "shape %d%s", shape, mixed ? ", mixed" : "");
            if (shape < 10)
                kit_disc(&k, shape + 3, &random);
            else if (shape == 10)
                kit_pentagons(&k, &random);
            else
                kit_grid(&k, 4, 3, shape == 12, 40, &random, NULL);
            if (mixed)
                for (uint32_t i = 0; i < k.nfaces; i++)
                    k.res[i] = (slv_res){(int8_t)(test_random(&random) % 6),
                                         (int8_t)(test_random(&random) % 6)};
            else
                kit_equal(&k, 4);
            write_flat(&k, path, mode, 0.375f);
            sample_constant(path, what, 0.375f, &random);
            kit_free(&k);
        }
    unlink(path);
}

static void test_constant_triangles(void) {
    slv_env env = test_env();
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_TRIANGLE,
                                    .type = SLV_TYPE_FLOAT,
                                    .nchannels = 2,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = 4};
    /* a tetrahedron, whose faces meet at any edges */
    static const int32_t face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    static const uint8_t edge[4][3] = {{0, 2, 1}, {0, 1, 1}, {2, 1, 1}, {0, 1, 2}};
    slv_ptx_writer *writer = NULL;
    uint64_t random = 5;
    char path[1100];
    snprintf(path, sizeof path, "%s", scratch_path("triangles.ptx"));
    REQUIRE(slv_ptx_writer_create(&env, path, &params, &writer) == SLV_OK);
    for (uint32_t f = 0; f < 4; f++) {
        int8_t log2 = (int8_t)(2 + f);
        slv_ptx_face info = {.res = {log2, log2}};
        float texels[2 << 10];
        for (int e = 0; e < 3; e++) {
            info.adjacency.face[e] = face[f][e];
            info.adjacency.edge[e] = edge[f][e];
        }
        info.adjacency.face[3] = -1;
        for (int i = 0; i < 1 << 2 * log2; i++) {
            texels[2 * i] = 0.625f;
            texels[2 * i + 1] = (float)i;
        }
        REQUIRE(slv_ptx_writer_write_face(writer, f, &info, texels) == SLV_OK);
    }
    REQUIRE(slv_ptx_writer_finish(writer) == SLV_OK);
    slv_ptx_writer_destroy(writer);
    sample_constant(path, "triangles", 0.625f, &random);
    unlink(path);
}

/* From a point of a face whose first corner is corner `turn` of its cell to the cell's own axes. */
static void to_cell(uint32_t turn, float u, float v, float *x, float *y) {
    *x = turn == 0 ? u : turn == 1 ? 1 - v : turn == 2 ? 1 - u : v;
    *y = turn == 0 ? v : turn == 1 ? u : turn == 2 ? 1 - v : 1 - u;
}

static void from_cell(uint32_t turn, float x, float y, float *u, float *v) {
    *u = turn == 0 ? x : turn == 1 ? y : turn == 2 ? 1 - x : 1 - y;
    *v = turn == 0 ? y : turn == 1 ? 1 - x : turn == 2 ? 1 - y : x;
}

/* A lookup at a place of a cell, footprint w and all. */
static slv_lookup cell_lookup(slv_file_id id, uint32_t face, uint32_t turn, float x, float y,
                              const float w[4]) {
    slv_lookup l = {.file = id, .face = face};
    float u0, v0;
    from_cell(turn, x, y, &l.u, &l.v);
    from_cell(turn, 0, 0, &u0, &v0);
    from_cell(turn, w[0], w[1], &l.uw1, &l.vw1);
    from_cell(turn, w[2], w[3], &l.uw2, &l.vw2);
    l.uw1 -= u0;
    l.uw2 -= u0;
    l.vw1 -= v0;
    l.vw2 -= v0;
    return l;
}

typedef float (*texture_fn)(float x, float y, uint64_t *random);

static float ramp(float x, float y, uint64_t *random) {
    (void)random;
    return 0.1f * x + 0.07f * y;
}

static float noise(float x, float y, uint64_t *random) {
    (void)x;
    (void)y;
    return kit_unit(random);
}

/* The same texture over faces that each begin where `turns` says; a grid if `count` is 0, else that
 * many faces around a vertex. Some cells may be coarser. */
static void write_cells(const char *path, uint32_t count, bool mixed, uint64_t *turned,
                        texture_fn texture, uint32_t *turns) {
    enum { SIZE = 1 << LOG2 };
    static float cell[SIZE * SIZE];
    uint64_t random = 17;
    kit k;
    if (count) {
        memset(&k, 0, sizeof k);
        for (uint32_t i = 0; i < count; i++) {
            int32_t n = (int32_t)i, next = (int32_t)((i + 1) % count);
            int32_t quad[4] = {0, 1 + 2 * n, 2 + 2 * n, 1 + 2 * next};
            turns[i] = turned ? test_random(turned) % 4 : 0;
            kit_poly(&k, 4, quad, turns[i]);
        }
        kit_finish(&k);
    } else
        kit_grid(&k, SIDE, SIDE, false, 0, turned, turns);
    for (uint32_t face = 0; face < k.nfaces; face++)
        k.res[face].u = k.res[face].v = (int8_t)(LOG2 - (mixed ? face % 3 : 0));
    kit_begin_texture(&k, SLV_TYPE_FLOAT, 1);
    for (uint32_t face = 0; face < k.nfaces; face++) {
        float values[SIZE * SIZE], column = (float)(face % SIDE), row = (float)(face / SIDE);
        int size = 1 << k.res[face].u;
        for (int i = 0; i < size * size; i++)
            cell[i] = texture(column + ((float)(i % size) + 0.5f) / (float)size,
                              row + ((float)(i / size) + 0.5f) / (float)size, &random);
        for (int i = 0; i < size * size; i++) {
            float x, y;
            to_cell(turns[face], ((float)(i % size) + 0.5f) / (float)size,
                    ((float)(i / size) + 0.5f) / (float)size, &x, &y);
            values[i] = cell[(int)(y * (float)size) * size + (int)(x * (float)size)];
        }
        kit_set(&k, face, values);
    }
    kit_end_texture(&k);
    kit_save(&k, path, NULL);
    kit_free(&k);
}

static void test_ramp(void) {
    uint64_t random = 23;
    uint32_t turns[SIDE * SIDE];
    char path[1100];
    snprintf(path, sizeof path, "%s", scratch_path("ramp.ptx"));
    write_cells(path, 0, false, &random, ramp, turns);
    slv_cache *cache = kit_cache(0, 0);
    slv_file_id id = kit_open(cache, path);
    for (int p = 0; p < PARAMS; p++) {
        const slv_filter_params *params = &all_params[p];
        slv_filter filter = params->filter;
        if (filter == SLV_FILTER_POINT || filter == SLV_FILTER_ANISOTROPIC ||
            params->no_edge_blend || params->width > 0)
            continue;
        slv_sampler *sampler = kit_sampler(cache, params);
        double worst = 0;
        for (uint32_t i = 0; i < test_effort(1000); i++) {
            /* the cubic filters reproduce planes where a texel is one sample apart; box and
             * gaussian only where they are symmetric about a texel's centre or edge */
            float x = 1.5f + 2 * kit_unit(&random), y = 1.5f + 2 * kit_unit(&random);
            float size = (float)(1 << LOG2), step = 1 / size, out;
            int levels = (int)(test_random(&random) % 3);
            bool plane = filter != SLV_FILTER_BOX && filter != SLV_FILTER_GAUSSIAN;
            if (!plane || params->lerp) {
                x = (floorf(x * size / 8) * 8 + 4) / size;
                y = (floorf(y * size / 8) * 8 + 4) / size;
            }
            for (int j = 0; j < levels; j++)
                step *= 2;
            float w[4] = {step, 0, 0, step};
            uint32_t face = (uint32_t)y * SIDE + (uint32_t)x;
            slv_lookup l = cell_lookup(id, face, turns[face], x - floorf(x), y - floorf(y), w);
            CHECK(slv_sample(sampler, &l, &out) == SLV_OK);
            worst = fmax(worst, fabs((double)out - (double)ramp(x, y, NULL)));
        }
        CHECK_MSG(worst <= 2e-6, "%s%s: %g away from the plane", slv_filter_name(filter),
                  params->lerp ? ", lerp" : "", worst);
        slv_sampler_destroy(sampler);
    }
    slv_cache_destroy(cache);
    unlink(path);
}

static void test_turns(uint32_t count, bool mixed) {
    uint64_t random = 29;
    uint32_t turns[2][SIDE * SIDE], nfaces = count ? count : SIDE * SIDE;
    slv_cache *cache = kit_cache(0, 0);
    slv_file_id ids[2];
    char path[2][1100];
    for (int i = 0; i < 2; i++) {
        snprintf(path[i], sizeof path[i], "%s", scratch_path(i ? "turned.ptx" : "straight.ptx"));
        write_cells(path[i], count, mixed, i ? &random : NULL, noise, turns[i]);
        ids[i] = kit_open(cache, path[i]);
    }
    for (int p = 0; p < PARAMS; p++) {
        slv_sampler *sampler = kit_sampler(cache, &all_params[p]);
        double worst = 0;
        for (uint32_t i = 0; i < test_effort(700); i++) {
            /* not where rounding decides between two texels, or two levels */
            float x = floorf(1024 * kit_unit(&random)) + 0.37f, w[4], out[2];
            float y = floorf(1024 * kit_unit(&random)) + 0.41f;
            uint32_t face = test_random(&random) % nfaces;
            for (int j = 0; j < 4; j++)
                w[j] = (kit_unit(&random) - 0.5f) * powf(2, -6 * kit_unit(&random));
            for (int j = 0; j < 2; j++) {
                slv_lookup l = cell_lookup(ids[j], face, turns[j][face], x / 1024, y / 1024, w);
                CHECK(slv_sample(sampler, &l, &out[j]) == SLV_OK);
            }
            worst = fmax(worst, fabs((double)out[0] - (double)out[1]));
        }
        CHECK_MSG(worst <= 1e-5, "%s%s, %u around%s: turning faces changes values by %g",
                  slv_filter_name(all_params[p].filter), all_params[p].lerp ? ", lerp" : "", count,
                  mixed ? ", mixed" : "", worst);
        slv_sampler_destroy(sampler);
    }
    slv_cache_destroy(cache);
    unlink(path[0]);
    unlink(path[1]);
}

/* Outside of a black border lies what is around the face: on a torus the same as from there. */
static void test_outside(int log2, uint32_t nchannels) {
    const char *path = scratch_path("outside.ptx");
    slv_ptx_write_params black = {.border_u = SLV_BORDER_BLACK, .border_v = SLV_BORDER_BLACK};
    uint64_t random = 71;
    kit k;
    kit_grid(&k, SIDE, SIDE, true, 0, NULL, NULL);
    kit_equal(&k, log2);
    kit_noise(&k, SLV_TYPE_FLOAT, nchannels, &random);
    kit_save(&k, path, &black);
    kit_free(&k);
    slv_cache *cache = kit_cache(0, 0);
    slv_file_id id = kit_open(cache, path);
    for (int p = 0; p < PARAMS; p++) {
        slv_filter filter = all_params[p].filter;
        if (filter == SLV_FILTER_POINT || filter == SLV_FILTER_ANISOTROPIC ||
            all_params[p].no_edge_blend)
            continue;
        slv_sampler *sampler = kit_sampler(cache, &all_params[p]);
        float worst = 0;
        for (uint32_t i = 0; i < test_effort(MANY); i++) {
            slv_lookup l = kit_lookup_any(id, SIDE * SIDE, &random), there = l;
            int x = (int)(test_random(&random) % 3) - 1, y = (int)(test_random(&random) % 3) - 1;
            int at_x = (int)(l.face % SIDE) + SIDE + x, at_y = (int)(l.face / SIDE) + SIDE + y;
            float seen[8], expected[8];
            there.u = floorf(kit_unit(&random) * 1023 + 1) / 1024;
            there.v = floorf(kit_unit(&random) * 1023 + 1) / 1024;
            l.u = there.u + (float)x;
            l.v = there.v + (float)y;
            there.face = (uint32_t)(at_y % SIDE * SIDE + at_x % SIDE);
            CHECK(slv_sample(sampler, &l, seen) == SLV_OK);
            CHECK(slv_sample(sampler, &there, expected) == SLV_OK);
            for (uint32_t c = 0; c < nchannels; c++)
                worst = fmaxf(worst, fabsf(seen[c] - expected[c]));
        }
        CHECK_MSG(worst <= 1e-5f, "%s, 2^%d texels: %g from what lies there",
                  slv_filter_name(filter), log2, (double)worst);
        slv_sampler_destroy(sampler);
    }
    slv_cache_destroy(cache);
    unlink(path);
}

static char sample_path[1100];
static slv_cache *temperatures[3]; /* cold, warm, tiny */

/* One by one, in batches and sorted, in caches of which one holds everything, one begins empty each
 * time, and one holds next to nothing: the same bytes. */
static void sample_all_ways(const char *path) {
    static slv_lookup lookups[MANY];
    slv_file_id ids[3], filler = kit_open(temperatures[2], sample_path);
    slv_ptx_info info;
    uint64_t random = 31;
    for (int i = 0; i < 3; i++)
        ids[i] = kit_open(temperatures[i], path);
    CHECK(slv_cache_get_info(temperatures[0], ids[0], &info) == SLV_OK);
    for (int i = 0; info.nfaces && i < MANY; i++)
        lookups[i] = kit_lookup_any(0, info.nfaces, &random);
    for (int p = 0; info.nfaces && p < PARAMS; p++) {
        uint32_t n = info.nchannels;
        size_t size = (size_t)MANY * n * sizeof(float);
        float *right = NULL;
        for (int c = 0; c < 3; c++)
            for (int way = 0; way < 4; way++) {
                slv_sampler *sampler = kit_sampler(temperatures[c], &all_params[p]);
                slv_lookup *mine = malloc(MANY * sizeof *mine);
                float *out = malloc(size);
                void *workspace = malloc(slv_sample_workspace(MANY));
                REQUIRE(mine && out && workspace);
                memset(out, 0xff, size);
                for (int i = 0; i < MANY; i++) {
                    mine[i] = lookups[i];
                    mine[i].file = ids[c];
                }
                if (c == 0)
                    CHECK(slv_cache_invalidate(temperatures[0], ids[0]) == SLV_OK);
                if (way == 0)
                    CHECK(slv_sample_batch(sampler, mine, MANY, out, n, NULL) == SLV_OK);
                else if (way == 1)
                    CHECK(slv_sample_sorted(sampler, mine, MANY, out, n, NULL, workspace) ==
                          SLV_OK);
                else
                    for (int i = 0; i < MANY; i++) {
                        slv_lookup other = {.file = filler, .face = (uint32_t)i % 60};
                        float room[64];
                        if (way == 3 && c == 2 && i % 8 == 0)
                            test_ignore(slv_sample(sampler, &other, room));
                        CHECK(slv_sample(sampler, &mine[i], out + (size_t)i * n) == SLV_OK);
                    }
                if (!right)
                    right = out;
                CHECK_MSG(memcmp(right, out, size) == 0, "%s, %s: way %d in cache %d differs", path,
                          slv_filter_name(all_params[p].filter), way, c);
                for (size_t i = 0; i < (size_t)MANY * n; i++)
                    if (!(out[i] == out[i]))
                        CHECK_MSG(info.type >= SLV_TYPE_HALF, "%s: not a number", path);
                if (out != right)
                    free(out);
                free(mine);
                free(workspace);
                slv_sampler_destroy(sampler);
            }
        free(right);
    }
    for (int i = 0; i < 3; i++)
        CHECK(slv_cache_close(temperatures[i], ids[i]) == SLV_OK);
    CHECK(slv_cache_close(temperatures[2], filler) == SLV_OK);
}

static void test_ways(void) {
    /* what fills the tiny cache: 64 faces of 256 KiB */
    uint64_t random = 37;
    kit k;
    kit_grid(&k, 8, 8, false, 0, NULL, NULL);
    kit_equal(&k, 8);
    kit_rough(&k, SLV_TYPE_U8, 4, &random);
    snprintf(sample_path, sizeof sample_path, "%s", scratch_path("filler.ptx"));
    kit_save(&k, sample_path, NULL);
    kit_free(&k);
    temperatures[0] = kit_cache(0, 0);
    temperatures[1] = kit_cache(0, 0);
    temperatures[2] = kit_cache(1, 1);
    CHECK(each_sample(sample_all_ways) > 0);
    for (int i = 0; i < 3; i++)
        slv_cache_destroy(temperatures[i]);
    unlink(sample_path);
}

int main(void) {
    test_constants();
    test_constant_triangles();
    test_ramp();
    for (uint32_t count = 2; count < 9; count += TEST_SANITIZED ? 3 : 1) {
        test_turns(count == 2 ? 0 : count, false);
        test_turns(count == 2 ? 0 : count, true);
    }
    for (int log2 = 0; log2 < 6; log2++) {
        test_outside(log2, 3);
        test_outside(log2, 5);
    }
    test_ways();
    return test_end();
}
