/* Textures in a host's own programs: several in one shader, with names, texture units and storage
 * bindings that the host chooses, in stages without derivatives; and lookups that leave the taps of
 * a footprint to the sampler. */
#include "kit/change_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_context.h>
#include <selvage/gl_images.h>
#include <selvage/gl_live.h>
#include <selvage/gl_renderer.h>

#include <GL/glcorearb.h>

#include <pthread.h>

enum { POINTS = 256 };

static slv_gl *gl;
static kit cube;

#define FUNCTIONS(X)                                                                               \
    X(PFNGLCREATESHADERPROC, CreateShader)                                                         \
    X(PFNGLSHADERSOURCEPROC, ShaderSource)                                                         \
    X(PFNGLCOMPILESHADERPROC, CompileShader)                                                       \
    X(PFNGLGETSHADERIVPROC, GetShaderiv)                                                           \
    X(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog)                                                 \
    X(PFNGLDELETESHADERPROC, DeleteShader)                                                         \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram)                                                       \
    X(PFNGLATTACHSHADERPROC, AttachShader)                                                         \
    X(PFNGLLINKPROGRAMPROC, LinkProgram)                                                           \
    X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                                                         \
    X(PFNGLUSEPROGRAMPROC, UseProgram)                                                             \
    X(PFNGLDELETEPROGRAMPROC, DeleteProgram)                                                       \
    X(PFNGLCREATEBUFFERSPROC, CreateBuffers)                                                       \
    X(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                                                       \
    X(PFNGLNAMEDBUFFERSTORAGEPROC, NamedBufferStorage)                                             \
    X(PFNGLBINDBUFFERBASEPROC, BindBufferBase)                                                     \
    X(PFNGLDISPATCHCOMPUTEPROC, DispatchCompute)                                                   \
    X(PFNGLMEMORYBARRIERPROC, MemoryBarrier)                                                       \
    X(PFNGLGETNAMEDBUFFERSUBDATAPROC, GetNamedBufferSubData)                                       \
    X(PFNGLENABLEPROC, Enable)                                                                     \
    X(PFNGLDISABLEPROC, Disable)                                                                   \
    X(PFNGLDEPTHFUNCPROC, DepthFunc)                                                               \
    X(PFNGLCLIPCONTROLPROC, ClipControl)                                                           \
    X(PFNGLPIXELSTOREIPROC, PixelStorei)                                                           \
    X(PFNGLBINDBUFFERPROC, BindBuffer)                                                             \
    X(PFNGLISBUFFERPROC, IsBuffer)                                                                 \
    X(PFNGLISTEXTUREPROC, IsTexture)                                                               \
    X(PFNGLISSAMPLERPROC, IsSampler)                                                               \
    X(PFNGLISPROGRAMPROC, IsProgram)                                                               \
    X(PFNGLGETINTEGERVPROC, GetIntegerv)
static struct {
#define MEMBER(type, name) type name;
    FUNCTIONS(MEMBER)
} api;

static void load(void) {
#define LOAD(type, name)                                                                           \
    api.name = (type)slv_gl_get_function(gl, "gl" #name);                                          \
    REQUIRE(api.name);
    FUNCTIONS(LOAD)
#undef LOAD
}

static slv_gl_texture *make(const slv_gl_texture_params *params) {
    slv_env env = test_env();
    slv_gl_texture *made = NULL;
    REQUIRE(slv_gl_texture_create(gl, &env, cube.texture, cube.adjacency, params, &made) == SLV_OK);
    return made;
}

static GLuint compile(GLenum stage, const char *const *texts, GLsizei count) {
    GLuint shader = api.CreateShader(stage);
    GLint fine = 0;
    char log[2048] = "";
    api.ShaderSource(shader, count, texts, NULL);
    api.CompileShader(shader);
    api.GetShaderiv(shader, GL_COMPILE_STATUS, &fine);
    if (!fine)
        api.GetShaderInfoLog(shader, sizeof log, NULL, log);
    CHECK_MSG(fine, "%s", log);
    return shader;
}

/* Points of random faces, footprints of a texel or so. */
struct points {
    int32_t faces[POINTS];
    float uv[2 * POINTS], dx[2 * POINTS], dy[2 * POINTS];
};

static void make_points(struct points *p, float width) {
    uint64_t random = 5;
    memset(p, 0, sizeof *p);
    for (uint32_t i = 0; i < POINTS; i++) {
        p->faces[i] = (int32_t)(test_random(&random) % cube.nfaces);
        p->uv[2 * i] = (float)(test_random(&random) % 1024) / 1023;
        p->uv[2 * i + 1] = (float)(test_random(&random) % 1024) / 1023;
        p->dx[2 * i] = p->dy[2 * i + 1] = width;
    }
}

static const char *const compute_text =
    "layout(local_size_x = 64) in;\n"
    "struct point { vec2 uv; int face; float width; };\n"
    "layout(std430, binding = 0) readonly buffer points_block { point points[]; };\n"
    "layout(std430, binding = 1) writeonly buffer values_block { vec4 values[]; };\n"
    "void main() {\n"
    "    uint i = gl_GlobalInvocationID.x;\n"
    "    point p = points[i];\n"
    "    vec2 dx = vec2(p.width, 0.0), dy = vec2(0.0, p.width);\n"
    "    values[2u * i] = colour_sample_grad(p.face, p.uv, dx, dy);\n"
    "    values[2u * i + 1u] = rough_sample_grad(p.face, p.uv, dx, dy);\n"
    "}\n";

/* Runs a compute shader that looks both textures up. */
static void run(const char *const *texts, GLsizei count, const struct points *p, float width,
                float *values) {
    struct {
        float uv[2];
        int32_t face;
        float width;
    } rows[POINTS];
    GLuint buffers[2], shader = compile(GL_COMPUTE_SHADER, texts, count);
    GLuint program = api.CreateProgram();
    GLint fine = 0;
    for (uint32_t i = 0; i < POINTS; i++) {
        memcpy(rows[i].uv, p->uv + 2 * i, sizeof rows[i].uv);
        rows[i].face = p->faces[i];
        rows[i].width = width;
    }
    api.AttachShader(program, shader);
    api.LinkProgram(program);
    api.GetProgramiv(program, GL_LINK_STATUS, &fine);
    REQUIRE(fine);
    api.CreateBuffers(2, buffers);
    api.NamedBufferStorage(buffers[0], sizeof rows, rows, 0);
    api.NamedBufferStorage(buffers[1], POINTS * 8 * sizeof *values, NULL, 0);
    api.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffers[0]);
    api.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffers[1]);
    api.UseProgram(program);
    api.DispatchCompute(POINTS / 64, 1, 1);
    api.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    api.GetNamedBufferSubData(buffers[1], 0, POINTS * 8 * sizeof *values, values);
    api.UseProgram(0);
    api.DeleteBuffers(2, buffers);
    api.DeleteProgram(program);
    api.DeleteShader(shader);
}

