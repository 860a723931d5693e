/* How many draws, calls of OpenGL's and pieces of memory a frame takes where neighbours seldom have
 * texels of one size: 100,000 faces of 16 random resolutions, with every strategy. The renderer's
 * context is a host's whose functions count. */
#include "kit/mesh_shapes.h"
#include "kit/strategy_kit.h"

#include "gl/context/api.h"

#include <selvage/gl_renderer.h>

#ifdef __SANITIZE_ADDRESS__
enum { COLUMNS = 100, ROWS = 100 };
#else
enum { COLUMNS = 400, ROWS = 250 };
#endif

static slv_gl_api real;
static uint64_t calls, draws, pieces;

static void *allocate(void *user, size_t bytes) {
    (void)user;
    pieces++;
    return malloc(bytes);
}

static void release(void *user, void *memory) {
    (void)user;
    free(memory);
}

/* Whose memory is counted. */
static slv_env counting_env(void) {
    slv_env env = test_env();
    env.allocate = allocate;
    env.release = release;
    return env;
}

/* Functions that a frame may call. */
#define COUNTED(X)                                                                                 \
    X(BindFramebuffer, (GLenum a, GLuint b), (a, b))                                               \
    X(Viewport, (GLint a, GLint b, GLsizei c, GLsizei d), (a, b, c, d))                            \
    X(Enable, (GLenum a), (a))                                                                     \
    X(Disable, (GLenum a), (a))                                                                    \
    X(PixelStorei, (GLenum a, GLint b), (a, b))                                                    \
    X(BindBuffer, (GLenum a, GLuint b), (a, b))                                                    \
    X(ClipControl, (GLenum a, GLenum b), (a, b))                                                   \
    X(PolygonMode, (GLenum a, GLenum b), (a, b))                                                   \
    X(PointSize, (GLfloat a), (a))                                                                 \
    X(DepthRangef, (GLfloat a, GLfloat b), (a, b))                                                 \
    X(DepthFunc, (GLenum a), (a))                                                                  \
    X(DepthMask, (GLboolean a), (a))                                                               \
    X(ColorMask, (GLboolean a, GLboolean b, GLboolean c, GLboolean d), (a, b, c, d))               \
    X(ClearNamedFramebufferfv, (GLuint a, GLenum b, GLint c, const GLfloat *d), (a, b, c, d))      \
    X(BindVertexArray, (GLuint a), (a))                                                            \
    X(UseProgram, (GLuint a), (a))                                                                 \
    X(ProgramUniform1i, (GLuint a, GLint b, GLint c), (a, b, c))                                   \
    X(ProgramUniform2f, (GLuint a, GLint b, GLfloat c, GLfloat d), (a, b, c, d))                   \
    X(ProgramUniformMatrix3fv, (GLuint a, GLint b, GLsizei c, GLboolean d, const GLfloat *e),      \
      (a, b, c, d, e))                                                                             \
    X(ProgramUniformMatrix4fv, (GLuint a, GLint b, GLsizei c, GLboolean d, const GLfloat *e),      \
      (a, b, c, d, e))                                                                             \
    X(BindTextures, (GLuint a, GLsizei b, const GLuint *c), (a, b, c))                             \
    X(GetObjectLabel, (GLenum a, GLuint b, GLsizei c, GLsizei * d, GLchar * e), (a, b, c, d, e))   \
    X(BindSamplers, (GLuint a, GLsizei b, const GLuint *c), (a, b, c))                             \
    X(BindBuffersRange,                                                                            \
      (GLenum a, GLuint b, GLsizei c, const GLuint *d, const GLintptr *e, const GLsizeiptr *f),    \
      (a, b, c, d, e, f))

#define COUNT(name, parameters, arguments)                                                         \
    static void APIENTRY count_##name parameters {                                                 \
        calls++;                                                                                   \
        real.name arguments;                                                                       \
    }
COUNTED(COUNT)

static void APIENTRY count_MultiDrawElements(GLenum mode, const GLsizei *counts, GLenum type,
                                             const void *const *at, GLsizei ndraws) {
    /* Nothing is drawn: a software driver would compile a program for each set of arrays. */
    (void)mode, (void)type, (void)at;
    calls++;
    draws += ndraws > 0 && counts[0] > 0;
}

