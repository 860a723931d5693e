/* Every source that there is passes the suite. */
#include "kit/filter_kit.h"
#include "kit/source_suite.h"

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

static void try_store(slv_type type, uint32_t nchannels, int32_t alpha, uint64_t seed) {
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
    subject.change = change_store;
    subject.user = texture;
    suite_run(&subject);
    slv_source_close(&subject.source);
    slv_source_close(&subject.source);
    slv_texture_destroy(texture);
    kit_free(&k);
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
    slv_texture_desc desc = {1, SLV_TYPE_U8, 1, SLV_NO_ALPHA, &res};
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
    try_store(SLV_TYPE_U8, 3, SLV_NO_ALPHA, 1);
    try_store(SLV_TYPE_U16, 4, 3, 2);
    try_store(SLV_TYPE_HALF, 2, 0, 3);
    try_store(SLV_TYPE_FLOAT, 1, SLV_NO_ALPHA, 4);
    CHECK(each_sample(try_ptx) > 0);
    return test_end();
}
