/* A viewer: two per-face textures of one surface in one shader, and a brush that changes texels of
 * both in each frame.
 *
 *   cc viewer.c $(pkg-config --cflags --libs selvage-gl) -o viewer
 *   ./viewer teapot.ptx teapot.png 100
 *
 * Colours are those of the .ptx, which must hold its geometry; roughness is made here. There is no
 * window: the last frame is written. The steps that matter are numbered. */
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

/* A texture in memory, what the GPU has of it, and how it is looked up. */
typedef struct layer {
    slv_texture *texels;
    slv_gl_texture *uploaded;
    const slv_strategy *strategy;
} layer;

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

/* 1. Each texture's text has names of its own, so that both stand in one shader. */
static const char fragment_text[] = "in vec2 face_uv;\n"
                                    "flat in int face_id;\n"
                                    "out vec4 color;\n"
                                    "void main() {\n"
                                    "    vec3 diffuse = color_sample(face_id, face_uv).rgb;\n"
                                    "    float shine = 1.0 - rough_sample(face_id, face_uv).r;\n"
                                    "    color = vec4(diffuse * 0.8 + shine * 0.2, 1.0);\n"
                                    "}\n";

static GLuint shader(GLenum stage, int count, const char *const *texts) {
    GLuint made = gl.CreateShader(stage);
    gl.ShaderSource(made, count, texts, NULL);
    gl.CompileShader(made);
    return made;
}

/* 0 if it does not link. `variants` are those of the batches of both textures. */
static GLuint program(const layer layers[2], const uint32_t variants[2]) {
    const char *vertex_texts[] = {vertex_text};
    const char *fragment_texts[] = {"#version 450 core\n",
                                    slv_gl_texture_extensions(layers[0].uploaded), NULL, NULL,
                                    fragment_text};
    GLuint made = gl.CreateProgram(), shaders[2];
    GLint linked = 0;
    for (int i = 0; i < 2; i++)
        if (slv_gl_texture_glsl(layers[i].uploaded, layers[i].strategy, variants[i],
                                &fragment_texts[2 + i]))
            return 0;
    shaders[0] = shader(GL_VERTEX_SHADER, 1, vertex_texts);
    shaders[1] = shader(GL_FRAGMENT_SHADER, 5, fragment_texts);
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

/* 2. A draw can show the faces that are in one batch of either texture: a material lists those. */
static int draw(slv_gl_material *material, const layer layers[2], const slv_surface *surface,
                const float to_clip[16],
                GLuint programs[SLV_GL_MAX_VARIANTS][SLV_GL_MAX_VARIANTS]) {
    int failed = 0;
    gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    for (uint32_t i = 0; !failed && i < slv_gl_material_batch_count(material); i++) {
        slv_gl_common_batch batch = slv_gl_material_batch(material, i);
        GLuint *made = &programs[batch.variants[0]][batch.variants[1]];
        vertex *vertices =
            malloc((size_t)batch.nfaces * SEGMENTS * SEGMENTS * 6 * sizeof *vertices);
        size_t count = 0;
        failed = !vertices || (!*made && !(*made = program(layers, batch.variants)));
        for (uint32_t f = 0; !failed && f < batch.nfaces; f++)
            count += add_face(surface, batch.faces[f], vertices + count);
        if (!failed) {
            gl.UseProgram(*made);
            gl.UniformMatrix4fv(0, 1, GL_FALSE, to_clip);
            slv_gl_material_bind(material, i); /* each at its own units and bindings */
            gl.BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(count * sizeof *vertices), vertices,
                          GL_STREAM_DRAW);
            gl.DrawArrays(GL_TRIANGLES, 0, (GLsizei)count);
        }
        free(vertices);
    }
    slv_gl_material_unbind(material);
    return failed;
}

/* 3. The brush: a square of texels in the middle of a face gets a value, in the texture in memory.
 */
