/* Common batches of several textures of one surface: every face is in exactly one, and each lies in
 * the one batch of each texture that it names, whatever resolutions and strategies they have, after
 * changes too; and textures that get into each other's way are refused. */
#include "kit/change_kit.h"
#include "kit/memory_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_live.h>
#include <selvage/gl_material.h>

enum { CASES = 60, MOST = 4 };

static slv_gl *gl;

static bool lists(const slv_gl_batch *batch, uint32_t face) {
    bool found = false;
    for (uint32_t i = 0; i < batch->nfaces; i++)
        found |= batch->faces[i] == face;
    return found;
}

static void check_batches(const slv_gl_material *material, const slv_gl_lookup *lookups,
                          uint32_t count, uint32_t nfaces) {
    uint32_t nbatches = slv_gl_material_batch_count(material), *seen = calloc(nfaces, sizeof *seen);
    uint32_t before[MOST] = {0};
    REQUIRE(seen);
    for (uint32_t b = 0; b < nbatches; b++) {
        slv_gl_common_batch common = slv_gl_material_batch(material, b);
        int order = 0; /* against the one before */
        CHECK(common.nfaces > 0);
        for (uint32_t k = 0; k < count; k++) {
            slv_gl_batch batch =
                slv_gl_texture_batch(lookups[k].texture, lookups[k].strategy, common.batches[k]);
            CHECK(batch.nfaces > 0 && batch.variant == common.variants[k]);
            for (uint32_t i = 0; i < common.nfaces; i++)
                CHECK(lists(&batch, common.faces[i]));
            if (!order && common.batches[k] != before[k])
                order = common.batches[k] > before[k] ? 1 : -1;
            before[k] = common.batches[k];
        }
        CHECK(b == 0 || order == 1);
        for (uint32_t i = 0; i < common.nfaces; i++)
            seen[common.faces[i]]++;
        slv_gl_material_bind(material, b);
    }
    slv_gl_material_unbind(material);
    for (uint32_t f = 0; f < nfaces; f++)
        CHECK_MSG(seen[f] == 1, "face %u is in %u batches", f, seen[f]);
    CHECK(slv_gl_material_batch(material, nbatches).nfaces == 0);
    free(seen);
}

/* A second texture for the same mesh. */
static kit with_other_texture(const kit *from, uint64_t *random) {
    kit k = *from;
    k.res = calloc(k.nfaces, sizeof *k.res);
    REQUIRE(k.res);
    kit_any_resolutions(&k, test_random(random) % 3, random);
    kit_noise(&k, SLV_TYPE_U8, 1 + test_random(random) % 3, random);
    return k;
}

static void free_texture(kit *k) {
    slv_levels_destroy(k->levels);
    slv_texture_destroy(k->texture);
    free(k->res);
}

static void check(uint32_t which, uint64_t *random) {
    slv_env env = test_env();
    uint32_t count = 1 + which % MOST;
    slv_gl_lookup lookups[MOST];
    slv_gl_material *material = NULL;
    bool changed = true, other = false;
    kit k, textures[MOST];
    kit_any_mesh(&k, test_random(random) % KIT_MESHES, random);
    for (uint32_t i = 0; i < count; i++) {
        const slv_strategy *strategy = slv_strategy_at(test_random(random) % slv_strategy_count());
        slv_gl_texture_params params = {
            KIT_ONLY(strategy),  .live = true,
            .batch_pools = 4,    .pool_layers = 1 + test_random(random) % 8,
            .first_unit = 4 * i, .first_storage = 4 + 4 * i};
        textures[i] = with_other_texture(&k, random);
        lookups[i] = (slv_gl_lookup){NULL, i % 2 ? strategy : NULL};
        REQUIRE(slv_gl_texture_create(gl, &env, textures[i].texture, k.adjacency, &params,
                                      &lookups[i].texture) == SLV_OK);
    }
    REQUIRE(slv_gl_material_create(&env, lookups, count, &material) == SLV_OK);
    check_batches(material, lookups, count, k.nfaces);
    REQUIRE(slv_gl_material_update(material, &env, &changed) == SLV_OK);
    CHECK(!changed);
    for (uint32_t i = 0; i < count; i++) {
        slv_gl_update update;
        kit_resize(&textures[i], test_random(random) % k.nfaces, 5, true, random);
        REQUIRE(slv_gl_texture_update(lookups[i].texture, &env, &update) == SLV_OK);
        other |= update.moved || update.renewed;
    }
    REQUIRE(slv_gl_material_update(material, &env, &changed) == SLV_OK);
    CHECK(changed || !other);
    check_batches(material, lookups, count, k.nfaces);
    slv_gl_material_destroy(material);
    for (uint32_t i = 0; i < count; i++) {
        slv_gl_texture_destroy(lookups[i].texture);
        free_texture(&textures[i]);
    }
    kit_free(&k);
}

