/* Patterns at single points: known values, defaults, ranges, smoothness, and inputs that make no
 * sense. */
#include "kit/test.h"

#include <selvage/bake.h>

static float value_at(const slv_procedural *pattern, float x, float y, float z) {
    float rgba[4];
    slv_procedural_evaluate(pattern, 0, (const float[3]){x, y, z}, rgba);
    return rgba[0];
}

static void test_stripes(void) {
    slv_procedural p = {.direction = {5, 0, 0}, .frequency = 2};
    CHECK(value_at(&p, 0, 3, 7) == 0);
    CHECK(value_at(&p, 0.25f, -1, 0) == 1);
    CHECK(value_at(&p, 0.125f, 0, 0) == 0.5f);
    CHECK(value_at(&p, -0.125f, 0, 0) == 0.5f);
    CHECK(value_at(&p, 0.3f, 0, 0) == value_at(&p, 0.3f, 9, -4));
    CHECK(fabsf(value_at(&p, 0.3f, 0, 0) - value_at(&p, 1.3f, 0, 0)) < 1e-5f);

    p.offset[0] = 0.25f;
    CHECK(value_at(&p, 0.25f, 0, 0) == 0);

    slv_procedural plain = {0}, spelled = {.frequency = 1, .direction = {0.36f, 0.80f, 0.48f}};
    for (int i = 0; i < 50; i++) {
        float x = 0.37f * (float)i;
        CHECK(fabsf(value_at(&plain, x, 1, -x) - value_at(&spelled, x, 1, -x)) < 1e-4f);
    }

    slv_procedural bent = {.direction = {1, 0, 0}, .warp = 0.7f};
    int moved = 0;
    for (int i = 0; i < 50; i++)
        moved +=
            fabsf(value_at(&bent, 0.3f, 0.41f * (float)i, 0) - value_at(&bent, 0.3f, 0, 0)) > 0.05f;
    CHECK(moved > 20);
}

static void test_checker_and_position(void) {
    slv_procedural p = {.pattern = SLV_PATTERN_CHECKER};
    for (int i = 0; i < 64; i++) {
        int x = i % 4 - 2, y = i / 4 % 4 - 2, z = i / 16 - 2;
        float expected = (x + y + z) & 1 ? 1.0f : 0.0f;
        CHECK(value_at(&p, (float)x + 0.5f, (float)y + 0.25f, (float)z + 0.75f) == expected);
    }
    float rgba[4];
    slv_procedural q = {.pattern = SLV_PATTERN_POSITION, .frequency = 0.5f, .offset = {1, 2, 3}};
    slv_procedural_evaluate(&q, 5, (const float[3]){2, 8, -3}, rgba);
    CHECK(rgba[0] == 0.5f && rgba[1] == 3 && rgba[2] == -3 && rgba[3] == 1);
}

static void test_colors(void) {
    float rgba[4];
    slv_procedural p = {
        .direction = {1, 0, 0}, .color0 = {1, 0, 0.5f, 0.25f}, .color1 = {0, 0, 0, 1}};
    slv_procedural_evaluate(&p, 0, (const float[3]){0, 0, 0}, rgba);
    CHECK(rgba[0] == 1 && rgba[1] == 0 && rgba[2] == 0.5f && rgba[3] == 0.25f);
    slv_procedural_evaluate(&p, 0, (const float[3]){0.5f, 0, 0}, rgba);
    CHECK(rgba[0] == 0 && rgba[1] == 0 && rgba[2] == 0 && rgba[3] == 1);

    /* Each face's own colour: in range, opaque, not the neighbouring ids' and not another seed's.
     */
    slv_procedural own = {.pattern = SLV_PATTERN_FACE_COLOR}, reseeded = own;
    reseeded.seed = 1;
    float last[4] = {-1, -1, -1, -1};
    for (int32_t face = 0; face < 200; face++) {
        float other[4], apart = 0;
        slv_procedural_evaluate(&own, face, (const float[3]){(float)face, 1, 2}, rgba);
        slv_procedural_evaluate(&reseeded, face, (const float[3]){0, 0, 0}, other);
        for (int c = 0; c < 3; c++) {
            CHECK(rgba[c] >= 0.02f && rgba[c] <= 1);
            apart += fabsf(rgba[c] - last[c]);
        }
        CHECK(rgba[3] == 1 && apart > 0.1f && memcmp(rgba, other, sizeof rgba) != 0);
        memcpy(last, rgba, sizeof last);
    }

    /* A full tint is the face's own colour whatever the pattern; half a tint lies in the middle. */
    slv_procedural tinted = {.pattern = SLV_PATTERN_CHECKER, .face_tint = 1};
    float full[4], half[4];
    slv_procedural_evaluate(&own, 17, (const float[3]){0, 0, 0}, rgba);
    slv_procedural_evaluate(&tinted, 17, (const float[3]){1.5f, 0, 0}, full);
    tinted.face_tint = 0.5f;
    slv_procedural_evaluate(&tinted, 17, (const float[3]){1.5f, 0, 0}, half);
    for (int c = 0; c < 3; c++) {
        CHECK(fabsf(full[c] - rgba[c]) < 1e-6f);
        CHECK(fabsf(half[c] - 0.5f * (1 + rgba[c])) < 1e-6f);
    }
}

