/* Frames of a tessellated surface: targets, triangles in the order of batches, programs. */
#include "gl/draw/blend.h"
#include "gl/draw/images.h"
#include "gl/draw/indices.h"
#include "gl/store/tables.h"
#include "gl/store/texture.h"

#include "base/log.h"
#include "base/memory.h"

#include <selvage/gl_renderer.h>

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define MAX_PROGRAMS 64

struct target {
    uint32_t width, height, msaa;
    bool wide;
    GLuint framebuffers[2], colors[2], depth; /* drawn to, and resolved to */
};

struct program {
    char *text; /* the lookup code that it was made with */
    GLuint program;
};

struct slv_gl_renderer {
    slv_gl *gl;
    slv_tessellation mesh;
    GLuint vertices, queries[2];
    struct target target;
    slv_gl_indices *indices;
    uint32_t nindices;
    struct program programs[MAX_PROGRAMS];
    uint32_t nprograms;
    slv_gl_blender blender;
};

/* What a frame draws: a texture, or images. */
struct subject {
    slv_gl_texture *texture;
    const slv_gl_slot *slot; /* of the texture */
    const slv_gl_images *images;
    const slv_gl_indices *indices;
    GLuint programs[SLV_GL_MAX_VARIANTS];
};

static void free_target(const slv_gl_api *api, struct target *target) {
    api->DeleteFramebuffers(2, target->framebuffers);
    api->DeleteRenderbuffers(2, target->colors);
    api->DeleteRenderbuffers(1, &target->depth);
    memset(target, 0, sizeof *target);
}

static slv_result make_target(const slv_gl *gl, const slv_env *env, const slv_frame *frame,
                              struct target *out) {
    const slv_gl_api *api = &gl->api;
    if (out->width == frame->width && out->height == frame->height && out->msaa == frame->msaa &&
        out->wide == frame->float_target)
        return SLV_OK;
    free_target(api, out);
    GLenum format = frame->float_target ? GL_RGBA32F : GL_RGBA16F;
    GLsizei width = (GLsizei)frame->width, height = (GLsizei)frame->height;
    GLsizei samples = frame->msaa > 1 ? (GLsizei)frame->msaa : 0;
    uint32_t count = samples ? 2 : 1;
    api->CreateFramebuffers((GLsizei)count, out->framebuffers);
    api->CreateRenderbuffers((GLsizei)count, out->colors);
    api->CreateRenderbuffers(1, &out->depth);
    api->NamedRenderbufferStorageMultisample(out->depth, samples, GL_DEPTH_COMPONENT32F, width,
                                             height);
    api->NamedFramebufferRenderbuffer(out->framebuffers[0], GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
                                      out->depth);
    for (uint32_t i = 0; i < count; i++) {
        api->NamedRenderbufferStorageMultisample(out->colors[i], i ? 0 : samples, format, width,
                                                 height);
        api->NamedFramebufferRenderbuffer(out->framebuffers[i], GL_COLOR_ATTACHMENT0,
                                          GL_RENDERBUFFER, out->colors[i]);
        if (api->CheckNamedFramebufferStatus(out->framebuffers[i], GL_FRAMEBUFFER) !=
            GL_FRAMEBUFFER_COMPLETE) {
            free_target(api, out);
            slvi_gl_check(gl, NULL, "framebuffer");
            return slvi_fail(env, SLV_ERROR_GL,
                             "the driver makes no %u x %u target with %u samples", frame->width,
                             frame->height, frame->msaa);
        }
    }
    slv_result result = slvi_gl_check(gl, env, "framebuffer");
    if (result) {
        free_target(api, out);
        return result;
    }
    out->width = frame->width;
    out->height = frame->height;
    out->msaa = frame->msaa;
    out->wide = frame->float_target;
    return SLV_OK;
}

