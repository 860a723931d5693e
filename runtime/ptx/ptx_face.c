/* Reading texels: stored blocks, and the reductions that the file leaves to its reader. */
#include "ptx/ptx_file.h"
#include "ptx/ptx_reduce.h"

#include <stdio.h>
#include <stdlib.h>

slv_result ptx_scratch_reserve(ptx_scratch *scratch, const slv_ptx *ptx, ptx_buffer *buffer,
                               uint64_t size) {
    if (size <= buffer->capacity)
        return SLV_OK;
    free(buffer->bytes);
    buffer->capacity = 0;
    slv_result result = slv_alloc(scratch->env, ptx->name, size, 1, &buffer->bytes);
    if (!result)
        buffer->capacity = (size_t)size;
    return result;
}

void ptx_scratch_free(ptx_scratch *scratch) {
    libdeflate_free_decompressor(scratch->inflater);
    free(scratch->input.bytes);
    free(scratch->planes.bytes);
    free(scratch->tiles.bytes);
    free(scratch->work[0].bytes);
    free(scratch->work[1].bytes);
}

/* The bytes of a block, valid until the next call. */
static slv_result read_block(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                             uint64_t position, uint32_t size, const uint8_t **out) {
    uint64_t end = scratch->input_position + scratch->input_size;
    if (position < scratch->input_position || position + size > end) {
        uint64_t wanted = size, left = ptx->source.size - position;
        if (wanted < scratch->read_ahead)
            wanted = left < scratch->read_ahead ? left : scratch->read_ahead;
        scratch->input_size = 0;
        slv_result result = ptx_scratch_reserve(scratch, ptx, &scratch->input, wanted);
        if (result)
            return result;
        char what[48];
        snprintf(what, sizeof what, "data of face %u", face);
        if ((result =
                 ptx_read_bytes(scratch->env, ptx, what, position, wanted, scratch->input.bytes)))
            return result;
        scratch->input_position = position;
        scratch->input_size = (size_t)wanted;
    }
    *out = scratch->input.bytes + (position - scratch->input_position);
    return SLV_OK;
}

/* Planar elements, differences summed up, to interleaved rows that lie `pitch` elements apart.
 * Reading and writing the same array is fine when there is one channel. */
#define DEFINE_INTERLEAVE(NAME, T)                                                                 \
    static void NAME(const T *in, T keep, size_t n, size_t w, size_t h, T *out, size_t pitch) {    \
        T value = 0;                                                                               \
        for (size_t c = 0; c < n; c++)                                                             \
            for (size_t y = 0; y < h; y++) {                                                       \
                T *to = out + y * pitch + c;                                                       \
                for (size_t x = 0; x < w; x++, to += n) {                                          \
                    value = (T)((T)(value & keep) + *in++);                                        \
                    *to = value;                                                                   \
                }                                                                                  \
            }                                                                                      \
    }

/* The same with differences, for few channels: each is summed up by itself, from where the one
 * before it ends, so that none waits for another. */
#define DEFINE_SUM(NAME, T, N)                                                                     \
    static void NAME(const T *in, size_t w, size_t h, T *out, size_t pitch) {                      \
        T value[N] = {0};                                                                          \
        for (size_t c = 0; c + 1 < N; c++) {                                                       \
            T total = value[c];                                                                    \
            for (size_t i = 0; i < w * h; i++)                                                     \
                total = (T)(total + in[c * w * h + i]);                                            \
            value[c + 1] = total;                                                                  \
        }                                                                                          \
        for (size_t y = 0; y < h; y++)                                                             \
            for (size_t x = 0; x < w; x++)                                                         \
                for (size_t c = 0; c < N; c++) {                                                   \
                    value[c] = (T)(value[c] + in[c * w * h + y * w + x]);                          \
                    out[y * pitch + x * N + c] = value[c];                                         \
                }                                                                                  \
    }

DEFINE_INTERLEAVE(interleave_u8, uint8_t)
DEFINE_INTERLEAVE(interleave_u16, uint16_t)
DEFINE_INTERLEAVE(interleave_u32, uint32_t)
DEFINE_SUM(sum_u8_3, uint8_t, 3)
DEFINE_SUM(sum_u8_4, uint8_t, 4)
DEFINE_SUM(sum_u16_3, uint16_t, 3)
DEFINE_SUM(sum_u16_4, uint16_t, 4)

static void sum_u8(const uint8_t *in, size_t n, size_t w, size_t h, uint8_t *out, size_t pitch) {
    if (n == 3)
        sum_u8_3(in, w, h, out, pitch);
    else if (n == 4)
        sum_u8_4(in, w, h, out, pitch);
    else
        interleave_u8(in, 0xff, n, w, h, out, pitch);
}