/* One texture as colour and, by another strategy, as something else, in one shader: each gives what
 * it gives alone. */
static void check_two(const slv_strategy *first, const slv_strategy *second) {
    static float alone[2][4 * POINTS], together[8 * POINTS];
    static struct points points;
    slv_env env = test_env();
    const float width = 0.1f;
    const char *texts[5] = {"#version 450 core\n", NULL, NULL, NULL, compute_text};
    slv_gl_texture_params params[2] = {
        {KIT_ONLY(first), .batch_pools = 8, .prefix = "colour_", .explicit_only = true},
        {KIT_ONLY(second), .batch_pools = 4, .prefix = "rough_", .explicit_only = true,
         .first_unit = 8, .first_storage = 9}};
    slv_gl_texture *made[2];
    make_points(&points, width);
    for (uint32_t i = 0; i < 2; i++) {
        made[i] = make(&params[i]);
        const slv_strategy *strategy = i ? second : first;
        REQUIRE(slv_gl_texture_batch_count(made[i], strategy) == 1);
        slv_gl_batch batch = slv_gl_texture_batch(made[i], strategy, 0);
        REQUIRE(slv_gl_texture_lookup(made[i], &env, strategy, POINTS, points.faces, points.uv,
                                      points.dx, points.dy, alone[i]) == SLV_OK);
        REQUIRE(slv_gl_texture_glsl(made[i], strategy, batch.variant, &texts[2 + i]) == SLV_OK);
        CHECK(!strstr(texts[2 + i], "slv_") && !strstr(texts[2 + i], "SLV_"));
        CHECK(!strstr(texts[2 + i], "#extension"));
    }
    texts[1] = slv_gl_texture_extensions(made[0]);
    for (uint32_t i = 0; i < 2; i++)
        slv_gl_texture_bind(made[i], i ? second : first, 0);
    run(texts, 5, &points, width, together);
    for (uint32_t i = 0; i < 8 * POINTS; i++) {
        float value = alone[i / 4 % 2][4 * (i / 8) + i % 4];
        CHECK_MSG(fabsf(together[i] - value) <= 1e-6f, "%s with %s: %g, alone %g", first->name,
                  second->name, (double)together[i], (double)value);
    }
    /* and in a vertex shader */
    texts[4] =
        "void main() { gl_Position = colour_sample_grad(0, vec2(0.5), vec2(0.1), vec2(0.1)); }\n";
    api.DeleteShader(compile(GL_VERTEX_SHADER, texts, 5));
    for (uint32_t i = 0; i < 2; i++) {
        slv_gl_texture_unbind(made[i]);
        slv_gl_texture_destroy(made[i]);
    }
}