static slv_result indices_of(slv_gl_renderer *renderer, const slv_env *env,
                             const slv_strategy *strategy, slv_gl_indices **out) {
    uint32_t i = 0;
    while (i < renderer->nindices && renderer->indices[i].strategy != strategy)
        i++;
    if (i == renderer->nindices) {
        slv_result result =
            slvi_grow(env, "triangles", i + 1, sizeof *renderer->indices, &renderer->indices);
        if (result)
            return result;
        renderer->indices[i] = (slv_gl_indices){.strategy = strategy};
        renderer->nindices++;
    }
    *out = &renderer->indices[i];
    return SLV_OK;
}

static void free_programs(slv_gl_renderer *renderer) {
    for (uint32_t i = 0; i < renderer->nprograms; i++) {
        slvi_free(renderer->programs[i].text);
        renderer->gl->api.DeleteProgram(renderer->programs[i].program);
    }
    renderer->nprograms = 0;
}

/* Two bindings that lookups leave free. */
static uint32_t storage_of(const struct subject *subject) {
    uint32_t first =
        subject->texture ? subject->texture->params.first_storage : SLV_GL_FIRST_STORAGE;
    return first >= 2 ? 0 : first + 4;
}

/* Of a vertex shader: which batch of a multi-draw it is of. */
static const char draw_numbers[] = "#extension GL_ARB_shader_draw_parameters : require\n"
                                   "#define SURFACE_DRAWS\n";

static slv_result surface_program(slv_gl_renderer *renderer, const slv_env *env,
                                  const slv_frame *frame, const struct subject *subject,
                                  const char *lookups, GLuint *out) {
    char head[224], *text = NULL;
    const bool draws = subject->slot && subject->slot->handles_at;
    const char *hand_on = subject->images ? subject->images->hand_on : draws ? draw_numbers : NULL;
    int length =
        snprintf(head, sizeof head,
                 "#define SURFACE_ALPHA %d\n#define SURFACE_MSAA %u\n"
                 "#define SURFACE_STORAGE %u\n#define SURFACE_IMAGES %d\n"
                 "#define SURFACE_BIASED %d\n#define SURFACE_SHADING %d\n"
                 "#define SURFACE_DRAWS %d\n",
                 (int)frame->alpha, frame->msaa, storage_of(subject), subject->images != NULL,
                 frame->level_bias != 0 && !subject->images, (int)frame->shading, draws);
    size_t size = strlen(lookups) + 1;
    slv_result result;
    for (uint32_t i = 0; i < renderer->nprograms; i++) {
        const char *made = renderer->programs[i].text;
        if (strncmp(made, head, (size_t)length) == 0 && strcmp(made + length, lookups) == 0) {
            *out = renderer->programs[i].program;
            return SLV_OK;
        }
    }
    if ((result = slvi_alloc(env, "shader", (size_t)length + size, 1, &text)))
        return result;
    memcpy(text, head, (size_t)length);
    memcpy(text + length, lookups, size);
    if ((result = slvi_gl_program(renderer->gl, env, "surface", hand_on, text, out)))
        slvi_free(text);
    else
        renderer->programs[renderer->nprograms++] = (struct program){text, *out};
    return result;
}

slv_result slv_gl_renderer_create(slv_gl *gl, const slv_env *env, const slv_mesh *mesh,
                                  const slv_surface *surface, uint32_t segments,
                                  slv_gl_renderer **out) {
    const slv_tessellation_params params = {.segments = segments};
    return slv_gl_renderer_create_with(gl, env, mesh, surface, &params, out);
}

slv_result slv_gl_renderer_create_with(slv_gl *gl, const slv_env *env, const slv_mesh *mesh,
                                       const slv_surface *surface,
                                       const slv_tessellation_params *params,
                                       slv_gl_renderer **out) {
    slv_gl_renderer *made = NULL;
    slv_result result = slvi_alloc(env, "renderer", 1, sizeof *made, &made);
    *out = NULL;
    if (result)
        return result;
    made->gl = gl;
    if ((result = slv_gl_renderer_tessellate(made, env, mesh, surface, params))) {
        slv_gl_renderer_destroy(made);
        made = NULL;
    } else {
        gl->api.CreateQueries(GL_TIMESTAMP, 2, made->queries);
    }
    *out = made;
    return result;
}

