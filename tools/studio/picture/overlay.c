/* Draws the surface once more: faces' edges, triangles, sizes of textures. */
#include "studio/picture/overlay.h"

#include "studio/picture/screen.h"

#include <selvage/tessellation.h>

#include <epoxy/gl.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>

struct studio_overlay_pass {
    slv_tessellation mesh;
    GLuint program, array, vertices, indices, table, depth;
    GLsizei count;
    uint32_t width, height;
    uint32_t *info; /* what is in the table */
};

static const char vertex_text[] = "#version 450 core\n"
                                  "layout(location = 0) in vec3 position;\n"
                                  "layout(location = 1) in vec2 uv;\n"
                                  "layout(location = 2) in int face;\n"
                                  "layout(location = 0) uniform mat4 to_clip;\n"
                                  "layout(location = 0) out vec2 at;\n"
                                  "layout(location = 1) flat out int id;\n"
                                  "void main() {\n"
                                  "    at = uv;\n"
                                  "    id = face;\n"
                                  "    gl_Position = to_clip * vec4(position, 1.0);\n"
                                  "}\n";

static const char fragment_text[] =
    "#version 450 core\n"
    "layout(location = 0) in vec2 at;\n"
    "layout(location = 1) flat in int id;\n"
    "layout(location = 1) uniform ivec4 show; // seams, wires, overlay, segments\n"
    "layout(std430, binding = 0) readonly buffer faces { uint info[]; }; // as face_info has it\n"
    "layout(location = 0) out vec4 color;\n"
    "vec3 hue(float h) {\n"
    "    return clamp(abs(fract(h + vec3(0.0, 2.0, 1.0) / 3.0) * 6.0 - 3.0) - 1.0, 0.0, 1.0);\n"
    "}\n"
    "void main() {\n"
    "    uint face = info[id];\n"
    "    vec2 width = max(fwidth(at), vec2(1e-9));\n"
    "    vec4 edges = vec4(at.y / width.y, (1.0 - at.x) / width.x, (1.0 - at.y) / width.y,\n"
    "                      at.x / width.x);\n"
    "    color = (face >> 24 & 1u) != 0u ? vec4(0.0, 0.0, 0.0, 0.7) : vec4(0.0);\n"
    "    if (show.z == 2)\n"
    "        color = vec4(hue(float((face & 255u) + (face >> 8 & 255u)) / 18.0), 0.7);\n"
    "    if (show.z >= 4) // widened, damaged: the others step back\n"
    "        color = (face >> (21 + show.z) & 1u) != 0u ? vec4(0.9, 0.02, 0.5, 0.6)\n"
    "                                                   : vec4(0.0, 0.0, 0.0, 0.6);\n"
    "    if (show.y != 0) {\n"
    "        vec2 cell = abs(fract(at * float(show.w) + 0.5) - 0.5) / (width * float(show.w));\n"
    "        float line = min(cell.x, cell.y);\n"
    "        if (line < 0.5)\n"
    "            color = vec4(0.02, 0.02, 0.02, 0.8);\n"
    "    }\n"
    "    for (int e = 0; show.x != 0 && e < 4; e++)\n"
    "        if (edges[e] < 1.0)\n"
    "            color = (face >> (20 + e) & 1u) != 0u   ? vec4(0.05, 0.2, 0.9, 1.0)\n"
    "                    : (face >> (16 + e) & 1u) != 0u ? vec4(0.9, 0.25, 0.02, 1.0)\n"
    "                                                    : vec4(0.9, 0.9, 0.9, 0.8);\n"
    "}\n";

void studio_overlay_destroy(studio_overlay_pass *p) {
    if (!p)
        return;
    const GLuint buffers[3] = {p->vertices, p->indices, p->table};
    glDeleteProgram(p->program);
    glDeleteVertexArrays(1, &p->array);
    glDeleteBuffers(3, buffers);
    glDeleteRenderbuffers(1, &p->depth);
    slv_tessellation_free(&p->mesh);
    free(p->info);
    free(p);
}

