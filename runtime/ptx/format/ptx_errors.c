/* Work on ranges of faces in parallel of which only the first error is logged. */
#include "ptx/format/ptx_file.h"

#include "base/log.h"

#include <stdio.h>

static void keep_first(void *user, slv_log_level level, const char *message) {
    const ptx_range_log *log = user;
    ptx_errors *errors = log->errors;
    if (level != SLV_LOG_ERROR)
        return;
    pthread_mutex_lock(&errors->lock);
    if (!errors->any || log->range < errors->range) {
        errors->any = true;
        errors->range = log->range;
        snprintf(errors->message, sizeof errors->message, "%s", message);
    }
    pthread_mutex_unlock(&errors->lock);
}

static void keep_line(void *user, slv_log_level level, const char *message) {
    ptx_kept_line *line = user;
    if (level == SLV_LOG_ERROR)
        snprintf(line->text, sizeof line->text, "%s", message);
}

slv_env slvi_ptx_keep_line(const slv_env *env, ptx_kept_line *line) {
    slv_env inner = slvi_env_or_default(env);
    line->text[0] = 0;
    inner.log = keep_line;
    inner.log_user = line;
    return inner;
}

slv_env slvi_ptx_range_env(const slv_env *env, ptx_errors *errors, uint64_t first,
                           ptx_range_log *log) {
    slv_env inner = slvi_env_or_default(env);
    *log = (ptx_range_log){errors, first};
    inner.log = keep_first;
    inner.log_user = log;
    return inner;
}

slv_result slvi_ptx_parallel_for(const slv_env *env, ptx_errors *errors, uint64_t count,
                                 uint64_t grain, slv_range_fn fn, void *user) {
    pthread_mutex_init(&errors->lock, NULL);
    errors->any = false;
    slv_result result = slvi_parallel_for(env, count, grain, fn, user);
    if (errors->any)
        slvi_fail(env, result, "%s", errors->message);
    pthread_mutex_destroy(&errors->lock);
    return result;
}