static void test_noise(void) {
    slv_procedural p = {.pattern = SLV_PATTERN_NOISE}, other = p, one = p;
    other.seed = 1;
    one.octaves = 1;
    uint64_t random = 1;
    double sum = 0, squares = 0;
    int differ = 0, clipped = 0;
    enum { COUNT = 20000 };
    for (int i = 0; i < COUNT; i++) {
        float x[3];
        for (int k = 0; k < 3; k++)
            x[k] = (float)(test_random(&random) % 200000) * 1e-3f - 100;
        float v = value_at(&p, x[0], x[1], x[2]);
        CHECK(v >= 0 && v <= 1);
        sum += v;
        squares += (double)v * v;
        clipped += v == 0 || v == 1;
        differ += fabsf(v - value_at(&other, x[0], x[1], x[2])) > 1e-3f;
        /* No jumps: a small step, over a lattice plane or not, is a small change. */
        CHECK(fabsf(v - value_at(&p, x[0] + 1e-3f, x[1], x[2] - 1e-3f)) < 0.05f);
        float cell = floorf(x[0]);
        CHECK(fabsf(value_at(&one, cell - 1e-4f, x[1], x[2]) - value_at(&one, cell, x[1], x[2])) <
              2e-3f);
    }
    double mean = sum / COUNT, deviation = sqrt(squares / COUNT - mean * mean);
    CHECK_MSG(fabs(mean - 0.5) < 0.02, "mean %g", mean);
    CHECK_MSG(deviation > 0.12 && deviation < 0.3, "deviation %g", deviation);
    CHECK(differ > COUNT * 9 / 10);
    CHECK_MSG(clipped < COUNT / 100, "%d of %d clipped", clipped, COUNT);
}

/* The same on every machine: only exact arithmetic is involved. */
static void test_golden(void) {
    static const struct {
        slv_pattern pattern;
        uint32_t seed;
        float x, y, z, red;
    } cases[] = {
        {SLV_PATTERN_NOISE, 0, 0.1f, 0.2f, 0.3f, 0x1.a2a578p-3f},
        {SLV_PATTERN_NOISE, 7, -12.5f, 3.75f, 100.125f, 0x1.e97298p-2f},
        {SLV_PATTERN_STRIPES, 0, 0.7f, -0.2f, 0.9f, 0x1.ffdfdp-1f},
        {SLV_PATTERN_FACE_COLOR, 3, 0, 0, 0, 0x1.6f3cd2p-1f},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        slv_procedural p = {.pattern = cases[i].pattern, .seed = cases[i].seed, .warp = 0.5f};
        float found = value_at(&p, cases[i].x, cases[i].y, cases[i].z);
        CHECK_MSG(found == cases[i].red, "case %zu: %a", i, (double)found);
    }
}

