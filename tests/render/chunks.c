/* Tables that are longer than a storage block may be: lookups are the same bits whatever the limit,
 * and values that faces share around a vertex are there once. The limit is a made-up one. */
#include "kit/change_kit.h"
#include "kit/lookup_kit.h"
#include "kit/strategy_kit.h"

#include "gl/context/api.h"

#include <selvage/gl_live.h>

#include <float.h>

enum { LIMIT = 16384 };

static slv_gl *gl;

static uint32_t look_up(const kit *k, const slv_strategy *strategy, float *out) {
    slv_env env = test_env();
    slv_gl_texture *texture = NULL;
    slv_gl_texture_params params = {KIT_ONLY(strategy)};
    slv_result result =
        slv_gl_texture_create(gl, &env, k->texture, k->adjacency, &params, &texture);
    REQUIRE(result == SLV_OK);
    result = slv_gl_texture_lookup(texture, &env, strategy, NPOINTS, faces, uv, dx, dy, out);
    REQUIRE(result == SLV_OK);
    uint32_t batches = slv_gl_texture_batch_count(texture, strategy);
    slv_gl_texture_destroy(texture);
    return batches;
}

static void check_limits(const kit *k) {
    static float whole[4 * NPOINTS], parts[4 * NPOINTS];
    uint64_t unlimited = gl->max_storage;
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        const slv_strategy *strategy = slv_strategy_at(s);
        if (test_skip(s, 3) && s + 1 < slv_strategy_count())
            continue;
        uint32_t few = look_up(k, strategy, whole);
        gl->max_storage = LIMIT;
        uint32_t many = look_up(k, strategy, parts);
        gl->max_storage = unlimited;
        CHECK(strategy->reach == SLV_GL_REACH_OWN ? many == few : many > few);
        int differ = 0;
        for (int i = 0; i < 4 * NPOINTS; i++)
            differ += memcmp(&whole[i], &parts[i], sizeof whole[i]) != 0;
        CHECK_MSG(differ == 0, "%s: %d values differ", strategy->name, differ);
    }
}

/* What is changed of a texture whose tables are in parts goes to the part that has it. */
static void check_updates(kit *k, uint64_t *random) {
    static float updated[4 * NPOINTS], fresh[4 * NPOINTS];
    static const char *const names[] = {"traverse", "htex"};
    slv_env env = test_env();
    uint64_t unlimited = gl->max_storage;
    for (int s = 0; s < 2; s++) {
        const slv_strategy *strategy = kit_strategy(names[s]);
        slv_gl_texture_params params = {KIT_ONLY(strategy), .live = true};
        slv_gl_texture *texture = NULL;
        gl->max_storage = LIMIT;
        REQUIRE(slv_gl_texture_create(gl, &env, k->texture, k->adjacency, &params, &texture) ==
                SLV_OK);
        for (int i = 0; i < 60; i++)
            kit_change(k, test_random(random) % k->nfaces, 1, random);
        REQUIRE(slv_gl_texture_update(texture, &env, NULL) == SLV_OK);
        REQUIRE(slv_gl_texture_lookup(texture, &env, strategy, NPOINTS, faces, uv, dx, dy,
                                      updated) == SLV_OK);
        slv_gl_texture_destroy(texture);
        look_up(k, strategy, fresh);
        gl->max_storage = unlimited;
        /* what has come to be of one value keeps its texels, which are weighed */
        for (int i = 0; i < 4 * NPOINTS; i++)
            CHECK_MSG(fabsf(updated[i] - fresh[i]) <=
                          4 * FLT_EPSILON * fabsf(fresh[i]) + kit_weight_step(gl),
                      "%s: %.9g, afresh %.9g", strategy->name, (double)updated[i],
                      (double)fresh[i]);
    }
}

/* A limit below what one chunk takes is said before anything is drawn. */
static void check_refusal(const kit *k) {
    slv_env env = test_env();
    slv_gl_texture *texture = NULL;
    uint64_t unlimited = gl->max_storage;
    slv_gl_texture_params params = {KIT_ONLY(kit_strategy("traverse"))};
    gl->max_storage = 256;
    CHECK(slv_gl_texture_create(gl, &env, k->texture, k->adjacency, &params, &texture) ==
          SLV_ERROR_LIMIT);
    gl->max_storage = unlimited;
    CHECK(texture == NULL && strstr(test_last_log, "limit"));
}

static uint64_t bytes_of(const kit *k, const char *name) {
    slv_env env = test_env();
    slv_gl_texture *texture = NULL;
    slv_gl_texture_params params = {KIT_ONLY(kit_strategy(name))};
    slv_result result =
        slv_gl_texture_create(gl, &env, k->texture, k->adjacency, &params, &texture);
    REQUIRE(result == SLV_OK);
    uint64_t bytes = slv_gl_texture_get_stats(texture, kit_strategy(name)).gpu_bytes;
    slv_gl_texture_destroy(texture);
    return bytes;
}

/* On a torus there are as many vertices as faces. */
static void check_sharing(uint64_t *random) {
    kit k;
    kit_grid(&k, 16, 16, true, 0, random, NULL);
    kit_equal(&k, 5);
    kit_noise(&k, SLV_TYPE_U8, 3, random);
    uint64_t tables = bytes_of(&k, "traverse") - bytes_of(&k, "discard");
    CHECK_MSG(tables <= k.nfaces * (64 + 6 * 16), "%llu bytes of tables",
              (unsigned long long)tables);
    kit_free(&k);
}

int main(void) {
    uint64_t random = 5;
    slv_env env = test_env();
    kit k;
    slv_result result = slv_gl_create(&env, SLV_GL_AUTO, &gl);
    REQUIRE(result == SLV_OK);
    kit_grid(&k, 14, 14, false, 20, &random, NULL);
    for (uint32_t f = 0; f < k.nfaces; f++)
        k.res[f] =
            (slv_res){(int8_t)(test_random(&random) % 4), (int8_t)(1 + test_random(&random) % 4)};
    kit_noise(&k, SLV_TYPE_HALF, 3, &random);
    random_points(&k, &random);
    check_limits(&k);
    check_refusal(&k);
    check_updates(&k, &random);
    kit_free(&k);
    check_sharing(&random);
    slv_gl_destroy(gl);
    return test_end();
}
