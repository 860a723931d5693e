/* Files that appear together: written into a folder beside their place, and moved when all are
 * there. */
#include "base/beside.h"
#include "base/file.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/output.h"

#include <selvage/folder.h>

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct slv_folder {
    slv_env env;
    char into[1100];
    char *beside;
    bool whole;
    int lock;
};

static int skip_dots(const struct dirent *entry) {
    return strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
}

static void free_list(struct dirent **list, int count) {
    for (int i = 0; i < count; i++)
        free(list[i]);
    free(list);
}

static slv_result too_long(const slv_folder *folder, const char *path) {
    return slvi_fail(&folder->env, SLV_ERROR_IO, "%s: the name is too long", path);
}

/* A new folder beside the target. */
static slv_result make_beside(const char *path, const char *target, slv_folder *out) {
    return slvi_beside_create(&out->env, path, target, true, 0777, &out->beside, &out->lock);
}

/* A folder that is there need not be in one that can be written: then inside of it. */
static slv_result make_inside(const char *path, const char *target, slv_folder *out) {
    char inside[sizeof out->into + 16];
    snprintf(inside, sizeof inside, "%s/unfinished", target);
    return make_beside(path, inside, out);
}

static bool parent_is_closed(const char *path) {
    char parent[sizeof((slv_folder *)NULL)->into];
    const char *slash = strrchr(path, '/');
    snprintf(parent, sizeof parent, "%.*s", slash ? (int)(slash + 1 - path) : 1,
             slash ? path : ".");
    return access(parent, W_OK | X_OK) != 0;
}

static slv_result begin_whole(const char *path, slv_folder *out) {
    struct stat status;
    int length = (int)strlen(path);
    char *target;
    while (length > 1 && path[length - 1] == '/')
        length--;
    if (stat(path, &status) == 0 && (!S_ISDIR(status.st_mode) || access(path, W_OK | X_OK) != 0))
        return slvi_fail(&out->env, SLV_ERROR_IO, "%s: %s", path,
                         S_ISDIR(status.st_mode) ? "cannot be written" : "is not a folder");
    if (snprintf(out->into, sizeof out->into, "%.*s", length, path) >= (int)sizeof out->into)
        return too_long(out, path);
    slv_result result = slvi_beside_resolve(&out->env, out->into, &target);
    if (!result && snprintf(out->into, sizeof out->into, "%s", target) >= (int)sizeof out->into)
        result = too_long(out, path);
    if (!result)
        result = slvi_is_folder(target) && parent_is_closed(target)
                     ? make_inside(path, target, out)
                     : make_beside(path, target, out);
    slvi_free(target);
    return result;
}

static slv_result begin_beside(const char *path, slv_folder *out) {
    const char *slash = strrchr(path, '/');
    int length = slash ? (int)(slash - path) + (slash == path) : 1;
    if (snprintf(out->into, sizeof out->into, "%.*s", length, slash ? path : ".") >=
        (int)sizeof out->into)
        return too_long(out, path);
    return make_beside(path, path, out);
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
        return stat(there, &status) == 0 && !S_ISREG(status.st_mode)
                   ? slvi_fail(&folder->env, SLV_ERROR_IO, "%s: is %s, where a file would go",
                               there, S_ISDIR(status.st_mode) ? "a folder" : "not a regular file")
                   : SLV_OK;
    return slvi_output_move(&folder->env, here, there);
}

/* Stops at the first failure, which most are before anything was moved. */
static slv_result move_files(const slv_folder *folder, const char *last) {
    struct dirent **list = NULL;
    int count = scandir(folder->beside, &list, skip_dots, NULL);
    slv_result result = SLV_OK;
    bool has_last = false;
    if (count < 0)
        return slvi_fail(&folder->env, slvi_io_error(errno), "%s: cannot be read: %s",
                         folder->beside, strerror(errno));
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
    struct stat old;
    if (!folder)
        return result;
    if (folder->whole && stat(folder->into, &old) == 0)
        slvi_output_keep(folder->lock, &old);
    if (!result && (!folder->whole || rename(folder->beside, folder->into) != 0)) {
        int reason = errno;
        /* not empty, a link to a folder, a mounted one, or "." */
        if (!folder->whole || slvi_is_folder(folder->into))
            result = move_files(folder, last);
        else
            result = slvi_fail(&folder->env, SLV_ERROR_IO, "%s: cannot be written: %s",
                               folder->into, strerror(reason));
        slvi_beside_remove_folder(folder->beside);
    } else if (result) {
        slvi_beside_remove_folder(folder->beside);
    }
    if (folder->lock >= 0)
        close(folder->lock);
    slvi_free(folder->beside);
    slvi_free(folder);
    return result;
}
