/* Blocks of texels, held by as many as have the same. */
#include "layer/plane.h"

#include "base/log.h"
#include "base/memory.h"

#include <string.h>

void slvi_repeat(void *texels, size_t size, size_t bytes) {
    unsigned char *out = texels;
    for (size_t done = size, next; done < bytes; done += next) {
        next = done < bytes - done ? done : bytes - done;
        memcpy(out + done, out, next);
    }
}

/* Texels that are yet to be filled. */
static slv_result make_block(const slvi_plane *plane, slv_res res, uint64_t entry,
                             slvi_block **out) {
    size_t bytes = slvi_block_bytes(plane, res);
    slv_result result = slvi_alloc_plain(&plane->env, "layer", 1, sizeof **out + bytes, out);
    if (result)
        return result;
    (*out)->entry = entry;
    (*out)->bytes = (uint32_t)bytes;
    atomic_init(&(*out)->refs, 1);
    return SLV_OK;
}

slv_result slvi_block_create(const slvi_plane *plane, slv_res res, uint64_t entry,
                             slvi_block **out) {
    slv_result result = make_block(plane, res, entry, out);
    if (!result)
        memset((*out)->texels, 0, (*out)->bytes);
    return result;
}

slv_result slvi_block_copy(const slvi_plane *plane, slv_res res, const slvi_block *block,
                           uint64_t entry, slvi_block **out) {
    slv_result result = make_block(plane, res, entry, out);
    if (result)
        return result;
    if (block) {
        memcpy((*out)->texels, block->texels, block->bytes);
    } else {
        slv_type_from_float(plane->type, plane->fill, plane->nchannels, (*out)->texels);
        slvi_repeat((*out)->texels, plane->texel_size, (*out)->bytes);
    }
    return SLV_OK;
}

slvi_block *slvi_block_hold(slvi_block *block) {
    if (block)
        atomic_fetch_add(&block->refs, 1);
    return block;
}

void slvi_block_drop(slvi_block *block) {
    if (block && atomic_fetch_sub(&block->refs, 1) == 1)
        slvi_free(block);
}

slv_result slvi_table_create(const slvi_plane *plane, slv_res res, slvi_table **out) {
    uint32_t count = slvi_block_count(res);
    slv_result result =
        slvi_alloc(&plane->env, "layer", 1, sizeof **out + count * sizeof *(*out)->blocks, out);
    if (result)
        return result;
    (*out)->count = count;
    return SLV_OK;
}

void slvi_table_drop(slvi_table *table) {
    for (uint32_t i = 0; table && i < table->count; i++)
        slvi_block_drop(table->blocks[i]);
    slvi_free(table);
}

uint64_t slvi_table_bytes(const slvi_table *table) {
    uint64_t bytes = 0;
    for (uint32_t i = 0; table && i < table->count; i++)
        if (table->blocks[i])
            bytes += table->blocks[i]->bytes + sizeof(slvi_block);
    return bytes;
}

static slv_result make_plane(const slv_env *env, const slvi_plane *like, const slv_res *res,
                             slvi_plane **out) {
    slvi_plane *plane = NULL;
    slv_result result = slvi_alloc(env, "layer", 1, sizeof *plane, &plane);
    *out = NULL;
    if (result)
        return result;
    *plane = *like;
    plane->env = *env;
    plane->refs = 1;
    plane->res = NULL;
    plane->tables = NULL;
    if ((result = slvi_alloc(env, "layer", plane->nfaces, sizeof *plane->res, &plane->res)) ||
        (result = slvi_alloc(env, "layer", plane->nfaces, sizeof(void *), &plane->tables))) {
        slvi_plane_drop(plane);
        return result;
    }
    memcpy(plane->res, res, plane->nfaces * sizeof *res);
    *out = plane;
    return SLV_OK;
}

