/* Per-face textures in a renderer of your own: your shaders, your framebuffer, your draw calls.
 *
 *   cc sample_in_your_shader.c $(pkg-config --cflags --libs selvage-gl) -o sample
 *   ./sample teapot.ptx teapot.png traverse
 *
 * The .ptx must hold its geometry, as files written with a mesh do. The steps that matter are
 * numbered. */
#include <selvage/selvage.h>

#include <GL/glcorearb.h>

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 512, SEGMENTS = 8 }; /* each face is drawn as 8 x 8 quads */

/* The functions that this program calls itself. An application has these from its own loader. */
#define FUNCTIONS(X)                                                                               \
    X(PFNGLCREATESHADERPROC, CreateShader)                                                         \
    X(PFNGLSHADERSOURCEPROC, ShaderSource)                                                         \
    X(PFNGLCOMPILESHADERPROC, CompileShader)                                                       \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram)                                                       \
    X(PFNGLATTACHSHADERPROC, AttachShader)                                                         \
    X(PFNGLLINKPROGRAMPROC, LinkProgram)                                                           \
    X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                                                         \
    X(PFNGLUSEPROGRAMPROC, UseProgram)                                                             \
    X(PFNGLDELETESHADERPROC, DeleteShader)                                                         \
    X(PFNGLDELETEPROGRAMPROC, DeleteProgram)                                                       \
    X(PFNGLUNIFORMMATRIX4FVPROC, UniformMatrix4fv)                                                 \
    X(PFNGLGENBUFFERSPROC, GenBuffers)                                                             \
    X(PFNGLBINDBUFFERPROC, BindBuffer)                                                             \
    X(PFNGLBUFFERDATAPROC, BufferData)                                                             \
    X(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)                                                   \
    X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                                                   \
    X(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray)                                   \
    X(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer)                                           \
    X(PFNGLVERTEXATTRIBIPOINTERPROC, VertexAttribIPointer)                                         \
    X(PFNGLDRAWARRAYSPROC, DrawArrays)                                                             \
    X(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)                                                   \
    X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                                                   \
    X(PFNGLGENRENDERBUFFERSPROC, GenRenderbuffers)                                                 \
    X(PFNGLBINDRENDERBUFFERPROC, BindRenderbuffer)                                                 \
    X(PFNGLRENDERBUFFERSTORAGEPROC, RenderbufferStorage)                                           \
    X(PFNGLFRAMEBUFFERRENDERBUFFERPROC, FramebufferRenderbuffer)                                   \
    X(PFNGLVIEWPORTPROC, Viewport)                                                                 \
    X(PFNGLCLEARPROC, Clear)                                                                       \
    X(PFNGLENABLEPROC, Enable)                                                                     \
    X(PFNGLREADPIXELSPROC, ReadPixels)                                                             \
    X(PFNGLGETERRORPROC, GetError)
static struct {
#define MEMBER(type, name) type name;
    FUNCTIONS(MEMBER)
} gl;

typedef struct vertex {
    float position[3], uv[2];
    int32_t face;
} vertex;

/* 1. The vertex shader hands on the face id, flat, and the coordinates in that face. */
static const char vertex_text[] = "#version 450 core\n"
                                  "layout(location = 0) in vec3 position;\n"
                                  "layout(location = 1) in vec2 uv;\n"
                                  "layout(location = 2) in int face;\n"
                                  "layout(location = 0) uniform mat4 to_clip;\n"
                                  "out vec2 face_uv;\n"
                                  "flat out int face_id;\n"
                                  "void main() {\n"
                                  "    face_uv = uv;\n"
                                  "    face_id = face;\n"
                                  "    gl_Position = to_clip * vec4(position, 1.0);\n"
                                  "}\n";

/* 2. The fragment shader calls slv_sample, whose text stands between the version line and this. */
static const char fragment_text[] = "in vec2 face_uv;\n"
                                    "flat in int face_id;\n"
                                    "out vec4 color;\n"
                                    "void main() {\n"
                                    "    color = vec4(slv_sample(face_id, face_uv).rgb, 1.0);\n"
                                    "}\n";

static GLuint shader(GLenum stage, int count, const char *const *texts) {
    GLuint made = gl.CreateShader(stage);
    gl.ShaderSource(made, count, texts, NULL);
    gl.CompileShader(made);
    return made;
}

