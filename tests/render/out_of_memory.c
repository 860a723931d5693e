/* Each allocation of each call of libselvage-gl fails once: no crash, no leak, SLV_ERROR_MEMORY and
 * one line in the log. What the driver allocates does not come through the hooks, and Mesa does not
 * survive without it, so that it is left alone. */
#include "kit/border_kit.h"
#include "kit/host_kit.h"
#include "kit/memory_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_images.h>
#include <selvage/gl_live.h>
#include <selvage/gl_material.h>
#include <selvage/gl_renderer.h>
#include <selvage/gl_residency.h>

static slv_gl *gl;
static kit grid;
static slv_surface *surface;
static slv_gl_texture *made; /* for calls on a texture */
static slv_gl_renderer *renderer;

static slv_result call_context(const slv_env *env) {
    slv_gl *own = NULL;
    slv_result result = slv_gl_create(env, SLV_GL_AUTO, &own);
    slv_gl_destroy(own);
    return result;
}

/* Another's context, which is made outside of the call's memory. */
static slv_result call_wrap(const slv_env *env) {
    slv_env plain = test_env();
    slv_gl *host = NULL, *own = NULL;
    void *library = dlopen("libEGL.so.1", RTLD_NOW);
    REQUIRE(library && slv_gl_create(&plain, SLV_GL_EGL, &host) == SLV_OK);
    slv_result result = slv_gl_wrap(env, host_proc, library, &own);
    slv_gl_destroy(own);
    slv_gl_destroy(host);
    dlclose(library);
    return result;
}

static slv_result create(const slv_env *env, const slv_gl_texture_params *params) {
    slv_gl_texture *texture = NULL;
    slv_result result =
        slv_gl_texture_create(gl, env, grid.texture, grid.adjacency, params, &texture);
    const char *text;
    uint64_t key;
    if (!result)
        result = slv_gl_texture_glsl(texture, slv_strategy_find("traverse"), 0, &text);
    if (!result)
        result = slv_gl_texture_key(texture, slv_strategy_find("traverse"), 1, &key);
    slv_gl_texture_destroy(texture);
    return result;
}

static slv_result call_texture(const slv_env *env) {
    return create(env, NULL);
}

static void two_pixels(const void *user, uint32_t tile, uint32_t x, uint32_t y, uint32_t count,
                       float *rgba) {
    (void)user, (void)tile, (void)y;
    for (uint32_t i = 0; i < 4 * count; i++)
        rgba[i] = (float)(x + i) / 8;
}

/* Images for the faces of the mesh, drawn. */
static slv_result call_images(const slv_env *env) {
    static const slv_uv_tile tile = {0, 0, 2, 2};
    const slv_frame frame = {.width = 8, .height = 8};
    slv_gl_images *images = NULL;
    uint32_t nfaces = slv_texture_get_desc(grid.texture)->nfaces;
    float *texcoords = calloc(nfaces, 8 * sizeof *texcoords);
    const slv_uv_images given = {.nfaces = nfaces,
                                 .texcoords = texcoords,
                                 .ntiles = 1,
                                 .tiles = &tile,
                                 .pixels = two_pixels};
    REQUIRE(texcoords);
    slv_gl_renderer *own = NULL; /* which keeps what it made for the images */
    slv_result result = slv_gl_images_create(gl, env, &given, 1, &images);
    if (!result && !(result = slv_gl_renderer_create(gl, env, grid.mesh, surface, 2, &own)))
        result = slv_gl_renderer_draw_images(own, env, images, &frame, NULL, NULL);
    slv_gl_renderer_destroy(own);
    slv_gl_images_destroy(images);
    free(texcoords);
    return result;
}

static slv_result call_blocks(const slv_env *env) {
    return create(env, &(slv_gl_texture_params){KIT_ALL, .compression = SLV_GL_COMPRESSION_BLOCKS,
                                                .prefix = "mine_"});
}

/* What follows changes of its texels. */
static slv_result call_live(const slv_env *env) {
    static uint8_t texels[16 * 3];
    const slv_gl_texture_params params = {KIT_ALL, .live = true, .even_levels = true};
    const slv_strategy *borders = slv_strategy_find("borders");
    slv_gl_texture *texture = NULL;
    uint64_t bytes;
    slv_gl_upload upload = {.ready = false};
    slv_result result =
        slv_gl_texture_prepare(gl, env, grid.texture, grid.adjacency, &params, &texture);
    while (!result && !upload.ready)
        result = slv_gl_texture_upload(texture, env, UINT64_C(1) << 40, &upload);
    texels[0]++;
    if (!result &&
        !(result = slv_texture_set_rect(grid.texture, 0, (slv_rect){0, 0, 4, 4}, texels)) &&
        !(result = slv_gl_texture_update(texture, env, NULL)))
        result = slv_gl_texture_read(texture, env, borders, 0, 0, 0, NULL, &bytes);
    slv_gl_texture_destroy(texture);
    return result;
}

