/* Ranges of work over several threads, and a log that they may share. */
#include "base/parallel.h"

#include "base/log.h"
#include "base/memory.h"

#include <signal.h>
#include <unistd.h>

#define MAX_THREADS 256

struct job {
    pthread_mutex_t lock;
    uint64_t next, count, grain;
    slv_range_fn fn;
    void *user;
    uint64_t failed_at;
    slv_result failed;
};

struct slv_parallel_log {
    pthread_mutex_t lock;
    slv_env inner;
};

uint32_t slvi_thread_count(const slv_env *env) {
    uint32_t threads = env ? env->threads : 0;
    if (!threads) {
        long online = sysconf(_SC_NPROCESSORS_ONLN);
        threads = online > 0 ? (uint32_t)online : 1;
    }
    return threads < MAX_THREADS ? threads : MAX_THREADS;
}

int slvi_thread_start(pthread_t *thread, void *(*run)(void *user), void *user) {
    /* of the thread's own doing, or a profiler's */
    static const int own[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGABRT, SIGSYS, SIGPROF};
    sigset_t held, before;
    sigfillset(&held);
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        sigdelset(&held, own[i]);
    pthread_sigmask(SIG_BLOCK, &held, &before);
    int reason = pthread_create(thread, NULL, run, user);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return reason;
}

static void work(void *user, uint32_t worker) {
    (void)worker;
    struct job *job = user;
    for (;;) {
        pthread_mutex_lock(&job->lock);
        uint64_t first = job->next;
        bool done = first >= job->count || job->failed;
        uint64_t left = done ? 0 : job->count - first;
        uint64_t end = first + (left < job->grain ? left : job->grain);
        if (!done)
            job->next = end;
        pthread_mutex_unlock(&job->lock);
        if (done)
            return;
        slv_result result = job->fn(job->user, first, end);
        if (result) {
            pthread_mutex_lock(&job->lock);
            if (!job->failed || first < job->failed_at) {
                job->failed = result;
                job->failed_at = first;
            }
            pthread_mutex_unlock(&job->lock);
        }
    }
}

static void *thread(void *job) {
    work(job, 0);
    return NULL;
}

/* Threads for this call alone. */
static void start_and_join(struct job *job, uint32_t wanted) {
    pthread_t threads[MAX_THREADS];
    uint32_t started = 0;
    while (started + 1 < wanted && slvi_thread_start(&threads[started], thread, job) == 0)
        started++;
    work(job, 0);
    while (started)
        pthread_join(threads[--started], NULL);
}

slv_result slvi_parallel_for(const slv_env *env, uint64_t count, uint64_t grain, slv_range_fn fn,
                             void *user) {
    struct job job = {.count = count, .grain = grain ? grain : 1, .fn = fn, .user = user};
    uint64_t ranges = count / job.grain + (count % job.grain != 0);
    uint32_t wanted = slvi_thread_count(env);
    if (wanted > ranges)
        wanted = (uint32_t)ranges;
    pthread_mutex_init(&job.lock, NULL);
    if (wanted > 1 && env && env->execute)
        env->execute(env->execute_user, wanted, work, &job);
    else
        start_and_join(&job, wanted);
    pthread_mutex_destroy(&job.lock);
    return job.failed;
}

static void locked_log(void *user, slv_log_level level, const char *message) {
    slv_parallel_log *state = user;
    pthread_mutex_lock(&state->lock);
    state->inner.log(state->inner.log_user, level, message);
    pthread_mutex_unlock(&state->lock);
}

slv_result slvi_parallel_env_begin(const slv_env *env, slv_parallel_log **state, slv_env *out) {
    slv_result result = slvi_alloc(env, "log lock", 1, sizeof **state, state);
    if (result)
        return result;
    pthread_mutex_init(&(*state)->lock, NULL);
    (*state)->inner = slvi_env_or_default(env);
    *out = (*state)->inner;
    if (out->log) {
        out->log = locked_log;
        out->log_user = *state;
    }
    return SLV_OK;
}

void slvi_parallel_env_end(slv_parallel_log *state) {
    if (!state)
        return;
    pthread_mutex_destroy(&state->lock);
    slvi_free(state);
}
