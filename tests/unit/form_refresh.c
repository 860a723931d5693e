/* Levels and forms that follow changes of a texture are what would be made of it afresh, bit for
 * bit: any mesh, resolutions, type and number of changes at a time. */
#include "kit/change_kit.h"

#include <selvage/htex.h>
#include <selvage/source.h>

enum { CASES = TEST_SANITIZED ? 20 : 60, MOST_ITEMS = 4096 };

/* A texture's levels and a form of them, kept up to date. */
struct follower {
    const kit *k;
    const slv_form *form;
    bool even; /* levels */
    slv_levels *levels;
    void *made;
    uint64_t seen;
    uint32_t items[MOST_ITEMS], count;
    bool listed[MOST_ITEMS];
    slv_form_change changes[MOST_ITEMS];
    uint32_t nchanges;
    slv_form_room room;
};

static slv_result follow(void *user, uint32_t face, slv_rect rect) {
    struct follower *f = user;
    return slv_levels_update(f->levels, f->k->texture, face, rect);
}

static slv_result list_item(void *user, uint32_t item) {
    struct follower *f = user;
    REQUIRE(item < MOST_ITEMS);
    if (!f->listed[item])
        f->items[f->count++] = item;
    f->listed[item] = true;
    return SLV_OK;
}

static slv_result list_change(void *user, uint32_t face, slv_rect rect) {
    struct follower *f = user;
    REQUIRE(f->nchanges < MOST_ITEMS);
    f->changes[f->nchanges++] = (slv_form_change){face, rect};
    return SLV_OK;
}

static void update(struct follower *f) {
    const slv_texture *texture = f->k->texture;
    f->count = 0;
    memset(f->listed, 0, sizeof f->listed);
    REQUIRE(slv_texture_changed(texture, f->seen, follow, f) == SLV_OK);
    f->nchanges = 0;
    REQUIRE(slv_texture_changed(texture, f->seen, list_change, f) == SLV_OK);
    REQUIRE(f->form->stale(f->made, f->changes, f->nchanges, &f->room, list_item, f) == SLV_OK);
    if (f->form->refresh)
        REQUIRE(f->form->refresh(f->made, f->items, f->count) == SLV_OK);
    f->seen = slv_texture_version(texture);
}

static void compare_levels(const struct follower *f, const slv_levels *fresh) {
    size_t texel = slv_type_size(f->k->type) * f->k->nchannels;
    for (uint32_t face = 0; face < f->k->nfaces; face++)
        for (uint32_t level = 0; level < slv_levels_count(fresh, face); level++)
            CHECK_MSG(memcmp(slv_levels_texels(f->levels, face, level),
                             slv_levels_texels(fresh, face, level),
                             texel * kit_texels(kit_level_res(f->k->res[face], level, f->even))) ==
                          0,
                      "face %u level %u", face, level);
}

/* They may stand elsewhere once faces had other resolutions. */
static void compare_values(const kit *k, const slv_htex *a, const slv_htex *b) {
    for (uint32_t face = 0; face < k->nfaces; face++) {
        slv_htex_face rows[2] = {slv_htex_get_face(a, face), slv_htex_get_face(b, face)};
        for (uint32_t corner = 0; corner < 5; corner++) {
            uint32_t first[2], log2[2], n = k->nchannels;
            slv_htex_get_corner(a, corner < 4 ? rows[0].start[corner] : rows[0].centre, &first[0],
                                &log2[0]);
            slv_htex_get_corner(b, corner < 4 ? rows[1].start[corner] : rows[1].centre, &first[1],
                                &log2[1]);
            CHECK_MSG(log2[0] == log2[1] && memcmp(slv_htex_values(a) + first[0] * n,
                                                   slv_htex_values(b) + first[1] * n,
                                                   (log2[1] + 1) * n * sizeof(float)) == 0,
                      "face %u, corner %u", face, corner);
        }
    }
}

