/* Sessions: made, opened and ended. */
#include "session/session_data.h"

#include "base/beside.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/output.h"
#include "history/history.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static slv_result open_all(slv_session *session, const slv_session_params *params) {
    const slv_env *env = &session->env;
    char *about = NULL, *mesh = NULL, *journal = NULL;
    bool missing = false;
    slv_result result;
    if ((result = slvi_session_path(env, session->path, "session.json", &about)) ||
        (result = slvi_session_path(env, session->path, "mesh.obj", &mesh)) ||
        (result = slvi_session_path(env, session->path, "journal", &journal)) ||
        (result = slvi_session_read_description(env, about, &session->params, &session->began)) ||
        (result = slvi_journal_open(env, journal, params->unkept, &missing, &session->journal)) ||
        (result = slv_mesh_load(env, mesh, &session->mesh)) ||
        (result = slv_mesh_adjacency(env, session->mesh, &session->adjacency)))
        goto done;
    if (slv_mesh_face_count(session->mesh) != session->params.document.flat.nfaces) {
        result = slvi_fail(env, SLV_ERROR_MISMATCH, "%s: the mesh has %u faces, the layers %u",
                           session->path, (unsigned)slv_mesh_face_count(session->mesh),
                           (unsigned)session->params.document.flat.nfaces);
        goto done;
    }
    if (missing)
        slvi_logf(env, SLV_LOG_WARNING,
                  "%s: is missing: there is only what was saved, and nothing that came after",
                  session->journal.path);
    session->params.relaxed = session->journal.relaxed = params->relaxed;
    session->params.as_saved = params->as_saved;
    session->params.unkept = params->unkept;
    session->params.document.history_bytes = params->document.history_bytes;
    session->params.document.disk_bytes = params->document.disk_bytes;
    session->params.document.scratch = params->document.scratch;
    result = slvi_session_recover(session);
done:
    slvi_free(about);
    slvi_free(mesh);
    slvi_free(journal);
    return result;
}

/* What went wrong while it was quiet is kept, for the line that says what comes of it. */
static void log_unless_quiet(void *user, slv_log_level level, const char *message) {
    static pthread_mutex_t guard = PTHREAD_MUTEX_INITIALIZER; /* any thread may fail */
    slv_session *session = user;
    if (!session->quiet) {
        if (session->outer.log)
            session->outer.log(session->outer.log_user, level, message);
    } else if (level == SLV_LOG_ERROR) {
        pthread_mutex_lock(&guard);
        snprintf(session->why, sizeof session->why, "%s", message);
        pthread_mutex_unlock(&guard);
    }
}

slv_result slv_session_open(const slv_env *env, const char *path, const slv_session_params *params,
                            slv_session **out) {
    static const slv_session_params plain = {0};
    slv_env found = slvi_env_or_default(env);
    slv_session *session = NULL;
    *out = NULL;
    slv_result result = slvi_alloc(&found, "session", 1, sizeof *session, &session);
    if (result)
        return result;
    session->env = session->outer = found;
    session->env.log = log_unless_quiet;
    session->env.log_user = session;
    session->journal.file = -1;
    session->edits = json_array();
    session->set = json_object();
    if (!(result = slvi_alloc(&found, "session", strlen(path) + 1, 1, &session->path))) {
        memcpy(session->path, path, strlen(path) + 1);
        result = open_all(session, params ? params : &plain);
    }
    if (result) {
        slv_session_destroy(session);
        return result;
    }
    *out = session;
    return SLV_OK;
}

/* The files of a new session. */
static slv_result fill_folder(const slv_env *env, const char *folder, const slv_mesh *mesh,
                              const slv_session_params *params) {
    char *about = NULL, *copy = NULL, *state = NULL, *journal = NULL;
    slv_document *document = NULL;
    slv_result result;
    if ((result = slvi_session_path(env, folder, "session.json", &about)) ||
        (result = slvi_session_path(env, folder, "mesh.obj", &copy)) ||
        (result = slvi_session_path(env, folder, "state-1", &state)) ||
        (result = slvi_session_path(env, folder, "journal", &journal)) ||
        (result = slv_document_create(env, &params->document, NULL, &document)) ||
        (result = slvi_session_describe(env, about, params)) ||
        (result = slv_mesh_save_obj(env, mesh, copy)) ||
        (result = slvi_output_write(env, journal, "", 0)))
        goto done;
    result = slvi_state_write(env, state, document, 0);
done:
    slv_document_destroy(document);
    slvi_free(about);
    slvi_free(copy);
    slvi_free(state);
    slvi_free(journal);
    return result;
}