static void sum_u16(const uint16_t *in, size_t n, size_t w, size_t h, uint16_t *out, size_t pitch) {
    if (n == 3)
        sum_u16_3(in, w, h, out, pitch);
    else if (n == 4)
        sum_u16_4(in, w, h, out, pitch);
    else
        interleave_u16(in, 0xffff, n, w, h, out, pitch);
}

static slv_result corrupt(const slv_ptx *ptx, const ptx_scratch *scratch, uint32_t face,
                          const char *why) {
    return slv_fail(scratch->env, SLV_ERROR_FORMAT, "%s: face %u: %s", ptx->name, face, why);
}

/* One zipped array of `res` texels into rows `pitch` texels apart. */
static slv_result unpack(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                         const uint8_t *zipped, uint32_t size, bool differences, slv_res res,
                         void *out, size_t pitch) {
    size_t w = (size_t)1 << res.u, h = (size_t)1 << res.v, n = ptx->info.nchannels;
    uint64_t bytes = ptx_texel_count(res) * ptx->pixel_size;
    uint8_t *planes = out;
    bool in_place = n == 1 && pitch == w;
    if (!ptx_zip_is_plausible(size, bytes))
        return corrupt(ptx, scratch, face, "its texels do not fit into so few bytes");
    if (!in_place) {
        slv_result result = ptx_scratch_reserve(scratch, ptx, &scratch->planes, bytes);
        if (result)
            return result;
        planes = scratch->planes.bytes;
    }
    if (!ptx_inflate_literals(zipped, size, planes, (size_t)bytes) &&
        libdeflate_zlib_decompress(scratch->inflater, zipped, size, planes, (size_t)bytes, NULL) !=
            LIBDEFLATE_SUCCESS)
        return corrupt(ptx, scratch, face, "its texels do not unpack to the size they should have");
    switch (ptx->info.type) {
    case SLV_TYPE_U8:
        if (differences)
            sum_u8(planes, n, w, h, out, pitch * n);
        else if (!in_place)
            interleave_u8(planes, 0, n, w, h, out, pitch * n);
        break;
    case SLV_TYPE_U16:
        if (differences)
            sum_u16((const uint16_t *)(const void *)planes, n, w, h, out, pitch * n);
        else if (!in_place)
            interleave_u16((const uint16_t *)(const void *)planes, 0, n, w, h, out, pitch * n);
        break;
    case SLV_TYPE_HALF:
        if (!in_place)
            interleave_u16((const uint16_t *)(const void *)planes, 0, n, w, h, out, pitch * n);
        break;
    case SLV_TYPE_FLOAT:
        if (!in_place)
            interleave_u32((const uint32_t *)(const void *)planes, 0, n, w, h, out, pitch * n);
        break;
    }
    return SLV_OK;
}

static slv_result decode_tiles(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                               const uint8_t *bytes, uint32_t size, slv_res res, uint8_t *out) {
    slv_res tile = {0, 0};
    uint32_t table_size = 0;
    if (size >= 6) {
        tile = (slv_res){(int8_t)bytes[0], (int8_t)bytes[1]};
        table_size = ptx_get_u32(bytes + 2);
    }
    if (size < 6 || tile.u < 0 || tile.v < 0 || tile.u > res.u || tile.v > res.v ||
        table_size > size - 6)
        return corrupt(ptx, scratch, face, "its tile table makes no sense");
    uint32_t columns = 1u << (res.u - tile.u), rows = 1u << (res.v - tile.v);
    uint64_t ntiles = (uint64_t)columns * rows, at = 6 + (uint64_t)table_size;
    if (!ptx_zip_is_plausible(table_size, 4 * ntiles))
        return corrupt(ptx, scratch, face, "its tile table does not fit into so few bytes");
    slv_result result = ptx_scratch_reserve(scratch, ptx, &scratch->tiles, 4 * ntiles);
    if (result)
        return result;
    if (libdeflate_zlib_decompress(scratch->inflater, bytes + 6, table_size, scratch->tiles.bytes,
                                   (size_t)(4 * ntiles), NULL) != LIBDEFLATE_SUCCESS)
        return corrupt(ptx, scratch, face, "its tile table does not unpack");
    size_t pitch = (size_t)1 << res.u, row_bytes = ((size_t)1 << tile.u) * ptx->pixel_size;
    for (uint64_t i = 0; i < ntiles; i++) {
        uint32_t header = ptx_get_u32(scratch->tiles.bytes + 4 * i);
        uint32_t block = PTX_BLOCK_SIZE(header), encoding = PTX_BLOCK_ENCODING(header);
        if (block > size - at || encoding == PTX_TILED ||
            (encoding == PTX_CONSTANT && block != ptx->pixel_size))
            return corrupt(ptx, scratch, face, "one of its tiles makes no sense");
        size_t y = (size_t)(i / columns) << tile.v, x = (size_t)(i % columns) << tile.u;
        uint8_t *to = out + (y * pitch + x) * ptx->pixel_size;
        if (encoding == PTX_CONSTANT) {
            for (size_t row = 0; row < (size_t)1 << tile.v; row++)
                if (row == 0)
                    ptx_fill(to, bytes + at, ptx->pixel_size, UINT64_C(1) << tile.u);
                else
                    memcpy(to + row * pitch * ptx->pixel_size, to, row_bytes);
        } else if ((result = unpack(ptx, scratch, face, bytes + at, block,
                                    encoding == PTX_DIFFZIPPED, tile, to, pitch)))
            return result;
        at += block;
    }
    return SLV_OK;
}