slv_result slv_gl_renderer_tessellate(slv_gl_renderer *renderer, const slv_env *env,
                                      const slv_mesh *mesh, const slv_surface *surface,
                                      const slv_tessellation_params *params) {
    const slv_gl_api *api = &renderer->gl->api;
    slv_tessellation grids = {0};
    slv_adjacency *adjacency = NULL;
    GLuint vertices = 0;
    slv_result result;
    if (!(result = slvi_gl_need_current(renderer->gl, env)) &&
        !(result = slv_mesh_adjacency(env, mesh, &adjacency)) &&
        !(result = slv_tessellate_with(env, mesh, surface, adjacency, params, &grids)))
        result =
            slvi_gl_buffer(renderer->gl, env, "vertices", grids.vertices,
                           (uint64_t)grids.first[grids.nfaces] * sizeof(slv_vertex), &vertices);
    slv_adjacency_destroy(adjacency);
    if (result) {
        slv_tessellation_free(&grids);
        return result;
    }
    slvi_free(grids.vertices); /* the driver has its own copy */
    grids.vertices = NULL;
    for (uint32_t i = 0; i < renderer->nindices; i++)
        slvi_gl_indices_free(renderer->gl, &renderer->indices[i]);
    api->DeleteBuffers(1, &renderer->vertices);
    slv_tessellation_free(&renderer->mesh);
    renderer->vertices = vertices;
    renderer->mesh = grids;
    return SLV_OK;
}

void slv_gl_renderer_destroy(slv_gl_renderer *renderer) {
    if (!renderer)
        return;
    slv_gl keeping;
    renderer->gl = slvi_gl_for_deleting(renderer->gl, &keeping);
    const slv_gl_api *api = &renderer->gl->api;
    free_target(api, &renderer->target);
    for (uint32_t i = 0; i < renderer->nindices; i++)
        slvi_gl_indices_free(renderer->gl, &renderer->indices[i]);
    slvi_free(renderer->indices);
    free_programs(renderer);
    slvi_gl_blender_free(renderer->gl, &renderer->blender);
    api->DeleteBuffers(1, &renderer->vertices);
    api->DeleteQueries(2, renderer->queries);
    slv_tessellation_free(&renderer->mesh);
    slvi_free(renderer);
}

uint32_t slv_gl_renderer_framebuffer(const slv_gl_renderer *renderer) {
    return renderer->target.framebuffers[renderer->target.msaa > 1];
}

uint64_t slv_gl_renderer_triangles(const slv_gl_renderer *renderer) {
    uint64_t count = 0;
    for (uint32_t f = 0; f < renderer->mesh.nfaces; f++)
        count += slv_tessellation_indices(&renderer->mesh, f, NULL) / 3;
    return count;
}

/* Column-major, from window and the depth range of the surface seen from the eye. */
static void projection(const slv_gl_renderer *renderer, const slv_camera *camera, float out[16]) {
    const float *w = camera->window;
    float n, f;
    slv_camera_depths(camera, renderer->mesh.bounds_min, renderer->mesh.bounds_max, &n, &f);
    memset(out, 0, 16 * sizeof *out);
    out[0] = 2 / (w[1] - w[0]);
    out[5] = 2 / (w[3] - w[2]);
    if (camera->perspective) {
        out[8] = (w[1] + w[0]) / (w[1] - w[0]);
        out[9] = (w[3] + w[2]) / (w[3] - w[2]);
        out[10] = (n + f) / (n - f);
        out[11] = -1;
        out[14] = 2 * n * f / (n - f);
    } else {
        out[12] = -(w[1] + w[0]) / (w[1] - w[0]);
        out[13] = -(w[3] + w[2]) / (w[3] - w[2]);
        out[10] = 2 / (n - f);
        out[14] = (n + f) / (n - f);
        out[15] = 1;
    }
}