/* Of which only a part is there. */
static slv_result call_residency(const slv_env *env) {
    const slv_strategy *clamp = slv_strategy_find("clamp");
    const slv_gl_residency_params params = {.texture = {.strategies = &clamp, .nstrategies = 1}};
    const float low[3] = {0, 0, 0}, high[3] = {80, 80, 80};
    const slv_camera camera = slv_camera_orbit(low, high, 20, 30, 30, 1);
    slv_gl_residency *residency = NULL;
    slv_source source = {0};
    float *corners = NULL;
    slv_result result = slv_mesh_corners(env, grid.mesh, NULL, &corners);
    if (!result &&
        !(result = slv_texture_as_source(env, grid.texture, grid.adjacency, NULL, &source)) &&
        !(result = slv_gl_residency_create(gl, env, &source, grid.adjacency, corners, &params,
                                           &residency)))
        result = slv_gl_residency_update(residency, env, &camera, 64, 64, NULL);
    slv_gl_residency_destroy(residency);
    slv_free(corners);
    return result;
}

static slv_result call_lookup(const slv_env *env) {
    const int32_t faces[2] = {0, 3};
    const float uv[4] = {0.5f, 0.5f, 0.1f, 0.9f}, zero[4] = {0};
    float out[8];
    return slv_gl_texture_lookup(made, env, slv_strategy_find("traverse"), 2, faces, uv, zero, zero,
                                 out);
}

static slv_result call_material(const slv_env *env) {
    const slv_gl_lookup lookup = {made, NULL};
    slv_gl_material *material = NULL;
    bool changed;
    slv_result result = slv_gl_material_create(env, &lookup, 1, &material);
    if (!result)
        result = slv_gl_material_update(material, env, &changed);
    slv_gl_material_destroy(material);
    return result;
}

static slv_result call_seam(const slv_env *env) {
    slv_gl_seam seam;
    return slv_gl_texture_seam_jump(made, env, slv_strategy_find("traverse"), grid.adjacency, NULL,
                                    &seam);
}

static slv_result call_renderer(const slv_env *env) {
    slv_gl_renderer *own = NULL;
    const slv_tessellation_params params = {.segments = 2};
    slv_result result = slv_gl_renderer_create_with(gl, env, grid.mesh, surface, &params, &own);
    if (!result)
        result = slv_gl_renderer_tessellate(own, env, grid.mesh, surface, &params);
    slv_gl_renderer_destroy(own);
    return result;
}

static slv_result call_draw(const slv_env *env) {
    const float low[3] = {0, 0, 0}, high[3] = {80, 80, 80};
    const slv_frame frame = {.camera = slv_camera_orbit(low, high, 20, 30, 30, 1),
                             .width = 32,
                             .height = 32,
                             .strategy = slv_strategy_find("traverse")};
    slv_image image = {0};
    slv_result result = slv_gl_renderer_draw(renderer, env, made, &frame, &image, NULL);
    slv_image_free(&image);
    return result;
}

int main(void) {
    static const struct {
        const char *name;
        slv_result (*call)(const slv_env *env);
    } entries[] = {
        {"images", call_images},       {"texture", call_texture}, {"live", call_live},
        {"residency", call_residency}, {"blocks", call_blocks},   {"lookup", call_lookup},
        {"seam", call_seam},           {"draw", call_draw},       {"renderer", call_renderer},
        {"material", call_material},   {"context", call_context}, {"wrap", call_wrap}};
    slv_env env = test_env();
    uint64_t random = 1;
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    kit_grid(&grid, 2, 2, false, 0, NULL, NULL);
    kit_equal(&grid, 2);
    kit_noise(&grid, SLV_TYPE_U8, 3, &random);
    REQUIRE(slv_surface_create(&env, grid.mesh, NULL, &surface) == SLV_OK);
    REQUIRE(slv_gl_texture_create(gl, &env, grid.texture, grid.adjacency, NULL, &made) == SLV_OK);
    REQUIRE(slv_gl_renderer_create(gl, &env, grid.mesh, surface, 2, &renderer) == SLV_OK);
    /* compiles the shaders */
    REQUIRE(call_lookup(&env) == SLV_OK && call_draw(&env) == SLV_OK &&
            call_images(&env) == SLV_OK);
    for (size_t i = 0; i < sizeof entries / sizeof *entries; i++) {
        /* a context that was made is the current one then */
        long failed;
        if (entries[i].call == call_context) {
            slv_gl_renderer_destroy(renderer);
            slv_gl_texture_destroy(made);
            slv_gl_destroy(gl);
        }
        failed = memory_sweep(entries[i].name, entries[i].call, NULL);
        fprintf(stderr, "%-12s %ld allocations\n", entries[i].name, failed);
    }
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    memory_within("a texture on the GPU", call_texture);
    slv_gl_destroy(gl);
    slv_surface_destroy(surface);
    kit_free(&grid);
    return test_end();
}
