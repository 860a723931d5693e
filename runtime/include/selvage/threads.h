/* Threads that wait for work, so that calls need not start their own. */
#ifndef SELVAGE_THREADS_H
#define SELVAGE_THREADS_H

#include <selvage/result.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Put into an environment, any number of threads may use one at once:
 *
 *     slv_threads *threads = NULL;
 *     slv_env env = {0};
 *     if (!slv_threads_create(&env, &threads))
 *         slv_threads_use(threads, &env);
 */
typedef struct slv_threads slv_threads;

/* Starts env->threads threads less one, for the caller's own works too; 0 means one per processor.
 * Fewer if the system gives no more. As all threads that the library starts, they take no signals.
 */
SLV_NODISCARD SLV_API slv_result slv_threads_create(const slv_env *env, slv_threads **out);
/* Waits until they have ended. Environments and objects that use them must not be used after. */
SLV_API void slv_threads_destroy(slv_threads *threads);
/* Sets env's `execute`, and its number of threads if that is 0. */
SLV_API void slv_threads_use(slv_threads *threads, slv_env *env);

#ifdef __cplusplus
}
#endif

#endif
