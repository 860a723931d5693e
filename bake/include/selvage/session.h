/* A session: a painted document that nothing can lose. It is a folder (docs/session-files.md) with
 * the mesh, the layers as they were saved, the brushes in use, and a journal of all that was done
 * since.
 *
 *     slv_session_create(&env, "car.selvage", mesh, &params, &session);   or slv_session_open
 *     slv_document_add_layer(slv_session_document(session), NULL, &layer);
 *     slv_session_run(session, layer, false, "{\"samples\":[[0,0.1,0.5],[0,0.9,0.5]]}", size);
 *     slv_session_save(session);
 *     slv_session_destroy(session);
 *
 * What is done is in the journal, and on the disk, when the call returns: a killed process loses no
 * more than what it was at. A call whose line cannot be written fails, and the document is as it
 * was. Opening brings back all whole lines of the journal, wherever it ends; what was saved stays
 * as it is until slv_session_save. One process has a session at a time. Not for several threads at
 * once. */
#ifndef SELVAGE_SESSION_H
#define SELVAGE_SESSION_H

#include <selvage/document.h>
#include <selvage/script.h>
#include <selvage/stroke.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct slv_session slv_session;

/* Zero means default, but for `document.flat`. */
typedef struct slv_session_params {
    slv_document_params
        document;      /* of its sizes only those of the limits count when one is opened */
    slv_scheme scheme; /* of the surface that is painted on */
    bool relaxed;  /* do not wait for the disk: a power cut may lose what it had not been told */
    bool as_saved; /* open without what came after the last save, and forget that */
    /* Nothing that is done is kept: the folder, which may be one that can only be read, is opened
     * to be looked at, and written to by no call. Saving is SLV_ERROR_ARGUMENT. Not for new
     * sessions. */
    bool unkept;
    /* For new sessions: the file that it is made of, which is kept as a full path for those who ask
     * what must not be written over. NULL: none. */
    const char *made_of;
    uint64_t reserved[3];
} slv_session_params;

/* A new folder with a copy of the mesh. SLV_ERROR_IO if something is there: nothing is replaced. */
SLV_NODISCARD SLV_API slv_result slv_session_create(const slv_env *env, const char *path,
                                                    const slv_mesh *mesh,
                                                    const slv_session_params *params,
                                                    slv_session **out);
/* The same with a texture's texels as the lowest layer, `base`, an empty layer above it, and saved.
 * Nothing of that can be undone. Of `params` (may be NULL) document.flat does not count: it is the
 * texture's. */
SLV_NODISCARD SLV_API slv_result slv_session_create_from(const slv_env *env, const char *path,
                                                         const slv_mesh *mesh,
                                                         const slv_texture *texture,
                                                         const slv_session_params *params,
                                                         slv_session **out);
/* `params` may be NULL. Undo goes back as far as what was brought back from the journal. */
SLV_NODISCARD SLV_API slv_result slv_session_open(const slv_env *env, const char *path,
                                                  const slv_session_params *params,
                                                  slv_session **out);
/* Ends it without saving: what was done is in the journal. */
SLV_API void slv_session_destroy(slv_session *session);

/* Whether a path is a session: a folder with its description in it. */
SLV_API bool slv_session_is(const char *path);

/* All that is done to it is journalled, but that its layers are painted on through the session.
 * Owned by the session, as the others. */
SLV_API slv_document *slv_session_document(slv_session *session);
SLV_API const slv_mesh *slv_session_mesh(const slv_session *session);
SLV_API const slv_adjacency *slv_session_adjacency(const slv_session *session);
SLV_API slv_scheme slv_session_scheme(const slv_session *session);
/* Made when it is first asked for. */
SLV_NODISCARD SLV_API slv_result slv_session_painter(slv_session *session, slv_painter **out);

/* Runs a line of a script (script.h) on a layer, or its mask: one entry of the history. Brush files
 * are copied into the session; names are relative to `folder` (NULL: where the process is). Lines
 * of a session's journal are run too, so that a journal is a script: a line that names its layer is
 * for that, and one with an edit, "undo" or "redo" does that to the document. */
SLV_NODISCARD SLV_API slv_result slv_session_run(slv_session *session, uint32_t layer, bool mask,
                                                 const char *folder, const char *line, size_t size);

