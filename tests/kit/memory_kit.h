/* Memory that is counted and that can run out. */
#ifndef MEMORY_KIT_H
#define MEMORY_KIT_H

#include "kit/test.h"

#include <stdatomic.h>
#include <stddef.h>

typedef struct memory_count {
    atomic_long live, asked;
    long fails; /* at this one, counted from 1; 0: never */
    atomic_uint errors;
    char message[1024];
    atomic_ullong bytes, peak; /* the latter with one thread */
} memory_count;

/* In front of each piece: how large it is. */
#define MEMORY_IN_FRONT sizeof(max_align_t)

static void *memory_allocate(void *user, size_t bytes) {
    memory_count *count = user;
    if (atomic_fetch_add(&count->asked, 1) + 1 == count->fails)
        return NULL;
    unsigned char *memory = malloc(MEMORY_IN_FRONT + bytes);
    if (!memory)
        return NULL;
    memcpy(memory, &bytes, sizeof bytes);
    atomic_fetch_add(&count->live, 1);
    unsigned long long now = atomic_fetch_add(&count->bytes, bytes) + bytes;
    if (now > count->peak)
        count->peak = now;
    return memory + MEMORY_IN_FRONT;
}

static void memory_release(void *user, void *memory) {
    memory_count *count = user;
    unsigned char *start = (unsigned char *)memory - MEMORY_IN_FRONT;
    size_t bytes;
    memcpy(&bytes, start, sizeof bytes);
    atomic_fetch_sub(&count->live, 1);
    atomic_fetch_sub(&count->bytes, bytes);
    free(start);
}

static void memory_log(void *user, slv_log_level level, const char *message) {
    memory_count *count = user;
    if (level != SLV_LOG_ERROR)
        return;
    atomic_fetch_add(&count->errors, 1);
    snprintf(count->message, sizeof count->message, "%s", message);
}

static inline slv_env memory_env(memory_count *count) {
    return (slv_env){.log = memory_log,
                     .log_user = count,
                     .threads = 1,
                     .allocate = memory_allocate,
                     .release = memory_release,
                     .memory_user = count};
}

/* Lets each allocation of a call fail once: that is an error of its own each time, told in one
 * line, and nothing is kept. */
static inline long memory_sweep(const char *name, slv_result (*call)(const slv_env *env),
                                void (*prepare)(void)) {
    memory_count count = {.fails = 0};
    slv_env env = memory_env(&count);
    if (prepare)
        prepare();
    slv_result result = call(&env);
    CHECK_MSG(result == SLV_OK, "%s: %d, %s", name, (int)result, count.message);
    CHECK_MSG(count.live == 0, "%s: %ld pieces of memory are left", name, (long)count.live);
    CHECK_MSG(count.asked > 0, "%s: asks for no memory", name);
    long most = count.asked;
    /* in a short run every so manieth of many */
    const long step = test_brief() ? most / 50 + 1 : 1;
    for (long at = 1; at <= most; at += step) {
        memory_count failing = {.fails = at};
        env = memory_env(&failing);
        if (prepare)
            prepare();
        result = call(&env);
        CHECK_MSG(result == SLV_ERROR_MEMORY, "%s, allocation %ld of %ld: %s, %s", name, at, most,
                  slv_result_string(result), failing.message);
        CHECK_MSG(failing.errors == 1, "%s, allocation %ld of %ld: %u lines, %s", name, at, most,
                  (unsigned)failing.errors, failing.message);
        CHECK_MSG(failing.live == 0, "%s, allocation %ld of %ld: %ld pieces of memory are left",
                  name, at, most, (long)failing.live);
    }
    return most;
}

/* With as much as it takes at its most a call succeeds; with less it is refused, and holds no more
 * than allowed but for what the library puts in front of each piece. */
static inline void memory_within(const char *name, slv_result (*call)(const slv_env *env)) {
    enum { IN_FRONT = 64 };
    memory_count free_of_it = {.fails = 0};
    slv_env env = memory_env(&free_of_it);
    CHECK_MSG(!call(&env), "%s: %s", name, free_of_it.message);
    uint64_t most = free_of_it.peak;
    for (unsigned tenths = 10; tenths > 0; tenths = tenths == 10 ? 9
                                                    : tenths < 2 ? 0
                                                                 : tenths - 2) {
        memory_count count = {.fails = 0};
        env = memory_env(&count);
        env.max_bytes = most * tenths / 10;
        slv_result result = call(&env);
        bool good = tenths == 10 ? !result : result == SLV_ERROR_LIMIT && count.errors == 1;
        CHECK_MSG(good && !count.live, "%s within %u tenths of %llu bytes: %s, %u lines, %s", name,
                  tenths, (unsigned long long)most, slv_result_string(result),
                  (unsigned)count.errors, count.message);
        CHECK_MSG(count.peak <= env.max_bytes + IN_FRONT * (uint64_t)count.asked,
                  "%s within %llu bytes: %llu at its most", name, (unsigned long long)env.max_bytes,
                  (unsigned long long)count.peak);
    }
}

#endif
