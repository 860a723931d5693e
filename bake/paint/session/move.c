/* A session is put to another place, with all that it can go back to. */
#include "session/session_data.h"

#include "base/beside.h"
#include "base/file.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/names.h"
#include "base/output.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { CHUNK = 1 << 20 };

/* As much as the file has now; `buffer` has room for a chunk. */
static slv_result copy_bytes(const slv_env *env, const char *from, int file, slv_output *to,
                             char *buffer) {
    struct stat status;
    slv_result result = SLV_OK;
    int reason = fstat(file, &status) == 0 ? 0 : errno;
    uint64_t size = reason ? 0 : (uint64_t)status.st_size;
    for (uint64_t at = 0; !result && !reason && at < size; at += CHUNK) {
        uint64_t part = size - at < CHUNK ? size - at : CHUNK;
        if (!(reason = slvi_read_at(file, buffer, part, at)))
            result = slvi_write_at(env, to->path, to->descriptor, buffer, part, at);
    }
    if (reason)
        result = slvi_fail(env, slvi_io_error(reason), "%s: %s", from, strerror(reason));
    return result;
}

static slv_result copy_file(const slv_session *session, const char *name, const char *folder,
                            char *buffer) {
    const slv_env *env = &session->env;
    char *from = NULL, *path = NULL;
    slv_output to = {0};
    int file = -1;
    slv_result result;
    if (!(result = slvi_session_path(env, session->path, name, &from)) &&
        !(result = slvi_session_path(env, folder, name, &path)) &&
        !(result = slvi_output_begin(env, path, false, &to))) {
        file = open(from, O_RDONLY | O_CLOEXEC);
        result = file < 0 ? slvi_fail(env, slvi_io_error(errno), "%s: %s", from, strerror(errno))
                          : copy_bytes(env, from, file, &to, buffer);
        if (!result)
            result = slvi_output_commit(&to, !session->params.relaxed);
    }
    slvi_output_discard(&to);
    if (file >= 0)
        close(file);
    slvi_free(from);
    slvi_free(path);
    return result;
}

/* What belongs to a session by its name: not what a killed process was writing. */
static bool is_part(const char *name) {
    static const char *const begins[] = {"session.json", "mesh.obj", "state-", "journal",
                                         "brush-",       "texture-", "image-"};
    size_t length = strlen(name), end = sizeof ".selvage" - 1;
    if (length > end && strcmp(name + length - end, ".selvage") == 0)
        return false;
    for (size_t i = 0; i < SLVI_COUNT(begins); i++)
        if (strncmp(name, begins[i], strlen(begins[i])) == 0)
            return true;
    return false;
}

static slv_result copy_folder(const slv_session *session, const char *folder) {
    char *buffer = NULL;
    slv_result result = slvi_alloc_plain(&session->env, "session", CHUNK, 1, &buffer);
    DIR *stream = result ? NULL : opendir(session->path);
    if (!result && !stream)
        result = slvi_fail(&session->env, slvi_io_error(errno), "%s: cannot be listed: %s",
                           session->path, strerror(errno));
    for (struct dirent *entry; !result && stream && (entry = readdir(stream));)
        if (is_part(entry->d_name))
            result = copy_file(session, entry->d_name, folder, buffer);
    if (stream)
        closedir(stream);
    slvi_free(buffer);
    return result;
}

/* The journal of the new place, to go on with, and its path. */
static slv_result open_there(const slv_session *session, const char *folder, char **path,
                             slvi_journal *journal) {
    char *name = NULL;
    size_t size = strlen(folder) + 1;
    slv_result result = slvi_alloc(&session->env, "session", size, 1, path);
    if (!result) {
        memcpy(*path, folder, size);
        result = slvi_session_path(&session->env, folder, "journal", &name);
    }
    if (!result && !(result = slvi_journal_open(&session->env, name, false, NULL, journal))) {
        journal->next = session->journal.next;
        journal->relaxed = session->journal.relaxed;
    }
    slvi_free(name);
    return result;
}

slv_result slv_session_save_as(slv_session *session, const char *path) {
    const slv_env *env = &session->env;
    char *target = NULL, *beside = NULL, *there = NULL;
    int descriptor = -1;
    slvi_journal journal = {.file = -1};
    struct stat status;
    if (session->document->history.open || session->params.unkept)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         session->params.unkept
                             ? "%s: was opened to be looked at, and is not saved"
                             : "%s: cannot be saved within an entry of its history",
                         session->path);
    if (lstat(path, &status) == 0)
        return slvi_fail(env, SLV_ERROR_IO, "%s: is there already", path);
    slv_result result = slvi_beside_resolve(env, path, &target);
    if (result ||
        (result = slvi_beside_create(env, path, target, true, 0777, &beside, &descriptor)))
        goto done;
    result = copy_folder(session, beside);
    if (!result && rename(beside, target) != 0)
        result = slvi_fail(env, slvi_io_error(errno), "%s: %s", path, strerror(errno));
    if (result)
        slvi_beside_remove_folder(beside);
    close(descriptor);
    if (result)
        goto done;
    char *old = session->path;
    slvi_journal here = session->journal;
    if (!(result = open_there(session, target, &there, &journal))) {
        session->path = there;
        session->journal = journal;
        result = slv_session_save(session);
    }
    if (result) { /* as if nothing had been */
        session->path = old;
        session->journal = here;
        slvi_journal_close(&journal);
        slvi_free(there);
        slvi_beside_remove_folder(target);
    } else {
        slvi_journal_close(&here);
        slvi_free(old);
    }
done:
    slvi_free(target);
    slvi_free(beside);
    return result;
}

slv_result slv_session_remove(const slv_env *env, const char *path) {
    slv_env found = slvi_env_or_default(env);
    slvi_journal journal = {.file = -1};
    char *name = NULL;
    if (!slv_session_is(path))
        return slvi_fail(&found, SLV_ERROR_IO, "%s: is no session", path);
    slv_result result = slvi_session_path(&found, path, "journal", &name);
    if (!result && !(result = slvi_journal_open(&found, name, false, NULL, &journal)))
        slvi_beside_remove_folder(path);
    if (!result && slv_session_is(path))
        result = slvi_fail(&found, SLV_ERROR_IO, "%s: cannot be removed", path);
    slvi_journal_close(&journal);
    slvi_free(name);
    return result;
}

const char *slv_session_path(const slv_session *session) {
    return session->path;
}