/* A stroke while it is made, for windows: `line` is one of a script's with all of a stroke but its
 * samples, which are told as they come and show in the document at once. `end` puts the line, with
 * all samples, into the journal, by which running it gives the same texels. One at a time; until it
 * has ended nothing else can be done to the document. After a failure nothing of it is left, and it
 * has ended; so has one whose session is destroyed. Pressures, tilts and times beyond their ranges
 * (stroke.h) are cut to them. `stats` may be NULL. */
SLV_NODISCARD SLV_API slv_result slv_session_stroke_begin(slv_session *session, uint32_t layer,
                                                          bool mask, const char *folder,
                                                          const char *line, size_t size);
SLV_NODISCARD SLV_API slv_result slv_session_stroke_add(slv_session *session,
                                                        const slv_stroke_sample *samples,
                                                        uint32_t count);
SLV_NODISCARD SLV_API slv_result slv_session_stroke_end(slv_session *session,
                                                        slv_stroke_stats *stats);
/* Takes it back. Nothing if there is none. */
SLV_API void slv_session_stroke_cancel(slv_session *session);

/* Puts the document as it is beside the saved one, which it then replaces: at any moment one of the
 * two is there. */
SLV_NODISCARD SLV_API slv_result slv_session_save(slv_session *session);

/* Puts a copy of the session, saved, to another place, where it is from then on: what is done next
 * is in the journal there. The old folder is left as it is, saved or not, and free for others.
 * SLV_ERROR_IO if something is there already; then the session is where it was. */
SLV_NODISCARD SLV_API slv_result slv_session_save_as(slv_session *session, const char *path);
/* Makes a new session at `path` in which all is done again that was done in the one at `from` and
 * not undone, from its beginning on, at 2^scale times the resolution along each side of a face (a
 * negative scale: at a part of it): strokes from their samples, brushes counted in texels by as
 * many more. Textures that were loaded are resized. It is saved; what was merged from other
 * sessions is not in journals, and is left out. SLV_ERROR_LIMIT for faces that would be too large
 * or too small. After a failure nothing is left. */
SLV_NODISCARD SLV_API slv_result slv_session_replay(const slv_env *env, const char *from,
                                                    const char *path, int scale, slv_session **out);
/* Removes a session's folder with all that is in it. SLV_ERROR_IO, and nothing is removed, while
 * somebody has it open. */
SLV_NODISCARD SLV_API slv_result slv_session_remove(const slv_env *env, const char *path);
/* Where it is. Owned by the session, until it goes elsewhere. */
SLV_API const char *slv_session_path(const slv_session *session);
/* The file that it was made of, or NULL if that was not said; it may be there no more. Owned by the
 * session. */
SLV_API const char *slv_session_made_of(const slv_session *session);

typedef struct slv_session_info {
    uint64_t lines;      /* of the journal */
    uint64_t unsaved;    /* of them, since the last save */
    uint64_t recovered;  /* things that were done and not saved, and brought back at opening */
    uint64_t torn_bytes; /* at the end of the journal that were no whole line then */
    uint64_t journal_bytes;
    uint64_t reserved[4];
} slv_session_info;
SLV_API void slv_session_get_info(const slv_session *session, slv_session_info *out);
/* What strokes and fills have done since it was opened, undone or not, and whether they painted on
 * a face. */
SLV_API void slv_session_get_stats(const slv_session *session, slv_script_stats *out);
SLV_API bool slv_session_touched(const slv_session *session, uint32_t face);

/* Writes the flattened document as a .ptx, with the mesh inside. */
SLV_NODISCARD SLV_API slv_result slv_session_export(slv_session *session, const char *path);
/* Appends to the .ptx at `path` those faces that it has otherwise; `faces` (may be NULL) is how
 * many. SLV_ERROR_MISMATCH if its faces, type or channels are not the document's. */
SLV_NODISCARD SLV_API slv_result slv_session_export_edits(slv_session *session, const char *path,
                                                          uint32_t *faces);

/* Takes what `other` has painted on faces of its layers, where this session has painted nothing on
 * those of the layers of the same ids; `faces` (may be NULL) is how many. Then it is saved, and its
 * history begins anew. SLV_ERROR_MISMATCH, and nothing is changed, if one was painted on in both,
 * and is not the same. */
SLV_NODISCARD SLV_API slv_result slv_session_merge(slv_session *session, const slv_session *other,
                                                   uint32_t *faces);

#ifdef __cplusplus
}
#endif

#endif