slv_result slvi_plane_create(const slv_env *env, const slv_texture_desc *desc, const float *fill,
                             slvi_plane **out) {
    slvi_plane like = {.nfaces = desc->nfaces,
                       .type = desc->type,
                       .nchannels = desc->nchannels,
                       .alpha = desc->alpha_channel,
                       .texel_size = slv_type_size(desc->type) * desc->nchannels};
    float rounded[SLVI_MOST_CHANNELS];
    if (fill) { /* to what a block holds of it */
        slv_type_from_float(desc->type, fill, desc->nchannels, rounded);
        slv_type_to_float(desc->type, rounded, desc->nchannels, like.fill);
    }
    for (uint32_t c = 0; c < desc->nchannels; c++)
        like.filled |= like.fill[c] != 0;
    return make_plane(env, &like, desc->res, out);
}

slv_result slvi_plane_share(const slvi_plane *plane, slvi_plane **out) {
    slv_result result = make_plane(&plane->env, plane, plane->res, out);
    for (uint32_t face = 0; !result && face < plane->nfaces; face++) {
        const slvi_table *from = plane->tables[face];
        if (!from)
            continue;
        if ((result = slvi_table_create(plane, plane->res[face], &(*out)->tables[face])))
            break;
        for (uint32_t i = 0; i < from->count; i++)
            (*out)->tables[face]->blocks[i] = slvi_block_hold(from->blocks[i]);
    }
    if (result) {
        slvi_plane_drop(*out);
        *out = NULL;
    }
    return result;
}

slvi_plane *slvi_plane_hold(slvi_plane *plane) {
    if (plane)
        plane->refs++;
    return plane;
}

void slvi_plane_drop(slvi_plane *plane) {
    if (!plane || --plane->refs)
        return;
    for (uint32_t face = 0; plane->tables && face < plane->nfaces; face++)
        slvi_table_drop(plane->tables[face]);
    slvi_free(plane->tables);
    slvi_free(plane->res);
    slvi_free(plane);
}

uint64_t slvi_plane_bytes(const slvi_plane *plane) {
    uint64_t bytes = 0;
    for (uint32_t face = 0; plane && face < plane->nfaces; face++)
        bytes += slvi_table_bytes(plane->tables[face]);
    return bytes;
}

/* A row of a rectangle as far as it lies in one block. */
typedef struct row {
    uint32_t index;     /* of the block */
    uint32_t x, length; /* from the rectangle's left, in texels */
    size_t at;          /* bytes from the block's first texel */
} row;

static row row_at(const slvi_plane *plane, slv_res res, slv_rect rect, uint32_t x, uint32_t y) {
    int u = slvi_block_log2(res.u), v = slvi_block_log2(res.v);
    uint32_t px = rect.x + x, py = rect.y + y, side = 1u << u, left = px & (side - 1);
    uint32_t length = side - left < rect.width - x ? side - left : rect.width - x;
    return (row){(py >> v) * slvi_blocks_along(res.u) + (px >> u), x, length,
                 ((size_t)(py & ((1u << v) - 1)) * side + left) * plane->texel_size};
}

void slvi_plane_read(const slvi_plane *plane, uint32_t face, slv_rect rect, float *out) {
    slv_res res = plane->res[face];
    const slvi_table *table = plane->tables[face];
    uint32_t n = plane->nchannels;
    for (uint32_t y = 0; y < rect.height; y++)
        for (uint32_t x = 0; x < rect.width;) {
            row r = row_at(plane, res, rect, x, y);
            const slvi_block *block = table ? table->blocks[r.index] : NULL;
            float *to = out + ((size_t)y * rect.width + x) * n;
            if (block)
                slv_type_to_float(plane->type, block->texels + r.at, (size_t)r.length * n, to);
            if (!block) {
                memcpy(to, plane->fill, n * sizeof *to);
                slvi_repeat(to, n * sizeof *to, (size_t)r.length * n * sizeof *to);
            }
            x += r.length;
        }
}

void slvi_table_write(const slvi_plane *plane, slv_res res, slvi_table *table, slv_rect rect,
                      uint64_t entry, const float *texels) {
    uint32_t n = plane->nchannels;
    for (uint32_t y = 0; y < rect.height; y++)
        for (uint32_t x = 0; x < rect.width;) {
            row r = row_at(plane, res, rect, x, y);
            slvi_block *block = table ? table->blocks[r.index] : NULL;
            if (block && block->entry == entry)
                slv_type_from_float(plane->type, texels + ((size_t)y * rect.width + x) * n,
                                    (size_t)r.length * n, block->texels + r.at);
            x += r.length;
        }
}
