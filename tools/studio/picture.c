/* Textures for the strategies that are shown, renderers, and the pass to the screen. */
#include "studio/picture.h"

#include "command/output.h"
#include "studio/overlay.h"
#include "studio/timer.h"

#include <selvage/gl_live.h>

#include <dlfcn.h>
#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STRATEGIES = 32 };

/* A texture of one strategy, and for what it was made. */
typedef struct shown {
    slv_gl_texture *texture;
    uint32_t anisotropy, channel;
} shown;

struct studio_picture {
    slv_env env; /* its log writes `message` */
    char message[STUDIO_MESSAGE];
    slv_gl *gl;
    slv_gl_renderer *renderer;
    studio_overlay_pass *overlay;
    uint32_t segments; /* along an edge of each face, as the overlay has them */
    uint64_t shape;    /* of the document, as the renderer and the overlay have it */
    bool even;         /* the renderer, too; else each face has what it needs for */
    slv_camera camera; /* this, in a picture so large */
    uint32_t seen[2];
    shown shown[STRATEGIES];
    const slv_mesh *mesh; /* for which all of it was made */
    uint64_t serial;
    GLuint program, array, targets[2], framebuffers[2];
    uint32_t width, height; /* of the targets */
    uint32_t screen[2];     /* of what was drawn last */
    studio_timer timer;
    GLuint stencil;
    char *stencil_path; /* of the image that is in it */
};

/* ---- the context's functions ---- */

static slv_gl_proc look_up(void *library, const char *getter, const char *name) {
    slv_gl_proc (*get)(const char *) = NULL;
    void *symbol = library ? dlsym(library, getter) : NULL;
    memcpy(&get, &symbol, sizeof symbol);
    return get ? get(name) : NULL;
}

/* The window system's context is one of EGL or of GLX. */
static slv_gl_proc get_proc(void *user, const char *name) {
    void **libraries = user;
    void *(*current)(void) = NULL;
    void *symbol = libraries[0] ? dlsym(libraries[0], "eglGetCurrentContext") : NULL;
    memcpy(&current, &symbol, sizeof symbol);
    if (current && current())
        return look_up(libraries[0], "eglGetProcAddress", name);
    return look_up(libraries[1], "glXGetProcAddressARB", name);
}

static slv_result wrap(const slv_env *env, slv_gl **out) {
    void *libraries[2] = {dlopen("libEGL.so.1", RTLD_LAZY), dlopen("libGL.so.1", RTLD_LAZY)};
    slv_result result = slv_gl_wrap(env, get_proc, libraries, out);
    for (int i = 0; i < 2; i++)
        if (libraries[i])
            dlclose(libraries[i]);
    return result;
}

/* ---- the pass to the screen ---- */

static const char vertex_text[] = "#version 450 core\n"
                                  "void main() {\n"
                                  "    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, "
                                  "gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);\n"
                                  "}\n";

