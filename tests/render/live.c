/* A texture on the GPU that follows changes holds the texels that one made afresh holds, whatever
 * the mesh, the resolutions, the type, the strategy and the sequence of changes; with
 * SELVAGE_TEST_BLOCKS also compressed. */
#include "kit/change_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_live.h>
#include <selvage/htex.h>

#include <float.h>
#include <math.h>
#include <pthread.h>

enum { CASES = TEST_SANITIZED ? 20 : 60, LOOKUPS = 600, MOST_LEVEL = 4 << 20 };

static slv_gl *gl;
static uint32_t moved, renewed; /* how often */

static uint32_t item_count(const kit *k, const slv_strategy *strategy) {
    const slv_form *form = strategy->form();
    slv_env env = test_env();
    void *made = NULL;
    REQUIRE(form->create(&env, k->levels, k->adjacency, 1, &made) == SLV_OK);
    uint32_t count = form->count(made);
    form->destroy(made);
    return count;
}

/* Whether both hold the same. A face that has come to be of one value keeps its layer; made afresh
 * it is one texel. */
static bool is_same(const unsigned char *followed, uint64_t size, const unsigned char *fresh,
                    uint64_t fresh_size) {
    bool same = fresh_size && size % fresh_size == 0;
    for (uint64_t at = 0; same && at < size; at += fresh_size)
        same = memcmp(followed + at, fresh, fresh_size) == 0;
    return same;
}

/* All stored texels of one strategy. */
static void compare_texels(const kit *k, const slv_gl_texture *a, const slv_gl_texture *b,
                           const slv_strategy *strategy, uint32_t which) {
    static unsigned char held[2][MOST_LEVEL];
    slv_env env = test_env();
    uint32_t count = item_count(k, strategy);
    for (uint32_t item = 0; item < count; item++) {
        uint64_t sizes[2] = {0};
        for (uint32_t level = 0;; level++) {
            slv_env quiet = {0};
            if (slv_gl_texture_read(b, &quiet, strategy, item, level, 0, NULL, &sizes[1]))
                break;
            REQUIRE(slv_gl_texture_read(a, &env, strategy, item, level, MOST_LEVEL, held[0],
                                        &sizes[0]) == SLV_OK);
            REQUIRE(slv_gl_texture_read(b, &env, strategy, item, level, MOST_LEVEL, held[1],
                                        &sizes[1]) == SLV_OK);
            CHECK_MSG(is_same(held[0], sizes[0], held[1], sizes[1]),
                      "case %u, %s: item %u level %u", which, strategy->name, item, level);
        }
    }
}

/* The same but for the last bits, in which weighing equal texels differs from taking one. */
static bool is_near(const float a[4], const float b[4]) {
    bool near = true;
    for (int c = 0; c < 4; c++)
        near = near && fabsf(a[c] - b[c]) <= 4 * FLT_EPSILON * fabsf(b[c]) + kit_weight_step(gl);
    return near;
}

/* What tables hold shows in lookups only. They may round otherwise, by `within`, where a face lies
 * elsewhere in arrays of other sizes. */
