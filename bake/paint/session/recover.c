/* Opening: the newest state that fits the journal, and what was done after it. */
#include "session/session_data.h"

#include "base/beside.h"
#include "base/file.h"
#include "base/json.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/output.h"
#include "history/history.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* Of a folder: the numbers of states in it, the newest first. */
static slv_result list_states(const slv_session *session, uint64_t **out, uint64_t *count) {
    uint64_t room = 0;
    slv_result result = SLV_OK;
    DIR *folder = opendir(session->path);
    *out = NULL;
    *count = 0;
    if (!folder)
        return slvi_fail(&session->env, slvi_io_error(errno), "%s: cannot be listed: %s",
                         session->path, strerror(errno));
    for (struct dirent *entry; !result && (entry = readdir(folder));) {
        char *end;
        const char *digits = entry->d_name + 6;
        if (strncmp(entry->d_name, "state-", 6) != 0 || *digits < '1' || *digits > '9' ||
            strlen(digits) > 18)
            continue;
        uint64_t number = strtoull(digits, &end, 10), at = *count;
        if (*end)
            continue;
        if (*count == room) {
            room += 16;
            if ((result = slvi_grow(&session->env, "session", room, sizeof **out, out)))
                break;
        }
        for (; at && (*out)[at - 1] < number; at--)
            (*out)[at] = (*out)[at - 1];
        (*out)[at] = number;
        ++*count;
    }
    closedir(folder);
    return result;
}

static slv_result replay_edit(slv_session *session, json_t *edit) {
    slv_document *document = session->document;
    const char *op = json_string_value(json_object_get(edit, "op"));
    json_int_t layer = json_integer_value(json_object_get(edit, "layer"));
    slvi_edit part;
    if (op && strcmp(op, "stroke") != 0 && strcmp(op, "fill") != 0)
        return slvi_edit_apply(document, session->journal.path, edit, session->path);
    slv_result result = slvi_edit_begin(document, slvi_session_name(edit), &part);
    if (result)
        return result;
    if (layer < 0 || layer > UINT32_MAX)
        result = slvi_fail(&session->env, SLV_ERROR_FORMAT, "%s: layer is not what it should be",
                           session->journal.path);
    else
        result = slvi_session_paint(session, (uint32_t)layer,
                                    json_is_true(json_object_get(edit, "mask")), edit);
    return slvi_edit_end(document, &part, NULL, result);
}

static slv_result replay_line(slv_session *session, const slvi_journal_text *text, uint64_t i) {
    const slvi_journal_line *line = &text->lines[i];
    slv_result result = SLV_OK;
    size_t size = line->size + 1, k;
    char *copy = NULL; /* with the brace that closes it */
    json_t *edit;
    if ((result = slvi_alloc_plain(&session->env, "journal", size, 1, &copy)))
        return result;
    memcpy(copy, text->text + line->at, size - 1);
    copy[size - 1] = '}';
    json_error_t error;
    json_t *root;
    result = slvi_json_load(copy, size, JSON_REJECT_DUPLICATES, &root, &error);
    json_t *edits = json_object_get(root, "edits");
    slvi_free(copy);
    if (result)
        return slvi_fail(&session->env, result, "%s: line %" PRIu64 " %s", session->journal.path,
                         line->number,
                         result == SLV_ERROR_MEMORY ? "does not fit into memory" : "is no JSON");
    if (!json_is_array(edits)) {
        result = replay_edit(session, root);
    } else if (!(result = slv_document_begin(session->document,
                                             json_string_value(json_object_get(root, "name"))))) {
        json_array_foreach(edits, k, edit) if (!result) result = replay_edit(session, edit);
        if (result)
            slv_document_cancel(session->document);
        else
            result = slv_document_end(session->document);
    }
    json_decref(root);
    return result;
}

/* What is no fault of the session's, and may be gone the next time it is opened. */
static bool will_pass(slv_result result) {
    return result == SLV_ERROR_MEMORY || result == SLV_ERROR_LIMIT || result == SLV_ERROR_IO;
}

/* Why, in as many words as there are. */
static const char *why(const slv_session *session, slv_result result) {
    return *session->why ? session->why : slv_result_string(result);
}

/* Makes the document of a state. What is wrong with one is said as a warning: there may be others.
 */
static slv_result try_state(slv_session *session, uint64_t state, uint64_t *line) {
    char *path = NULL;
    slv_result result;
    session->quiet = true;
    *session->why = 0;
    if (!(result = slvi_session_state_path(session, state, &path)) &&
        !(result = slvi_session_new_document(session)))
        result = slvi_state_read(&session->env, path, session->document, line);
    session->quiet = false;
    if (result && !will_pass(result))
        slvi_logf(&session->env, SLV_LOG_WARNING, "%s/state-%" PRIu64 ": cannot be used (%s)",
                  session->path, state, why(session, result));
    slvi_free(path);
    return result;
}