static const char fragment_text[] =
    "#version 450 core\n"
    "layout(binding = 0) uniform sampler2D pictures[2];\n"
    "layout(location = 0) uniform ivec4 mode; // compare, encoding, second, -\n"
    "layout(location = 1) uniform vec4 numbers; // divider, gain, exposure, -\n"
    "layout(location = 2) uniform vec2 size;\n"
    "layout(location = 3) uniform vec3 cursor; // where, and how far around\n"
    "layout(binding = 2) uniform sampler2D stencil;\n"
    "layout(location = 4) uniform vec4 before; // where the stencil is, its width, and turned how\n"
    "layout(location = 5) uniform float aspect;\n"
    "layout(location = 0) out vec4 color;\n"
    "vec3 map(float t) { // from dark blue to yellow, evenly\n"
    "    t = clamp(t, 0.0, 1.0);\n"
    "    const vec3 c[5] = vec3[](vec3(0.27, 0.0, 0.33), vec3(0.23, 0.32, 0.55),\n"
    "        vec3(0.13, 0.57, 0.55), vec3(0.37, 0.79, 0.38), vec3(0.99, 0.91, 0.14));\n"
    "    int i = min(int(t * 4.0), 3);\n"
    "    return mix(c[i], c[i + 1], t * 4.0 - float(i));\n"
    "}\n"
    "vec3 encode(vec3 c) {\n"
    "    c = clamp(c, 0.0, 1.0);\n"
    "    return mix(12.92 * c, 1.055 * pow(max(c, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055,\n"
    "               greaterThan(c, vec3(0.0031308)));\n"
    "}\n"
    "void main() {\n"
    "    vec2 at = gl_FragCoord.xy / size;\n"
    "    bool right = mode.x == 1 ? at.x >= numbers.x : mode.x == 3 && mode.z != 0;\n"
    "    vec4 a = right ? texture(pictures[1], at) : texture(pictures[0], at);\n"
    "    if (mode.x == 2)\n"
    "        a.rgb = abs(a.rgb - texture(pictures[1], at).rgb) * numbers.y;\n"
    "    a.rgb *= exp2(numbers.z);\n"
    "    if (mode.y == 2)\n"
    "        a.rgb = a.a > 0.0 ? map(dot(a.rgb, vec3(1.0 / 3.0))) : vec3(0.0);\n"
    "    else if (mode.y == 0)\n"
    "        a.rgb = encode(a.rgb);\n"
    "    if (mode.x == 1 && abs(gl_FragCoord.x - numbers.x * size.x) < 1.0)\n"
    "        a.rgb = vec3(1.0);\n"
    "    if (before.z > 0.0) {\n"
    "        vec2 p = (gl_FragCoord.xy - before.xy) * vec2(1.0, -1.0);\n"
    "        float s = sin(before.w), c = cos(before.w);\n"
    "        vec2 at = vec2(c * p.x + s * p.y, c * p.y - s * p.x) * vec2(1.0, aspect) / before.z;\n"
    "        vec4 over = textureLod(stencil, at + 0.5, 0.0);\n"
    "        if (all(lessThan(abs(at), vec2(0.5))))\n"
    "            a.rgb = mix(a.rgb, over.rgb, 0.5 * over.a);\n"
    "    }\n"
    "    float off = abs(distance(gl_FragCoord.xy, cursor.xy) - cursor.z);\n"
    "    if (cursor.z > 0.0 && off < 1.5)\n"
    "        a.rgb = vec3(off < 0.75 ? 1.0 : 0.0);\n"
    "    color = vec4(a.rgb, 1.0);\n"
    "}\n";