static void compare_lookups(const kit *k, slv_gl_texture *a, slv_gl_texture *b,
                            const slv_strategy *strategy, float within, uint32_t which,
                            uint64_t *random) {
    static int32_t faces[LOOKUPS];
    static float uv[2 * LOOKUPS], dx[2 * LOOKUPS], dy[2 * LOOKUPS], out[2][4 * LOOKUPS];
    slv_env env = test_env();
    for (uint32_t i = 0; i < LOOKUPS; i++) {
        float width = 1.0f / (float)(1u << test_random(random) % 8);
        faces[i] = (int32_t)(test_random(random) % k->nfaces);
        for (uint32_t c = 0; c < 2; c++) {
            uint32_t at = test_random(random) % 4;
            uv[2 * i + c] = at == 0 ? 0 : at == 1 ? 1 : (float)(test_random(random) % 1024) / 1023;
            dx[2 * i + c] = c == 0 ? width : 0;
            dy[2 * i + c] = c == 1 ? width : 0;
        }
    }
    REQUIRE(slv_gl_texture_lookup(a, &env, strategy, LOOKUPS, faces, uv, dx, dy, out[0]) == SLV_OK);
    REQUIRE(slv_gl_texture_lookup(b, &env, strategy, LOOKUPS, faces, uv, dx, dy, out[1]) == SLV_OK);
    for (uint32_t i = 0; i < LOOKUPS; i++) {
        bool same = is_near(&out[0][4 * i], &out[1][4 * i]);
        if (within > 0) {
            float most = 0;
            for (uint32_t c = 4 * i; c < 4 * i + 4; c++)
                most = fmaxf(most, fabsf(out[0][c] - out[1][c]));
            same = most <= within + kit_weight_step(gl);
        }
        CHECK_MSG(same, "case %u, %s: face %d at %g,%g, width %g: %g %g %g, afresh %g %g %g", which,
                  strategy->name, faces[i], uv[2 * i], uv[2 * i + 1], dx[2 * i], out[0][4 * i],
                  out[0][4 * i + 1], out[0][4 * i + 2], out[1][4 * i], out[1][4 * i + 1],
                  out[1][4 * i + 2]);
    }
}

static slv_gl_texture *make(const kit *k, const slv_gl_texture_params *params) {
    slv_env env = test_env();
    slv_gl_texture *made = NULL;
    REQUIRE(slv_gl_texture_create(gl, &env, k->texture, k->adjacency, params, &made) == SLV_OK);
    return made;
}

static void check(uint32_t which, bool lookups, uint64_t *random) {
    static const slv_type types[] = {SLV_TYPE_U8, SLV_TYPE_HALF, SLV_TYPE_FLOAT, SLV_TYPE_U16};
    static const slv_texture_encoding encodings[] = {SLV_TEXTURE_AUTO, SLV_TEXTURE_DATA};
    const slv_strategy *strategy = slv_strategy_at(which % slv_strategy_count());
    slv_env env = test_env();
    slv_type type = types[test_random(random) % 4];
    bool blocks = getenv("SELVAGE_TEST_BLOCKS") || which % 5 == 0;
    slv_gl_texture_params params = {KIT_ONLY(strategy),
                                    .anisotropy = 1 + test_random(random) % 3,
                                    .pool_layers = 1 + test_random(random) % 64,
                                    .encoding = encodings[test_random(random) % 2],
                                    .even_levels = test_random(random) % 2 != 0,
                                    .whole = test_random(random) % 4 == 0};
    kit k;
    kit_any_mesh(&k, test_random(random) % KIT_MESHES, random);
    kit_any_resolutions(&k, test_random(random) % 3, random);
    if (blocks)
        type = SLV_TYPE_U8;
    params.layout = which / 8 % 3;
    if (blocks)
        params.compression = SLV_GL_COMPRESSION_BLOCKS;
    kit_noise(&k, type, 1 + test_random(random) % 4, random);
    params.live = true;
    params.pixel_buffers = which % 3 == 0; /* one of both: texels are the same */
    slv_gl_texture *followed = make(&k, &params);
    params.pixel_buffers = !params.pixel_buffers && which % 2;
    params.live = params.even_levels; /* of which squares of one size need none, if they stay so */
    for (uint32_t round = 0; round < 3; round++) {
        uint32_t changes = 1 + test_random(random) % 6;
        /* values that lookups have to be made otherwise for */
        bool large = type == SLV_TYPE_FLOAT && round < 2 && which % 3 == 0;
        for (uint32_t i = 0; i < changes; i++)
            kit_change(&k, test_random(random) % k.nfaces, large ? 1e32f : 1, random);
        for (uint32_t i = 0; round && which / 3 % 2 && i < 1 + which % 3; i++)
            kit_resize(&k, test_random(random) % k.nfaces, 5, which % 8 < 4, random);
        slv_gl_update update;
        REQUIRE(slv_gl_texture_update(followed, &env, &update) == SLV_OK);
        CHECK(update.faces > 0 && (update.bytes > 0 || update.renewed));
        moved += update.moved;
        renewed += update.renewed;
        bool elsewhere = !update.renewed && strategy->packing == SLV_GL_PAGES;
        if (round == 1)
            continue;
        slv_gl_texture *fresh = make(&k, &params);
        compare_texels(&k, followed, fresh, strategy, which);
        if (lookups && round == 2)
            compare_lookups(&k, followed, fresh, strategy, elsewhere ? 1e-4f : 0, which, random);
        slv_gl_texture_stats a = slv_gl_texture_get_stats(followed, strategy);
        slv_gl_texture_stats b = slv_gl_texture_get_stats(fresh, strategy);
        CHECK_MSG(a.widened == b.widened && a.clipped == b.clipped, "case %u", which);
        uint32_t wide = 0;
        for (uint32_t f = 0; f < k.nfaces; f++)
            wide += slv_gl_texture_is_widened(followed, strategy, f);
        CHECK_MSG(wide == a.widened + a.clipped, "case %u: %u faces are widened, not %u", which,
                  wide, a.widened + a.clipped);
        slv_gl_texture_destroy(fresh);
    }
    slv_gl_texture_destroy(followed);
    kit_free(&k);
}

