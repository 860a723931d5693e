/* What border texels are: bitwise the neighbours' where resolutions are equal, linear where the
 * texture is, constant where it is constant. */
#include "kit/border_kit.h"

static const slv_type types[4] = {SLV_TYPE_U8, SLV_TYPE_U16, SLV_TYPE_HALF, SLV_TYPE_FLOAT};

/* Where in the frame of a grid cell, 0..1 from its lower left, a point of its quad lies. */
static void to_cell(uint32_t turn, double u, double v, double *x, double *y) {
    for (uint32_t i = 0; i < turn; i++) {
        double old = u;
        u = 1 - v;
        v = old;
    }
    *x = u;
    *y = v;
}

static void from_cell(uint32_t turn, double x, double y, double *u, double *v) {
    to_cell((4 - turn) % 4, x, y, u, v);
}

static int32_t wrap(int32_t at, int32_t count, bool torus) {
    if (torus)
        return (at + count) % count;
    return at < 0 ? 0 : at < count ? at : count - 1;
}

/* A grid of equal faces is one image that wraps, or is repeated beyond its edge: every border texel
 * is that image's, bit for bit except where a float comes out of a sum. */
static void test_image(bool torus, slv_type type, int r, uint32_t nchannels) {
    enum { NX = 4, NY = 3 };
    uint64_t random = 11 + (uint64_t)r;
    uint32_t turns[NX * NY];
    kit k;
    kit_grid(&k, NX, NY, torus, 0, &random, turns);
    kit_equal(&k, r);
    kit_noise(&k, type, nchannels, &random);
    float *expected = malloc(nchannels * sizeof *expected);
    REQUIRE(expected);
    for (uint32_t level = 0; level <= (uint32_t)r; level++) {
        int32_t n = 1 << (r - (int)level);
        for (uint32_t face = 0; face < k.nfaces; face++) {
            kit_level got = kit_build(&k, face, level, 3, 8);
            CHECK(!got.out_of_range);
            int32_t bu = (int32_t)got.bu, bv = (int32_t)got.bv;
            for (int32_t y = -bv; y < n + bv; y++) {
                for (int32_t x = -bu; x < n + bu; x++) {
                    double cx, cy, u, v;
                    to_cell(turns[face], (x + 0.5) / n, (y + 0.5) / n, &cx, &cy);
                    /* In texels of the whole image, then face and texel of the one that is there.
                     */
                    int32_t column = (int32_t)(face % NX) * n + (int32_t)floor(cx * n);
                    int32_t row = (int32_t)(face / NX) * n + (int32_t)floor(cy * n);
                    column = wrap(column, NX * n, torus);
                    row = wrap(row, NY * n, torus);
                    uint32_t other = (uint32_t)(row / n * NX + column / n);
                    from_cell(turns[other], (column % n + 0.5) / n, (row % n + 0.5) / n, &u, &v);
                    size_t texel = (size_t)(v * n) * (size_t)n + (size_t)(u * n);
                    const unsigned char *from = slv_levels_texels(k.levels, other, level);
                    slv_type_to_float(type, from + texel * nchannels * slv_type_size(type),
                                      nchannels, expected);
                    const float *found = kit_texel(&got, x, y);
                    bool same = !memcmp(expected, found, nchannels * sizeof(float));
                    if (!torus && type >= SLV_TYPE_HALF)
                        same = fabs((double)found[0] - (double)expected[0]) < 1e-6;
                    CHECK_MSG(same, "%s level %u face %u texel %d %d: %g, expected %g",
                              slv_type_name(type), level, face, x, y,
                              (double)kit_texel(&got, x, y)[0], (double)expected[0]);
                }
            }
            free(got.values);
        }
    }
    free(expected);
    kit_free(&k);
}

/* A texture that is linear over a flat grid: the whole innermost ring is linear, whatever
 * resolutions meet, and between equal resolutions everything is. */
