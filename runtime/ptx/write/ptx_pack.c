/* Texels to the blocks of a .ptx file. */
#include "base/log.h"
#include "base/memory.h"
#include "ptx/write/ptx_write.h"
#include "texture/reduce.h"

/* A block as large as this, and no smaller, is cut into tiles. */
#define TILE_BYTES 65536

slv_result slvi_ptx_bytes_reserve(const slv_env *env, const char *path, ptx_bytes *bytes,
                                  uint64_t extra) {
    uint8_t *grown = NULL;
    if (extra <= bytes->capacity - bytes->size)
        return SLV_OK;
    if (extra > UINT64_MAX / 2 - bytes->size)
        return slvi_fail(env, SLV_ERROR_LIMIT, "%s: too large", path);
    uint64_t capacity = bytes->size + extra;
    if (capacity < bytes->size + bytes->size / 2)
        capacity = bytes->size + bytes->size / 2;
    slv_result result = slvi_alloc(env, path, capacity, 1, &grown);
    if (result)
        return result;
    if (bytes->size)
        memcpy(grown, bytes->data, (size_t)bytes->size);
    slvi_free(bytes->data);
    bytes->data = grown;
    bytes->capacity = capacity;
    return SLV_OK;
}

slv_result slvi_ptx_bytes_append(const slv_env *env, const char *path, ptx_bytes *bytes,
                                 const void *data, uint64_t size) {
    slv_result result = slvi_ptx_bytes_reserve(env, path, bytes, size);
    if (!result && size) {
        memcpy(bytes->data + bytes->size, data, (size_t)size);
        bytes->size += size;
    }
    return result;
}

slv_result slvi_ptx_bytes_append_zip(const slv_env *env, const char *path,
                                     struct libdeflate_compressor *deflater, ptx_bytes *bytes,
                                     const void *data, uint64_t size, uint64_t limit,
                                     uint32_t *zipped) {
    size_t bound = libdeflate_zlib_compress_bound(deflater, (size_t)size);
    slv_result result = slvi_ptx_bytes_reserve(env, path, bytes, bound);
    if (result)
        return result;
    size_t length =
        libdeflate_zlib_compress(deflater, data, (size_t)size, bytes->data + bytes->size, bound);
    if (length == 0 || length > limit)
        return slvi_fail(env, SLV_ERROR_LIMIT,
                         "%s: %llu bytes do not pack into the %llu that the format has for them",
                         path, (unsigned long long)size, (unsigned long long)limit);
    bytes->size += length;
    *zipped = (uint32_t)length;
    return SLV_OK;
}

/* Interleaved rows `pitch` elements apart to planes. */
#define DEFINE_PLANES(NAME, T)                                                                     \
    static void NAME(const T *in, size_t pitch, size_t n, size_t w, size_t h, T *out) {            \
        for (size_t c = 0; c < n; c++)                                                             \
            for (size_t y = 0; y < h; y++) {                                                       \
                const T *from = in + y * pitch + c;                                                \
                for (size_t x = 0; x < w; x++, from += n)                                          \
                    *out++ = *from;                                                                \
            }                                                                                      \
    }

/* The same, as differences to the element before. `N` is the number of channels where it is known
 * when this is compiled: one pass over the rows then does for all of them. */
#define DEFINE_DIFFERENCES(NAME, T, N)                                                             \
    static void NAME(const T *in, size_t pitch, size_t w, size_t h, T *out) {                      \
        T last[N] = {0};                                                                           \
        for (size_t y = 0; y < h; y++, in += pitch)                                                \
            for (size_t x = 0; x < w; x++)                                                         \
                for (size_t c = 0; c < N; c++) {                                                   \
                    out[c * w * h + y * w + x] = (T)(in[x * N + c] - last[c]);                     \
                    last[c] = in[x * N + c];                                                       \
                }                                                                                  \
        for (size_t c = 1; c < N; c++)                                                             \
            out[c * w * h] = (T)(out[c * w * h] - last[c - 1]);                                    \
    }