slv_result slv_session_create(const slv_env *env, const char *path, const slv_mesh *mesh,
                              const slv_session_params *params, slv_session **out) {
    slv_env found = slvi_env_or_default(env);
    char *target = NULL, *beside = NULL;
    int descriptor = -1;
    struct stat there;
    *out = NULL;
    if (params->document.flat.nfaces != slv_mesh_face_count(mesh))
        return slvi_fail(&found, SLV_ERROR_MISMATCH, "%s: the mesh has %u faces, the layers %u",
                         path, (unsigned)slv_mesh_face_count(mesh),
                         (unsigned)params->document.flat.nfaces);
    if (lstat(path, &there) == 0)
        return slvi_fail(&found, SLV_ERROR_IO, "%s: is there already", path);
    slv_result result = slvi_beside_resolve(&found, path, &target);
    if (result ||
        (result = slvi_beside_create(&found, path, target, true, 0777, &beside, &descriptor)))
        goto done;
    result = fill_folder(&found, beside, mesh, params);
    if (!result && rename(beside, target) != 0)
        result = slvi_fail(&found, SLV_ERROR_IO, "%s: %s", path, strerror(errno));
    if (result)
        slvi_beside_remove_folder(beside);
    close(descriptor);
    if (!result && (result = slv_session_open(env, path, params, out)))
        slvi_beside_remove_folder(target); /* nobody has it yet */
done:
    slvi_free(target);
    slvi_free(beside);
    return result;
}

slv_result slv_session_create_from(const slv_env *env, const char *path, const slv_mesh *mesh,
                                   const slv_texture *texture, const slv_session_params *params,
                                   slv_session **out) {
    const slv_layer_props props = {.name = "base", .opacity = 1};
    slv_session_params all = params ? *params : (slv_session_params){0};
    uint32_t layer;
    all.document.flat = *slv_texture_get_desc(texture);
    slv_result result = slv_session_create(env, path, mesh, &all, out);
    if (result)
        return result;
    slv_document *document = slv_session_document(*out);
    if ((result = slv_document_add_layer(document, &(slv_layer_params){.props = &props}, &layer)) ||
        (result = slv_document_load_layer(document, layer, texture)) ||
        (result = slv_document_add_layer(document, NULL, NULL)) ||
        (result = slv_session_save(*out))) {
        slv_session_destroy(*out);
        *out = NULL;
        slvi_beside_remove_folder(path); /* nobody has it yet */
        return result;
    }
    slvi_history_forget(document); /* undoing begins with what is done to the texture */
    return SLV_OK;
}

void slv_session_destroy(slv_session *session) {
    if (!session)
        return;
    slv_session_stroke_cancel(session);
    slv_document_destroy(session->document);
    slv_painter_destroy(session->painter);
    slv_paint_surface_destroy(session->surface);
    slv_adjacency_destroy(session->adjacency);
    slv_mesh_destroy(session->mesh);
    slvi_journal_close(&session->journal);
    json_decref(session->edits);
    json_decref(session->set);
    slvi_session_free_description(&session->params);
    slvi_free(session->touched);
    slvi_free(session->path);
    slvi_free(session);
}

bool slv_session_is(const char *path) {
    char name[4096];
    struct stat status;
    int length = snprintf(name, sizeof name, "%s/session.json", path);
    return length > 0 && (size_t)length < sizeof name && stat(name, &status) == 0 &&
           S_ISREG(status.st_mode);
}

slv_document *slv_session_document(slv_session *session) {
    return session->document;
}

const char *slv_session_made_of(const slv_session *session) {
    return session->params.made_of;
}

const slv_mesh *slv_session_mesh(const slv_session *session) {
    return session->mesh;
}

const slv_adjacency *slv_session_adjacency(const slv_session *session) {
    return session->adjacency;
}

slv_scheme slv_session_scheme(const slv_session *session) {
    return session->params.scheme;
}

void slv_session_get_info(const slv_session *session, slv_session_info *out) {
    *out = session->info;
    out->lines = session->journal.next - 1;
    out->unsaved = out->lines > session->saved_line ? out->lines - session->saved_line : 0;
    out->journal_bytes = session->journal.size;
}
