/* Files read whole, and bytes at places in open files. */
#include "base/file.h"

#include "base/log.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    PART = 1 << 30,      /* of one call */
    PIPE_ROOM = 1 << 16, /* bytes at first */
    PATIENCE = 2000      /* milliseconds for somebody to begin to write to a pipe */
};

slv_result slvi_io_error(int reason) {
    return reason == ENOMEM ? SLV_ERROR_MEMORY : SLV_ERROR_IO;
}

bool slvi_name_ends(const char *path, const char *extension) {
    size_t length = strlen(path), wanted = strlen(extension);
    return length > wanted && strcasecmp(path + length - wanted, extension) == 0;
}

bool slvi_is_folder(const char *path) {
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

bool slvi_same_file(const char *a, const char *b) {
    struct stat one, other;
    return stat(a, &one) == 0 && stat(b, &other) == 0 && one.st_dev == other.st_dev &&
           one.st_ino == other.st_ino;
}

int slvi_read_at(int descriptor, void *data, uint64_t size, uint64_t position) {
    char *to = data;
    while (size) {
        ssize_t got = pread(descriptor, to, size < PART ? (size_t)size : PART, (off_t)position);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return got ? errno : EIO;
        to += got;
        position += (uint64_t)got;
        size -= (uint64_t)got;
    }
    return 0;
}

slv_result slvi_write_at(const slv_env *env, const char *path, int descriptor, const void *data,
                         uint64_t size, uint64_t position) {
    const char *from = data;
    while (size) {
        ssize_t done = pwrite(descriptor, from, size < PART ? (size_t)size : PART, (off_t)position);
        if (done < 0 && errno == EINTR)
            continue;
        if (done <= 0)
            return slvi_fail(env, SLV_ERROR_IO, "%s: write failed: %s", path,
                             done ? strerror(errno) : "nothing was written");
        from += done;
        position += (uint64_t)done;
        size -= (uint64_t)done;
    }
    return SLV_OK;
}

/* Whether there is something to read, or the end, within some milliseconds; -1: sooner or later. */
static bool wait_for(int descriptor, int milliseconds) {
    struct pollfd poller = {.fd = descriptor, .events = POLLIN};
    int ready;
    do
        ready = poll(&poller, 1, milliseconds);
    while (ready < 0 && errno == EINTR);
    return ready != 0;
}

/* As read(). A pipe that nobody has opened to write seems to be at its end, so that the first read
 * waits a while for somebody; who never comes is ETIMEDOUT. */
static ssize_t read_some(int descriptor, bool pipe, bool first, char *to, size_t room) {
    bool in_vain = false;
    for (;;) {
        ssize_t got = read(descriptor, to, room);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0 && errno == EAGAIN) {
            wait_for(descriptor, -1);
            first = false;
            continue;
        }
        if (got || !pipe || !first)
            return got;
        if (in_vain) {
            errno = ETIMEDOUT;
            return -1;
        }
        in_vain = !wait_for(descriptor, PATIENCE);
        first = in_vain;
    }
}

static slv_result read_all(const slv_env *env, const char *path, int descriptor,
                           const struct stat *status, char **data, size_t *size) {
    bool pipe = !S_ISREG(status->st_mode);
    uint64_t room = pipe || !status->st_size ? PIPE_ROOM : (uint64_t)status->st_size + 1, at = 0;
    slv_result result = slvi_alloc_plain(env, path, room, 1, data);
    while (!result) {
        if (at + 1 >= room) {
            /* a file of the expected size is most often at its end */
            char next;
            ssize_t got = read_some(descriptor, pipe, false, &next, 1);
            if (!got)
                break;
            if (got < 0)
                return slvi_fail(env, slvi_io_error(errno), "%s: %s", path, strerror(errno));
            if ((result = slvi_grow(env, path, room * 2, 1, data)))
                break;
            room *= 2;
            (*data)[at++] = next;
        }
        size_t part = room - 1 - at < PART ? (size_t)(room - 1 - at) : PART;
        ssize_t got = read_some(descriptor, pipe, at == 0, *data + at, part);
        if (got < 0)
            return slvi_fail(env, slvi_io_error(errno), "%s: %s", path,
                             errno == ETIMEDOUT ? "a pipe that nobody writes to" : strerror(errno));
        if (!got)
            break;
        at += (uint64_t)got;
    }
    if (!result)
        (*data)[at] = 0;
    *size = (size_t)at;
    return result;
}

slv_result slvi_file_read(const slv_env *env, const char *path, char **data, size_t *size) {
    bool standard = strcmp(path, "/dev/stdin") == 0;
    struct stat status;
    *data = NULL;
    *size = 0;
    /* standard input may be a socket, which has no name that could be opened */
    int descriptor = standard ? fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3)
                              : open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (descriptor < 0)
        return slvi_fail(env, slvi_io_error(errno), "%s: %s", path, strerror(errno));
    slv_result result;
    bool good = fstat(descriptor, &status) == 0;
    if (good && (S_ISREG(status.st_mode) || S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode) ||
                 (standard && isatty(descriptor) == 1)))
        result = read_all(env, path, descriptor, &status, data, size);
    else
        result = slvi_fail(env, SLV_ERROR_IO, "%s: not a regular file", path);
    close(descriptor);
    if (result) {
        slvi_free(*data);
        *data = NULL;
        *size = 0;
    }
    return result;
}
