/* Array textures that are found by handles (GL_ARB_bindless_texture), all batches in one draw:
 * frames and lookups are those of array textures that are bound, bit for bit, after changes of
 * texels and resolutions too, and no handle is resident when its texture is deleted. Skipped where
 * the driver has none; Mesa's zink has, from version 23 on. */
#include "kit/change_kit.h"
#include "kit/lookup_kit.h"
#include "kit/strategy_kit.h"

#include "gl/context/api.h"

#include <selvage/gl_live.h>
#include <selvage/gl_renderer.h>

enum { CASES = 40, SIZE = 48, MOST_HANDLES = 1 << 14, SKIPPED = 77 };

static slv_gl *gl;
static slv_gl_api real;
static uint32_t draws, longest; /* and the most batches of one */

/* Handles that were given out, those of textures that are gone without a texture. */
static struct {
    GLuint64 handle;
    GLuint texture;
    bool resident;
} handles[MOST_HANDLES];
static uint32_t nhandles;

static GLuint64 APIENTRY get_handle(GLuint texture, GLuint sampler) {
    GLuint64 handle = real.GetTextureSamplerHandleARB(texture, sampler);
    uint32_t i = 0;
    while (i < nhandles && (handles[i].handle != handle || !handles[i].texture))
        i++;
    REQUIRE(handle && i < MOST_HANDLES);
    if (i < nhandles)
        return handle;
    handles[nhandles].handle = handle;
    handles[nhandles++].texture = texture;
    return handle;
}

static void set_resident(GLuint64 handle, bool resident) {
    uint32_t i = 0;
    while (i < nhandles && (handles[i].handle != handle || !handles[i].texture))
        i++;
    REQUIRE(i < nhandles && handles[i].resident != resident);
    handles[i].resident = resident;
}

static void APIENTRY make_resident(GLuint64 handle) {
    set_resident(handle, true);
    real.MakeTextureHandleResidentARB(handle);
}

static void APIENTRY make_non_resident(GLuint64 handle) {
    set_resident(handle, false);
    real.MakeTextureHandleNonResidentARB(handle);
}

static void APIENTRY delete_textures(GLsizei count, const GLuint *textures) {
    for (GLsizei k = 0; k < count; k++) {
        for (uint32_t i = 0; i < nhandles; i++) {
            if (handles[i].texture != textures[k])
                continue;
            CHECK_MSG(!handles[i].resident, "texture %u is deleted with a resident handle",
                      textures[k]);
            handles[i].texture = 0;
        }
    }
    real.DeleteTextures(count, textures);
}

static void APIENTRY multi_draw(GLenum mode, const GLsizei *counts, GLenum type,
                                const void *const *at, GLsizei ndraws) {
    draws++;
    longest = (uint32_t)ndraws > longest ? (uint32_t)ndraws : longest;
    real.MultiDrawElements(mode, counts, type, at, ndraws);
}

/* A mesh in space: the kit's own has all its vertices on a line. */
static slv_mesh *in_space(const kit *k, uint64_t *random) {
    static float positions[3 * KIT_VERTS];
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    for (uint32_t i = 0; i < 3 * k->nverts; i++)
        positions[i] = (float)(test_random(random) % 1000) / 1000;
    slv_mesh_view view = {.nverts = k->nverts,
                          .positions = positions,
                          .npolys = k->npolys,
                          .poly_sizes = k->sizes,
                          .poly_verts = k->verts};
    REQUIRE(slv_mesh_create(&env, &view, &mesh) == SLV_OK);
    return mesh;
}

