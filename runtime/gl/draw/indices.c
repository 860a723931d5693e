/* Lists of triangles: of each batch's faces, one batch after the other. */
#include "gl/draw/indices.h"

#include "base/log.h"
#include "base/memory.h"
#include "gl/store/tables.h"

#include <stddef.h>

static GLuint make_array(const slv_gl_api *api, GLuint vertices, GLuint indices) {
    GLuint array;
    api->CreateVertexArrays(1, &array);
    api->VertexArrayVertexBuffer(array, 0, vertices, 0, sizeof(slv_vertex));
    api->VertexArrayElementBuffer(array, indices);
    for (GLuint i = 0; i < 4; i++) {
        api->EnableVertexArrayAttrib(array, i);
        api->VertexArrayAttribBinding(array, i, 0);
    }
    api->VertexArrayAttribFormat(array, 0, 3, GL_FLOAT, GL_FALSE, offsetof(slv_vertex, position));
    api->VertexArrayAttribFormat(array, 1, 3, GL_FLOAT, GL_FALSE, offsetof(slv_vertex, normal));
    api->VertexArrayAttribFormat(array, 2, 2, GL_HALF_FLOAT, GL_FALSE, offsetof(slv_vertex, uv));
    api->VertexArrayAttribIFormat(array, 3, 1, GL_INT, offsetof(slv_vertex, face));
    return array;
}

void slvi_gl_indices_free(const slv_gl *gl, slv_gl_indices *indices) {
    const slv_gl_api *api = &gl->api;
    api->DeleteBuffers(1, &indices->buffer);
    api->DeleteVertexArrays(1, &indices->array);
    slvi_free(indices->counts);
    slvi_free(indices->at);
    *indices = (slv_gl_indices){.strategy = indices->strategy};
}

/* The parameters are what is listed, and for which texture. */
slv_result slvi_gl_indices_make(const slv_gl *gl, const slv_env *env, const slv_tessellation *mesh,
                                GLuint vertices, uint64_t texture, const slv_gl_batches *batches,
                                slv_gl_indices *out) {
    uint32_t *list = NULL;
    uint64_t count = 0;
    slv_result result = SLV_OK;
    if (out->texture == texture)
        return SLV_OK;
    slvi_gl_indices_free(gl, out);
    for (uint32_t b = 0; b < batches->count; b++)
        for (uint32_t i = 0; i < batches->ranges[b].count; i++)
            count +=
                slv_tessellation_indices(mesh, batches->faces[batches->ranges[b].first + i], NULL);
    if (count > INT32_MAX)
        return slvi_fail(env, SLV_ERROR_LIMIT, "too many triangles: choose a coarser tessellation");
    if ((result = slvi_alloc(env, "triangles", count, sizeof *list, &list)) ||
        (result = slvi_alloc(env, "batches", batches->count, sizeof *out->counts, &out->counts)) ||
        (result = slvi_alloc(env, "batches", batches->count, sizeof *out->at, &out->at)))
        goto done;
    uint32_t at = 0;
    for (uint32_t b = 0; b < batches->count; b++) {
        const slv_gl_batch_range *range = &batches->ranges[b];
        uint32_t first = at;
        for (uint32_t i = 0; i < range->count; i++)
            at += slv_tessellation_indices(mesh, batches->faces[range->first + i], list + at);
        out->counts[b] = (GLsizei)(at - first);
        out->at[b] = (const void *)(first * sizeof *list);
    }
    if ((result = slvi_gl_buffer(gl, env, "triangles", list, count * sizeof *list, &out->buffer)))
        goto done;
    out->array = make_array(&gl->api, vertices, out->buffer);
    out->texture = texture;
done:
    slvi_free(list);
    if (result)
        slvi_gl_indices_free(gl, out);
    return result;
}