/* Where an update fails, whatever it had come to, a texture may have no batches until the next one:
 * a material says so. */
static void check_failed_update(uint64_t *random) {
    static memory_count memory;
    slv_env env = test_env(), failing = memory_env(&memory);
    slv_gl_texture_params params = {.live = true};
    slv_gl_material *material = NULL;
    slv_gl_lookup lookup = {NULL, NULL};
    slv_result result = SLV_ERROR_MEMORY;
    uint32_t without = 0;
    kit k;
    kit_grid(&k, 4, 4, false, 0, random, NULL);
    kit_equal(&k, 3);
    kit_noise(&k, SLV_TYPE_U8, 3, random);
    REQUIRE(slv_gl_texture_create(gl, &failing, k.texture, k.adjacency, &params, &lookup.texture) ==
            SLV_OK);
    REQUIRE(slv_gl_material_create(&env, &lookup, 1, &material) == SLV_OK);
    for (uint32_t after = 1; result; after++) {
        kit_resize(&k, 5, 4, true, random);
        memory.fails = memory.asked + (long)after;
        result = slv_gl_texture_update(lookup.texture, &failing, NULL);
        memory.fails = 0;
        bool none = slv_gl_texture_batch_count(lookup.texture, NULL) == 0;
        slv_result listed = slv_gl_material_update(material, &env, NULL);
        CHECK_MSG(listed == (none ? SLV_ERROR_ARGUMENT : SLV_OK), "after %u: %d", after, listed);
        CHECK(!none || slv_gl_material_batch_count(material) == 0);
        without += none;
        REQUIRE(slv_gl_texture_update(lookup.texture, &env, NULL) == SLV_OK);
        REQUIRE(slv_gl_material_update(material, &env, NULL) == SLV_OK);
        check_batches(material, &lookup, 1, k.nfaces);
    }
    CHECK(without > 0);
    slv_gl_material_destroy(material);
    slv_gl_texture_destroy(lookup.texture);
    kit_free(&k);
}

static void refuse(const slv_gl_lookup *lookups, uint32_t count, slv_result expected,
                   const char *words) {
    slv_env env = test_env();
    slv_gl_material *material = NULL;
    CHECK(slv_gl_material_create(&env, lookups, count, &material) == expected && !material);
    CHECK_MSG(strstr(test_last_log, words), "it says: %s", test_last_log);
}

static void check_refusals(uint64_t *random) {
    slv_env env = test_env();
    slv_gl_texture_params params = {.batch_pools = 8, .binding = SLV_GL_BINDING_UNITS};
    slv_gl_texture *made[4];
    kit k, other;
    kit_grid(&k, 3, 3, false, 0, random, NULL);
    kit_equal(&k, 2);
    kit_noise(&k, SLV_TYPE_U8, 3, random);
    kit_grid(&other, 2, 2, false, 0, random, NULL);
    kit_equal(&other, 2);
    kit_noise(&other, SLV_TYPE_U8, 3, random);
    for (uint32_t i = 0; i < 4; i++) {
        const kit *of = i == 3 ? &other : &k;
        params.first_unit = i == 1 ? 4 : 8 * i;
        params.first_storage = i == 2 ? 7 : 4 + 4 * i;
        REQUIRE(slv_gl_texture_create(gl, &env, of->texture, of->adjacency, &params, &made[i]) ==
                SLV_OK);
    }
    refuse((slv_gl_lookup[]){{made[0], NULL}, {made[1], NULL}}, 2, SLV_ERROR_ARGUMENT,
           "texture units, from 0 and from 4");
    refuse((slv_gl_lookup[]){{made[0], NULL}, {made[2], NULL}}, 2, SLV_ERROR_ARGUMENT,
           "storage bindings, from 4 and from 7");
    refuse((slv_gl_lookup[]){{made[0], NULL}, {made[3], NULL}}, 2, SLV_ERROR_MISMATCH,
           "9 and 4 faces");
    refuse((slv_gl_lookup[]){{made[0], slv_strategy_find("htex")}}, 1, SLV_ERROR_ARGUMENT, "htex");
    refuse(NULL, 0, SLV_ERROR_ARGUMENT, "0 textures");
    for (uint32_t i = 0; i < 4; i++)
        slv_gl_texture_destroy(made[i]);
    kit_free(&k);
    kit_free(&other);
}

int main(void) {
    uint64_t random = 8;
    slv_env env = test_env();
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    for (uint32_t i = 0; i < test_effort(CASES); i++)
        check(i, &random);
    check_refusals(&random);
    check_failed_update(&random);
    slv_gl_destroy(gl);
    return test_end();
}
