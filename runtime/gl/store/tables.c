/* Buffers that shaders read: the tables that every kind of lookup needs. */
#include "gl/store/tables.h"

#include "base/log.h"
#include "base/memory.h"
#include "texture/black.h"

#include <string.h>

slv_result slvi_gl_buffer(const slv_gl *gl, const slv_env *env, const char *what, const void *data,
                          uint64_t bytes, GLuint *out) {
    const slv_gl_api *api = &gl->api;
    api->CreateBuffers(1, out);
    api->NamedBufferStorage(*out, (GLsizeiptr)(bytes ? bytes : 16), bytes ? data : NULL,
                            GL_DYNAMIC_STORAGE_BIT);
    return slvi_gl_check(gl, env, what);
}

static slv_result put_off(const slv_env *env, const char *what, const void *data, uint64_t bytes,
                          GLuint *out, slv_gl_tables *tables) {
    slv_gl_table table = {what, NULL, bytes, out};
    slv_result result;
    if (tables->count == tables->capacity) {
        uint32_t capacity = tables->capacity ? 2 * tables->capacity : 16;
        if ((result = slvi_grow(env, "tables", capacity, sizeof table, &tables->tables)))
            return result;
        tables->capacity = capacity;
    }
    if ((result = slvi_alloc_plain(env, what, bytes, 1, &table.data)))
        return result;
    if (bytes)
        memcpy(table.data, data, bytes);
    tables->tables[tables->count++] = table;
    return SLV_OK;
}

void slvi_gl_tables_free(slv_gl_tables *tables) {
    for (uint32_t i = 0; i < tables->count; i++)
        slvi_free(tables->tables[i].data);
    slvi_free(tables->tables);
    memset(tables, 0, sizeof *tables);
}

slv_result slvi_gl_table(const slv_gl_source *source, const char *what, const void *data,
                         uint64_t bytes, GLuint *out) {
    uint64_t most = source->gl->max_storage;
    if (bytes > most)
        return slvi_fail(source->env, SLV_ERROR_LIMIT,
                         "the %s takes %llu bytes, the driver's limit is %llu", what,
                         (unsigned long long)bytes, (unsigned long long)most);
    return slvi_gl_long_table(source, what, data, bytes, out);
}

slv_result slvi_gl_long_table(const slv_gl_source *source, const char *what, const void *data,
                              uint64_t bytes, GLuint *out) {
    return source->put_off ? put_off(source->env, what, data, bytes, out, source->put_off)
                           : slvi_gl_buffer(source->gl, source->env, what, data, bytes, out);
}

bool slvi_gl_is_single(const slv_gl_source *source, const slv_gl_pools *pools, uint32_t face) {
    if (!slvi_gl_is_constant(source, face))
        return false;
    if (pools->form != slv_form_bare())
        return true;
    const slv_res stored = pools->pools[pools->pool_of[face]].res;
    return stored.u + stored.v == 0;
}

void slvi_gl_face_row(const slv_gl_source *source, const slv_gl_pools *pools, const void *made,
                      uint32_t face, uint32_t row[2]) {
    slv_res res = slv_levels_get_desc(source->levels)->res[face];
    uint32_t items[SLV_FORM_ITEMS];
    bool single = slvi_gl_is_single(source, pools, face);
    row[0] = 0;
    if (pools->form->items(made, face, items) == 1)
        row[0] = pools->pool_of[items[0]] | pools->layer_of[items[0]] << 16;
    if (pools->packing == SLV_GL_PAGES) {
        slv_res stored = pools->pools[pools->pool_of[items[0]]].res;
        single = stored.u + stored.v == 0 && res.u + res.v > 0; /* one texel has its own border */
    }
    row[1] =
        (uint32_t)res.u | (uint32_t)res.v << 8 |
        slvi_black_edges(source->adjacency, face, source->params.border_u, source->params.border_v)
            << 16 |
        (uint32_t)single << 20;
}

slv_result slvi_gl_face_table(const slv_gl_source *source, const slv_gl_pools *pools,
                              const void *made, GLuint *out, uint64_t *bytes) {
    const slv_texture_desc *desc = slv_levels_get_desc(source->levels);
    uint32_t *rows = NULL;
    slv_result result = slvi_alloc(source->env, "face table", desc->nfaces, 8, &rows);
    if (result)
        return result;
    for (uint32_t f = 0; f < desc->nfaces; f++)
        slvi_gl_face_row(source, pools, made, f, &rows[2 * (size_t)f]);
    *bytes += (uint64_t)desc->nfaces * 8;
    result = slvi_gl_long_table(source, "face table", rows, (uint64_t)desc->nfaces * 8, out);
    slvi_free(rows);
    return result;
}

slv_result slvi_gl_level_table(const slv_gl_source *source, const slv_gl_pools *pools, GLuint *out,
                               uint64_t *bytes) {
    float *rects = NULL, first_sample = pools->form->samples ? 0.5f : 0.0f;
    uint64_t size = (uint64_t)pools->npools * SLV_GL_LEVEL_ROWS * 4 * sizeof *rects;
    slv_result result = slvi_alloc(source->env, "level table", size, 1, &rects);
    if (result)
        return result;
    for (uint32_t p = 0; p < pools->npools; p++) {
        const slv_gl_pool *pool = &pools->pools[p];
        slv_gl_sheet array = slv_gl_pool_array(pools, pool);
        float width = (float)array.width, height = (float)array.height;
        float *row = rects + (size_t)p * SLV_GL_LEVEL_ROWS * 4;
        for (uint32_t level = 0; level < pool->nlevels; level++, row += 4) {
            const slv_gl_rect *rect = &pool->rects[level];
            row[0] = (float)rect->width / width;
            row[1] = (float)rect->height / height;
            row[2] = ((float)(pool->x + rect->x + rect->bu) + first_sample) / width;
            row[3] = ((float)(pool->y + rect->y + rect->bv) + first_sample) / height;
        }
        if (pool->columns) {
            row = rects + ((size_t)p * SLV_GL_LEVEL_ROWS + SLV_GL_LEVELS) * 4;
            row[0] = (float)pool->columns;
            row[1] = (float)pool->page;
            row[2] = (float)pool->width / width;
            row[3] = (float)pool->height / height;
        }
    }
    *bytes += size;
    result = slvi_gl_table(source, "level table", rects, size, out);
    slvi_free(rects);
    return result;
}

void slvi_gl_table_value(const slv_gl_texture_params *params, const float *from, float to[4]) {
    to[1] = to[2] = 0;
    to[3] = 1;
    memcpy(to, from + params->first_channel, params->nchannels * sizeof *to);
    if (params->grey_alpha)
        to[3] = to[1];
    if (params->nchannels == 1 || params->grey_alpha)
        to[1] = to[2] = to[0];
}
