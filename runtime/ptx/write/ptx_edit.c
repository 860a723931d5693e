/* A file opened to be edited: locked against other editors, and a writer that goes on from its end.
 */
#include "ptx/write/ptx_write.h"

#include "base/file.h"
#include "base/log.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static slv_result open_locked(const slv_env *env, const char *path, int *out) {
    struct stat status;
    slv_result result = SLV_OK;
    int descriptor = open(path, O_RDWR | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0)
        return slvi_fail(env, slvi_io_error(errno), "%s: cannot be edited: %s", path,
                         strerror(errno));
    if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode))
        result = slvi_fail(env, SLV_ERROR_IO, "%s: not a regular file", path);
    else if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        result = slvi_fail(env, SLV_ERROR_IO, "%s: is being edited already", path);
    if (result) {
        close(descriptor);
        return result;
    }
    *out = descriptor;
    return SLV_OK;
}

slv_result slv_ptx_writer_edit(const slv_env *env, const char *path,
                               const slv_ptx_writer_params *params, slv_ptx_writer **out) {
    slv_ptx *ptx = NULL;
    slv_ptx_writer *writer = NULL;
    uint8_t size[4];
    int descriptor = -1;
    *out = NULL;
    slv_result result = open_locked(env, path, &descriptor);
    if (result || (result = slv_ptx_open(env, path, &ptx)) ||
        (result = slvi_ptx_read_bytes(env, ptx, "header", 28, sizeof size, size)))
        goto done;
    if (ptx_get_u32(size) < PTX_EXTENDED_HEADER_SIZE) {
        result = slvi_fail(env, SLV_ERROR_UNSUPPORTED,
                           "%s: its header has no room for edits; it can be rewritten", path);
        goto done;
    }
    if (params && params->output) {
        result =
            slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: edits go into a file, not into a stream", path);
        goto done;
    }
    slv_ptx_writer_params own = slvi_ptx_writer_params_of_header(ptx);
    if (params) {
        own.compression = params->compression;
        own.sync = params->sync;
        own.memory = params->memory;
        own.progress = params->progress;
    }
    if ((result = slvi_ptx_writer_begin(env, path, &own, &writer)))
        goto done;
    writer->edited = descriptor;
    writer->edit_position = ptx->edit_position;
    writer->edit_end = ptx->edit_end;
    descriptor = -1;
    *out = writer;
done:
    if (descriptor >= 0)
        close(descriptor);
    slv_ptx_close(ptx);
    return result;
}
