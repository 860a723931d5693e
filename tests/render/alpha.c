/* Alpha in drawing: stacks of quads blend in the right order whatever order they are drawn in,
 * masks cut at one half, with multisampling too; colours under no paint never show; grey with alpha
 * is as four channels are; and the ray-cast reference composes the same picture. */
#include "gl/context/api.h"
#include "kit/seam_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_renderer.h>
#include <selvage/reference.h>

enum { SIDE = 24, LAYERS = 12, LEAST_ROW = 32 * SIDE * LAYERS };

static slv_gl *gl;
static uint64_t lists_most; /* bytes that lists of fragments may take; 0: the driver's limit */

/* Quads that lie one behind the other, at depths in no order, seen from the front. */
typedef struct stack {
    kit k;
    slv_surface *surface;
    slv_camera camera;
    int order[LAYERS]; /* faces from the nearest to the furthest */
} stack;

static void make_stack(stack *s) {
    static float positions[12 * LAYERS];
    slv_env env = test_env();
    memset(s, 0, sizeof *s);
    for (int i = 0; i < LAYERS; i++) {
        int rank = i * 5 % LAYERS;
        const int32_t quad[4] = {4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3};
        kit_poly(&s->k, 4, quad, 0);
        s->order[rank] = i;
        for (int c = 0; c < 4; c++) {
            positions[12 * i + 3 * c] = c == 1 || c == 2 ? 1.0f : -1.0f;
            positions[12 * i + 3 * c + 1] = c > 1 ? 1.0f : -1.0f;
            positions[12 * i + 3 * c + 2] = -1 - 0.25f * (float)rank;
        }
    }
    kit_finish(&s->k);
    slv_mesh_destroy(s->k.mesh);
    slv_mesh_view view = {.nverts = 4 * LAYERS,
                          .positions = positions,
                          .npolys = LAYERS,
                          .poly_sizes = s->k.sizes,
                          .poly_verts = s->k.verts};
    REQUIRE(slv_mesh_create(&env, &view, &s->k.mesh) == SLV_OK);
    const slv_surface_params flat = {.scheme = SLV_SCHEME_BILINEAR};
    REQUIRE(slv_surface_create(&env, s->k.mesh, &flat, &s->surface) == SLV_OK);
    s->camera = (slv_camera){.world_to_camera = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                             .window = {-0.9f, 0.9f, -0.9f, 0.9f}};
}

static void free_stack(stack *s) {
    slv_surface_destroy(s->surface);
    kit_free(&s->k);
}

/* Each layer has one colour, multiplied by its alpha. */
static void color_stack(stack *s, float rgba[LAYERS][4], float least, float most) {
    uint64_t random = 5;
    kit_equal(&s->k, 0);
    kit_begin_texture(&s->k, SLV_TYPE_FLOAT, 4);
    for (int i = 0; i < LAYERS; i++) {
        rgba[i][3] = least + (most - least) * (float)(test_random(&random) % 1000) / 1000;
        for (int c = 0; c < 3; c++)
            rgba[i][c] = rgba[i][3] * (float)(test_random(&random) % 1000) / 1000;
        kit_set(&s->k, (uint32_t)i, rgba[i]);
    }
}

static slv_image draw(const stack *s, const slv_strategy *strategy, uint32_t msaa,
                      slv_alpha_mode alpha, const float background[4]) {
    slv_env env = test_env();
    slv_gl_renderer *renderer = NULL;
    slv_image image = {0};
    slv_gl_texture *texture =
        seam_upload(gl, &s->k, (slv_gl_texture_params){.strategies = &strategy, .nstrategies = 1});
    slv_frame frame = {.camera = s->camera,
                       .width = SIDE,
                       .height = SIDE,
                       .msaa = msaa,
                       .shading = SLV_SHADE_UNLIT,
                       .float_target = true,
                       .alpha = alpha};
    memcpy(frame.background, background, sizeof frame.background);
    REQUIRE(slv_gl_renderer_create(gl, &env, s->k.mesh, s->surface, 2, &renderer) == SLV_OK);
    const uint64_t most = gl->max_storage;
    gl->max_storage = lists_most ? lists_most : most;
    slv_result result = slv_gl_renderer_draw(renderer, &env, texture, &frame, &image, NULL);
    gl->max_storage = most;
    CHECK_MSG(result == (lists_most && lists_most < LEAST_ROW ? SLV_ERROR_LIMIT : SLV_OK), "%d",
              result);
    slv_gl_renderer_destroy(renderer);
    slv_gl_texture_destroy(texture);
    return image;
}

