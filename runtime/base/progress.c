/* Telling a caller how far work is, and ending it when the caller has had enough. */
#include "base/progress.h"

#include "base/log.h"

void slvi_steps_begin(slvi_steps *steps, slv_progress progress, uint64_t total) {
    *steps = (slvi_steps){.progress = progress, .total = total};
    pthread_mutex_init(&steps->lock, NULL);
}

slv_result slvi_steps_add(slvi_steps *steps, const slv_env *env, const char *what, uint64_t count) {
    slv_result result;
    if (!steps || !steps->progress.report)
        return SLV_OK;
    pthread_mutex_lock(&steps->lock);
    steps->done += count;
    if (steps->cancelled)
        result = SLV_ERROR_CANCELLED;
    else
        result = slvi_progress(&steps->progress, env, what, steps->done, steps->total);
    steps->cancelled = result != SLV_OK;
    pthread_mutex_unlock(&steps->lock);
    return result;
}

void slvi_steps_end(slvi_steps *steps) {
    pthread_mutex_destroy(&steps->lock);
}

slv_result slvi_progress(const slv_progress *progress, const slv_env *env, const char *what,
                         uint64_t done, uint64_t total) {
    if (!progress->report || progress->report(progress->user, done, total))
        return SLV_OK;
    return slvi_fail(env, SLV_ERROR_CANCELLED, "%s: cancelled", what);
}

static bool ask(void *user, uint64_t done, uint64_t total) {
    const slv_progress *progress = user;
    (void)done;
    (void)total;
    return progress->report(progress->user, 0, 1);
}

slv_progress slvi_progress_asking(slv_progress *progress) {
    return (slv_progress){progress->report ? ask : NULL, progress};
}