struct preparation {
    const kit *k;
    const slv_gl_texture_params *params;
    slv_gl_texture *made;
};

static void *prepare(void *user) {
    struct preparation *p = user;
    slv_env env = test_env();
    REQUIRE(slv_gl_texture_prepare(gl, &env, p->k->texture, p->k->adjacency, p->params, &p->made) ==
            SLV_OK);
    return NULL;
}

/* A texture that was prepared on another thread and uploaded bit by bit is one that was made at
 * once; and may be given up halfway. */
static void check_steps(uint32_t which, uint64_t *random) {
    const slv_strategy *strategy = slv_strategy_at(which % slv_strategy_count());
    slv_gl_texture_params params = {KIT_ONLY(strategy), .pool_layers = 1 + which % 16,
                                    .layout = which / 3 % 3};
    slv_env env = test_env();
    pthread_t thread;
    kit k;
    kit_any_mesh(&k, which % KIT_MESHES, random);
    kit_any_resolutions(&k, which % 3, random);
    kit_noise(&k, SLV_TYPE_U8, 3, random);
    struct preparation p = {.k = &k, .params = &params};
    params.live = which % 2;
    REQUIRE(pthread_create(&thread, NULL, prepare, &p) == 0);
    REQUIRE(pthread_join(thread, NULL) == 0);
    slv_gl_upload upload = {0};
    uint64_t budget = 1 + test_random(random) % 20000, before = 0;
    uint32_t calls = 0, last = which % 4 == 3 ? 3 : UINT32_MAX;
    while (!upload.ready && calls < last) {
        CHECK(slv_gl_texture_batch_count(p.made, strategy) == 0);
        REQUIRE(slv_gl_texture_upload(p.made, &env, budget, &upload) == SLV_OK);
        CHECK(upload.done > before || calls == 0);
        CHECK(upload.done <= upload.total && upload.total > 0);
        before = upload.done;
        calls++;
    }
    if (upload.ready) {
        CHECK_MSG(upload.done == upload.total, "case %u: %llu of %llu", which,
                  (unsigned long long)upload.done, (unsigned long long)upload.total);
        slv_gl_texture *fresh = make(&k, &params);
        compare_texels(&k, p.made, fresh, strategy, which);
        if (which < slv_strategy_count())
            compare_lookups(&k, p.made, fresh, strategy, 0, which, random);
        CHECK(slv_gl_texture_batch_count(p.made, strategy) ==
              slv_gl_texture_batch_count(fresh, strategy));
        CHECK(slv_gl_texture_get_stats(p.made, strategy).gpu_bytes ==
              slv_gl_texture_get_stats(fresh, strategy).gpu_bytes);
        slv_gl_texture_destroy(fresh);
    }
    slv_gl_texture_destroy(p.made);
    kit_free(&k);
}

