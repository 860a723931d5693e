/* Lookups for a list of points, drawn as points into a target of floats. */
#include "gl/store/texture.h"

#include "base/log.h"
#include "base/memory.h"

#include <stddef.h>
#include <string.h>

#define TARGET_WIDTH 1024
#define CHUNK (1u << 20)

struct point {
    int32_t face;
    float uv[2], dx[2], dy[2];
};

struct target {
    GLuint framebuffer, color, vertices, indices, array;
};

static slv_result lookup_program(slv_gl_texture *texture, const slv_env *env, slv_gl_slot *slot,
                                 uint32_t variant, GLuint *out) {
    GLuint *program = &slot->lookup_programs[variant];
    const char *lookups = NULL;
    slv_result result = SLV_OK;
    if (!*program && !(result = slvi_gl_texture_text(texture, slot->strategy, variant, &lookups)))
        result = slvi_gl_program(texture->gl, env, "lookup", NULL, lookups, program);
    *out = *program;
    return result;
}

static void free_target(const slv_gl_api *api, struct target *target) {
    api->BindFramebuffer(GL_FRAMEBUFFER, 0);
    api->BindVertexArray(0);
    api->DeleteFramebuffers(1, &target->framebuffer);
    api->DeleteRenderbuffers(1, &target->color);
    api->DeleteBuffers(1, &target->vertices);
    api->DeleteBuffers(1, &target->indices);
    api->DeleteVertexArrays(1, &target->array);
}

static void make_target(const slv_gl_api *api, uint32_t height, const struct point *points,
                        const uint32_t *order, uint32_t count, struct target *out) {
    static const GLuint offsets[3] = {offsetof(struct point, uv), offsetof(struct point, dx),
                                      offsetof(struct point, dy)};
    api->CreateFramebuffers(1, &out->framebuffer);
    api->CreateRenderbuffers(1, &out->color);
    api->NamedRenderbufferStorageMultisample(out->color, 0, GL_RGBA32F, TARGET_WIDTH,
                                             (GLsizei)height);
    api->NamedFramebufferRenderbuffer(out->framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                      out->color);
    api->CreateBuffers(1, &out->vertices);
    api->NamedBufferStorage(out->vertices, (GLsizeiptr)(count * sizeof *points), points, 0);
    api->CreateBuffers(1, &out->indices);
    api->NamedBufferStorage(out->indices, (GLsizeiptr)(count * sizeof *order), order, 0);
    api->CreateVertexArrays(1, &out->array);
    api->VertexArrayVertexBuffer(out->array, 0, out->vertices, 0, sizeof *points);
    api->VertexArrayElementBuffer(out->array, out->indices);
    api->EnableVertexArrayAttrib(out->array, 0);
    api->VertexArrayAttribIFormat(out->array, 0, 1, GL_INT, 0);
    api->VertexArrayAttribBinding(out->array, 0, 0);
    for (GLuint i = 0; i < 3; i++) {
        api->EnableVertexArrayAttrib(out->array, i + 1);
        api->VertexArrayAttribFormat(out->array, i + 1, 2, GL_FLOAT, GL_FALSE, offsets[i]);
        api->VertexArrayAttribBinding(out->array, i + 1, 0);
    }
}

/* Lookups sorted by batch: `first` has a start for each batch and one past the last. */
static void sort_by_batch(const slv_gl_batches *batches, const uint32_t *batch_of,
                          const struct point *points, uint32_t count, uint32_t *first,
                          uint32_t *order) {
    memset(first, 0, (batches->count + 1) * sizeof *first);
    for (uint32_t i = 0; i < count; i++)
        first[batch_of[points[i].face] + 1]++;
    for (uint32_t b = 0; b < batches->count; b++)
        first[b + 1] += first[b];
    for (uint32_t i = 0; i < count; i++)
        order[first[batch_of[points[i].face]]++] = i;
    for (uint32_t b = batches->count; b > 0; b--)
        first[b] = first[b - 1];
    first[0] = 0;
}

/* Draws one chunk of points. Its parameters are many since chunks share memory, which the caller
 * allocates once. */