static slv_result decode_block(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                               uint32_t header, uint64_t position, slv_res res, void *out) {
    uint32_t size = PTX_BLOCK_SIZE(header), encoding = PTX_BLOCK_ENCODING(header);
    const uint8_t *bytes;
    if (size == 0)
        return corrupt(ptx, scratch, face, "has no texels, and is not marked as constant");
    slv_result result = read_block(ptx, scratch, face, position, size, &bytes);
    if (result)
        return result;
    if (encoding == PTX_TILED)
        return decode_tiles(ptx, scratch, face, bytes, size, res, out);
    if (encoding != PTX_CONSTANT)
        return unpack(ptx, scratch, face, bytes, size, encoding == PTX_DIFFZIPPED, res, out,
                      (size_t)1 << res.u);
    if (size != ptx->pixel_size)
        return corrupt(ptx, scratch, face, "its one texel has a wrong size");
    ptx_fill(out, bytes, ptx->pixel_size, ptx_texel_count(res));
    return SLV_OK;
}

/* Where the texels of a face at full resolution are. */
static void find_texels(const slv_ptx *ptx, uint32_t face, const slv_ptx_face *f, uint32_t *header,
                        uint64_t *position) {
    const ptx_level *level = &ptx->tables->levels[0];
    const ptx_edit *edit = f->flags & SLV_FACE_EDITED ? ptx_find_edit(ptx, face) : NULL;
    *header = edit ? edit->header : level->headers[face];
    *position = edit ? edit->position : ptx_block_position(level, face);
}

