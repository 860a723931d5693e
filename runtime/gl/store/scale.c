/* Copies of textures with large floats. */
#include "gl/store/scale.h"

#include "base/memory.h"
#include "base/parallel.h"

#include <math.h>
#include <string.h>

/* Above this a sum of a few texels, or the difference of two, could leave the range of a float:
 * reductions, borders, samplers and shaders all make those. */
#define MOST 1e30f

static uint64_t stored_values(const slv_texture *texture, uint32_t face) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    slv_res res = desc->res[face];
    uint64_t texels = slv_texture_is_constant(texture, face) ? 1 : UINT64_C(1) << (res.u + res.v);
    return texels * desc->nchannels;
}

bool slvi_gl_is_large(const float *values, uint64_t count) {
    bool large = false;
    for (uint64_t i = 0; i < count; i++)
        large |= fabsf(values[i]) > MOST;
    return large;
}

struct scan {
    const slv_texture *texture;
    unsigned char *large; /* of each face */
};

static slv_result scan_faces(void *user, uint64_t first, uint64_t end) {
    const struct scan *scan = user;
    for (uint64_t face = first; face < end; face++) {
        const float *values = slv_texture_texels(scan->texture, (uint32_t)face);
        scan->large[face] = slvi_gl_is_large(values, stored_values(scan->texture, (uint32_t)face));
    }
    return SLV_OK;
}

struct copy {
    const slv_texture *from;
    slv_texture *to;
    slv_env env; /* logs one at a time */
};

static slv_result copy_faces(void *user, uint64_t first, uint64_t end) {
    const struct copy *copy = user;
    slv_result result = SLV_OK;
    for (uint64_t face = first; !result && face < end; face++) {
        uint32_t f = (uint32_t)face;
        const float *values = slv_texture_texels(copy->from, f);
        uint64_t count = stored_values(copy->from, f);
        float *scaled = NULL;
        if ((result = slvi_alloc(&copy->env, "scaled texels", count, sizeof *scaled, &scaled)))
            return result;
        for (uint64_t i = 0; i < count; i++)
            scaled[i] = values[i] / SLV_GL_SCALE;
        result = slv_texture_is_constant(copy->from, f)
                     ? slv_texture_set_constant(copy->to, f, scaled)
                     : slv_texture_set_face(copy->to, f, scaled);
        slvi_free(scaled);
    }
    return result;
}

static slv_result any_large(const slv_env *env, const slv_texture *texture, bool *large) {
    uint32_t nfaces = slv_texture_get_desc(texture)->nfaces;
    struct scan scan = {.texture = texture};
    slv_result result = slvi_alloc(env, "faces of large values", nfaces, 1, &scan.large);
    if (!result)
        result = slvi_parallel_for(env, nfaces, 64, scan_faces, &scan);
    *large = !result && memchr(scan.large, true, nfaces);
    slvi_free(scan.large);
    return result;
}

slv_result slvi_gl_scale_down(const slv_env *env, const slv_texture *texture, slv_texture **out) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    slv_parallel_log *log = NULL;
    struct copy copy = {.from = texture};
    bool large = false;
    slv_result result = SLV_OK;
    *out = NULL;
    if (desc->type != SLV_TYPE_FLOAT || (result = any_large(env, texture, &large)) || !large)
        return result;
    if (!(result = slv_texture_create(env, desc, &copy.to)) &&
        !(result = slvi_parallel_env_begin(env, &log, &copy.env)))
        result = slvi_parallel_for(env, desc->nfaces, 16, copy_faces, &copy);
    slvi_parallel_env_end(log);
    if (result) {
        slv_texture_destroy(copy.to);
        copy.to = NULL;
    }
    *out = copy.to;
    return result;
}