static slv_result lookup_chunk(slv_gl_texture *texture, const slv_env *env, slv_gl_slot *slot,
                               const uint32_t *batch_of, const struct point *points, uint32_t count,
                               uint32_t *first, uint32_t *order, float *out) {
    const slv_gl_batches *batches = slvi_gl_texture_batches(texture, slot->strategy);
    const slv_gl_api *api = &texture->gl->api;
    uint32_t height = (count + TARGET_WIDTH - 1) / TARGET_WIDTH;
    uint32_t whole = count / TARGET_WIDTH, rest = count % TARGET_WIDTH;
    struct target target = {0};
    slv_result result = SLV_OK;
    sort_by_batch(batches, batch_of, points, count, first, order);
    slvi_gl_set_state(texture->gl);
    make_target(api, height, points, order, count, &target);
    if (api->CheckNamedFramebufferStatus(target.framebuffer, GL_FRAMEBUFFER) !=
        GL_FRAMEBUFFER_COMPLETE)
        result = slvi_fail(env, SLV_ERROR_GL, "the driver makes no target for %u lookups", count);
    api->BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
    api->Viewport(0, 0, TARGET_WIDTH, (GLsizei)height);
    api->Disable(GL_DEPTH_TEST);
    api->BindVertexArray(target.array);
    slv_gl_texture_bind_shared(texture, slot->strategy);
    for (uint32_t b = 0; !result && b < batches->count; b++) {
        GLuint program = 0;
        uint32_t here = first[b + 1] - first[b];
        if (!here)
            continue;
        if ((result = lookup_program(texture, env, slot, batches->ranges[b].variant, &program)))
            break;
        api->ProgramUniform2f(program, 0, TARGET_WIDTH, (float)height);
        api->UseProgram(program);
        slv_gl_texture_bind_batch(texture, slot->strategy, b);
        api->DrawElements(GL_POINTS, (GLsizei)here, GL_UNSIGNED_INT,
                          (const void *)(uintptr_t)(first[b] * sizeof *order));
    }
    api->ReadBuffer(GL_COLOR_ATTACHMENT0);
    if (!result && whole)
        api->ReadPixels(0, 0, TARGET_WIDTH, (GLsizei)whole, GL_RGBA, GL_FLOAT, out);
    if (!result && rest)
        api->ReadPixels(0, (GLint)whole, (GLsizei)rest, 1, GL_RGBA, GL_FLOAT,
                        out + 4 * (size_t)TARGET_WIDTH * whole);
    slv_gl_texture_unbind(texture);
    free_target(api, &target);
    return result ? result : slvi_gl_check(texture->gl, env, "lookups");
}

/* Nine parameters, since callers have an array for each part of a point. */
slv_result slv_gl_texture_lookup(slv_gl_texture *texture, const slv_env *env,
                                 const slv_strategy *strategy, uint32_t count, const int32_t *faces,
                                 const float *uv, const float *dx, const float *dy, float *out) {
    const slv_gl_batches *batches = slvi_gl_texture_batches(texture, strategy);
    uint32_t *batch_of = NULL, *first = NULL, *order = NULL;
    struct point *points = NULL;
    uint32_t chunk = count < CHUNK ? count : CHUNK;
    slv_result result = SLV_OK;
    slv_gl_slot *slot = NULL;
    if ((result = slvi_gl_texture_need(texture, env, strategy, &slot)) ||
        (result = slvi_gl_texture_need_ready(texture, env)) ||
        (result = slvi_alloc(env, "lookups", texture->nfaces, sizeof *batch_of, &batch_of)) ||
        (result = slvi_alloc(env, "lookups", batches->count + 1, sizeof *first, &first)) ||
        (result = slvi_alloc(env, "lookups", chunk, sizeof *order, &order)) ||
        (result = slvi_alloc(env, "lookups", chunk, sizeof *points, &points)))
        goto done;
    for (uint32_t b = 0; b < batches->count; b++)
        for (uint32_t i = 0; i < batches->ranges[b].count; i++)
            batch_of[batches->faces[batches->ranges[b].first + i]] = b;
    for (uint32_t start = 0; !result && start < count; start += chunk) {
        uint32_t here = count - start < chunk ? count - start : chunk;
        for (uint32_t i = 0; i < here; i++) {
            size_t at = (size_t)start + i;
            if (faces[at] < 0 || (uint32_t)faces[at] >= texture->nfaces) {
                result = slvi_fail(env, SLV_ERROR_ARGUMENT, "lookup %zu: there is no face %d", at,
                                   faces[at]);
                goto done;
            }
            points[i] = (struct point){faces[at],
                                       {uv[2 * at], uv[2 * at + 1]},
                                       {dx[2 * at], dx[2 * at + 1]},
                                       {dy[2 * at], dy[2 * at + 1]}};
        }
        result = lookup_chunk(texture, env, slot, batch_of, points, here, first, order,
                              out + 4 * (size_t)start);
    }
done:
    slvi_free(batch_of);
    slvi_free(first);
    slvi_free(order);
    slvi_free(points);
    return result;
}