static void compare(const kit *k, slv_gl_renderer *renderer, slv_gl_texture *textures[2],
                    const slv_strategy *strategy, uint32_t which, uint64_t *random) {
    static float out[2][4 * NPOINTS];
    static const float low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
    slv_env env = test_env();
    slv_image images[2];
    slv_frame frame = {.width = SIZE, .height = SIZE, .strategy = strategy};
    frame.camera = slv_camera_orbit(low, high, (float)(which * 40), 20, 35, 1);
    frame.msaa = which % 2 ? 4 : 1;
    frame.alpha = k->nchannels == 4 ? (slv_alpha_mode)(which / 4 % 3) : SLV_ALPHA_IGNORE;
    random_points(k, random);
    for (int i = 0; i < 2; i++) {
        draws = 0;
        REQUIRE(slv_gl_renderer_draw(renderer, &env, textures[i], &frame, &images[i], NULL) ==
                SLV_OK);
        CHECK(draws == (i ? 1 : slv_gl_texture_batch_count(textures[0], strategy)));
        REQUIRE(slv_gl_texture_lookup(textures[i], &env, strategy, NPOINTS, faces, uv, dx, dy,
                                      out[i]) == SLV_OK);
    }
    CHECK_MSG(memcmp(images[0].pixels, images[1].pixels, sizeof(float) * 4 * SIZE * SIZE) == 0,
              "case %u: frames of %s differ", which, strategy->name);
    CHECK_MSG(memcmp(out[0], out[1], sizeof out[0]) == 0, "case %u: lookups of %s differ", which,
              strategy->name);
    slv_image_free(&images[0]);
    slv_image_free(&images[1]);
}

static void check(uint32_t which, uint64_t *random) {
    static const slv_type types[] = {SLV_TYPE_U8, SLV_TYPE_HALF, SLV_TYPE_FLOAT};
    const slv_strategy *strategy = slv_strategy_at(which % slv_strategy_count());
    slv_env env = test_env();
    slv_gl_texture_params params = {KIT_ONLY(strategy), .anisotropy = 1 + test_random(random) % 3,
                                    .pool_layers = 1 + test_random(random) % 8,
                                    .layout = which / 8 % 3, .live = true};
    slv_gl_texture *textures[2];
    slv_gl_renderer *renderer = NULL;
    slv_surface *surface = NULL;
    kit k;
    kit_any_mesh(&k, test_random(random) % KIT_MESHES, random);
    kit_any_resolutions(&k, 2, random);
    kit_noise(&k, types[which / 8 % 3], 1 + which % 4, random);
    slv_mesh *mesh = in_space(&k, random);
    REQUIRE(slv_surface_create(&env, mesh, NULL, &surface) == SLV_OK);
    REQUIRE(slv_gl_renderer_create(gl, &env, mesh, surface, 4, &renderer) == SLV_OK);
    for (int i = 0; i < 2; i++) {
        params.binding = i ? SLV_GL_BINDING_HANDLES : SLV_GL_BINDING_UNITS;
        REQUIRE(slv_gl_texture_create(gl, &env, k.texture, k.adjacency, &params, &textures[i]) ==
                SLV_OK);
    }
    compare(&k, renderer, textures, strategy, which, random);
    for (uint32_t round = 0; round < 2; round++) {
        for (uint32_t i = 0; i < 4; i++)
            kit_change(&k, test_random(random) % k.nfaces, 1, random);
        for (uint32_t i = 0; i < 3 * round; i++)
            kit_resize(&k, test_random(random) % k.nfaces, 5, which % 2, random);
        for (int i = 0; i < 2; i++)
            REQUIRE(slv_gl_texture_update(textures[i], &env, NULL) == SLV_OK);
        compare(&k, renderer, textures, strategy, which, random);
    }
    for (int i = 0; i < 2; i++)
        slv_gl_texture_destroy(textures[i]);
    for (uint32_t i = 0; i < nhandles; i++)
        CHECK(!handles[i].resident && !handles[i].texture);
    nhandles = 0;
    slv_gl_renderer_destroy(renderer);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    kit_free(&k);
    CHECK(real.GetError() == GL_NO_ERROR);
}

int main(void) {
    uint64_t random = 12;
    slv_env env = test_env();
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    if (!gl->handles) {
        fprintf(stderr, "skipped: %s has no handles of textures\n", slv_gl_get_info(gl)->renderer);
        slv_gl_destroy(gl);
        return SKIPPED;
    }
    real = gl->api;
    gl->api.GetTextureSamplerHandleARB = get_handle;
    gl->api.MakeTextureHandleResidentARB = make_resident;
    gl->api.MakeTextureHandleNonResidentARB = make_non_resident;
    gl->api.DeleteTextures = delete_textures;
    gl->api.MultiDrawElements = multi_draw;
    for (uint32_t i = 0; i < CASES; i++)
        if (!test_skip(i, 3))
            check(i, &random);
    CHECK(longest > 4);
    slv_gl_destroy(gl);
    return test_end();
}