bool ptx_face_is_plausible(const slv_ptx *ptx, uint32_t face, const slv_ptx_face *f) {
    uint64_t position;
    uint32_t header;
    find_texels(ptx, face, f, &header, &position);
    uint32_t encoding = PTX_BLOCK_ENCODING(header);
    if (encoding == PTX_CONSTANT || encoding == PTX_TILED)
        return PTX_BLOCK_SIZE(header) != 0;
    return ptx_zip_is_plausible(PTX_BLOCK_SIZE(header), ptx_texel_count(f->res) * ptx->pixel_size);
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

static slv_result read_reduced(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                               const slv_ptx_face *f, slv_res res, void *out) {
    slv_res steps[2 * SLV_MAX_LOG2_RES + 1];
    uint32_t nsteps = 0, header;
    uint64_t position;
    slv_res source = res;
    bool reduced = res.u != f->res.u || res.v != f->res.v;
    slv_result result = SLV_OK;
    int level;
    if (reduced && ptx->info.nlevels > 1 && (result = ptx_need(ptx, PTX_RANKS)))
        return result;
    while ((level = stored_level(ptx, face, f, source)) < 0) {
        steps[nsteps++] = source;
        source = finer(ptx, f, source);
    }
    if ((result = ptx_need(ptx, PTX_LEVEL(level))))
        return result;
    if (level == 0)
        find_texels(ptx, face, f, &header, &position);
    else {
        header = ptx->tables->levels[level].headers[ptx->tables->ranks[face]];
        position = ptx_block_position(&ptx->tables->levels[level], ptx->tables->ranks[face]);
    }
    if (!nsteps) {
        result = decode_block(ptx, scratch, face, header, position, res, out);
        if (!result && ptx->premultiply && level == 0)
            slv_ptx_premultiply(ptx->info.type, ptx->info.nchannels, ptx->info.alpha_channel, out,
                                ptx_texel_count(res));
        return result;
    }

    uint64_t bytes = ptx_texel_count(source) * ptx->pixel_size;
    if (level == 0 && !ptx_face_is_plausible(ptx, face, f))
        return corrupt(ptx, scratch, face, "its texels do not fit into so few bytes");
    if ((result = ptx_scratch_reserve(scratch, ptx, &scratch->work[0], bytes)) ||
        (result =
             decode_block(ptx, scratch, face, header, position, source, scratch->work[0].bytes)))
        return result;
    bool triangle = ptx->info.mesh_type == SLV_PTX_TRIANGLE;
    if (triangle && (result = ptx_scratch_reserve(scratch, ptx, &scratch->work[1], bytes / 4)))
        return result;
    uint8_t *from = scratch->work[0].bytes, *other = scratch->work[1].bytes;
    if (ptx->premultiply && level == 0)
        slv_ptx_premultiply(ptx->info.type, ptx->info.nchannels, ptx->info.alpha_channel, from,
                            ptx_texel_count(source));
    while (nsteps) {
        slv_res next = steps[--nsteps];
        uint8_t *to = nsteps ? triangle ? other : from : out;
        if (triangle)
            ptx_halve_triangle(ptx->info.type, ptx->info.nchannels, source.u, from, to);
        else if (next.u < source.u)
            ptx_halve_u(ptx->info.type, ptx->info.nchannels, source, from, to);
        else
            ptx_halve_v(ptx->info.type, ptx->info.nchannels, source, from, to);
        other = from;
        from = to;
        source = next;
    }
    return SLV_OK;
}

slv_result ptx_read_face_with(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face, slv_res res,
                              void *out) {
    if (face >= ptx->info.nfaces)
        return slv_fail(scratch->env, SLV_ERROR_ARGUMENT, "%s: face %u: there are %u faces",
                        ptx->name, face, ptx->info.nfaces);
    slv_result result = ptx_need(ptx, PTX_FACES);
    if (result)
        return result;
    slv_ptx_face f = ptx_face_at(ptx, face);
    bool triangle = ptx->info.mesh_type == SLV_PTX_TRIANGLE;
    if (res.u < 0 || res.v < 0 || res.u > f.res.u || res.v > f.res.v ||
        (triangle && res.u != res.v))
        return slv_fail(scratch->env, SLV_ERROR_ARGUMENT,
                        "%s: face %u: has 2^%d x 2^%d texels, which do not reduce to 2^%d x 2^%d",
                        ptx->name, face, f.res.u, f.res.v, res.u, res.v);
    if ((f.flags & SLV_FACE_CONSTANT) || (res.u == 0 && res.v == 0)) {
        if ((result = ptx_need(ptx, PTX_CONSTANTS)))
            return result;
        ptx_fill(out, ptx->tables->constants + face * ptx->pixel_size, ptx->pixel_size,
                 ptx_texel_count(res));
        return SLV_OK;
    }
    if (!scratch->inflater) {
        scratch->inflater = libdeflate_alloc_decompressor();
        if (!scratch->inflater)
            return slv_fail(scratch->env, SLV_ERROR_MEMORY, "%s: face %u: no memory to unpack it",
                            ptx->name, face);
    }
    return read_reduced(ptx, scratch, face, &f, res, out);
}

slv_result slv_ptx_read_face(const slv_ptx *ptx, uint32_t face, slv_res res, void *out) {
    ptx_scratch scratch = {.env = &ptx->env};
    slv_result result = ptx_read_face_with(ptx, &scratch, face, res, out);
    ptx_scratch_free(&scratch);
    return result;
}

struct slv_ptx_reader {
    const slv_ptx *ptx;
    slv_env env;
    ptx_scratch scratch;
};

slv_result slv_ptx_reader_create(const slv_env *env, const slv_ptx *ptx, slv_ptx_reader **out) {
    slv_ptx_reader *reader = NULL;
    slv_result result = slv_alloc(env, ptx->name, 1, sizeof *reader, &reader);
    *out = NULL;
    if (result)
        return result;
    reader->ptx = ptx;
    reader->env = slv_env_or_default(env);
    reader->scratch.env = &reader->env;
    *out = reader;
    return SLV_OK;
}

void slv_ptx_reader_destroy(slv_ptx_reader *reader) {
    if (!reader)
        return;
    ptx_scratch_free(&reader->scratch);
    free(reader);
}

slv_result slv_ptx_reader_read(slv_ptx_reader *reader, uint32_t face, slv_res res, void *out) {
    return ptx_read_face_with(reader->ptx, &reader->scratch, face, res, out);
}
