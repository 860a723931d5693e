/* Inputs that come through pipes, as files that can be read at any place. */
#include "command/cli.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

enum {
    PART = 1 << 18,
    PATIENCE = 2000 /* milliseconds until somebody writes */
};

static const char *folder(void) {
    const char *given = getenv("TMPDIR");
    return given && *given ? given : "/tmp";
}

static int open_nameless(void) {
    char path[4096];
    snprintf(path, sizeof path, "%s/selvage.XXXXXX", folder());
    int file = mkstemp(path);
    if (file >= 0)
        unlink(path);
    return file;
}

static int write_part(int file, const char *data, size_t size) {
    while (size) {
        ssize_t done = write(file, data, size);
        if (done < 0 && errno != EINTR)
            return errno;
        data += done > 0 ? done : 0;
        size -= done > 0 ? (size_t)done : 0;
    }
    return 0;
}

/* Whoever pours in without end shall not fill the disk of others. */
static uint64_t room_for(int file) {
    struct statvfs disk;
    return fstatvfs(file, &disk) == 0 ? (uint64_t)disk.f_bavail * disk.f_frsize / 2 : UINT64_MAX;
}

static int copy(int from, int file, const char *name) {
    char *part = malloc(PART);
    uint64_t size = 0, room = room_for(file);
    int code = part ? EXIT_OK : cli_error("%s: no memory to read it", name);
    while (!code) {
        struct pollfd poller = {.fd = from, .events = POLLIN};
        bool ready = poll(&poller, 1, PATIENCE) != 0;
        ssize_t got = read(from, part, PART);
        if (!got && !ready && !size)
            code = cli_error("%s: a pipe that nobody writes to", name);
        else if (!got)
            break;
        else if (got < 0 && errno != EAGAIN && errno != EINTR)
            code = cli_error("%s: %s", name, strerror(errno));
        size += got > 0 ? (uint64_t)got : 0;
        if (got > 0 && (size > room || (errno = write_part(file, part, (size_t)got))))
            code = cli_error("%s: what comes through it cannot be kept in %s: %s", name, folder(),
                             size > room ? "it takes more than half of the free space"
                                         : strerror(errno));
    }
    free(part);
    return code;
}

/* The descriptor that a name is of, or -1. */
static int descriptor_of(const char *path) {
    return strcmp(cli_input(path), cli_input("-")) == 0 ? STDIN_FILENO
           : strncmp(path, CLI_DESCRIPTORS, sizeof CLI_DESCRIPTORS - 1) == 0
               ? atoi(path + sizeof CLI_DESCRIPTORS - 1)
               : -1;
}

/* The file takes the place of the descriptor, if there is one, or else gets a name of its own. */
static int name_file(int file, int descriptor, const char **path) {
    if (descriptor >= 0) {
        bool good = dup2(file, descriptor) == descriptor && lseek(descriptor, 0, SEEK_SET) == 0;
        close(file);
        return good ? EXIT_OK : cli_error("%s: %s", *path, strerror(errno));
    }
    const char *name = cli_name_pipe(file, *path);
    if (!name) {
        close(file);
        return cli_error("%s: is one pipe too many", *path);
    }
    *path = name;
    return EXIT_OK;
}

int cli_settle_input(const char **path) {
    struct stat status;
    int descriptor = descriptor_of(*path);
    if (descriptor == STDIN_FILENO)
        *path = cli_input("-");
    if ((descriptor >= 0 ? fstat(descriptor, &status) : stat(*path, &status)) != 0 ||
        (!S_ISFIFO(status.st_mode) && !(descriptor >= 0 && S_ISSOCK(status.st_mode))))
        return EXIT_OK; /* a file; or nothing, which whoever opens it will say */
    int from = descriptor >= 0 ? descriptor : open(*path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (from < 0)
        return cli_error("%s: %s", *path, strerror(errno));
    int file = open_nameless();
    int code = file < 0
                   ? cli_error("%s: cannot be kept in %s: %s", *path, folder(), strerror(errno))
                   : copy(from, file, *path);
    if (descriptor < 0)
        close(from);
    if (!code)
        return name_file(file, descriptor, path);
    if (file >= 0)
        close(file);
    return code;
}