/* What the sampler takes by itself of a texture of one colour is that colour: coverage is weighed
 * in the same way. */
static void check_taps(const slv_strategy *strategy) {
    static const float colour[3] = {0.25f, 0.5f, 0.75f};
    static float values[4 * POINTS];
    static struct points points;
    slv_env env = test_env();
    uint64_t keys[2];
    make_points(&points, 0.5f);
    for (uint32_t i = 0; i < 2; i++) {
        slv_gl_texture_params params = {KIT_ONLY(strategy), .anisotropy = 4,
                                        .taps = i ? SLV_GL_TAPS_SAMPLER : SLV_GL_TAPS_SHADER};
        const char *text = NULL;
        slv_gl_texture *made = make(&params);
        slv_gl_batch batch = slv_gl_texture_batch(made, strategy, 0);
        REQUIRE(slv_gl_texture_glsl(made, strategy, batch.variant, &text) == SLV_OK);
        CHECK(strstr(text, i ? "#define SLV_TAPS 0\n" : "#define SLV_TAPS 1\n"));
        REQUIRE(slv_gl_texture_key(made, strategy, batch.variant, &keys[i]) == SLV_OK);
        for (uint32_t k = 0; k < POINTS; k++)
            points.dx[2 * k] = i ? 0.05f : 0.5f; /* long footprints, too */
        REQUIRE(slv_gl_texture_lookup(made, &env, strategy, POINTS, points.faces, points.uv,
                                      points.dx, points.dy, values) == SLV_OK);
        /* a software sampler takes footprints from other fragments, beyond what a page holds */
        bool exact = !i || strategy->packing != SLV_GL_PAGES;
        for (uint32_t k = 0; k < 4 * POINTS; k++) {
            float most = k % 4 < 3 ? colour[k % 4] : 1, least = exact ? most : 0;
            CHECK_MSG(values[k] > least - 1e-3f && values[k] < (exact ? most : 1) + 1e-3f,
                      "%s, taps %u: %g", strategy->name, i, (double)values[k]);
        }
        slv_gl_texture_destroy(made);
    }
    CHECK(keys[0] != keys[1]);
}

/* What a host has of the state that transfers and drawing depend on. */
static const GLenum states[] = {GL_BLEND,
                                GL_SCISSOR_TEST,
                                GL_DEPTH_FUNC,
                                GL_CLIP_DEPTH_MODE,
                                GL_UNPACK_ALIGNMENT,
                                GL_UNPACK_ROW_LENGTH,
                                GL_UNPACK_SKIP_ROWS,
                                GL_PACK_ALIGNMENT,
                                GL_PACK_SKIP_PIXELS,
                                GL_PIXEL_UNPACK_BUFFER_BINDING,
                                GL_PIXEL_PACK_BUFFER_BINDING,
                                GL_SHADER_STORAGE_BUFFER_BINDING};
enum { STATES = sizeof states / sizeof *states, NAMES = 4096 };

static void get_states(GLint out[STATES]) {
    for (size_t i = 0; i < STATES; i++)
        api.GetIntegerv(states[i], &out[i]);
}

static void white(const void *user, uint32_t tile, uint32_t x, uint32_t y, uint32_t count,
                  float *rgba) {
    (void)user, (void)tile, (void)x, (void)y;
    for (uint32_t i = 0; i < 4 * count; i++)
        rgba[i] = 1;
}

static const slv_uv_tile one_tile = {0, 0, 5, 3};
static const float one_face[8] = {0, 0, 1, 0, 1, 1, 0, 1};
static const slv_uv_images one_image = {
    .nfaces = 1, .texcoords = one_face, .ntiles = 1, .tiles = &one_tile, .pixels = white};