/* 0 if it does not link. */
static GLuint program(const char *lookups) {
    const char *vertex_texts[] = {vertex_text};
    const char *fragment_texts[] = {"#version 450 core\n", lookups, fragment_text};
    GLuint made = gl.CreateProgram(), shaders[2];
    GLint linked = 0;
    shaders[0] = shader(GL_VERTEX_SHADER, 1, vertex_texts);
    shaders[1] = shader(GL_FRAGMENT_SHADER, 3, fragment_texts);
    for (int i = 0; i < 2; i++) {
        gl.AttachShader(made, shaders[i]);
        gl.DeleteShader(shaders[i]);
    }
    gl.LinkProgram(made);
    gl.GetProgramiv(made, GL_LINK_STATUS, &linked);
    return linked ? made : 0;
}

/* Two triangles a quad, from the limit surface. Returns how many vertices. */
static size_t add_face(const slv_surface *surface, uint32_t face, vertex *out) {
    static float positions[(SEGMENTS + 1) * (SEGMENTS + 1) * 3];
    slv_surface_arrays arrays = {.positions = positions};
    size_t count = 0;
    if (slv_surface_evaluate_grid(surface, (int32_t)face, SEGMENTS, SEGMENTS, &arrays))
        return 0;
    for (uint32_t quad = 0; quad < SEGMENTS * SEGMENTS; quad++) {
        static const uint32_t corners[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
        for (int i = 0; i < 6; i++) {
            uint32_t x = quad % SEGMENTS + corners[i][0], y = quad / SEGMENTS + corners[i][1];
            vertex *v = &out[count++];
            memcpy(v->position, positions + 3 * (y * (SEGMENTS + 1) + x), sizeof v->position);
            v->uv[0] = (float)x / SEGMENTS;
            v->uv[1] = (float)y / SEGMENTS;
            v->face = (int32_t)face;
        }
    }
    return count;
}

/* Your own target, vertex layout and depth test; nothing of it concerns the library. */
static void set_up_drawing(const float box[2][3], float to_clip[16]) {
    GLuint names[2], framebuffer, array, buffer;
    gl.GenFramebuffers(1, &framebuffer);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl.GenRenderbuffers(2, names);
    for (int i = 0; i < 2; i++) {
        gl.BindRenderbuffer(GL_RENDERBUFFER, names[i]);
        gl.RenderbufferStorage(GL_RENDERBUFFER, i ? GL_DEPTH_COMPONENT24 : GL_RGBA16F, SIZE, SIZE);
        gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, i ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0,
                                   GL_RENDERBUFFER, names[i]);
    }
    gl.GenVertexArrays(1, &array);
    gl.BindVertexArray(array);
    gl.GenBuffers(1, &buffer);
    gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    for (GLuint i = 0; i < 3; i++)
        gl.EnableVertexAttribArray(i);
    gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(vertex),
                           (const void *)offsetof(vertex, position));
    gl.VertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, sizeof(vertex),
                           (const void *)offsetof(vertex, uv));
    gl.VertexAttribIPointer(2, 1, GL_INT, sizeof(vertex), (const void *)offsetof(vertex, face));
    gl.Viewport(0, 0, SIZE, SIZE);
    gl.Enable(GL_DEPTH_TEST);
    gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    /* seen from +z without perspective, the whole box in the picture; columns of the matrix one
     * after another */
    float half = 0;
    memset(to_clip, 0, 16 * sizeof *to_clip);
    for (int c = 0; c < 3; c++)
        half = box[1][c] - box[0][c] > 2 * half ? (box[1][c] - box[0][c]) / 2 : half;
    for (int c = 0; c < 3; c++) {
        to_clip[5 * c] = (c == 2 ? -0.9f : 0.9f) / half;
        to_clip[12 + c] = -(box[0][c] + box[1][c]) / 2 * to_clip[5 * c];
    }
    to_clip[15] = 1;
}

