/* Forms: after a change of some texels every item that has become another is among those that were
 * said to be stale, whatever the mesh, the resolutions and the type; and those are few. */
#include "kit/change_kit.h"

#include <selvage/form.h>

enum { MOST_ITEMS = 4096, CASES = TEST_SANITIZED ? 40 : 150 };

struct stale {
    uint32_t count;
    bool seen[MOST_ITEMS];
};

/* What forms are made of: even levels or not. */
static bool even;

static slv_result visit(void *user, uint32_t item) {
    struct stale *stale = user;
    REQUIRE(item < MOST_ITEMS);
    CHECK_MSG(!stale->seen[item], "item %u is visited twice", item);
    stale->seen[item] = true;
    stale->count++;
    return SLV_OK;
}

/* The levels of the texture with other texels in a rectangle of a face. */
static slv_levels *change(const kit *k, uint32_t face, const slv_rect *rect, uint64_t *random) {
    slv_res res = k->res[face];
    size_t texel = slv_type_size(k->type) * k->nchannels, row = texel << res.u;
    unsigned char *texels = malloc(row << res.v);
    const unsigned char *old = slv_texture_texels(k->texture, face);
    REQUIRE(texels);
    for (size_t i = 0; i < row << res.v; i += texel)
        memcpy(texels + i, slv_texture_is_constant(k->texture, face) ? old : old + i, texel);
    unsigned char *before = malloc(row << res.v);
    REQUIRE(before);
    memcpy(before, texels, row << res.v);
    for (uint32_t y = rect->y; y < rect->y + rect->height; y++) {
        for (uint32_t i = 0; i < rect->width * k->nchannels; i++) {
            float value = (float)(test_random(random) % 1000) / 999;
            slv_type_from_float(k->type, &value, 1,
                                texels + y * row + rect->x * texel + i * slv_type_size(k->type));
        }
    }
    REQUIRE(slv_texture_set_face(k->texture, face, texels) == SLV_OK);
    slv_levels *levels = kit_levels(k, even);
    REQUIRE(slv_texture_set_face(k->texture, face, before) == SLV_OK);
    free(texels);
    free(before);
    return levels;
}

static bool same_item(const kit *k, const slv_form *form, const void *a, const void *b,
                      uint32_t item, uint32_t border) {
    static float scratch[2][64 * 64 * 4];
    slv_res res = form->res(a, item);
    for (uint32_t level = 0; level < slv_res_level_count(res); level++) {
        slv_form_extent extent = kit_extent(form, res, level, border, even);
        size_t count = (size_t)extent.width * extent.height * k->nchannels;
        slv_form_texels texels[2];
        REQUIRE(count <= sizeof scratch[0] / sizeof scratch[0][0]);
        REQUIRE(form->read(a, item, level, scratch[0], &texels[0]) == SLV_OK);
        REQUIRE(form->read(b, item, level, scratch[1], &texels[1]) == SLV_OK);
        CHECK(texels[0].type == texels[1].type);
        if (memcmp(texels[0].texels, texels[1].texels, count * slv_type_size(texels[0].type)))
            return false;
    }
    return true;
}

/* One change of one face; returns how many items were stale. */
static uint32_t check_change(const kit *k, const slv_form *form, const void *made, uint32_t border,
                             uint32_t face, const slv_rect *rect, uint64_t *random) {
    slv_env env = test_env();
    slv_levels *levels = change(k, face, rect, random);
    struct stale stale = {0};
    slv_form_room room = {0};
    void *after = NULL;
    uint32_t changed = 0;
    REQUIRE(form->stale(made, &(slv_form_change){face, *rect}, 1, &room, visit, &stale) == SLV_OK);
    slv_form_room_end(&room);
    REQUIRE(form->create(&env, levels, k->adjacency, border, &after) == SLV_OK);
    for (uint32_t item = 0; item < form->count(made); item++) {
        bool same = same_item(k, form, made, after, item, border);
        changed += !same;
        CHECK_MSG(same || stale.seen[item],
                  "%s: item %u changes with %u,%u %u x %u of face %u, which is not said",
                  form->name, item, rect->x, rect->y, rect->width, rect->height, face);
    }
    CHECK(changed <= stale.count);
    form->destroy(after);
    slv_levels_destroy(levels);
    return stale.count;
}

