/* Saving: a new state, and those that nothing goes back to are removed. */
#include "session/session_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

slv_result slvi_session_save(slv_session *session) {
    char *path = NULL;
    if (session->params.unkept)
        return slvi_fail(&session->env, SLV_ERROR_ARGUMENT,
                         "%s: was opened to be looked at, and is not saved", session->path);
    uint64_t line = session->journal.next - 1;
    slv_result result = slvi_session_state_path(session, session->state + 1, &path);
    if (!result && !(result = slvi_state_write(&session->env, path, session->document, line))) {
        /* that which undo may go back to stays, too */
        size_t room = strlen(path) + 1, at = strlen(session->path) + sizeof "/state-" - 1;
        for (uint64_t state = session->state; state; state--) {
            snprintf(path + at, room - at, "%" PRIu64, state);
            if (state != session->floor && unlink(path) != 0)
                state = state > session->floor ? session->floor + 1 : 1;
        }
        session->state++;
        session->saved_line = line;
    }
    slvi_free(path);
    return result;
}

slv_result slv_session_save(slv_session *session) {
    if (session->document->history.open)
        return slvi_fail(&session->env, SLV_ERROR_ARGUMENT,
                         "%s: cannot be saved within an entry of its history", session->path);
    return slvi_session_save(session);
}