static void cast_rays(const stack *s, slv_alpha_mode alpha, const float background[4],
                      slv_image *out) {
    slv_env env = test_env();
    slv_reference *reference = NULL;
    slv_reference_frame frame = {.camera = s->camera,
                                 .width = SIDE,
                                 .height = SIDE,
                                 .shading = SLV_SHADE_UNLIT,
                                 .samples = 4};
    memcpy(frame.background, background, sizeof frame.background);
    REQUIRE(slv_reference_create(&env, s->k.mesh, s->surface, s->k.texture, s->k.adjacency,
                                 &(slv_reference_params){.segments = 2, .alpha = alpha},
                                 &reference) == SLV_OK);
    REQUIRE(slv_reference_render(reference, &env, &frame, out, NULL, NULL) == SLV_OK);
    slv_reference_destroy(reference);
}

static void check_all(const slv_image *image, const float expected[4], const char *what) {
    for (size_t i = 0; i < (size_t)SIDE * SIDE * 4; i++)
        CHECK_MSG(fabsf(image->pixels[i] - expected[i % 4]) < 1e-4f,
                  "%s: channel %zu of pixel %zu is %g and not %g", what, i % 4, i / 4,
                  (double)image->pixels[i], (double)expected[i % 4]);
}

/* More layers than there is room for at first. */
static void check_stack(void) {
    static const float background[4] = {0.1f, 0.2f, 0.15f, 0.5f};
    float rgba[LAYERS][4], expected[4];
    stack s;
    slv_image image = {0};
    make_stack(&s);
    color_stack(&s, rgba, 0, 0.3f);
    memcpy(expected, background, sizeof expected);
    for (int rank = LAYERS - 1; rank >= 0; rank--)
        for (int c = 0; c < 4; c++)
            expected[c] = rgba[s.order[rank]][c] + (1 - rgba[s.order[rank]][3]) * expected[c];
    for (uint32_t k = 0; k < slv_strategy_count(); k++)
        for (uint32_t msaa = 1; msaa <= 4; msaa *= 4) {
            if (test_skip(k + (msaa > 1), 2))
                continue;
            image = draw(&s, slv_strategy_at(k), msaa, SLV_ALPHA_BLEND, background);
            check_all(&image, expected, slv_strategy_at(k)->name);
            slv_image_free(&image);
        }
    cast_rays(&s, SLV_ALPHA_BLEND, background, &image);
    check_all(&image, expected, "rays");
    slv_image_free(&image);
    free_stack(&s);
}

/* Where lists of fragments have no room the picture is made in bands, to the bit the same; a row
 * for which there is none is refused. */
static void check_bands(void) {
    static const float background[4] = {0.1f, 0.2f, 0.15f, 0.5f};
    float rgba[LAYERS][4];
    stack s;
    make_stack(&s);
    color_stack(&s, rgba, 0, 0.3f);
    for (uint32_t msaa = 1; msaa <= 4; msaa *= 4) {
        slv_image whole = draw(&s, slv_strategy_default(), msaa, SLV_ALPHA_BLEND, background);
        for (int rows = 1; rows <= 8; rows *= 2) {
            /* triangles share the pixels on their edges */
            lists_most = (uint64_t)rows * (msaa + 1) * LEAST_ROW;
            slv_image bands = draw(&s, slv_strategy_default(), msaa, SLV_ALPHA_BLEND, background);
            CHECK_MSG(memcmp(whole.pixels, bands.pixels, sizeof(float) * 4 * SIDE * SIDE) == 0,
                      "%u samples, room for %d rows or more", msaa, rows);
            slv_image_free(&bands);
        }
        lists_most = LEAST_ROW / 2;
        slv_image none = draw(&s, slv_strategy_default(), msaa, SLV_ALPHA_BLEND, background);
        CHECK(!none.pixels);
        lists_most = 0;
        slv_image_free(&whole);
    }
    free_stack(&s);
}

