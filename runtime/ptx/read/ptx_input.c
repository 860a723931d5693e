/* Bytes of a .ptx out of a file or a source, as they are or unzipped. */
#include "ptx/format/ptx_file.h"

#include "base/file.h"
#include "base/log.h"
#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

/* A memory map would be quicker by one copy, but kills the process when another one truncates the
 * file. */
struct file_source {
    int descriptor;
};

static int file_read(void *user, uint64_t offset, void *buffer, size_t size) {
    const struct file_source *file = user;
    return slvi_read_at(file->descriptor, buffer, size, offset) ? -1 : 0;
}

static void file_close(void *user) {
    struct file_source *file = user;
    close(file->descriptor);
    slvi_free(file);
}

slv_result slvi_ptx_source_open(const slv_env *env, const char *path, slv_stream_in *out) {
    struct file_source *file = NULL;
    struct stat status;
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0)
        return slvi_fail(env, slvi_io_error(errno), "%s: %s", path, strerror(errno));
    slv_result result = slvi_alloc(env, path, 1, sizeof *file, &file);
    if (!result && (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)))
        result = slvi_fail(env, SLV_ERROR_IO, "%s: not a regular file", path);
    if (result) {
        close(descriptor);
        slvi_free(file);
        return result;
    }
    file->descriptor = descriptor;
    *out = (slv_stream_in){file_read, file_close, file, (uint64_t)status.st_size};
    return SLV_OK;
}

slv_result slvi_ptx_read_bytes(const slv_env *env, const slv_ptx *ptx, const char *what,
                               uint64_t position, uint64_t size, void *out) {
    if (position > ptx->source.size || size > ptx->source.size - position)
        return slvi_fail(env, SLV_ERROR_FORMAT,
                         "%s: truncated: the %s is %llu bytes at offset %llu, but the file ends at "
                         "%llu",
                         ptx->name, what, (unsigned long long)size, (unsigned long long)position,
                         (unsigned long long)ptx->source.size);
    if (size && ptx->source.read(ptx->source.user, position, out, (size_t)size) != 0)
        return slvi_fail(env, SLV_ERROR_IO, "%s: the %s at offset %llu could not be read",
                         ptx->name, what, (unsigned long long)position);
    return SLV_OK;
}

bool slvi_ptx_zip_is_plausible(uint64_t zipped, uint64_t size) {
    return size / 1032 <= zipped;
}

slv_result slvi_ptx_read_zip(const slv_ptx *ptx, struct libdeflate_decompressor *inflater,
                             const char *what, uint64_t position, uint64_t zipped, uint64_t size,
                             void *out) {
    uint8_t *packed = NULL, *bytes = NULL;
    slv_result result = SLV_OK;
    memset(out, 0, sizeof(void *));
    if (!slvi_ptx_zip_is_plausible(zipped, size))
        return slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                         "%s: the %s at offset %llu claims %llu bytes packed into %llu", ptx->name,
                         what, (unsigned long long)position, (unsigned long long)size,
                         (unsigned long long)zipped);
    /* before the allocation, so that it is bounded by the file */
    if (position > ptx->source.size || zipped > ptx->source.size - position)
        return slvi_ptx_read_bytes(&ptx->env, ptx, what, position, zipped, NULL);
    if ((result = slvi_alloc(&ptx->env, ptx->name, zipped, 1, &packed)) ||
        (result = slvi_alloc(&ptx->env, ptx->name, size + 1, 1, &bytes)) ||
        (result = slvi_ptx_read_bytes(&ptx->env, ptx, what, position, zipped, packed)))
        goto done;
    /* libdeflate cannot be given no room, and an empty stream says nothing */
    if (size && libdeflate_zlib_decompress(inflater, packed, (size_t)zipped, bytes, (size_t)size,
                                           NULL) != LIBDEFLATE_SUCCESS) {
        result = slvi_fail(&ptx->env, SLV_ERROR_FORMAT,
                           "%s: the %s at offset %llu does not unpack to %llu bytes", ptx->name,
                           what, (unsigned long long)position, (unsigned long long)size);
        goto done;
    }
    memcpy(out, &bytes, sizeof bytes);
    bytes = NULL;
done:
    slvi_free(packed);
    slvi_free(bytes);
    return result;
}