/* Images go while the one table that they have is bound, and another is the host's. */
static void make_images(GLuint host) {
    static bool was[NAMES];
    slv_env env = test_env();
    slv_gl_images *images = NULL;
    for (GLuint name = 1; name < NAMES; name++)
        was[name] = api.IsBuffer(name);
    REQUIRE(slv_gl_images_create(gl, &env, &one_image, 4, &images) == SLV_OK);
    uint32_t tables = 0;
    for (GLuint name = 1; name < NAMES; name++)
        if (!was[name] && api.IsBuffer(name)) {
            api.BindBufferBase(GL_SHADER_STORAGE_BUFFER, SLV_GL_FIRST_STORAGE, name);
            tables++;
        }
    CHECK(tables == 1);
    api.BindBuffer(GL_SHADER_STORAGE_BUFFER, host);
    slv_gl_images_destroy(images);
}

/* Textures are made, uploaded, updated and read amid a host's frame, whose state stays, and is none
 * of theirs. */
static void check_states(void) {
    static unsigned char held[2][1 << 16];
    const slv_strategy *strategy = slv_strategy_find("borders");
    slv_gl_texture_params params = {KIT_ONLY(strategy), .live = true};
    slv_env env = test_env();
    slv_gl_upload upload = {0};
    uint64_t random = 5, bytes[2];
    GLint before[STATES], after[STATES];
    slv_gl_texture *plain = make(&params), *guest = NULL;
    GLuint buffer = 0;
    api.CreateBuffers(1, &buffer);
    api.NamedBufferStorage(buffer, 64, NULL, 0);
    api.Enable(GL_BLEND);
    api.Enable(GL_SCISSOR_TEST);
    api.DepthFunc(GL_GEQUAL);
    api.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    api.PixelStorei(GL_UNPACK_ALIGNMENT, 8);
    api.PixelStorei(GL_UNPACK_ROW_LENGTH, 7);
    api.PixelStorei(GL_UNPACK_SKIP_ROWS, 3);
    api.PixelStorei(GL_PACK_ALIGNMENT, 2);
    api.PixelStorei(GL_PACK_SKIP_PIXELS, 5);
    api.BindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
    api.BindBuffer(GL_PIXEL_PACK_BUFFER, buffer);
    slv_gl_texture *bound = make(&params);
    slv_gl_texture_bind(bound, NULL, 0);
    api.BindBuffer(GL_SHADER_STORAGE_BUFFER, buffer);
    get_states(before);
    slv_gl_texture_destroy(bound);
    make_images(buffer);
    REQUIRE(slv_gl_texture_prepare(gl, &env, cube.texture, cube.adjacency, &params, &guest) ==
            SLV_OK);
    while (!upload.ready)
        REQUIRE(slv_gl_texture_upload(guest, &env, 1000, &upload) == SLV_OK);
    kit_change(&cube, 0, 1, &random);
    REQUIRE(slv_gl_texture_update(guest, &env, NULL) == SLV_OK);
    REQUIRE(slv_gl_texture_update(plain, &env, NULL) == SLV_OK);
    for (uint32_t face = 0; face < cube.nfaces; face++) {
        for (uint32_t i = 0; i < 2; i++)
            REQUIRE(slv_gl_texture_read(i ? guest : plain, &env, strategy, face, 0, sizeof held[i],
                                        held[i], &bytes[i]) == SLV_OK);
        CHECK(bytes[0] == bytes[1] && memcmp(held[0], held[1], bytes[0]) == 0);
    }
    get_states(after);
    for (size_t i = 0; i < STATES; i++)
        CHECK_MSG(before[i] == after[i], "state 0x%04x: %d was %d", states[i], after[i], before[i]);
    slv_gl_texture_destroy(plain);
    slv_gl_texture_destroy(guest);
    api.DeleteBuffers(1, &buffer);
}

/* Where the context is not current calls say so in one line, and nothing is lost by them. */
struct elsewhere {
    slv_gl_texture *ready, *begun;
    uint32_t lines;
};

static void count_line(void *user, slv_log_level level, const char *message) {
    if (level == SLV_LOG_ERROR && strstr(message, "not current"))
        ++*(uint32_t *)user;
}

