/* EGL and OSMesa draw the same picture, and a host's own context serves as well. */
#include "kit/border_kit.h"
#include "kit/host_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/bake.h>
#include <selvage/gl_renderer.h>

static slv_image draw(slv_gl *gl, const kit *k, const slv_strategy *strategy, uint32_t msaa) {
    slv_env env = test_env();
    slv_surface *surface = NULL;
    slv_gl_texture *texture = NULL;
    slv_gl_renderer *renderer = NULL;
    slv_image image = {0};
    slv_gl_texture_params params = {KIT_ONLY(strategy), .anisotropy = 4};
    const float low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
    slv_frame frame = {.width = 160,
                       .height = 120,
                       .msaa = msaa,
                       .strategy = strategy,
                       .camera = slv_camera_orbit(low, high, 30, 25, 40, 160.0f / 120)};
    slv_result result = slv_surface_create(&env, k->mesh, NULL, &surface);
    REQUIRE(result == SLV_OK);
    result = slv_gl_texture_create(gl, &env, k->texture, k->adjacency, &params, &texture);
    REQUIRE(result == SLV_OK);
    result = slv_gl_renderer_create(gl, &env, k->mesh, surface, 8, &renderer);
    REQUIRE(result == SLV_OK);
    result = slv_gl_renderer_draw(renderer, &env, texture, &frame, &image, NULL);
    REQUIRE(result == SLV_OK);
    slv_gl_renderer_destroy(renderer);
    slv_gl_texture_destroy(texture);
    slv_surface_destroy(surface);
    return image;
}

/* What a host may have left behind; none of it may show. */
static void dirty(void *library) {
    typedef void (*set_fn)(unsigned, int);
    typedef void (*one_fn)(unsigned);
    typedef void (*two_fn)(unsigned, unsigned);
    typedef void (*size_fn)(float);
    typedef void (*mask_fn)(unsigned char, unsigned char, unsigned char, unsigned char);
    ((set_fn)host_proc(library, "glPixelStorei"))(0x0CF2, 7);      /* unpack row length */
    ((set_fn)host_proc(library, "glPixelStorei"))(0x0D02, 9);      /* pack row length */
    ((set_fn)host_proc(library, "glPixelStorei"))(0x0CF4, 1);      /* unpack skip pixels */
    ((two_fn)host_proc(library, "glClipControl"))(0x8CA2, 0x935F); /* upper left, zero to one */
    ((two_fn)host_proc(library, "glPolygonMode"))(0x0408, 0x1B01); /* lines */
    ((one_fn)host_proc(library, "glEnable"))(0x8C89);              /* rasteriser discard */
    ((one_fn)host_proc(library, "glEnable"))(0x0BE2);              /* blend */
    ((one_fn)host_proc(library, "glEnable"))(0x0C11);              /* scissor */
    ((one_fn)host_proc(library, "glEnable"))(0x0B90);              /* stencil */
    ((one_fn)host_proc(library, "glEnable"))(0x0B44);              /* culling */
    ((one_fn)host_proc(library, "glDepthFunc"))(0x0204);           /* greater */
    ((size_fn)host_proc(library, "glPointSize"))(4);
    ((mask_fn)host_proc(library, "glColorMask"))(1, 0, 0, 1);
}

static float largest_difference(const slv_image *a, const slv_image *b, float *mean) {
    float largest = 0;
    double sum = 0;
    size_t count = (size_t)a->width * a->height * 4;
    for (size_t i = 0; i < count; i++) {
        largest = fmaxf(largest, fabsf(a->pixels[i] - b->pixels[i]));
        sum += a->pixels[i];
    }
    *mean = (float)(sum / (double)count);
    return largest;
}

/* Destroying one context leaves another one usable. */
static void check_two_contexts(const kit *k) {
    slv_env env = test_env();
    slv_gl *first = NULL, *second = NULL;
    float mean = 0;
    slv_result result = slv_gl_create(&env, SLV_GL_EGL, &first);
    REQUIRE(result == SLV_OK);
    result = slv_gl_create(&env, SLV_GL_EGL, &second);
    REQUIRE(result == SLV_OK);
    slv_gl_destroy(first);
    slv_image image = draw(second, k, kit_strategy("traverse"), 1);
    largest_difference(&image, &image, &mean);
    CHECK(mean > 0.05f);
    slv_image_free(&image);
    slv_gl_destroy(second);
}

static void make_cube(kit *k, uint64_t *random) {
    static const float corners[8][3] = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                                        {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};
    slv_env env = test_env();
    kit_cube(k, random);
    slv_mesh_view view = *slv_mesh_get_view(k->mesh);
    slv_mesh *placed = NULL;
    view.positions = &corners[0][0];
    slv_result result = slv_mesh_create(&env, &view, &placed);
    REQUIRE(result == SLV_OK);
    slv_mesh_destroy(k->mesh);
    k->mesh = placed;
    kit_equal(k, 4);
    kit_noise(k, SLV_TYPE_U8, 3, random);
}

