/* Files written beside their place and moved there when they are complete; pipes and devices, which
 * have no such place. */
#include "base/output.h"

#include "base/beside.h"
#include "base/file.h"
#include "base/log.h"
#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static bool same_file(const struct stat *a, const struct stat *b) {
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

static slv_result cannot(const slv_env *env, const char *path, int reason) {
    return slvi_fail(env, slvi_io_error(reason), "%s: cannot be written: %s", path,
                     strerror(reason));
}

void slvi_output_keep(int descriptor, const struct stat *old) {
    struct stat own;
    mode_t mode = old->st_mode & 07777;
    if (fstat(descriptor, &own) == 0 && (own.st_uid != old->st_uid || own.st_gid != old->st_gid) &&
        fchown(descriptor, old->st_uid, old->st_gid) != 0) {
        mode &= ~(mode_t)(S_ISUID | S_ISGID);
        (void)!fchown(descriptor, (uid_t)-1, old->st_gid);
    }
    (void)!fchmod(descriptor, mode);
}

/* Where an output goes. What is no regular file is written as it comes, and so is whatever standard
 * output is. */
typedef enum output_kind { PLACE_FILE, PLACE_STREAM, PLACE_STANDARD } output_kind;

/* A pipe waits for who reads it, but not without end. */
static int open_stream(const char *path) {
    static const struct timespec moment = {.tv_nsec = 20000000};
    int descriptor = -1;
    for (int patience = 100; patience; patience--) {
        descriptor = open(path, O_WRONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
        if (descriptor >= 0 || errno != ENXIO)
            break;
        nanosleep(&moment, NULL);
        errno = ENXIO;
    }
    if (descriptor >= 0)
        fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) & ~O_NONBLOCK);
    return descriptor;
}

static slv_result begin_stream(output_kind place, slv_output *out) {
    out->descriptor =
        place == PLACE_STANDARD ? fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3) : open_stream(out->path);
    if (out->descriptor < 0 && errno == ENXIO)
        return slvi_fail(&out->env, SLV_ERROR_IO, "%s: a pipe that nobody reads from", out->path);
    return out->descriptor < 0 ? cannot(&out->env, out->path, errno) : SLV_OK;
}

/* In a folder such as /tmp others may make files, but not replace ours: better known before the
 * work than after it. */
static bool is_protected(const char *target, const struct stat *old) {
    const char *slash = strrchr(target, '/');
    char folder[PATH_MAX];
    struct stat status;
    size_t length = slash ? (size_t)(slash + 1 - target) : 1;
    if (geteuid() == 0 || old->st_uid == geteuid() || length >= sizeof folder)
        return false;
    memcpy(folder, slash ? target : ".", length);
    folder[length] = 0;
    return stat(folder, &status) == 0 && (status.st_mode & S_ISVTX) && status.st_uid != geteuid();
}

/* Finds the target, and what it is now. */
static slv_result find_target(bool streams, slv_output *out, struct stat *old, bool *exists,
                              output_kind *place) {
    struct stat standard, target;
    const char *path = out->path;
    *exists = stat(path, old) == 0;
    *place = PLACE_FILE;
    if (*exists && streams && fstat(STDOUT_FILENO, &standard) == 0 && same_file(old, &standard))
        *place = PLACE_STANDARD;
    else if (*exists && streams && !S_ISREG(old->st_mode) && !S_ISDIR(old->st_mode))
        *place = PLACE_STREAM;
    if (*place != PLACE_FILE)
        return SLV_OK;
    /* rename() would replace a device or a pipe by a file of that name */
    if (*exists && !S_ISREG(old->st_mode))
        return slvi_fail(&out->env, SLV_ERROR_IO, "%s: is %s, cannot be written", path,
                         S_ISDIR(old->st_mode) ? "a folder" : "not a regular file");
    slv_result result = slvi_beside_resolve(&out->env, path, &out->target);
    /* a file that was deleted while a process has it open still has a name in /proc */
    if (!result && *exists && (stat(out->target, &target) != 0 || !same_file(old, &target)))
        result = slvi_fail(&out->env, SLV_ERROR_IO, "%s: has no name that it could be replaced by",
                           path);
    if (!result && *exists && is_protected(out->target, old))
        result = cannot(&out->env, path, EPERM);
    return result;
}