static void set_frame(const slv_gl_renderer *renderer, const slv_frame *frame, GLuint program) {
    const slv_gl_api *api = &renderer->gl->api;
    float to_eye[16], to_clip[16], normals[9];
    for (int r = 0; r < 4; r++)
        for (int c = 0; c < 4; c++)
            to_eye[4 * c + r] = frame->camera.world_to_camera[4 * r + c];
    projection(renderer, &frame->camera, to_clip);
    slv_camera_normal_matrix(&frame->camera, normals);
    api->ProgramUniformMatrix4fv(program, 0, 1, GL_FALSE, to_eye);
    api->ProgramUniformMatrix4fv(program, 1, 1, GL_FALSE, to_clip);
    api->ProgramUniformMatrix3fv(program, 2, 1, GL_TRUE, normals);
    api->ProgramUniform1i(program, 4, frame->camera.perspective);
    api->ProgramUniform2f(program, 5, frame->ka, frame->kd);
    if (frame->shading == SLV_SHADE_IMAGE) /* as the camera carries normals, but the other way */
        for (int c = 0; c < 3; c++)
            api->ProgramUniformMatrix4fv(program, 8 + c, 1, GL_FALSE, frame->light->matrices[c]);
    if (frame->level_bias != 0)
        api->ProgramUniform1f(program, 7, exp2f(frame->level_bias));
}

static void draw_batches(const slv_gl_renderer *renderer, slv_gl_texture *texture,
                         const slv_gl_indices *indices,
                         const GLuint programs[SLV_GL_MAX_VARIANTS]) {
    const slv_gl_api *api = &renderer->gl->api;
    GLuint current = 0;
    slv_gl_run run;
    api->BindVertexArray(indices->array);
    slv_gl_texture_bind_shared(texture, indices->strategy);
    for (uint32_t b = 0; (run = slv_gl_texture_run(texture, indices->strategy, b)).nbatches;
         b += run.nbatches) {
        GLuint program = programs[run.variant];
        if (program != current)
            api->UseProgram(program);
        current = program;
        slv_gl_texture_bind_batch(texture, indices->strategy, b);
        api->MultiDrawElements(GL_TRIANGLES, indices->counts + b, GL_UNSIGNED_INT, indices->at + b,
                               (GLsizei)run.nbatches);
    }
}

static void draw_images(const slv_gl_images *images, const slv_gl_indices *indices,
                        GLuint program) {
    const slv_gl_api *api = &images->gl->api;
    api->BindVertexArray(indices->array);
    api->UseProgram(program);
    slvi_gl_images_bind(images);
    for (uint32_t b = 0; b < images->batches.count; b++) {
        slvi_gl_images_bind_batch(images, b, program);
        api->DrawElements(GL_TRIANGLES, indices->counts[b], GL_UNSIGNED_INT, indices->at[b]);
    }
    slvi_gl_images_unbind(images);
}

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + (double)time.tv_nsec * 1e-9;
}

static slv_result read_back(slv_gl_renderer *renderer, const slv_env *env, slv_image *image) {
    const slv_gl_api *api = &renderer->gl->api;
    const struct target *target = &renderer->target;
    slv_result result = slv_image_create(env, target->width, target->height, 4, image);
    size_t row = (size_t)target->width * 4;
    if (result)
        return result;
    api->BindFramebuffer(GL_READ_FRAMEBUFFER, target->framebuffers[target->msaa > 1]);
    api->ReadBuffer(GL_COLOR_ATTACHMENT0);
    api->ReadPixels(0, 0, (GLsizei)target->width, (GLsizei)target->height, GL_RGBA, GL_FLOAT,
                    image->pixels);
    for (uint32_t y = 0; y < target->height / 2; y++) { /* OpenGL's first row is the lowest */
        float *a = image->pixels + y * row, *b = image->pixels + (target->height - 1 - y) * row;
        for (size_t i = 0; i < row; i++) {
            float swapped = a[i];
            a[i] = b[i];
            b[i] = swapped;
        }
    }
    return SLV_OK;
}

static slv_frame with_defaults(const slv_frame *given) {
    slv_frame frame = *given;
    frame.width = frame.width ? frame.width : 512;
    frame.height = frame.height ? frame.height : 512;
    frame.msaa = frame.msaa ? frame.msaa : 1;
    if (frame.ka == 0 && frame.kd == 0) {
        frame.ka = 0.2f;
        frame.kd = 0.8f;
    }
    return frame;
}