/* One renderer with many textures, as in a viewer whose settings change: more programs than it
 * keeps, several of them in one frame (faces of many sizes need shaders that reach different
 * numbers of arrays). */
static void check_many_programs(uint64_t *random) {
    slv_env env = test_env();
    slv_gl *gl = NULL;
    slv_gl_renderer *renderer = NULL;
    slv_surface *surface = NULL;
    kit k;
    kit_grid(&k, 6, 6, false, 20, random, NULL);
    kit_mixed(&k, 3, random);
    kit_noise(&k, SLV_TYPE_U8, 3, random);
    slv_result result = slv_gl_create(&env, SLV_GL_EGL, &gl);
    REQUIRE(result == SLV_OK);
    result = slv_surface_create(&env, k.mesh, NULL, &surface);
    REQUIRE(result == SLV_OK);
    result = slv_gl_renderer_create(gl, &env, k.mesh, surface, 2, &renderer);
    REQUIRE(result == SLV_OK);
    /* cheap programs up to two below what the renderer keeps, then one frame that needs several
     * more */
    for (uint32_t made = 0; made < 63; made++) {
        slv_gl_texture *texture = NULL;
        const slv_strategy *strategy =
            made < 62 ? kit_strategy("borders") : kit_strategy("traverse");
        slv_gl_texture_params params = {KIT_ONLY(strategy), .border = 1 + made, .pool_layers = 4};
        slv_frame frame = {.width = 16, .height = 16, .strategy = strategy};
        const float low[3] = {0, 0, 0}, high[3] = {100, 100, 100};
        uint32_t variants = 0;
        frame.camera = slv_camera_orbit(low, high, 0, 30, 40, 1);
        result = slv_gl_texture_create(gl, &env, k.texture, k.adjacency, &params, &texture);
        REQUIRE(result == SLV_OK);
        for (uint32_t b = 0; b < slv_gl_texture_batch_count(texture, strategy); b++)
            variants |= 1u << slv_gl_texture_batch(texture, strategy, b).variant;
        uint32_t kinds = 0;
        for (uint32_t v = variants; v; v &= v - 1)
            kinds++;
        CHECK(made < 62 || kinds > 2);
        result = slv_gl_renderer_draw(renderer, &env, texture, &frame, NULL, NULL);
        CHECK_MSG(result == SLV_OK, "after %u programs: %s", made, test_last_log);
        slv_gl_texture_destroy(texture);
    }
    slv_gl_renderer_destroy(renderer);
    slv_surface_destroy(surface);
    slv_gl_destroy(gl);
    kit_free(&k);
}

int main(void) {
    slv_env env = test_env();
    uint64_t random = 3;
    kit k;
    make_cube(&k, &random);
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        for (uint32_t msaa = 1; msaa <= 4; msaa *= 4) {
            if (test_skip(s + (msaa > 1 ? 2 : 0), 4))
                continue;
            slv_image images[3];
            float mean;
            for (int i = 0; i < 3; i++) {
                slv_gl *gl = NULL, *host = NULL;
                slv_result result = slv_gl_create(&env, i == 1 ? SLV_GL_OSMESA : SLV_GL_EGL, &gl);
                REQUIRE(result == SLV_OK);
                if (i == 2) {
                    void *library = dlopen("libEGL.so.1", RTLD_NOW);
                    result = slv_gl_wrap(&env, host_proc, library, &host);
                    REQUIRE(result == SLV_OK);
                    CHECK(slv_gl_get_info(host)->backend == SLV_GL_HOST);
                    CHECK(slv_gl_has_samples(host, slv_gl_get_info(host)->max_msaa));
                    dirty(library);
                }
                CHECK(slv_gl_has_samples(gl, 1) && slv_gl_has_samples(gl, 4));
                CHECK(!slv_gl_has_samples(gl, 0) && !slv_gl_has_samples(gl, 3) &&
                      !slv_gl_has_samples(gl, 2 * slv_gl_get_info(gl)->max_msaa));
                images[i] = draw(host ? host : gl, &k, slv_strategy_at(s), msaa);
                slv_gl_destroy(host);
                slv_gl_destroy(gl);
            }
            CHECK(largest_difference(&images[0], &images[1], &mean) <= 1.0f / 255);
            CHECK(largest_difference(&images[0], &images[2], &mean) == 0);
            CHECK(mean > 0.05f);
            for (int i = 0; i < 3; i++)
                slv_image_free(&images[i]);
        }
    }
    check_two_contexts(&k);
    if (!test_brief())
        check_many_programs(&random);
    kit_free(&k);
    return test_end();
}
