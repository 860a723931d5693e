/* Sums along lines for any processor. */
#include "uv/lines.h"

#include <string.h>

#define SLVI_VARIANT_NAME portable
#define LANES 4

/* What lies between two pixels and the two below them. */
static inline __attribute__((always_inline)) void between_rows(const char *above, const char *below,
                                                               float fraction, uv_pixel *left,
                                                               uv_pixel *right) {
    const uv_pixel *upper = (const uv_pixel *)above, *lower = (const uv_pixel *)below;
    *left = upper[0] - (upper[0] - lower[0]) * fraction;
    *right = upper[1] - (upper[1] - lower[1]) * fraction;
}

#include "uv/lines_template.h"
