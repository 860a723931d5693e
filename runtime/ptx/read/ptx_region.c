/* Reductions that the file leaves to its reader, made block by block: a block of a reduction comes
 * from one of the next finer, that from one finer still, and where blocks would grow too large from
 * several, one after the other. So memory does not depend on the size of the face. */
#include "ptx/read/ptx_texels.h"
#include "texture/reduce.h"

/* What the blocks of all resolutions take together. No block takes more than a share of what is
 * left, so that they become smaller where many are open at once. */
#define WORK_BYTES (192 << 10)
#define SHARE 8

struct plan {
    const slv_ptx *ptx;
    ptx_scratch *scratch;
    const ptx_block *block;
    const slv_res *res;
    uint32_t last; /* res[last] is stored */
    slv_res unit;  /* what is unpacked at a time */
    /* of blocks at res[i + 1]: the most bytes, and where they are in scratch->work */
    uint64_t limit[2 * SLV_MAX_LOG2_RES], offset[2 * SLV_MAX_LOG2_RES];
};

static bool is_triangle(const struct plan *plan) {
    return plan->ptx->info.mesh_type == SLV_PTX_TRIANGLE;
}

/* The texels at res[i + 1] that texels at res[i] are made of. */
static slv_res grow(const struct plan *plan, uint32_t i, slv_res size) {
    size.u = (int8_t)(size.u + plan->res[i + 1].u - plan->res[i].u);
    size.v = (int8_t)(size.v + plan->res[i + 1].v - plan->res[i].v);
    return size;
}

/* What those take; a triangle's with their mirror image. */
static uint64_t grown_bytes(const struct plan *plan, uint32_t i, slv_res size) {
    return ptx_region_bytes(plan->ptx, grow(plan, i, size)) << is_triangle(plan);
}

/* Whether a block at res[i] is cut along u rather than v: so that what its halves are made of comes
 * to lie within one tile of the file, and no tile is unpacked twice. */
static bool cut_along_u(const struct plan *plan, uint32_t i, slv_res size) {
    int over_u = size.u + plan->block->res.u - plan->res[i].u - plan->unit.u;
    int over_v = size.v + plan->block->res.v - plan->res[i].v - plan->unit.v;
    return size.v == 0 || (size.u > 0 && over_u > over_v);
}

/* A block of a quad at res[i], into rows `pitch` texels apart. */
static slv_result make_quad(const struct plan *plan, uint32_t i, ptx_region region, uint8_t *out,
                            size_t pitch) {
    const slv_ptx *ptx = plan->ptx;
    if (i == plan->last)
        return slvi_ptx_read_stored(ptx, plan->scratch, plan->block, region, out, pitch);
    if (grown_bytes(plan, i, region.size) > plan->limit[i]) {
        ptx_region second = region;
        size_t distance = 1;
        if (cut_along_u(plan, i, region.size)) {
            second.size.u = --region.size.u;
            second.x += 1u << region.size.u;
            distance <<= region.size.u;
        } else {
            second.size.v = --region.size.v;
            second.y += 1u << region.size.v;
            distance = pitch << region.size.v;
        }
        slv_result result = make_quad(plan, i, region, out, pitch);
        return result ? result
                      : make_quad(plan, i, second, out + distance * ptx->pixel_size, pitch);
    }
    bool along_u = plan->res[i + 1].u > plan->res[i].u;
    size_t width = (size_t)1 << region.size.u, row = width * ptx->pixel_size;
    ptx_region from = {grow(plan, i, region.size), region.x << along_u, region.y << !along_u};
    uint8_t *work = plan->scratch->work.bytes + plan->offset[i];
    uint8_t *to = pitch == width ? out : work;
    slv_result result = make_quad(plan, i + 1, from, work, (size_t)1 << from.size.u);
    if (result)
        return result;
    slvi_halve(ptx->info.type, ptx->info.nchannels, along_u ? SLV_HALVE_U : SLV_HALVE_V,
               (size_t)1 << from.size.u, (size_t)1 << from.size.v, work, to);
    for (size_t y = 0; to == work && y < (size_t)1 << region.size.v; y++)
        memcpy(out + y * pitch * ptx->pixel_size, work + y * row, row);
    return SLV_OK;
}

/* A block of a triangle at res[i], of 2^size x 2^size texels, and the block that the anti-diagonal
 * maps it to, unless that is NULL: made together, as both come from the same two finer blocks. */
