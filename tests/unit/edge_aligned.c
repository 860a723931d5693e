/* Samples on edges and vertices: shared to the bit, interpolation exactly continuous across every
 * seam whatever meets there, constants and linear functions kept, losses measured. */
#include "kit/border_kit.h"

#include <selvage/edge_aligned.h>

static slv_edge_aligned *convert(const kit *k, uint32_t threads) {
    slv_env env = test_env();
    slv_edge_aligned *aligned = NULL;
    env.threads = threads;
    slv_result result = slv_edge_aligned_create(&env, k->levels, k->adjacency, &aligned);
    REQUIRE(result == SLV_OK);
    return aligned;
}

static void measure(const slv_env *env, const slv_edge_aligned *aligned, const kit *k,
                    slv_edge_aligned_error *out) {
    slv_result result = slv_edge_aligned_measure(env, aligned, k->levels, k->adjacency, out);
    REQUIRE(result == SLV_OK);
}

static int along(slv_res res, unsigned edge) {
    return edge & 1 ? res.v : res.u;
}

static int halvings(const slv_neighbour *n) {
    return n->scale > 1.5f ? 1 : n->scale < 0.75f ? -1 : 0;
}

/* What rounding to the type may leave between a sample and the line between two others. */
static double tolerance(slv_type type) {
    return type == SLV_TYPE_U8     ? 0.51 / 255
           : type == SLV_TYPE_U16  ? 0.51 / 65535
           : type == SLV_TYPE_HALF ? 0x1p-11
                                   : 1e-6;
}

/* The value at (u,v) of a level that was built apart, in float whatever the type. */
static double interpolate(const float *samples, slv_res res, uint32_t n, double u, double v,
                          uint32_t c) {
    int32_t width = 1 << res.u, height = 1 << res.v;
    double x = u * width, y = v * height;
    int32_t i = (int32_t)x < width ? (int32_t)x : width - 1;
    int32_t j = (int32_t)y < height ? (int32_t)y : height - 1;
    const float *low = samples + ((size_t)j * (size_t)(width + 1) + (size_t)i) * n + c;
    const float *high = low + (size_t)(width + 1) * n;
    double s = x - i, t = y - j;
    return (1 - t) * ((1 - s) * (double)low[0] + s * (double)low[n]) +
           t * ((1 - s) * (double)high[0] + s * (double)high[n]);
}

static float *build(const kit *k, uint32_t face, uint32_t level) {
    uint64_t count = slv_edge_aligned_count(slv_res_level(k->res[face], level)) * k->nchannels;
    float *out = malloc(count * sizeof *out);
    REQUIRE(out);
    slv_result result = slv_edge_aligned_build(k->levels, k->adjacency, face, level, out);
    REQUIRE(result == SLV_OK);
    return out;
}

/* One face's level against one neighbour's, along all that they share. */
static void compare(const kit *k, const slv_edge_aligned *aligned, uint32_t face, uint32_t level,
                    unsigned edge, const slv_neighbour *n, uint32_t their_level) {
    enum { POINTS = 49 };
    slv_res mine = slv_res_level(k->res[face], level),
            theirs = slv_res_level(k->res[n->face], their_level);
    float *own = build(k, face, level), *other = build(k, (uint32_t)n->face, their_level);
    float a[8], b[8];
    for (int i = 0; i < POINTS; i++) {
        double t = (double)n->t0 + (double)(n->t1 - n->t0) * i / (POINTS - 1), u, v;
        kit_edge_point(edge, t, &u, &v);
        float nu, nv;
        slv_affine_apply(&n->map, (float)u, (float)v, &nu, &nv);
        slv_edge_aligned_lookup(aligned, face, level, (float)u, (float)v, a);
        slv_edge_aligned_lookup(aligned, (uint32_t)n->face, their_level, nu, nv, b);
        for (uint32_t c = 0; c < k->nchannels; c++) {
            double x = interpolate(own, mine, k->nchannels, (double)(float)u, (double)(float)v, c);
            double y = interpolate(other, theirs, k->nchannels, (double)nu, (double)nv, c);
            CHECK_MSG(fabs(x - y) < 1e-6,
                      "face %u level %u edge %u t %g to face %d level %u: %g %g", face, level, edge,
                      t, (int)n->face, their_level, x, y);
            CHECK_MSG(fabs((double)a[c] - (double)b[c]) <= tolerance(k->type),
                      "%s: face %u level %u edge %u t %g to face %d level %u: %g %g",
                      slv_type_name(k->type), face, level, edge, t, (int)n->face, their_level,
                      (double)a[c], (double)b[c]);
        }
    }
    /* Samples at the same places are the same bits. */
    int equal = along(mine, edge) - halvings(n) == along(theirs, n->edge);
    for (int i = 0, count = 1 << along(mine, edge); equal && i <= count; i++) {
        double t = (double)i / count, u, v;
        float nu, nv;
        kit_edge_point(edge, t, &u, &v);
        if (t < (double)n->t0 || t > (double)n->t1)
            continue;
        slv_affine_apply(&n->map, (float)u, (float)v, &nu, &nv);
        slv_edge_aligned_lookup(aligned, face, level, (float)u, (float)v, a);
        slv_edge_aligned_lookup(aligned, (uint32_t)n->face, their_level, nu, nv, b);
        CHECK(memcmp(a, b, k->nchannels * sizeof *a) == 0);
    }
    free(own);
    free(other);
}