static void check_random(const slv_form *form) {
    static const slv_type types[] = {SLV_TYPE_U8, SLV_TYPE_HALF, SLV_TYPE_FLOAT, SLV_TYPE_U16};
    uint64_t random = 71;
    for (uint32_t i = 0; i < CASES; i++) {
        kit k;
        void *made = NULL;
        slv_env env = test_env();
        uint32_t border = 1 + test_random(&random) % 8;
        kit_any_mesh(&k, i % 10, &random);
        kit_any_resolutions(&k, i / 10 % 3, &random);
        kit_noise(&k, types[i / 30 % 4], 1 + i % 3, &random);
        even = i % 4 == 3 && kit_takes_even(form);
        slv_levels *levels = kit_levels(&k, even);
        REQUIRE(form->create(&env, levels, k.adjacency, border, &made) == SLV_OK);
        for (int n = 0; n < 4; n++) {
            uint32_t face = test_random(&random) % k.nfaces;
            slv_rect rect = kit_rect(k.res[face], &random);
            check_change(&k, form, made, border, face, &rect, &random);
        }
        form->destroy(made);
        slv_levels_destroy(levels);
        kit_free(&k);
    }
    even = false;
}

/* On a mesh of 240 faces and more only those around the changed one are stale. */
static void check_local(const slv_form *form) {
    uint64_t random = 9;
    for (uint32_t which = 0; which < 4; which++) {
        kit k;
        void *made = NULL;
        slv_env env = test_env();
        uint32_t most = 0;
        kit_grid(&k, 15, 16, true, which == 3 ? 3 : 0, &random, NULL);
        kit_any_resolutions(&k, which % 3, &random);
        kit_noise(&k, SLV_TYPE_U8, 3, &random);
        REQUIRE(form->create(&env, k.levels, k.adjacency, 4, &made) == SLV_OK);
        for (int n = 0; n < 24; n++) {
            uint32_t face = test_random(&random) % k.nfaces;
            slv_rect rect = kit_rect(k.res[face], &random);
            uint32_t count = check_change(&k, form, made, 4, face, &rect, &random);
            most = count > most ? count : most;
        }
        fprintf(stderr, "%s, mesh %u: %u of %u items stale at most\n", form->name, which, most,
                form->count(made));
        CHECK_MSG(most * 3 <= form->count(made), "%s, mesh %u: %u of %u items are stale",
                  form->name, which, most, form->count(made));
        if (which == 0)
            CHECK_MSG(most <= 24, "%s: %u items are stale where nine faces meet", form->name, most);
        form->destroy(made);
        kit_free(&k);
    }
}

/* A texel in the middle of a face belongs to no square but that face's. */
static void check_inside(void) {
    const slv_form *form = slv_form_find("htex");
    const slv_rect middle = {7, 3, 2, 1}, corner = {0, 0, 1, 1};
    uint64_t random = 5;
    kit k;
    void *made = NULL;
    slv_env env = test_env();
    REQUIRE(form);
    kit_grid(&k, 8, 8, true, 0, &random, NULL);
    kit_equal(&k, 4);
    kit_noise(&k, SLV_TYPE_U8, 3, &random);
    REQUIRE(form->create(&env, k.levels, k.adjacency, 0, &made) == SLV_OK);
    CHECK(check_change(&k, form, made, 0, 9, &middle, &random) == 1);
    CHECK(check_change(&k, form, made, 0, 9, &corner, &random) > 4);
    form->destroy(made);
    kit_free(&k);
}

static void check_refused(const slv_form *form) {
    static const slv_rect wrong[] = {{0, 0, 0, 1},  {0, 0, 1, 0},  {16, 0, 1, 1},
                                     {0, 15, 1, 2}, {1, 0, 16, 1}, {1, 1, UINT32_MAX, 1}};
    uint64_t random = 3;
    slv_form_room room = {0};
    kit k;
    void *made = NULL;
    slv_env env = test_env();
    kit_cube(&k, &random);
    kit_equal(&k, 4);
    kit_noise(&k, SLV_TYPE_U8, 1, &random);
    REQUIRE(form->create(&env, k.levels, k.adjacency, 1, &made) == SLV_OK);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct stale stale = {0};
        const slv_form_change change = {0, wrong[i]};
        CHECK(form->stale(made, &change, 1, &room, visit, &stale) == SLV_ERROR_ARGUMENT);
        CHECK(stale.count == 0);
    }
    const slv_form_change missing = {6, {0, 0, 1, 1}};
    CHECK(form->stale(made, &missing, 1, &room, visit, NULL) == SLV_ERROR_ARGUMENT);
    slv_form_room_end(&room);
    form->destroy(made);
    form->destroy(NULL);
    kit_free(&k);
}

int main(void) {
    CHECK(slv_form_count() >= 4 && !slv_form_at(slv_form_count()) && !slv_form_find("none"));
    for (uint32_t i = 0; i < slv_form_count(); i++) {
        const slv_form *form = slv_form_at(i);
        CHECK(slv_form_find(form->name) == form);
        check_random(form);
        check_local(form);
        check_refused(form);
    }
    check_inside();
    return test_end();
}
