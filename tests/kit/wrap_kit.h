/* A stranger's program around selvage_wrap.glsl: tubes and tori of triangles, with one texture
 * coordinate a vertex or with the vertices of their seams twice, drawn by OpenGL and nothing else.
 */
#ifndef SLV_TEST_WRAP_KIT_H
#define SLV_TEST_WRAP_KIT_H

#include <selvage/camera.h>
#include <selvage/gl_context.h>
#include <selvage/image.h>

#include <GL/glcorearb.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WRAP_AROUND = 32, WRAP_ACROSS = 20 };
#define WRAP_RING 1.0 /* of a torus */
#define WRAP_PIPE 0.45

#define WRAP_FUNCTIONS(X)                                                                          \
    X(PFNGLATTACHSHADERPROC, AttachShader)                                                         \
    X(PFNGLBINDBUFFERPROC, BindBuffer)                                                             \
    X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                                                   \
    X(PFNGLBINDTEXTUREUNITPROC, BindTextureUnit)                                                   \
    X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                                                   \
    X(PFNGLBLITNAMEDFRAMEBUFFERPROC, BlitNamedFramebuffer)                                         \
    X(PFNGLCHECKNAMEDFRAMEBUFFERSTATUSPROC, CheckNamedFramebufferStatus)                           \
    X(PFNGLCLEARNAMEDFRAMEBUFFERFVPROC, ClearNamedFramebufferfv)                                   \
    X(PFNGLCOMPILESHADERPROC, CompileShader)                                                       \
    X(PFNGLCREATEBUFFERSPROC, CreateBuffers)                                                       \
    X(PFNGLCREATEFRAMEBUFFERSPROC, CreateFramebuffers)                                             \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram)                                                       \
    X(PFNGLCREATERENDERBUFFERSPROC, CreateRenderbuffers)                                           \
    X(PFNGLCREATESHADERPROC, CreateShader)                                                         \
    X(PFNGLCREATETEXTURESPROC, CreateTextures)                                                     \
    X(PFNGLCREATEVERTEXARRAYSPROC, CreateVertexArrays)                                             \
    X(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                                                       \
    X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)                                             \
    X(PFNGLDELETEPROGRAMPROC, DeleteProgram)                                                       \
    X(PFNGLDELETERENDERBUFFERSPROC, DeleteRenderbuffers)                                           \
    X(PFNGLDELETESHADERPROC, DeleteShader)                                                         \
    X(PFNGLDELETETEXTURESPROC, DeleteTextures)                                                     \
    X(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)                                             \
    X(PFNGLDRAWELEMENTSPROC, DrawElements)                                                         \
    X(PFNGLENABLEPROC, Enable)                                                                     \
    X(PFNGLENABLEVERTEXARRAYATTRIBPROC, EnableVertexArrayAttrib)                                   \
    X(PFNGLFINISHPROC, Finish)                                                                     \
    X(PFNGLGENERATETEXTUREMIPMAPPROC, GenerateTextureMipmap)                                       \
    X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                                                         \
    X(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog)                                                 \
    X(PFNGLLINKPROGRAMPROC, LinkProgram)                                                           \
    X(PFNGLNAMEDBUFFERSTORAGEPROC, NamedBufferStorage)                                             \
    X(PFNGLNAMEDFRAMEBUFFERRENDERBUFFERPROC, NamedFramebufferRenderbuffer)                         \
    X(PFNGLNAMEDRENDERBUFFERSTORAGEMULTISAMPLEPROC, NamedRenderbufferStorageMultisample)           \
    X(PFNGLPROGRAMUNIFORM1FPROC, ProgramUniform1f)                                                 \
    X(PFNGLPROGRAMUNIFORM2FPROC, ProgramUniform2f)                                                 \
    X(PFNGLPROGRAMUNIFORMMATRIX4FVPROC, ProgramUniformMatrix4fv)                                   \
    X(PFNGLREADPIXELSPROC, ReadPixels)                                                             \
    X(PFNGLSHADERSOURCEPROC, ShaderSource)                                                         \
    X(PFNGLTEXTUREPARAMETERFPROC, TextureParameterf)                                               \
    X(PFNGLTEXTUREPARAMETERIPROC, TextureParameteri)                                               \
    X(PFNGLTEXTURESTORAGE2DPROC, TextureStorage2D)                                                 \
    X(PFNGLTEXTURESUBIMAGE2DPROC, TextureSubImage2D)                                               \
    X(PFNGLUSEPROGRAMPROC, UseProgram)                                                             \
    X(PFNGLVERTEXARRAYATTRIBBINDINGPROC, VertexArrayAttribBinding)                                 \
    X(PFNGLVERTEXARRAYATTRIBFORMATPROC, VertexArrayAttribFormat)                                   \
    X(PFNGLVERTEXARRAYELEMENTBUFFERPROC, VertexArrayElementBuffer)                                 \
    X(PFNGLVERTEXARRAYVERTEXBUFFERPROC, VertexArrayVertexBuffer)                                   \
    X(PFNGLVIEWPORTPROC, Viewport)
