/* Allocation through the caller's hooks. In front of what is handed out lies how to give it back,
 * so that whoever releases memory needs to know neither the environment nor who allocated it. */
#include "base/memory.h"

#include "base/log.h"

#include <stdlib.h>
#include <string.h>

#define MALLOC_ALIGNMENT 16

/* What precedes every piece of memory; a multiple of malloc's alignment. */
typedef struct header {
    void (*release)(void *user, void *memory);
    void *user;
    void *start; /* what the hook gave */
    uint64_t size;
} header;

_Static_assert(sizeof(header) % MALLOC_ALIGNMENT == 0, "memory stays aligned behind its header");

static header *header_of(void *memory) {
    return (header *)memory - 1;
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
    if (known.allocate)
        start = known.allocate(known.memory_user, (size_t)(room + bytes));
    else if (zeroed)
        start = calloc(1, (size_t)(room + bytes));
    else
        start = malloc((size_t)(room + bytes));
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
        (header){known.allocate ? known.release : NULL, known.memory_user, start, bytes};
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
    header *head = header_of(memory);
    if (head->release)
        head->release(head->user, head->start);
    else
        free(head->start);
}
