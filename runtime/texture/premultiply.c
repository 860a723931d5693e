/* Copies of textures whose colours are multiplied by alpha, which is how they may be averaged. */
#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "texture/reduce.h"
#include "texture/texture_data.h"

struct multiplying {
    const slv_texture *from;
    slv_texture *to;
    slv_env env; /* logs one at a time */
    bool encoded;
};

static slv_result multiply_faces(void *user, uint64_t first, uint64_t end) {
    const struct multiplying *m = user;
    const slv_texture_desc *desc = slv_texture_get_desc(m->from);
    const uint32_t n = desc->nchannels;
    slv_result result = SLV_OK;
    for (uint32_t face = (uint32_t)first; !result && face < end; face++) {
        bool constant = slv_texture_is_constant(m->from, face);
        uint64_t count = constant ? 1 : (uint64_t)1 << (desc->res[face].u + desc->res[face].v);
        float *values = NULL;
        if ((result = slvi_alloc_plain(&m->env, "texels", count * n, sizeof *values, &values)))
            return result;
        slv_type_to_float(desc->type, slv_texture_texels(m->from, face), count * n, values);
        if (m->encoded)
            slv_texels_decode(n, desc->alpha_channel, values, count);
        slvi_multiply_alpha(SLV_TYPE_FLOAT, n, desc->alpha_channel, false, values, count);
        if (m->encoded)
            slv_texels_encode(n, desc->alpha_channel, values, count);
        /* in place: no type is longer than a float */
        slv_type_from_float(desc->type, values, count * n, values);
        result = constant ? slv_texture_set_constant(m->to, face, values)
                          : slv_texture_set_face(m->to, face, values);
        slvi_free(values);
    }
    return result;
}

static slv_result premultiply(const slv_env *env, const slv_texture *texture,
                              slv_texture_encoding wanted, slv_texture **out) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    struct multiplying m = {
        .from = texture, .encoded = slv_texture_get_encoding(texture, wanted) == SLV_TEXTURE_SRGB};
    slv_parallel_log *log = NULL;
    slv_result result;
    *out = NULL;
    if (desc->alpha_channel < 0)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "texture: there is no alpha to multiply by");
    if (!(result = slv_texture_create(env, desc, &m.to)) &&
        !(result = slvi_texture_reserve(m.to, texture)) &&
        !(result = slvi_parallel_env_begin(env, &log, &m.env)))
        result = slvi_parallel_for(env, desc->nfaces, 16, multiply_faces, &m);
    slvi_parallel_env_end(log);
    if (result) {
        slv_texture_destroy(m.to);
        m.to = NULL;
    }
    *out = m.to;
    return result;
}

slv_result slv_texture_premultiply(const slv_env *env, const slv_texture *texture,
                                   slv_texture_encoding wanted, slv_texture **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, premultiply(&own, texture, wanted, out));
}
