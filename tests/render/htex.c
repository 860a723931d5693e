/* Half-edge squares on the GPU: lookups are those of slv_htex_lookup, in every part of a face, at
 * every level, however the squares are spread over array textures; and those with anisotropy are
 * means along their rows, the same on both sides of an edge. */
#include "kit/border_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_texture.h>
#include <selvage/htex.h>

enum { POINTS = 4096 };

static slv_gl *gl;
static int32_t faces[POINTS];
static float uv[2 * POINTS], dx[2 * POINTS], dy[2 * POINTS], widths[POINTS], values[4 * POINTS];

static void random_points(const kit *k, uint64_t *random) {
    for (int i = 0; i < POINTS; i++) {
        uint32_t face = test_random(random) % k->nfaces, where = test_random(random) % 4;
        float width = exp2f(-8 + (float)(test_random(random) % 1024) / 128);
        faces[i] = (int32_t)face;
        widths[i] = width;
        for (int c = 0; c < 2; c++)
            uv[2 * i + c] = (float)(test_random(random) % 257) / 256;
        if (where == 0) /* on an edge, or on a side between two squares */
            uv[2 * i] = (float)(test_random(random) % 3) / 2;
        else if (where == 1)
            uv[2 * i] = test_random(random) % 2 ? uv[2 * i + 1] : 1 - uv[2 * i + 1];
        dx[2 * i] = dy[2 * i + 1] = width;
        dx[2 * i + 1] = dy[2 * i] = 0;
    }
}

static void check_values(const kit *k, const char *name, uint32_t pool_layers, uint64_t *random) {
    slv_env env = test_env();
    slv_htex *htex = NULL;
    REQUIRE(slv_htex_create(&env, k->levels, k->adjacency, &htex) == SLV_OK);
    random_points(k, random);
    for (int branching = SLV_GL_BRANCHING_REAL; branching <= SLV_GL_BRANCHING_VECTORS;
         branching++) {
        slv_gl_texture_params params = {KIT_ONLY(kit_strategy("htex")),
                                        .branching = (slv_gl_branching)branching,
                                        .pool_layers = pool_layers, .batch_pools = 1};
        slv_gl_texture *texture = NULL;
        int wrong = 0;
        REQUIRE(slv_gl_texture_create(gl, &env, k->texture, k->adjacency, &params, &texture) ==
                SLV_OK);
        REQUIRE(slv_gl_texture_lookup(texture, &env, kit_strategy("htex"), POINTS, faces, uv, dx,
                                      dy, values) == SLV_OK);
        for (int i = 0; i < POINTS && wrong < 4; i++) {
            float expected[4] = {0, 0, 0, 1};
            slv_htex_lookup(htex, (uint32_t)faces[i], uv[2 * i], uv[2 * i + 1], widths[i],
                            expected);
            if (k->nchannels == 1)
                expected[1] = expected[2] = expected[0];
            for (int c = 0; c < 4; c++) {
                float got = values[4 * i + c];
                bool good = fabsf(got - expected[c]) < 5e-3f;
                wrong += !good;
                CHECK_MSG(good, "%s %s %s: face %d of %d x %d at (%g, %g), width %g: %g for %g",
                          name, slv_type_name(k->type),
                          branching == SLV_GL_BRANCHING_REAL ? "branches" : "vectors", faces[i],
                          1 << k->res[faces[i]].u, 1 << k->res[faces[i]].v, (double)uv[2 * i],
                          (double)uv[2 * i + 1], (double)widths[i], (double)got,
                          (double)expected[c]);
            }
        }
        slv_gl_texture_destroy(texture);
    }
    slv_htex_destroy(htex);
}

