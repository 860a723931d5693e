/* The store, its types, and its chains of levels. */
#include "kit/test.h"

#include "base/parallel.h"

#include <selvage/half.h>
#include <selvage/source.h>
#include <selvage/texture.h>

static void test_types(void) {
    static uint16_t every[65536], back16[65536];
    static float values[65536];
    uint8_t bytes[256], back8[256];
    for (int i = 0; i < 256; i++)
        bytes[i] = (uint8_t)i;
    for (int i = 0; i < 65536; i++)
        every[i] = (uint16_t)i;
    slv_type_to_float(SLV_TYPE_U8, bytes, 256, values);
    CHECK(values[0] == 0.0f && values[255] == 1.0f && values[51] == 0.2f);
    slv_type_from_float(SLV_TYPE_U8, values, 256, back8);
    CHECK(!memcmp(bytes, back8, sizeof bytes));
    slv_type_to_float(SLV_TYPE_U16, every, 65536, values);
    CHECK(values[65535] == 1.0f);
    slv_type_from_float(SLV_TYPE_U16, values, 65536, back16);
    CHECK(!memcmp(every, back16, sizeof every));
    slv_type_to_float(SLV_TYPE_HALF, every, 65536, values);
    for (int i = 0; i < 65536; i++) {
        float expected = slv_half_to_float((uint16_t)i);
        CHECK_MSG(!memcmp(&expected, &values[i], sizeof expected), "half %04x", (unsigned)i);
    }

    const float odd[8] = {NAN, -INFINITY, INFINITY, -0.5f, 1.5f, 0.5f, 0.498f, 1e30f};
    const uint8_t odd8[8] = {0, 0, 255, 0, 255, 128, 127, 255};
    const uint16_t odd16[8] = {0, 0, 65535, 0, 65535, 32768, 32636, 65535};
    slv_type_from_float(SLV_TYPE_U8, odd, 8, back8);
    slv_type_from_float(SLV_TYPE_U16, odd, 8, back16);
    CHECK(!memcmp(back8, odd8, sizeof odd8));
    CHECK(!memcmp(back16, odd16, sizeof odd16));
    slv_type_from_float(SLV_TYPE_HALF, odd + 3, 3, back16);
    CHECK(back16[0] == 0xb800 && back16[1] == 0x3e00 && back16[2] == 0x3800);

    CHECK(slv_type_size(SLV_TYPE_U8) == 1 && slv_type_size(SLV_TYPE_U16) == 2);
    CHECK(slv_type_size(SLV_TYPE_HALF) == 2 && slv_type_size(SLV_TYPE_FLOAT) == 4);
    CHECK(!strcmp(slv_type_name(SLV_TYPE_U8), "uint8") &&
          !strcmp(slv_type_name(SLV_TYPE_HALF), "half"));
}

/* Many at once become what each becomes by itself, whatever lies beside it. */
static void halves_at_once(void) {
    enum { MANY = 300 };
    float values[MANY];
    uint16_t halves[MANY];
    uint64_t random = 17;
    for (int round = 0; round < 400; round++) {
        uint32_t count = 1 + test_random(&random) % MANY;
        for (uint32_t i = 0; i < count; i++) {
            uint32_t bits = test_random(&random) << 16 | test_random(&random) % 65536;
            const uint32_t most = 0x38800000u + bits % 0xeff0000u,
                           ends[] = {0x38800000u, 0x477ff000u};
            if (round % 4) /* as large as most are, or nearly so, or zero */
                bits = (bits & 0x80000000u) |
                       (round % 4 == 1 ? most : ends[bits % 2] - 8 + bits / 2 % (round % 4 * 4));
            if (test_random(&random) % 8 == 0)
                bits &= 0x80000000u;
            memcpy(&values[i], &bits, sizeof bits);
        }
        slv_type_from_float(SLV_TYPE_HALF, values, count, halves);
        for (uint32_t i = 0; i < count; i++)
            CHECK(halves[i] == slv_half_from_float(values[i]));
    }
}

