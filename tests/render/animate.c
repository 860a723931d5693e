/* A surface that moves, drawn frame after frame by one renderer: each frame is what a renderer of
 * the moved mesh draws, and a hundred of them leave nothing behind. */
#include "kit/border_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_renderer.h>

#include <malloc.h>

enum { SIZE = 48, FRAMES = 100 };

static void sway(const slv_mesh_view *view, float time, float *out) {
    for (uint32_t i = 0; i < 3 * view->nverts; i++)
        out[i] = view->positions[i] + 0.2f * sinf(time + 2 * view->positions[i / 3 * 3]);
}

static void draw(slv_gl_renderer *renderer, slv_gl_texture *texture, const slv_frame *frame,
                 slv_image *image) {
    slv_env env = test_env();
    REQUIRE(slv_gl_renderer_draw(renderer, &env, texture, frame, image, NULL) == SLV_OK);
}

int main(void) {
    static const float low[3] = {-1.5f, -1.5f, -1.5f}, high[3] = {1.5f, 1.5f, 1.5f};
    slv_env env = test_env();
    const slv_surface_params moves = {.moves = true};
    const slv_frame frame = {.camera = slv_camera_orbit(low, high, 30, 20, 35, 1),
                             .width = SIZE,
                             .height = SIZE,
                             .float_target = true};
    const slv_tessellation_params params = {.camera = &frame.camera, .width = SIZE, .height = SIZE};
    uint64_t random = 3;
    kit cube;
    slv_gl *gl = NULL;
    slv_surface *surface = NULL, *afresh = NULL;
    slv_gl_texture *texture = NULL;
    slv_gl_renderer *renderer = NULL, *other = NULL;
    slv_image image, wanted;
    kit_cube(&cube, &random);
    kit_equal(&cube, 3);
    kit_noise(&cube, SLV_TYPE_HALF, 3, &random);
    const slv_gl_texture_params upload = {KIT_ONLY(slv_strategy_find("borders"))};
    float corners[24];
    for (int i = 0; i < 24; i++)
        corners[i] = i / 3 >> i % 3 & 1 ? 1.0f : -1.0f;
    slv_mesh_view shape = *slv_mesh_get_view(cube.mesh), *view = &shape;
    shape.positions = corners;
    slv_mesh *rest = NULL;
    REQUIRE(slv_mesh_create(&env, &shape, &rest) == SLV_OK);
    float *positions = malloc((size_t)view->nverts * 3 * sizeof *positions);
    REQUIRE(positions && slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    REQUIRE(slv_gl_texture_create(gl, &env, cube.texture, cube.adjacency, &upload, &texture) ==
            SLV_OK);
    REQUIRE(slv_surface_create(&env, rest, &moves, &surface) == SLV_OK);
    REQUIRE(slv_gl_renderer_create_with(gl, &env, rest, surface, &params, &renderer) == SLV_OK);
    size_t before = 0, after = 0;
    for (int i = 0; i <= FRAMES + 20; i++) {
        /* a cycle, so that equal frames are compared */
        sway(view, 6.2831853f * (float)(i % 20) / 20, positions);
        REQUIRE(slv_surface_move(surface, view->nverts, positions) == SLV_OK);
        REQUIRE(slv_gl_renderer_tessellate(renderer, &env, rest, surface, &params) == SLV_OK);
        draw(renderer, texture, &frame, &image);
        after = mallinfo2().uordblks;
        before = i == 20 ? after : before;
        if (i < FRAMES + 20)
            slv_image_free(&image);
    }
    if (!TEST_SANITIZED)
        CHECK_MSG(after <= before + 65536, "%zu bytes became %zu", before, after);
    slv_mesh_view moved = *view;
    slv_mesh *mesh = NULL;
    moved.positions = positions;
    REQUIRE(slv_mesh_create(&env, &moved, &mesh) == SLV_OK);
    REQUIRE(slv_surface_create(&env, mesh, NULL, &afresh) == SLV_OK);
    REQUIRE(slv_gl_renderer_create_with(gl, &env, mesh, afresh, &params, &other) == SLV_OK);
    draw(other, texture, &frame, &wanted);
    CHECK(memcmp(image.pixels, wanted.pixels, sizeof(float) * 4 * SIZE * SIZE) == 0);
    float sum = 0;
    for (int i = 0; i < SIZE * SIZE; i++)
        sum += image.pixels[4 * i + 3];
    CHECK_MSG(sum > SIZE * SIZE / 20, "%g pixels", (double)sum);
    slv_image_free(&image);
    slv_image_free(&wanted);
    slv_gl_renderer_destroy(renderer);
    slv_gl_renderer_destroy(other);
    slv_gl_texture_destroy(texture);
    slv_surface_destroy(surface);
    slv_surface_destroy(afresh);
    slv_mesh_destroy(mesh);
    slv_mesh_destroy(rest);
    kit_free(&cube);
    free(positions);
    slv_gl_destroy(gl);
    return test_end();
}
