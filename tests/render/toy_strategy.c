/* A strategy, and a form, of a stranger's: described here, outside of the library's files, and
 * drawn and looked up with like any other. */
#include "kit/border_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_renderer.h>

static slv_gl *gl;

/* The nearest texel of the own face's level 0, red and blue exchanged. */
static const slv_strategy swapped = {
    .name = "swapped",
    .title = "the nearest texel, red and blue exchanged",
    .form = slv_form_bare,
    .glsl =
        "#include \"lookup/interface.glsl\"\n#include \"lookup/footprint.glsl\"\n"
        "vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {\n"
        "    ivec2 size = textureSize(slv_pool[0], 0).xy;\n"
        "    ivec2 at = clamp(ivec2(uv * vec2(size)), ivec2(0), size - 1);\n"
        "    return slv_value(texelFetch(slv_pool[0], ivec3(at, int(slv_store[face].x >> 16)), 0))"
        ".bgra;\n"
        "}\n",
};

/* A form of one colour a face: that of its level of one texel. */
static slv_result mean_create(const slv_env *env, const slv_levels *levels,
                              const slv_adjacency *adjacency, uint32_t border, void **out) {
    const slv_levels **made = malloc(sizeof *made);
    (void)env;
    (void)adjacency;
    (void)border;
    *out = made;
    if (!made)
        return SLV_ERROR_MEMORY;
    *made = levels;
    return SLV_OK;
}

static uint32_t mean_count(const void *made) {
    return slv_levels_get_desc(*(const slv_levels *const *)made)->nfaces;
}

static slv_res mean_res(const void *made, uint32_t item) {
    (void)made;
    (void)item;
    return (slv_res){0, 0};
}

static uint32_t mean_items(const void *made, uint32_t face, uint32_t out[SLV_FORM_ITEMS]) {
    (void)made;
    out[0] = face;
    return 1;
}

static slv_result mean_read(const void *made, uint32_t item, uint32_t level, float *scratch,
                            slv_form_texels *out) {
    const slv_levels *levels = *(const slv_levels *const *)made;
    (void)level;
    (void)scratch;
    out->texels = slv_levels_texels(levels, item, slv_levels_count(levels, item) - 1);
    out->type = slv_levels_get_desc(levels)->type;
    return SLV_OK;
}

static slv_result mean_stale(const void *made, const slv_form_change *changes, uint32_t count,
                             slv_form_room *room, slv_visit_item visit, void *user) {
    slv_result result = SLV_OK;
    (void)made;
    (void)room;
    for (uint32_t i = 0; !result && i < count; i++)
        if (!i || changes[i].face != changes[i - 1].face)
            result = visit(user, changes[i].face);
    return result;
}

static const slv_form mean_form = {
    .name = "mean",
    .title = "one colour a face",
    .item = "a face",
    .create = mean_create,
    .destroy = free,
    .count = mean_count,
    .res = mean_res,
    .items = mean_items,
    .read = mean_read,
    .stale = mean_stale,
};

static const slv_form *mean(void) {
    return &mean_form;
}

static const slv_strategy flat = {
    .name = "flat",
    .form = mean,
    .glsl =
        "// A comment may come first.\n#include \"lookup/interface.glsl\"\n#include "
        "\"lookup/footprint.glsl\"\n"
        "vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {\n"
        "    return slv_value(texelFetch(slv_pool[0], ivec3(0, 0, int(slv_store[face].x >> 16)),"
        " 0));\n"
        "}\n",
};

static void make_cube(kit *k, uint64_t *random) {
    float positions[24];
    slv_env env = test_env();
    kit_cube(k, random);
    for (int i = 0; i < 24; i++)
        positions[i] = (float)(i / 3 >> i % 3 & 1);
    slv_mesh_view view = {.nverts = k->nverts,
                          .positions = positions,
                          .npolys = k->npolys,
                          .poly_sizes = k->sizes,
                          .poly_verts = k->verts};
    slv_mesh_destroy(k->mesh);
    REQUIRE(slv_mesh_create(&env, &view, &k->mesh) == SLV_OK);
    kit_mixed(k, 3, random);
    kit_noise(k, SLV_TYPE_U8, 3, random);
}

static slv_gl_texture *upload(const kit *k, const slv_strategy *const *strategies, uint32_t count) {
    slv_env env = test_env();
    slv_gl_texture *texture = NULL;
    slv_gl_texture_params params = {.strategies = strategies, .nstrategies = count};
    REQUIRE(slv_gl_texture_create(gl, &env, k->texture, k->adjacency, &params, &texture) == SLV_OK);
    return texture;
}