static void test_linear(bool mixed) {
    enum { NX = 5, NY = 5 };
    uint64_t random = 21;
    for (int round = 0; round < 4; round++) {
        uint32_t turns[NX * NY];
        kit k;
        kit_grid(&k, NX, NY, false, 0, &random, turns);
        kit_equal(&k, 4);
        if (mixed)
            kit_mixed(&k, 5, &random);
        kit_begin_texture(&k, SLV_TYPE_FLOAT, 1);
        for (uint32_t face = 0; face < k.nfaces; face++) {
            int32_t n = 1 << k.res[face].u;
            float *values = malloc((size_t)n * (size_t)n * sizeof *values);
            REQUIRE(values);
            for (int32_t i = 0; i < n * n; i++) {
                double x, y;
                to_cell(turns[face], (i % n + 0.5) / n, (i / n + 0.5) / n, &x, &y);
                values[i] = (float)(0.1 * (x + face % NX) - 0.07 * (y + face / NX) + 0.3);
            }
            kit_set(&k, face, values);
            free(values);
        }
        kit_end_texture(&k);
        for (uint32_t face = 0; face < k.nfaces; face++) {
            uint32_t column = face % NX, row = face / NX;
            if (column == 0 || row == 0 || column == NX - 1 || row == NY - 1)
                continue;
            for (uint32_t level = 0; level < slv_levels_count(k.levels, face); level++) {
                kit_level got = kit_build(&k, face, level, mixed ? 1 : 4, mixed ? 1 : 3);
                int32_t n = 1 << got.res.u;
                for (int32_t y = -(int32_t)got.bv; y < n + (int32_t)got.bv; y++) {
                    for (int32_t x = -(int32_t)got.bu; x < n + (int32_t)got.bu; x++) {
                        double cx, cy;
                        to_cell(turns[face], (x + 0.5) / n, (y + 0.5) / n, &cx, &cy);
                        double expected = 0.1 * (cx + column) - 0.07 * (cy + row) + 0.3;
                        CHECK_MSG(fabs(expected - (double)kit_texel(&got, x, y)[0]) < 1e-5,
                                  "face %u level %u texel %d %d: %g, expected %g", face, level, x,
                                  y, (double)kit_texel(&got, x, y)[0], expected);
                    }
                }
                free(got.values);
            }
        }
        kit_free(&k);
    }
}

static void make(kit *k, int which, uint64_t *random) {
    switch (which) {
    case 0:
        kit_grid(k, 3, 3, true, 40, random, NULL);
        break;
    case 1:
        kit_grid(k, 4, 3, false, 40, random, NULL);
        break;
    case 2:
        kit_cube(k, random);
        break;
    case 3:
        kit_pentagons(k, random);
        break;
    default:
        kit_disc(k, which, random);
        break;
    }
}

/* Any resolutions, oblong ones too. */
static void scramble(kit *k, uint64_t *random) {
    for (uint32_t face = 0; face < k->nfaces; face++) {
        k->res[face].u = (int8_t)(test_random(random) % 5);
        k->res[face].v = (int8_t)(test_random(random) % 5);
    }
}

static void test_constant(void) {
    uint64_t random = 31;
    for (int round = 0; round < 60; round++) {
        kit k;
        make(&k, round % 10, &random);
        scramble(&k, &random);
        float texel[3] = {(float)(test_random(&random) % 256) / 255.0f, 0.0f, 1.0f}, rounded[3];
        unsigned char stored[12];
        slv_type type = types[round / 10 % 4];
        slv_type_from_float(type, texel, 3, stored);
        slv_type_to_float(type, stored, 3, rounded);
        kit_begin_texture(&k, type, 3);
        for (uint32_t face = 0; face < k.nfaces; face++)
            CHECK(slv_texture_set_constant(k.texture, face, stored) == SLV_OK);
        kit_end_texture(&k);
        for (uint32_t face = 0; face < k.nfaces; face++) {
            for (uint32_t level = 0; level < slv_levels_count(k.levels, face); level++) {
                kit_level got = kit_build(&k, face, level, 4, 2);
                size_t size = kit_level_size(&got);
                bool same = true;
                for (size_t i = 0; i < size; i++)
                    same = same && got.values[i] == rounded[i % 3];
                CHECK_MSG(same, "round %d face %u level %u", round, face, level);
                CHECK(!got.out_of_range);
                free(got.values);
                for (unsigned corner = 0; corner < 4; corner++) {
                    float m[3];
                    slv_border_vertex(k.levels, k.adjacency, face, level, corner, m);
                    CHECK(!memcmp(m, rounded, sizeof m));
                }
            }
        }
        kit_free(&k);
    }
}

/* Own texels stay, nothing is NaN, the same call gives the same bytes, and the range flag tells the
 * truth. */
static void test_noise(void) {
    uint64_t random = 41;
    for (int round = 0; round < 60; round++) {
        kit k;
        make(&k, round % 10, &random);
        scramble(&k, &random);
        slv_type type = types[round / 10 % 4];
        uint32_t nchannels = 1 + test_random(&random) % 4;
        kit_noise(&k, type, nchannels, &random);
        for (uint32_t face = 0; face < k.nfaces; face++) {
            for (uint32_t level = 0; level < slv_levels_count(k.levels, face); level++) {
                kit_level got = kit_build(&k, face, level, 5, 3),
                          again = kit_build(&k, face, level, 5, 3);
                size_t size = kit_level_size(&got), row = (size_t)nchannels << got.res.u;
                CHECK(!memcmp(got.values, again.values, size * sizeof *got.values));
                float least = 0, most = 1;
                for (size_t i = 0; i < size; i++) {
                    CHECK(isfinite(got.values[i]));
                    least = fminf(least, got.values[i]);
                    most = fmaxf(most, got.values[i]);
                }
                bool integers = type == SLV_TYPE_U8 || type == SLV_TYPE_U16;
                CHECK(got.out_of_range == (integers && (least < -1e-6f || most > 1.0f + 1e-6f)));
                float *own = malloc(row * sizeof *own);
                REQUIRE(own);
                for (int32_t y = 0; y < 1 << got.res.v; y++) {
                    const unsigned char *texels = slv_levels_texels(k.levels, face, level);
                    slv_type_to_float(type, texels + (size_t)y * row * slv_type_size(type), row,
                                      own);
                    CHECK(!memcmp(own, kit_texel(&got, 0, y), row * sizeof *own));
                }
                free(own);
                free(got.values);
                free(again.values);
            }
        }
        kit_free(&k);
    }
}

