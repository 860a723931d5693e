/* What the GPU holds, read back. */
#include "base/log.h"
#include "gl/store/place.h"
#include "gl/store/texture.h"

#include <selvage/gl_live.h>

slv_result slv_gl_texture_read(const slv_gl_texture *texture, const slv_env *env,
                               const slv_strategy *strategy, uint32_t item, uint32_t level,
                               uint64_t size, void *out, uint64_t *bytes) {
    const slv_gl_api *api = &texture->gl->api;
    slv_gl_slot *slot = NULL;
    slv_result result = slvi_gl_texture_need(texture, env, strategy, &slot);
    if (result || (result = slvi_gl_texture_need_ready(texture, env)))
        return result;
    const slv_gl_pools *pools = &texture->stores[slot->store].pools;
    /* a face of one value has one texel for all levels */
    if (pools->form == slv_form_bare() && item < pools->nitems &&
        pools->pools[pools->pool_of[item]].nlevels == 1 &&
        level < slv_res_level_count(texture->res[item]))
        level = 0;
    if (item >= pools->nitems || level >= pools->pools[pools->pool_of[item]].nlevels)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "there is no level %u of %s number %u", level,
                         pools->form->item, item);
    slv_gl_place place = slvi_gl_place(pools, item, level);
    place = slvi_gl_place_part(&place, (slv_rect){0, 0, place.width, place.height});
    *bytes = slvi_gl_place_bytes(&place);
    if (!out)
        return SLV_OK;
    if (size < *bytes)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "room for %llu bytes, %llu are needed",
                         (unsigned long long)size, (unsigned long long)*bytes);
    const slv_gl_format *format = place.format;
    GLuint array = place.pool->texture;
    GLint at[] = {(GLint)place.level, (GLint)place.x, (GLint)place.y, (GLint)place.layer};
    GLsizei width = (GLsizei)place.width, height = (GLsizei)place.height;
    slv_gl_transfer before = slvi_gl_transfer_begin(texture->gl);
    if (format->block)
        api->GetCompressedTextureSubImage(array, at[0], at[1], at[2], at[3], width, height, 1,
                                          (GLsizei)*bytes, out);
    else
        api->GetTextureSubImage(array, at[0], at[1], at[2], at[3], width, height, 1,
                                format->external, format->data, (GLsizei)*bytes, out);
    slvi_gl_transfer_end(texture->gl, &before);
    return slvi_gl_check(texture->gl, env, "reading a texture");
}
