/* Names of unfinished files and folders, their locks, and the removal of those that nobody finishes
 * any more. */
#if !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* O_TMPFILE */
#endif

#include "base/beside.h"

#include "base/file.h"
#include "base/log.h"
#include "base/memory.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

/* NAME.0.selvage, NAME.1.selvage, ...: whoever comes next finds what was left without reading a
 * folder that may have a hundred thousand files. */
#define SUFFIX ".selvage"
/* Of longer names only the beginning is there, and a hash of all. */
#define LONGEST ((size_t)64)
#define NAME_EXTRA (LONGEST + 32 + sizeof SUFFIX)
#define ATTEMPTS 1000
#define SWEPT 4 /* free numbers in a row that end a search */
#define MAX_LINKS 40

/* Where the last part of a path begins. */
static const char *base_of(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static void make_name(const char *target, unsigned number, char *out, size_t size) {
    const char *base = base_of(target);
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    if (strlen(base) <= LONGEST) {
        snprintf(out, size, "%s.%u" SUFFIX, target, number);
        return;
    }
    for (const char *c = base; *c; c++)
        hash = (hash ^ (unsigned char)*c) * UINT64_C(0x100000001b3);
    size_t kept = LONGEST;
    while (kept && (base[kept] & 0xC0) == 0x80) /* not in the middle of a character */
        kept--;
    snprintf(out, size, "%.*s~%016llx.%u" SUFFIX, (int)((size_t)(base - target) + kept), target,
             (unsigned long long)hash, number);
}

static bool is_still(const char *name, int descriptor) {
    struct stat there, own;
    return lstat(name, &there) == 0 && fstat(descriptor, &own) == 0 && there.st_dev == own.st_dev &&
           there.st_ino == own.st_ino;
}

void slvi_beside_remove_folder(const char *folder) {
    DIR *stream = opendir(folder);
    for (struct dirent *entry; stream && (entry = readdir(stream));)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            unlinkat(dirfd(stream), entry->d_name, 0);
    if (stream)
        closedir(stream);
    rmdir(folder);
}

/* Removes it if its writer is gone. The name may be somebody else's by the time that the lock is
 * had. */
static bool remove_abandoned(const char *name) {
    const int flags = O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
    struct stat status;
    /* some file systems lock only what can be written; a folder or a file of mode 400 cannot */
    int descriptor = open(name, O_RDWR | flags);
    if (descriptor < 0 && errno != ENOENT)
        descriptor = open(name, O_RDONLY | flags);
    if (descriptor < 0)
        return false;
    bool removed = fstat(descriptor, &status) == 0 &&
                   (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode)) &&
                   flock(descriptor, LOCK_EX | LOCK_NB) == 0 && is_still(name, descriptor);
    if (removed && S_ISDIR(status.st_mode))
        slvi_beside_remove_folder(name);
    else if (removed)
        unlink(name);
    close(descriptor);
    return removed;
}

/* A new file or folder, locked; -1 and errno, EEXIST if the name or the lock is somebody's. */
static int make(const char *name, bool folder, mode_t mode) {
    int descriptor = -1;
    if (!folder)
        descriptor = open(name, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    else if (mkdir(name, mode) == 0)
        descriptor = open(name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (descriptor < 0)
        return -1;
    /* before the lock a sweep may have taken it; where locks are not to be had, nothing is ever
     * taken for abandoned */
    bool taken = flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (!taken && is_still(name, descriptor))
        return descriptor;
    close(descriptor);
    errno = EEXIST;
    return -1;
}

static void sweep_from(const char *target, unsigned number, char *name, size_t size) {
    struct stat status;
    for (unsigned gaps = 0; gaps < SWEPT && number < ATTEMPTS; number++) {
        make_name(target, number, name, size);
        if (lstat(name, &status) != 0)
            gaps++;
        else if (remove_abandoned(name))
            gaps = 0;
    }
}

void slvi_beside_sweep(const char *target) {
    char name[PATH_MAX + NAME_EXTRA];
    if (strlen(target) < PATH_MAX)
        sweep_from(target, 0, name, sizeof name);
}

slv_result slvi_beside_create(const slv_env *env, const char *path, const char *target, bool folder,
                              mode_t mode, char **name, int *descriptor) {
    size_t size = strlen(target) + NAME_EXTRA;
    *descriptor = -1;
    slv_result result = slvi_alloc(env, path, size, 1, name);
    if (result)
        return result;
    int reason = EEXIST;
    for (unsigned number = 0; *descriptor < 0 && reason == EEXIST && number < ATTEMPTS; number++) {
        make_name(target, number, *name, size);
        *descriptor = make(*name, folder, mode);
        reason = errno;
        if (*descriptor < 0 && reason == EEXIST && remove_abandoned(*name)) {
            *descriptor = make(*name, folder, mode);
            reason = errno;
        }
    }
    if (*descriptor < 0) {
        result = slvi_fail(env, slvi_io_error(reason), "%s: cannot be written: %s", path,
                           strerror(reason));
        slvi_free(*name);
        *name = NULL;
    } else {
        slvi_beside_sweep(target);
    }
    return result;
}

slv_result slvi_beside_nameless(const slv_env *env, const char *path, const char *target,
                                int *descriptor) {
    char *name;
    *descriptor = -1;
#ifdef O_TMPFILE
    size_t length = (size_t)(base_of(target) - target);
    slv_result result = slvi_alloc(env, path, length + 2, 1, &name);
    if (result)
        return result;
    memcpy(name, length ? target : ".", length ? length : 1);
    *descriptor = open(name, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    slvi_free(name);
    if (*descriptor >= 0)
        return SLV_OK;
#endif
    /* not every file system has such files */
    slv_result made = slvi_beside_create(env, path, target, false, 0600, &name, descriptor);
    if (!made) {
        unlink(name);
        slvi_free(name);
    }
    return made;
}

/* What the link `name` points to, as a path of its own. */
static slv_result follow(const slv_env *env, const char *path, const char *name, const char *link,
                         char **out) {
    size_t before = link[0] == '/' ? 0 : (size_t)(base_of(name) - name);
    slv_result result = slvi_alloc(env, path, before + strlen(link) + 1, 1, out);
    if (!result) {
        memcpy(*out, name, before);
        strcpy(*out + before, link);
    }
    return result;
}

slv_result slvi_beside_resolve(const slv_env *env, const char *path, char **target) {
    char link[PATH_MAX], *name;
    slv_result result = follow(env, path, "", path, &name);
    for (int links = 0; !result; links++) {
        ssize_t length = readlink(name, link, sizeof link - 1);
        if (length < 0)
            break;
        char *next;
        link[length] = 0;
        if (links == MAX_LINKS)
            result =
                slvi_fail(env, SLV_ERROR_IO, "%s: cannot be written: %s", path, strerror(ELOOP));
        else
            result = follow(env, path, name, link, &next);
        slvi_free(name);
        name = result ? NULL : next;
    }
    *target = result ? NULL : name;
    return result;
}
