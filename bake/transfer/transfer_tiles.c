/* Texels of the source as one thread needs them: a few tiles that were read last, as floats. */
#include "transfer/transfer_data.h"

#include "base/memory.h"

#include <selvage/ptx.h>

#include <string.h>

enum { TILE_BYTES = 1 << 16, MOST_SIDE_LOG2 = 5 };

void slvi_transfer_tiles_begin(const slv_env *env, const transfer_source *source,
                               transfer_tiles *out) {
    uint64_t texel = source->desc.nchannels * sizeof(float);
    *out = (transfer_tiles){.env = env, .source = source, .side_log2 = MOST_SIDE_LOG2};
    while (out->side_log2 && texel << 2 * out->side_log2 > TILE_BYTES)
        out->side_log2--;
    for (int i = 0; i < TRANSFER_TILES; i++)
        out->tiles[i].face = -1;
}

void slvi_transfer_tiles_end(transfer_tiles *tiles) {
    for (int i = 0; i < TRANSFER_TILES; i++)
        slvi_free(tiles->tiles[i].values);
    slvi_free(tiles->raw);
}

static slv_rect rect_of(const transfer_tiles *t, slv_res res, uint32_t x, uint32_t y) {
    uint32_t side = 1u << t->side_log2, width = 1u << res.u, height = 1u << res.v;
    return (slv_rect){x << t->side_log2, y << t->side_log2, width < side ? width : side,
                      height < side ? height : side};
}

static slv_result load(transfer_tiles *t, transfer_tile *tile, uint32_t face, slv_res res,
                       uint32_t x, uint32_t y) {
    const slv_source_desc *desc = &t->source->desc;
    slv_rect rect = rect_of(t, res, x, y);
    slv_res whole = t->source->faces[face].res;
    uint64_t most = UINT64_C(1) << 2 * t->side_log2, count = (uint64_t)rect.width * rect.height;
    slv_result result = SLV_OK;
    tile->face = -1;
    if (!t->raw)
        result = slvi_alloc_plain(t->env, "texels", most,
                                  desc->nchannels * slv_type_size(desc->type), &t->raw);
    if (!result && !tile->values)
        result = slvi_alloc_plain(t->env, "texels", most, desc->nchannels * sizeof(float),
                                  &tile->values);
    if (result ||
        (result = t->source->texels.fns->read(t->source->texels.user, face, res, rect, t->raw)))
        return result;
    slv_type_to_float(desc->type, t->raw, count * desc->nchannels, tile->values);
    /* texels at full resolution and means are as painted, reductions multiplied already */
    if ((res.u == whole.u && res.v == whole.v) || (res.u == 0 && res.v == 0))
        slv_ptx_premultiply(SLV_TYPE_FLOAT, desc->nchannels, desc->alpha_channel, tile->values,
                            count);
    tile->face = (int32_t)face;
    tile->res = res;
    tile->x = x;
    tile->y = y;
    return SLV_OK;
}

const float *slvi_transfer_fetch(transfer_tiles *t, uint32_t face, slv_res res, uint32_t x,
                                 uint32_t y) {
    if (t->source->faces[face].flags & SLV_FACE_CONSTANT) {
        res = (slv_res){0, 0};
        x = y = 0;
    }
    uint32_t tile_x = x >> t->side_log2, tile_y = y >> t->side_log2;
    uint32_t hash = face * 0x9E3779B1u + tile_x * 0x85EBCA77u + tile_y * 0xC2B2AE3Du +
                    (uint32_t)res.u * 0x27D4EB2Fu + (uint32_t)res.v * 0x165667B1u;
    transfer_tile *tile = &t->tiles[(hash ^ hash >> 15) % TRANSFER_TILES];
    if (t->result)
        return NULL;
    if (tile->face != (int32_t)face || tile->res.u != res.u || tile->res.v != res.v ||
        tile->x != tile_x || tile->y != tile_y)
        t->result = load(t, tile, face, res, tile_x, tile_y);
    if (t->result)
        return NULL;
    slv_rect rect = rect_of(t, res, tile_x, tile_y);
    return tile->values +
           ((size_t)(y - rect.y) * rect.width + (x - rect.x)) * t->source->desc.nchannels;
}