static void test_senseless(void) {
    static const float odd[] = {INFINITY, -INFINITY, NAN, 3e38f, -3e9f, 2147483648.0f, 16777217.0f};
    for (int pattern = SLV_PATTERN_STRIPES; pattern <= SLV_PATTERN_FACE_COLOR; pattern++)
        for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
            slv_procedural p = {.pattern = (slv_pattern)pattern, .warp = 1, .octaves = 100};
            float v = value_at(&p, odd[i], 0.3f, odd[i]);
            CHECK(v >= 0 && v <= 1);
            p.direction[0] = p.frequency = odd[i];
            p.face_tint = odd[i];
            v = value_at(&p, 1, 2, 3);
            CHECK(v >= 0 && v <= 1);
        }
}

enum { CUBE = 20 };

/* A cube's sides in CUBE x CUBE quads, blown up to a ball; `inside` turns them round. */
static slv_mesh *ball_mesh(float radius, bool inside) {
    enum { VERTS = 6 * (CUBE + 1) * (CUBE + 1) };
    static float positions[3 * VERTS];
    static int32_t verts[4 * 6 * CUBE * CUBE], sizes[6 * CUBE * CUBE];
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    uint32_t nverts = 0, npolys = 0;
    for (int side = 0; side < 6; side++) {
        int32_t ids[CUBE + 1][CUBE + 1];
        for (int j = 0; j <= CUBE; j++)
            for (int i = 0; i <= CUBE; i++) {
                float p[3], a = (float)(2 * i) / CUBE - 1, b = (float)(2 * j) / CUBE - 1;
                int axis = side % 3, sign = side < 3 ? 1 : -1;
                p[axis] = (float)sign;
                p[(axis + 1) % 3] = a * (float)sign;
                p[(axis + 2) % 3] = b;
                float length = sqrtf(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
                uint32_t at = 0;
                for (int c = 0; c < 3; c++)
                    p[c] *= radius / length;
                while (at < nverts && !(fabsf(positions[3 * at] - p[0]) < 1e-4f &&
                                        fabsf(positions[3 * at + 1] - p[1]) < 1e-4f &&
                                        fabsf(positions[3 * at + 2] - p[2]) < 1e-4f))
                    at++;
                if (at == nverts)
                    memcpy(positions + (size_t)3 * nverts++, p, sizeof p);
                ids[j][i] = (int32_t)at;
            }
        for (int j = 0; j < CUBE; j++)
            for (int i = 0; i < CUBE; i++) {
                int32_t quad[4] = {ids[j][i], ids[j][i + 1], ids[j + 1][i + 1], ids[j + 1][i]};
                for (int k = 0; k < 4; k++)
                    verts[4 * npolys + (uint32_t)k] = quad[inside ? 3 - k : k];
                sizes[npolys++] = 4;
            }
    }
    const slv_mesh_view view = {.nverts = nverts,
                                .positions = positions,
                                .npolys = npolys,
                                .poly_sizes = sizes,
                                .poly_verts = verts};
    REQUIRE(!slv_mesh_create(&env, &view, &mesh));
    return mesh;
}

/* 1 / r on a ball, seen from outside, and less than nothing from inside. */
static void test_curvature(void) {
    slv_env env = test_env();
    for (int inside = 0; inside < 2; inside++) {
        slv_mesh *mesh = ball_mesh(4, inside);
        slv_surface *surface = NULL;
        slv_bake_source *source = NULL;
        float values[16];
        uint8_t misses[16];
        double sum = 0, want = inside ? -0.25 : 0.25;
        uint32_t off = 0, count = 0;
        REQUIRE(!slv_surface_create(&env, mesh, NULL, &surface));
        REQUIRE(!slv_bake_from_surface(&env, surface, SLV_BAKE_CURVATURE, &source));
        for (uint32_t face = 0; face < slv_mesh_face_count(mesh); face++) {
            REQUIRE(!slv_bake_evaluate(source, &env, face, (slv_res){2, 1}, (slv_rect){0, 0, 4, 2},
                                       values, misses));
            for (int i = 0; i < 8; i++, count++) {
                sum += (double)values[i] / want;
                off += fabs((double)values[i] / want - 1) > 0.02;
            }
        }
        /* at the eight vertices of three faces the limit surface is no ball */
        CHECK_MSG(fabs(sum / count - 1) < 0.01 && off * 5 < count,
                  "inside %d: %g of 1/r, %u of %u off", inside, sum / count, off, count);
        slv_bake_source_destroy(source);
        slv_surface_destroy(surface);
        slv_mesh_destroy(mesh);
    }
}

/* A texel is the mean of the pattern at four places, whichever way it is found. */
static void test_means(void) {
    static const struct {
        slv_procedural pattern;
        float most; /* that values may be off */
    } cases[] = {
        {{.frequency = 3}, 1e-4f},
        {{.frequency = 3, .warp = 0.4f, .color0 = {1, 0.5f, 0, 1}, .face_tint = 0.3f}, 1e-4f},
        /* bends whose cells are much larger than texels are taken at corners */
        {{.frequency = 0.3f, .warp = 0.5f}, 0.004f},
        {{.frequency = 0.6f, .warp = 0.5f, .color0 = {1, 0, 0, 0.25f}}, 0.004f},
        {{.pattern = SLV_PATTERN_CHECKER, .frequency = 7, .offset = {0.1f, 0.2f, 0.3f}}, 1e-4f},
        {{.pattern = SLV_PATTERN_CHECKER,
          .frequency = 2.3f,
          .color0 = {0, 1, 0, 0.5f},
          .color1 = {1, 0, 0.5f, 0},
          .face_tint = 0.4f},
         1e-4f},
        {{.frequency = 2, .color0 = {1, 0, 0, 0.25f}}, 1e-4f},
        {{.pattern = SLV_PATTERN_POSITION, .frequency = 2, .offset = {1, 2, 3}}, 1e-4f},
        {{.pattern = SLV_PATTERN_POSITION, .face_tint = 0.3f}, 1e-4f},
        {{.pattern = SLV_PATTERN_FACE_COLOR, .seed = 3}, 1e-6f}};
    static const char obj[] = "v -1 0 0\nv 2 0 0\nv 2 3 0\nv -1 3 0\nf 1 2 3 4\n";
    const slv_surface_params flat = {.scheme = SLV_SCHEME_BILINEAR};
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    slv_surface *surface = NULL;
    REQUIRE(!slv_mesh_parse_obj(&env, "quad", obj, sizeof obj - 1, &mesh));
    REQUIRE(!slv_surface_create(&env, mesh, &flat, &surface));
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const slv_procedural *pattern = &cases[k].pattern;
        slv_bake_source *source = NULL;
        float values[16 * 8 * 4];
        uint8_t misses[16 * 8];
        REQUIRE(!slv_bake_from_pattern(&env, surface, pattern, &source));
        uint32_t n = slv_bake_source_get_desc(source)->nchannels;
        REQUIRE(!slv_bake_evaluate(source, &env, 0, (slv_res){4, 3}, (slv_rect){0, 0, 16, 8},
                                   values, misses));
        for (uint32_t i = 0; i < 16 * 8; i++) {
            double sum[4] = {0};
            for (int s = 0; s < 4; s++) {
                float rgba[4], u = ((float)(i % 16) + 0.25f + 0.5f * (float)(s & 1)) / 16,
                               v = ((float)(i / 16) + 0.25f + 0.5f * (float)(s >> 1)) / 8;
                slv_procedural_evaluate(pattern, 0, (const float[3]){-1 + 3 * u, 3 * v, 0}, rgba);
                for (uint32_t c = 0; c < 4; c++)
                    sum[c] += (double)(rgba[c] * (c < 3 && n == 4 ? rgba[3] : 1)) / 4;
            }
            for (uint32_t c = 0; c < n; c++) {
                double want = c < 3 && n == 4 ? sum[c] / sum[3] : sum[c];
                if (c < 3 && n == 4 && sum[3] <= 0)
                    continue; /* nothing is seen */
                CHECK_MSG(fabs((double)values[i * n + c] - want) < (double)cases[k].most,
                          "pattern %zu: %g, not %g", k, (double)values[i * n + c], want);
            }
        }
        slv_bake_source_destroy(source);
    }
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
}

