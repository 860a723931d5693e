/* Errors of lines that are run by somebody who does not know the file that they come from. */
#ifndef SELVAGE_TOOLS_LINE_LOG_H
#define SELVAGE_TOOLS_LINE_LOG_H

#include <selvage/result.h>

#include <stdint.h>

typedef struct line_log {
    slv_env outer;
    const char *path;
    uint64_t line; /* that is run; 0: none */
} line_log;

/* An environment like `env` whose errors begin with the file and the line; both live as long. */
slv_env line_log_begin(line_log *log, const slv_env *env, const char *path);

#endif