static void test_resolutions(void) {
    slv_res res = {5, 2};
    CHECK(slv_res_level_count(res) == 6);
    slv_res one = slv_res_level(res, 3), last = slv_res_level(res, 5),
            past = slv_res_level(res, 40);
    CHECK(one.u == 2 && one.v == 0);
    CHECK(last.u == 0 && last.v == 0 && past.u == 0 && past.v == 0);
    const slv_res even[7] = {{5, 2}, {4, 2}, {3, 2}, {2, 2}, {1, 1}, {0, 0}, {0, 0}};
    for (uint32_t level = 0; level < 7; level++) {
        slv_res lying = slv_res_even_level(res, level),
                standing = slv_res_even_level((slv_res){2, 5}, level);
        CHECK(lying.u == even[level].u && lying.v == even[level].v);
        CHECK(standing.u == even[level].v && standing.v == even[level].u);
    }
}

static void test_store(void) {
    slv_env env = test_env();
    slv_res res[3] = {{2, 1}, {0, 0}, {1, 3}};
    slv_texture_desc desc = {3, SLV_TYPE_U16, 2, 1, res, SLV_TEXTURE_AUTO};
    slv_texture *texture = NULL;
    slv_result result = slv_texture_create(&env, &desc, &texture);
    REQUIRE(result == SLV_OK);
    res[0].u = 7; /* the texture has a copy */
    CHECK(slv_texture_get_desc(texture)->res[0].u == 2);
    CHECK(slv_texture_get_desc(texture)->alpha_channel == 1);
    CHECK(slv_texture_bytes(texture) == (8 + 1 + 16) * 4);

    float texel[2];
    CHECK(slv_texture_is_constant(texture, 0));
    slv_texture_fetch(texture, 0, 3, 1, texel);
    CHECK(texel[0] == 0.0f && texel[1] == 0.0f);

    uint16_t texels[16];
    for (int i = 0; i < 16; i++)
        texels[i] = (uint16_t)(i * 1000);
    CHECK(slv_texture_set_face(texture, 0, texels) == SLV_OK);
    CHECK(!slv_texture_is_constant(texture, 0));
    CHECK(!memcmp(slv_texture_texels(texture, 0), texels, sizeof texels));
    slv_texture_fetch(texture, 0, 3, 1, texel);
    CHECK(texel[0] == 14000.0f / 65535.0f && texel[1] == 15000.0f / 65535.0f);

    /* Only the last texel differs: not constant. All the same: constant. */
    for (int i = 0; i < 16; i++)
        texels[i] = (uint16_t)(i % 2 ? 5 : 9);
    texels[15] = 6;
    CHECK(slv_texture_set_face(texture, 0, texels) == SLV_OK &&
          !slv_texture_is_constant(texture, 0));
    texels[15] = 5;
    CHECK(slv_texture_set_face(texture, 0, texels) == SLV_OK &&
          slv_texture_is_constant(texture, 0));
    CHECK(slv_texture_get_desc(texture)->res[0].u == 2);
    slv_texture_fetch(texture, 0, 1, 1, texel);
    CHECK(texel[0] == 9.0f / 65535.0f);
    CHECK(slv_texture_set_face(texture, 1, texels) == SLV_OK &&
          slv_texture_is_constant(texture, 1));
    CHECK(slv_texture_set_constant(texture, 2, texels + 2) == SLV_OK);

    CHECK(slv_texture_set_face(texture, 3, texels) == SLV_ERROR_ARGUMENT);
    CHECK(strstr(test_last_log, "face 3"));
    CHECK(slv_texture_set_face(texture, 0, NULL) == SLV_ERROR_ARGUMENT);
    slv_texture_destroy(texture);
    slv_texture_destroy(NULL);
}

static void expect_refused(slv_texture_desc desc, slv_result expected) {
    slv_env env = test_env();
    slv_texture *texture = NULL;
    test_last_log[0] = 0;
    slv_result result = slv_texture_create(&env, &desc, &texture);
    CHECK(result == expected && !texture && test_last_log[0]);
}

