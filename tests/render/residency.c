/* A texture of which only a part is there keeps within its budgets, is never waited for, and looks
 * like the whole of it once that is there. */
#include "kit/strategy_kit.h"

#include "gl/context/api.h"

#include <selvage/gl_renderer.h>
#include <selvage/gl_residency.h>

#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

enum { SIDE = 8, NFACES = SIDE * SIDE, SIZE = 192, NPIXELS = SIZE * SIZE };

static slv_gl *gl;
static slv_mesh *mesh;
static slv_surface *surface;
static slv_adjacency *adjacency;
static slv_gl_renderer *renderer;
static float *corners;

/* What the driver was asked for: textures and buffers by their names, in bytes, of a residency's
 * calls only. */
enum { MOST_NAMES = 1 << 16 };
static struct {
    slv_gl_api real;
    bool counting;
    uint64_t textures[MOST_NAMES], buffers[MOST_NAMES], bytes, most;
} driver;

static void own(uint64_t *bytes, uint64_t more) {
    if (!driver.counting)
        return;
    *bytes += more;
    driver.bytes += more;
    driver.most = driver.bytes > driver.most ? driver.bytes : driver.most;
}

static void disown(uint64_t *all, GLsizei count, const GLuint *names) {
    for (GLsizei i = 0; i < count; i++) {
        driver.bytes -= all[names[i]];
        all[names[i]] = 0;
    }
}