/* Noise is as near to its mean over a texel as the page says, at whatever size of its cells. */
static void test_noise_means(void) {
    /* texels' sides in cells, and what a value may be off; beyond 2.4 nothing is left of it */
    static const struct {
        float side, most, root_mean_square;
    } cases[] = {{1.0f / 32, 0.001f, 0.0003f},
                 {0.06f, 0.003f, 0.0008f},
                 {0.07f, 0.0005f, 0.0001f},
                 {0.25f, 0.003f, 0.0007f},
                 {0.5f, 0.03f, 0.007f},
                 {0.7f, 0.05f, 0.014f},
                 {1, 0.08f, 0.02f},
                 {2, 0.2f, 0.06f},
                 {4, 0.2f, 0.06f}};
    enum { SIDE = 8, DENSE = 24 };
    slv_env env = test_env();
    uint64_t random = 9;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        double most = 0, sum = 0;
        int count = 0;
        for (int round = 0; round < 6; round++) {
            const double turn = (double)(test_random(&random) % 1000) * 0.0062832,
                         lean = (double)(test_random(&random) % 1000) * 0.0031416;
            const double u[3] = {cos(turn) * cos(lean), sin(turn) * cos(lean), sin(lean)},
                         v[3] = {-sin(turn), cos(turn), 0};
            char obj[400];
            size_t used = 0;
            for (int c = 0; c < 4; c++)
                used += (size_t)snprintf(obj + used, sizeof obj - used, "v %.9g %.9g %.9g\n",
                                         u[0] * (c == 1 || c == 2) + v[0] * (c > 1),
                                         u[1] * (c == 1 || c == 2) + v[1] * (c > 1),
                                         u[2] * (c == 1 || c == 2) + v[2] * (c > 1));
            used += (size_t)snprintf(obj + used, sizeof obj - used, "f 1 2 3 4\n");
            const slv_surface_params flat = {.scheme = SLV_SCHEME_BILINEAR};
            const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE,
                                          .frequency = cases[k].side * SIDE,
                                          .octaves = 1,
                                          .seed = (uint32_t)round};
            slv_mesh *mesh = NULL;
            slv_surface *surface = NULL;
            slv_bake_source *source = NULL;
            float values[3 * SIDE * SIDE], rgba[4];
            uint8_t misses[SIDE * SIDE];
            REQUIRE(!slv_mesh_parse_obj(&env, "quad", obj, used, &mesh));
            REQUIRE(!slv_surface_create(&env, mesh, &flat, &surface));
            REQUIRE(!slv_bake_from_pattern(&env, surface, &noise, &source));
            REQUIRE(!slv_bake_evaluate(source, &env, 0, (slv_res){3, 3},
                                       (slv_rect){0, 0, SIDE, SIDE}, values, misses));
            for (int i = 0; i < SIDE * SIDE; i++) {
                double want = 0;
                bool clamped = false;
                for (int s = 0; s < DENSE * DENSE; s++) {
                    const double x = (i % SIDE + (s % DENSE + 0.5) / DENSE) / SIDE,
                                 y = (i / SIDE + ((double)(s / DENSE) + 0.5) / DENSE) / SIDE;
                    const float at[3] = {(float)(x * u[0] + y * v[0]), (float)(x * u[1] + y * v[1]),
                                         (float)(x * u[2] + y * v[2])};
                    slv_procedural_evaluate(&noise, 0, at, rgba);
                    want += (double)rgba[0] / (DENSE * DENSE);
                    clamped |= rgba[0] == 0 || rgba[0] == 1;
                }
                if (clamped)
                    continue;
                count++;
                const double off = fabs((double)values[3 * i] - want);
                most = fmax(most, off);
                sum += off * off;
            }
            slv_bake_source_destroy(source);
            slv_surface_destroy(surface);
            slv_mesh_destroy(mesh);
        }
        CHECK_MSG(most <= (double)cases[k].most &&
                      sqrt(sum / count) <= (double)cases[k].root_mean_square,
                  "%g cells: off by %g at most, %g root mean square", (double)cases[k].side, most,
                  sqrt(sum / count));
    }
}

int main(void) {
    test_stripes();
    test_checker_and_position();
    test_colors();
    test_noise();
    test_golden();
    test_senseless();
    test_curvature();
    test_means();
    test_noise_means();
    return test_end();
}
