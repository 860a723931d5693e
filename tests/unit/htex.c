/* Squares of half-edges: the same value from both sides of every edge and along every line inside a
 * face, whatever meets there; constants and linear functions kept; losses measured; no adjacency
 * that crashes it. */
#include "kit/border_kit.h"

#include <selvage/htex.h>

static slv_htex *convert(const kit *k, uint32_t threads) {
    slv_env env = test_env();
    slv_htex *htex = NULL;
    env.threads = threads;
    REQUIRE(slv_htex_create(&env, k->levels, k->adjacency, &htex) == SLV_OK);
    return htex;
}

static float uniform(uint64_t *random) {
    return (float)(test_random(random) % 65536) / 65535;
}

static void make(kit *k, uint32_t which, uint64_t *random) {
    if (which == 0)
        kit_pentagons(k, random);
    else if (which == 1)
        kit_cube(k, random);
    else if (which < 6)
        kit_disc(k, (int32_t)which + 1, random);
    else
        kit_grid(k, 4, 3, which % 2, which > 7 ? 40 : 0, random, NULL);
}

static void resolutions(kit *k, bool oblong, uint64_t *random) {
    kit_mixed(k, 4, random);
    for (uint32_t face = 0; oblong && face < k->nfaces; face++)
        k->res[face].v = (int8_t)(test_random(random) % 5);
}

/* Values at both sides of all edges, at many widths of footprint. */
static void check_edges(const kit *k, const slv_htex *htex, uint32_t which, uint64_t *random) {
    double most = 0;
    for (uint32_t face = 0; face < k->nfaces; face++) {
        for (unsigned edge = 0; edge < 4; edge++) {
            slv_neighbour to[2];
            uint32_t count = slv_adjacency_neighbours(k->adjacency, (int32_t)face, edge, to);
            for (uint32_t i = 0; i < 16 * count; i++) {
                const slv_neighbour *n = &to[i / 16];
                double t = i % 8 == 0 ? 0 : i % 8 == 1 ? 1 : (double)uniform(random), u, v;
                float width = i % 3 ? exp2f(-7 * uniform(random)) : 0, a[4], b[4], nu, nv;
                kit_edge_point(edge, (double)n->t0 + t * (double)(n->t1 - n->t0), &u, &v);
                slv_affine_apply(&n->map, (float)u, (float)v, &nu, &nv);
                slv_htex_lookup(htex, face, (float)u, (float)v, width, a);
                slv_htex_lookup(htex, (uint32_t)n->face, nu, nv, width * n->scale, b);
                for (uint32_t c = 0; c < k->nchannels; c++)
                    most = fmax(most, fabs((double)a[c] - (double)b[c]));
            }
        }
    }
    CHECK_MSG(most < 1e-4, "mesh %u: %g apart on an edge", which, most);
}

/* Squares have up to 32 texels along a side here: over a step of 1/4096 a continuous lookup changes
 * by a few per cent at most. */
static void check_lines(const kit *k, const slv_htex *htex, uint32_t which, uint64_t *random) {
    enum { STEPS = 4096 };
    for (uint32_t line = 0; line < 6; line++) {
        uint32_t face = test_random(random) % k->nfaces;
        float from[2], to[2], width = line % 2 ? exp2f(-6 * uniform(random)) : 0, values[2][4];
        double most = 0;
        for (int c = 0; c < 2; c++) {
            from[c] = uniform(random);
            to[c] = line < 3 ? 1 - from[c] : uniform(random); /* through the centre */
        }
        for (int i = 0; i <= STEPS; i++) {
            float t = (float)i / STEPS;
            slv_htex_lookup(htex, face, from[0] + t * (to[0] - from[0]),
                            from[1] + t * (to[1] - from[1]), width, values[i % 2]);
            for (uint32_t c = 0; i && c < k->nchannels; c++)
                most = fmax(most, fabs((double)values[0][c] - (double)values[1][c]));
        }
        CHECK_MSG(most < 0.06, "mesh %u: a step of %g in face %u, width %g", which, most, face,
                  (double)width);
    }
}

static void test_continuous(void) {
    uint64_t random = 21;
    for (uint32_t which = 0; which < 40; which++) {
        kit k;
        make(&k, which % 10, &random);
        resolutions(&k, which >= 20, &random);
        kit_noise(&k, which % 4 == 3 ? SLV_TYPE_U8 : SLV_TYPE_FLOAT, 1 + which % 4, &random);
        slv_htex *htex = convert(&k, 0);
        check_edges(&k, htex, which, &random);
        check_lines(&k, htex, which, &random);
        slv_htex_destroy(htex);
        kit_free(&k);
    }
}