/* Level 0 against level 0, always; with `levels`, every pair of levels that meets too. */
static void check(const kit *k, bool levels) {
    slv_edge_aligned *aligned = convert(k, 0);
    for (uint32_t face = 0; face < k->nfaces; face++) {
        for (unsigned edge = 0; edge < 4; edge++) {
            slv_neighbour n[2];
            uint32_t links = slv_adjacency_neighbours(k->adjacency, (int32_t)face, edge, n);
            for (uint32_t i = 0; i < links; i++) {
                compare(k, aligned, face, 0, edge, &n[i], 0);
                for (uint32_t level = 1; levels && level < slv_levels_count(k->levels, face);
                     level++) {
                    int want = along(slv_res_level(k->res[face], level), edge) - halvings(&n[i]);
                    int has = along(k->res[n[i].face], n[i].edge);
                    if (want > has || (want >= 0 && k->res[face].u == k->res[face].v) || want > 0)
                        compare(k, aligned, face, level, edge, &n[i],
                                want > has ? 0 : (uint32_t)(has - want));
                }
            }
        }
        /* All faces around a vertex have the same bits there. */
        for (unsigned corner = 0; corner < 4; corner++) {
            const double *here = kit_corners[corner];
            slv_ring ring = slv_adjacency_ring(k->adjacency, (int32_t)face, corner, NULL);
            float a[8], b[8];
            slv_edge_aligned_lookup(aligned, face, 0, (float)here[0], (float)here[1], a);
            for (uint32_t i = 0; i < ring.count; i++) {
                const double *there = kit_corners[ring.corners[i].corner];
                slv_edge_aligned_lookup(aligned, (uint32_t)ring.corners[i].face, 0, (float)there[0],
                                        (float)there[1], b);
                CHECK(memcmp(a, b, k->nchannels * sizeof *a) == 0);
            }
        }
    }
    slv_edge_aligned_destroy(aligned);
}

