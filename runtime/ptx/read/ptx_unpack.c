/* From the bytes of a stored array to its texels. */
#include "ptx/read/ptx_texels.h"

#include "base/log.h"
#include "base/memory.h"

#include <stdio.h>

#define LARGE (UINT32_C(1) << 18)

slv_result slvi_ptx_scratch_reserve(ptx_scratch *scratch, const slv_ptx *ptx, ptx_buffer *buffer,
                                    uint64_t size) {
    if (size <= buffer->capacity)
        return SLV_OK;
    slvi_free(buffer->bytes);
    buffer->capacity = 0;
    slv_result result = slvi_alloc(scratch->env, ptx->name, size, 1, &buffer->bytes);
    if (!result)
        buffer->capacity = (size_t)size;
    return result;
}

static void release(ptx_buffer *buffer) {
    slvi_free(buffer->bytes);
    *buffer = (ptx_buffer){0};
}

void slvi_ptx_scratch_trim(ptx_scratch *scratch) {
    if (scratch->planes.capacity > LARGE)
        release(&scratch->planes);
    if (scratch->input.capacity > LARGE) {
        release(&scratch->input);
        scratch->input_size = 0;
    }
    for (unsigned i = 0; i < PTX_KEPT; i++)
        if (scratch->kept[i].texels.capacity > LARGE) {
            release(&scratch->kept[i].texels);
            scratch->kept[i].block = (ptx_block){0};
        }
}

void slvi_ptx_scratch_free(ptx_scratch *scratch) {
    libdeflate_free_decompressor(scratch->inflater);
    release(&scratch->input);
    release(&scratch->planes);
    release(&scratch->work);
    release(&scratch->table_headers);
    release(&scratch->table_positions);
    for (unsigned i = 0; i < PTX_KEPT; i++)
        release(&scratch->kept[i].texels);
}

slv_result slvi_ptx_read_input(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                               uint64_t position, uint32_t size, uint64_t ahead,
                               const uint8_t **out) {
    uint64_t end = scratch->input_position + scratch->input_size;
    char what[48];
    snprintf(what, sizeof what, "data of face %u", face);
    if (position > ptx->source.size || size > ptx->source.size - position)
        return slvi_ptx_read_bytes(scratch->env, ptx, what, position, size, NULL);
    if (position < scratch->input_position || position + size > end) {
        uint64_t wanted = size, left = ptx->source.size - position;
        if (ahead < scratch->read_ahead)
            ahead = scratch->read_ahead;
        if (wanted < ahead)
            wanted = left < ahead ? left : ahead;
        scratch->input_size = 0;
        slv_result result = slvi_ptx_scratch_reserve(scratch, ptx, &scratch->input, wanted);
        if (result)
            return result;
        if ((result = slvi_ptx_read_bytes(scratch->env, ptx, what, position, wanted,
                                          scratch->input.bytes)))
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

slv_result slvi_ptx_corrupt(const slv_ptx *ptx, const ptx_scratch *scratch, uint32_t face,
                            const char *why) {
    return slvi_fail(scratch->env, SLV_ERROR_FORMAT, "%s: face %u: %s", ptx->name, face, why);
}

/* Nine parameters, since faces and tiles keep in tables of their own what is said here of an array.
 */
slv_result slvi_ptx_unpack(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face,
                           const uint8_t *zipped, uint32_t size, bool differences, slv_res res,
                           void *out, size_t pitch) {
    size_t w = (size_t)1 << res.u, h = (size_t)1 << res.v, n = ptx->info.nchannels;
    uint64_t bytes = ptx_texel_count(res) * ptx->pixel_size;
    uint8_t *planes = out;
    bool in_place = n == 1 && pitch == w;
    if (!slvi_ptx_zip_is_plausible(size, bytes))
        return slvi_ptx_corrupt(ptx, scratch, face, "its texels do not fit into so few bytes");
    if (!in_place) {
        slv_result result = slvi_ptx_scratch_reserve(scratch, ptx, &scratch->planes, bytes);
        if (result)
            return result;
        planes = scratch->planes.bytes;
    }
    if (!slvi_ptx_inflate_literals(zipped, size, planes, (size_t)bytes) &&
        libdeflate_zlib_decompress(scratch->inflater, zipped, size, planes, (size_t)bytes, NULL) !=
            LIBDEFLATE_SUCCESS)
        return slvi_ptx_corrupt(ptx, scratch, face,
                                "its texels do not unpack to the size they should have");
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
