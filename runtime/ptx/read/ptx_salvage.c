/* Reading past damage, of a file that was opened for it: a face whose texels cannot be read is
 * filled from its finest stored reduction that can, or with its average. */
#include "ptx/read/ptx_texels.h"

#include "base/log.h"
#include "base/memory.h"
#include "texture/reduce.h"

#include <stdio.h>

#define MOST_TOLD 100 /* faces, one by one */

static void tell(const slv_ptx *ptx, uint32_t face, const char *why, const char *with) {
    if (atomic_exchange(&ptx->salvaged[face], true))
        return;
    uint32_t count = atomic_fetch_add(&((slv_ptx *)(uintptr_t)ptx)->nsalvaged, 1);
    if (count < MOST_TOLD)
        slvi_logf(&ptx->env, SLV_LOG_WARNING, "%s; face %u is filled from %s", why, face, with);
    else if (count == MOST_TOLD)
        slvi_logf(&ptx->env, SLV_LOG_WARNING,
                  "%s: further faces that are filled are not told one by one", ptx->name);
}

/* Which texel of a triangle's reduction, `steps` halvings on, was made of one of a face of 2^log2
 * texels an axis. Of four that are averaged the last belongs to the upper half, which is stored
 * turned around: texel (i,j) comes of (2i,2j), (2i+1,2j), (2i,2j+1) and (R-1-2j,R-1-2i). */
static void find_reduced(uint32_t *x, uint32_t *y, int log2, int steps) {
    for (; steps > 0; steps--, log2--) {
        uint32_t last = (1u << log2) - 1, at = *x;
        bool turned = *x & *y & 1;
        *x = (turned ? last - *y : *x) >> 1;
        *y = (turned ? last - at : *y) >> 1;
    }
}

/* The region of a reduction that lies under one of the face at `res`, texels repeated; of a
 * triangle all of it, for both halves are mixed there. */
static slv_result fill_from(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face, slv_res res,
                            ptx_region region, slv_res from, uint8_t *out) {
    int du = res.u - from.u, dv = res.v - from.v;
    bool triangle = ptx->info.mesh_type == SLV_PTX_TRIANGLE;
    ptx_region whole = {from, 0, 0},
               under = {{(int8_t)(region.size.u > du ? region.size.u - du : 0),
                         (int8_t)(region.size.v > dv ? region.size.v - dv : 0)},
                        region.x >> du,
                        region.y >> dv};
    under = triangle ? whole : under;
    size_t pixel = ptx->pixel_size;
    uint8_t *texels = NULL;
    slv_result result =
        slvi_alloc_plain(scratch->env, ptx->name, ptx_texel_count(under.size), pixel, &texels);
    if (!result)
        result = slvi_ptx_read_as_stored(ptx, scratch, face, from, under, texels);
    for (uint32_t y = 0; !result && y < 1u << region.size.v; y++)
        for (uint32_t x = 0; x < 1u << region.size.u; x++) {
            uint32_t to_x = region.x + x, to_y = region.y + y;
            if (triangle)
                find_reduced(&to_x, &to_y, res.u, du);
            else
                to_x >>= du, to_y >>= dv;
            size_t at = ((size_t)(to_y - under.y) << under.size.u) + (to_x - under.x);
            memcpy(out + (((size_t)y << region.size.u) + x) * pixel, texels + at * pixel, pixel);
        }
    slvi_free(texels);
    return result;
}

/* From the finest reduction no finer than `res`. Returns its level; 0: none can be read. */
static int fill_from_reduction(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                               const slv_ptx_face *f, slv_res res, ptx_region region, uint8_t *out,
                               slv_result *result) {
    for (int level = 1; level < (int)ptx->info.nlevels && level <= ptx_min_log2(f->res); level++) {
        slv_res from = {(int8_t)(f->res.u - level), (int8_t)(f->res.v - level)};
        if (from.u > res.u || from.v > res.v || (from.u == res.u && from.v == res.v) ||
            (f->flags & SLV_FACE_EDITED) || ptx_need(ptx, PTX_LEVEL(level)) ||
            ptx_need(ptx, PTX_RANKS) ||
            ptx->tables->ranks[face] >= ptx->tables->levels[level].nfaces)
            continue;
        *result = fill_from(ptx, scratch, face, res, region, from, out);
        if (ptx_goes_on(ptx, *result))
            continue;
        if (!*result && res.u == f->res.u && res.v == f->res.v && !ptx->premultiply)
            slv_ptx_unmultiply(ptx->info.type, ptx->info.nchannels, ptx->info.alpha_channel, out,
                               ptx_texel_count(region.size));
        return level;
    }
    return 0;
}

slv_result slvi_ptx_read_region(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                                slv_res res, ptx_region region, void *out) {
    ptx_kept_line why, other;
    char with[64] = "its average";
    const slv_env *env = scratch->env;
    if (!ptx->salvage)
        return slvi_ptx_read_as_stored(ptx, scratch, face, res, region, out);
    slv_env quiet = slvi_ptx_keep_line(env, &why);
    scratch->env = &quiet;
    slv_result result = slvi_ptx_read_as_stored(ptx, scratch, face, res, region, out);
    if (!ptx_goes_on(ptx, result)) {
        scratch->env = env;
        return result ? slvi_fail(env, result, "%s", why.text) : SLV_OK;
    }
    slv_ptx_face f = slvi_ptx_face_at(ptx, face);
    quiet.log_user = &other;
    int level = fill_from_reduction(ptx, scratch, face, &f, res, region, out, &result);
    if (level)
        snprintf(with, sizeof with, "its reduction of %u x %u", 1u << (f.res.u - level),
                 1u << (f.res.v - level));
    else {
        bool known = !ptx_need(ptx, PTX_CONSTANTS);
        size_t count = (size_t)ptx_texel_count(region.size);
        result = SLV_OK;
        if (known)
            slvi_fill_texels(out, ptx->tables->constants + face * ptx->pixel_size, ptx->pixel_size,
                             count);
        else
            memset(out, 0, count * ptx->pixel_size);
        if (!known)
            snprintf(with, sizeof with, "nothing, with zeros");
    }
    scratch->env = env;
    if (result)
        return slvi_fail(env, result, "%s", other.text);
    if (!why.text[0])
        snprintf(why.text, sizeof why.text, "%s: face %u cannot be read", ptx->name, face);
    tell(ptx, face, why.text, with);
    return SLV_OK;
}

uint64_t slv_ptx_salvaged_count(const slv_ptx *ptx) {
    return ptx->salvage ? atomic_load(&ptx->nsalvaged) + (uint64_t)ptx->nleft_out : 0;
}

bool slv_ptx_is_salvaged(const slv_ptx *ptx, uint32_t face) {
    return ptx->salvage && face < ptx->info.nfaces && atomic_load(&ptx->salvaged[face]);
}