/* 5. Draws batch by batch: a batch is a set of faces whose textures can be bound together. */
static int draw(slv_gl_texture *texture, const slv_strategy *strategy, const slv_surface *surface,
                const float to_clip[16]) {
    GLuint programs[SLV_GL_MAX_VARIANTS] = {0};
    int failed = 0;
    for (uint32_t i = 0; !failed && i < slv_gl_texture_batch_count(texture, strategy); i++) {
        slv_gl_batch batch = slv_gl_texture_batch(texture, strategy, i);
        vertex *vertices =
            malloc((size_t)batch.nfaces * SEGMENTS * SEGMENTS * 6 * sizeof *vertices);
        size_t count = 0;
        for (uint32_t k = 0; vertices && k < batch.nfaces; k++)
            count += add_face(surface, batch.faces[k], vertices + count);
        const char *lookups = NULL;
        if (!programs[batch.variant] && /* a program for each variant that occurs, made once */
            !slv_gl_texture_glsl(texture, strategy, batch.variant, &lookups))
            programs[batch.variant] = program(lookups);
        failed = !vertices || !programs[batch.variant];
        if (!failed) {
            gl.UseProgram(programs[batch.variant]);
            gl.UniformMatrix4fv(0, 1, GL_FALSE, to_clip);
            slv_gl_texture_bind(texture, strategy, i); /* its array textures, samplers and tables */
            gl.BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(count * sizeof *vertices), vertices,
                          GL_STREAM_DRAW);
            gl.DrawArrays(GL_TRIANGLES, 0, (GLsizei)count);
        }
        free(vertices);
    }
    slv_gl_texture_unbind(texture); /* or its samplers would apply to what you draw next */
    for (int v = 0; v < SLV_GL_MAX_VARIANTS; v++)
        gl.DeleteProgram(programs[v]);
    return failed;
}

static int save(const slv_env *env, const char *path) {
    slv_image image = {0};
    if (slv_image_create(env, SIZE, SIZE, 4, &image))
        return 1;
    for (uint32_t y = 0; y < SIZE;
         y++) /* an image's first row is the highest, OpenGL's the lowest */
        gl.ReadPixels(0, (GLint)(SIZE - 1 - y), SIZE, 1, GL_RGBA, GL_FLOAT,
                      image.pixels + (size_t)y * SIZE * 4);
    int failed = slv_image_save(env, path, &image, NULL) != SLV_OK;
    slv_image_free(&image);
    return failed;
}

static void print(void *user, slv_log_level level, const char *message) {
    (void)user;
    (void)level;
    fprintf(stderr, "%s\n", message);
}

int main(int argc, char **argv) {
    slv_env env = {.log = print};
    const slv_strategy *strategy = slv_strategy_find(argc > 3 ? argv[3] : "traverse");
    slv_ptx *ptx = NULL;
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    slv_texture *texture = NULL;
    slv_gl *context = NULL;
    slv_gl_texture *uploaded = NULL;
    slv_mesh_stats stats;
    slv_gl_texture_params params = {.anisotropy = 4};
    float to_clip[16];
    int failed = 1;
    if (argc < 3 || !strategy) {
        fputs("usage: sample_in_your_shader FILE.ptx OUT.png [clamp|borders|traverse|discard]\n",
              stderr);
        return 2;
    }
    params.strategies = &strategy; /* upload only what will be drawn */
    params.nstrategies = 1;
    if (slv_ptx_open(&env, argv[1], &ptx) || slv_ptx_load_mesh(&env, ptx, &mesh) ||
        slv_ptx_load_adjacency(&env, ptx, &adjacency) ||
        slv_ptx_load_texture(&env, ptx, &texture) || slv_mesh_get_stats(&env, mesh, &stats) ||
        slv_surface_create(&env, mesh, NULL, &surface))
        goto done;

    /* 3. A context. In an application, whose context is current already, this becomes
     *        slv_gl_wrap(&env, get_proc, NULL, &context)
     *    with get_proc forwarding to eglGetProcAddress, glfwGetProcAddress, SDL_GL_GetProcAddress,
     * ... */
    if (slv_gl_create(&env, SLV_GL_AUTO, &context))
        goto done;
#define LOAD(type, name)                                                                           \
    if (!(gl.name = (type)slv_gl_get_function(context, "gl" #name)))                               \
        goto done;
    FUNCTIONS(LOAD)

    /* 4. Upload. The texture in memory is no longer needed afterwards. */
    if (slv_gl_texture_create(context, &env, texture, adjacency, &params, &uploaded))
        goto done;
    const float box[2][3] = {{stats.bounds_min[0], stats.bounds_min[1], stats.bounds_min[2]},
                             {stats.bounds_max[0], stats.bounds_max[1], stats.bounds_max[2]}};
    set_up_drawing(box, to_clip);
    failed = draw(uploaded, strategy, surface, to_clip) || gl.GetError() != GL_NO_ERROR ||
             save(&env, argv[2]);
done:
    slv_gl_texture_destroy(uploaded);
    slv_gl_destroy(context);
    slv_texture_destroy(texture);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    slv_ptx_close(ptx);
    return failed;
}