GLuint studio_program(const slv_env *env, const char *vertex, const char *fragment) {
    const char *texts[2] = {vertex, fragment};
    char log[512] = "";
    GLint fine = 0;
    GLuint program = glCreateProgram();
    for (int i = 0; i < 2; i++) {
        GLuint shader = glCreateShader(i ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
        glShaderSource(shader, 1, &texts[i], NULL);
        glCompileShader(shader);
        glAttachShader(program, shader);
        glGetShaderiv(shader, GL_COMPILE_STATUS, &fine);
        if (!fine)
            glGetShaderInfoLog(shader, sizeof log, NULL, log);
        glDeleteShader(shader);
    }
    glLinkProgram(program);
    glGetProgramiv(program, GL_LINK_STATUS, &fine);
    if (fine)
        return program;
    if (!*log)
        glGetProgramInfoLog(program, sizeof log, NULL, log);
    (void)output_fail(env, SLV_ERROR_GL, "the driver refuses a shader: %s", log);
    glDeleteProgram(program);
    return 0;
}

static void free_targets(studio_picture *p) {
    glDeleteTextures(2, p->targets);
    glDeleteFramebuffers(2, p->framebuffers);
    memset(p->targets, 0, sizeof p->targets);
    memset(p->framebuffers, 0, sizeof p->framebuffers);
    p->width = p->height = 0;
}

static void need_targets(studio_picture *p, uint32_t width, uint32_t height) {
    if (p->width == width && p->height == height)
        return;
    free_targets(p);
    glCreateTextures(GL_TEXTURE_2D, 2, p->targets);
    glCreateFramebuffers(2, p->framebuffers);
    for (int i = 0; i < 2; i++) {
        glTextureStorage2D(p->targets[i], 1, GL_RGBA16F, (GLsizei)width, (GLsizei)height);
        glTextureParameteri(p->targets[i], GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTextureParameteri(p->targets[i], GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
        glTextureParameteri(p->targets[i], GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glNamedFramebufferTexture(p->framebuffers[i], GL_COLOR_ATTACHMENT0, p->targets[i], 0);
    }
    p->width = width;
    p->height = height;
}

/* ---- making ---- */

slv_result studio_picture_create(const slv_env *env, studio_picture **out) {
    studio_picture *p = calloc(1, sizeof *p);
    *out = NULL;
    if (!p)
        return output_fail(env, SLV_ERROR_MEMORY, "no memory for a picture");
    p->env = *env;
    p->env.log = studio_document_note;
    p->env.log_user = p->message;
    slv_result result = wrap(&p->env, &p->gl);
    if (!result && !(p->program = studio_program(&p->env, vertex_text, fragment_text)))
        result = SLV_ERROR_GL;
    if (!result)
        glCreateVertexArrays(1, &p->array);
    if (result) {
        env->log(env->log_user, SLV_LOG_ERROR, p->message);
        studio_picture_destroy(p);
        return result;
    }
    *out = p;
    return SLV_OK;
}

void studio_picture_forget(studio_picture *p) {
    for (uint32_t i = 0; i < STRATEGIES; i++)
        slv_gl_texture_destroy(p->shown[i].texture);
    memset(p->shown, 0, sizeof p->shown);
    slv_gl_renderer_destroy(p->renderer);
    p->renderer = NULL;
    p->segments = 0;
    studio_overlay_destroy(p->overlay);
    p->overlay = NULL;
    p->mesh = NULL;
}

void studio_picture_destroy(studio_picture *p) {
    if (!p)
        return;
    if (p->gl) {
        studio_picture_forget(p);
        free_targets(p);
        glDeleteProgram(p->program);
        glDeleteVertexArrays(1, &p->array);
        glDeleteTextures(1, &p->stencil);
        studio_timer_free(&p->timer);
    }
    slv_gl_destroy(p->gl);
    free(p->stencil_path);
    free(p);
}

const slv_gl_info *studio_picture_info(const studio_picture *p) {
    return slv_gl_get_info(p->gl);
}

static slv_result need_texture(studio_picture *p, const studio_document *d, const studio_look *look,
                               uint32_t index, slv_gl_texture **out) {
    shown *s = &p->shown[index < STRATEGIES ? index : 0];
    const slv_strategy *strategy = slv_strategy_at(index);
    *out = NULL;
    if (index >= STRATEGIES || !strategy)
        return output_fail(&p->env, SLV_ERROR_ARGUMENT, "there is no strategy %u", index);
    if (s->texture && s->anisotropy == look->anisotropy && s->channel == look->channel) {
        *out = s->texture;
        return SLV_OK;
    }
    const slv_gl_texture_params params = {.strategies = &strategy,
                                          .nstrategies = 1,
                                          .anisotropy = look->anisotropy,
                                          .first_channel = look->channel ? look->channel - 1 : 0,
                                          .nchannels = look->channel ? 1 : 0,
                                          .border_u = d->scene.border_u,
                                          .border_v = d->scene.border_v,
                                          .edge_filter = d->scene.edge_filter,
                                          .live = true};
    slv_gl_texture_destroy(s->texture);
    *s = (shown){.anisotropy = look->anisotropy, .channel = look->channel};
    slv_result result = slv_gl_texture_create(p->gl, &p->env, d->texture,
                                              studio_document_adjacency(d), &params, &s->texture);
    *out = s->texture;
    return result;
}

/* Whether the surface is divided as this picture wants it. One that moves takes what there is, for
 * dividing it would stutter. */
static bool is_divided(const studio_picture *p, const studio_shot *shot, bool even,
                       uint32_t segments) {
    if (!p->renderer || p->even != even)
        return false;
    if (even)
        return p->segments == segments;
    return shot->coarse || (memcmp(&p->camera, &shot->camera, sizeof p->camera) == 0 &&
                            p->seen[0] == shot->width && p->seen[1] == shot->height);
}

/* All faces alike where that was asked for or where it is shown; else each as the picture needs. */
static slv_result need_renderer(studio_picture *p, const studio_document *d,
                                const studio_shot *shot) {
    const slv_mesh *mesh = studio_document_mesh(d);
    bool even = shot->look.segments || shot->look.wires;
    uint32_t segments = shot->look.segments ? shot->look.segments
                        : p->segments
                            ? p->segments
                            : slv_tessellation_for(mesh, &shot->camera, shot->width, shot->height);
    bool reshaped = p->shape != d->shape;
    if (segments != p->segments || reshaped) {
        studio_overlay_destroy(p->overlay);
        p->overlay = NULL;
    }
    bool divided = !reshaped && is_divided(p, shot, even, segments);
    p->segments = segments;
    if (divided)
        return SLV_OK;
    const slv_tessellation_params params = {.segments = even ? segments : 0,
                                            .displacement = studio_document_displacement(d),
                                            .camera = &shot->camera,
                                            .width = shot->width,
                                            .height = shot->height};
    slv_result result =
        p->renderer
            ? slv_gl_renderer_tessellate(p->renderer, &p->env, mesh, d->scene.surface, &params)
            : slv_gl_renderer_create_with(p->gl, &p->env, mesh, d->scene.surface, &params,
                                          &p->renderer);
    if (result)
        return result;
    p->shape = d->shape;
    p->even = even;
    p->camera = shot->camera;
    p->seen[0] = shot->width;
    p->seen[1] = shot->height;
    return SLV_OK;
}

/* ---- drawing ---- */

static slv_shading shading_of(const studio_look *look) {
    return look->overlay == STUDIO_OVERLAY_FACES    ? SLV_SHADE_FACES
           : look->overlay == STUDIO_OVERLAY_LEVELS ? SLV_SHADE_LEVELS
                                                    : look->shading;
}

/* One strategy into one of the targets. */
static slv_result draw_one(studio_picture *p, const studio_document *d, const studio_shot *shot,
                           uint32_t index, int target, studio_picture_stats *stats) {
    const slv_strategy *strategy = slv_strategy_at(index);
    slv_gl_texture *texture;
    double seconds = 0, start = cli_now();
    uint32_t msaa = shot->coarse ? 1 : shot->look.msaa;
    const uint32_t most = slv_gl_get_info(p->gl)->max_msaa;
    slv_frame frame = {.camera = shot->camera,
                       .width = p->width,
                       .height = p->height,
                       .msaa = msaa < most ? msaa : most,
                       .strategy = strategy,
                       .shading = shading_of(&shot->look),
                       .light = &shot->light,
                       .level_bias = shot->look.level_bias};
    memcpy(frame.background, shot->background, sizeof frame.background);
    slv_result result = need_texture(p, d, &shot->look, index, &texture);
    if (!result)
        result = slv_gl_texture_update(texture, &p->env, NULL);
    stats->update += cli_now() - start;
    if (result ||
        (result = slv_gl_renderer_draw(p->renderer, &p->env, texture, &frame, NULL, &seconds)))
        return result;
    stats->seconds += seconds;
    const slv_gl_texture_stats made = slv_gl_texture_get_stats(texture, strategy);
    stats->gpu_bytes += made.gpu_bytes;
    stats->widened += made.widened;
    stats->draws += slv_gl_texture_batch_count(texture, strategy);
    glBlitNamedFramebuffer(slv_gl_renderer_framebuffer(p->renderer), p->framebuffers[target], 0, 0,
                           (GLint)p->width, (GLint)p->height, 0, 0, (GLint)p->width,
                           (GLint)p->height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    return SLV_OK;
}

/* The stencil's image, as it is on the screen. */
static slv_result need_stencil(studio_picture *p, const studio_stencil *stencil) {
    slv_image image = {0};
    GLint most = 0;
    if (p->stencil_path && strcmp(p->stencil_path, stencil->path) == 0)
        return SLV_OK;
    slv_result result = slv_image_load(&p->env, stencil->path, &image);
    if (result)
        return result;
    const size_t npixels = (size_t)image.width * image.height;
    const uint32_t n = image.nchannels;
    uint8_t *pixels = malloc(4 * npixels + 1);
    char *path = strdup(stencil->path);
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    if (image.width > (uint32_t)most || image.height > (uint32_t)most)
        result = output_fail(&p->env, SLV_ERROR_LIMIT, "%s: more than %d pixels wide or high",
                             stencil->path, most);
    else if (!pixels || !path)
        result = output_fail(&p->env, SLV_ERROR_MEMORY, "%s: no memory", stencil->path);
    for (size_t i = 0; !result && i < npixels; i++)
        for (uint32_t c = 0; c < 4; c++) {
            const float *from = image.pixels + i * n;
            float value = c == 3 ? (n == 2 || n == 4 ? from[n - 1] : 1) : from[n < 3 ? 0 : c];
            pixels[4 * i + c] = (uint8_t)(fminf(fmaxf(value, 0), 1) * 255 + 0.5f);
        }
    if (!result) {
        glDeleteTextures(1, &p->stencil);
        glCreateTextures(GL_TEXTURE_2D, 1, &p->stencil);
        glTextureStorage2D(p->stencil, 1, GL_RGBA8, (GLsizei)image.width, (GLsizei)image.height);
        glTextureParameteri(p->stencil, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTextureParameteri(p->stencil, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
        glTextureParameteri(p->stencil, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
        glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
        glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
        glTextureSubImage2D(p->stencil, 0, 0, 0, (GLsizei)image.width, (GLsizei)image.height,
                            GL_RGBA, GL_UNSIGNED_BYTE, pixels);
        free(p->stencil_path);
        p->stencil_path = path;
        path = NULL;
    }
    free(path);
    free(pixels);
    slv_image_free(&image);
    return result;
}

static void put_stencil(const studio_picture *p, const studio_shot *shot) {
    const studio_stencil *s = shot->stencil;
    static const studio_stencil none = {.aspect = 1};
    s = s ? s : &none;
    glBindTextures(2, 1, &p->stencil);
    glBindSampler(2, 0);
    glProgramUniform4f(p->program, 4, 0.5f * (float)shot->width + s->at[0],
                       0.5f * (float)shot->height - s->at[1], s->width,
                       s->angle * 3.14159265f / 180);
    glProgramUniform1f(p->program, 5, s->aspect);
}

static void to_screen(const studio_picture *p, const studio_shot *shot, GLuint framebuffer,
                      bool two) {
    const studio_look *look = &shot->look;
    const GLuint textures[2] = {p->targets[0], p->targets[two]};
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, (GLsizei)shot->width, (GLsizei)shot->height);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glUseProgram(p->program);
    glBindVertexArray(p->array);
    glBindTextures(0, 2, textures);
    glBindSampler(0, 0);
    glBindSampler(1, 0);
    glProgramUniform1iv(p->program, glGetUniformLocation(p->program, "pictures"), 2,
                        (const GLint[]){0, 1});
    glProgramUniform4i(p->program, 0, (GLint)look->compare, (GLint)look->encoding, look->second, 0);
    glProgramUniform4f(p->program, 1, look->divider, look->gain, look->exposure, 0);
    glProgramUniform2f(p->program, 2, (float)shot->width, (float)shot->height);
    glProgramUniform3f(p->program, 3, shot->cursor[0], (float)shot->height - shot->cursor[1],
                       shot->cursor[2]);
    put_stencil(p, shot);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
    glUseProgram(0);
}

slv_result studio_picture_draw(studio_picture *p, studio_document *d, const studio_shot *shot,
                               studio_picture_stats *stats) {
    const studio_look *look = &shot->look;
    bool two = look->compare != STUDIO_WHOLE;
    float scale = shot->scale > 0 ? shot->scale : 1;
    GLint framebuffer = 0;
    slv_result result;
    p->message[0] = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
    if (p->mesh != studio_document_mesh(d) || p->serial != d->serial) {
        studio_picture_forget(p);
        p->mesh = studio_document_mesh(d);
        p->serial = d->serial;
    }
    if (shot->stencil && (result = need_stencil(p, shot->stencil))) {
        snprintf(d->message, STUDIO_MESSAGE, "%s", p->message);
        return result;
    }
    if (shot->again && p->renderer && p->screen[0] == shot->width && p->screen[1] == shot->height) {
        to_screen(p, shot, (GLuint)framebuffer, two);
        return SLV_OK;
    }
    need_targets(p, (uint32_t)fmaxf(1, (float)shot->width * scale),
                 (uint32_t)fmaxf(1, (float)shot->height * scale));
    studio_timer_begin(&p->timer);
    *stats = (studio_picture_stats){0};
    p->screen[0] = shot->width;
    p->screen[1] = shot->height;
    if ((result = need_renderer(p, d, shot)) ||
        (result = draw_one(p, d, shot, look->strategy, 0, stats)) ||
        (two && (result = draw_one(p, d, shot, look->other, 1, stats))))
        goto done;
    if (studio_overlay_wanted(look) || shot->meant) {
        const uint32_t which[2] = {look->strategy, look->other};
        studio_overlay_target over[2];
        for (int i = 0; i < 2; i++)
            over[i] = (studio_overlay_target){p->framebuffers[i], p->shown[which[i]].texture,
                                              slv_strategy_at(which[i])};
        result = studio_overlay_draw(&p->overlay, d, shot, p->segments, over, 1 + two);
    }
    stats->segments = p->segments;
    stats->triangles = slv_gl_renderer_triangles(p->renderer);
done:
    glBindFramebuffer(GL_FRAMEBUFFER, (GLuint)framebuffer);
    if (result) {
        static const float black[4] = {0, 0, 0, 1};
        glClearBufferfv(GL_COLOR, 0, black);
        snprintf(d->message, STUDIO_MESSAGE, "%s", p->message);
        return result;
    }
    to_screen(p, shot, (GLuint)framebuffer, two);
    studio_timer_end(&p->timer);
    GLenum error = glGetError();
    if (error) {
        result = output_fail(&p->env, SLV_ERROR_GL, "OpenGL has reported error 0x%x", error);
        snprintf(d->message, STUDIO_MESSAGE, "%s", p->message);
    }
    return result;
}

void studio_picture_times(const studio_picture *p, double *cpu, double *gpu) {
    studio_timer_read(&p->timer, cpu, gpu);
}

slv_result studio_picture_read(studio_picture *p, slv_image *out) {
    slv_result result = slv_image_create(&p->env, p->screen[0], p->screen[1], 4, out);
    size_t row = 4 * (size_t)p->screen[0];
    if (result)
        return result;
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, (GLsizei)p->screen[0], (GLsizei)p->screen[1], GL_RGBA, GL_FLOAT,
                 out->pixels);
    for (uint32_t y = 0; y < p->screen[1] / 2; y++) /* OpenGL's first row is the lowest */
        for (size_t i = 0; i < row; i++) {
            float *a = &out->pixels[y * row + i],
                  *b = &out->pixels[(p->screen[1] - 1 - y) * row + i];
            float swapped = *a;
            *a = *b;
            *b = swapped;
        }
    return SLV_OK;
}

slv_result studio_picture_seam(studio_picture *p, studio_document *d, uint32_t strategy,
                               slv_gl_seam *out) {
    const studio_look look = {.anisotropy = 1};
    slv_gl_texture *texture;
    slv_result result = need_texture(p, d, &look, strategy, &texture);
    return result ? result
                  : slv_gl_texture_seam_jump(texture, &p->env, slv_strategy_at(strategy),
                                             studio_document_adjacency(d), NULL, out);
}
