/* Texels of all faces in blocks that are shared until they are written to. */
#ifndef SLV_PAINT_PLANE_H
#define SLV_PAINT_PLANE_H

#include <selvage/texture.h>

#include <stdatomic.h>

enum { SLVI_BLOCK_LOG2 = 5, SLVI_BLOCK_SIDE = 1 << SLVI_BLOCK_LOG2, SLVI_MOST_CHANNELS = 8 };

/* Texels of a part of a face. */
typedef struct slvi_block {
    uint64_t entry; /* of the history, in which it was made: while that goes on, and nobody else
                       holds it, it may be written to */
    atomic_uint refs;
    uint32_t bytes; /* of texels */
    unsigned char texels[];
} slvi_block;

/* What a face has: its blocks, v-major, or none if nothing of it was painted. */
typedef struct slvi_table {
    uint32_t count;
    slvi_block *blocks[]; /* NULL: all texels are the plane's fill */
} slvi_table;

typedef struct slvi_plane {
    slv_env env;
    uint32_t refs; /* layers and entries of the history */
    uint32_t nfaces;
    slv_type type;
    uint32_t nchannels;
    int32_t alpha;
    size_t texel_size;
    float fill[SLVI_MOST_CHANNELS];
    bool filled; /* `fill` is not zero */
    slv_res *res;
    slvi_table **tables;
} slvi_plane;

/* `res` is copied; `fill` NULL is zeros. */
slv_result slvi_plane_create(const slv_env *env, const slv_texture_desc *desc, const float *fill,
                             slvi_plane **out);
/* One that shares all blocks. */
slv_result slvi_plane_share(const slvi_plane *plane, slvi_plane **out);
slvi_plane *slvi_plane_hold(slvi_plane *plane);
void slvi_plane_drop(slvi_plane *plane); /* may be NULL */
uint64_t slvi_plane_bytes(const slvi_plane *plane);

slv_result slvi_table_create(const slvi_plane *plane, slv_res res, slvi_table **out);
void slvi_table_drop(slvi_table *table); /* may be NULL */
uint64_t slvi_table_bytes(const slvi_table *table);

/* Of a resolution: how many texels a block has along an axis, and how many blocks there are. */
static inline int slvi_block_log2(int log2) {
    return log2 < SLVI_BLOCK_LOG2 ? log2 : SLVI_BLOCK_LOG2;
}
static inline uint32_t slvi_blocks_along(int log2) {
    return 1u << (log2 - slvi_block_log2(log2));
}
static inline uint32_t slvi_block_count(slv_res res) {
    return slvi_blocks_along(res.u) * slvi_blocks_along(res.v);
}
static inline size_t slvi_block_bytes(const slvi_plane *plane, slv_res res) {
    return plane->texel_size << (slvi_block_log2(res.u) + slvi_block_log2(res.v));
}
static inline slv_rect slvi_res_rect(slv_res res) {
    return (slv_rect){0, 0, 1u << res.u, 1u << res.v};
}
static inline slv_rect slvi_block_rect(slv_res res, uint32_t index) {
    int u = slvi_block_log2(res.u), v = slvi_block_log2(res.v);
    uint32_t along = slvi_blocks_along(res.u);
    return (slv_rect){index % along << u, index / along << v, 1u << u, 1u << v};
}
/* The blocks that a rectangle of texels touches, as a rectangle of blocks. */
static inline slv_rect slvi_rect_blocks(slv_res res, slv_rect rect) {
    int u = slvi_block_log2(res.u), v = slvi_block_log2(res.v);
    slv_rect out = {rect.x >> u, rect.y >> v, 0, 0};
    out.width = ((rect.x + rect.width - 1) >> u) + 1 - out.x;
    out.height = ((rect.y + rect.height - 1) >> v) + 1 - out.y;
    return out;
}

/* Copies the first `size` bytes into all of them. */
void slvi_repeat(void *texels, size_t size, size_t bytes);
/* Texels as if all were zero but the header. */
slv_result slvi_block_create(const slvi_plane *plane, slv_res res, uint64_t entry,
                             slvi_block **out);
/* A copy of a block, or if it is NULL one of the plane's fill. */
slv_result slvi_block_copy(const slvi_plane *plane, slv_res res, const slvi_block *block,
                           uint64_t entry, slvi_block **out);
slvi_block *slvi_block_hold(slvi_block *block); /* may be NULL, as below */
void slvi_block_drop(slvi_block *block);

/* A rectangle of a face as floats, tightly packed. */
void slvi_plane_read(const slvi_plane *plane, uint32_t face, slv_rect rect, float *out);
/* Puts floats into those blocks of a table that were made in `entry`. */
void slvi_table_write(const slvi_plane *plane, slv_res res, slvi_table *table, slv_rect rect,
                      uint64_t entry, const float *texels);

#endif