static struct {
#define WRAP_MEMBER(type, name) type name;
    WRAP_FUNCTIONS(WRAP_MEMBER)
#undef WRAP_MEMBER
} wrap_api;

static inline void wrap_stop(const char *what) {
    fprintf(stderr, "%s\n", what);
    exit(1);
}

static inline void *wrap_room(size_t count, size_t size) {
    void *room = calloc(count ? count : 1, size);
    if (!room)
        wrap_stop("no memory");
    return room;
}

static inline void wrap_load(const slv_gl *gl) {
#define WRAP_LOAD(type, name)                                                                      \
    if (!(wrap_api.name = (type)slv_gl_get_function(gl, "gl" #name)))                              \
        wrap_stop("the driver lacks gl" #name);
    WRAP_FUNCTIONS(WRAP_LOAD)
#undef WRAP_LOAD
}

/* The text of the include, of the tree that $SELVAGE_TESTS is in, or of this one. For free(). */
static inline char *wrap_include(void) {
    enum { MOST = 1 << 16 };
    const char *tests = getenv("SELVAGE_TESTS");
    char path[600], *text = wrap_room(MOST, 1);
    snprintf(path, sizeof path, "%s/../shaders/wrap/selvage_wrap.glsl", tests ? tests : "tests");
    FILE *file = fopen(path, "r");
    if (!file || !fread(text, 1, MOST - 1, file))
        wrap_stop("shaders/wrap/selvage_wrap.glsl cannot be read");
    fclose(file);
    return text;
}

/* Quads of two triangles each, around fastest. */
typedef struct wrap_mesh {
    uint32_t nverts, nquads, columns, rows;
    bool torus;
    float *positions, *uv; /* per vertex 3 and 2 */
    uint32_t *indices;     /* 6 per quad */
} wrap_mesh;

/* `phase` turns the map, so that it ends between vertices. */
static inline wrap_mesh wrap_make(bool torus, bool twice, uint32_t columns, uint32_t rows,
                                  double phase) {
    uint32_t width = columns + twice, height = torus && !twice ? rows : rows + 1;
    wrap_mesh m = {.nverts = width * height,
                   .nquads = columns * rows,
                   .columns = columns,
                   .rows = rows,
                   .torus = torus};
    m.positions = wrap_room(m.nverts, 3 * sizeof(float));
    m.uv = wrap_room(m.nverts, 2 * sizeof(float));
    m.indices = wrap_room(m.nquads, 6 * sizeof(uint32_t));
    for (uint32_t i = 0; i < m.nverts; i++) {
        uint32_t x = i % width, y = i / width;
        double u = (double)x / columns + phase, v = (double)y / rows;
        double a = 6.283185307179586 * (x % columns) / columns, radius = 0.7, up = 2 * v - 1;
        if (torus) {
            double b = 6.283185307179586 * (y % rows) / rows;
            radius = WRAP_RING + WRAP_PIPE * cos(b);
            up = WRAP_PIPE * sin(b);
            v += phase;
        }
        m.positions[3 * i] = (float)(radius * sin(a));
        m.positions[3 * i + 1] = (float)up;
        m.positions[3 * i + 2] = (float)(radius * cos(a));
        m.uv[2 * i] = (float)(twice ? u : u - floor(u));
        m.uv[2 * i + 1] = (float)(twice || !torus ? v : v - floor(v));
    }
    for (uint32_t q = 0; q < m.nquads; q++) {
        uint32_t x = q % columns, y = q / columns, x1 = (x + 1) % width, y1 = (y + 1) % height;
        uint32_t a = y * width + x, b = y * width + x1, c = y1 * width + x1, d = y1 * width + x;
        const uint32_t six[6] = {a, b, c, a, c, d};
        memcpy(m.indices + 6 * q, six, sizeof six);
    }
    return m;
}

static inline void wrap_free(wrap_mesh *m) {
    free(m->positions);
    free(m->uv);
    free(m->indices);
}

/* A mesh in the driver's memory. */
typedef struct wrap_buffers {
    GLuint buffers[3], array;
    GLsizei count;
    bool torus;
    float turn; /* of its coordinates against the texture, which TURNED programs take back */
} wrap_buffers;

static inline wrap_buffers wrap_upload(const wrap_mesh *m) {
    wrap_buffers b = {.count = (GLsizei)(6 * m->nquads), .torus = m->torus};
    wrap_api.CreateBuffers(3, b.buffers);
    wrap_api.CreateVertexArrays(1, &b.array);
    wrap_api.NamedBufferStorage(b.buffers[0], m->nverts * 3 * (GLsizeiptr)sizeof(float),
                                m->positions, 0);
    wrap_api.NamedBufferStorage(b.buffers[1], m->nverts * 2 * (GLsizeiptr)sizeof(float), m->uv, 0);
    wrap_api.NamedBufferStorage(b.buffers[2], m->nquads * 6 * (GLsizeiptr)sizeof(uint32_t),
                                m->indices, 0);
    wrap_api.VertexArrayElementBuffer(b.array, b.buffers[2]);
    for (GLuint i = 0; i < 2; i++) {
        GLint size = i ? 2 : 3;
        wrap_api.VertexArrayVertexBuffer(b.array, i, b.buffers[i], 0,
                                         size * (GLsizei)sizeof(float));
        wrap_api.EnableVertexArrayAttrib(b.array, i);
        wrap_api.VertexArrayAttribFormat(b.array, i, size, GL_FLOAT, GL_FALSE, 0);
        wrap_api.VertexArrayAttribBinding(b.array, i, i);
    }
    return b;
}

static inline void wrap_discard(wrap_buffers *b) {
    wrap_api.DeleteBuffers(3, b->buffers);
    wrap_api.DeleteVertexArrays(1, &b->array);
}

/* What main does is chosen by defines. */
static const char wrap_vertex[] =
    "layout(location = 0) in vec3 position;\n"
    "layout(location = 1) in vec2 uv;\n"
    "layout(location = 0) uniform mat4 to_clip;\n"
    "out vec2 plain_uv;\n"
    "out vec4 round_uv;\n"
    "out vec3 place;\n"
    "void main() {\n"
    "    vec2 at = uv;\n"
    "#ifdef MADE\n"
    "    at.x = atan(position.x, position.z) / 6.283185307;\n"
    "#ifdef TORUS\n"
    "    at.y = atan(position.y, length(position.xz) - 1.0) / 6.283185307;\n"
    "#endif\n"
    "#endif\n"
    "    plain_uv = at;\n"
    "#ifndef PLAIN\n"
    "    round_uv = slv_wrap_pair(at);\n"
    "#endif\n"
    "    place = position;\n"
    "    gl_Position = to_clip * vec4(position, 1.0);\n"
    "}\n";
static const char wrap_fragment[] =
    "layout(binding = 0) uniform sampler2D map;\n"
    "layout(location = 1) uniform float times;\n"
    "layout(location = 2) uniform float taps;\n"
    "layout(location = 3) uniform vec2 turn;\n"
    "in vec2 plain_uv;\n"
    "in vec4 round_uv;\n"
    "in vec3 place;\n"
    "layout(location = 0) out vec4 color;\n"
    "#ifdef TURNED\n"
    "#define PLACE(at) ((at)-turn)\n"
    "#else\n"
    "#define PLACE(at) (at)\n"
    "#endif\n"
    /* the footprint as a row of short ones, which software drivers lack */
    "vec4 look(vec2 at, vec2 dx, vec2 dy) {\n"
    "    if (taps <= 1.0)\n"
    "        return textureGrad(map, PLACE(at), dx, dy);\n"
    "    vec2 size = vec2(textureSize(map, 0));\n"
    "    float px = length(dx * size), py = length(dy * size), longest = max(px, py);\n"
    "    float n = clamp(longest / max(min(px, py), 1e-12), 1.0, taps);\n"
    "    vec2 axis = (px > py ? dx : dy) * (1.0 - 1.0 / n);\n" /* at a tie either is as good */
    "    vec4 sum = vec4(0.0);\n"
    "    for (float k = 1.0; k <= taps; k++)\n"
    "        sum += textureLod(map, PLACE(at + axis * (k / (taps + 1.0) - 0.5)),\n"
    "                          log2(longest / n));\n"
    "    return sum / taps;\n"
    "}\n"
    "vec4 look(vec2 at) {\n"
    "    return taps <= 1.0 ? texture(map, PLACE(at)) : look(at, dFdx(at), dFdy(at));\n"
    "}\n"
    "void main() {\n"
    "#ifdef PLAIN\n"
    "    vec2 at = vec2(times, 1.0) * plain_uv;\n"
    "#ifdef GRADIENTS\n"
    "    color = look(at, dFdx(at), dFdy(at));\n"
    "#else\n"
    "    color = look(at);\n"
    "#endif\n"
    "#else\n"
    "#ifdef TORUS\n"
    "    vec3 v = slv_wrap_grad(round_uv.zw);\n"
    "#else\n"
    "    vec3 v = vec3(plain_uv.y, dFdx(plain_uv.y), dFdy(plain_uv.y));\n"
    "#endif\n"
    "#if defined(GRADIENTS)\n"
    "    vec3 u = slv_wrap_grad(round_uv.xy) * times;\n"
    "    color = look(vec2(u.x, v.x), vec2(u.y, v.y), vec2(u.z, v.z));\n"
    "#elif defined(TANGENTS)\n"
    "    color = vec4(slv_wrap_tangent(place, slv_wrap_grad(round_uv.xy), v), 1.0);\n"
    "#elif defined(ANGLE)\n"
    "    float u = atan(ANGLE place.x, ANGLE place.z) / 6.283185307 + (ANGLE 0.25) + 0.25;\n"
    "    color = look(vec2(slv_wrap(slv_wrap_pair(u)), v.x));\n"
    "#elif defined(TORUS)\n"
    "    color = look(vec2(times, 1.0) * slv_wrap(round_uv));\n"
    "#else\n"
    "    color = look(vec2(times * slv_wrap(round_uv.xy), plain_uv.y));\n"
    "#endif\n"
    "#endif\n"
    "    color.a = 1.0;\n"
    "}\n";

/* The include stands before main, with what main does chosen before it. */
static inline GLuint wrap_link(const char *version, const char *include, const char *defines,
                               const char *vertex, const char *fragment) {
    GLuint program = wrap_api.CreateProgram();
    GLint fine = 0;
    for (int stage = 0; stage < 2; stage++) {
        const char *texts[] = {version, defines, stage ? "#define SLV_WRAP_FRAGMENT\n" : "",
                               include, stage ? fragment : vertex};
        GLuint shader = wrap_api.CreateShader(stage ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
        char log[1024] = "";
        wrap_api.ShaderSource(shader, 5, texts, NULL);
        wrap_api.CompileShader(shader);
        wrap_api.GetShaderInfoLog(shader, sizeof log, NULL, log);
        if (log[0])
            fprintf(stderr, "%s\n", log);
        wrap_api.AttachShader(program, shader);
        wrap_api.DeleteShader(shader);
    }
    wrap_api.LinkProgram(program);
    wrap_api.GetProgramiv(program, GL_LINK_STATUS, &fine);
    if (!fine)
        wrap_stop("the program does not link");
    return program;
}

static inline GLuint wrap_program(const char *include, const char *defines) {
    return wrap_link("#version 450 core\n", include, defines, wrap_vertex, wrap_fragment);
}

/* RGB floats, row 0 at v = 0, as a texture that repeats. */
static inline GLuint wrap_texture(const float *rgb, uint32_t width, uint32_t height) {
    GLuint texture;
    GLsizei levels = 1;
    while (width >> levels || height >> levels)
        levels++;
    wrap_api.CreateTextures(GL_TEXTURE_2D, 1, &texture);
    wrap_api.TextureStorage2D(texture, levels, GL_RGBA32F, (GLsizei)width, (GLsizei)height);
    wrap_api.TextureSubImage2D(texture, 0, 0, 0, (GLsizei)width, (GLsizei)height, GL_RGB, GL_FLOAT,
                               rgb);
    wrap_api.GenerateTextureMipmap(texture);
    wrap_api.TextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_REPEAT);
    wrap_api.TextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_REPEAT);
    wrap_api.TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    return texture;
}

typedef struct wrap_target {
    GLuint framebuffers[2], renderbuffers[3];
    GLsizei size, msaa;
    uint32_t parts; /* pictures, since the driver has too few samples for one */
} wrap_target;

static inline wrap_target wrap_target_make(const slv_gl *gl, uint32_t size, uint32_t msaa) {
    uint32_t most = slv_gl_get_info(gl)->max_msaa, each = msaa < most ? msaa : most;
    wrap_target t = {.size = (GLsizei)size,
                     .msaa = each > 1 ? (GLsizei)each : 0,
                     .parts = each > 1 ? msaa / each : msaa};
    wrap_api.CreateFramebuffers(2, t.framebuffers);
    wrap_api.CreateRenderbuffers(3, t.renderbuffers);
    for (int i = 0; i < 3; i++)
        wrap_api.NamedRenderbufferStorageMultisample(t.renderbuffers[i], i == 1 ? 0 : t.msaa,
                                                     i < 2 ? GL_RGBA32F : GL_DEPTH_COMPONENT32F,
                                                     t.size, t.size);
    for (int i = 0; i < 2; i++)
        wrap_api.NamedFramebufferRenderbuffer(t.framebuffers[i], GL_COLOR_ATTACHMENT0,
                                              GL_RENDERBUFFER, t.renderbuffers[i]);
    wrap_api.NamedFramebufferRenderbuffer(t.framebuffers[0], GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
                                          t.renderbuffers[2]);
    if (wrap_api.CheckNamedFramebufferStatus(t.framebuffers[0], GL_FRAMEBUFFER) !=
        GL_FRAMEBUFFER_COMPLETE)
        wrap_stop("the driver makes no such target");
    return t;
}

static inline void wrap_target_free(wrap_target *t) {
    wrap_api.DeleteFramebuffers(2, t->framebuffers);
    wrap_api.DeleteRenderbuffers(3, t->renderbuffers);
}

/* Column-major, for things within 2 of the origin. */
static inline void wrap_matrix(const slv_camera *camera, float out[16]) {
    static const float low[3] = {-2, -2, -2}, high[3] = {2, 2, 2};
    const float *w = camera->window, *m = camera->world_to_camera;
    float n, f, p[16] = {0};
    slv_camera_depths(camera, low, high, &n, &f);
    p[0] = 2 / (w[1] - w[0]);
    p[5] = 2 / (w[3] - w[2]);
    if (camera->perspective) {
        p[2] = (w[1] + w[0]) / (w[1] - w[0]);
        p[6] = (w[3] + w[2]) / (w[3] - w[2]);
        p[10] = (n + f) / (n - f);
        p[11] = 2 * n * f / (n - f);
        p[14] = -1;
    } else {
        p[3] = -(w[1] + w[0]) / (w[1] - w[0]);
        p[7] = -(w[3] + w[2]) / (w[3] - w[2]);
        p[10] = 2 / (n - f);
        p[11] = (n + f) / (n - f);
        p[15] = 1;
    }
    for (int r = 0; r < 4; r++)
        for (int c = 0; c < 4; c++) {
            out[4 * c + r] = 0;
            for (int k = 0; k < 4; k++)
                out[4 * c + r] += p[4 * r + k] * m[4 * k + c];
        }
}

static inline void wrap_draw(const wrap_target *t, GLuint program, GLuint texture,
                             const wrap_buffers *mesh, const slv_camera *camera, float times) {
    static const float nothing[4] = {0}, far_away = 1;
    float matrix[16];
    wrap_matrix(camera, matrix);
    wrap_api.BindFramebuffer(GL_FRAMEBUFFER, t->framebuffers[0]);
    wrap_api.Viewport(0, 0, t->size, t->size);
    wrap_api.Enable(GL_DEPTH_TEST);
    wrap_api.ClearNamedFramebufferfv(t->framebuffers[0], GL_COLOR, 0, nothing);
    wrap_api.ClearNamedFramebufferfv(t->framebuffers[0], GL_DEPTH, 0, &far_away);
    wrap_api.ProgramUniformMatrix4fv(program, 0, 1, GL_FALSE, matrix);
    wrap_api.ProgramUniform1f(program, 1, times);
    wrap_api.ProgramUniform2f(program, 3, mesh->turn, mesh->torus ? mesh->turn : 0);
    wrap_api.UseProgram(program);
    wrap_api.BindTextureUnit(0, texture);
    wrap_api.BindVertexArray(mesh->array);
    wrap_api.DrawElements(GL_TRIANGLES, mesh->count, GL_UNSIGNED_INT, NULL);
}

/* By the sampler on hardware, else by the program. */
static inline void wrap_anisotropy(const slv_gl *gl, GLuint texture, GLuint program, float taps) {
    bool own = slv_gl_get_info(gl)->software;
    wrap_api.TextureParameterf(texture, GL_TEXTURE_MAX_ANISOTROPY, own ? 1 : taps);
    wrap_api.ProgramUniform1f(program, 2, own ? taps : 1);
}

/* What was drawn, RGBA, row 0 at the top. */
static inline void wrap_read(const wrap_target *t, float *rgba) {
    size_t row = 4 * (size_t)t->size;
    wrap_api.BlitNamedFramebuffer(t->framebuffers[0], t->framebuffers[1], 0, 0, t->size, t->size, 0,
                                  0, t->size, t->size, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    wrap_api.BindFramebuffer(GL_READ_FRAMEBUFFER, t->framebuffers[1]);
    for (GLsizei y = 0; y < t->size; y++)
        wrap_api.ReadPixels(0, y, t->size, 1, GL_RGBA, GL_FLOAT,
                            rgba + (size_t)(t->size - 1 - y) * row);
}

/* Drawn and read; the mean of several pictures, apart by less than their samples are, where the
 * driver has fewer samples. */
static inline void wrap_picture(const wrap_target *t, GLuint program, GLuint texture,
                                const wrap_buffers *mesh, const slv_camera *camera, float times,
                                float *rgba) {
    size_t count = 4 * (size_t)t->size * (size_t)t->size;
    float *part = wrap_room(count, sizeof *part);
    memset(rgba, 0, count * sizeof *rgba);
    for (uint32_t k = 0; k < t->parts; k++) {
        slv_camera moved = *camera;
        float along = (2 * (float)k + 1 - (float)t->parts) / (8 * (float)t->parts);
        for (int i = 0; i < 4; i++)
            moved.window[i] +=
                along * (camera->window[i | 1] - camera->window[i & 2]) / (float)t->size;
        wrap_draw(t, program, texture, mesh, &moved, times);
        wrap_read(t, part);
        for (size_t i = 0; i < count; i++)
            rgba[i] += part[i] / (float)t->parts;
    }
    free(part);
}

#endif
