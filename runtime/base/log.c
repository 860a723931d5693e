/* Lines for the caller's log. */
#include "base/log.h"

#include <stdarg.h>
#include <stdio.h>

#define DEFAULT_MAX_BYTES (UINT64_C(16) << 30)

slv_env slvi_env_or_default(const slv_env *env) {
    slv_env copy = {0};
    if (env)
        copy = *env;
    if (!copy.max_bytes)
        copy.max_bytes = DEFAULT_MAX_BYTES;
    return copy;
}

static void log_line(const slv_env *env, slv_log_level level, const char *format, va_list args)
    __attribute__((format(printf, 3, 0)));

static void log_line(const slv_env *env, slv_log_level level, const char *format, va_list args) {
    if (!env || !env->log)
        return;
    char line[1024];
    vsnprintf(line, sizeof line, format, args);
    for (char *c = line; *c; c++)
        if ((unsigned char)*c < 0x20)
            *c = ' ';
    env->log(env->log_user, level, line);
}

void slvi_logf(const slv_env *env, slv_log_level level, const char *format, ...) {
    va_list args;
    va_start(args, format);
    log_line(env, level, format, args);
    va_end(args);
}

slv_result slvi_fail(const slv_env *env, slv_result result, const char *format, ...) {
    va_list args;
    va_start(args, format);
    log_line(env, SLV_LOG_ERROR, format, args);
    va_end(args);
    return result;
}