static void make(kit *k, int which, uint64_t *random) {
    static const int32_t valences[] = {3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    if (which < 10)
        kit_disc(k, valences[which], random);
    else if (which == 10)
        kit_cube(k, random);
    else if (which == 11)
        kit_pentagons(k, random);
    else
        kit_grid(k, 4, 3 + which % 2, which & 2, which & 4 ? 40 : 0, random, NULL);
}

enum { KINDS = 20 };

static void test_seams(void) {
    uint64_t random = 11;
    for (int which = 0; which < KINDS; which++) {
        kit k;
        make(&k, which, &random);
        for (int type = 0; type < 4; type++) {
            kit_equal(&k, 1 + type % 3);
            kit_noise(&k, (slv_type)type, 2, &random);
            check(&k, true);
            kit_mixed(&k, 4, &random);
            kit_noise(&k, (slv_type)type, 1, &random);
            check(&k, true);
            for (uint32_t face = 0; face < k.nfaces; face++)
                k.res[face] = (slv_res){(int8_t)(test_random(&random) % 5),
                                        (int8_t)(test_random(&random) % 5)};
            kit_noise(&k, (slv_type)type, 1, &random);
            check(&k, false);
        }
        kit_free(&k);
    }
}

/* Faces among squares of one resolution have a way of their own, and the samples that the way of
 * all faces finds. */
static void test_alike(void) {
    static const int grids[] = {10, 16, 17, 18, 19};
    uint64_t random = 15;
    for (int i = 0; i < 5; i++) {
        kit k;
        make(&k, grids[i], &random);
        for (int type = 0; type < 4; type++) {
            kit_equal(&k, (i + type) % 4);
            kit_noise(&k, (slv_type)type, type == 1 ? 18 : 3, &random);
            slv_edge_aligned *aligned = convert(&k, 0);
            for (uint32_t face = 0; face < k.nfaces; face++)
                for (uint32_t level = 0; level < slv_levels_count(k.levels, face); level++) {
                    float *values = build(&k, face, level);
                    uint64_t count = slv_edge_aligned_count(slv_res_level(k.res[face], level));
                    size_t n = (size_t)count * k.nchannels;
                    void *rounded = malloc(n * sizeof(float));
                    REQUIRE(rounded);
                    slv_type_from_float(k.type, values, n, rounded);
                    CHECK_MSG(memcmp(rounded, slv_edge_aligned_samples(aligned, face, level),
                                     n * slv_type_size(k.type)) == 0,
                              "%s: face %u level %u of grid %d", slv_type_name(k.type), face, level,
                              grids[i]);
                    free(values);
                    free(rounded);
                }
            slv_edge_aligned_destroy(aligned);
        }
        kit_free(&k);
    }
}

static void test_constant(void) {
    uint64_t random = 12;
    for (int which = 0; which < KINDS; which++) {
        kit k;
        slv_env env = test_env();
        make(&k, which, &random);
        kit_mixed(&k, 4, &random);
        kit_begin_texture(&k, (slv_type)(which % 4), 2);
        unsigned char texel[8], back[8];
        float values[2] = {0.3f, 0.9f}, was[2], found[2];
        slv_type_from_float(k.type, values, 2, texel);
        slv_type_to_float(k.type, texel, 2, was);
        for (uint32_t face = 0; face < k.nfaces; face++)
            REQUIRE(slv_texture_set_constant(k.texture, face, texel) == SLV_OK);
        kit_end_texture(&k);
        slv_edge_aligned *aligned = convert(&k, 0);
        size_t size = 2 * slv_type_size(k.type);
        for (uint32_t face = 0; face < k.nfaces; face++) {
            for (uint32_t level = 0; level < slv_levels_count(k.levels, face); level++) {
                const unsigned char *at = slv_edge_aligned_samples(aligned, face, level);
                uint64_t count = slv_edge_aligned_count(slv_res_level(k.res[face], level));
                for (uint64_t i = 0; i < count; i++, at += size) {
                    slv_type_to_float(k.type, at, 2, found);
                    CHECK_MSG(fabsf(found[0] - was[0]) < 1e-6f && fabsf(found[1] - was[1]) < 1e-6f,
                              "face %u level %u sample %u: %g %g", face, level, (unsigned)i,
                              (double)found[0], (double)found[1]);
                    if (k.type <= SLV_TYPE_U16)
                        CHECK(memcmp(at, texel, size) == 0);
                }
            }
        }
        slv_texture *again = NULL;
        REQUIRE(slv_edge_aligned_to_texture(&env, aligned, &again) == SLV_OK);
        for (uint32_t face = 0; face < k.nfaces; face++) {
            slv_texture_fetch(again, face, 0, 0, found);
            slv_type_from_float(k.type, found, 2, back);
            CHECK(slv_texture_get_desc(again)->res[face].u == k.res[face].u);
            CHECK(fabsf(found[0] - was[0]) < 1e-6f && fabsf(found[1] - was[1]) < 1e-6f);
            CHECK(k.type > SLV_TYPE_U16 || memcmp(back, texel, size) == 0);
        }
        slv_texture_destroy(again);
        slv_edge_aligned_destroy(aligned);
        kit_free(&k);
    }
}

/* Where a point of quad `face` of a grid lies, its first corner turned. */
static void grid_position(uint32_t face, uint32_t turn, int nx, double u, double v, double *x,
                          double *y) {
    double p[4][2] = {{u, v}, {1 - v, u}, {1 - u, 1 - v}, {v, 1 - u}};
    *x = (int)face % nx + p[turn][0];
    *y = (int)face / nx + p[turn][1];
}

static double plane(double x, double y) {
    return 0.1 + 0.11 * x + 0.07 * y;
}

/* Of several resolutions, away from the boundary of the mesh, where the centred form repeats its
 * last texel and is not linear itself. */
static void test_linear(void) {
    enum { NX = 5, NY = 4 };
    uint64_t random = 13;
    for (int round = 0; round < 8; round++) {
        kit k;
        uint32_t turns[NX * NY];
        double longest = 0;
        kit_grid(&k, NX, NY, false, 0, &random, turns);
        for (uint32_t face = 0; face < k.nfaces; face++) {
            k.res[face].u = k.res[face].v = (int8_t)(round % 2 ? 2 + test_random(&random) % 4 : 3);
            longest = fmax(longest, 1.0 / (1 << k.res[face].u));
        }
        kit_begin_texture(&k, SLV_TYPE_FLOAT, 1);
        for (uint32_t face = 0; face < k.nfaces; face++) {
            uint32_t n = 1u << k.res[face].u;
            float *values = malloc((size_t)n * n * sizeof *values);
            REQUIRE(values);
            for (uint32_t i = 0; i < n * n; i++) {
                double x, y;
                grid_position(face, turns[face], NX, (i % n + 0.5) / n, (i / n + 0.5) / n, &x, &y);
                values[i] = (float)plane(x, y);
            }
            kit_set(&k, face, values);
            free(values);
        }
        kit_end_texture(&k);
        slv_edge_aligned *aligned = convert(&k, 0);
        uint32_t checked = 0;
        for (uint32_t face = 0; face < k.nfaces; face++) {
            for (int i = 0; i <= 32 * 32; i++) {
                double u = i % 33 / 32.0, v = i / 33 / 32.0, x, y;
                float value;
                grid_position(face, turns[face], NX, u, v, &x, &y);
                if (x < longest || y < longest || x > NX - longest || y > NY - longest)
                    continue;
                slv_edge_aligned_lookup(aligned, face, 0, (float)u, (float)v, &value);
                CHECK_MSG(fabs((double)value - plane(x, y)) < 1e-5, "(%g, %g): %g for %g", x, y,
                          (double)value, plane(x, y));
                checked++;
            }
        }
        CHECK(checked > 8000);
        slv_edge_aligned_destroy(aligned);
        kit_free(&k);
    }
}

static void test_threads(void) {
    uint64_t random = 14;
    kit k;
    kit_grid(&k, 8, 8, false, 30, &random, NULL);
    for (int type = 0; type < 4; type++) {
        slv_env one = test_env(), many = test_env();
        slv_edge_aligned_error errors[2];
        slv_texture *textures[2];
        kit_mixed(&k, 5, &random);
        kit_noise(&k, (slv_type)type, 3, &random);
        slv_edge_aligned *a = convert(&k, 1), *b = convert(&k, 5);
        one.threads = 1;
        many.threads = 5;
        REQUIRE(slv_edge_aligned_bytes(a) == slv_edge_aligned_bytes(b));
        CHECK(memcmp(slv_edge_aligned_samples(a, 0, 0), slv_edge_aligned_samples(b, 0, 0),
                     slv_edge_aligned_bytes(a)) == 0);
        measure(&one, a, &k, &errors[0]);
        measure(&many, b, &k, &errors[1]);
        CHECK(memcmp(&errors[0], &errors[1], sizeof errors[0]) == 0);
        REQUIRE(slv_edge_aligned_to_texture(&one, a, &textures[0]) == SLV_OK);
        REQUIRE(slv_edge_aligned_to_texture(&many, b, &textures[1]) == SLV_OK);
        for (uint32_t face = 0; face < k.nfaces; face++) {
            size_t size = slv_texture_is_constant(textures[0], face) ? 1 : kit_texels(k.res[face]);
            CHECK(memcmp(slv_texture_texels(textures[0], face),
                         slv_texture_texels(textures[1], face),
                         size * 3 * slv_type_size(k.type)) == 0);
        }
        slv_texture_destroy(textures[0]);
        slv_texture_destroy(textures[1]);
        slv_edge_aligned_destroy(a);
        slv_edge_aligned_destroy(b);
    }
    kit_free(&k);
}

/* The measured losses against many lookups, and against the texture that comes back. */
static void test_measure(void) {
    uint64_t random = 15;
    slv_env env = test_env();
    for (int round = 0; round < 3; round++) {
        kit k;
        make(&k, round == 0 ? 10 : round == 1 ? 11 : 12, &random);
        kit_mixed(&k, 4, &random);
        kit_noise(&k, SLV_TYPE_FLOAT, 2, &random);
        slv_edge_aligned *aligned = convert(&k, 0);
        slv_edge_aligned_error error;
        slv_texture *back = NULL;
        measure(&env, aligned, &k, &error);
        REQUIRE(slv_edge_aligned_to_texture(&env, aligned, &back) == SLV_OK);
        double trip_sum = 0, trip_max = 0, sum = 0, most = 0, texels = 0;
        for (uint32_t face = 0; face < k.nfaces; face++) {
            enum { STEPS = 320 };
            kit_level bordered = kit_build(&k, face, 0, 1, 1);
            uint32_t width = 1u << k.res[face].u;
            double weight = (double)kit_texels(k.res[face]) / (STEPS * STEPS);
            float a[2], b[2];
            for (uint32_t i = 0; i < kit_texels(k.res[face]); i++) {
                slv_texture_fetch(k.texture, face, i % width, i / width, a);
                slv_texture_fetch(back, face, i % width, i / width, b);
                for (int c = 0; c < 2; c++) {
                    double lost = fabs((double)a[c] - (double)b[c]);
                    trip_sum += lost * lost;
                    trip_max = fmax(trip_max, lost);
                }
            }
            texels += (double)kit_texels(k.res[face]);
            for (int i = 0; i < STEPS * STEPS; i++) {
                double u = (i % STEPS + 0.5) / STEPS, v = (i / STEPS + 0.5) / STEPS;
                slv_edge_aligned_lookup(aligned, face, 0, (float)u, (float)v, a);
                for (uint32_t c = 0; c < 2; c++) {
                    double lost = fabs((double)a[c] - (double)kit_lookup(&bordered, u, v, c));
                    sum += weight * lost * lost;
                    most = fmax(most, lost);
                }
            }
            free(bordered.values);
        }
        trip_sum = sqrt(trip_sum / (2 * texels));
        sum = sqrt(sum / (2 * texels));
        CHECK_MSG(fabs(trip_sum - error.round_trip_rms) < 1e-6, "%g %g", trip_sum,
                  error.round_trip_rms);
        CHECK(fabs(trip_max - error.round_trip_max) < 1e-6);
        CHECK_MSG(fabs(sum - error.function_rms) < 0.003 * sum, "%g %g", sum, error.function_rms);
        CHECK_MSG(most <= error.function_max + 1e-6 && most > 0.8 * error.function_max, "%g %g",
                  most, error.function_max);
        CHECK(error.function_rms > 0.01 && error.function_rms < error.round_trip_rms);
        slv_texture_destroy(back);
        slv_edge_aligned_destroy(aligned);
        kit_free(&k);
    }
}

static void test_refused(void) {
    uint64_t random = 16;
    slv_env env = test_env();
    slv_edge_aligned *aligned = NULL;
    slv_edge_aligned_error error;
    float value[64];
    kit a, b;
    kit_cube(&a, &random);
    kit_disc(&b, 3, &random);
    kit_equal(&a, 1);
    kit_equal(&b, 1);
    kit_noise(&a, SLV_TYPE_FLOAT, 1, &random);
    kit_noise(&b, SLV_TYPE_FLOAT, 1, &random);
    CHECK(slv_edge_aligned_create(&env, a.levels, b.adjacency, &aligned) == SLV_ERROR_MISMATCH);
    CHECK(!aligned);
    CHECK(slv_edge_aligned_build(a.levels, b.adjacency, 0, 0, value) == SLV_ERROR_MISMATCH);
    CHECK(slv_edge_aligned_build(a.levels, a.adjacency, 6, 0, value) == SLV_ERROR_ARGUMENT);
    CHECK(slv_edge_aligned_build(a.levels, a.adjacency, 0, 2, value) == SLV_ERROR_ARGUMENT);
    env.max_bytes = 64;
    CHECK(slv_edge_aligned_create(&env, a.levels, a.adjacency, &aligned) == SLV_ERROR_LIMIT);
    env.max_bytes = 0;
    aligned = convert(&a, 1);
    CHECK(slv_edge_aligned_centred(aligned, 0, 2, value) == SLV_ERROR_ARGUMENT);
    CHECK(slv_edge_aligned_measure(&env, aligned, b.levels, b.adjacency, &error) ==
          SLV_ERROR_MISMATCH);
    slv_edge_aligned_destroy(aligned);
    slv_edge_aligned_destroy(NULL);
    kit_free(&a);
    kit_free(&b);
}

int main(void) {
    test_seams();
    test_alike();
    test_constant();
    test_linear();
    test_threads();
    test_measure();
    test_refused();
    return test_end();
}
