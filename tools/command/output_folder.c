/* Files that appear together: written into a folder beside their place, and moved when all are
 * there. The folder is locked while its writer lives, so that those of a killed one are known. */
#include "command/output.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define MARK ".selvage-"
#define UNIQUE "XXXXXX"
#define ATTEMPTS 8

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
    char parent[sizeof((output_folder *)NULL)->beside], path[1600];
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
static int make_beside(const char *path, int length, output_folder *out) {
    char pattern[sizeof out->beside];
    if (snprintf(pattern, sizeof pattern, "%.*s" MARK UNIQUE, length, path) >= (int)sizeof pattern)
        return cli_error("%s: the name is too long", path);
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
            return EXIT_OK;
        if (out->lock >= 0)
            close(out->lock);
    }
    return cli_error("%s: cannot be made: %s", path, strerror(errno));
}

int output_folder_begin(const char *folder, output_folder *out) {
    struct stat status;
    int length = (int)strlen(folder);
    while (length > 1 && folder[length - 1] == '/')
        length--;
    if (stat(folder, &status) == 0 &&
        (!S_ISDIR(status.st_mode) || access(folder, W_OK | X_OK) != 0))
        return cli_error("%s: %s", folder,
                         S_ISDIR(status.st_mode) ? "cannot be written" : "is not a folder");
    *out = (output_folder){.whole = true, .lock = -1};
    if (snprintf(out->into, sizeof out->into, "%s", folder) >= (int)sizeof out->into)
        return cli_error("%s: the name is too long", folder);
    return make_beside(folder, length, out);
}

int output_files_begin(const char *path, output_folder *out) {
    const char *slash = strrchr(path, '/');
    int length = slash ? (int)(slash - path) + (slash == path) : 1;
    *out = (output_folder){.lock = -1};
    if (snprintf(out->into, sizeof out->into, "%.*s", length, slash ? path : ".") >=
        (int)sizeof out->into)
        return cli_error("%s: the name is too long", path);
    return make_beside(path, (int)strlen(path), out);
}

static int move_file(const char *from, const char *to, const char *name, bool only_look) {
    char here[1600], there[1600];
    struct stat status;
    if (snprintf(here, sizeof here, "%s/%s", from, name) >= (int)sizeof here ||
        snprintf(there, sizeof there, "%s/%s", to, name) >= (int)sizeof there)
        return cli_error("%s/%s: the name is too long", to, name);
    if (only_look)
        return lstat(there, &status) == 0 && S_ISDIR(status.st_mode)
                   ? cli_error("%s: is a folder, where a file would go", there)
                   : EXIT_OK;
    if (rename(here, there) != 0)
        return cli_error("%s: cannot be written: %s", there, strerror(errno));
    return EXIT_OK;
}

/* Stops at the first failure, which most are before anything was moved. */
static int move_files(const char *from, const char *to, const char *last) {
    struct dirent **list = NULL;
    int code = EXIT_OK, count = scandir(from, &list, skip_dots, NULL);
    bool has_last = false;
    if (count < 0)
        return cli_error("%s: cannot be read: %s", from, strerror(errno));
    for (int i = 0; i < count && !code; i++)
        code = move_file(from, to, list[i]->d_name, true);
    for (int i = 0; i < count && !code; i++)
        if (last && strcmp(list[i]->d_name, last) == 0)
            has_last = true;
        else
            code = move_file(from, to, list[i]->d_name, false);
    if (has_last && !code)
        code = move_file(from, to, last, false);
    free_list(list, count);
    return code;
}

int output_folder_end(output_folder *folder, const char *last, int code) {
    if (!code && (!folder->whole || rename(folder->beside, folder->into) != 0)) {
        int reason = errno;
        /* not empty, a link to a folder, a mounted one, or "." */
        if (!folder->whole || is_folder(folder->into))
            code = move_files(folder->beside, folder->into, last);
        else
            code = cli_error("%s: cannot be written: %s", folder->into, strerror(reason));
        remove_folder(folder->beside);
    } else if (code) {
        remove_folder(folder->beside);
    }
    if (folder->lock >= 0)
        close(folder->lock);
    return code;
}
