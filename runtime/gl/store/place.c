/* Where items lie: a layer each, of which OpenGL knows the levels, or levels beside one another in
 * a layer or in a cell of a page. */
#include "gl/store/place.h"

#include "gl/store/compress.h"

slv_gl_place slvi_gl_place_cell(const slv_gl_pools *pools, const slv_gl_pool *pool, uint32_t layer,
                                uint32_t level) {
    slv_gl_sheet array = slv_gl_pool_array(pools, pool);
    slv_gl_place place = {.pool = pool,
                          .format = slv_gl_pool_format(pools, pool),
                          .layer = layer,
                          .width = pool->width,
                          .height = pool->height,
                          .array_width = array.width,
                          .array_height = array.height};
    if (pool->columns) {
        place.layer = pool->page;
        place.x = pool->x + layer % pool->columns * pool->width;
        place.y = pool->y + layer / pool->columns * pool->height;
    }
    if (pools->packing != SLV_GL_PAGES) {
        slv_res res = slv_res_level(pool->res, level);
        place.level = level;
        place.width = place.array_width = 1u << res.u;
        place.height = place.array_height = 1u << res.v;
    }
    return place;
}

slv_gl_place slvi_gl_place(const slv_gl_pools *pools, uint32_t item, uint32_t level) {
    const slv_gl_pool *pool = &pools->pools[pools->pool_of[item]];
    slv_gl_place place = slvi_gl_place_cell(pools, pool, pools->layer_of[item], level);
    if (pools->packing == SLV_GL_PAGES) {
        const slv_gl_rect *rect = &pool->rects[level];
        place.x += rect->x;
        place.y += rect->y;
        place.width = rect->width + 2 * rect->bu + pools->form->samples;
        place.height = rect->height + 2 * rect->bv + pools->form->samples;
    }
    return place;
}

slv_gl_place slvi_gl_place_part(const slv_gl_place *place, slv_rect rect) {
    slv_gl_place part = *place;
    uint32_t end_x = place->x + rect.x + rect.width, end_y = place->y + rect.y + rect.height;
    part.x += rect.x;
    part.y += rect.y;
    if (place->format->block) {
        part.x = part.x / 4 * 4;
        part.y = part.y / 4 * 4;
        end_x = (end_x + 3) / 4 * 4;
        end_y = (end_y + 3) / 4 * 4;
        /* an edge of the texture may end a block early */
        end_x = end_x < place->array_width ? end_x : place->array_width;
        end_y = end_y < place->array_height ? end_y : place->array_height;
    }
    part.width = end_x - part.x;
    part.height = end_y - part.y;
    return part;
}

uint64_t slvi_gl_place_bytes(const slv_gl_place *place) {
    const slv_gl_format *format = place->format;
    return format->block ? slv_gl_compressed_bytes(format->block, place->width, place->height)
                         : (uint64_t)place->width * place->height * format->texel_bytes;
}

void slvi_gl_place_send(const slv_gl_source *source, const slv_gl_place *place, uint32_t nlayers,
                        const void *stored) {
    const slv_gl_api *api = &source->gl->api;
    const slv_gl_format *format = place->format;
    const uint64_t bytes = slvi_gl_place_bytes(place) * nlayers;
    GLuint texture = place->pool->texture;
    GLint level = (GLint)place->level, layer = (GLint)place->layer;
    GLint x = (GLint)place->x, y = (GLint)place->y;
    GLsizei width = (GLsizei)place->width, height = (GLsizei)place->height;
    GLuint buffer = 0;
    if (source->params.pixel_buffers) {
        api->CreateBuffers(1, &buffer);
        api->NamedBufferStorage(buffer, (GLsizeiptr)bytes, stored, 0);
        api->BindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
        stored = NULL; /* where it is in the buffer */
    }
    if (format->block)
        api->CompressedTextureSubImage3D(texture, level, x, y, layer, width, height,
                                         (GLsizei)nlayers, format->internal, (GLsizei)bytes,
                                         stored);
    else
        api->TextureSubImage3D(texture, level, x, y, layer, width, height, (GLsizei)nlayers,
                               format->external, format->data, stored);
    if (buffer) {
        api->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
        api->DeleteBuffers(1, &buffer); /* once the GPU has copied it */
    }
}