static void *call_elsewhere(void *user) {
    struct elsewhere *e = user;
    slv_env env = {.log = count_line, .log_user = &e->lines};
    slv_gl_texture *none = NULL;
    const int32_t face = 0;
    const float zero[2] = {0};
    float value[4];
    uint64_t bytes;
    CHECK(slv_gl_texture_update(e->ready, &env, NULL) == SLV_ERROR_GL);
    CHECK(slv_gl_texture_upload(e->begun, &env, UINT64_MAX, NULL) == SLV_ERROR_GL);
    CHECK(slv_gl_texture_read(e->ready, &env, NULL, 0, 0, 0, NULL, &bytes) == SLV_ERROR_GL);
    CHECK(slv_gl_texture_lookup(e->ready, &env, NULL, 1, &face, zero, zero, zero, value) ==
          SLV_ERROR_GL);
    CHECK(slv_gl_texture_create(gl, &env, cube.texture, cube.adjacency, NULL, &none) ==
          SLV_ERROR_GL);
    CHECK(e->lines == 5 && !none);
    return NULL;
}

static void check_elsewhere(void) {
    slv_gl_texture_params params = {KIT_ONLY(slv_strategy_find("borders")), .live = true};
    struct elsewhere e = {.ready = make(&params)};
    slv_env env = test_env();
    slv_gl_update update;
    slv_gl_upload upload;
    slv_gl *other = NULL;
    uint64_t random = 9, bytes;
    pthread_t thread;
    kit_change(&cube, 0, 1, &random);
    REQUIRE(slv_gl_texture_prepare(gl, &env, cube.texture, cube.adjacency, &params, &e.begun) ==
            SLV_OK);
    CHECK(slv_gl_texture_read(e.begun, &(slv_env){0}, NULL, 0, 0, 0, NULL, &bytes) ==
          SLV_ERROR_ARGUMENT);
    CHECK(slv_gl_texture_update(e.begun, &(slv_env){0}, NULL) == SLV_ERROR_ARGUMENT);
    REQUIRE(pthread_create(&thread, NULL, call_elsewhere, &e) == 0);
    pthread_join(thread, NULL);
    api.Enable(0xdead); /* a mistake of the host's is none of the library's */
    CHECK(slv_gl_texture_update(e.ready, &env, &update) == SLV_OK && update.faces == 1);
    CHECK(slv_gl_texture_upload(e.begun, &env, UINT64_MAX, &upload) == SLV_OK && upload.ready);
    slv_gl_texture_destroy(e.begun);
    REQUIRE(slv_gl_texture_prepare(gl, &env, cube.texture, cube.adjacency, &params, &e.begun) ==
            SLV_OK);
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &other) == SLV_OK); /* current now */
    e.lines = 0;
    call_elsewhere(&e);
    slv_gl_texture_destroy(e.begun);
    slv_gl_texture_destroy(e.ready);
    slv_gl_destroy(other);
}

/* A texture, a renderer and UV images, all of which have objects of OpenGL's. */
struct guests {
    slv_gl_texture *texture;
    slv_gl_renderer *renderer;
    slv_gl_images *images;
};

static struct guests make_guests(slv_gl *in) {
    slv_env env = test_env();
    const slv_gl_texture_params params = {KIT_ONLY(slv_strategy_find("traverse"))};
    const float low[3] = {0, 0, 0}, high[3] = {60, 60, 60};
    const slv_frame frame = {
        .width = 16, .height = 16, .camera = slv_camera_orbit(low, high, 20, 20, 35, 1)};
    struct guests made = {0};
    slv_surface *surface = NULL;
    slv_image image;
    REQUIRE(slv_gl_texture_create(in, &env, cube.texture, cube.adjacency, &params, &made.texture) ==
            SLV_OK);
    REQUIRE(slv_surface_create(&env, cube.mesh, NULL, &surface) == SLV_OK);
    REQUIRE(slv_gl_renderer_create(in, &env, cube.mesh, surface, 2, &made.renderer) == SLV_OK);
    REQUIRE(slv_gl_renderer_draw(made.renderer, &env, made.texture, &frame, &image, NULL) ==
            SLV_OK);
    REQUIRE(slv_gl_images_create(in, &env, &one_image, 4, &made.images) == SLV_OK);
    slv_image_free(&image);
    slv_surface_destroy(surface);
    return made;
}

static void destroy_guests(struct guests *guests) {
    slv_gl_images_destroy(guests->images);
    slv_gl_renderer_destroy(guests->renderer);
    slv_gl_texture_destroy(guests->texture);
}

static uint32_t count_objects(void) {
    uint32_t count = 0;
    for (GLuint name = 1; name < NAMES; name++)
        count += (uint32_t)(api.IsBuffer(name) + api.IsTexture(name) + api.IsSampler(name) +
                            api.IsProgram(name));
    return count;
}

