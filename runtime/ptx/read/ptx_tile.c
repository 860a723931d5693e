/* What a block of the file stores: a tile or the whole as one array, or a table of tiles. */
#include "ptx/read/ptx_texels.h"
#include "texture/reduce.h"

/* How much of a block to read at once when all of it is wanted, and when it begins with a table. */
#define BLOCK_AHEAD (UINT64_C(1) << 18)
#define TABLE_AHEAD 2048

/* One array of a block: `index` tells the tiles of a block apart. */
struct array {
    uint64_t position;
    uint32_t header, index;
    slv_res res;
};

/* Damaged files may have several readings of the same bytes. */
static bool same_block(const ptx_block *a, const ptx_block *b) {
    return a->position == b->position && a->header == b->header && a->res.u == b->res.u &&
           a->res.v == b->res.v;
}

slv_result slvi_ptx_need_tiles(const slv_ptx *ptx, ptx_scratch *scratch, const ptx_block *block) {
    uint32_t size = PTX_BLOCK_SIZE(block->header), face = block->face, table_size = 0;
    uint64_t ahead = size < TABLE_AHEAD ? size : TABLE_AHEAD;
    slv_res res = block->res, tile = {-1, -1};
    const uint8_t *bytes;
    slv_result result;
    if (same_block(&scratch->table_block, block))
        return SLV_OK;
    scratch->table_block = (ptx_block){0};
    if (size >= 6) {
        if ((result = slvi_ptx_read_input(ptx, scratch, face, block->position, 6, ahead, &bytes)))
            return result;
        tile = (slv_res){(int8_t)bytes[0], (int8_t)bytes[1]};
        table_size = ptx_get_u32(bytes + 2);
    }
    if (tile.u < 0 || tile.v < 0 || tile.u > res.u || tile.v > res.v || table_size > size - 6)
        return slvi_ptx_corrupt(ptx, scratch, face, "its tile table makes no sense");
    uint64_t ntiles = UINT64_C(1) << (res.u - tile.u + res.v - tile.v);
    if (ntiles > UINT32_MAX || !slvi_ptx_zip_is_plausible(table_size, 4 * ntiles))
        return slvi_ptx_corrupt(ptx, scratch, face,
                                "its tile table does not fit into so few bytes");
    if ((result = slvi_ptx_scratch_reserve(scratch, ptx, &scratch->table_headers, 4 * ntiles)) ||
        (result = slvi_ptx_scratch_reserve(scratch, ptx, &scratch->table_positions,
                                           8 * (ntiles / PTX_POSITION_STEP + 1))) ||
        (result =
             slvi_ptx_read_input(ptx, scratch, face, block->position + 6, table_size, 0, &bytes)))
        return result;
    ptx_level *table = &scratch->table;
    table->headers = (uint32_t *)(void *)scratch->table_headers.bytes;
    table->positions = (uint64_t *)(void *)scratch->table_positions.bytes;
    table->nfaces = (uint32_t)ntiles;
    if (libdeflate_zlib_decompress(scratch->inflater, bytes, table_size, table->headers,
                                   (size_t)(4 * ntiles), NULL) != LIBDEFLATE_SUCCESS)
        return slvi_ptx_corrupt(ptx, scratch, face, "its tile table does not unpack");
    uint64_t at = 6 + (uint64_t)table_size;
    for (uint32_t i = 0; i < table->nfaces; i++) {
        uint32_t bytes_here = PTX_BLOCK_SIZE(table->headers[i]);
        uint32_t encoding = PTX_BLOCK_ENCODING(table->headers[i]);
        if (bytes_here > size - at || encoding == PTX_TILED ||
            (encoding == PTX_CONSTANT && bytes_here != ptx->pixel_size))
            return slvi_ptx_corrupt(ptx, scratch, face, "one of its tiles makes no sense");
        if (i % PTX_POSITION_STEP == 0)
            table->positions[i / PTX_POSITION_STEP] = block->position + at;
        at += bytes_here;
    }
    scratch->tile = tile;
    scratch->table_block = *block;
    return SLV_OK;
}

/* Rows of texels, each `in_step` and `pitch` bytes behind the one before. */
static void copy_rows(const uint8_t *in, size_t in_step, size_t row, size_t rows, uint8_t *out,
                      size_t pitch) {
    for (; rows; rows--, in += in_step, out += pitch)
        memcpy(out, in, row);
}

/* An array that is needed in parts: unpacked as a whole, and kept for the other parts. */
static slv_result keep(const slv_ptx *ptx, ptx_scratch *scratch, const ptx_block *block,
                       const struct array *array, uint64_t ahead, const uint8_t **out) {
    uint32_t size = PTX_BLOCK_SIZE(array->header), face = block->face;
    uint64_t bytes = ptx_region_bytes(ptx, array->res);
    bool triangle = ptx->info.mesh_type == SLV_PTX_TRIANGLE;
    const uint8_t *zipped;
    slv_result result;
    for (unsigned i = 0; i < PTX_KEPT; i++) {
        const ptx_kept *kept = &scratch->kept[i];
        if (kept->tile == array->index && same_block(&kept->block, block)) {
            scratch->newest = i;
            *out = kept->texels.bytes;
            return SLV_OK;
        }
    }
    ptx_kept *kept = &scratch->kept[triangle ? scratch->newest ^ 1 : 0];
    kept->block = (ptx_block){0};
    if (!slvi_ptx_zip_is_plausible(size, bytes))
        return slvi_ptx_corrupt(ptx, scratch, face, "its texels do not fit into so few bytes");
    if ((result = slvi_ptx_scratch_reserve(scratch, ptx, &kept->texels, bytes)) ||
        (result = slvi_ptx_read_input(ptx, scratch, face, array->position, size, ahead, &zipped)) ||
        (result = slvi_ptx_unpack(ptx, scratch, face, zipped, size,
                                  PTX_BLOCK_ENCODING(array->header) == PTX_DIFFZIPPED, array->res,
                                  kept->texels.bytes, (size_t)1 << array->res.u)))
        return result;
    kept->block = *block;
    kept->tile = array->index;
    scratch->newest = (unsigned)(kept - scratch->kept);
    *out = kept->texels.bytes;
    return SLV_OK;
}

