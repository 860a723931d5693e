/* Copies a texture through a function of its texels, face by face by many threads. */
#include "texture/texture_map.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "texture/texture_data.h"

typedef struct mapping {
    const slv_texture *from;
    slv_texture *to;
    slv_env env; /* logs one at a time */
    slvi_texel_map map;
    const void *user;
} mapping;

static slv_result map_faces(void *user, uint64_t first, uint64_t end) {
    const mapping *m = user;
    const slv_texture_desc *desc = slv_texture_get_desc(m->from);
    slv_result result = SLV_OK;
    for (uint32_t face = (uint32_t)first; !result && face < end; face++) {
        bool constant = slv_texture_is_constant(m->from, face);
        uint64_t count = constant ? 1 : (uint64_t)1 << (desc->res[face].u + desc->res[face].v);
        void *texels = NULL;
        if ((result = slvi_alloc_plain(&m->env, "texels", count, desc->nchannels * sizeof(float),
                                       &texels)))
            return result;
        m->map(m->user, slv_texture_texels(m->from, face), count, texels);
        result = constant ? slv_texture_set_constant(m->to, face, texels)
                          : slv_texture_set_face(m->to, face, texels);
        slvi_free(texels);
    }
    return result;
}

slv_result slvi_texture_map(const slv_env *env, const slv_texture *texture,
                            const slv_texture_desc *desc, slvi_texel_map map, const void *user,
                            slv_texture **out) {
    mapping m = {.from = texture, .map = map, .user = user};
    slv_parallel_log *log = NULL;
    slv_result result;
    if (!(result = slv_texture_create(env, desc, &m.to)) &&
        !(result = slvi_texture_reserve(m.to, texture)) &&
        !(result = slvi_parallel_env_begin(env, &log, &m.env)))
        result = slvi_parallel_for(env, desc->nfaces, 16, map_faces, &m);
    slvi_parallel_env_end(log);
    if (result) {
        slv_texture_destroy(m.to);
        m.to = NULL;
    }
    *out = m.to;
    return result;
}