/* What goes while another context is current leaves that one's objects, which have the same names,
 * alone. */
static void check_gone_elsewhere(void) {
    slv_env env = test_env();
    slv_gl *contexts[2] = {NULL, NULL};
    struct guests guests[2];
    for (int i = 0; i < 2; i++) {
        REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &contexts[i]) == SLV_OK);
        guests[i] = make_guests(contexts[i]);
    }
    uint32_t count = count_objects();
    destroy_guests(&guests[0]);
    CHECK_MSG(count_objects() == count, "%u objects of %u are left", count_objects(), count);
    api.UseProgram(0);
    destroy_guests(&guests[1]);
    CHECK_MSG(count_objects() == 0, "%u objects are left", count_objects());
    for (int i = 0; i < 2; i++)
        slv_gl_destroy(contexts[i]);
}

static bool stop(void *user, uint64_t done, uint64_t total) {
    (void)user, (void)done, (void)total;
    return false;
}

static void count_error(void *user, slv_log_level level, const char *message) {
    (void)message;
    *(uint32_t *)user += level == SLV_LOG_ERROR;
}

/* What was cancelled says so when it is gone on with, too. */
static void check_cancelled(void) {
    slv_gl_texture_params params = {KIT_ONLY(slv_strategy_find("clamp")), .progress = {stop, NULL}};
    uint32_t lines = 0;
    slv_env env = {.log = count_error, .log_user = &lines};
    slv_gl_texture *made = NULL;
    REQUIRE(slv_gl_texture_prepare(gl, &env, cube.texture, cube.adjacency, &params, &made) ==
            SLV_OK);
    CHECK(slv_gl_texture_upload(made, &env, UINT64_MAX, NULL) == SLV_ERROR_CANCELLED);
    CHECK(slv_gl_texture_upload(made, &env, UINT64_MAX, NULL) == SLV_ERROR_ARGUMENT);
    CHECK(lines == 2);
    slv_gl_texture_destroy(made);
}

static void check_refused(void) {
    static const char *const wrong[] = {
        "", "1a", "a-b", "gl_x", "a__b", "_a", "abcdefghijklmnopqrstuvwxyz_abcdefg"};
    slv_env quiet = {0};
    slv_gl_texture *made = NULL;
    enum { PREFIXES = sizeof wrong / sizeof *wrong };
    for (size_t i = 0; i < PREFIXES + 5; i++) {
        slv_gl_texture_params params = {KIT_ONLY(slv_strategy_find("clamp"))};
        if (i < PREFIXES)
            params.prefix = wrong[i];
        params.first_unit = i == PREFIXES ? 10000 : 0;
        params.first_storage = i == PREFIXES + 1 ? UINT32_MAX : 0;
        params.compression = i == PREFIXES + 2 ? (slv_gl_compression)2 : SLV_GL_COMPRESSION_NONE;
        params.taps = i == PREFIXES + 3 ? (slv_gl_taps)3 : SLV_GL_TAPS_AUTO;
        params.branching = i == PREFIXES + 4 ? (slv_gl_branching)3 : SLV_GL_BRANCHING_AUTO;
        CHECK(slv_gl_texture_create(gl, &quiet, cube.texture, cube.adjacency, &params, &made) ==
              SLV_ERROR_ARGUMENT);
        CHECK(!made);
    }
}

int main(void) {
    slv_env env = test_env();
    uint64_t random = 3;
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    load();
    kit_cube(&cube, &random);
    kit_equal(&cube, 4);
    kit_noise(&cube, SLV_TYPE_HALF, 3, &random);
    check_two(slv_strategy_find("borders"), slv_strategy_find("traverse"));
    check_two(slv_strategy_find("htex"), slv_strategy_find("borders"));
    for (uint32_t face = 0; face < cube.nfaces; face++) {
        static const uint16_t halves[3] = {0x3400, 0x3800, 0x3a00};
        REQUIRE(slv_texture_set_constant(cube.texture, face, halves) == SLV_OK);
    }
    for (uint32_t i = 0; i < slv_strategy_count(); i++)
        check_taps(slv_strategy_at(i));
    check_refused();
    check_states();
    check_cancelled();
    check_elsewhere(); /* other contexts are current from here on */
    check_gone_elsewhere();
    kit_free(&cube);
    slv_gl_destroy(gl);
    return test_end();
}
