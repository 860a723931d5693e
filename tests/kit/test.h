/* The smallest test kit that ctest needs: CHECK counts, a failing check says where, and main
 * returns the verdict. */
#ifndef SLV_TEST_H
#define SLV_TEST_H

#include <selvage/result.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>
#include <unistd.h>

/* Sanitizers are slow: long tests do less of the same under them. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TEST_SANITIZED 1
#else
#define TEST_SANITIZED 0
#endif

/* `make test` is short: of random cases and of products of many cases it takes a part, by which
 * each kind of case is met. SELVAGE_TEST_EFFORT=1 takes all, as continuous integration does, and 10
 * ten times as many random ones, for a night. */
static inline bool test_brief(void) {
    return !getenv("SELVAGE_TEST_EFFORT");
}

/* Whether case `i` is left out of a short run, which takes every nth. */
static inline bool test_skip(uint32_t i, uint32_t every) {
    return test_brief() && i % every != 0;
}

static inline uint32_t test_effort(uint32_t count) {
    if (test_brief())
        return (count + 2) / 3;
    unsigned long times = strtoul(getenv("SELVAGE_TEST_EFFORT"), NULL, 10);
    return count * (uint32_t)(times ? times : 1);
}

/* Where tests make their folders: what is flushed to a disk takes as long as the disk likes, so in
 * memory where there is a good deal, unless $TMPDIR says otherwise. */
static inline const char *test_parent(void) {
    const char *given = getenv("TMPDIR");
    struct statvfs room;
    if (given && *given)
        return given;
    return statvfs("/dev/shm", &room) == 0 && access("/dev/shm", W_OK | X_OK) == 0 &&
                   (uint64_t)room.f_bavail * room.f_frsize >= UINT64_C(1) << 30
               ? "/dev/shm"
               : "/tmp";
}

static int test_checks, test_failures;
static char test_last_log[1024]; /* the newest message of the library */

#define CHECK(condition) CHECK_MSG(condition, "%s", #condition)
#define CHECK_MSG(condition, ...)                                                                  \
    do {                                                                                           \
        test_checks++;                                                                             \
        if (!(condition)) {                                                                        \
            test_failures++;                                                                       \
            if (test_failures <= 20) {                                                             \
                fprintf(stderr, "%s:%d: failed: ", __FILE__, __LINE__);                            \
                fprintf(stderr, __VA_ARGS__);                                                      \
                fputc('\n', stderr);                                                               \
            }                                                                                      \
        }                                                                                          \
    } while (0)
/* For what must hold before the test can go on. */
#define REQUIRE(condition)                                                                         \
    do {                                                                                           \
        int failures_before_ = test_failures;                                                      \
        CHECK(condition);                                                                          \
        if (test_failures != failures_before_) {                                                   \
            fprintf(stderr, "last message: %s\n", test_last_log);                                  \
            exit(1);                                                                               \
        }                                                                                          \
    } while (0)

static void test_log(void *user, slv_log_level level, const char *message) {
    (void)user;
    (void)level;
    snprintf(test_last_log, sizeof test_last_log, "%s", message);
}

static inline slv_env test_env(void) {
    slv_env env = {.log = test_log};
    return env;
}

/* For a call that may fail or not. */
static inline void test_ignore(slv_result result) {
    (void)result;
}

/* A small generator with a fixed seed, so that every run sees the same cases. */
static inline uint32_t test_random(uint64_t *state) {
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(*state >> 33);
}

static inline int test_end(void) {
    fprintf(stderr, "%d checks, %d failures\n", test_checks, test_failures);
    return test_failures || !test_checks ? 1 : 0;
}

#endif
