/* A pool of threads behind slv_env's `execute`. Calls put their work into a list; threads, and the
 * callers themselves, take its parts one by one. */
#include "base/memory.h"
#include "base/parallel.h"

#include <selvage/threads.h>

/* Lives on the stack of the call that waits for it. */
struct work {
    void (*task)(void *argument, uint32_t index);
    void *argument;
    uint32_t next, count, running;
    struct work *following;
};

struct slv_threads {
    pthread_mutex_t lock;
    pthread_cond_t arrived, finished;
    struct work *first; /* of those with parts that nobody has taken */
    bool ending;
    uint32_t started;
    pthread_t *threads;
};

static void unlink_work(slv_threads *threads, const struct work *work) {
    struct work **at = &threads->first;
    while (*at && *at != work)
        at = &(*at)->following;
    if (*at)
        *at = work->following;
}

/* Takes one part; called with the lock held, which is open while the part runs. */
static void run_part(slv_threads *threads, struct work *work) {
    uint32_t index = work->next++;
    work->running++;
    if (work->next == work->count)
        unlink_work(threads, work);
    pthread_mutex_unlock(&threads->lock);
    work->task(work->argument, index);
    pthread_mutex_lock(&threads->lock);
    if (--work->running == 0 && work->next == work->count)
        pthread_cond_broadcast(&threads->finished);
}

static void *serve(void *user) {
    slv_threads *threads = user;
    pthread_mutex_lock(&threads->lock);
    while (!threads->ending) {
        if (threads->first)
            run_part(threads, threads->first);
        else
            pthread_cond_wait(&threads->arrived, &threads->lock);
    }
    pthread_mutex_unlock(&threads->lock);
    return NULL;
}

static void execute(void *user, uint32_t count, void (*task)(void *argument, uint32_t index),
                    void *argument) {
    slv_threads *threads = user;
    struct work work = {.task = task, .argument = argument, .count = count};
    if (!count)
        return;
    pthread_mutex_lock(&threads->lock);
    struct work **last = &threads->first;
    while (*last)
        last = &(*last)->following;
    *last = &work;
    pthread_cond_broadcast(&threads->arrived);
    while (work.next < work.count)
        run_part(threads, &work);
    while (work.running)
        pthread_cond_wait(&threads->finished, &threads->lock);
    pthread_mutex_unlock(&threads->lock);
}

slv_result slv_threads_create(const slv_env *env, slv_threads **out) {
    slv_threads *threads = NULL;
    uint32_t wanted = slvi_thread_count(env) - 1;
    *out = NULL;
    slv_result result = slvi_alloc(env, "threads", 1, sizeof *threads, &threads);
    if (result)
        return result;
    if ((result =
             slvi_alloc(env, "threads", wanted, sizeof *threads->threads, &threads->threads))) {
        slvi_free(threads);
        return result;
    }
    pthread_mutex_init(&threads->lock, NULL);
    pthread_cond_init(&threads->arrived, NULL);
    pthread_cond_init(&threads->finished, NULL);
    while (threads->started < wanted &&
           slvi_thread_start(&threads->threads[threads->started], serve, threads) == 0)
        threads->started++;
    *out = threads;
    return SLV_OK;
}

void slv_threads_destroy(slv_threads *threads) {
    if (!threads)
        return;
    pthread_mutex_lock(&threads->lock);
    threads->ending = true;
    pthread_cond_broadcast(&threads->arrived);
    pthread_mutex_unlock(&threads->lock);
    while (threads->started)
        pthread_join(threads->threads[--threads->started], NULL);
    pthread_cond_destroy(&threads->arrived);
    pthread_cond_destroy(&threads->finished);
    pthread_mutex_destroy(&threads->lock);
    slvi_free(threads->threads);
    slvi_free(threads);
}

void slv_threads_use(slv_threads *threads, slv_env *env) {
    env->execute = execute;
    env->execute_user = threads;
    if (!env->threads)
        env->threads = threads->started + 1;
}