/* What a bordered level interpolates to at its corners is the vertex value. */
static void test_corners(void) {
    uint64_t random = 51;
    for (int round = 0; round < 40; round++) {
        kit k;
        make(&k, round % 10, &random);
        kit_equal(&k, 3);
        slv_type type = types[round / 10];
        kit_noise(&k, type, 20, &random);
        bool closed_low = round % 10 == 2;
        for (uint32_t face = 0; face < k.nfaces; face++) {
            for (uint32_t level = 0; level < slv_levels_count(k.levels, face); level++) {
                kit_level got = kit_build(&k, face, level, 1, 1);
                for (unsigned corner = 0; corner < 4; corner++) {
                    float m[20];
                    slv_border_vertex(k.levels, k.adjacency, face, level, corner, m);
                    double u = corner == 1 || corner == 2, v = corner >= 2;
                    for (uint32_t c = 0; c < 20; c++)
                        CHECK(fabs((double)kit_lookup(&got, u, v, c) - (double)m[c]) < 1e-5);
                }
                /* Three faces can always agree without leaving the range. */
                CHECK(!closed_low || !got.out_of_range);
                free(got.values);
            }
        }
        kit_free(&k);
    }
}

/* Every face around a vertex computes bitwise the same value, whatever resolutions meet there. */
static void test_vertex(void) {
    uint64_t random = 61;
    for (int which = 0; which < 13; which++) {
        kit k;
        make(&k, which, &random);
        for (int type = 0; type < 4; type++) {
            kit_mixed(&k, 4, &random);
            kit_noise(&k, types[type], 2, &random);
            for (uint32_t face = 0; face < k.nfaces; face++) {
                for (unsigned corner = 0; corner < 4; corner++) {
                    float mine[2], theirs[2];
                    slv_ring ring = slv_adjacency_ring(k.adjacency, (int32_t)face, corner, NULL);
                    slv_border_vertex(k.levels, k.adjacency, face, 0, corner, mine);
                    for (uint32_t i = 0; i < ring.count; i++) {
                        slv_border_vertex(k.levels, k.adjacency, (uint32_t)ring.corners[i].face, 0,
                                          ring.corners[i].corner, theirs);
                        CHECK(!memcmp(mine, theirs, sizeof mine));
                    }
                }
            }
        }
        kit_free(&k);
    }
}

static void test_errors(void) {
    uint64_t random = 71;
    kit k, other;
    float out[1024];
    kit_grid(&k, 2, 2, false, 0, NULL, NULL);
    kit_grid(&other, 3, 2, false, 0, NULL, NULL);
    kit_equal(&k, 2);
    kit_noise(&k, SLV_TYPE_U8, 3, &random);
    CHECK(slv_border_build(k.levels, other.adjacency, 0, 0, 1, 1, out, NULL) == SLV_ERROR_MISMATCH);
    CHECK(slv_border_build(k.levels, k.adjacency, 4, 0, 1, 1, out, NULL) == SLV_ERROR_ARGUMENT);
    CHECK(slv_border_build(k.levels, k.adjacency, 0, 3, 1, 1, out, NULL) == SLV_ERROR_ARGUMENT);
    CHECK(slv_border_build(k.levels, k.adjacency, 0, 0, 0, 1, out, NULL) == SLV_ERROR_ARGUMENT);
    CHECK(slv_border_build(k.levels, k.adjacency, 0, 0, 1, 5, out, NULL) == SLV_ERROR_ARGUMENT);
    CHECK(slv_border_build(k.levels, k.adjacency, 0, 0, 4, 4, out, NULL) == SLV_OK);
    kit_free(&other);
    kit_free(&k);
}

int main(void) {
    for (int type = 0; type < 4; type++) {
        for (int torus = 0; torus < 2; torus++) {
            test_image(torus, types[type], 4, 3);
            test_image(torus, types[type], 0, 1);
            test_image(torus, types[type], 3, 37);
        }
    }
    test_linear(false);
    test_linear(true);
    test_constant();
    test_noise();
    test_corners();
    test_vertex();
    test_errors();
    return test_end();
}