/* The nearest layer that is at least half there hides all others, with its colour undivided. */
static void check_mask(void) {
    static const float background[4] = {0, 0, 0.5f, 0.5f};
    float rgba[LAYERS][4], expected[4];
    stack s;
    slv_image image = {0};
    make_stack(&s);
    for (int there = 0; there < 2; there++) {
        color_stack(&s, rgba, 0.1f, there ? 0.9f : 0.45f);
        memcpy(expected, background, sizeof expected);
        for (int rank = 0; rank < LAYERS; rank++) {
            const float *layer = rgba[s.order[rank]];
            if (layer[3] < 0.5f)
                continue;
            for (int c = 0; c < 4; c++)
                expected[c] = layer[c] / layer[3];
            break;
        }
        for (uint32_t k = 0; k < slv_strategy_count(); k++)
            for (uint32_t msaa = 1; msaa <= 4; msaa *= 4) {
                if (test_skip(k + (msaa > 1), 2))
                    continue;
                image = draw(&s, slv_strategy_at(k), msaa, SLV_ALPHA_MASK, background);
                check_all(&image, expected, slv_strategy_at(k)->name);
                slv_image_free(&image);
            }
        cast_rays(&s, SLV_ALPHA_MASK, background, &image);
        check_all(&image, expected, "rays");
        slv_image_free(&image);
    }
    free_stack(&s);
}

/* A mask of so many texels a pixel that none is seen: as much of it is there as rays find; and
 * nothing of what is nowhere half there. */
static void check_far_mask(void) {
    enum { LOG2 = 8, COUNT = 1 << 2 * LOG2 };
    static const float background[4] = {0, 0, 0, 0};
    static float texels[4 * COUNT];
    uint64_t random = 3;
    stack s;
    slv_image drawn = {0}, rays = {0};
    make_stack(&s);
    kit_equal(&s.k, LOG2);
    for (int flat = 0; flat < 2; flat++) {
        double squares = 0, there = 0;
        kit_begin_texture(&s.k, SLV_TYPE_U8, 4);
        for (int i = 0; i < 4 * COUNT; i++)
            texels[i] = flat ? 0.4f : (float)(i % 4 == 3 ? test_random(&random) % 2 : texels[i]);
        for (int i = 0; i < COUNT; i++)
            texels[4 * i] = texels[4 * i + 1] = texels[4 * i + 2] = texels[4 * i + 3];
        for (uint32_t f = 0; f < LAYERS; f++)
            if (f == (uint32_t)s.order[0])
                kit_set(&s.k, f, texels);
        drawn = draw(&s, slv_strategy_default(), 4, SLV_ALPHA_MASK, background);
        cast_rays(&s, SLV_ALPHA_MASK, background, &rays);
        for (size_t i = 3; i < 4 * SIDE * SIDE; i += 4) {
            double apart = (double)(drawn.pixels[i] - rays.pixels[i]);
            squares += apart * apart / (SIDE * SIDE);
            there += (double)drawn.pixels[i] / (SIDE * SIDE);
        }
        /* four rays a pixel are a quarter off where half is there */
        CHECK_MSG(flat ? there == 0 : fabs(there - 0.5) < 0.03, "%g of the mask is there", there);
        CHECK_MSG(sqrt(squares) < 0.32, "a mask far away is %g from rays", sqrt(squares));
        slv_image_free(&drawn);
        slv_image_free(&rays);
    }
    free_stack(&s);
}

/* White paint on faces that are black where no paint is, one texel here and there: multiplied, a
 * lookup is its alpha, whatever it crosses. */
