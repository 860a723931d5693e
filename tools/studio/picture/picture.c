/* Textures for the strategies that are shown, renderers, and the pass to the screen. */
#include "studio/picture/picture.h"

#include "command/output.h"
#include "studio/picture/overlay.h"
#include "studio/picture/screen.h"
#include "studio/picture/timer.h"

#include <selvage/gl_live.h>

#include <dlfcn.h>
#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of so many texels blank faces take memory, too, so that painting on them is not held up. */
enum { STRATEGIES = 32, MOST_WHOLE = 1 << 25 };

/* A texture of one strategy, and for what it was made. */
typedef struct shown {
    slv_gl_texture *texture;
    uint32_t anisotropy, channel;
    bool even;
    bool drawn[2]; /* with one sample a pixel; with more */
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
    shown shown[STRATEGIES][2]; /* without anisotropy, which is what moves; and with it */
    const slv_mesh *mesh;       /* for which all of it was made */
    uint64_t serial;
    GLuint targets[2], framebuffers[2];
    uint32_t width, height; /* of the targets */
    uint32_t screen[2];     /* of what was drawn last */
    studio_timer timer;
    studio_screen *to_screen;
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

bool studio_picture_in_software(void) {
    const slv_env quiet = {0};
    slv_gl *gl = NULL;
    bool software = !wrap(&quiet, &gl) && slv_gl_get_info(gl)->software;
    slv_gl_destroy(gl);
    return software;
}

slv_result studio_picture_create(const slv_env *env, studio_picture **out) {
    studio_picture *p = calloc(1, sizeof *p);
    *out = NULL;
    if (!p)
        return output_fail(env, SLV_ERROR_MEMORY, "no memory for a picture");
    p->env = *env;
    p->env.log = studio_document_note;
    p->env.log_user = p->message;
    /* it outlives the document, and so what gives that memory */
    p->env.allocate = NULL;
    p->env.release = NULL;
    p->env.memory_user = NULL;
    slv_result result = wrap(&p->env, &p->gl);
    if (!result)
        result = studio_screen_create(&p->env, &p->to_screen);
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
        for (int k = 0; k < 2; k++)
            slv_gl_texture_destroy(p->shown[i][k].texture);
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
        studio_screen_destroy(p->to_screen);
        studio_timer_free(&p->timer);
    }
    slv_gl_destroy(p->gl);
    free(p);
}

const slv_gl_info *studio_picture_info(const studio_picture *p) {
    return slv_gl_get_info(p->gl);
}

static uint64_t texels_of(const slv_texture *texture) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    uint64_t total = 0;
    for (uint32_t f = 0; f < desc->nfaces; f++)
        total += UINT64_C(1) << (desc->res[f].u + desc->res[f].v);
    return total;
}

static bool is_for(const shown *s, const studio_document *d, const studio_look *look,
                   uint32_t anisotropy) {
    return s->texture && s->anisotropy == anisotropy && s->channel == look->channel &&
           s->even == (d->scene.even != look->other_levels);
}