static void test_refusals(void) {
    slv_res good = {1, 1}, big = {17, 0}, negative = {0, -1};
    expect_refused((slv_texture_desc){1, SLV_TYPE_U8, 0, SLV_NO_ALPHA, &good, SLV_TEXTURE_AUTO},
                   SLV_ERROR_ARGUMENT);
    expect_refused(
        (slv_texture_desc){1, SLV_TYPE_U8, 100000, SLV_NO_ALPHA, &good, SLV_TEXTURE_AUTO},
        SLV_ERROR_ARGUMENT);
    expect_refused((slv_texture_desc){1, (slv_type)7, 1, SLV_NO_ALPHA, &good, SLV_TEXTURE_AUTO},
                   SLV_ERROR_ARGUMENT);
    expect_refused((slv_texture_desc){1, SLV_TYPE_U8, 3, 3, &good, SLV_TEXTURE_AUTO},
                   SLV_ERROR_ARGUMENT);
    expect_refused((slv_texture_desc){1, SLV_TYPE_U8, 3, SLV_NO_ALPHA, &big, SLV_TEXTURE_AUTO},
                   SLV_ERROR_ARGUMENT);
    expect_refused((slv_texture_desc){1, SLV_TYPE_U8, 3, SLV_NO_ALPHA, &negative, SLV_TEXTURE_AUTO},
                   SLV_ERROR_ARGUMENT);
    expect_refused((slv_texture_desc){1, SLV_TYPE_U8, 3, SLV_NO_ALPHA, NULL, SLV_TEXTURE_AUTO},
                   SLV_ERROR_ARGUMENT);

    /* A constant face is cheap however large it claims to be; its levels are not. */
    slv_env env = test_env();
    env.max_bytes = 1 << 20;
    slv_res huge[2] = {{16, 16}, {10, 10}};
    slv_texture_desc desc = {2, SLV_TYPE_FLOAT, 4, SLV_NO_ALPHA, huge, SLV_TEXTURE_AUTO};
    slv_texture *texture = NULL;
    slv_levels *levels = NULL;
    slv_result result = slv_texture_create(&env, &desc, &texture);
    REQUIRE(result == SLV_OK);
    CHECK(slv_levels_create(&env, texture, &levels) == SLV_ERROR_LIMIT && !levels);
    float *texels = calloc((size_t)4 << 20, sizeof *texels);
    REQUIRE(texels);
    texels[0] = 1;
    CHECK(slv_texture_set_face(texture, 1, texels) == SLV_ERROR_LIMIT);
    CHECK(slv_texture_is_constant(texture, 1));
    free(texels);
    slv_texture_destroy(texture);

    desc.nfaces = 0;
    desc.res = NULL;
    result = slv_texture_create(NULL, &desc, &texture);
    REQUIRE(result == SLV_OK);
    CHECK(slv_levels_create(NULL, texture, &levels) == SLV_OK);
    slv_levels_destroy(levels);
    slv_texture_destroy(texture);
    slv_levels_destroy(NULL);
}

/* A value of a level as a number in the type's own units. */
static double unit(slv_type type, const void *texels, size_t index) {
    float value;
    slv_type_to_float(type, (const char *)texels + index * slv_type_size(type), 1, &value);
    double one = type == SLV_TYPE_U8 ? 255 : type == SLV_TYPE_U16 ? 65535 : 0;
    return one > 0 ? round((double)value * one) : (double)value;
}

static slv_res level_res(slv_res res, uint32_t level, bool even) {
    return even ? slv_res_even_level(res, level) : slv_res_level(res, level);
}

static void check_chain(const slv_levels *levels, uint32_t face, bool even) {
    const slv_texture_desc *desc = slv_levels_get_desc(levels);
    slv_res res = desc->res[face];
    bool integers = desc->type == SLV_TYPE_U8 || desc->type == SLV_TYPE_U16;
    size_t nch = desc->nchannels;
    CHECK(slv_levels_count(levels, face) == slv_res_level_count(res));
    for (uint32_t level = 1; level < slv_levels_count(levels, face); level++) {
        slv_res above = level_res(res, level - 1, even), here = level_res(res, level, even);
        const void *from = slv_levels_texels(levels, face, level - 1);
        const void *to = slv_levels_texels(levels, face, level);
        size_t sx = above.u > here.u, sy = above.v > here.v;
        for (size_t y = 0; y < (size_t)1 << here.v; y++) {
            for (size_t x = 0; x < (size_t)1 << here.u; x++) {
                for (size_t c = 0; c < nch; c++) {
                    double sum = 0;
                    for (size_t i = 0; i < 4; i++) {
                        size_t ax = (x << sx) + (i & sx), ay = (y << sy) + (i / 2 & sy);
                        sum += unit(desc->type, from, ((ay << above.u) + ax) * nch + c);
                    }
                    double mean = sum / 4,
                           got = unit(desc->type, to, ((y << here.u) + x) * nch + c);
                    double slack = integers ? 0 : desc->type == SLV_TYPE_HALF ? 6e-4 : 1e-6;
                    if (integers)
                        mean = floor(mean + 0.5);
                    CHECK_MSG(fabs(got - mean) <= slack, "face %u level %u: %g, expected %g", face,
                              level, got, mean);
                }
            }
        }
    }
}

