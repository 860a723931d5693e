/* Every source that there is passes the suite, and one that a stranger wrote. */
#include "kit/source_suite.h"

#define EXAMPLE_WITHOUT_MAIN
#include "../../docs/examples/source.c"

/* A store with faces of every kind: constant ones among others of their value and apart, long ones,
 * and noise. */
static void make_store(kit *k, slv_type type, uint32_t nchannels, uint64_t *random) {
    kit_pentagons(k, random);
    for (uint32_t face = 0; face < k->nfaces; face++) {
        k->res[face].u = (int8_t)(test_random(random) % 7);
        k->res[face].v = (int8_t)(test_random(random) % 7);
    }
    kit_begin_texture(k, type, nchannels);
    for (uint32_t face = 0; face < k->nfaces; face++) {
        size_t count = kit_texels(k->res[face]) * nchannels;
        float *values = malloc(count * sizeof *values);
        bool constant = face < 5 || test_random(random) % 4 == 0;
        REQUIRE(values);
        for (size_t i = 0; i < count; i++)
            values[i] = constant ? 0.25f : (float)(test_random(random) % 1000) / 999.0f;
        kit_set(k, face, values);
        free(values);
    }
    kit_end_texture(k);
}

/* Sets a rectangle of a face to noise or one colour, or all of it. */
static void change_store(void *user, uint64_t *random, uint32_t *face, slv_rect *rect) {
    slv_texture *texture = user;
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    *face = test_random(random) % desc->nfaces;
    bool whole = test_random(random) % 4 == 0, constant = test_random(random) % 2 == 0;
    *rect = whole ? suite_whole(desc->res[*face]) : suite_any_rect(desc->res[*face], random);
    size_t count = (size_t)rect->width * rect->height * desc->nchannels;
    float *values = malloc(count * sizeof *values);
    void *texels = malloc(count * slv_type_size(desc->type));
    REQUIRE(values && texels);
    for (size_t i = 0; i < count; i++)
        values[i] = constant ? 0.25f : (float)(test_random(random) % 1000) / 999.0f;
    slv_type_from_float(desc->type, values, count, texels);
    if (whole && test_random(random) % 2)
        CHECK(slv_texture_set_face(texture, *face, texels) == SLV_OK);
    else
        CHECK(slv_texture_set_rect(texture, *face, *rect, texels) == SLV_OK);
    free(values);
    free(texels);
}

static void try_store(slv_type type, uint32_t nchannels, int32_t alpha, uint64_t seed,
                      bool decoded) {
    slv_env env = suite_env();
    suite_subject subject = {0};
    slv_texture *texture = NULL;
    uint64_t random = seed;
    kit k;
    make_store(&k, type, nchannels, &random);
    slv_texture_desc desc = *slv_texture_get_desc(k.texture);
    desc.alpha_channel = alpha;
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    for (uint32_t face = 0; face < desc.nfaces; face++) {
        const void *texels = slv_texture_texels(k.texture, face);
        if (slv_texture_is_constant(k.texture, face))
            CHECK(slv_texture_set_constant(texture, face, texels) == SLV_OK);
        else
            CHECK(slv_texture_set_face(texture, face, texels) == SLV_OK);
    }
    REQUIRE(slv_texture_as_source(&env, texture, k.adjacency, NULL, &subject.source) == SLV_OK);
    if (decoded) {
        slv_source inner = subject.source;
        REQUIRE(slv_source_decode(&env, &inner, SLV_TEXTURE_AUTO, &subject.source) == SLV_OK);
        CHECK(!inner.fns);
    }
    subject.change = change_store;
    subject.user = texture;
    suite_run(&subject);
    slv_source_close(&subject.source);
    slv_source_close(&subject.source);
    slv_texture_destroy(texture);
    kit_free(&k);
}

/* A file of a cache that has too little room for it. */
static void try_cache(const char *path) {
    slv_env env = suite_env();
    slv_cache_params params = {.max_bytes = UINT64_C(8) << 20};
    slv_cache *cache = NULL;
    slv_ptx *ptx = NULL;
    slv_file_id id = 0;
    suite_subject subject = {0};
    REQUIRE(slv_cache_create(&env, &params, &cache) == SLV_OK);
    REQUIRE(slv_cache_open(cache, path, &id) == SLV_OK);
    REQUIRE(slv_cache_as_source(cache, id, &subject.source) == SLV_OK);
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    subject.stored = ptx;
    suite_run(&subject);
    CHECK(slv_cache_close(cache, id) == SLV_OK);
    suite_refuses(&subject, 0, (slv_res){0, 0}, (slv_rect){0, 0, 1, 1});
    slv_source_close(&subject.source);
    slv_ptx_close(ptx);
    slv_cache_destroy(cache);
}

/* A store behind a cache behind a cache that shows less of it. */
typedef struct layers {
    slv_cache *caches[2];
    slv_file_id ids[2];
    slv_texture *texture;
} layers;

static void change_layers(void *user, uint64_t *random, uint32_t *face, slv_rect *rect) {
    layers *l = user;
    change_store(l->texture, random, face, rect);
    for (int i = 0; i < 2; i++)
        CHECK(slv_cache_refresh(l->caches[i], l->ids[i]) == SLV_OK);
}

