/* Puts a file and a line before errors. */
#include "command/line_log.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static void log_line(void *user, slv_log_level level, const char *message) {
    const line_log *log = user;
    char text[1024];
    /* what a script itself says names its line already */
    const size_t length = log->path ? strlen(log->path) : 0;
    const bool named = log->line && level == SLV_LOG_ERROR &&
                       !(length && strncmp(message, log->path, length) == 0 &&
                         strncmp(message + length, ": line ", 7) == 0);
    if (named)
        snprintf(text, sizeof text, "%s: line %" PRIu64 ": %s", log->path, log->line, message);
    log->outer.log(log->outer.log_user, level, named ? text : message);
}

slv_env line_log_begin(line_log *log, const slv_env *env, const char *path) {
    slv_env own = *env;
    *log = (line_log){.outer = *env, .path = path};
    own.log = log_line;
    own.log_user = log;
    return own;
}
