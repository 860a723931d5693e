/* Files that appear together: written into a folder beside their place, and moved when all are
 * there. The folder is locked while its writer lives, so that those of a killed one are known. */
#include "base/log.h"
#include "base/memory.h"

#include <selvage/folder.h>

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define MARK ".selvage-"
#define UNIQUE "XXXXXX"
#define ATTEMPTS 8

struct slv_folder {
    slv_env env;
    char into[1100], beside[1200];
    bool whole;
    int lock;
};

static bool is_folder(const char *path) {
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

static int skip_dots(const struct dirent *entry) {
    return strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
}

static void free_list(struct dirent **list, int count) {
    for (int i = 0; i < count; i++)
        free(list[i]);
    free(list);
}

static void remove_folder(const char *folder) {
    struct dirent **list = NULL;
    char path[1600];
    int count = scandir(folder, &list, skip_dots, NULL);
    for (int i = 0; i < count; i++)
        if (snprintf(path, sizeof path, "%s/%s", folder, list[i]->d_name) < (int)sizeof path)
            remove(path);
    free_list(list, count);
    rmdir(folder);
}

/* Locked, or -1; errno is EWOULDBLOCK if it is somebody's. */
static int lock_folder(const char *folder) {
    int lock = open(folder, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (lock >= 0 && flock(lock, LOCK_EX | LOCK_NB) != 0) {
        int reason = errno;
        close(lock);
        errno = reason;
        return -1;
    }
    return lock;
}

/* Removes what killed writers of the same place left. `pattern` ends with MARK and UNIQUE. */
static void sweep(const char *pattern) {
    char parent[sizeof((slv_folder *)NULL)->beside], path[1600];
    const char *slash = strrchr(pattern, '/'), *base = slash ? slash + 1 : pattern;
    size_t length = strlen(base), known = length - strlen(UNIQUE);
    struct dirent **list = NULL;
    snprintf(parent, sizeof parent, "%.*s", slash ? (int)(slash + 1 - pattern) : 1,
             slash ? pattern : ".");
    int count = scandir(parent, &list, skip_dots, NULL);
    for (int i = 0; i < count; i++) {
        const char *name = list[i]->d_name;
        if (strlen(name) != length || strncmp(name, base, known) != 0 ||
            snprintf(path, sizeof path, "%s/%s", parent, name) >= (int)sizeof path)
            continue;
        int lock = lock_folder(path);
        if (lock < 0)
            continue;
        remove_folder(path);
        close(lock);
    }
    free_list(list, count);
}

/* A new folder beside the first `length` characters of a path. */
static slv_result make_beside(const char *path, int length, slv_folder *out) {
    char pattern[sizeof out->beside];
    if (snprintf(pattern, sizeof pattern, "%.*s" MARK UNIQUE, length, path) >= (int)sizeof pattern)
        return slvi_fail(&out->env, SLV_ERROR_IO, "%s: the name is too long", path);
    sweep(pattern);
    for (int attempt = 0; attempt < ATTEMPTS; attempt++) {
        memcpy(out->beside, pattern, sizeof pattern);
        if (!mkdtemp(out->beside) || chmod(out->beside, 0755) != 0)
            break;
        out->lock = lock_folder(out->beside);
        /* before the lock a sweep may have taken this one; where locks are not to be had, nothing
         * is ever taken for abandoned */
        bool taken = out->lock < 0 && errno == EWOULDBLOCK;
        if (!taken && is_folder(out->beside))
            return SLV_OK;
        if (out->lock >= 0)
            close(out->lock);
    }
    return slvi_fail(&out->env, SLV_ERROR_IO, "%s: cannot be made: %s", path, strerror(errno));
}

static slv_result begin_whole(const char *path, slv_folder *out) {
    struct stat status;
    int length = (int)strlen(path);
    while (length > 1 && path[length - 1] == '/')
        length--;
    if (stat(path, &status) == 0 && (!S_ISDIR(status.st_mode) || access(path, W_OK | X_OK) != 0))
        return slvi_fail(&out->env, SLV_ERROR_IO, "%s: %s", path,
                         S_ISDIR(status.st_mode) ? "cannot be written" : "is not a folder");
    if (snprintf(out->into, sizeof out->into, "%s", path) >= (int)sizeof out->into)
        return slvi_fail(&out->env, SLV_ERROR_IO, "%s: the name is too long", path);
    return make_beside(path, length, out);
}

static slv_result begin_beside(const char *path, slv_folder *out) {
    const char *slash = strrchr(path, '/');
    int length = slash ? (int)(slash - path) + (slash == path) : 1;
    if (snprintf(out->into, sizeof out->into, "%.*s", length, slash ? path : ".") >=
        (int)sizeof out->into)
        return slvi_fail(&out->env, SLV_ERROR_IO, "%s: the name is too long", path);
    return make_beside(path, (int)strlen(path), out);
}

static slv_result begin(const slv_env *given, const char *path, bool whole, slv_folder **out) {
    slv_env env = slvi_env_or_default(given);
    slv_folder *folder;
    *out = NULL;
    slv_result result = slvi_alloc(&env, path, 1, sizeof *folder, &folder);
    if (result)
        return result;
    folder->env = env;
    folder->whole = whole;
    folder->lock = -1;
    result = whole ? begin_whole(path, folder) : begin_beside(path, folder);
    if (result)
        slvi_free(folder);
    else
        *out = folder;
    return result;
}

slv_result slv_folder_begin(const slv_env *env, const char *path, slv_folder **out) {
    return begin(env, path, true, out);
}

slv_result slv_folder_begin_beside(const slv_env *env, const char *path, slv_folder **out) {
    return begin(env, path, false, out);
}

const char *slv_folder_path(const slv_folder *folder) {
    return folder->beside;
}

static slv_result move_file(const slv_folder *folder, const char *name, bool only_look) {
    char here[1600], there[1600];
    struct stat status;
    if (snprintf(here, sizeof here, "%s/%s", folder->beside, name) >= (int)sizeof here ||
        snprintf(there, sizeof there, "%s/%s", folder->into, name) >= (int)sizeof there)
        return slvi_fail(&folder->env, SLV_ERROR_IO, "%s/%s: the name is too long", folder->into,
                         name);
    if (only_look)
        return lstat(there, &status) == 0 && S_ISDIR(status.st_mode)
                   ? slvi_fail(&folder->env, SLV_ERROR_IO, "%s: is a folder, where a file would go",
                               there)
                   : SLV_OK;
    if (rename(here, there) != 0)
        return slvi_fail(&folder->env, SLV_ERROR_IO, "%s: cannot be written: %s", there,
                         strerror(errno));
    return SLV_OK;
}

/* Stops at the first failure, which most are before anything was moved. */
static slv_result move_files(const slv_folder *folder, const char *last) {
    struct dirent **list = NULL;
    int count = scandir(folder->beside, &list, skip_dots, NULL);
    slv_result result = SLV_OK;
    bool has_last = false;
    if (count < 0)
        return slvi_fail(&folder->env, SLV_ERROR_IO, "%s: cannot be read: %s", folder->beside,
                         strerror(errno));
    for (int i = 0; i < count && !result; i++)
        result = move_file(folder, list[i]->d_name, true);
    for (int i = 0; i < count && !result; i++)
        if (last && strcmp(list[i]->d_name, last) == 0)
            has_last = true;
        else
            result = move_file(folder, list[i]->d_name, false);
    if (has_last && !result)
        result = move_file(folder, last, false);
    free_list(list, count);
    return result;
}

slv_result slv_folder_end(slv_folder *folder, const char *last, slv_result result) {
    if (!folder)
        return result;
    if (!result && (!folder->whole || rename(folder->beside, folder->into) != 0)) {
        int reason = errno;
        /* not empty, a link to a folder, a mounted one, or "." */
        if (!folder->whole || is_folder(folder->into))
            result = move_files(folder, last);
        else
            result = slvi_fail(&folder->env, SLV_ERROR_IO, "%s: cannot be written: %s",
                               folder->into, strerror(reason));
        remove_folder(folder->beside);
    } else if (result) {
        remove_folder(folder->beside);
    }
    if (folder->lock >= 0)
        close(folder->lock);
    slvi_free(folder);
    return result;
}