/* A polygon is one face of half-edges, however many sub-faces it has. */
static void test_squares(void) {
    uint64_t random = 22;
    kit k;
    kit_pentagons(&k, &random);
    for (uint32_t face = 0; face < k.nfaces; face++)
        k.res[face] = kit_sub(&k, face) ? (slv_res){2, 2} : (slv_res){3, 1};
    kit_noise(&k, SLV_TYPE_U8, 3, &random);
    slv_htex *htex = convert(&k, 0);
    CHECK(slv_htex_edge_count(htex) == 15);
    uint64_t texels = 0;
    for (uint32_t edge = 0; edge < 15; edge++) {
        uint32_t log2 = slv_htex_log2(htex, edge);
        CHECK(log2 == 2 || log2 == 3);
        texels += log2 == 2 ? 16 + 4 + 1 : 64 + 16 + 4 + 1;
    }
    CHECK(slv_htex_bytes(htex) == 3 * texels);
    uint32_t seen[15] = {0};
    for (uint32_t face = 0; face < k.nfaces; face++) {
        slv_htex_face row = slv_htex_get_face(htex, face);
        CHECK(row.part == kit_sub(&k, face));
        for (uint32_t i = 0; i < 4; i++) {
            REQUIRE(row.edge[i] < 15);
            bool own = !row.part || i == 2;
            seen[row.edge[i]] += own ? row.second[i] ? 0x100 : 1 : 0;
            /* the quads' ring is at 4, everything beside a pentagon at 8 */
            if (row.part)
                CHECK(slv_htex_log2(htex, row.edge[i]) == 3);
        }
    }
    for (uint32_t edge = 0; edge < 15; edge++)
        CHECK(seen[edge] == 0x101); /* one half-edge for each half */
    slv_htex_destroy(htex);
    kit_free(&k);

    kit_grid(&k, 2, 2, false, 0, &random, NULL);
    kit_equal(&k, 0);
    kit_noise(&k, SLV_TYPE_FLOAT, 1, &random);
    htex = convert(&k, 0);
    const slv_texture_desc *desc = slv_htex_get_desc(htex);
    CHECK(desc->nfaces == 4 && desc->type == SLV_TYPE_FLOAT && desc->nchannels == 1);
    CHECK(slv_htex_edge_count(htex) == 12); /* 4 inside, 8 of the boundary */
    CHECK(slv_htex_log2(htex, 0) == 0 && slv_htex_bytes(htex) == 12 * sizeof(float));
    slv_htex_destroy(htex);
    kit_free(&k);
}

static void test_constant(void) {
    uint64_t random = 23;
    for (int type = 0; type < 4; type++) {
        kit k;
        float color[3] = {0.2f, 0.6f, 1.0f};
        unsigned char texel[12];
        make(&k, (uint32_t)type * 3, &random);
        resolutions(&k, true, &random);
        kit_begin_texture(&k, (slv_type)type, 3);
        slv_type_from_float((slv_type)type, color, 3, texel);
        for (uint32_t face = 0; face < k.nfaces; face++)
            REQUIRE(slv_texture_set_constant(k.texture, face, texel) == SLV_OK);
        kit_end_texture(&k);
        slv_type_to_float((slv_type)type, texel, 3, color);
        slv_htex *htex = convert(&k, 0);
        for (int i = 0; i < 500; i++) {
            float value[3];
            slv_htex_lookup(htex, test_random(&random) % k.nfaces, uniform(&random),
                            uniform(&random), uniform(&random), value);
            for (int c = 0; c < 3; c++)
                CHECK(fabsf(value[c] - color[c]) < 2e-6f);
        }
        slv_htex_destroy(htex);
        kit_free(&k);
    }
}

