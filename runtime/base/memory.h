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
/* An environment whose allocations together keep within max_bytes, those that are given back not
 * counted: for all that one object holds, and what it takes to make it. Of an environment that is
 * such a one already it is part. It is ended when no more is to be allocated but by objects that
 * were allocated from it themselves; what was allocated may stay. Without memory for the counter
 * the first allocation fails. The end passes on what the object's maker returned. */
slv_env slvi_budget_begin(const slv_env *env);
slv_result slvi_budget_end(slv_env *env, slv_result result);
/* Releases any of these; NULL is fine. What a public function hands out goes back through slv_free.
 */
void slvi_free(void *memory);

#endif