static void try_layers(void) {
    const slv_cache_open_params capped = {.max_log2_res = 4};
    slv_env env = suite_env();
    suite_subject subject = {0};
    slv_source sources[2];
    layers l = {0};
    uint64_t random = 12;
    kit k;
    make_store(&k, SLV_TYPE_U16, 3, &random);
    l.texture = k.texture;
    REQUIRE(slv_texture_as_source(&env, k.texture, k.adjacency, NULL, &sources[0]) == SLV_OK);
    for (int i = 0; i < 2; i++) {
        REQUIRE(slv_cache_create(&env, NULL, &l.caches[i]) == SLV_OK);
        REQUIRE(slv_cache_open_source(l.caches[i], &sources[i], i ? NULL : &capped, &l.ids[i]) ==
                SLV_OK);
        REQUIRE(slv_cache_as_source(l.caches[i], l.ids[i], i ? &subject.source : &sources[1]) ==
                SLV_OK);
    }
    subject.change = change_layers;
    subject.user = &l;
    suite_describes(&subject);
    for (uint32_t i = 0; i < k.nfaces; i++) {
        slv_res res = suite_face(&subject, i).res;
        CHECK(res.u == (k.res[i].u < 4 ? k.res[i].u : 4) &&
              res.v == (k.res[i].v < 4 ? k.res[i].v : 4));
    }
    suite_rectangles(&subject);
    suite_arguments(&subject);
    suite_changes(&subject);
    slv_source_close(&subject.source);
    slv_cache_destroy(l.caches[1]);
    slv_cache_destroy(l.caches[0]);
    kit_free(&k);
}

static void change_checkers(void *user, uint64_t *random, uint32_t *face, slv_rect *rect) {
    checkers *c = user;
    (void)random;
    (void)face;
    (void)rect;
    c->time++;
}

static void try_stranger(void) {
    checkers c = {.env = suite_env(), .time = 1};
    suite_subject subject = {.source = {&checkers_fns, &c}, .change = change_checkers, .user = &c};
    suite_run(&subject);
}

static void try_ptx(const char *path) {
    slv_env env = suite_env();
    slv_ptx *ptx = NULL;
    suite_subject subject = {0};
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    REQUIRE(slv_ptx_as_source(&env, ptx, &subject.source) == SLV_OK);
    subject.stored = ptx;
    suite_run(&subject);
    slv_source_close(&subject.source);
    slv_ptx_close(ptx);
}

/* A store that became constant, or ceased to be, rectangle by rectangle, is the same as one that
 * was set at once. */
static void test_rectangles(void) {
    slv_env env = suite_env();
    slv_texture *texture = NULL;
    const slv_res res = {3, 2};
    uint8_t texels[32] = {0}, some[4] = {7, 7, 7, 7};
    slv_texture_desc desc = {1, SLV_TYPE_U8, 1, SLV_NO_ALPHA, &res, SLV_TEXTURE_AUTO};
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    CHECK(slv_texture_set_rect(texture, 0, (slv_rect){2, 1, 2, 2}, some) == SLV_OK);
    CHECK(!slv_texture_is_constant(texture, 0));
    for (int i = 0; i < 4; i++)
        texels[8 * (1 + i / 2) + 2 + i % 2] = 7;
    CHECK(memcmp(slv_texture_texels(texture, 0), texels, 32) == 0);
    memset(some, 0, sizeof some);
    CHECK(slv_texture_set_rect(texture, 0, (slv_rect){2, 1, 2, 2}, some) == SLV_OK);
    CHECK(slv_texture_is_constant(texture, 0));
    atomic_store(&suite_lines, 0);
    CHECK(slv_texture_set_rect(texture, 0, (slv_rect){7, 0, 2, 1}, some) == SLV_ERROR_ARGUMENT);
    CHECK(slv_texture_set_rect(texture, 0, (slv_rect){0, 0, 0, 1}, some) == SLV_ERROR_ARGUMENT);
    CHECK(slv_texture_set_rect(texture, 1, (slv_rect){0, 0, 1, 1}, some) == SLV_ERROR_ARGUMENT);
    CHECK(atomic_load(&suite_lines) == 3);
    slv_texture_destroy(texture);
}

int main(void) {
    test_rectangles();
    try_store(SLV_TYPE_U8, 3, SLV_NO_ALPHA, 1, false);
    try_store(SLV_TYPE_U16, 4, 3, 2, false);
    try_store(SLV_TYPE_HALF, 2, 0, 3, false);
    try_store(SLV_TYPE_FLOAT, 1, SLV_NO_ALPHA, 4, false);
    try_store(SLV_TYPE_U8, 3, SLV_NO_ALPHA, 5, true);
    try_store(SLV_TYPE_U16, 4, 3, 6, true);
    try_store(SLV_TYPE_HALF, 2, 0, 7, true);
    try_layers();
    try_stranger();
    CHECK(each_sample(try_ptx) > 0);
    CHECK(each_sample(try_cache) > 0);
    return test_end();
}
