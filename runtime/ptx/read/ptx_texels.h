/* Reading texels: what one thread keeps for it, and the steps from a block of the file to a region
 * of a face at some resolution. */
#ifndef SLV_PTX_TEXELS_H
#define SLV_PTX_TEXELS_H

#include "ptx/format/ptx_file.h"

typedef struct ptx_buffer {
    uint8_t *bytes;
    size_t capacity;
} ptx_buffer;

/* Texels from (x, y) on, as many as `size` says; all of it a whole multiple of `size` from the
 * origin. */
typedef struct ptx_region {
    slv_res size;
    uint32_t x, y;
} ptx_region;

/* Where a face is stored, at one resolution. */
typedef struct ptx_block {
    uint64_t position;
    uint32_t header, face;
    slv_res res;
    bool plain; /* still to be premultiplied */
} ptx_block;

/* The stored array that was unpacked last: a tile, or a block without tiles. A triangle's
 * reductions need two, as each region is made of itself and of its mirror image. */
#define PTX_KEPT 2
typedef struct ptx_kept {
    ptx_block block; /* all zero if there is nothing */
    uint32_t tile;
    ptx_buffer texels;
} ptx_kept;

/* What one thread needs to read faces; zeroed but for `env` at first. */
typedef struct ptx_scratch {
    const slv_env *env;
    struct libdeflate_decompressor *inflater;
    size_t read_ahead; /* how much to read at a time when blocks are small and follow each other */
    ptx_buffer input, planes, work;
    uint64_t input_position;
    size_t input_size;
    ptx_kept kept[PTX_KEPT];
    unsigned newest;       /* of those */
    ptx_block table_block; /* whose tile table this is; all zero if there is none */
    slv_res tile;
    ptx_level table;
    ptx_buffer table_headers, table_positions;
} ptx_scratch;

/* ptx_inflate.c: unpacks a zlib stream if it is of literals alone; else returns false, and `out` is
 * of no use. */
bool slvi_ptx_inflate_literals(const uint8_t *in, size_t size, uint8_t *out, size_t out_size);

/* ptx_unpack.c */
slv_result slvi_ptx_scratch_reserve(ptx_scratch *scratch, const slv_ptx *ptx, ptx_buffer *buffer,
                                    uint64_t size);
/* Gives back what only large blocks without tiles need. */
void slvi_ptx_scratch_trim(ptx_scratch *scratch);
void slvi_ptx_scratch_free(ptx_scratch *scratch);
slv_result slvi_ptx_corrupt(const slv_ptx *ptx, const ptx_scratch *scratch, uint32_t face,
                            const char *why);
/* `size` bytes of a face's data, valid until the next call; up to `ahead` are read for the calls
 * that follow. */
slv_result slvi_ptx_read_input(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                               uint64_t position, uint32_t size, uint64_t ahead,
                               const uint8_t **out);
/* One zipped array of `res` texels into rows `pitch` texels apart. */
slv_result slvi_ptx_unpack(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                           const uint8_t *zipped, uint32_t size, bool differences, slv_res res,
                           void *out, size_t pitch);

/* ptx_tile.c */
/* The table of a tiled block, into scratch->table and scratch->tile. */
slv_result slvi_ptx_need_tiles(const slv_ptx *ptx, ptx_scratch *scratch, const ptx_block *block);
/* A region of what a block stores, into rows `pitch` texels apart. */
slv_result slvi_ptx_read_stored(const slv_ptx *ptx, ptx_scratch *scratch, const ptx_block *block,
                                ptx_region region, uint8_t *out, size_t pitch);

/* ptx_region.c: a region of the reduction that `steps` - 1 halvings make of a block; res[0] is that
 * of the region, res[steps - 1] the block's. */
slv_result slvi_ptx_read_reduced(const slv_ptx *ptx, ptx_scratch *scratch, const ptx_block *block,
                                 const slv_res *res, uint32_t steps, ptx_region region,
                                 uint8_t *out);

/* ptx_face.c: a region of a face at `res`. */
slv_result slvi_ptx_read_as_stored(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                                   slv_res res, ptx_region region, void *out);
/* ptx_salvage.c: the same, filled from what is left where a file opened for salvage is damaged. */
slv_result slvi_ptx_read_region(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                                slv_res res, ptx_region region, void *out);

/* ptx_reader.c */
slv_result slvi_ptx_read_face_with(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                                   slv_res res, void *out);

static inline uint64_t ptx_region_bytes(const slv_ptx *ptx, slv_res size) {
    return ptx_texel_count(size) * ptx->pixel_size;
}

#endif
