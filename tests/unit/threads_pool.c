/* A pool of threads in the environment: the same bytes as without one, for calls within calls and
 * for many callers at once, and no signal that is the host's. */
#include "kit/calls_kit.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/stat.h>

enum { CALLERS = 6, ROUNDS = 4 };

static slv_env pooled; /* an environment with the pool */
static unsigned char *plain;
static size_t plain_size;

static unsigned char *read_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    struct stat status;
    REQUIRE(file && fstat(fileno(file), &status) == 0);
    unsigned char *bytes = malloc((size_t)status.st_size);
    REQUIRE(bytes && fread(bytes, 1, (size_t)status.st_size, file) == (size_t)status.st_size);
    fclose(file);
    *size = (size_t)status.st_size;
    return bytes;
}

/* For threads, which the counters of CHECK and REQUIRE are not for. */
static void need(bool good) {
    if (!good) {
        fputs("a call on a thread failed\n", stderr);
        abort();
    }
}

/* Reads the texture and writes it again. */
static void copy(const slv_env *env, const char *path) {
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL;
    need(!slv_ptx_open(env, calls.ptx, &ptx));
    need(!slv_ptx_load_texture(env, ptx, &texture));
    need(!slv_ptx_save(env, path, texture, calls.adjacency, NULL));
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
}

static void check_copy(const slv_env *env, const char *path) {
    size_t size;
    copy(env, path);
    unsigned char *bytes = read_file(path, &size);
    CHECK(size == plain_size && !memcmp(bytes, plain, size));
    free(bytes);
}

static void *caller(void *user) {
    const char *path = user;
    for (int i = 0; i < ROUNDS; i++) {
        slv_levels *levels = NULL;
        copy(&pooled, path);
        need(!slv_levels_create(&pooled, calls.texture, &levels));
        slv_levels_destroy(levels);
    }
    return NULL;
}

static void check_callers(void) {
    static char paths[CALLERS][256];
    pthread_t threads[CALLERS];
    for (int i = 0; i < CALLERS; i++) {
        snprintf(paths[i], sizeof paths[i], "%s/caller%d.ptx", calls.folder, i);
        REQUIRE(pthread_create(&threads[i], NULL, caller, paths[i]) == 0);
    }
    for (int i = 0; i < CALLERS; i++) {
        size_t size;
        REQUIRE(pthread_join(threads[i], NULL) == 0);
        unsigned char *bytes = read_file(paths[i], &size);
        CHECK(size == plain_size && !memcmp(bytes, plain, size));
        free(bytes);
    }
}

/* On a thread of the pool, a call that wants the pool. */
static slv_result nested(void *user, const slv_env *env, uint32_t face, const slv_ptx_face *info,
                         void *texels) {
    slv_levels *levels = NULL;
    (void)user, (void)env, (void)face, (void)info, (void)texels;
    slv_result result = slv_levels_create(&pooled, calls.texture, &levels);
    slv_levels_destroy(levels);
    return result;
}

static void check_nested(void) {
    slv_ptx *ptx = NULL;
    REQUIRE(!slv_ptx_open(&pooled, calls.ptx, &ptx));
    for (int i = 0; i < 20; i++)
        CHECK(!slv_ptx_visit_faces(&pooled, ptx, nested, NULL));
    slv_ptx_close(ptx);
}

static pthread_t host;
static atomic_uint others;

static slv_result look_at_signals(void *user, const slv_env *env, uint32_t face,
                                  const slv_ptx_face *info, void *texels) {
    sigset_t held;
    (void)user, (void)env, (void)face, (void)info, (void)texels;
    pthread_sigmask(SIG_SETMASK, NULL, &held);
    if (!pthread_equal(pthread_self(), host)) {
        need(sigismember(&held, SIGTERM) == 1 && sigismember(&held, SIGINT) == 1 &&
             sigismember(&held, SIGSEGV) == 0);
        atomic_fetch_add(&others, 1);
    }
    return SLV_OK;
}

/* A signal that the host's thread holds back waits, however many threads there are: those of the
 * pool (which is there), of a call and of a cache. */
static void check_signals(void) {
    slv_env four = test_env();
    slv_ptx *ptx = NULL;
    slv_cache *cache = NULL;
    slv_file_id file;
    sigset_t term, before, waiting;
    four.threads = 4;
    host = pthread_self();
    REQUIRE(!slv_ptx_open(&four, calls.ptx, &ptx));
    for (int i = 0; i < 1000 && !atomic_load(&others); i++)
        CHECK(!slv_ptx_visit_faces(&four, ptx, look_at_signals, NULL));
    CHECK(atomic_load(&others) > 0);
    slv_ptx_close(ptx);

    REQUIRE(!slv_cache_create(&four, NULL, &cache) && !slv_cache_open(cache, calls.ptx, &file));
    CHECK(!slv_cache_prefetch(cache, file, 0));
    sigemptyset(&term);
    sigaddset(&term, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &term, &before);
    CHECK(kill(getpid(), SIGTERM) == 0 && sigpending(&waiting) == 0 &&
          sigismember(&waiting, SIGTERM) == 1);
    sigwait(&term, &(int){0});
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    slv_cache_destroy(cache);
}

/* An executor of somebody else's, that takes the parts from last to first. */
static unsigned executed;

static void backwards(void *user, uint32_t count, void (*task)(void *argument, uint32_t index),
                      void *argument) {
    CHECK(user == &executed);
    while (count--)
        task(argument, count);
    executed++;
}

int main(void) {
    slv_threads *threads = NULL;
    slv_env single = test_env(), own = test_env();
    single.threads = 1;
    calls_begin();
    calls_path("plain.ptx");
    copy(&single, calls.out);
    plain = read_file(calls.out, &plain_size);

    pooled = test_env();
    pooled.threads = 4;
    REQUIRE(!slv_threads_create(&pooled, &threads));
    slv_threads_use(threads, &pooled);
    CHECK(pooled.execute && pooled.threads == 4);
    check_copy(&pooled, calls_path("pooled.ptx"));
    check_nested();
    check_callers();
    check_signals();
    slv_threads_destroy(threads);
    slv_threads_destroy(NULL);

    own.threads = 3;
    own.execute = backwards;
    own.execute_user = &executed;
    check_copy(&own, calls_path("own.ptx"));
    CHECK(executed > 0);

    /* one thread is the caller's own */
    slv_env alone = {.threads = 1};
    REQUIRE(!slv_threads_create(&alone, &threads));
    slv_threads_use(threads, &alone);
    check_copy(&alone, calls_path("alone.ptx"));
    slv_threads_destroy(threads);
    free(plain);
    calls_end();
    return test_end();
}
