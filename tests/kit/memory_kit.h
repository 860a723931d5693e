/* Memory that is counted and that can run out. */
#ifndef MEMORY_KIT_H
#define MEMORY_KIT_H

#include "kit/test.h"

#include <stdatomic.h>

typedef struct memory_count {
    atomic_long live, asked;
    long fails; /* at this one, counted from 1; 0: never */
    atomic_uint errors;
    char message[1024];
} memory_count;

static void *memory_allocate(void *user, size_t bytes) {
    memory_count *count = user;
    if (atomic_fetch_add(&count->asked, 1) + 1 == count->fails)
        return NULL;
    void *memory = malloc(bytes);
    if (memory)
        atomic_fetch_add(&count->live, 1);
    return memory;
}

static void memory_release(void *user, void *memory) {
    memory_count *count = user;
    atomic_fetch_sub(&count->live, 1);
    free(memory);
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
    for (long at = 1; at <= most; at++) {
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

#endif