/* A linear function of the place on a grid comes out as it is, around vertices and centres too. */
static void test_linear(void) {
    enum { N = 16 };
    uint32_t turns[9];
    uint64_t random = 24;
    slv_env env = test_env();
    slv_htex_error error;
    kit k;
    kit_grid(&k, 3, 3, false, 0, &random, turns);
    kit_equal(&k, 4);
    kit_begin_texture(&k, SLV_TYPE_FLOAT, 1);
    for (uint32_t face = 0; face < 9; face++) {
        float texels[N * N];
        for (int i = 0; i < N * N; i++) {
            float u = ((float)(i % N) + 0.5f) / N, v = ((float)(i / N) + 0.5f) / N, turned;
            for (uint32_t turn = 0; turn < turns[face]; turn++) {
                turned = 1 - v;
                v = u;
                u = turned;
            }
            texels[i] = 0.1f * ((float)(face % 3) + u) + 0.2f * ((float)(face / 3) + v);
        }
        kit_set(&k, face, texels);
    }
    kit_end_texture(&k);
    slv_htex *htex = convert(&k, 0);
    for (int i = 0; i < 2000; i++) {
        float u = uniform(&random), v = uniform(&random), value;
        kit_level level = kit_build(&k, 4, 0, 1, 1);
        float expected = (float)kit_lookup(&level, (double)u, (double)v, 0);
        slv_htex_lookup(htex, 4, u, v, 0, &value);
        CHECK_MSG(fabsf(value - expected) < 2e-6f, "(%g, %g): %g for %g", (double)u, (double)v,
                  (double)value, (double)expected);
        free(level.values);
    }
    REQUIRE(slv_htex_measure(&env, htex, k.levels, k.adjacency, &error) == SLV_OK);
    CHECK(error.function_max < 0.02 && error.function_rms < 0.002);
    CHECK(error.texel_max <= error.function_max + 0.01);
    slv_htex_destroy(htex);
    kit_free(&k);
}

static void test_threads(void) {
    uint64_t random = 25;
    kit k;
    kit_grid(&k, 8, 8, false, 30, &random, NULL);
    for (int type = 0; type < 4; type++) {
        slv_env one = test_env(), many = test_env();
        slv_htex_error errors[2];
        resolutions(&k, true, &random);
        kit_noise(&k, (slv_type)type, 3, &random);
        slv_htex *a = convert(&k, 1), *b = convert(&k, 5);
        one.threads = 1;
        many.threads = 5;
        REQUIRE(slv_htex_bytes(a) == slv_htex_bytes(b));
        CHECK(memcmp(slv_htex_texels(a, 0, 0), slv_htex_texels(b, 0, 0), slv_htex_bytes(a)) == 0);
        REQUIRE(slv_htex_measure(&one, a, k.levels, k.adjacency, &errors[0]) == SLV_OK);
        REQUIRE(slv_htex_measure(&many, b, k.levels, k.adjacency, &errors[1]) == SLV_OK);
        CHECK(memcmp(&errors[0], &errors[1], sizeof errors[0]) == 0);
        CHECK(errors[0].function_rms > 0.01 && errors[0].function_max < 1);
        slv_htex_destroy(a);
        slv_htex_destroy(b);
    }
    kit_free(&k);
}

/* The measured losses against many lookups. */
static void test_measure(void) {
    enum { STEPS = 200 };
    uint64_t random = 26;
    slv_env env = test_env();
    kit k;
    slv_htex_error error;
    double sum = 0, most = 0, texels = 0;
    kit_pentagons(&k, &random);
    resolutions(&k, false, &random);
    kit_noise(&k, SLV_TYPE_FLOAT, 1, &random);
    slv_htex *htex = convert(&k, 0);
    REQUIRE(slv_htex_measure(&env, htex, k.levels, k.adjacency, &error) == SLV_OK);
    for (uint32_t face = 0; face < k.nfaces; face++) {
        kit_level bordered = kit_build(&k, face, 0, 1, 1);
        double weight = (double)kit_texels(k.res[face]) / (STEPS * STEPS);
        texels += (double)kit_texels(k.res[face]);
        for (int i = 0; i < STEPS * STEPS; i++) {
            double u = (i % STEPS + 0.5) / STEPS, v = (i / STEPS + 0.5) / STEPS;
            float value;
            slv_htex_lookup(htex, face, (float)u, (float)v, 0, &value);
            double lost = fabs((double)value - kit_lookup(&bordered, u, v, 0));
            sum += weight * lost * lost;
            most = fmax(most, lost);
        }
        free(bordered.values);
    }
    sum = sqrt(sum / texels);
    CHECK_MSG(fabs(sum - error.function_rms) < 0.03 * sum, "%g %g", sum, error.function_rms);
    CHECK_MSG(most >= error.function_max - 0.02 && most < 1.3 * error.function_max, "%g %g", most,
              error.function_max);
    slv_htex_destroy(htex);
    kit_free(&k);
}

