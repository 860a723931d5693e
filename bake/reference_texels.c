#include "reference_data.h"

#include "base/log.h"
#include "base/parallel.h"

#include <selvage/border.h>

#include <stdlib.h>
#include <string.h>

struct filling {
    const slv_levels *levels;
    const slv_adjacency *adjacency;
    const slv_env *env;
    uint32_t first_channel, nsource;
    const reference_texels *texels;
};

static uint64_t bordered(slv_res res) {
    return ((UINT64_C(1) << res.u) + 2) * ((UINT64_C(1) << res.v) + 2);
}

static slv_result fill(void *user, uint64_t begin, uint64_t end) {
    const struct filling *f = user;
    const reference_texels *t = f->texels;
    float *whole = NULL;
    slv_result result = SLV_OK;
    if (f->nsource != t->nchannels) {
        uint64_t most = 0;
        for (uint64_t face = begin; face < end; face++)
            most = bordered(t->res[face]) > most ? bordered(t->res[face]) : most;
        if ((result = slv_alloc(f->env, "texels", most * f->nsource, sizeof *whole, &whole)))
            return result;
    }
    for (uint64_t face = begin; face < end && !result; face++) {
        float *to = t->values + t->first[face];
        result = slv_border_build(f->levels, f->adjacency, (uint32_t)face, 0, 1, 1,
                                  whole ? whole : to, NULL);
        for (uint64_t i = 0; whole && !result && i < bordered(t->res[face]); i++)
            memcpy(to + i * t->nchannels, whole + i * f->nsource + f->first_channel,
                   t->nchannels * sizeof *to);
    }
    free(whole);
    return result;
}

slv_result reference_texels_create(const slv_env *env, const slv_texture *texture,
                                   const slv_adjacency *adjacency, uint32_t first_channel,
                                   uint32_t nchannels, reference_texels *out) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    reference_texels made = {.nchannels = nchannels};
    slv_parallel_log *log = NULL;
    slv_levels *levels = NULL;
    slv_env serial;
    uint64_t count = 0;
    slv_result result;
    if ((result = slv_alloc(env, "resolutions", desc->nfaces, sizeof *made.res, &made.res)) ||
        (result = slv_alloc(env, "faces", desc->nfaces, sizeof *made.first, &made.first)))
        goto done;
    for (uint32_t face = 0; face < desc->nfaces; face++) {
        made.res[face] = desc->res[face];
        made.first[face] = count;
        count += bordered(desc->res[face]) * nchannels;
    }
    if ((result = slv_alloc(env, "texels as floats", count, sizeof *made.values, &made.values)) ||
        (result = slv_parallel_env_begin(env, &log, &serial)) ||
        (result = slv_levels_create(&serial, texture, &levels)))
        goto done;
    struct filling filling = {levels, adjacency, &serial, first_channel, desc->nchannels, &made};
    result = slv_parallel_for(env, desc->nfaces, 16, fill, &filling);
done:
    slv_levels_destroy(levels);
    slv_parallel_env_end(log);
    if (result)
        reference_texels_free(&made);
    *out = made;
    return result;
}

void reference_texels_free(reference_texels *texels) {
    free(texels->res);
    free(texels->first);
    free(texels->values);
    memset(texels, 0, sizeof *texels);
}
