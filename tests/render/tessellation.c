/* Faces divided each as the picture needs: the demo scene takes less than half of the triangles of
 * all faces alike, and looks as the finest does. */
#include "kit/command_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_renderer.h>
#include <selvage/ptx.h>

enum { WIDTH = 480, HEIGHT = 270, FINEST = 16 };

static slv_gl *gl;

static slv_image draw(const slv_mesh *mesh, const slv_surface *surface, slv_gl_texture *texture,
                      const slv_frame *frame, uint32_t segments, uint64_t *triangles) {
    const slv_tessellation_params params = {.segments = segments,
                                            .camera = &frame->camera,
                                            .width = frame->width,
                                            .height = frame->height};
    slv_env env = test_env();
    slv_gl_renderer *renderer = NULL;
    slv_image image = {0};
    REQUIRE(slv_gl_renderer_create_with(gl, &env, mesh, surface, &params, &renderer) == SLV_OK);
    REQUIRE(slv_gl_renderer_draw(renderer, &env, texture, frame, &image, NULL) == SLV_OK);
    *triangles = slv_gl_renderer_triangles(renderer);
    slv_gl_renderer_destroy(renderer);
    return image;
}

static double off_pixels(const slv_image *a, const slv_image *b) {
    uint32_t count = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        float apart = 0;
        for (size_t c = 0; c < 3; c++)
            apart = fmaxf(apart, fabsf(a->pixels[4 * i + c] - b->pixels[4 * i + c]));
        count += apart > 2.0f / 255;
    }
    return (double)count / (WIDTH * HEIGHT);
}

/* `part` of the whole is in the picture. */
static void check_view(const slv_mesh *mesh, const slv_surface *surface, slv_gl_texture *texture,
                       float azimuth, float part) {
    slv_mesh_stats stats;
    uint64_t even, chosen, finest;
    float low[3], high[3];
    REQUIRE(slv_mesh_get_stats(NULL, mesh, &stats) == SLV_OK);
    for (int c = 0; c < 3; c++) {
        float middle = (stats.bounds_min[c] + stats.bounds_max[c]) / 2;
        low[c] = middle + part * (stats.bounds_min[c] - middle);
        high[c] = middle + part * (stats.bounds_max[c] - middle);
    }
    const slv_frame frame = {
        .width = WIDTH,
        .height = HEIGHT,
        .msaa = 4,
        .camera = slv_camera_orbit(low, high, azimuth, 20, 35, (float)WIDTH / HEIGHT)};
    uint32_t segments = slv_tessellation_for(mesh, &frame.camera, WIDTH, HEIGHT);
    slv_image a = draw(mesh, surface, texture, &frame, segments, &even);
    slv_image b = draw(mesh, surface, texture, &frame, 0, &chosen);
    slv_image c = draw(mesh, surface, texture, &frame, FINEST, &finest);
    double off = off_pixels(&b, &c);
    fprintf(stderr, "%u triangles, %u face by face: %.3f %% of the pixels differ\n", (uint32_t)even,
            (uint32_t)chosen, 100 * off);
    CHECK(chosen > 1000 && 2 * chosen <= even && even < finest);
    CHECK_MSG(off <= 0.005, "%.3f %% of the pixels differ", 100 * off);
    slv_image_free(&a);
    slv_image_free(&b);
    slv_image_free(&c);
}

int main(void) {
    kit_scratch scratch;
    kit_run run;
    char program[KIT_PATH], obj[KIT_PATH], texels[KIT_PATH];
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL;
    slv_gl_texture *uploaded = NULL;
    const slv_gl_texture_params params = {KIT_ONLY(kit_strategy("traverse"))};
    kit_scratch_make(&scratch);
    kit_join(program, kit_variable("SELVAGE_BIN"), "selvage-assets");
    kit_run_program(&scratch, NULL, (const char *const[]){program, scratch.root, NULL}, &run);
    REQUIRE(run.code == 0);
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    REQUIRE(slv_mesh_load(&env, kit_join(obj, scratch.root, "scene.obj"), &mesh) == SLV_OK);
    REQUIRE(slv_ptx_open(&env, kit_join(texels, scratch.root, "scene.ptx"), &ptx) == SLV_OK);
    REQUIRE(slv_ptx_load_texture(&env, ptx, &texture) == SLV_OK);
    slv_ptx_close(ptx);
    REQUIRE(slv_mesh_adjacency(&env, mesh, &adjacency) == SLV_OK);
    REQUIRE(slv_surface_create(&env, mesh, NULL, &surface) == SLV_OK);
    REQUIRE(slv_gl_texture_create(gl, &env, texture, adjacency, &params, &uploaded) == SLV_OK);
    if (!test_brief())
        check_view(mesh, surface, uploaded, 30, 1);
    check_view(mesh, surface, uploaded, 210, 0.4f);
    slv_gl_texture_destroy(uploaded);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_texture_destroy(texture);
    slv_mesh_destroy(mesh);
    slv_gl_destroy(gl);
    test_remove(scratch.root);
    return test_end();
}
