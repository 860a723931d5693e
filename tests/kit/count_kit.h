/* How often is allocated, counted by an environment's hooks. */
#ifndef SLV_TEST_COUNT_KIT_H
#define SLV_TEST_COUNT_KIT_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>

static atomic_ulong allocations;

static inline void *count_allocation(void *user, size_t bytes) {
    (void)user;
    atomic_fetch_add(&allocations, 1);
    return malloc(bytes);
}

static inline void count_release(void *user, void *memory) {
    (void)user;
    free(memory);
}

#endif