static slv_result check_frame(const slv_gl_renderer *renderer, const slv_env *env,
                              const slv_frame *frame, const char *what, uint32_t nfaces) {
    const slv_gl_info *info = &renderer->gl->info;
    if (nfaces != renderer->mesh.nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "%s %u faces, the mesh %u", what, nfaces,
                         renderer->mesh.nfaces);
    if (frame->shading == SLV_SHADE_IMAGE && !frame->light)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "the shading by an image has no light");
    if ((unsigned)frame->alpha > SLV_ALPHA_MASK)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "there is no alpha mode %d", (int)frame->alpha);
    if (frame->msaa > info->max_msaa || (frame->msaa & (frame->msaa - 1)))
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED,
                         "%u samples per pixel: the driver has at most %u", frame->msaa,
                         info->max_msaa);
    return slvi_gl_need_current(renderer->gl, env);
}

static void draw_subject(const slv_gl_renderer *renderer, const struct subject *subject) {
    if (subject->images)
        draw_images(subject->images, subject->indices, subject->programs[0]);
    else
        draw_batches(renderer, subject->texture, subject->indices, subject->programs);
}

struct blending {
    const slv_gl_renderer *renderer;
    const struct subject *subject;
};

static void draw_fragments(void *user, const GLint room[4]) {
    const struct blending *b = user;
    for (uint32_t v = 0; v < SLV_GL_MAX_VARIANTS; v++)
        if (b->subject->programs[v])
            b->renderer->gl->api.ProgramUniform4i(b->subject->programs[v], 6, room[0], room[1],
                                                  room[2], room[3]);
    draw_subject(b->renderer, b->subject);
}

static slv_result blend_subject(slv_gl_renderer *renderer, const slv_env *env,
                                const slv_frame *frame, const struct subject *subject) {
    const struct target *target = &renderer->target;
    struct blending blending = {renderer, subject};
    const slv_gl_blend blend = {.drawn = target->framebuffers[0],
                                .shown = target->framebuffers[target->msaa > 1],
                                .width = frame->width,
                                .height = frame->height,
                                .msaa = frame->msaa,
                                .storage = storage_of(subject),
                                .background = frame->background,
                                .array = subject->indices->array,
                                .draw = draw_fragments,
                                .user = &blending};
    return slvi_gl_blend(renderer->gl, env, &renderer->blender, &blend);
}

/* Clears, draws, resolves, and reads back. */
static slv_result make_frame(slv_gl_renderer *renderer, const slv_env *env, const slv_frame *frame,
                             const struct subject *subject, slv_image *image, double *seconds) {
    slv_gl *gl = renderer->gl;
    const slv_gl_api *api = &gl->api;
    slv_result result = SLV_OK;
    slvi_gl_set_state(gl);
    static const float far_away = 1;
    const struct target *target = &renderer->target;
    bool timed = seconds && !gl->info.software;
    if (seconds && gl->info.software)
        api->Finish();
    double start = now();
    if (timed) /* the host may have a query of elapsed time of its own, of which there is one */
        api->QueryCounter(renderer->queries[0], GL_TIMESTAMP);
    api->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffers[0]);
    api->Viewport(0, 0, (GLsizei)frame->width, (GLsizei)frame->height);
    api->Enable(GL_DEPTH_TEST);
    api->ClearNamedFramebufferfv(target->framebuffers[0], GL_COLOR, 0, frame->background);
    api->ClearNamedFramebufferfv(target->framebuffers[0], GL_DEPTH, 0, &far_away);
    if (frame->alpha == SLV_ALPHA_BLEND)
        result = blend_subject(renderer, env, frame, subject);
    else
        draw_subject(renderer, subject);
    if (frame->msaa > 1 && frame->alpha != SLV_ALPHA_BLEND)
        api->BlitNamedFramebuffer(target->framebuffers[0], target->framebuffers[1], 0, 0,
                                  (GLint)frame->width, (GLint)frame->height, 0, 0,
                                  (GLint)frame->width, (GLint)frame->height, GL_COLOR_BUFFER_BIT,
                                  GL_NEAREST);
    if (timed) {
        GLuint64 at[2] = {0};
        api->QueryCounter(renderer->queries[1], GL_TIMESTAMP);
        for (int i = 0; i < 2; i++)
            api->GetQueryObjectui64v(renderer->queries[i], GL_QUERY_RESULT, &at[i]);
        *seconds = (double)(at[1] - at[0]) * 1e-9;
    } else if (seconds) {
        api->Finish();
        *seconds = now() - start;
    }
    if (image && !result)
        result = read_back(renderer, env, image);
    if (subject->texture)
        slv_gl_texture_unbind(subject->texture);
    api->BindVertexArray(0);
    api->BindFramebuffer(GL_FRAMEBUFFER, 0);
    if (!result && (result = slvi_gl_check(gl, env, "drawing")) && image)
        slv_image_free(image);
    return result;
}

