/* Copies of textures whose colours are multiplied by alpha, which is how they may be averaged. */
#include "base/log.h"
#include "base/memory.h"
#include "texture/reduce.h"
#include "texture/texture_map.h"

struct multiplying {
    const slv_texture_desc *desc;
    bool encoded;
};

static void multiply_texels(const void *user, const void *from, uint64_t count, void *to) {
    const struct multiplying *m = user;
    const uint32_t n = m->desc->nchannels;
    const int32_t alpha = m->desc->alpha_channel;
    slv_type_to_float(m->desc->type, from, count * n, to);
    if (m->encoded)
        slv_texels_decode(n, alpha, to, count);
    slvi_multiply_alpha(SLV_TYPE_FLOAT, n, alpha, false, to, count);
    if (m->encoded)
        slv_texels_encode(n, alpha, to, count);
    slv_type_from_float(m->desc->type, to, count * n, to); /* no type is longer than a float */
}

static slv_result premultiply(const slv_env *env, const slv_texture *texture,
                              slv_texture_encoding wanted, slv_texture **out) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    const struct multiplying m = {desc,
                                  slv_texture_get_encoding(texture, wanted) == SLV_TEXTURE_SRGB};
    *out = NULL;
    if (desc->alpha_channel < 0)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "texture: there is no alpha to multiply by");
    return slvi_texture_map(env, texture, desc, multiply_texels, &m, out);
}

slv_result slv_texture_premultiply(const slv_env *env, const slv_texture *texture,
                                   slv_texture_encoding wanted, slv_texture **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, premultiply(&own, texture, wanted, out));
}
