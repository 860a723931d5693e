/* Where the texels of a face come from. */
#include "base/log.h"
#include "base/memory.h"
#include "ptx/read/ptx_texels.h"
#include "texture/reduce.h"

/* Where the texels of a face at full resolution are. */
static void find_texels(const slv_ptx *ptx, uint32_t face, const slv_ptx_face *f, uint32_t *header,
                        uint64_t *position) {
    const ptx_level *level = &ptx->tables->levels[0];
    const ptx_edit *edit = f->flags & SLV_FACE_EDITED ? slvi_ptx_find_edit(ptx, face) : NULL;
    *header = edit ? edit->header : level->headers[face];
    *position = edit ? edit->position : slvi_ptx_block_position(level, face);
}

bool slvi_ptx_face_is_plausible(const slv_ptx *ptx, uint32_t face, const slv_ptx_face *f) {
    uint64_t position;
    uint32_t header;
    find_texels(ptx, face, f, &header, &position);
    uint32_t encoding = PTX_BLOCK_ENCODING(header);
    if (encoding == PTX_CONSTANT || encoding == PTX_TILED)
        return PTX_BLOCK_SIZE(header) != 0;
    return slvi_ptx_zip_is_plausible(PTX_BLOCK_SIZE(header),
                                     ptx_texel_count(f->res) * ptx->pixel_size);
}

/* The level that stores the face at `res`, or -1. */
static int stored_level(const slv_ptx *ptx, uint32_t face, const slv_ptx_face *f, slv_res res) {
    int du = f->res.u - res.u, dv = f->res.v - res.v;
    if (du == 0 && dv == 0)
        return 0;
    if (du != dv || (uint32_t)du >= ptx->info.nlevels || (f->flags & SLV_FACE_EDITED) ||
        ptx->tables->ranks[face] >= ptx->tables->levels[du].nfaces)
        return -1;
    return du;
}

/* One step from `res` towards the resolution of the face that it is made of. */
static slv_res finer(const slv_ptx *ptx, const slv_ptx_face *face, slv_res res) {
    int du = face->res.u - res.u, dv = face->res.v - res.v;
    bool triangle = ptx->info.mesh_type == SLV_PTX_TRIANGLE;
    bool along_u = du > dv || (du == dv && (res.u & 1));
    if (triangle || along_u)
        res.u++;
    if (triangle || !along_u)
        res.v++;
    return res;
}

/* The block that a face at `res` is made of, and the resolutions on the way: res[0] is the given
 * one, the last the block's. */
static slv_result find_block(const slv_ptx *ptx, uint32_t face, const slv_ptx_face *f, slv_res *res,
                             uint32_t *steps, ptx_block *block) {
    bool reduced = res->u != f->res.u || res->v != f->res.v;
    slv_result result = SLV_OK;
    int level;
    if (reduced && ptx->info.nlevels > 1 && (result = ptx_need(ptx, PTX_RANKS)))
        return result;
    for (*steps = 1; (level = stored_level(ptx, face, f, *res)) < 0; ++*steps, res++)
        res[1] = finer(ptx, f, *res);
    if ((result = ptx_need(ptx, PTX_LEVEL(level))))
        return result;
    *block = (ptx_block){.face = face, .res = *res, .plain = ptx->premultiply && level == 0};
    if (level == 0)
        find_texels(ptx, face, f, &block->header, &block->position);
    else {
        const ptx_level *table = &ptx->tables->levels[level];
        block->header = table->headers[ptx->tables->ranks[face]];
        block->position = slvi_ptx_block_position(table, ptx->tables->ranks[face]);
    }
    return SLV_OK;
}

static bool is_on_grid(uint32_t at, int size, int whole) {
    return !(at & ((1u << size) - 1)) && at >> whole == 0;
}

slv_result slvi_ptx_read_as_stored(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                                   slv_res res, ptx_region region, void *out) {
    slv_res chain[2 * SLV_MAX_LOG2_RES + 1];
    uint32_t steps;
    ptx_block block;
    if (face >= ptx->info.nfaces)
        return slvi_fail(scratch->env, SLV_ERROR_ARGUMENT, "%s: face %u: there are %u faces",
                         ptx->name, face, ptx->info.nfaces);
    slv_result result = ptx_need(ptx, PTX_FACES);
    if (result)
        return result;
    slv_ptx_face f = slvi_ptx_face_at(ptx, face);
    bool triangle = ptx->info.mesh_type == SLV_PTX_TRIANGLE;
    if (res.u < 0 || res.v < 0 || res.u > f.res.u || res.v > f.res.v ||
        (triangle && res.u != res.v))
        return slvi_fail(scratch->env, SLV_ERROR_ARGUMENT,
                         "%s: face %u: has 2^%d x 2^%d texels, which do not reduce to 2^%d x 2^%d",
                         ptx->name, face, f.res.u, f.res.v, res.u, res.v);
    if (region.size.u < 0 || region.size.v < 0 || region.size.u > res.u || region.size.v > res.v ||
        (triangle && region.size.u != region.size.v) ||
        !is_on_grid(region.x, region.size.u, res.u) || !is_on_grid(region.y, region.size.v, res.v))
        return slvi_fail(scratch->env, SLV_ERROR_ARGUMENT,
                         "%s: face %u: 2^%d x 2^%d texels at (%u, %u) are no tile of 2^%d x 2^%d",
                         ptx->name, face, region.size.u, region.size.v, region.x, region.y, res.u,
                         res.v);
    if ((f.flags & SLV_FACE_CONSTANT) || (res.u == 0 && res.v == 0)) {
        if ((result = ptx_need(ptx, PTX_CONSTANTS)))
            return result;
        slvi_fill_texels(out, ptx->tables->constants + face * ptx->pixel_size, ptx->pixel_size,
                         ptx_texel_count(region.size));
        return SLV_OK;
    }
    if (!scratch->inflater) {
        scratch->inflater = libdeflate_alloc_decompressor();
        if (!scratch->inflater)
            return slvi_fail(scratch->env, SLV_ERROR_MEMORY, "%s: face %u: no memory to unpack it",
                             ptx->name, face);
    }
    chain[0] = res;
    if ((result = find_block(ptx, face, &f, chain, &steps, &block)))
        return result;
    result = slvi_ptx_read_reduced(ptx, scratch, &block, chain, steps, region, out);
    slvi_ptx_scratch_trim(scratch);
    return result;
}
