/* Lists of fragments, one for each pixel (Yang and others 2010, "Real-time concurrent linked list
 * construction on the GPU"): sorted where they are read, so that no triangle needs to be. */
#include "gl/draw/blend.h"

#include "gl/store/tables.h"

#include "base/log.h"

#include <stdio.h>
#include <string.h>

#define FRAGMENT_BYTES 32
#define LISTS_MOST (UINT64_C(512) << 20) /* bytes; more is drawn in bands */

void slvi_gl_blender_free(const slv_gl *gl, slv_gl_blender *blender) {
    slvi_gl_delete(gl->api.DeleteBuffers, &blender->heads);
    slvi_gl_delete(gl->api.DeleteBuffers, &blender->fragments);
    if (blender->program)
        gl->api.DeleteProgram(blender->program);
    memset(blender, 0, sizeof *blender);
}

static slv_result need_program(const slv_gl *gl, const slv_env *env, slv_gl_blender *blender,
                               const slv_gl_blend *blend) {
    char head[96];
    if (blender->program && blender->storage == blend->storage && blender->msaa == blend->msaa)
        return SLV_OK;
    if (blender->program)
        gl->api.DeleteProgram(blender->program);
    blender->program = 0;
    snprintf(head, sizeof head, "#define SURFACE_STORAGE %u\n#define SURFACE_MSAA %u\n",
             blend->storage, blend->msaa);
    blender->storage = blend->storage;
    blender->msaa = blend->msaa;
    return slvi_gl_program(gl, env, "blend", NULL, head, &blender->program);
}

static slv_result need_buffer(const slv_gl *gl, const slv_env *env, uint64_t bytes,
                              GLuint *buffer) {
    slvi_gl_delete(gl->api.DeleteBuffers, buffer);
    *buffer = 0;
    gl->api.CreateBuffers(1, buffer);
    gl->api.NamedBufferStorage(*buffer, (GLsizeiptr)bytes, NULL, GL_DYNAMIC_STORAGE_BIT);
    return slvi_gl_check(gl, env, "fragments to blend");
}

static uint64_t most_of(const slv_gl *gl) {
    return gl->max_storage < LISTS_MOST ? gl->max_storage : LISTS_MOST;
}

static slv_result need_buffers(const slv_gl *gl, const slv_env *env, slv_gl_blender *blender,
                               uint64_t heads_bytes, uint64_t room) {
    slv_result result = SLV_OK;
    if (blender->heads_bytes < heads_bytes) {
        blender->heads_bytes = 0;
        if ((result = need_buffer(gl, env, heads_bytes, &blender->heads)))
            return result;
        blender->heads_bytes = heads_bytes;
    }
    if (blender->room < room) {
        blender->room = 0;
        if ((result = need_buffer(gl, env, 16 + room * FRAGMENT_BYTES, &blender->fragments)))
            return result;
        blender->room = room;
    }
    return SLV_OK;
}

/* Lists of rows first..first+rows-1. Returns how many fragments they have, or would have. */
static uint64_t make_lists(const slv_gl *gl, const slv_gl_blender *blender,
                           const slv_gl_blend *blend, uint32_t first, uint32_t rows) {
    const slv_gl_api *api = &gl->api;
    const GLuint zero = 0;
    const GLuint buffers[2] = {blender->heads, blender->fragments};
    const GLintptr at[2] = {0, 0};
    const GLsizeiptr sizes[2] = {(GLsizeiptr)blender->heads_bytes,
                                 (GLsizeiptr)(16 + blender->room * FRAGMENT_BYTES)};
    const GLint room[4] = {(GLint)blend->width, (GLint)first, (GLint)blender->room, 0};
    GLuint count = 0;
    api->ClearNamedBufferSubData(blender->heads, GL_R32UI, 0,
                                 (GLsizeiptr)(4 * (uint64_t)blend->width * rows), GL_RED_INTEGER,
                                 GL_UNSIGNED_INT, &zero);
    api->ClearNamedBufferSubData(blender->fragments, GL_R32UI, 0, 16, GL_RED_INTEGER,
                                 GL_UNSIGNED_INT, &zero);
    api->BindBuffersRange(GL_SHADER_STORAGE_BUFFER, blend->storage, 2, buffers, at, sizes);
    api->BindFramebuffer(GL_FRAMEBUFFER, blend->drawn);
    api->Scissor(0, (GLint)first, (GLsizei)blend->width, (GLsizei)rows);
    api->Disable(GL_DEPTH_TEST);
    api->ColorMask(0, 0, 0, 0);
    blend->draw(blend->user, room);
    api->ColorMask(1, 1, 1, 1);
    api->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    api->GetNamedBufferSubData(blender->fragments, 0, sizeof count, &count);
    return count;
}

static void show_lists(const slv_gl *gl, const slv_gl_blender *blender, const slv_gl_blend *blend,
                       uint32_t first) {
    const slv_gl_api *api = &gl->api;
    api->BindFramebuffer(GL_FRAMEBUFFER, blend->shown);
    api->ProgramUniform4i(blender->program, 0, (GLint)blend->width, (GLint)first, 0, 0);
    api->ProgramUniform4fv(blender->program, 1, 1, blend->background);
    api->UseProgram(blender->program);
    api->BindVertexArray(blend->array);
    api->DrawArrays(GL_TRIANGLES, 0, 3);
}

slv_result slvi_gl_blend(const slv_gl *gl, const slv_env *env, slv_gl_blender *blender,
                         const slv_gl_blend *blend) {
    const uint64_t most = (most_of(gl) - 16) / FRAGMENT_BYTES, pixel = 4;
    uint32_t rows = blend->height;
    slv_result result = need_program(gl, env, blender, blend);
    while (rows > 1 && pixel * blend->width * rows > most_of(gl))
        rows = (rows + 1) / 2;
    if (!result) {
        uint64_t guess = 4 * (uint64_t)blend->width * rows;
        result = need_buffers(gl, env, blender, pixel * blend->width * rows,
                              guess < most ? guess : most);
    }
    gl->api.Enable(GL_SCISSOR_TEST);
    for (uint32_t first = 0; !result && first < blend->height;) {
        uint32_t left = blend->height - first, band = rows < left ? rows : left;
        uint64_t count = make_lists(gl, blender, blend, first, band);
        if (count <= blender->room) {
            show_lists(gl, blender, blend, first);
            first += band;
            if (first <
                blend->height) /* Mesa's llvmpipe clears buffers that are still to be read */
                gl->api.Finish();
        } else if (count <= most) {
            result = need_buffers(gl, env, blender, 0, count);
        } else if (band > 1) {
            rows = (band + 1) / 2;
        } else {
            result = slvi_fail(env, SLV_ERROR_LIMIT,
                               "a row of the picture has %llu fragments to blend, there is room "
                               "for %llu",
                               (unsigned long long)count, (unsigned long long)most);
        }
    }
    gl->api.Disable(GL_SCISSOR_TEST);
    return result ? result : slvi_gl_check(gl, env, "blending");
}
