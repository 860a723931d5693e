/* Saving: a new state, and those that nothing goes back to are removed. */
#include "session/session_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <unistd.h>

slv_result slv_session_save(slv_session *session) {
    char *path = NULL, *old = NULL;
    uint64_t line = session->journal.next - 1;
    if (session->document->history.open)
        return slvi_fail(&session->env, SLV_ERROR_ARGUMENT,
                         "%s: cannot be saved within an entry of its history", session->path);
    slv_result result = slvi_session_state_path(session, session->state + 1, &path);
    if (!result && !(result = slvi_state_write(&session->env, path, session->document, line))) {
        /* that which undo may go back to stays, too */
        for (uint64_t state = session->state; state; state--) {
            if (state == session->floor)
                continue;
            if (slvi_session_state_path(session, state, &old) || unlink(old) != 0)
                state = state > session->floor ? session->floor + 1 : 1;
            slvi_free(old);
            old = NULL;
        }
        session->state++;
        session->saved_line = line;
    }
    slvi_free(path);
    return result;
}