/* Rows of taps of any length and direction: the same on both sides of an edge. */
static void check_rows(const kit *k, const char *name, uint64_t *random) {
    slv_env env = test_env();
    slv_gl_texture_params params = {KIT_ONLY(kit_strategy("htex")), .anisotropy = 16};
    slv_gl_texture *texture = NULL;
    float most = 0;
    REQUIRE(slv_gl_texture_create(gl, &env, k->texture, k->adjacency, &params, &texture) == SLV_OK);
    for (int i = 0; i < POINTS;) {
        uint32_t face = test_random(random) % k->nfaces;
        unsigned edge = test_random(random) % 4;
        slv_neighbour to[2];
        double u, v, t = (double)(test_random(random) % 65) / 64;
        float angle = 6.2831853f * (float)(test_random(random) % 1000) / 1000;
        float longest = exp2f(-7 + (float)(test_random(random) % 1024) / 128);
        float shortest = longest * exp2f(-(float)(test_random(random) % 1024) / 200);
        if (!slv_adjacency_neighbours(k->adjacency, (int32_t)face, edge, to))
            continue;
        kit_edge_point(edge, (double)to[0].t0 + t * (double)(to[0].t1 - to[0].t0), &u, &v);
        const slv_affine *m = &to[0].map;
        int j = i + 1;
        faces[i] = (int32_t)face;
        faces[j] = to[0].face;
        uv[2 * i] = (float)u;
        uv[2 * i + 1] = (float)v;
        slv_affine_apply(m, uv[2 * i], uv[2 * i + 1], &uv[2 * j], &uv[2 * j + 1]);
        float *sides[2] = {dx, dy}, lengths[2] = {longest, shortest};
        for (int s = 0; s < 2; s++) {
            float *a = sides[s] + 2 * i, *b = a + 2;
            a[0] = lengths[s] * (s ? -sinf(angle) : cosf(angle));
            a[1] = lengths[s] * (s ? cosf(angle) : sinf(angle));
            b[0] = m->uu * a[0] + m->uv * a[1];
            b[1] = m->vu * a[0] + m->vv * a[1];
        }
        i += 2;
    }
    REQUIRE(slv_gl_texture_lookup(texture, &env, kit_strategy("htex"), POINTS, faces, uv, dx, dy,
                                  values) == SLV_OK);
    for (int i = 0; i < POINTS; i += 2)
        for (int c = 0; c < 4; c++)
            most = fmaxf(most, fabsf(values[4 * i + c] - values[4 * i + 4 + c]));
    CHECK_MSG(most <= 1.0f / 255, "%s: rows of taps are %g apart on an edge", name, (double)most);
    slv_gl_texture_destroy(texture);
}

/* On a face's diagonals it goes over from one square to the next, without a jump as long as rows
 * stay in the two triangles there. */
static void check_diagonals(const kit *k, const char *name, uint32_t anisotropy, uint64_t *random) {
    slv_env env = test_env();
    slv_gl_texture_params params = {KIT_ONLY(kit_strategy("htex")), .anisotropy = anisotropy};
    slv_gl_texture *texture = NULL;
    float most = 0;
    int worst = 0;
    REQUIRE(slv_gl_texture_create(gl, &env, k->texture, k->adjacency, &params, &texture) == SLV_OK);
    for (int i = 0; i < POINTS; i += 2) {
        float t = (float)(test_random(random) % 1023 + 1) / 1024;
        float room = anisotropy > 1 ? 0.4f * fminf(fabsf(t - 0.5f), fminf(t, 1 - t)) : 1;
        float angle = 6.2831853f * (float)(test_random(random) % 1000) / 1000;
        float longest = room * exp2f(1 - (float)(test_random(random) % 1024) / 128);
        float shortest = longest * exp2f(-(float)(test_random(random) % 1024) / 200);
        bool rising = test_random(random) % 2;
        faces[i] = faces[i + 1] = (int32_t)(test_random(random) % k->nfaces);
        for (int j = i; j < i + 2; j++) {
            float apart = j > i ? 1e-6f : -1e-6f;
            uv[2 * j] = t + apart;
            uv[2 * j + 1] = rising ? t - apart : 1 - t + apart;
            dx[2 * j] = longest * cosf(angle);
            dx[2 * j + 1] = longest * sinf(angle);
            dy[2 * j] = -shortest * sinf(angle);
            dy[2 * j + 1] = shortest * cosf(angle);
        }
    }
    REQUIRE(slv_gl_texture_lookup(texture, &env, kit_strategy("htex"), POINTS, faces, uv, dx, dy,
                                  values) == SLV_OK);
    for (int i = 0; i < POINTS; i += 2)
        for (int c = 0; c < 4; c++) {
            float apart = fabsf(values[4 * i + c] - values[4 * i + 4 + c]);
            worst = apart > most ? i : worst;
            most = fmaxf(most, apart);
        }
    CHECK_MSG(most <= 1.0f / 255, "%s: %ux: %g apart on a diagonal, at (%g, %g), row (%g, %g)",
              name, anisotropy, (double)most, (double)uv[2 * worst], (double)uv[2 * worst + 1],
              (double)dx[2 * worst], (double)dx[2 * worst + 1]);
    slv_gl_texture_destroy(texture);
}

/* A row of taps that stays in one triangle is the mean of magnified lookups along it, in any
 * direction. */