static GLboolean APIENTRY count_IsTextureHandleResidentARB(GLuint64 handle) {
    calls++;
    return real.IsTextureHandleResidentARB(handle);
}

static GLenum APIENTRY count_GetError(void) {
    calls++;
    return real.GetError();
}

static GLboolean APIENTRY count_IsRenderbuffer(GLuint name) {
    calls++;
    return real.IsRenderbuffer(name);
}

static void APIENTRY uncounted(void) {
    REQUIRE(!"a frame calls a function that this test does not count");
}

static slv_gl_proc counted(const char *name) {
#define NAMED(function, parameters, arguments)                                                     \
    if (strcmp(name, "gl" #function) == 0)                                                         \
        return (slv_gl_proc)count_##function;
    COUNTED(NAMED)
#undef NAMED
    if (strcmp(name, "glMultiDrawElements") == 0)
        return (slv_gl_proc)count_MultiDrawElements;
    if (strcmp(name, "glIsTextureHandleResidentARB") == 0)
        return (slv_gl_proc)count_IsTextureHandleResidentARB;
    if (strcmp(name, "glIsRenderbuffer") == 0)
        return (slv_gl_proc)count_IsRenderbuffer;
    return strcmp(name, "glGetError") == 0 ? (slv_gl_proc)count_GetError : NULL;
}

static slv_gl_proc get_proc(void *user, const char *name) {
    slv_gl_proc function = counted(name);
    return function ? function : slv_gl_get_function(user, name);
}

static slv_gl_proc get_trap(void *user, const char *name) {
    slv_gl_proc function = counted(name);
    (void)user;
    return function ? function : (slv_gl_proc)uncounted;
}

static void load(slv_gl_api *api, slv_gl_get_proc from, void *user) {
#define LOAD(type, name) api->name = (type)from(user, "gl" #name);
    SLV_GL_FUNCTIONS(LOAD)
    SLV_GL_HANDLE_FUNCTIONS(LOAD)
#undef LOAD
}

static slv_gl_proc get_real(void *user, const char *name) {
    return slv_gl_get_function(user, name);
}

static void count_frame(slv_gl *gl, slv_gl_renderer *renderer, slv_gl_texture *texture,
                        const slv_strategy *strategy, slv_gl_binding binding) {
    const float low[3] = {0, 0, -1}, high[3] = {COLUMNS, ROWS, 1};
    slv_env env = counting_env();
    slv_frame frame = {.width = 64, .height = 64, .strategy = strategy};
    slv_gl_api all = gl->api;
    frame.camera = slv_camera_orbit(low, high, 30, 20, 35, 1);
    slv_result result = slv_gl_renderer_draw(renderer, &env, texture, &frame, NULL, NULL);
    REQUIRE(result == SLV_OK); /* makes programs and lists of triangles */
    load(&gl->api, get_trap, NULL);
    calls = draws = pieces = 0;
    result = slv_gl_renderer_draw(renderer, &env, texture, &frame, NULL, NULL);
    REQUIRE(result == SLV_OK);
    gl->api = all;
    bool reaches = strategy->reach == SLV_GL_REACH_NEIGHBOURS;
    fprintf(stderr, "%-14s %-8s %4llu draws, %5llu calls\n", strategy->name,
            slv_gl_binding_name(binding), (unsigned long long)draws, (unsigned long long)calls);
    CHECK_MSG(pieces == 0, "%s: %llu pieces of memory", strategy->name, (unsigned long long)pieces);
    CHECK(draws ==
          (binding == SLV_GL_BINDING_HANDLES ? 1 : slv_gl_texture_batch_count(texture, strategy)));
    bool shares = strategy->packing == SLV_GL_PAGES; /* two types at most, in pages */
    CHECK_MSG(draws <= (reaches  ? 500
                        : shares ? 4
                                 : 100) &&
                  calls <= 6000,
              "%s: %llu draws, %llu calls", strategy->name, (unsigned long long)draws,
              (unsigned long long)calls);
}

/* A frame is timed within a host's own query of elapsed time, as on a driver that has a clock of
 * the GPU's. */
static void check_timed(slv_gl *host, slv_gl *gl, slv_gl_renderer *renderer,
                        slv_gl_texture *texture) {
    PFNGLBEGINQUERYPROC begin = (PFNGLBEGINQUERYPROC)get_real(host, "glBeginQuery");
    PFNGLENDQUERYPROC end = (PFNGLENDQUERYPROC)get_real(host, "glEndQuery");
    slv_env env = test_env();
    slv_frame frame = {.width = 64, .height = 64, .strategy = kit_strategy("clamp")};
    const float low[3] = {0, 0, -1}, high[3] = {COLUMNS, ROWS, 1};
    bool software = gl->info.software;
    double seconds = -1;
    GLuint query = 0;
    frame.camera = slv_camera_orbit(low, high, 30, 20, 35, 1);
    gl->info.software = false;
    real.CreateQueries(GL_TIME_ELAPSED, 1, &query);
    begin(GL_TIME_ELAPSED, query);
    CHECK(slv_gl_renderer_draw(renderer, &env, texture, &frame, NULL, &seconds) == SLV_OK);
    end(GL_TIME_ELAPSED);
    CHECK(real.GetError() == GL_NO_ERROR && seconds >= 0 && seconds < 3600);
    real.DeleteQueries(1, &query);
    gl->info.software = software;
}

static void check(slv_gl *host, slv_gl *gl) {
    uint64_t random = 3;
    slv_env env = counting_env();
    shape s = shape_grid(COLUMNS, ROWS, false, false);
    slv_surface *surface = NULL;
    slv_adjacency *adjacency = NULL;
    slv_texture *texels = NULL;
    slv_gl_renderer *renderer = NULL;
    slv_gl_texture *texture = NULL;
    const slv_strategy *list[KIT_STRATEGIES];
    slv_mesh *mesh = shape_mesh(&env, &s);
    uint32_t nfaces = slv_mesh_face_count(mesh);
    slv_res *res = malloc(nfaces * sizeof *res);
    REQUIRE(res);
    for (uint32_t f = 0; f < nfaces; f++)
        res[f] = (slv_res){(int8_t)(test_random(&random) % 4), (int8_t)(test_random(&random) % 4)};
    slv_texture_desc desc = {nfaces, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res, SLV_TEXTURE_LINEAR};
    slv_result result = slv_texture_create(&env, &desc, &texels);
    REQUIRE(result == SLV_OK);
    for (uint32_t f = 0; f < nfaces; f++) { /* faces of one value would have one texel */
        unsigned char values[3 << 6];
        for (size_t i = 0; i < sizeof values; i++)
            values[i] = (unsigned char)test_random(&random);
        result = slv_texture_set_face(texels, f, values);
        REQUIRE(result == SLV_OK);
    }
    result = slv_mesh_adjacency(&env, mesh, &adjacency);
    REQUIRE(result == SLV_OK);
    result = slv_surface_create(&env, mesh, NULL, &surface);
    REQUIRE(result == SLV_OK);
    result = slv_gl_renderer_create(gl, &env, mesh, surface, 2, &renderer);
    REQUIRE(result == SLV_OK);
    fprintf(stderr, "%u faces\n", nfaces);
    slv_gl_texture_params params = {.strategies = list};
    for (uint32_t k = 0; k < slv_strategy_count(); k++)
        list[params.nstrategies++] = slv_strategy_at(k);
    for (params.binding = SLV_GL_BINDING_UNITS;
         params.binding <= (gl->handles ? SLV_GL_BINDING_HANDLES : SLV_GL_BINDING_UNITS);
         params.binding++) {
        result = slv_gl_texture_create(gl, &env, texels, adjacency, &params, &texture);
        REQUIRE(result == SLV_OK);
        for (uint32_t k = 0; k < params.nstrategies; k++)
            count_frame(gl, renderer, texture, list[k], params.binding);
        check_timed(host, gl, renderer, texture);
        slv_gl_texture_destroy(texture);
    }
    slv_gl_renderer_destroy(renderer);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_texture_destroy(texels);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
    free(res);
}

int main(void) {
    slv_env env = test_env();
    slv_gl *context = NULL, *gl = NULL;
    slv_result result = slv_gl_create(&env, SLV_GL_AUTO, &context);
    REQUIRE(result == SLV_OK);
    load(&real, get_real, context);
    result = slv_gl_wrap(&env, get_proc, context, &gl);
    REQUIRE(result == SLV_OK);
    check(context, gl);
    slv_gl_destroy(gl);
    slv_gl_destroy(context);
    return test_end();
}