static int paint(slv_texture *texels, uint32_t face, const float value[3]) {
    const slv_texture_desc *desc = slv_texture_get_desc(texels);
    slv_res res = desc->res[face];
    slv_rect rect = {res.u ? 1u << (res.u - 1) : 0, res.v ? 1u << (res.v - 1) : 0, 1, 1};
    rect.width = res.u > 1 ? 1u << (res.u - 2) : 1;
    rect.height = res.v > 1 ? 1u << (res.v - 2) : 1;
    size_t texel = slv_type_size(desc->type) * desc->nchannels, count = rect.width * rect.height;
    unsigned char *square = malloc(count * texel);
    int failed = 1;
    if (square) {
        for (size_t i = 0; i < count; i++)
            for (uint32_t c = 0; c < desc->nchannels; c++)
                slv_type_from_float(desc->type, &value[c < 3 ? c : 0], 1,
                                    square + i * texel + c * slv_type_size(desc->type));
        failed = slv_texture_set_rect(texels, face, rect, square) != SLV_OK;
    }
    free(square);
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

/* Rough everywhere. */
static int make_roughness(const slv_env *env, const slv_texture_desc *like, slv_texture **out) {
    static const unsigned char rough = 230;
    slv_texture_desc desc = {.nfaces = like->nfaces,
                             .type = SLV_TYPE_U8,
                             .nchannels = 1,
                             .alpha_channel = SLV_NO_ALPHA,
                             .res = like->res,
                             .encoding = SLV_TEXTURE_DATA};
    if (slv_texture_create(env, &desc, out))
        return 1;
    for (uint32_t face = 0; face < desc.nfaces; face++)
        if (slv_texture_set_constant(*out, face, &rough))
            return 1;
    return 0;
}

/* 4. Textures that follow what is painted, each with its share of the units and bindings. */
static int upload(slv_gl *context, const slv_env *env, layer layers[2],
                  const slv_adjacency *adjacency, slv_gl_material **out) {
    slv_gl_lookup lookups[2];
    for (int i = 0; i < 2; i++) {
        slv_gl_texture_params params = {.strategies = &layers[i].strategy,
                                        .nstrategies = 1,
                                        .live = true,
                                        .batch_pools = 8,
                                        .prefix = i ? "rough_" : "color_",
                                        .first_unit = i ? 16 : 0,
                                        .first_storage = i ? 8 : 4};
        if (slv_gl_texture_create(context, env, layers[i].texels, adjacency, &params,
                                  &layers[i].uploaded))
            return 1;
        lookups[i] = (slv_gl_lookup){layers[i].uploaded, layers[i].strategy};
    }
    return slv_gl_material_create(env, lookups, 2, out) != SLV_OK;
}

int main(int argc, char **argv) {
    static GLuint programs[SLV_GL_MAX_VARIANTS][SLV_GL_MAX_VARIANTS];
    static const float red[3] = {1, 0, 0}, smooth[3] = {0, 0, 0};
    slv_env env = {.log = print};
    layer layers[2] = {{.strategy = slv_strategy_find("traverse")},
                       {.strategy = slv_strategy_find("borders")}};
    slv_ptx *ptx = NULL;
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    slv_gl *context = NULL;
    slv_gl_material *material = NULL;
    slv_mesh_stats stats;
    unsigned long long bytes = 0;
    float to_clip[16];
    int failed = 1, frames = argc > 3 ? atoi(argv[3]) : 0;
    if (argc < 4) {
        fputs("usage: viewer FILE.ptx OUT.png FRAMES\n", stderr);
        return 2;
    }
    if (slv_ptx_open(&env, argv[1], &ptx) || slv_ptx_load_mesh(&env, ptx, &mesh) ||
        slv_ptx_load_adjacency(&env, ptx, &adjacency) ||
        slv_ptx_load_texture(&env, ptx, &layers[0].texels) ||
        slv_mesh_get_stats(&env, mesh, &stats) || slv_surface_create(&env, mesh, NULL, &surface) ||
        make_roughness(&env, slv_texture_get_desc(layers[0].texels), &layers[1].texels) ||
        slv_gl_create(&env, SLV_GL_AUTO, &context))
        goto done;
#define LOAD(type, name)                                                                           \
    if (!(gl.name = (type)slv_gl_get_function(context, "gl" #name)))                               \
        goto done;
    FUNCTIONS(LOAD)

    if (upload(context, &env, layers, adjacency, &material))
        goto done;
    uint32_t nfaces = slv_texture_get_desc(layers[0].texels)->nfaces;
    const float box[2][3] = {{stats.bounds_min[0], stats.bounds_min[1], stats.bounds_min[2]},
                             {stats.bounds_max[0], stats.bounds_max[1], stats.bounds_max[2]}};
    set_up_drawing(box, to_clip);
    failed = draw(material, layers, surface, to_clip, programs);
    for (int frame = 0; !failed && frame < frames; frame++) {
        uint32_t face = (uint32_t)frame % nfaces;
        failed = paint(layers[0].texels, face, red) || paint(layers[1].texels, face, smooth);
        for (int i = 0; !failed && i < 2; i++) { /* 5. only what was changed goes to the GPU */
            slv_gl_update update;
            failed = slv_gl_texture_update(layers[i].uploaded, &env, &update) != SLV_OK;
            bytes += update.bytes;
        }
        failed = failed || slv_gl_material_update(material, &env, NULL) ||
                 draw(material, layers, surface, to_clip, programs);
    }
    failed = failed || gl.GetError() != GL_NO_ERROR || save(&env, argv[2]);
    if (!failed)
        printf("%d frames, %llu bytes were sent for what was painted\n", frames, bytes);
done:
    for (int i = 0; context && i < SLV_GL_MAX_VARIANTS * SLV_GL_MAX_VARIANTS; i++)
        if (programs[i / SLV_GL_MAX_VARIANTS][i % SLV_GL_MAX_VARIANTS])
            gl.DeleteProgram(programs[i / SLV_GL_MAX_VARIANTS][i % SLV_GL_MAX_VARIANTS]);
    slv_gl_material_destroy(material);
    for (int i = 0; i < 2; i++) {
        slv_gl_texture_destroy(layers[i].uploaded);
        slv_texture_destroy(layers[i].texels);
    }
    slv_gl_destroy(context);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    slv_ptx_close(ptx);
    return failed;
}
