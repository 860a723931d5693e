/* Sums along lines for processors with AVX2. */
#include "uv/lines.h"

#include <string.h>

#define SLVI_VARIANT_NAME avx2
#define LANES 8

typedef float eight __attribute__((vector_size(32)));

/* What lies between two pixels and the two below them. */
static inline __attribute__((always_inline)) void between_rows(const char *above, const char *below,
                                                               float fraction, uv_pixel *left,
                                                               uv_pixel *right) {
    eight upper, lower;
    memcpy(&upper, above, sizeof upper);
    memcpy(&lower, below, sizeof lower);
    const eight both = upper - (upper - lower) * fraction;
    *left = __builtin_shufflevector(both, both, 0, 1, 2, 3);
    *right = __builtin_shufflevector(both, both, 4, 5, 6, 7);
}

#include "uv/lines_template.h"
