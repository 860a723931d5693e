/* Unpacking gzip files, member by member. */
#include "base/gzip.h"

#include "base/log.h"
#include "base/memory.h"

#include <libdeflate.h>
#include <string.h>

enum { MIN_ROOM = 1 << 16 };

/* Unpacks one member to `out + *at`, making room as it takes. Nine parameters, since most come in
 * and go out for the next member. */
static slv_result unpack_member(const slv_env *env, const char *path,
                                struct libdeflate_decompressor *inflater, const char *in,
                                size_t in_size, size_t *taken, char **out, size_t *room,
                                size_t *at) {
    for (;;) {
        size_t made = 0;
        switch (libdeflate_gzip_decompress_ex(inflater, in, in_size, *out + *at, *room - *at, taken,
                                              &made)) {
        case LIBDEFLATE_SUCCESS:
            *at += made;
            return SLV_OK;
        case LIBDEFLATE_INSUFFICIENT_SPACE: {
            slv_result result = slvi_grow(env, path, (uint64_t)*room * 2 + 1, 1, out);
            if (result)
                return result;
            *room *= 2;
            break;
        }
        default:
            return slvi_fail(env, SLV_ERROR_FORMAT, "%s: the gzip data are damaged", path);
        }
    }
}

slv_result slvi_gunzip(const slv_env *env, const char *path, char **data, size_t *size) {
    size_t from = 0, at = 0, room = *size < MIN_ROOM / 4 ? MIN_ROOM : *size * 4;
    char *out = NULL;
    if (*size < 2 || memcmp(*data, "\x1f\x8b", 2) != 0)
        return SLV_OK;
    struct libdeflate_decompressor *inflater = libdeflate_alloc_decompressor();
    slv_result result = inflater
                            ? slvi_alloc_plain(env, path, (uint64_t)room + 1, 1, &out)
                            : slvi_fail(env, SLV_ERROR_MEMORY, "%s: no memory to unpack it", path);
    while (!result && from < *size) {
        size_t taken = 0;
        result = unpack_member(env, path, inflater, *data + from, *size - from, &taken, &out, &room,
                               &at);
        from += taken;
    }
    if (inflater)
        libdeflate_free_decompressor(inflater);
    if (!result) {
        out[at] = 0;
        slvi_free(*data);
        *data = out;
        *size = at;
        out = NULL;
    }
    slvi_free(out);
    return result;
}