static slv_result need_texture(studio_picture *p, const studio_document *d, const studio_look *look,
                               uint32_t index, uint32_t anisotropy, slv_gl_texture **out) {
    shown *s = &p->shown[index < STRATEGIES ? index : 0][anisotropy > 1];
    const slv_strategy *strategy = slv_strategy_at(index);
    *out = NULL;
    if (index >= STRATEGIES || !strategy)
        return output_fail(&p->env, SLV_ERROR_ARGUMENT, "there is no strategy %u", index);
    const bool even = d->scene.even != look->other_levels;
    if (is_for(s, d, look, anisotropy)) {
        *out = s->texture;
        return SLV_OK;
    }
    const slv_gl_texture_params params = {.strategies = &strategy,
                                          .nstrategies = 1,
                                          .anisotropy = anisotropy,
                                          .first_channel = look->channel ? look->channel - 1 : 0,
                                          .nchannels = look->channel ? 1 : 0,
                                          .border_u = d->scene.border_u,
                                          .border_v = d->scene.border_v,
                                          .edge_filter = d->scene.edge_filter,
                                          .whole = texels_of(d->texture) <= MOST_WHOLE,
                                          .live = true,
                                          .even_levels = even};
    slv_gl_texture_destroy(s->texture);
    *s = (shown){.anisotropy = anisotropy, .channel = look->channel, .even = even};
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

/* Pictures that move do without. */
static uint32_t anisotropy_of(const studio_shot *shot) {
    return shot->coarse ? 1 : shot->look.anisotropy;
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
    slv_result result = need_texture(p, d, &shot->look, index, anisotropy_of(shot), &texture);
    if (!result)
        result = slv_gl_texture_update(texture, &p->env, NULL);
    stats->update += cli_now() - start;
    if (result ||
        (result = slv_gl_renderer_draw(p->renderer, &p->env, texture, &frame, NULL, &seconds)))
        return result;
    stats->seconds += seconds;
    p->shown[index][anisotropy_of(shot) > 1].drawn[msaa > 1] = true;
    const slv_gl_texture_stats made = slv_gl_texture_get_stats(texture, strategy);
    stats->gpu_bytes += made.gpu_bytes;
    stats->widened += made.widened;
    stats->draws += slv_gl_texture_batch_count(texture, strategy);
    glBlitNamedFramebuffer(slv_gl_renderer_framebuffer(p->renderer), p->framebuffers[target], 0, 0,
                           (GLint)p->width, (GLint)p->height, 0, 0, (GLint)p->width,
                           (GLint)p->height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    return SLV_OK;
}

static slv_result put_on_screen(studio_picture *p, const studio_shot *shot, GLuint framebuffer) {
    const bool same_size = p->width == shot->width && p->height == shot->height;
    slv_result result =
        studio_screen_put(p->to_screen, &p->env, shot, p->targets, same_size, framebuffer);
    GLenum error = glGetError();
    if (!result && error)
        result = output_fail(&p->env, SLV_ERROR_GL, "OpenGL has reported error 0x%x", error);
    return result;
}

bool studio_picture_is_ready(const studio_picture *p, const studio_document *d,
                             const studio_shot *shot) {
    const studio_look *look = &shot->look;
    const uint32_t anisotropy = anisotropy_of(shot), which[2] = {look->strategy, look->other};
    bool ready = p->mesh == studio_document_mesh(d) && p->serial == d->serial;
    for (int i = 0; i < 1 + (look->compare != STUDIO_WHOLE); i++) {
        const shown *s = &p->shown[which[i]][anisotropy > 1];
        ready =
            ready && is_for(s, d, look, anisotropy) && s->drawn[!shot->coarse && look->msaa > 1];
    }
    return ready;
}

slv_result studio_picture_keep(studio_picture *p, const studio_document *d,
                               const studio_shot *shot) {
    static const float black[4] = {0, 0, 0, 1};
    GLint framebuffer = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
    if (p->targets[0] && p->mesh == studio_document_mesh(d))
        return put_on_screen(p, shot, (GLuint)framebuffer);
    glClearBufferfv(GL_COLOR, 0, black);
    return SLV_OK;
}

slv_result studio_picture_draw(studio_picture *p, studio_document *d, const studio_shot *shot,
                               studio_picture_stats *stats) {
    const studio_look *look = &shot->look;
    bool two = look->compare != STUDIO_WHOLE;
    float scale = shot->scale > 0 ? shot->scale : 1;
    GLint framebuffer = 0;
    slv_result result = SLV_OK;
    p->message[0] = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
    if (p->mesh != studio_document_mesh(d) || p->serial != d->serial) {
        studio_picture_forget(p);
        p->mesh = studio_document_mesh(d);
        p->serial = d->serial;
    }
    const bool again =
        shot->again && p->renderer && p->screen[0] == shot->width && p->screen[1] == shot->height;
    if (again)
        goto put;
    studio_timer_begin(&p->timer);
    need_targets(p, (uint32_t)fmaxf(1, (float)shot->width * scale),
                 (uint32_t)fmaxf(1, (float)shot->height * scale));
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
            over[i] = (studio_overlay_target){p->framebuffers[i],
                                              p->shown[which[i]][anisotropy_of(shot) > 1].texture,
                                              slv_strategy_at(which[i])};
        result = studio_overlay_draw(&p->overlay, d, shot, p->segments, over, 1 + two);
    }
    stats->segments = p->segments;
    stats->triangles = slv_gl_renderer_triangles(p->renderer);
put:
    if (!result)
        result = put_on_screen(p, shot, (GLuint)framebuffer);
    if (!again)
        studio_timer_end(&p->timer);
done:
    if (result) {
        static const float black[4] = {0, 0, 0, 1};
        glBindFramebuffer(GL_FRAMEBUFFER, (GLuint)framebuffer);
        glClearBufferfv(GL_COLOR, 0, black);
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

slv_result studio_picture_seam(studio_picture *p, studio_document *d, const studio_look *look,
                               uint32_t strategy, const slv_gl_seam_params *params,
                               slv_gl_seam *out) {
    slv_gl_texture *texture;
    slv_result result = need_texture(p, d, look, strategy, look->anisotropy, &texture);
    if (!result)
        result = slv_gl_texture_seam_jump(texture, &p->env, slv_strategy_at(strategy),
                                          studio_document_adjacency(d), params, out);
    if (result)
        snprintf(d->message, STUDIO_MESSAGE, "%s", p->message);
    return result;
}
