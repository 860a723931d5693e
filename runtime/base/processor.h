/* What processors can do beyond what all of their kind can; the conditions for code that is
 * compiled for some of them. A list of kinds, the best first, becomes a choice where each is
 * `slvi_has_KIND() ? what is for it :`, as SLVI_FILTER_PROCESSORS in filter/sampler.c. */
#ifndef SLV_BASE_PROCESSOR_H
#define SLV_BASE_PROCESSOR_H

#include <stdbool.h>

#ifdef SLV_HAVE_AVX2
static inline bool slvi_has_avx2(void) {
    /* no processor has these without F16C, which not all compilers can ask for */
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2");
}
#endif

static inline bool slvi_has_portable(void) {
    return true;
}

#endif
