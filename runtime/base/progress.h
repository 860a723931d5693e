/* Telling a caller how far work is, and ending it when the caller has had enough. */
#ifndef SLV_BASE_PROGRESS_H
#define SLV_BASE_PROGRESS_H

#include <selvage/result.h>

#include <pthread.h>

/* Steps of work that threads share. */
typedef struct slvi_steps {
    slv_progress progress;
    pthread_mutex_t lock;
    uint64_t done, total;
    bool cancelled;
} slvi_steps;

void slvi_steps_begin(slvi_steps *steps, slv_progress progress, uint64_t total);
/* `count` more are done. SLV_ERROR_CANCELLED if the caller wants no more: the first thread that
 * hears it logs so, and the caller is not asked again. Any thread; `steps` may be NULL. */
slv_result slvi_steps_add(slvi_steps *steps, const slv_env *env, const char *what, uint64_t count);
void slvi_steps_end(slvi_steps *steps);

/* The same for one thread, with the total known: SLV_OK or SLV_ERROR_CANCELLED, logged. */
slv_result slvi_progress(const slv_progress *progress, const slv_env *env, const char *what,
                         uint64_t done, uint64_t total);

/* Asks `progress`, which it points at, whether to go on, and never says how far work is: where
 * nobody knows yet how much lies behind it. */
slv_progress slvi_progress_asking(slv_progress *progress);

#endif
