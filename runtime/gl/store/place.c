/* Where items lie: a layer each, of which OpenGL knows the levels, or levels beside one another in
 * a page. */
#include "gl/store/place.h"

#include "gl/store/compress.h"

slv_gl_place slvi_gl_place(const slv_gl_pools *pools, uint32_t item, uint32_t level) {
    const slv_gl_pool *pool = &pools->pools[pools->pool_of[item]];
    slv_gl_place place = {
        .pool = pool, .format = slv_gl_pool_format(pools, pool), .layer = pools->layer_of[item]};
    if (pools->packing == SLV_GL_PAGES) {
        const slv_gl_rect *rect = &pool->rects[level];
        place.x = rect->x;
        place.y = rect->y;
        place.width = rect->width + 2 * rect->bu + pools->form->samples;
        place.height = rect->height + 2 * rect->bv + pools->form->samples;
    } else {
        slv_res res = slv_res_level(pool->res, level);
        place.level = level;
        place.width = 1u << res.u;
        place.height = 1u << res.v;
    }
    return place;
}

slv_gl_place slvi_gl_place_part(const slv_gl_place *place, slv_rect rect) {
    slv_gl_place part = *place;
    uint32_t end_x = place->x + rect.x + rect.width, end_y = place->y + rect.y + rect.height;
    part.x += rect.x;
    part.y += rect.y;
    if (place->format->block) {
        /* an edge of the texture may end a block early */
        uint32_t width = place->pool->width >> place->level;
        uint32_t height = place->pool->height >> place->level;
        part.x = part.x / 4 * 4;
        part.y = part.y / 4 * 4;
        end_x = (end_x + 3) / 4 * 4;
        end_y = (end_y + 3) / 4 * 4;
        width = width ? width : 1;
        height = height ? height : 1;
        end_x = end_x < width ? end_x : width;
        end_y = end_y < height ? end_y : height;
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

void slvi_gl_place_send(const slv_gl *gl, const slv_gl_place *place, uint32_t nlayers,
                        const void *stored) {
    const slv_gl_format *format = place->format;
    GLuint texture = place->pool->texture;
    GLint level = (GLint)place->level, layer = (GLint)place->layer;
    GLint x = (GLint)place->x, y = (GLint)place->y;
    GLsizei width = (GLsizei)place->width, height = (GLsizei)place->height;
    if (format->block)
        gl->api.CompressedTextureSubImage3D(
            texture, level, x, y, layer, width, height, (GLsizei)nlayers, format->internal,
            (GLsizei)(slvi_gl_place_bytes(place) * nlayers), stored);
    else
        gl->api.TextureSubImage3D(texture, level, x, y, layer, width, height, (GLsizei)nlayers,
                                  format->external, format->data, stored);
}
