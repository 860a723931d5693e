/* Files read whole, and files written beside their place and moved there when they are complete. */
#include "base/file.h"

#include "base/log.h"
#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

slv_result slvi_io_error(int reason) {
    return reason == ENOMEM ? SLV_ERROR_MEMORY : SLV_ERROR_IO;
}

slv_result slvi_file_read(const slv_env *env, const char *path, char **data, size_t *size) {
    slv_result result = SLV_OK;
    char *bytes = NULL;
    struct stat status;
    *data = NULL;
    *size = 0;
    int descriptor =
        open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC); /* a pipe must not make us wait */
    FILE *stream = descriptor < 0 ? NULL : fdopen(descriptor, "rb");
    if (!stream) {
        result = slvi_fail(env, slvi_io_error(errno), "%s: %s", path, strerror(errno));
        if (descriptor >= 0)
            close(descriptor);
        return result;
    }
    if (fstat(fileno(stream), &status) != 0 || !S_ISREG(status.st_mode)) {
        result = slvi_fail(env, SLV_ERROR_IO, "%s: not a regular file", path);
        goto done;
    }
    if ((result = slvi_alloc(env, path, (uint64_t)status.st_size + 1, 1, &bytes)))
        goto done;
    if (fread(bytes, 1, (size_t)status.st_size, stream) != (size_t)status.st_size) {
        result = slvi_fail(env, SLV_ERROR_IO, "%s: could not be read to its end", path);
        goto done;
    }
    *data = bytes;
    *size = (size_t)status.st_size;
    bytes = NULL;
done:
    slvi_free(bytes);
    fclose(stream);
    return result;
}

slv_result slvi_file_writer_open(const slv_env *env, const char *path, slv_file_writer *out) {
    slv_result result = SLV_OK;
    size_t length = strlen(path);
    int descriptor = -1;
    struct stat status;
    memset(out, 0, sizeof *out);
    /* rename() would replace a device or pipe by a file of that name */
    if (stat(path, &status) == 0 && !S_ISREG(status.st_mode))
        return slvi_fail(env, SLV_ERROR_IO, "%s: not a regular file, cannot be written", path);
    if ((result = slvi_alloc(env, path, length + 1, 1, &out->path)) ||
        (result = slvi_alloc(env, path, length + 32, 1, &out->temporary)))
        goto fail;
    memcpy(out->path, path, length + 1);
    for (unsigned attempt = 0; descriptor < 0 && attempt < 1000; attempt++) {
        snprintf(out->temporary, length + 32, "%s.%ld-%u.tmp", path, (long)getpid(), attempt);
        descriptor = open(out->temporary, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor < 0 && errno != EEXIST)
            break;
    }
    if (descriptor < 0) {
        result = slvi_fail(env, slvi_io_error(errno), "%s: cannot be written: %s", path,
                           strerror(errno));
        goto fail;
    }
    if (!(out->stream = fdopen(descriptor, "wb"))) {
        result = slvi_fail(env, slvi_io_error(errno), "%s: cannot be written: %s", path,
                           strerror(errno));
        close(descriptor);
        unlink(out->temporary);
        goto fail;
    }
    return SLV_OK;
fail:
    slvi_free(out->path);
    slvi_free(out->temporary);
    memset(out, 0, sizeof *out);
    return result;
}

slv_result slvi_file_writer_write(const slv_env *env, slv_file_writer *writer, const void *data,
                                  size_t size) {
    if (size && fwrite(data, 1, size, writer->stream) != size)
        return slvi_fail(env, slvi_io_error(errno), "%s: write failed: %s", writer->path,
                         strerror(errno));
    return SLV_OK;
}

slv_result slvi_file_writer_commit(const slv_env *env, slv_file_writer *writer) {
    slv_result result = SLV_OK;
    bool flushed = fflush(writer->stream) == 0;
    flushed = fclose(writer->stream) == 0 && flushed;
    writer->stream = NULL;
    if (!flushed || rename(writer->temporary, writer->path) != 0) {
        result = slvi_fail(env, slvi_io_error(errno), "%s: write failed: %s", writer->path,
                           strerror(errno));
        unlink(writer->temporary);
    }
    slvi_file_writer_abandon(writer);
    return result;
}

void slvi_file_writer_abandon(slv_file_writer *writer) {
    if (writer->stream) {
        fclose(writer->stream);
        unlink(writer->temporary);
    }
    slvi_free(writer->path);
    slvi_free(writer->temporary);
    memset(writer, 0, sizeof *writer);
}

slv_result slvi_file_write(const slv_env *env, const char *path, const void *data, size_t size) {
    slv_file_writer writer;
    slv_result result = slvi_file_writer_open(env, path, &writer);
    if (result)
        return result;
    result = slvi_file_writer_write(env, &writer, data, size);
    if (!result)
        return slvi_file_writer_commit(env, &writer);
    slvi_file_writer_abandon(&writer);
    return result;
}
