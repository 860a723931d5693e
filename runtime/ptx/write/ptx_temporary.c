/* Files beside a target, locked while their writer lives, so that those of a killed one are known.
 */
#if !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* O_TMPFILE */
#endif

#include "ptx/write/ptx_write.h"

#include "base/file.h"
#include "base/log.h"
#include "base/memory.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* PATH.xxxxxxxxxxxx.selvage, with that many hexadecimal digits */
#define DIGITS 12
#define SUFFIX ".selvage"
#define NAME_EXTRA (1 + DIGITS + sizeof SUFFIX)
#define ATTEMPTS 64

slv_result slvi_ptx_write_at(const slv_env *env, const char *path, int descriptor, const void *data,
                             uint64_t size, uint64_t position) {
    const uint8_t *from = data;
    while (size) {
        size_t part = size < (UINT64_C(1) << 30) ? (size_t)size : (size_t)1 << 30;
        ssize_t done = pwrite(descriptor, from, part, (off_t)position);
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

static void make_name(const char *path, unsigned attempt, char *out, size_t size) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    uint64_t seed = (uint64_t)now.tv_nsec ^ (uint64_t)now.tv_sec << 30 ^ (uint64_t)getpid() << 44;
    /* writers of one process differ in where they keep the name */
    seed = (seed + attempt + (uintptr_t)out) * UINT64_C(0x9e3779b97f4a7c15);
    snprintf(out, size, "%s.%0*llx%s", path, DIGITS,
             (unsigned long long)(seed >> (64 - 4 * DIGITS)), SUFFIX);
}

slv_result slvi_ptx_temporary_create(const slv_env *env, const char *path, ptx_temporary *out) {
    struct stat status;
    bool exists = stat(path, &status) == 0;
    *out = (ptx_temporary){-1, NULL};
    /* rename() would replace a device or a pipe by a file of that name */
    if (exists && !S_ISREG(status.st_mode))
        return slvi_fail(env, SLV_ERROR_IO, "%s: not a regular file, cannot be written", path);
    slv_result result = slvi_alloc(env, path, strlen(path) + NAME_EXTRA, 1, &out->name);
    if (result)
        return result;
    for (unsigned attempt = 0; attempt < ATTEMPTS; attempt++) {
        struct stat own;
        make_name(path, attempt, out->name, strlen(path) + NAME_EXTRA);
        int descriptor = open(out->name, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor < 0 && errno == EEXIST)
            continue;
        if (descriptor < 0)
            break;
        /* where locks are not to be had, nothing is ever taken for abandoned; before the lock, a
         * sweep may have taken this one */
        flock(descriptor, LOCK_EX | LOCK_NB);
        if (fstat(descriptor, &own) == 0 && own.st_nlink > 0) {
            if (exists)
                (void)!fchmod(descriptor, status.st_mode & 07777);
            out->descriptor = descriptor;
            return SLV_OK;
        }
        close(descriptor);
    }
    result =
        slvi_fail(env, slvi_io_error(errno), "%s: cannot be written: %s", path, strerror(errno));
    slvi_free(out->name);
    out->name = NULL;
    return result;
}

slv_result slvi_ptx_temporary_commit(const slv_env *env, const char *path, ptx_temporary *temporary,
                                     bool sync) {
    if ((sync && fsync(temporary->descriptor) != 0) || rename(temporary->name, path) != 0) {
        slv_result result =
            slvi_fail(env, slvi_io_error(errno), "%s: write failed: %s", path, strerror(errno));
        slvi_ptx_temporary_discard(temporary);
        return result;
    }
    close(temporary->descriptor);
    slvi_free(temporary->name);
    *temporary = (ptx_temporary){-1, NULL};
    return SLV_OK;
}

void slvi_ptx_temporary_discard(ptx_temporary *temporary) {
    if (!temporary->name)
        return;
    unlink(temporary->name);
    close(temporary->descriptor);
    slvi_free(temporary->name);
    *temporary = (ptx_temporary){-1, NULL};
}

/* The folder of a path, for slvi_free, and where in the path its last part begins. */
static slv_result folder_of(const slv_env *env, const char *path, const char **base, char **out) {
    const char *slash = strrchr(path, '/');
    *base = slash ? slash + 1 : path;
    size_t length = slash ? (size_t)(slash - path) + (slash == path) : 1;
    slv_result result = slvi_alloc(env, path, length + 1, 1, out);
    if (!result)
        memcpy(*out, slash ? path : ".", length);
    return result;
}

static bool is_ours(const char *name, const char *base) {
    size_t length = strlen(base);
    if (strlen(name) != length + NAME_EXTRA - 1 || memcmp(name, base, length) != 0 ||
        name[length] != '.' || strcmp(name + length + 1 + DIGITS, SUFFIX) != 0)
        return false;
    return strspn(name + length + 1, "0123456789abcdef") >= DIGITS;
}

void slvi_ptx_temporary_sweep(const char *path) {
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
    char name[PATH_MAX] = ".";
    /* the file is written; that no memory is left for this is nothing to fail by */
    if (slash && (size_t)(slash - path) + 2 > sizeof name)
        return;
    if (slash) {
        memcpy(name, path, (size_t)(slash - path) + 1);
        name[slash - path + 1] = 0;
    }
    DIR *folder = opendir(name);
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        if (!is_ours(entry->d_name, base))
            continue;
        int descriptor =
            openat(dirfd(folder), entry->d_name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
        if (descriptor < 0)
            continue;
        if (flock(descriptor, LOCK_EX | LOCK_NB) == 0)
            unlinkat(dirfd(folder), entry->d_name, 0);
        close(descriptor);
    }
    if (folder)
        closedir(folder);
}

slv_result slvi_ptx_open_nameless(const slv_env *env, const char *path, int *out) {
    const char *base;
    char *folder;
    ptx_temporary named;
    int descriptor = -1;
    slv_result result = folder_of(env, path, &base, &folder);
    if (result)
        return result;
#ifdef O_TMPFILE
    descriptor = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
#endif
    slvi_free(folder);
    /* not every file system has such files */
    if (descriptor < 0) {
        if ((result = slvi_ptx_temporary_create(env, path, &named)))
            return result;
        unlink(named.name);
        slvi_free(named.name);
        descriptor = named.descriptor;
    }
    *out = descriptor;
    return SLV_OK;
}
