#include "base/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEFAULT_MAX_BYTES (UINT64_C(16) << 30)

slv_env slv_env_or_default(const slv_env *env) {
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

void slv_logf(const slv_env *env, slv_log_level level, const char *format, ...) {
    va_list args;
    va_start(args, format);
    log_line(env, level, format, args);
    va_end(args);
}

slv_result slv_fail(const slv_env *env, slv_result result, const char *format, ...) {
    va_list args;
    va_start(args, format);
    log_line(env, SLV_LOG_ERROR, format, args);
    va_end(args);
    return result;
}

slv_result slv_alloc(const slv_env *env, const char *what, uint64_t count, uint64_t size,
                     void *out) {
    void *memory = NULL;
    uint64_t limit = env && env->max_bytes ? env->max_bytes : DEFAULT_MAX_BYTES;
    memcpy(out, &memory, sizeof memory);
    if (size && count > limit / size)
        return slv_fail(env, SLV_ERROR_LIMIT, "%s: %llu x %llu bytes is over the limit of %llu",
                        what, (unsigned long long)count, (unsigned long long)size,
                        (unsigned long long)limit);
    memory = calloc(count ? (size_t)count : 1, size ? (size_t)size : 1);
    if (!memory)
        return slv_fail(env, SLV_ERROR_MEMORY, "%s: no memory for %llu bytes", what,
                        (unsigned long long)(count * size));
    memcpy(out, &memory, sizeof memory);
    return SLV_OK;
}