/* Does the lines again; from one that cannot be on, nothing. */
static slv_result replay(slv_session *session, const slvi_journal_text *text, const uint64_t *live,
                         uint64_t count, bool *whole) {
    slv_result result = SLV_OK;
    session->replaying = true;
    for (uint64_t i = 0; i < count; i++) {
        session->quiet = true;
        *session->why = 0;
        result = replay_line(session, text, live[i]);
        session->quiet = false;
        if (will_pass(result)) {
            slvi_logf(&session->env, SLV_LOG_ERROR,
                      "%s: line %" PRIu64
                      " cannot be done now (%s); as saved (--as-saved) it opens "
                      "without that line and all after it",
                      session->journal.path, text->lines[live[i]].number, why(session, result));
            break;
        }
        if (result) {
            slvi_logf(&session->env, SLV_LOG_WARNING,
                      "%s: line %" PRIu64 " and what came after cannot be done again (%s)",
                      session->journal.path, text->lines[live[i]].number, why(session, result));
            result = SLV_OK;
            *whole = false;
            break;
        }
        session->info.recovered++;
    }
    session->replaying = false;
    return result;
}

/* What could be redone can be again. It is no part of what is there: if it cannot be done, there is
 * less to redo. */
static slv_result replay_undone(slv_session *session, const slvi_journal_text *text,
                                const uint64_t *lines, uint64_t count) {
    uint64_t done = 0;
    slv_result result = SLV_OK;
    session->replaying = session->quiet = true;
    while (done < count && replay_line(session, text, lines[done]) == SLV_OK)
        done++;
    for (session->quiet = false; done && !result; done--)
        result = slv_document_undo(session->document);
    session->replaying = false;
    return result;
}

/* What is at the journal's end and no whole line: torn off, or kept if there is more behind it. */
static slv_result cut(slv_session *session, const slvi_journal_text *text) {
    uint64_t torn = session->journal.size - text->end;
    char *path = NULL;
    slv_result result = SLV_OK;
    session->info.torn_bytes = torn;
    if (session->params.unkept)
        return SLV_OK;
    if (torn > 1 && memchr(text->text + text->end, '\n', torn - 1) &&
        !(result = slvi_session_path(&session->env, session->path, "journal-damaged", &path)))
        result = slvi_output_write(&session->env, path, text->text + text->end, torn);
    if (!result && path)
        slvi_logf(&session->env, SLV_LOG_WARNING,
                  "%s: is damaged after line %" PRIu64
                  ": what came then is not done again, and kept in %s",
                  session->journal.path, text->count, path);
    slvi_free(path);
    return result ? result : slvi_journal_cut(&session->journal, text->end);
}

/* What a process that was killed while it saved has left. */
static slv_result sweep(const slv_session *session) {
    char *path = NULL;
    slv_result result = slvi_session_state_path(session, session->state + 1, &path);
    if (!result)
        slvi_beside_sweep(path);
    slvi_free(path);
    return result;
}

/* What came after a state and is not to be: the journal says that it was undone, for those who read
 * it from its beginning. */
static slv_result forget(slv_session *session, const slvi_journal_text *text, uint64_t line,
                         uint64_t *live) {
    uint64_t count = 0, undone;
    bool whole;
    slv_result result = SLV_OK;
    if (session->params.unkept ||
        !slvi_journal_survivors(text, line, live, &count, &undone, &whole) || !whole)
        return SLV_OK;
    json_t *undo = json_pack("{s:s}", "op", "undo");
    for (uint64_t i = 0; i < count && !result; i++)
        result = slvi_journal_append(&session->journal, undo);
    json_decref(undo);
    return result;
}

/* From the states, newest first, the one to go on from. */
static slv_result choose(slv_session *session, const slvi_journal_text *text,
                         const uint64_t *states, uint64_t nstates, uint64_t *live) {
    uint64_t line = 0, count = 0, undone = 0,
             last = text->count ? text->lines[text->count - 1].number : 0;
    bool whole = true;
    slv_result result = SLV_ERROR_FORMAT;
    for (uint64_t i = 0; i < nstates; i++) {
        result = try_state(session, states[i], &line);
        if (will_pass(result))
            return slvi_fail(&session->env, result, "%s/state-%" PRIu64 ": cannot be read now (%s)",
                             session->path, states[i], why(session, result));
        if (result)
            continue;
        if (i == 0)
            session->saved_line = line;
        if (session->params.as_saved ||
            slvi_journal_survivors(text, line, live, &count, &undone, &whole)) {
            session->floor = states[i];
            break;
        }
        result = SLV_ERROR_FORMAT;
    }
    if (result)
        return slvi_fail(&session->env, SLV_ERROR_FORMAT,
                         "%s: there is no state that could be opened", session->path);
    session->state = states[0];
    session->journal.next = (last > line ? last : line) + 1;
    if (session->params.as_saved) {
        if ((result = forget(session, text, line, live)))
            return result;
        whole = text->count == 0 || last <= line;
        count = undone = 0;
    }
    if ((result = replay(session, text, live, count, &whole)))
        return result;
    if (whole)
        return replay_undone(session, text, live + count, undone);
    if (session->params.unkept)
        return SLV_OK;
    /* later lines follow on what is there now */
    return slv_session_save(session);
}

slv_result slvi_session_recover(slv_session *session) {
    slvi_journal_text text = {0};
    uint64_t *states = NULL, *live = NULL, nstates = 0;
    slv_result result = slvi_journal_scan(&session->journal, &text);
    if (!result && !(result = list_states(session, &states, &nstates)) &&
        !(result = slvi_alloc(&session->env, "journal", text.count, sizeof *live, &live)) &&
        !(result = cut(session, &text)))
        result = choose(session, &text, states, nstates, live);
    if (!result && !session->params.unkept)
        result = sweep(session);
    session->info.lines = text.count;
    slvi_journal_free(&text);
    slvi_free(states);
    slvi_free(live);
    return result;
}