/* A region within one array. */
static slv_result read_array(const slv_ptx *ptx, ptx_scratch *scratch, const ptx_block *block,
                             const struct array *array, uint64_t ahead, ptx_region region,
                             uint8_t *out, size_t pitch) {
    uint32_t size = PTX_BLOCK_SIZE(array->header), encoding = PTX_BLOCK_ENCODING(array->header);
    size_t pixel = ptx->pixel_size, rows = (size_t)1 << region.size.v;
    size_t row = pixel << region.size.u, width = (size_t)1 << array->res.u;
    bool whole = region.size.u == array->res.u && region.size.v == array->res.v;
    const uint8_t *bytes;
    slv_result result;
    if (encoding != PTX_CONSTANT && !whole) {
        if (!(result = keep(ptx, scratch, block, array, ahead, &bytes)))
            copy_rows(bytes + (region.y * width + region.x) * pixel, width * pixel, row, rows, out,
                      pitch * pixel);
        return result;
    }
    if ((result =
             slvi_ptx_read_input(ptx, scratch, block->face, array->position, size, ahead, &bytes)))
        return result;
    if (encoding != PTX_CONSTANT)
        return slvi_ptx_unpack(ptx, scratch, block->face, bytes, size, encoding == PTX_DIFFZIPPED,
                               array->res, out, pitch);
    if (size != pixel)
        return slvi_ptx_corrupt(ptx, scratch, block->face, "its one texel has a wrong size");
    slvi_fill_texels(out, bytes, pixel, UINT64_C(1) << region.size.u);
    copy_rows(out, 0, row, rows - 1, out + pitch * pixel, pitch * pixel);
    return SLV_OK;
}

static slv_result read_tiles(const slv_ptx *ptx, ptx_scratch *scratch, const ptx_block *block,
                             ptx_region region, uint8_t *out, size_t pitch) {
    slv_result result = slvi_ptx_need_tiles(ptx, scratch, block);
    if (result)
        return result;
    slv_res tile = scratch->tile, overlap = region.size;
    int columns = block->res.u - tile.u;
    uint64_t end = block->position + PTX_BLOCK_SIZE(block->header);
    bool whole = region.size.u == block->res.u && region.size.v == block->res.v;
    if (overlap.u > tile.u)
        overlap.u = tile.u;
    if (overlap.v > tile.v)
        overlap.v = tile.v;
    for (uint32_t y = 0; y < 1u << region.size.v; y += 1u << overlap.v)
        for (uint32_t x = 0; x < 1u << region.size.u; x += 1u << overlap.u) {
            uint32_t at_x = region.x + x, at_y = region.y + y;
            uint32_t index = (at_y >> tile.v << columns) + (at_x >> tile.u);
            struct array array = {slvi_ptx_block_position(&scratch->table, index),
                                  scratch->table.headers[index], index, tile};
            uint64_t left = end - array.position;
            uint64_t ahead = !whole ? 0 : left < BLOCK_AHEAD ? left : BLOCK_AHEAD;
            ptx_region part = {overlap, at_x & ((1u << tile.u) - 1), at_y & ((1u << tile.v) - 1)};
            if ((result = read_array(ptx, scratch, block, &array, ahead, part,
                                     out + (y * pitch + x) * ptx->pixel_size, pitch)))
                return result;
        }
    return SLV_OK;
}

slv_result slvi_ptx_read_stored(const slv_ptx *ptx, ptx_scratch *scratch, const ptx_block *block,
                                ptx_region region, uint8_t *out, size_t pitch) {
    size_t width = (size_t)1 << region.size.u, height = (size_t)1 << region.size.v;
    struct array array = {block->position, block->header, 0, block->res};
    slv_result result;
    if (PTX_BLOCK_SIZE(block->header) == 0)
        return slvi_ptx_corrupt(ptx, scratch, block->face,
                                "has no texels, and is not marked as constant");
    if (PTX_BLOCK_ENCODING(block->header) == PTX_TILED)
        result = read_tiles(ptx, scratch, block, region, out, pitch);
    else
        result = read_array(ptx, scratch, block, &array, 0, region, out, pitch);
    if (result || !block->plain)
        return result;
    if (pitch == width) {
        width *= height;
        height = 1;
    }
    for (size_t y = 0; y < height; y++)
        slv_ptx_premultiply(ptx->info.type, ptx->info.nchannels, ptx->info.alpha_channel,
                            out + y * pitch * ptx->pixel_size, width);
    return SLV_OK;
}
