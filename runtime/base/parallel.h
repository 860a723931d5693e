/* Work shared out over threads. */
#ifndef SLV_BASE_PARALLEL_H
#define SLV_BASE_PARALLEL_H

#include <selvage/result.h>

#include <pthread.h>

/* Handles the items first..end-1. A result other than SLV_OK stops the handing out of further
 * ranges. */
typedef slv_result (*slv_range_fn)(void *user, uint64_t first, uint64_t end);

/* Calls `fn` on ranges of at most `grain` items that cover 0..count-1 once each, on env->threads
 * threads, the caller's among them. The ranges are the same for any number of threads. Returns the
 * error of the lowest failing range that ran, or SLV_OK. Inside, env's log is called by one thread
 * at a time only if `fn` logs through slv_parallel_env. */
slv_result slvi_parallel_for(const slv_env *env, uint64_t count, uint64_t grain, slv_range_fn fn,
                             void *user);

/* A copy of env whose log is serialised with a mutex, for use in `fn`. Valid until
 * slvi_parallel_env_end. */
typedef struct slv_parallel_log slv_parallel_log;
slv_result slvi_parallel_env_begin(const slv_env *env, slv_parallel_log **state, slv_env *out);
void slvi_parallel_env_end(slv_parallel_log *state);

uint32_t slvi_thread_count(const slv_env *env);

/* pthread_create for a thread that takes no signals but those that it causes itself: what the host
 * does with signals, or holds back for a while, is its own threads' matter. */
int slvi_thread_start(pthread_t *thread, void *(*run)(void *user), void *user);

#endif
