/* A caller who counts, and who may have had enough. */
#ifndef PROGRESS_KIT_H
#define PROGRESS_KIT_H

#include "kit/test.h"

typedef struct progress_count {
    uint64_t done, total;
    uint32_t calls, stop; /* at this call; 0: never */
    bool wrong;           /* steps that went back or past the end, or a call after the stop */
} progress_count;

static bool progress_report(void *user, uint64_t done, uint64_t total) {
    progress_count *count = user;
    count->wrong |= done < count->done || done > total || (count->calls && total != count->total) ||
                    (count->stop && count->calls >= count->stop);
    count->done = done;
    count->total = total;
    count->calls++;
    return count->calls != count->stop;
}

static uint32_t progress_errors;
static void progress_log(void *user, slv_log_level level, const char *message) {
    test_log(user, level, message);
    progress_errors += level == SLV_LOG_ERROR;
}

/* Runs a call to its end, and then again and again until it is stopped at one of the reports of the
 * first run. */
static inline void progress_check(const char *name,
                                  slv_result (*call)(const slv_env *env, slv_progress progress)) {
    progress_count count = {0};
    slv_env env = {.log = progress_log, .threads = 2};
    slv_result result = call(&env, (slv_progress){progress_report, &count});
    CHECK_MSG(result == SLV_OK && !count.wrong, "%s: %d, %s", name, (int)result, test_last_log);
    CHECK_MSG(count.calls && count.done == count.total, "%s: %u reports, %u of %u", name,
              count.calls, (unsigned)count.done, (unsigned)count.total);
    for (uint32_t stop = 1; stop <= count.calls; stop += count.calls / 4 + 1) {
        progress_count stopped = {.stop = stop};
        progress_errors = 0;
        result = call(&env, (slv_progress){progress_report, &stopped});
        CHECK_MSG(result == SLV_ERROR_CANCELLED, "%s, stopped at %u: %d", name, stop, (int)result);
        CHECK_MSG(stopped.calls == stop && !stopped.wrong, "%s, stopped at %u: %u reports", name,
                  stop, stopped.calls);
        CHECK_MSG(progress_errors == 1 && strstr(test_last_log, "cancelled"), "%s: %u errors, %s",
                  name, progress_errors, test_last_log);
    }
}

#endif