static void make_array(studio_overlay_pass *p) {
    static const struct {
        GLenum type;
        GLint count;
        GLuint at;
    } attributes[] = {{GL_FLOAT, 3, offsetof(slv_vertex, position)},
                      {GL_HALF_FLOAT, 2, offsetof(slv_vertex, uv)},
                      {GL_INT, 1, offsetof(slv_vertex, face)}};
    glCreateVertexArrays(1, &p->array);
    glVertexArrayVertexBuffer(p->array, 0, p->vertices, 0, sizeof(slv_vertex));
    glVertexArrayElementBuffer(p->array, p->indices);
    for (GLuint i = 0; i < 3; i++) {
        glEnableVertexArrayAttrib(p->array, i);
        glVertexArrayAttribBinding(p->array, i, 0);
        if (attributes[i].type == GL_INT)
            glVertexArrayAttribIFormat(p->array, i, 1, GL_INT, attributes[i].at);
        else
            glVertexArrayAttribFormat(p->array, i, attributes[i].count, attributes[i].type,
                                      GL_FALSE, attributes[i].at);
    }
}

static slv_result make(const studio_document *d, uint32_t segments, studio_overlay_pass **out) {
    studio_overlay_pass *p = calloc(1, sizeof *p);
    uint32_t *indices = NULL;
    uint64_t count = 0;
    const slv_tessellation_params params = {.segments = segments,
                                            .displacement = studio_document_displacement(d)};
    slv_result result = SLV_ERROR_MEMORY;
    *out = p;
    if (p && !(result = slv_tessellate_with(&d->env, studio_document_mesh(d), d->scene.surface,
                                            studio_document_adjacency(d), &params, &p->mesh))) {
        for (uint32_t f = 0; f < p->mesh.nfaces; f++)
            count += slv_tessellation_indices(&p->mesh, f, NULL);
        indices = count < INT32_MAX ? malloc(count * sizeof *indices + 1) : NULL;
        p->info = calloc((size_t)p->mesh.nfaces + 1, sizeof *p->info);
    }
    if (result || !indices || !p->info ||
        !(p->program = studio_program(&d->env, vertex_text, fragment_text))) {
        free(indices);
        studio_overlay_destroy(p);
        *out = NULL;
        return result ? result : SLV_ERROR_MEMORY;
    }
    uint64_t at = 0;
    for (uint32_t f = 0; f < p->mesh.nfaces; f++)
        at += slv_tessellation_indices(&p->mesh, f, indices + at);
    glCreateBuffers(1, &p->vertices);
    glCreateBuffers(1, &p->indices);
    glNamedBufferStorage(p->vertices,
                         (GLsizeiptr)(p->mesh.first[p->mesh.nfaces] * sizeof(slv_vertex)),
                         p->mesh.vertices, 0);
    glNamedBufferStorage(p->indices, (GLsizeiptr)(count * sizeof *indices), indices, 0);
    p->count = (GLsizei)count;
    free(indices);
    slv_free(p->mesh.vertices);
    p->mesh.vertices = NULL;
    make_array(p);
    return SLV_OK;
}

/* log2 of the width and height of a face, a bit for each edge across which texels have another
 * size, one for each where there is nothing, and one where it is to be darker. */
static uint32_t face_info(const slv_res *res, const slv_face_adjacency *adjacency, uint32_t f) {
    uint32_t info = (uint32_t)res[f].u | (uint32_t)res[f].v << 8;
    for (uint32_t e = 0; e < 4; e++) {
        int32_t other = adjacency[f].face[e];
        uint32_t turned = (e ^ adjacency[f].edge[e]) & 1;
        bool differs =
            other >= 0 && (turned ? res[other].u != res[f].v || res[other].v != res[f].u
                                  : res[other].u != res[f].u || res[other].v != res[f].v);
        info |= (uint32_t)differs << (16 + e) | (uint32_t)(other < 0) << (20 + e);
    }
    return info;
}

bool studio_overlay_wanted(const studio_look *look) {
    return look->seams || look->wires || look->overlay == STUDIO_OVERLAY_RESOLUTION ||
           look->overlay == STUDIO_OVERLAY_WIDENED || look->overlay == STUDIO_OVERLAY_DAMAGED;
}