static uint64_t texel_bytes(GLenum format) {
    static const struct {
        GLenum format;
        uint32_t bytes;
    } known[] = {{GL_R8, 1},    {GL_RG8, 2},     {GL_RGBA8, 4},   {GL_SRGB8_ALPHA8, 4},
                 {GL_R16F, 2},  {GL_RG16F, 4},   {GL_RGBA16F, 8}, {GL_R32F, 4},
                 {GL_RG32F, 8}, {GL_RGBA32F, 16}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (known[i].format == format)
            return known[i].bytes;
    REQUIRE(!"a format that this test does not know");
    return 0;
}

static void APIENTRY storage3d(GLuint texture, GLsizei levels, GLenum format, GLsizei width,
                               GLsizei height, GLsizei depth) {
    REQUIRE(texture < MOST_NAMES);
    for (GLsizei level = 0; level < levels; level++) {
        uint64_t w = (uint64_t)width >> level, h = (uint64_t)height >> level;
        own(&driver.textures[texture],
            (w ? w : 1) * (h ? h : 1) * (uint64_t)depth * texel_bytes(format));
    }
    driver.real.TextureStorage3D(texture, levels, format, width, height, depth);
}

static void APIENTRY buffer_storage(GLuint buffer, GLsizeiptr size, const void *data,
                                    GLbitfield flags) {
    REQUIRE(buffer < MOST_NAMES);
    own(&driver.buffers[buffer], (uint64_t)size);
    driver.real.NamedBufferStorage(buffer, size, data, flags);
}

static void APIENTRY delete_textures(GLsizei count, const GLuint *names) {
    disown(driver.textures, count, names);
    driver.real.DeleteTextures(count, names);
}

static void APIENTRY delete_buffers(GLsizei count, const GLuint *names) {
    disown(driver.buffers, count, names);
    driver.real.DeleteBuffers(count, names);
}

static slv_gl_proc get_proc(void *user, const char *name) {
    slv_gl_proc found = slv_gl_get_function(user, name), real = found;
    if (strcmp(name, "glTextureStorage3D") == 0) {
        memcpy(&driver.real.TextureStorage3D, &real, sizeof real);
        found = (slv_gl_proc)storage3d;
    } else if (strcmp(name, "glNamedBufferStorage") == 0) {
        memcpy(&driver.real.NamedBufferStorage, &real, sizeof real);
        found = (slv_gl_proc)buffer_storage;
    } else if (strcmp(name, "glDeleteTextures") == 0) {
        memcpy(&driver.real.DeleteTextures, &real, sizeof real);
        found = (slv_gl_proc)delete_textures;
    } else if (strcmp(name, "glDeleteBuffers") == 0) {
        memcpy(&driver.real.DeleteBuffers, &real, sizeof real);
        found = (slv_gl_proc)delete_buffers;
    }
    return found;
}

/* A plane of SIDE x SIDE quads. */
static void make_mesh(void) {
    enum { VERTS = (SIDE + 1) * (SIDE + 1) };
    slv_env env = test_env();
    static float positions[3 * VERTS];
    static int32_t sizes[NFACES], verts[4 * NFACES];
    for (int32_t i = 0; i < VERTS; i++) {
        positions[3 * i] = (float)(i % (SIDE + 1));
        positions[3 * i + 1] = (float)(i / (SIDE + 1));
    }
    for (int32_t f = 0; f < NFACES; f++) {
        int32_t at = f / SIDE * (SIDE + 1) + f % SIDE;
        const int32_t quad[4] = {at, at + 1, at + SIDE + 2, at + SIDE + 1};
        sizes[f] = 4;
        memcpy(verts + 4 * f, quad, sizeof quad);
    }
    slv_mesh_view view = {.nverts = VERTS,
                          .positions = positions,
                          .npolys = NFACES,
                          .poly_sizes = sizes,
                          .poly_verts = verts};
    REQUIRE(slv_mesh_create(&env, &view, &mesh) == SLV_OK);
    REQUIRE(slv_mesh_adjacency(&env, mesh, &adjacency) == SLV_OK);
    REQUIRE(slv_surface_create(&env, mesh, NULL, &surface) == SLV_OK);
    REQUIRE(slv_mesh_corners(&env, mesh, NULL, &corners) == SLV_OK);
    REQUIRE(slv_gl_renderer_create(gl, &env, mesh, surface, 2, &renderer) == SLV_OK);
}

/* Waves that go on across faces, some of them too fine to be seen from afar. */
static slv_texture *make_texture(slv_type type, uint32_t nchannels, uint64_t *random) {
    slv_env env = test_env();
    slv_res res[NFACES];
    slv_texture *texture = NULL;
    for (int f = 0; f < NFACES; f++)
        res[f] =
            (slv_res){(int8_t)(4 + test_random(random) % 4), (int8_t)(4 + test_random(random) % 4)};
    const slv_texture_desc desc = {.nfaces = NFACES,
                                   .type = type,
                                   .nchannels = nchannels,
                                   .alpha_channel = SLV_NO_ALPHA,
                                   .res = res};
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    for (uint32_t f = 0; f < NFACES; f++) {
        uint32_t width = 1u << res[f].u, height = 1u << res[f].v;
        size_t count = (size_t)nchannels * width * height;
        float *values = malloc(sizeof *values * count);
        void *texels = malloc(count * slv_type_size(type));
        REQUIRE(values && texels);
        for (uint32_t i = 0; i < width * height; i++) {
            float x = (float)(f % SIDE) + ((float)(i % width) + 0.5f) / (float)width;
            float y = (float)f / SIDE + ((float)i / (float)width + 0.5f) / (float)height;
            const float colour[4] = {0.5f + 0.4f * sinf(2 * x + y),
                                     0.5f + 0.3f * sinf(17 * x) * sinf(11 * y),
                                     (float)(i * 2654435761u >> 24) / 255, f % 3 ? 0.1f : 1};
            memcpy(values + (size_t)nchannels * i, colour, nchannels * sizeof *colour);
        }
        slv_type_from_float(type, values, count, texels);
        REQUIRE(slv_texture_set_face(texture, f, texels) == SLV_OK);
        free(values);
        free(texels);
    }
    return texture;
}

/* A source that takes its time, says who reads it, and fails for one face if it is told to. */
static struct slow {
    slv_source inner;
    pthread_t drawing;
    atomic_uint on_drawing, reads;
    atomic_bool armed, failing;
} slow;

static slv_result slow_describe(void *user, slv_source_desc *out) {
    (void)user;
    return slow.inner.fns->describe(slow.inner.user, out);
}

static slv_result slow_face(void *user, uint32_t face, slv_source_face *out) {
    (void)user;
    return slow.inner.fns->face(slow.inner.user, face, out);
}

static slv_result slow_read(void *user, uint32_t face, slv_res res, slv_rect rect, void *out) {
    (void)user;
    if (slow.armed) {
        nanosleep(&(struct timespec){.tv_nsec = 200000}, NULL);
        slow.on_drawing += pthread_equal(pthread_self(), slow.drawing) != 0;
        slow.reads++;
    }
    if (slow.failing && face == 27)
        return SLV_ERROR_IO;
    return slow.inner.fns->read(slow.inner.user, face, res, rect, out);
}

static void slow_close(void *user) {
    (void)user;
    slv_source_close(&slow.inner);
}

static slv_source open_slow(const slv_texture *texture) {
    static const slv_source_fns fns = {
        .describe = slow_describe, .face = slow_face, .read = slow_read, .close = slow_close};
    slv_env env = test_env();
    slow.armed = slow.failing = false;
    slow.on_drawing = slow.reads = 0;
    slow.drawing = pthread_self();
    REQUIRE(slv_texture_as_source(&env, texture, adjacency, NULL, &slow.inner) == SLV_OK);
    return (slv_source){.fns = &fns, .user = &slow};
}

/* From above, `height` faces away from a point of the plane. */
static slv_camera camera_at(float x, float y, float height) {
    return (slv_camera){.world_to_camera = {1, 0, 0, -x, 0, 1, 0, -y, 0, 0, 1, -height, 0, 0, 0, 1},
                        .perspective = true,
                        .window = {-0.5f, 0.5f, -0.5f, 0.5f}};
}

static slv_image draw(slv_gl_texture *texture, const slv_camera *camera) {
    slv_env env = test_env();
    slv_image image = {0};
    const slv_frame frame = {
        .camera = *camera, .width = SIZE, .height = SIZE, .shading = SLV_SHADE_UNLIT};
    REQUIRE(slv_gl_renderer_draw(renderer, &env, texture, &frame, &image, NULL) == SLV_OK);
    return image;
}

/* Of encoded colours as a screen shows them. */
static float difference(slv_image *a, slv_image *b, bool encoded) {
    float most = 0;
    if (encoded) {
        slv_texels_encode(4, 3, a->pixels, NPIXELS);
        slv_texels_encode(4, 3, b->pixels, NPIXELS);
    }
    for (size_t i = 0; i < (size_t)4 * NPIXELS; i++)
        most = fmaxf(most, fabsf(a->pixels[i] - b->pixels[i]));
    return most;
}

static slv_gl_residency_state update(slv_gl_residency *residency, const slv_camera *camera,
                                     const slv_gl_residency_params *params) {
    slv_env env = test_env();
    slv_gl_residency_state state;
    driver.counting = true;
    REQUIRE(slv_gl_residency_update(residency, &env, camera, SIZE, SIZE, &state) == SLV_OK);
    driver.counting = false;
    CHECK_MSG(driver.most <= params->gpu_bytes && state.host_bytes <= params->host_bytes,
              "%llu bytes on the GPU, %llu of memory", (unsigned long long)driver.most,
              (unsigned long long)state.host_bytes);
    CHECK_MSG(driver.bytes == state.gpu_bytes, "%llu bytes are there, %llu are said to be",
              (unsigned long long)driver.bytes, (unsigned long long)state.gpu_bytes);
    return state;
}

/* Updates until nothing more is to come; no call may read. */
static slv_gl_residency_state settle(slv_gl_residency *residency, const slv_camera *camera,
                                     const slv_gl_residency_params *params) {
    slv_gl_residency_state state = {0};
    for (int i = 0; i < 20000; i++) {
        state = update(residency, camera, params);
        if (state.settled)
            return state;
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
    }
    CHECK_MSG(false, "never settled: %u faces wait", state.waiting);
    return state;
}

struct scene {
    const char *strategy;
    slv_type type;
    uint32_t nchannels;
    slv_texture_encoding encoding;
    uint64_t gpu_bytes, host_bytes; /* MiB / 16 */
};

static void check(const struct scene *scene, uint64_t *random) {
    slv_env env = test_env();
    const slv_strategy *strategy = slv_strategy_find(scene->strategy);
    slv_texture *texture = make_texture(scene->type, scene->nchannels, random);
    slv_source source = open_slow(texture);
    slv_gl_residency_params params = {.texture = {KIT_ONLY(strategy), .encoding = scene->encoding},
                                      .gpu_bytes = scene->gpu_bytes << 16,
                                      .host_bytes = scene->host_bytes << 16};
    slv_gl_residency *residency = NULL;
    slv_gl_texture *whole = NULL;
    bool fits = scene->gpu_bytes > 256;
    bool encoded = scene->encoding == SLV_TEXTURE_AUTO && scene->type == SLV_TYPE_U8;
    REQUIRE(slv_gl_texture_create(gl, &env, texture, adjacency, &params.texture, &whole) == SLV_OK);
    driver.counting = true;
    driver.bytes = driver.most = 0;
    REQUIRE(slv_gl_residency_create(gl, &env, &source, adjacency, corners, &params, &residency) ==
            SLV_OK);
    driver.counting = false;
    slow.armed = true;
    const slv_camera cameras[] = {camera_at(4, 4, 12), camera_at(2, 2, 1.5f), camera_at(6, 6, 1),
                                  camera_at(4, 4, 30)};
    enum { NCAMERAS = sizeof cameras / sizeof *cameras };
    for (uint32_t i = 0; i < NCAMERAS; i++) {
        slv_gl_residency_state state = settle(residency, &cameras[i], &params);
        slv_image there = draw(slv_gl_residency_texture(residency), &cameras[i]);
        slv_image all = draw(whole, &cameras[i]);
        float most = difference(&there, &all, encoded);
        fprintf(stderr, "%s, camera %u: %llu bytes, bias %u, differs by %.5f\n", strategy->name, i,
                (unsigned long long)state.gpu_bytes, state.bias, (double)most);
        /* a set that does not fit may lack what neighbours' texels are compared with */
        CHECK_MSG(most <= (fits ? 1.0f / 255 : 1.0f / 16) || (state.bias && !fits),
                  "%s, camera %u: differs by %g", strategy->name, i, (double)most);
        slv_image_free(&there);
        slv_image_free(&all);
    }
    for (uint32_t i = 0; i < 60; i++) { /* without a rest */
        float t = (float)i / 8;
        slv_camera camera = camera_at(4 + 3 * sinf(t), 4 + 3 * cosf(1.7f * t), 1.2f + sinf(3 * t));
        update(residency, &camera, &params);
    }
    CHECK(slow.reads > 0 && slow.on_drawing == 0);
    slv_gl_residency_destroy(residency);
    CHECK(driver.bytes == 0);
    slv_gl_texture_destroy(whole);
    slv_texture_destroy(texture);
}

/* A face that cannot be read stays as it is; what is too small even for the coarse levels is said
 * at once. */
static void check_failures(void) {
    slv_env env = test_env(), quiet = {0};
    const slv_strategy *clamp = slv_strategy_find("clamp");
    uint64_t random = 9;
    slv_texture *texture = make_texture(SLV_TYPE_U8, 3, &random);
    slv_source source = open_slow(texture);
    slv_gl_residency_params params = {
        .texture = {KIT_ONLY(clamp)}, .gpu_bytes = 64 << 20, .host_bytes = 64 << 20};
    const slv_camera camera = camera_at(4, 4, 6);
    slv_gl_residency *residency = NULL;
    REQUIRE(slv_gl_residency_create(gl, &env, &source, adjacency, corners, &params, &residency) ==
            SLV_OK);
    slow.failing = true;
    slv_gl_residency_state state = {0};
    for (int i = 0; i < 20000 && !state.failed; i++) {
        REQUIRE(slv_gl_residency_update(residency, &env, &camera, SIZE, SIZE, &state) == SLV_OK);
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
    }
    CHECK(state.failed == 1);
    for (uint32_t i = 0; i < 20; i++) {
        slv_camera wrong = camera;
        *(i < 16 ? &wrong.world_to_camera[i] : &wrong.window[i - 16]) = i & 1 ? NAN : -INFINITY;
        CHECK(slv_gl_residency_update(residency, &quiet, &wrong, SIZE, SIZE, NULL) ==
              SLV_ERROR_ARGUMENT);
    }
    while (!state.settled)
        REQUIRE(slv_gl_residency_update(residency, &env, &camera, SIZE, SIZE, &state) == SLV_OK);
    slv_gl_residency_destroy(residency);
    for (int all = 0; all < 2; all++) { /* texels that each face always has: 8 each way, or all */
        params.gpu_bytes = all ? 1 << 20 : 1000;
        params.coarse_log2 = all ? UINT32_MAX : 0;
        source = open_slow(texture);
        CHECK(slv_gl_residency_create(gl, &quiet, &source, adjacency, corners, &params,
                                      &residency) == SLV_ERROR_LIMIT);
        CHECK(!residency && !source.fns);
    }
    slv_texture_destroy(texture);
}

int main(void) {
    static const struct scene scenes[] = {
        {"clamp", SLV_TYPE_U8, 3, SLV_TEXTURE_DATA, 1024, 1024},
        {"borders", SLV_TYPE_U8, 3, SLV_TEXTURE_AUTO, 1024, 1024},
        {"traverse", SLV_TYPE_HALF, 4, SLV_TEXTURE_AUTO, 1024, 1024},
        {"edge-aligned", SLV_TYPE_U8, 3, SLV_TEXTURE_AUTO, 1024, 1024},
        {"htex", SLV_TYPE_U8, 3, SLV_TEXTURE_DATA, 1024, 1024},
        {"borders", SLV_TYPE_U8, 3, SLV_TEXTURE_AUTO, 32, 64},
        {"hybrid", SLV_TYPE_U8, 4, SLV_TEXTURE_AUTO, 24, 64},
        {"htex", SLV_TYPE_U8, 3, SLV_TEXTURE_AUTO, 32, 64},
    };
    slv_env env = test_env();
    slv_gl *context = NULL;
    uint64_t random = 7;
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &context) == SLV_OK);
    REQUIRE(slv_gl_wrap(&env, get_proc, context, &gl) == SLV_OK);
    make_mesh();
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++)
        check(&scenes[i], &random);
    check_failures();
    slv_free(corners);
    slv_gl_renderer_destroy(renderer);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    slv_adjacency_destroy(adjacency);
    slv_gl_destroy(gl);
    slv_gl_destroy(context);
    return test_end();
}