#define DEFINE_INTEGERS(TYPE, T)                                                                   \
    DEFINE_PLANES(planes_##TYPE, T)                                                                \
    DEFINE_DIFFERENCES(differences_##TYPE##_1, T, 1)                                               \
    DEFINE_DIFFERENCES(differences_##TYPE##_2, T, 2)                                               \
    DEFINE_DIFFERENCES(differences_##TYPE##_3, T, 3)                                               \
    DEFINE_DIFFERENCES(differences_##TYPE##_4, T, 4)                                               \
    static void differences_##TYPE(const T *in, size_t pitch, size_t n, size_t w, size_t h,        \
                                   T *out) {                                                       \
        if (n == 1)                                                                                \
            differences_##TYPE##_1(in, pitch, w, h, out);                                          \
        else if (n == 2)                                                                           \
            differences_##TYPE##_2(in, pitch, w, h, out);                                          \
        else if (n == 3)                                                                           \
            differences_##TYPE##_3(in, pitch, w, h, out);                                          \
        else if (n == 4)                                                                           \
            differences_##TYPE##_4(in, pitch, w, h, out);                                          \
        else {                                                                                     \
            planes_##TYPE(in, pitch, n, w, h, out);                                                \
            for (size_t i = n * w * h; i-- > 1;)                                                   \
                out[i] = (T)(out[i] - out[i - 1]);                                                 \
        }                                                                                          \
    }

DEFINE_INTEGERS(u8, uint8_t)
DEFINE_INTEGERS(u16, uint16_t)
DEFINE_PLANES(planes_u32, uint32_t)

/* Appends one zipped array of `res` texels out of rows `pitch` texels apart. */
static slv_result pack_array(ptx_packer *packer, ptx_bytes *out, const uint8_t *texels,
                             size_t pitch, slv_res res, uint32_t *header) {
    size_t w = (size_t)1 << res.u, h = (size_t)1 << res.v, n = packer->nchannels;
    uint64_t size = ptx_texel_count(res) * packer->pixel_size;
    uint32_t length = 0, encoding = PTX_ZIPPED;
    const void *in = texels;
    packer->planes.size = 0;
    slv_result result = slvi_ptx_bytes_reserve(packer->env, packer->path, &packer->planes, size);
    if (result)
        return result;
    void *planes = packer->planes.data;
    switch (packer->type) {
    case SLV_TYPE_U8:
        differences_u8(in, pitch * n, n, w, h, planes);
        encoding = PTX_DIFFZIPPED;
        break;
    case SLV_TYPE_U16:
        differences_u16(in, pitch * n, n, w, h, planes);
        encoding = PTX_DIFFZIPPED;
        break;
    case SLV_TYPE_HALF:
        planes_u16(in, pitch * n, n, w, h, planes);
        break;
    case SLV_TYPE_FLOAT:
        planes_u32(in, pitch * n, n, w, h, planes);
        break;
    }
    if (packer->own && encoding == PTX_DIFFZIPPED) {
        size_t element = slv_type_size(packer->type);
        if ((result = slvi_ptx_bytes_reserve(packer->env, packer->path, out,
                                             slvi_ptx_deflate_bound(size))))
            return result;
        length = (uint32_t)slvi_ptx_deflate(packer->own, planes, size, w * element, element,
                                            out->data + out->size);
        out->size += length;
    }
    if (!length)
        result = slvi_ptx_bytes_append_zip(packer->env, packer->path, packer->deflater, out, planes,
                                           size, PTX_MAX_BLOCK, &length);
    *header = length | encoding << 30;
    return result;
}

static bool tile_is_constant(const uint8_t *texels, size_t pixel_size, size_t pitch, slv_res res) {
    size_t row = pixel_size << res.u;
    if (!slvi_texels_equal(texels, pixel_size, UINT64_C(1) << res.u))
        return false;
    for (size_t y = 1; y < (size_t)1 << res.v; y++)
        if (memcmp(texels, texels + y * pitch * pixel_size, row) != 0)
            return false;
    return true;
}

static slv_result pack_tiles(ptx_packer *packer, uint32_t face, const uint8_t *texels, slv_res res,
                             slv_res tile, uint32_t *header) {
    size_t pitch = (size_t)1 << res.u;
    uint32_t columns = 1u << (res.u - tile.u), rows = 1u << (res.v - tile.v), table_size = 0;
    uint64_t ntiles = (uint64_t)columns * rows, start = packer->out.size;
    uint8_t *headers = NULL;
    slv_result result = slvi_alloc(packer->env, packer->path, ntiles, 4, &headers);
    packer->tiles.size = 0;
    for (uint64_t i = 0; !result && i < ntiles; i++) {
        size_t y = (size_t)(i / columns) << tile.v, x = (size_t)(i % columns) << tile.u;
        const uint8_t *from = texels + (y * pitch + x) * packer->pixel_size;
        uint32_t tile_header = (uint32_t)packer->pixel_size | (uint32_t)PTX_CONSTANT << 30;
        if (tile_is_constant(from, packer->pixel_size, pitch, tile))
            result = slvi_ptx_bytes_append(packer->env, packer->path, &packer->tiles, from,
                                           packer->pixel_size);
        else
            result = pack_array(packer, &packer->tiles, from, pitch, tile, &tile_header);
        ptx_put_u32(headers + 4 * i, tile_header);
    }
    uint8_t prefix[6] = {(uint8_t)tile.u, (uint8_t)tile.v};
    if (result ||
        (result = slvi_ptx_bytes_append(packer->env, packer->path, &packer->out, prefix,
                                        sizeof prefix)) ||
        (result =
             slvi_ptx_bytes_append_zip(packer->env, packer->path, packer->deflater, &packer->out,
                                       headers, 4 * ntiles, PTX_MAX_BLOCK, &table_size)) ||
        (result = slvi_ptx_bytes_append(packer->env, packer->path, &packer->out, packer->tiles.data,
                                        packer->tiles.size)))
        goto done;
    ptx_put_u32(packer->out.data + start + 2, table_size);
    if (packer->out.size - start > PTX_MAX_BLOCK) {
        result = slvi_fail(packer->env, SLV_ERROR_LIMIT,
                           "%s: face %u: %llu bytes packed, a block holds %u", packer->path, face,
                           (unsigned long long)(packer->out.size - start), PTX_MAX_BLOCK);
        goto done;
    }
    *header = (uint32_t)(packer->out.size - start) | (uint32_t)PTX_TILED << 30;
done:
    slvi_free(headers);
    return result;
}

slv_result slvi_ptx_pack(ptx_packer *packer, uint32_t face, const void *texels, slv_res res,
                         uint32_t *header) {
    uint64_t blocks = ptx_texel_count(res) * packer->pixel_size / TILE_BYTES;
    int log2_tiles = 0;
    while (blocks >> (log2_tiles + 1))
        log2_tiles++;
    if (log2_tiles == 0)
        return pack_array(packer, &packer->out, texels, (size_t)1 << res.u, res, header);
    int sum = res.u + res.v - log2_tiles;
    if (sum < 0) /* texels of so many channels that one fills a tile */
        sum = 0;
    int u = (sum + 1) / 2 < res.u ? (sum + 1) / 2 : res.u;
    int v = sum - u < res.v ? sum - u : res.v;
    return pack_tiles(packer, face, texels, res, (slv_res){(int8_t)u, (int8_t)v}, header);
}

void slvi_ptx_packer_free(ptx_packer *packer) {
    if (!packer)
        return;
    libdeflate_free_compressor(packer->deflater);
    slvi_free(packer->own);
    slvi_free(packer->out.data);
    slvi_free(packer->tiles.data);
    slvi_free(packer->planes.data);
    slvi_free(packer->work[0].data);
    slvi_free(packer->work[1].data);
    slvi_free(packer);
}