/* What the faces are now. */
static void fill_table(studio_overlay_pass *p, const studio_document *d, const uint8_t *meant,
                       const studio_overlay_target *target) {
    const uint8_t *damaged = d->scene.damaged;
    const slv_res *res = slv_texture_get_desc(d->texture)->res;
    const slv_face_adjacency *adjacency = slv_adjacency_faces(studio_document_adjacency(d));
    const uint32_t n = p->mesh.nfaces;
    bool same = p->table != 0;
    for (uint32_t f = 0; f < n; f++) {
        uint32_t now = face_info(res, adjacency, f) | (uint32_t)(meant && !meant[f]) << 24 |
                       (uint32_t)slv_gl_texture_is_widened(target->texture, target->strategy, f)
                           << 25 |
                       (uint32_t)(damaged && damaged[f]) << 26;
        same = same && p->info[f] == now;
        p->info[f] = now;
    }
    if (same)
        return;
    glDeleteBuffers(1, &p->table);
    glCreateBuffers(1, &p->table);
    glNamedBufferStorage(p->table, (GLsizeiptr)(n * sizeof *p->info), p->info, 0);
}

/* Column-major: window and depths of the surface, as the renderer has them. */
static void set_camera(const studio_overlay_pass *p, const slv_camera *camera) {
    const float *w = camera->window, *m = camera->world_to_camera;
    float n, f, clip[4][4] = {{0}}, all[16];
    slv_camera_depths(camera, p->mesh.bounds_min, p->mesh.bounds_max, &n, &f);
    clip[0][0] = 2 / (w[1] - w[0]);
    clip[1][1] = 2 / (w[3] - w[2]);
    clip[0][camera->perspective ? 2 : 3] =
        (w[1] + w[0]) / (w[1] - w[0]) * (camera->perspective ? 1.0f : -1.0f);
    clip[1][camera->perspective ? 2 : 3] =
        (w[3] + w[2]) / (w[3] - w[2]) * (camera->perspective ? 1.0f : -1.0f);
    clip[2][2] = camera->perspective ? (n + f) / (n - f) : 2 / (n - f);
    clip[2][3] = camera->perspective ? 2 * n * f / (n - f) : (n + f) / (n - f);
    clip[3][camera->perspective ? 2 : 3] = camera->perspective ? -1 : 1;
    for (int r = 0; r < 4; r++)
        for (int c = 0; c < 4; c++) {
            all[4 * c + r] = 0;
            for (int k = 0; k < 4; k++)
                all[4 * c + r] += clip[r][k] * m[4 * k + c];
        }
    glProgramUniformMatrix4fv(p->program, 0, 1, GL_FALSE, all);
}

static void need_depth(studio_overlay_pass *p, uint32_t width, uint32_t height) {
    if (p->width == width && p->height == height)
        return;
    glDeleteRenderbuffers(1, &p->depth);
    glCreateRenderbuffers(1, &p->depth);
    glNamedRenderbufferStorage(p->depth, GL_DEPTH_COMPONENT32F, (GLsizei)width, (GLsizei)height);
    p->width = width;
    p->height = height;
}

slv_result studio_overlay_draw(studio_overlay_pass **pass, const studio_document *d,
                               const studio_shot *shot, uint32_t segments,
                               const studio_overlay_target *targets, uint32_t count) {
    const studio_look *look = &shot->look;
    float scale = shot->scale > 0 ? shot->scale : 1;
    uint32_t width = (uint32_t)fmaxf(1, (float)shot->width * scale),
             height = (uint32_t)fmaxf(1, (float)shot->height * scale);
    static const float far_away = 1;
    slv_result result = *pass ? SLV_OK : make(d, segments, pass);
    studio_overlay_pass *p = *pass;
    if (result)
        return result;
    need_depth(p, width, height);
    set_camera(p, &shot->camera);
    glProgramUniform4i(p->program, 1, look->seams, look->wires, (GLint)look->overlay,
                       (GLint)segments);
    glViewport(0, 0, (GLsizei)width, (GLsizei)height);
    glUseProgram(p->program);
    glBindVertexArray(p->array);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glDepthMask(GL_TRUE);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    for (uint32_t i = 0; i < count; i++) {
        const GLuint framebuffer = targets[i].framebuffer;
        fill_table(p, d, shot->meant, &targets[i]);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, p->table);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
        glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, p->depth);
        glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &far_away);
        /* first what is in front, so that nothing shines through from behind */
        for (int turn = 0; turn < 2; turn++) {
            const GLboolean colors = turn == 1;
            glColorMask(colors, colors, colors, colors);
            glDrawElements(GL_TRIANGLES, p->count, GL_UNSIGNED_INT, NULL);
        }
        glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, 0);
    }
    glDisable(GL_BLEND);
    glBindVertexArray(0);
    return SLV_OK;
}