static void compare_forms(const struct follower *f, const void *fresh, uint32_t border) {
    static float scratch[2][64 * 64 * 4];
    for (uint32_t item = 0; item < f->form->count(fresh); item++) {
        slv_res res = f->form->res(fresh, item);
        for (uint32_t level = 0; level < slv_res_level_count(res); level++) {
            slv_form_extent extent = kit_extent(f->form, res, level, border, f->even);
            size_t count = (size_t)extent.width * extent.height * f->k->nchannels;
            slv_form_texels a, b;
            REQUIRE(count <= sizeof scratch[0] / sizeof scratch[0][0]);
            REQUIRE(f->form->read(f->made, item, level, scratch[0], &a) == SLV_OK);
            REQUIRE(f->form->read(fresh, item, level, scratch[1], &b) == SLV_OK);
            CHECK_MSG(memcmp(a.texels, b.texels, count * slv_type_size(a.type)) == 0,
                      "%s: item %u level %u", f->form->name, item, level);
        }
    }
    const slv_htex *squares = slv_form_get_htex(f->form, f->made);
    if (squares) {
        const slv_htex *other = slv_form_get_htex(f->form, fresh);
        compare_values(f->k, squares, other);
    }
}

static void check(const slv_form *form, uint32_t which, bool over, uint64_t *random) {
    static const slv_type types[] = {SLV_TYPE_U8, SLV_TYPE_HALF, SLV_TYPE_FLOAT, SLV_TYPE_U16};
    static struct follower f;
    slv_env env = test_env();
    uint32_t border = 1 + test_random(random) % 8;
    kit k;
    kit_any_mesh(&k, which % KIT_MESHES, random);
    kit_any_resolutions(&k, which / KIT_MESHES % 3, random);
    kit_noise(&k, types[test_random(random) % 4], 1 + which % 4, random);
    f = (struct follower){.k = &k, .form = form, .seen = slv_texture_version(k.texture)};
    f.even = which % 3 == 2 && kit_takes_even(form);
    if (over && !f.even)
        REQUIRE(slv_levels_create_over(&env, k.texture, &f.levels) == SLV_OK);
    else
        f.levels = kit_levels(&k, f.even);
    REQUIRE(form->create(&env, f.levels, k.adjacency, border, &f.made) == SLV_OK);
    for (int round = 0; round < 6; round++) {
        slv_levels *levels = NULL;
        void *fresh = NULL;
        /* now and then more than a texture remembers one by one */
        uint32_t changes = round == 4 ? 400 : test_random(random) % 6;
        for (uint32_t i = 0; i < changes; i++)
            kit_change(&k, test_random(random) % k.nfaces, 1, random);
        for (int i = 0; round % 2 && which % 2 && i < 2; i++)
            kit_resize(&k, test_random(random) % k.nfaces, 5, which % 4 == 1, random);
        update(&f);
        levels = kit_levels(&k, f.even);
        REQUIRE(form->create(&env, levels, k.adjacency, border, &fresh) == SLV_OK);
        compare_levels(&f, levels);
        compare_forms(&f, fresh, border);
        form->destroy(fresh);
        slv_levels_destroy(levels);
    }
    slv_form_room_end(&f.room);
    form->destroy(f.made);
    slv_levels_destroy(f.levels);
    kit_free(&k);
}

/* A face may change its resolution as often as it likes within the memory that it once took. */
static void check_memory(const slv_form *form) {
    enum { CHANGES = TEST_SANITIZED ? 4000 : 16000 };
    static const uint16_t texels[16] = {1, 2, 3, 4};
    static struct follower f;
    uint64_t random = 5;
    slv_env env = test_env();
    kit k;
    kit_cube(&k, &random);
    kit_equal(&k, 0);
    kit_noise(&k, SLV_TYPE_HALF, 1, &random);
    f = (struct follower){.k = &k, .form = form, .seen = slv_texture_version(k.texture)};
    env.max_bytes = 64 << 10;
    REQUIRE(slv_levels_create(&env, k.texture, &f.levels) == SLV_OK);
    REQUIRE(form->create(&env, f.levels, k.adjacency, 1, &f.made) == SLV_OK);
    for (int i = 0; i < CHANGES; i++) {
        slv_res res = i % 2 ? (slv_res){0, 0} : (slv_res){2, 2};
        REQUIRE(slv_texture_set_resolution(k.texture, 0, res, texels) == SLV_OK);
        update(&f);
    }
    slv_form_room_end(&f.room);
    form->destroy(f.made);
    slv_levels_destroy(f.levels);
    kit_free(&k);
}

int main(void) {
    uint64_t random = 47;
    for (uint32_t k = 0; k < slv_form_count(); k++)
        check_memory(slv_form_at(k));
    for (uint32_t i = 0; i < test_effort(CASES); i++)
        for (uint32_t k = 0; k < slv_form_count(); k++)
            check(slv_form_at(k), i, i % 3 > 0, &random);
    return test_end();
}
