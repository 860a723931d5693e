/* Allocation that checks its arithmetic and goes through the caller's hooks. */
#ifndef SLV_BASE_MEMORY_H
#define SLV_BASE_MEMORY_H

#include <selvage/result.h>

/* `count * size` zeroed bytes in *out, aligned as malloc's and released with slvi_free. Overflow or
 * more than env's max_bytes is SLV_ERROR_LIMIT; `what` names the thing in the message. A count of
 * zero gives a valid pointer. */
slv_result slvi_alloc(const slv_env *env, const char *what, uint64_t count, uint64_t size,
                      void *out);
/* The same, not zeroed, for what is filled at once. */
slv_result slvi_alloc_plain(const slv_env *env, const char *what, uint64_t count, uint64_t size,
                            void *out);
/* The same as slvi_alloc, aligned to a power of two of at least 32. */
slv_result slvi_alloc_aligned(const slv_env *env, const char *what, uint64_t alignment,
                              uint64_t count, uint64_t size, void *out);
/* Makes room for `count` elements in *memory (a pointer to NULL, or to memory of this file), whose
 * contents move along; what is new is not zeroed. On failure *memory is as it was. */
slv_result slvi_grow(const slv_env *env, const char *what, uint64_t count, uint64_t size,
                     void *memory);
/* In *out (which may be `env`) an environment whose allocations together keep within max_bytes,
 * those that are given back not counted: for all that one object holds, and what it takes to make
 * it. An environment that is such a one already counts no further for what is made with *out. It is
 * ended when no more is to be allocated, whatever this returns; what was allocated may stay. */
slv_result slvi_budget_begin(const slv_env *env, slv_env *out);
void slvi_budget_end(slv_env *env);
/* Releases any of these; NULL is fine. What a public function hands out goes back through slv_free.
 */
void slvi_free(void *memory);

#endif