slv_result slv_gl_renderer_draw(slv_gl_renderer *renderer, const slv_env *env,
                                slv_gl_texture *texture, const slv_frame *given, slv_image *image,
                                double *seconds) {
    slv_frame frame = with_defaults(given);
    struct subject subject = {.texture = texture};
    const slv_gl_batches *batches = slvi_gl_texture_batches(texture, frame.strategy);
    slv_gl_indices *indices = NULL;
    slv_gl_slot *slot = NULL;
    slv_result result = slvi_gl_texture_need(texture, env, frame.strategy, &slot);
    if (result || (result = check_frame(renderer, env, &frame, "the texture has",
                                        slv_gl_texture_face_count(texture))))
        return result;
    if ((result = make_target(renderer->gl, env, &frame, &renderer->target)) ||
        (result = indices_of(renderer, env, slot->strategy, &indices)) ||
        (result = slvi_gl_indices_make(renderer->gl, env, &renderer->mesh, renderer->vertices,
                                       texture->serial, batches, indices)))
        return result;
    subject.indices = indices;
    subject.slot = slot;
    /* A viewer that keeps making textures starts afresh now and then: before a frame has collected
     * its programs, not amid. */
    if (renderer->nprograms + SLV_GL_MAX_VARIANTS > MAX_PROGRAMS)
        free_programs(renderer);
    for (uint32_t b = 0; b < batches->count; b++) {
        uint32_t variant = batches->ranges[b].variant;
        if (subject.programs[variant])
            continue;
        const char *lookups = NULL;
        if ((result = slvi_gl_texture_text(texture, slot->strategy, variant, &lookups)) ||
            (result = surface_program(renderer, env, &frame, &subject, lookups,
                                      &subject.programs[variant])))
            return result;
        set_frame(renderer, &frame, subject.programs[variant]);
    }
    return make_frame(renderer, env, &frame, &subject, image, seconds);
}

slv_result slv_gl_renderer_draw_images(slv_gl_renderer *renderer, const slv_env *env,
                                       slv_gl_images *images, const slv_frame *given,
                                       slv_image *image, double *seconds) {
    slv_frame frame = with_defaults(given);
    struct subject subject = {.images = images};
    slv_gl_indices *indices = NULL;
    slv_result result = check_frame(renderer, env, &frame, "the images are for", images->nfaces);
    if (result || (result = make_target(renderer->gl, env, &frame, &renderer->target)) ||
        (result = indices_of(renderer, env, NULL, &indices)) ||
        (result = slvi_gl_indices_make(renderer->gl, env, &renderer->mesh, renderer->vertices,
                                       images->serial, &images->batches, indices)))
        return result;
    subject.indices = indices;
    if (renderer->nprograms == MAX_PROGRAMS)
        free_programs(renderer);
    if ((result = surface_program(renderer, env, &frame, &subject, images->lookups,
                                  &subject.programs[0])))
        return result;
    set_frame(renderer, &frame, subject.programs[0]);
    return make_frame(renderer, env, &frame, &subject, image, seconds);
}