static slv_result make_triangle(const struct plan *plan, uint32_t i, int size, uint32_t x,
                                uint32_t y, uint8_t *out, uint8_t *mirrored, size_t pitch) {
    const slv_ptx *ptx = plan->ptx;
    uint32_t side = 1u << size, whole = 1u << plan->res[i].u;
    uint32_t mirror_x = whole - y - side, mirror_y = whole - x - side;
    bool own_mirror = mirror_x == x;
    slv_res square = {(int8_t)size, (int8_t)size};
    slv_result result = SLV_OK;
    if (i == plan->last) {
        result = slvi_ptx_read_stored(ptx, plan->scratch, plan->block, (ptx_region){square, x, y},
                                      out, pitch);
        if (!result && mirrored)
            result =
                slvi_ptx_read_stored(ptx, plan->scratch, plan->block,
                                     (ptx_region){square, mirror_x, mirror_y}, mirrored, pitch);
        return result;
    }
    if (grown_bytes(plan, i, square) > plan->limit[i]) {
        uint32_t half = side / 2;
        for (uint32_t quarter = 0; quarter < 4 && !result; quarter++) {
            /* each shares a row with the one before, or a column, so its image a column or a row:
             * likely a tile of the file */
            uint32_t up = quarter >> 1, right = (quarter & 1) ^ up;
            size_t at = (up * half * pitch + right * half) * ptx->pixel_size;
            size_t there = ((1 - right) * half * pitch + (1 - up) * half) * ptx->pixel_size;
            uint8_t *also = mirrored ? mirrored + there : NULL;
            if (own_mirror && up && right) /* came with the first */
                continue;
            if (own_mirror && !up && !right)
                also = out + there;
            result = make_triangle(plan, i, size - 1, x + right * half, y + up * half, out + at,
                                   also, pitch);
        }
        return result;
    }
    slv_res from = grow(plan, i, square);
    uint8_t *even = plan->scratch->work.bytes + plan->offset[i];
    uint8_t *odd = own_mirror ? even : even + ptx_region_bytes(ptx, from);
    if ((result = make_triangle(plan, i + 1, from.u, 2 * x, 2 * y, even, own_mirror ? NULL : odd,
                                (size_t)1 << from.u)))
        return result;
    size_t width = (size_t)1 << from.u;
    slvi_halve_triangle(ptx->info.type, ptx->info.nchannels, width, width, even, odd, out, pitch);
    if (mirrored)
        slvi_halve_triangle(ptx->info.type, ptx->info.nchannels, width, width, odd, even, mirrored,
                            pitch);
    return SLV_OK;
}

static slv_result read_reduced(const slv_ptx *ptx, ptx_scratch *scratch, const ptx_block *block,
                               const slv_res *res, uint32_t last, ptx_region region, uint8_t *out) {
    struct plan plan = {.ptx = ptx,
                        .scratch = scratch,
                        .block = block,
                        .res = res,
                        .last = last,
                        .unit = block->res};
    bool triangle = is_triangle(&plan);
    slv_result result = SLV_OK;
    size_t pitch = (size_t)1 << region.size.u;
    if (PTX_BLOCK_ENCODING(block->header) == PTX_TILED) {
        if ((result = slvi_ptx_need_tiles(ptx, scratch, block)))
            return result;
        plan.unit = scratch->tile;
    }
    slv_res size = region.size, texel = {0, 0};
    uint64_t left = WORK_BYTES, total = 0;
    for (uint32_t i = 0; i < plan.last; i++) {
        uint64_t least = grown_bytes(&plan, i, texel);
        plan.limit[i] = left / SHARE > least ? left / SHARE : least;
        while (grown_bytes(&plan, i, size) > plan.limit[i])
            if (triangle) {
                size.u--;
                size.v--;
            } else if (cut_along_u(&plan, i, size))
                size.u--;
            else
                size.v--;
        uint64_t bytes = grown_bytes(&plan, i, size);
        plan.offset[i] = total;
        total += bytes;
        left -= left < bytes ? left : bytes;
        size = grow(&plan, i, size);
    }
    if ((result = slvi_ptx_scratch_reserve(scratch, ptx, &scratch->work, total)))
        return result;
    return triangle ? make_triangle(&plan, 0, region.size.u, region.x, region.y, out, NULL, pitch)
                    : make_quad(&plan, 0, region, out, pitch);
}

slv_result slvi_ptx_read_reduced(const slv_ptx *ptx, ptx_scratch *scratch, const ptx_block *block,
                                 const slv_res *res, uint32_t steps, ptx_region region,
                                 uint8_t *out) {
    if (steps == 1) /* many faces are small: nothing may be slow for them */
        return slvi_ptx_read_stored(ptx, scratch, block, region, out, (size_t)1 << region.size.u);
    return read_reduced(ptx, scratch, block, res, steps - 1, region, out);
}