static void check_fringe(void) {
    enum { POINTS = 2000 };
    static int32_t faces[POINTS];
    static float uv[2 * POINTS], dx[2 * POINTS], dy[2 * POINTS], values[4 * POINTS],
        grey[4 * POINTS];
    uint64_t random = 77;
    slv_env env = test_env();
    kit k, two;
    slv_texture *multiplied = NULL;
    kit_grid(&k, 4, 4, true, 30, &random, NULL);
    kit_mixed(&k, 3, &random);
    two = k;
    kit_begin_texture(&k, SLV_TYPE_U16, 4);
    two.texture = NULL;
    two.levels = NULL;
    const slv_texture_desc four = {k.nfaces, SLV_TYPE_U16, 4, 3, k.res, SLV_TEXTURE_LINEAR};
    const slv_texture_desc pair = {k.nfaces, SLV_TYPE_U16, 2, 1, k.res, SLV_TEXTURE_LINEAR};
    slv_texture_destroy(k.texture);
    REQUIRE(slv_texture_create(&env, &four, &k.texture) == SLV_OK);
    REQUIRE(slv_texture_create(&env, &pair, &two.texture) == SLV_OK);
    for (uint32_t face = 0; face < k.nfaces; face++) {
        uint16_t texels[64 * 4], grey_texels[64 * 2];
        for (size_t i = 0; i < kit_texels(k.res[face]); i++) {
            uint16_t paint = test_random(&random) % 2 ? 0xffff : 0;
            for (int c = 0; c < 4; c++)
                texels[4 * i + (size_t)c] = paint;
            grey_texels[2 * i] = grey_texels[2 * i + 1] = paint;
            if (paint && test_random(&random) % 2) /* half there, and as white */
                texels[4 * i + 3] = grey_texels[2 * i + 1] = 0x8000;
        }
        REQUIRE(slv_texture_set_face(k.texture, face, texels) == SLV_OK);
        REQUIRE(slv_texture_set_face(two.texture, face, grey_texels) == SLV_OK);
    }
    REQUIRE(slv_texture_premultiply(&env, k.texture, SLV_TEXTURE_AUTO, &multiplied) == SLV_OK);
    slv_texture_destroy(k.texture);
    k.texture = multiplied;
    REQUIRE(slv_texture_premultiply(&env, two.texture, SLV_TEXTURE_AUTO, &multiplied) == SLV_OK);
    slv_texture_destroy(two.texture);
    two.texture = multiplied;
    for (int i = 0; i < POINTS; i++) {
        faces[i] = (int32_t)(test_random(&random) % k.nfaces);
        dx[2 * i] = dy[2 * i + 1] = ldexpf(1, -(int)(test_random(&random) % 8));
        for (int c = 0; c < 2; c++)
            uv[2 * i + c] = (float)(test_random(&random) % 1001) / 1000;
    }
    slv_gl_texture *texture = seam_upload(gl, &k, (slv_gl_texture_params){.anisotropy = 1});
    slv_gl_texture *grey_texture = seam_upload(gl, &two, (slv_gl_texture_params){.anisotropy = 1});
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        const slv_strategy *strategy = slv_strategy_at(s);
        REQUIRE(slv_gl_texture_lookup(texture, &env, strategy, POINTS, faces, uv, dx, dy, values) ==
                SLV_OK);
        REQUIRE(slv_gl_texture_lookup(grey_texture, &env, strategy, POINTS, faces, uv, dx, dy,
                                      grey) == SLV_OK);
        for (int i = 0; i < 4 * POINTS; i++) {
            CHECK_MSG(fabsf(values[i] - values[i | 3]) < 1e-4f, "%s: %g beside alpha %g",
                      strategy->name, (double)values[i], (double)values[i | 3]);
            CHECK_MSG(fabsf(values[i] - grey[i]) < 1e-4f, "%s: grey %g and not %g", strategy->name,
                      (double)grey[i], (double)values[i]);
        }
    }
    slv_gl_texture_destroy(texture);
    slv_gl_texture_destroy(grey_texture);
    slv_texture_destroy(two.texture);
    kit_free(&k);
}

/* Light is multiplied, and alpha stays as it is. */
static void check_values(void) {
    static const slv_res res = {0, 0};
    static const uint8_t texel[4] = {255, 128, 0, 128};
    slv_env env = test_env();
    slv_texture *texture = NULL, *multiplied = NULL, *none = NULL;
    slv_texture_desc desc = {1, SLV_TYPE_U8, 4, 3, &res, SLV_TEXTURE_SRGB};
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    REQUIRE(slv_texture_set_constant(texture, 0, texel) == SLV_OK);
    REQUIRE(slv_texture_premultiply(&env, texture, SLV_TEXTURE_AUTO, &multiplied) == SLV_OK);
    const uint8_t *light = slv_texture_texels(multiplied, 0);
    /* 128/255 is the light of 0.7354 of the curve; that of 128 times it is 0.1084, 0.3636 */
    CHECK(light[0] == 188 && light[1] == 93 && light[2] == 0 && light[3] == 128);
    CHECK(slv_texture_is_constant(multiplied, 0));
    slv_texture_destroy(multiplied);
    REQUIRE(slv_texture_premultiply(&env, texture, SLV_TEXTURE_DATA, &multiplied) == SLV_OK);
    light = slv_texture_texels(multiplied, 0);
    CHECK(light[0] == 128 && light[1] == 64 && light[2] == 0 && light[3] == 128);
    slv_texture_destroy(multiplied);
    slv_texture_destroy(texture);
    desc.alpha_channel = SLV_NO_ALPHA;
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    CHECK(slv_texture_premultiply(&env, texture, SLV_TEXTURE_AUTO, &none) == SLV_ERROR_ARGUMENT);
    CHECK(!none);
    slv_texture_destroy(texture);
}

int main(void) {
    slv_env env = test_env();
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    check_values();
    check_stack();
    check_bands();
    check_mask();
    check_far_mask();
    check_fringe();
    slv_gl_destroy(gl);
    return test_end();
}