static void check_means(uint64_t *random) {
    enum { STEPS = 64 };
    slv_env env = test_env();
    slv_gl_texture_params params = {KIT_ONLY(kit_strategy("htex")), .anisotropy = 16};
    slv_gl_texture *texture = NULL;
    slv_htex *htex = NULL;
    const float length = 0.15f;
    double squares = 0, spread = 0;
    kit k;
    kit_grid(&k, 4, 4, false, 0, random, NULL);
    kit_equal(&k, 5);
    kit_noise(&k, SLV_TYPE_U8, 1, random);
    REQUIRE(slv_htex_create(&env, k.levels, k.adjacency, &htex) == SLV_OK);
    REQUIRE(slv_gl_texture_create(gl, &env, k.texture, k.adjacency, &params, &texture) == SLV_OK);
    for (int i = 0; i < POINTS; i++) {
        uint32_t edge = test_random(random) % 4;
        float angle = 6.2831853f * (float)(test_random(random) % 1000) / 1000;
        faces[i] = (int32_t)(test_random(random) % k.nfaces);
        uv[2 * i] = edge % 2 == 0 ? 0.5f : edge == 1 ? 0.8f : 0.2f;
        uv[2 * i + 1] = edge % 2 ? 0.5f : edge == 2 ? 0.8f : 0.2f;
        dx[2 * i] = length * cosf(angle);
        dx[2 * i + 1] = length * sinf(angle);
        dy[2 * i] = -dx[2 * i + 1] / 16;
        dy[2 * i + 1] = dx[2 * i] / 16;
    }
    REQUIRE(slv_gl_texture_lookup(texture, &env, kit_strategy("htex"), POINTS, faces, uv, dx, dy,
                                  values) == SLV_OK);
    for (int i = 0; i < POINTS; i++) {
        float mean = 0;
        for (int step = 0; step < STEPS; step++) {
            float at = ((float)step + 0.5f) / STEPS - 0.5f, value;
            slv_htex_lookup(htex, (uint32_t)faces[i], uv[2 * i] + at * dx[2 * i],
                            uv[2 * i + 1] + at * dx[2 * i + 1], 0, &value);
            mean += value / STEPS;
        }
        squares += (double)((values[4 * i] - mean) * (values[4 * i] - mean));
        spread += (double)((mean - 0.5f) * (mean - 0.5f));
    }
    CHECK_MSG(squares < 0.01 * spread, "rows of taps are %g from means that vary by %g",
              sqrt(squares / POINTS), sqrt(spread / POINTS));
    slv_gl_texture_destroy(texture);
    slv_htex_destroy(htex);
    kit_free(&k);
}

/* Faces that meet get squares in the same array textures, and so share batches. */
static void check_batches(uint64_t *random) {
    slv_env env = test_env();
    slv_gl_texture_params params = {KIT_ONLY(kit_strategy("htex")), .pool_layers = 16};
    slv_gl_texture *texture = NULL;
    uint32_t drawn = 0;
    kit k;
    kit_grid(&k, 15, 15, false, 0, random, NULL);
    for (uint32_t f = 0; f < k.nfaces; f++)
        k.res[f] = (slv_res){2, (int8_t)(2 + f % 2)};
    kit_noise(&k, SLV_TYPE_U8, 3, random);
    REQUIRE(slv_gl_texture_create(gl, &env, k.texture, k.adjacency, &params, &texture) == SLV_OK);
    slv_gl_texture_stats stats = slv_gl_texture_get_stats(texture, kit_strategy("htex"));
    CHECK(stats.pools == 30); /* 480 edges, all of 8 x 8 texels */
    CHECK_MSG(stats.batches < 4 * stats.pools, "%u batches for %u pools", stats.batches,
              stats.pools);
    for (uint32_t b = 0; b < stats.batches; b++) {
        slv_gl_batch batch = slv_gl_texture_batch(texture, kit_strategy("htex"), b);
        CHECK(batch.variant <= 8 && batch.nfaces > 0);
        drawn += batch.nfaces;
    }
    CHECK(drawn == k.nfaces);
    slv_gl_texture_destroy(texture);
    kit_free(&k);
}

int main(void) {
    uint64_t random = 3;
    slv_env env = test_env();
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    for (int round = 0; round < 8; round++) {
        kit k;
        char name[32];
        snprintf(name, sizeof name, "round %d", round);
        if (round % 4 == 0)
            kit_pentagons(&k, &random);
        else if (round % 4 == 1)
            kit_disc(&k, 3 + round, &random);
        else
            kit_grid(&k, 4, 3, round % 4 == 2, 30, &random, NULL);
        for (uint32_t f = 0; f < k.nfaces; f++)
            k.res[f] =
                (slv_res){(int8_t)(test_random(&random) % 6), (int8_t)(test_random(&random) % 6)};
        if (round < 2)
            kit_equal(&k, 3);
        kit_noise(&k, (slv_type)(round % 4), 1 + test_random(&random) % 4, &random);
        check_values(&k, name, round % 2 ? 2 : 0, &random);
        check_rows(&k, name, &random);
        check_diagonals(&k, name, 1, &random);
        check_diagonals(&k, name, 16, &random);
        kit_free(&k);
    }
    check_means(&random);
    check_batches(&random);
    slv_gl_destroy(gl);
    return test_end();
}
