/* Allocation through the caller's hooks. In front of what is handed out lies how to give it back,
 * so that whoever releases memory needs to know neither the environment nor who allocated it. */
#include "base/memory.h"

#include "base/log.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#define MALLOC_ALIGNMENT 16
#define LARGE_PAGE (UINT64_C(2) << 20)

/* What the pieces of one object's memory add up to. It lives as long as any of them. */
typedef struct budget {
    _Atomic(uint64_t) used, holders;
} budget;

/* What precedes every piece of memory; a multiple of malloc's alignment. */
typedef struct header {
    _Alignas(MALLOC_ALIGNMENT) void (*release)(void *user, void *memory);
    void *user;
    void *start; /* what the hook gave */
    uint64_t size;
    budget *from; /* or NULL */
} header;

_Static_assert(sizeof(header) % MALLOC_ALIGNMENT == 0, "memory stays aligned behind its header");

static header *header_of(void *memory) {
    return (header *)memory - 1;
}

/* In place of a budget that there was no memory for. */
#define NO_BUDGET 1

/* Which of its reserved words an environment keeps it in. */
static budget *budget_of(const slv_env *env) {
    uint64_t word = env->reserved[0];
    return word == NO_BUDGET ? NULL : (budget *)(uintptr_t)word;
}

static void let_go(budget *from, uint64_t bytes) {
    atomic_fetch_sub_explicit(&from->used, bytes, memory_order_relaxed);
    if (atomic_fetch_sub_explicit(&from->holders, 1, memory_order_acq_rel) == 1)
        slvi_free(from);
}

static bool take(budget *from, uint64_t bytes, uint64_t limit) {
    uint64_t used = atomic_fetch_add_explicit(&from->used, bytes, memory_order_relaxed);
    atomic_fetch_add_explicit(&from->holders, 1, memory_order_relaxed);
    if (used <= limit && bytes <= limit - used)
        return true;
    let_go(from, bytes);
    return false;
}

slv_env slvi_budget_begin(const slv_env *env) {
    slv_env own = slvi_env_or_default(env), quiet = own;
    budget *made = budget_of(&own);
    if (made) {
        atomic_fetch_add_explicit(&made->holders, 1, memory_order_relaxed);
        return own;
    }
    quiet.log = NULL; /* it is told by the first allocation */
    if (own.reserved[0] == NO_BUDGET || slvi_alloc(&quiet, "memory", 1, sizeof *made, &made)) {
        own.reserved[0] = NO_BUDGET;
        return own;
    }
    atomic_init(&made->used, 0);
    atomic_init(&made->holders, 1);
    own.reserved[0] = (uint64_t)(uintptr_t)made;
    return own;
}

slv_result slvi_budget_end(slv_env *env, slv_result result) {
    budget *from = budget_of(env);
    env->reserved[0] = 0;
    if (from)
        let_go(from, 0);
    return result;
}

/* Asks for large pages where all of a large piece is about to be written: with small ones most of
 * the time of filling it can be the system's. */
static void expect_filling(unsigned char *start, uint64_t bytes) {
#ifdef MADV_HUGEPAGE
    uint64_t before = (LARGE_PAGE - (uintptr_t)start % LARGE_PAGE) % LARGE_PAGE;
    if (start && bytes >= 4 * LARGE_PAGE)
        (void)madvise(start + before, (size_t)((bytes - before) / LARGE_PAGE * LARGE_PAGE),
                      MADV_HUGEPAGE);
#else
    (void)start;
    (void)bytes;
#endif
}

static slv_result allocate(const slv_env *env, const char *what, uint64_t alignment, uint64_t count,
                           uint64_t size, bool zeroed, void *out) {
    unsigned char *start = NULL;
    void *memory = NULL;
    slv_env known = slvi_env_or_default(env);
    uint64_t room = sizeof(header) + (alignment > MALLOC_ALIGNMENT ? alignment : 0), most;
    memcpy(out, &memory, sizeof memory);
    most = known.max_bytes < SIZE_MAX - room ? known.max_bytes : SIZE_MAX - room;
    if (size && count > most / size)
        return slvi_fail(env, SLV_ERROR_LIMIT, "%s: %llu x %llu bytes is over the limit of %llu",
                         what, (unsigned long long)count, (unsigned long long)size,
                         (unsigned long long)most);
    uint64_t bytes = count * size;
    room += bytes == 0; /* who looks for leaks finds no pointer to what lies behind a piece */
    budget *from = budget_of(&known);
    if (known.reserved[0] == NO_BUDGET)
        return slvi_fail(env, SLV_ERROR_MEMORY, "%s: no memory to count what it takes", what);
    if (from && !take(from, bytes, known.max_bytes))
        return slvi_fail(env, SLV_ERROR_LIMIT,
                         "%s: with %llu bytes more it is over the limit of %llu", what,
                         (unsigned long long)bytes, (unsigned long long)known.max_bytes);
    if (known.allocate)
        start = known.allocate(known.memory_user, (size_t)(room + bytes));
    else if (zeroed)
        start = calloc(1, (size_t)(room + bytes));
    else
        expect_filling(start = malloc((size_t)(room + bytes)), room + bytes);
    if (!start && from)
        let_go(from, bytes);
    if (!start)
        return slvi_fail(env, SLV_ERROR_MEMORY, "%s: no memory for %llu bytes", what,
                         (unsigned long long)bytes);
    unsigned char *at = start + sizeof(header);
    if (alignment > MALLOC_ALIGNMENT)
        at += (alignment - (uintptr_t)at % alignment) % alignment;
    if (zeroed && known.allocate)
        memset(at, 0, (size_t)bytes);
    memory = at;
    *header_of(memory) =
        (header){known.allocate ? known.release : NULL, known.memory_user, start, bytes, from};
    memcpy(out, &memory, sizeof memory);
    return SLV_OK;
}

slv_result slvi_alloc(const slv_env *env, const char *what, uint64_t count, uint64_t size,
                      void *out) {
    return allocate(env, what, MALLOC_ALIGNMENT, count, size, true, out);
}

slv_result slvi_alloc_plain(const slv_env *env, const char *what, uint64_t count, uint64_t size,
                            void *out) {
    return allocate(env, what, MALLOC_ALIGNMENT, count, size, false, out);
}

slv_result slvi_alloc_aligned(const slv_env *env, const char *what, uint64_t alignment,
                              uint64_t count, uint64_t size, void *out) {
    return allocate(env, what, alignment, count, size, true, out);
}

slv_result slvi_grow(const slv_env *env, const char *what, uint64_t count, uint64_t size,
                     void *memory) {
    void *before, *after;
    memcpy(&before, memory, sizeof before);
    slv_result result = allocate(env, what, MALLOC_ALIGNMENT, count, size, false, &after);
    if (result)
        return result;
    if (before) {
        uint64_t had = header_of(before)->size, has = header_of(after)->size;
        memcpy(after, before, (size_t)(had < has ? had : has));
        slvi_free(before);
    }
    memcpy(memory, &after, sizeof after);
    return SLV_OK;
}

void slvi_free(void *memory) {
    if (!memory)
        return;
    header head = *header_of(memory);
    if (head.release)
        head.release(head.user, head.start);
    else
        free(head.start);
    if (head.from)
        let_go(head.from, head.size);
}