/* Every texel of every face, looked up at its centre. */
static void check_lookups(const kit *k, slv_gl_texture *texture) {
    slv_env env = test_env();
    for (uint32_t f = 0; f < k->nfaces; f++) {
        slv_res res = k->res[f];
        uint32_t last = slv_levels_count(k->levels, f) - 1;
        const unsigned char *texels = slv_levels_texels(k->levels, f, 0),
                            *one = slv_levels_texels(k->levels, f, last);
        for (uint32_t i = 0; i < kit_texels(res); i++) {
            const int32_t face = (int32_t)f;
            const float zero[2] = {0, 0};
            const float uv[2] = {((float)(i & ((1u << res.u) - 1)) + 0.5f) / (float)(1u << res.u),
                                 ((float)(i >> res.u) + 0.5f) / (float)(1u << res.v)};
            float got[4], even[4];
            REQUIRE(slv_gl_texture_lookup(texture, &env, &swapped, 1, &face, uv, zero, zero, got) ==
                    SLV_OK);
            REQUIRE(slv_gl_texture_lookup(texture, &env, &flat, 1, &face, uv, zero, zero, even) ==
                    SLV_OK);
            for (int c = 0; c < 3; c++) {
                CHECK(fabsf(got[2 - c] * 255 - texels[3 * i + (uint32_t)c]) < 0.01f);
                CHECK(fabsf(even[c] * 255 - one[c]) < 0.01f);
            }
            CHECK(got[3] == 1);
        }
    }
}

static slv_image draw(const kit *k, slv_gl_texture *texture, const slv_strategy *strategy) {
    const float low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
    slv_env env = test_env();
    slv_surface *surface = NULL;
    slv_gl_renderer *renderer = NULL;
    slv_image image = {0};
    slv_frame frame = {.camera = slv_camera_orbit(low, high, 30, 20, 35, 1.5f),
                       .width = 96,
                       .height = 64,
                       .strategy = strategy,
                       .shading = SLV_SHADE_UNLIT,
                       .float_target = true};
    REQUIRE(slv_surface_create(&env, k->mesh, NULL, &surface) == SLV_OK);
    REQUIRE(slv_gl_renderer_create(gl, &env, k->mesh, surface, 4, &renderer) == SLV_OK);
    REQUIRE(slv_gl_renderer_draw(renderer, &env, texture, &frame, &image, NULL) == SLV_OK);
    slv_gl_renderer_destroy(renderer);
    slv_surface_destroy(surface);
    return image;
}

/* With one texel a face all strategies that stay in their face show its colour. */
static void check_pictures(uint64_t *random) {
    kit k;
    uint32_t covered = 0;
    make_cube(&k, random);
    kit_mixed(&k, 0, random);
    kit_noise(&k, SLV_TYPE_U8, 3, random);
    const slv_strategy *const list[] = {&swapped, kit_strategy("clamp"), &flat};
    slv_gl_texture *texture = upload(&k, list, 3);
    slv_image images[3];
    for (int i = 0; i < 3; i++)
        images[i] = draw(&k, texture, i ? list[i] : NULL); /* NULL is the first */
    for (size_t p = 0; p < (size_t)96 * 64; p++) {
        const float *a = images[0].pixels + 4 * p, *b = images[1].pixels + 4 * p;
        covered += b[3] > 0;
        for (int c = 0; c < 3; c++) {
            CHECK(fabsf(a[2 - c] - b[c]) < 1e-3f);
            CHECK(fabsf(images[2].pixels[4 * p + (size_t)c] - b[c]) < 1e-3f);
        }
    }
    CHECK(covered > 500);
    for (int i = 0; i < 3; i++)
        slv_image_free(&images[i]);
    slv_gl_texture_destroy(texture);
    kit_free(&k);
}

static void check_refused(const kit *k) {
    const slv_strategy nothing = {.name = "nothing"},
                       layers = {.name = "layers", .form = slv_form_borders, .glsl = " "},
                       squares = {.name = "squares",
                                  .form = slv_form_bare,
                                  .glsl = " ",
                                  .reach = SLV_GL_REACH_SQUARES},
                       lost = {.name = "lost",
                               .form = slv_form_bare,
                               .glsl = "#include \"lookup/none.glsl\"\n"};
    const slv_strategy *const wrong[] = {NULL, &nothing, &layers, &squares, &lost};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        slv_env env = test_env();
        slv_gl_texture *texture = NULL;
        slv_gl_texture_params params = {.strategies = &wrong[i], .nstrategies = 1};
        CHECK(slv_gl_texture_create(gl, &env, k->texture, k->adjacency, &params, &texture) ==
                  SLV_ERROR_ARGUMENT &&
              !texture);
    }
}

int main(void) {
    slv_env env = test_env();
    uint64_t random = 17;
    kit k;
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    make_cube(&k, &random);
    /* the one listed twice has one place */
    const slv_strategy *const list[] = {&swapped, &flat, kit_strategy("borders"), &swapped};
    slv_gl_texture *texture = upload(&k, list, 4);
    CHECK(slv_gl_texture_strategy_count(texture) == 3);
    CHECK(slv_gl_texture_strategy(texture, 1) == &flat && !slv_gl_texture_strategy(texture, 3));
    CHECK(!slv_strategy_find("swapped"));
    CHECK(slv_gl_texture_get_stats(texture, &flat).gpu_bytes <
          slv_gl_texture_get_stats(texture, &swapped).gpu_bytes);
    check_lookups(&k, texture);
    slv_gl_texture_destroy(texture);
    check_refused(&k);
    kit_free(&k);
    check_pictures(&random);
    slv_gl_destroy(gl);
    return test_end();
}