slv_result slvi_output_begin(const slv_env *env, const char *path, bool streams, slv_output *out) {
    bool standard = streams && strcmp(path, "-") == 0, exists = false;
    output_kind place = PLACE_STANDARD;
    struct stat old;
    *out = (slv_output){.env = slvi_env_or_default(env), .descriptor = -1};
    const char *name = standard ? "standard output" : path;
    slv_result result = slvi_alloc(&out->env, name, strlen(name) + 1, 1, &out->path);
    if (result)
        return result;
    strcpy(out->path, name);
    if (!standard)
        result = find_target(streams, out, &old, &exists, &place);
    if (!result && place != PLACE_FILE)
        result = begin_stream(place, out);
    else if (!result && !(result = slvi_beside_create(&out->env, path, out->target, false,
                                                      exists ? old.st_mode & 0777 : 0666,
                                                      &out->beside, &out->descriptor)))
        if (exists)
            slvi_output_keep(out->descriptor, &old);
    if (result)
        slvi_output_discard(out);
    return result;
}

slv_result slvi_output_stream(slv_output *output, FILE **stream) {
    if (!output->stream && !(output->stream = fdopen(output->descriptor, "wb")))
        return cannot(&output->env, output->path, errno ? errno : ENOMEM);
    *stream = output->stream;
    return SLV_OK;
}

static int close_output(slv_output *output) {
    int failed = output->stream            ? fclose(output->stream)
                 : output->descriptor >= 0 ? close(output->descriptor)
                                           : 0;
    output->stream = NULL;
    output->descriptor = -1;
    return failed;
}

/* What a commit does, up to the renaming. Returns errno, or 0. */
static int finish(slv_output *output, bool sync) {
    errno = 0;
    if (output->stream && (fflush(output->stream) != 0 || ferror(output->stream)))
        /* of an earlier failure nothing but the stream's flag may be left */
        return errno ? errno : ENOSPC;
    if (sync && output->beside && fsync(output->descriptor) != 0)
        return errno;
    /* closing may be the first to say that the disk is full */
    return close_output(output) != 0 && errno != EINTR ? errno : 0;
}

slv_result slvi_output_commit(slv_output *output, bool sync) {
    slv_result result = SLV_OK;
    /* a second descriptor keeps the lock until the name is the target's */
    int lock = output->beside ? fcntl(output->descriptor, F_DUPFD_CLOEXEC, 3) : -1;
    int reason = output->beside && lock < 0 ? errno : finish(output, sync);
    if (!reason && output->beside && rename(output->beside, output->target) != 0)
        reason = errno;
    if (!reason) {
        slvi_free(output->beside);
        output->beside = NULL;
    } else {
        result = slvi_fail(&output->env, slvi_io_error(reason), "%s: write failed: %s",
                           output->path, strerror(reason));
    }
    slvi_output_discard(output);
    if (lock >= 0)
        close(lock);
    return result;
}

void slvi_output_discard(slv_output *output) {
    if (output->beside)
        unlink(output->beside);
    if (output->path)
        close_output(output);
    slvi_free(output->beside);
    slvi_free(output->target);
    slvi_free(output->path);
    memset(output, 0, sizeof *output);
}

/* From another file system. */
static slv_result copy(const slv_env *env, const char *from, const char *path) {
    char block[1 << 16];
    uint64_t position = 0;
    slv_output output;
    int descriptor = open(from, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0)
        return cannot(env, path, errno);
    slv_result result = slvi_output_begin(env, path, false, &output);
    while (!result) {
        ssize_t got = read(descriptor, block, sizeof block);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            result = cannot(env, path, errno);
        if (got <= 0)
            break;
        result = slvi_write_at(env, path, output.descriptor, block, (size_t)got, position);
        position += (uint64_t)got;
    }
    close(descriptor);
    if (!result)
        return slvi_output_commit(&output, false);
    slvi_output_discard(&output);
    return result;
}

slv_result slvi_output_move(const slv_env *env, const char *from, const char *path) {
    struct stat old;
    slv_output output = {.env = slvi_env_or_default(env), .descriptor = -1};
    output_kind place;
    bool exists;
    slv_result result = slvi_alloc(env, path, strlen(path) + 1, 1, &output.path);
    if (result)
        return result;
    strcpy(output.path, path);
    result = find_target(false, &output, &old, &exists, &place);
    int descriptor = !result && exists ? open(from, O_RDONLY | O_NOFOLLOW | O_CLOEXEC) : -1;
    if (descriptor >= 0) {
        slvi_output_keep(descriptor, &old);
        close(descriptor);
    }
    if (!result && rename(from, output.target) != 0)
        result = errno == EXDEV ? copy(env, from, path) : cannot(env, path, errno);
    slvi_output_discard(&output);
    return result;
}

slv_result slvi_output_write(const slv_env *env, const char *path, const void *data, size_t size) {
    slv_output output;
    slv_result result = slvi_output_begin(env, path, false, &output);
    if (result)
        return result;
    if (!(result = slvi_write_at(env, path, output.descriptor, data, size, 0)))
        return slvi_output_commit(&output, false);
    slvi_output_discard(&output);
    return result;
}