/* Links of every kind, most of them cut when the adjacency is built; flags at random. */
static void test_hostile(void) {
    enum { FACES = 12 };
    uint64_t random = 27;
    for (int round = 0; round < 300; round++) {
        slv_env env = test_env();
        slv_face_adjacency links[FACES];
        uint8_t flags[FACES];
        slv_res res[FACES];
        slv_adjacency *adjacency = NULL;
        slv_texture *texture = NULL;
        slv_levels *levels = NULL;
        slv_htex *htex = NULL;
        for (int f = 0; f < FACES; f++) {
            flags[f] = test_random(&random) % 3 ? SLV_FACE_SUBFACE : 0;
            res[f] =
                (slv_res){(int8_t)(test_random(&random) % 4), (int8_t)(test_random(&random) % 4)};
            for (int e = 0; e < 4; e++)
                links[f].face[e] = SLV_BOUNDARY;
        }
        for (int i = 0; i < 20; i++) { /* pairs, so that some are mutual */
            uint32_t a = test_random(&random) % FACES, b = test_random(&random) % FACES;
            uint32_t ea = test_random(&random) % 4, eb = test_random(&random) % 4;
            if (round % 2) {
                ea = 1;
                eb = 2;
            }
            links[a].face[ea] = (int32_t)b;
            links[a].edge[ea] = (uint8_t)eb;
            links[b].face[eb] = (int32_t)a;
            links[b].edge[eb] = (uint8_t)ea;
        }
        slv_texture_desc desc = {FACES, SLV_TYPE_U8, 1, SLV_NO_ALPHA, res, SLV_TEXTURE_AUTO};
        REQUIRE(slv_adjacency_create(&env, FACES, links, flags, &adjacency) == SLV_OK);
        REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
        for (uint32_t f = 0; f < FACES; f++) {
            uint8_t texel = 255;
            REQUIRE(slv_texture_set_constant(texture, f, &texel) == SLV_OK);
        }
        REQUIRE(slv_levels_create(&env, texture, &levels) == SLV_OK);
        REQUIRE(slv_htex_create(&env, levels, adjacency, &htex) == SLV_OK);
        for (int i = 0; i < 100; i++) {
            static const float odd[] = {0, 1, -1, 1e30f, -1e30f, INFINITY, -INFINITY, NAN};
            float at[3], value;
            for (int c = 0; c < 3; c++)
                at[c] = test_random(&random) % 4 ? uniform(&random) : odd[test_random(&random) % 8];
            slv_htex_lookup(htex, test_random(&random) % FACES, at[0], at[1], at[2], &value);
            CHECK_MSG(value > 0 && value < 4, "%g at (%g, %g)", (double)value, (double)at[0],
                      (double)at[1]);
        }
        slv_htex_destroy(htex);
        slv_levels_destroy(levels);
        slv_texture_destroy(texture);
        slv_adjacency_destroy(adjacency);
    }
}

static void test_refused(void) {
    uint64_t random = 28;
    slv_env env = test_env();
    slv_htex *htex = NULL;
    slv_htex_error error;
    kit a, b;
    kit_cube(&a, &random);
    kit_disc(&b, 3, &random);
    kit_equal(&a, 1);
    kit_equal(&b, 1);
    kit_noise(&a, SLV_TYPE_FLOAT, 1, &random);
    kit_noise(&b, SLV_TYPE_FLOAT, 1, &random);
    CHECK(slv_htex_create(&env, a.levels, b.adjacency, &htex) == SLV_ERROR_MISMATCH);
    CHECK(!htex);
    env.max_bytes = 64;
    CHECK(slv_htex_create(&env, a.levels, a.adjacency, &htex) == SLV_ERROR_LIMIT);
    CHECK(!htex);
    env.max_bytes = 0;
    htex = convert(&a, 1);
    CHECK(slv_htex_measure(&env, htex, b.levels, b.adjacency, &error) == SLV_ERROR_MISMATCH);
    slv_htex_destroy(htex);
    slv_htex_destroy(NULL);
    kit_free(&a);
    kit_free(&b);
}

int main(void) {
    test_continuous();
    test_squares();
    test_constant();
    test_linear();
    test_threads();
    test_measure();
    test_hostile();
    test_refused();
    return test_end();
}