struct setter {
    slv_texture *texture;
};

/* Fills a face from its number alone. */
static slv_result set_faces(void *user, uint64_t first, uint64_t end) {
    struct setter *setter = user;
    const slv_texture_desc *desc = slv_texture_get_desc(setter->texture);
    for (uint32_t face = (uint32_t)first; face < end; face++) {
        uint64_t random = face;
        size_t count = (size_t)desc->nchannels << (desc->res[face].u + desc->res[face].v);
        float *values = malloc(count * sizeof *values);
        void *texels = malloc(count * 4);
        for (size_t i = 0; values && i < count; i++)
            values[i] = face % 7 == 3 ? 0.25f : (float)(test_random(&random) % 1000) / 999.0f;
        if (values && texels)
            slv_type_from_float(desc->type, values, count, texels);
        slv_result result = values && texels ? slv_texture_set_face(setter->texture, face, texels)
                                             : SLV_ERROR_MEMORY;
        free(values);
        free(texels);
        if (result)
            return result;
    }
    return SLV_OK;
}

/* The same levels from a texture that stays: level 0 is its own. */
static void check_over(const slv_texture *texture, const slv_levels *expected) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    slv_env env = test_env();
    slv_levels *over = NULL;
    REQUIRE(slv_levels_create_over(&env, texture, &over) == SLV_OK);
    for (uint32_t face = 0; face < desc->nfaces; face++) {
        bool constant = slv_texture_is_constant(texture, face);
        CHECK((slv_levels_texels(over, face, 0) == slv_texture_texels(texture, face)) == !constant);
        for (uint32_t level = 0; level < slv_levels_count(expected, face); level++) {
            slv_res at = slv_res_level(desc->res[face], level);
            size_t size = (slv_type_size(desc->type) * desc->nchannels) << (at.u + at.v);
            CHECK(!memcmp(slv_levels_texels(over, face, level),
                          slv_levels_texels(expected, face, level), size));
        }
    }
    slv_levels_destroy(over);
}

/* Even levels, also after changes of some texels. */
static void check_even(slv_texture *texture) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    size_t texel = slv_type_size(desc->type) * desc->nchannels;
    unsigned char *zeroes = calloc(1024, texel);
    slv_env env = test_env();
    slv_levels *even = NULL;
    REQUIRE(zeroes && slv_levels_create_even(&env, texture, &even) == SLV_OK);
    for (uint32_t face = 0; face < desc->nfaces; face++) {
        slv_res res = desc->res[face];
        slv_rect rect = {1u << res.u >> 1, 1u << res.v >> 2, 1, 1u << res.v >> (res.v > 1)};
        check_chain(even, face, true);
        CHECK(slv_texture_set_rect(texture, face, rect, zeroes) == SLV_OK);
        CHECK(slv_levels_update(even, texture, face, rect) == SLV_OK);
        check_chain(even, face, true);
    }
    slv_levels_destroy(even);
    free(zeroes);
}

