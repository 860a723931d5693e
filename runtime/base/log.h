/* Words for the caller's log. */
#ifndef SLV_BASE_LOG_H
#define SLV_BASE_LOG_H

#include <selvage/result.h>

#define SLV_PRINTF(f, a) __attribute__((format(printf, f, a)))

/* NULL stands for all defaults. */
slv_env slvi_env_or_default(const slv_env *env);

void slvi_logf(const slv_env *env, slv_log_level level, const char *format, ...) SLV_PRINTF(3, 4);
/* Logs an error and returns `result`, so that a failing line reads `return slvi_fail(...)`. */
slv_result slvi_fail(const slv_env *env, slv_result result, const char *format, ...)
    SLV_PRINTF(3, 4);

#endif
