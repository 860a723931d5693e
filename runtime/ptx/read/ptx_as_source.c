/* A .ptx file as a source: any rectangle, out of tiles, by readers that are kept for whoever comes
 * next. */
#include "base/idle.h"
#include "base/log.h"
#include "base/memory.h"
#include "ptx/format/ptx_file.h"

/* What is read at a time of rectangles that are no tiles. */
#define TILE_BYTES 65536

typedef struct ptx_idle_reader {
    slvi_idle_link link;
    slv_ptx_reader *reader;
} ptx_idle_reader;

typedef struct ptx_as_source {
    slv_env env;
    const slv_ptx *ptx;
    slvi_idle idle;
} ptx_as_source;

static const slv_source_fns ptx_fns;

static slv_result describe(void *user, slv_source_desc *out) {
    const ptx_as_source *source = user;
    const slv_ptx_info *info = &source->ptx->info;
    *out = (slv_source_desc){.name = source->ptx->name,
                             .nfaces = info->nfaces,
                             .type = info->type,
                             .nchannels = info->nchannels,
                             .alpha_channel = info->alpha_channel,
                             .triangles = info->mesh_type == SLV_PTX_TRIANGLE,
                             .border_u = info->border_u,
                             .border_v = info->border_v,
                             .edge_filter = info->edge_filter};
    return SLV_OK;
}

static slv_result face(void *user, uint32_t index, slv_source_face *out) {
    const ptx_as_source *source = user;
    return slv_ptx_get_face(source->ptx, index, out);
}

/* Whoever read last, so that what it unpacked may serve again. */
static slv_result take_reader(ptx_as_source *source, ptx_idle_reader **out) {
    ptx_idle_reader *reader = slvi_idle_take(&source->idle);
    *out = reader;
    if (reader)
        return SLV_OK;
    slv_result result = slvi_alloc(&source->env, source->ptx->name, 1, sizeof *reader, &reader);
    if (result)
        return result;
    if ((result = slv_ptx_reader_create(&source->env, source->ptx, &reader->reader))) {
        slvi_free(reader);
        return result;
    }
    *out = reader;
    return SLV_OK;
}

/* Whether a rectangle is a tile that the file can be asked for, and of what size. */
static bool is_tile(const ptx_as_source *source, slv_rect r, slv_res *size) {
    *size = (slv_res){(int8_t)slv_res_log2(r.width), (int8_t)slv_res_log2(r.height)};
    return size->u >= 0 && size->v >= 0 && !(r.x & (r.width - 1)) && !(r.y & (r.height - 1)) &&
           (r.width == r.height || source->ptx->info.mesh_type != SLV_PTX_TRIANGLE);
}

/* A rectangle in parts of tiles. */
static slv_result read_parts(ptx_as_source *source, slv_ptx_reader *reader, uint32_t index,
                             slv_res res, slv_rect rect, uint8_t *out) {
    size_t pixel = source->ptx->pixel_size;
    bool triangle = source->ptx->info.mesh_type == SLV_PTX_TRIANGLE;
    slv_res tile = res;
    uint8_t *texels = NULL;
    while (ptx_texel_count(tile) * pixel > TILE_BYTES && tile.u + tile.v > 0)
        if (triangle) {
            tile.u--;
            tile.v--;
        } else if (tile.u >= tile.v)
            tile.u--;
        else
            tile.v--;
    slv_result result =
        slvi_alloc_plain(&source->env, source->ptx->name, ptx_texel_count(tile), pixel, &texels);
    uint32_t end_x = rect.x + rect.width, end_y = rect.y + rect.height;
    for (uint32_t y = rect.y; !result && y < end_y; y = ((y >> tile.v) + 1) << tile.v)
        for (uint32_t x = rect.x; !result && x < end_x; x = ((x >> tile.u) + 1) << tile.u) {
            uint32_t tile_x = x >> tile.u << tile.u, tile_y = y >> tile.v << tile.v;
            uint32_t stop_x = tile_x + (1u << tile.u), stop_y = tile_y + (1u << tile.v);
            stop_x = stop_x < end_x ? stop_x : end_x;
            stop_y = stop_y < end_y ? stop_y : end_y;
            result = slv_ptx_reader_read_tile(reader, index, res, tile, tile_x, tile_y, texels);
            for (uint32_t row = y; !result && row < stop_y; row++)
                memcpy(out + ((size_t)(row - rect.y) * rect.width + (x - rect.x)) * pixel,
                       texels + (((size_t)(row - tile_y) << tile.u) + (x - tile_x)) * pixel,
                       (stop_x - x) * pixel);
        }
    slvi_free(texels);
    return result;
}

static slv_result read_rect(void *user, uint32_t index, slv_res res, slv_rect rect, void *out) {
    ptx_as_source *source = user;
    const slv_source self = {&ptx_fns, source};
    ptx_idle_reader *reader;
    slv_source_face found;
    slv_result result = slv_source_check(&source->env, &self, index, res, rect, &found);
    if (result || (result = take_reader(source, &reader)))
        return result;
    slv_res size;
    if (is_tile(source, rect, &size))
        result = slv_ptx_reader_read_tile(reader->reader, index, res, size, rect.x, rect.y, out);
    else
        result = read_parts(source, reader->reader, index, res, rect, out);
    slvi_idle_give(&source->idle, reader);
    return result;
}

static void close_source(void *user) {
    ptx_as_source *source = user;
    for (ptx_idle_reader *reader; (reader = slvi_idle_take(&source->idle));) {
        slv_ptx_reader_destroy(reader->reader);
        slvi_free(reader);
    }
    slvi_idle_end(&source->idle);
    slvi_free(source);
}

static const slv_source_fns ptx_fns = {
    .describe = describe, .face = face, .read = read_rect, .close = close_source};

slv_result slv_ptx_as_source(const slv_env *env, const slv_ptx *ptx, slv_source *out) {
    ptx_as_source *source = NULL;
    *out = (slv_source){0};
    /* faces must not fail once the source is there */
    slv_result result = ptx_need(ptx, PTX_FACES | PTX_CONSTANTS);
    if (result || (result = slvi_alloc(env, ptx->name, 1, sizeof *source, &source)))
        return result;
    source->env = slvi_env_or_default(env);
    source->ptx = ptx;
    slvi_idle_begin(&source->idle);
    *out = (slv_source){&ptx_fns, source};
    return SLV_OK;
}