/* Under a brush one face after the other comes to be of one colour, and another thing again: none
 * moves, so that batches stay what they were, and drivers need no other shaders. With `whole` that
 * is so of what begins as one colour. */
static void check_stays(const slv_strategy *strategy, bool whole, uint64_t *random) {
    const slv_gl_texture_params params = {KIT_ONLY(strategy), .live = true, .whole = whole};
    const uint16_t texel[3] = {0x3a00, 0x3200, 0x2c00};
    slv_env env = test_env();
    slv_gl_update update;
    kit k;
    kit_any_mesh(&k, 0, random);
    kit_any_resolutions(&k, 2, random);
    kit_noise(&k, SLV_TYPE_HALF, 3, random);
    for (uint32_t f = 0; whole && f < k.nfaces; f++)
        REQUIRE(slv_texture_set_constant(k.texture, f, texel) == SLV_OK);
    slv_gl_texture *followed = make(&k, &params);
    for (uint32_t round = whole; round < 2; round++) {
        for (uint32_t f = 0; f < k.nfaces; f++) {
            if (round)
                kit_change(&k, f, 1, random);
            else
                REQUIRE(slv_texture_set_constant(k.texture, f, texel) == SLV_OK);
        }
        REQUIRE(slv_gl_texture_update(followed, &env, &update) == SLV_OK);
        CHECK_MSG(update.moved == 0, "%s: %u items have moved", strategy->name, update.moved);
        slv_gl_texture *fresh = make(&k, &params);
        compare_lookups(&k, followed, fresh, strategy,
                        strategy->packing == SLV_GL_PAGES ? 1e-4f : 0, round, random);
        slv_gl_texture_destroy(fresh);
    }
    slv_gl_texture_destroy(followed);
    kit_free(&k);
}

/* A texture that was not made to follow changes says so, and one that nothing was changed of does
 * nothing. */
static void check_refused(void) {
    uint64_t random = 3;
    slv_env env = test_env(), quiet = {0};
    slv_gl_texture_params params = {KIT_ONLY(slv_strategy_at(0))};
    slv_gl_update update;
    kit k;
    kit_cube(&k, &random);
    kit_equal(&k, 2);
    kit_noise(&k, SLV_TYPE_U8, 3, &random);
    slv_gl_texture *made = make(&k, &params);
    CHECK(slv_gl_texture_update(made, &quiet, &update) == SLV_ERROR_ARGUMENT);
    slv_gl_texture_destroy(made);
    params.live = true;
    made = make(&k, &params);
    CHECK(slv_gl_texture_update(made, &env, &update) == SLV_OK);
    CHECK(update.faces == 0 && update.items == 0 && update.bytes == 0);
    slv_gl_texture_destroy(made);
    kit_free(&k);
}

int main(void) {
    slv_env env = test_env();
    uint64_t random = 97;
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    uint32_t cases = test_effort(CASES);
    for (uint32_t i = 0; i < cases; i++)
        check(i, i % 40 < slv_strategy_count(), &random);
    CHECK_MSG(moved > 0 && (renewed > 0 || getenv("SELVAGE_TEST_BLOCKS")),
              "%u items were moved, %u textures made anew", moved, renewed);
    for (uint32_t i = 0; i < 2 * slv_strategy_count(); i++)
        check_stays(slv_strategy_at(i % slv_strategy_count()), i >= slv_strategy_count(), &random);
    check_refused();
    for (uint32_t i = 0; i < test_effort(16); i++)
        check_steps(i, &random);
    slv_gl_destroy(gl);
    return test_end();
}
