/* Chains of levels that are filled from outside: where each lies. */
#include "texture/levels.h"

#include "base/log.h"
#include "base/memory.h"

#include <string.h>

static uint64_t face_texels(slv_res res) {
    uint64_t texels = 0;
    for (uint32_t level = 0; level < slv_res_level_count(res); level++)
        texels += slv_res_texels(slv_res_level(res, level));
    return texels;
}

slv_result slvi_levels_bytes(const slv_env *env, const slv_texture_desc *desc, uint64_t *out) {
    uint64_t size = slv_type_size(desc->type) * desc->nchannels, texels = 0;
    for (uint32_t face = 0; face < desc->nfaces; face++)
        texels += face_texels(desc->res[face]); /* less than 2^33 each */
    *out = texels * size;
    return texels > SIZE_MAX / size ? slvi_fail(env, SLV_ERROR_LIMIT, "levels: too many texels")
                                    : SLV_OK;
}

slv_result slvi_levels_lay(const slv_env *env, const slv_texture_desc *desc, void *memory,
                           slv_levels **out) {
    slv_levels *levels = NULL;
    uint64_t n = desc->nfaces, nlevels = 0, bytes = 0;
    *out = NULL;
    slv_result result = slvi_levels_bytes(env, desc, &bytes);
    if (result || (result = slvi_alloc(env, "levels", 1, sizeof *levels, &levels)))
        return result;
    levels->desc = *desc;
    levels->texel_size = slv_type_size(desc->type) * desc->nchannels;
    levels->fixed = true;
    for (uint32_t face = 0; face < n; face++)
        nlevels += slv_res_level_count(desc->res[face]);
    if ((result = slvi_parallel_env_begin(env, &levels->log, &levels->env)) ||
        (result = slvi_alloc(env, "level resolutions", n, sizeof *levels->res, &levels->res)) ||
        (result = slvi_alloc(env, "level table", n + 1, sizeof *levels->first, &levels->first)) ||
        (result = slvi_alloc(env, "level table", nlevels, sizeof *levels->at, &levels->at)) ||
        (!memory && (result = slvi_alloc_plain(env, "level texels", bytes, 1, &levels->texels))))
        goto done;
    if (n)
        memcpy(levels->res, desc->res, n * sizeof *levels->res);
    levels->desc.res = levels->res;
    levels->nbytes = bytes;
    levels->nat = nlevels;
    unsigned char *next = memory ? memory : levels->texels;
    for (uint32_t face = 0, at = 0; face < n; face++) {
        levels->first[face] = at;
        for (uint32_t level = 0; level < slv_res_level_count(levels->res[face]); level++) {
            levels->at[at++] = next;
            next += slv_res_texels(slv_res_level(levels->res[face], level)) * levels->texel_size;
        }
    }
    *out = levels;
    levels = NULL;
done:
    slv_levels_destroy(levels);
    return result;
}

slv_result slvi_levels_kinds(slv_levels *levels) {
    return slvi_alloc(&levels->env, "level table", levels->desc.nfaces, 1, &levels->kind);
}

void slvi_levels_put(slv_levels *levels, uint32_t face, const void *memory, bool single) {
    unsigned char **at = levels->at + levels->first[face];
    unsigned char *next = (unsigned char *)(uintptr_t)memory; /* never written to */
    for (uint32_t level = 0; level < slv_res_level_count(levels->res[face]); level++) {
        at[level] = next;
        if (!single)
            next += slv_res_texels(slv_res_level(levels->res[face], level)) * levels->texel_size;
    }
    if (single)
        levels->kind[face] |= SLVI_LEVELS_SINGLE;
}

void *slvi_levels_place(const slv_levels *levels, uint32_t face, uint32_t level) {
    return levels->at[levels->first[face] + level];
}