static void test_levels(slv_type type, uint32_t nchannels) {
    enum { FACES = 60 };
    slv_res res[FACES];
    slv_levels *levels[2] = {NULL, NULL};
    uint64_t random = 5;
    for (int i = 0; i < FACES; i++)
        res[i] = (slv_res){(int8_t)(test_random(&random) % 6), (int8_t)(test_random(&random) % 6)};
    slv_texture_desc desc = {FACES, type, nchannels, SLV_NO_ALPHA, res, SLV_TEXTURE_AUTO};
    for (int i = 0; i < 2; i++) {
        slv_env env = test_env();
        env.threads = i ? 4 : 1;
        slv_texture *texture = NULL;
        slv_result result = slv_texture_create(&env, &desc, &texture);
        REQUIRE(result == SLV_OK);
        struct setter setter = {texture};
        CHECK(slvi_parallel_for(&env, FACES, 3, set_faces, &setter) == SLV_OK);
        result = slv_levels_create(&env, texture, &levels[i]);
        REQUIRE(result == SLV_OK);
        check_over(texture, levels[i]);
        check_even(texture);
        slv_texture_destroy(texture);
    }
    for (uint32_t face = 0; face < FACES; face++) {
        check_chain(levels[0], face, false);
        for (uint32_t level = 0; level < slv_levels_count(levels[0], face); level++) {
            slv_res at = slv_res_level(res[face], level);
            size_t size = (slv_type_size(type) * nchannels) << (at.u + at.v);
            CHECK(!memcmp(slv_levels_texels(levels[0], face, level),
                          slv_levels_texels(levels[1], face, level), size));
        }
    }
    slv_levels_destroy(levels[0]);
    slv_levels_destroy(levels[1]);
}

struct random_fill {
    const uint16_t *texels;
    slv_rect rect;
};

static void put_texels(void *user, void *texels, size_t pitch) {
    const struct random_fill *fill = user;
    for (uint32_t i = 0; i < fill->rect.width * fill->rect.height; i++)
        memcpy((uint16_t *)texels + 2 * (i / fill->rect.width * pitch + i % fill->rect.width),
               fill->texels + 2 * (size_t)i, 4);
}

/* Rectangles that are filled in place are those that are set, constant faces and all. */
static void test_filling(void) {
    static uint16_t texels[2 * 64];
    slv_env env = test_env();
    slv_res res[2] = {{3, 3}, {1, 2}};
    slv_texture_desc desc = {2, SLV_TYPE_U16, 2, 1, res, SLV_TEXTURE_AUTO};
    slv_texture *set = NULL, *filled = NULL;
    uint64_t random = 3;
    uint32_t constant = 0;
    REQUIRE(slv_texture_create(&env, &desc, &set) == SLV_OK);
    REQUIRE(slv_texture_create(&env, &desc, &filled) == SLV_OK);
    for (int n = 0; n < 2000; n++) {
        uint32_t face = test_random(&random) % 2, few = 1 + test_random(&random) % 2;
        slv_rect rect = {test_random(&random) & ((1u << res[face].u) - 1),
                         test_random(&random) & ((1u << res[face].v) - 1), 0, 0};
        rect.width = 1 + test_random(&random) % ((1u << res[face].u) - rect.x);
        rect.height = 1 + test_random(&random) % ((1u << res[face].v) - rect.y);
        if (test_random(&random) % 4 == 0)
            rect = (slv_rect){0, 0, 1u << res[face].u, 1u << res[face].v};
        for (uint32_t i = 0; i < 2 * rect.width * rect.height; i++)
            texels[i] = (uint16_t)(test_random(&random) % few);
        struct random_fill fill = {texels, rect};
        REQUIRE(slv_texture_set_rect(set, face, rect, texels) == SLV_OK);
        REQUIRE(slv_texture_fill_rect(filled, face, rect, put_texels, &fill) == SLV_OK);
        bool is = slv_texture_is_constant(set, face);
        constant += is;
        CHECK(slv_texture_is_constant(filled, face) == is);
        CHECK(memcmp(slv_texture_texels(set, face), slv_texture_texels(filled, face),
                     is ? 4 : (size_t)4 << (res[face].u + res[face].v)) == 0);
    }
    CHECK(constant > 100 && constant < 1900);
    CHECK(slv_texture_version(set) == slv_texture_version(filled));
    CHECK(slv_texture_fill_rect(filled, 1, (slv_rect){1, 0, 2, 1}, put_texels, NULL) ==
          SLV_ERROR_ARGUMENT);
    CHECK(slv_texture_fill_rect(filled, 2, (slv_rect){0, 0, 1, 1}, put_texels, NULL) ==
          SLV_ERROR_ARGUMENT);
    slv_texture_destroy(set);
    slv_texture_destroy(filled);
}

int main(void) {
    test_types();
    halves_at_once();
    test_resolutions();
    test_store();
    test_filling();
    test_refusals();
    for (int type = 0; type < 4; type++) {
        test_levels((slv_type)type, 1);
        test_levels((slv_type)type, 3);
    }
    return test_end();
}
