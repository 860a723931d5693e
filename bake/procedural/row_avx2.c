/* Rows of patterns for processors with AVX2. */
#define SLVI_VARIANT_NAME avx2
#define LANES 8
#include "procedural/row_template.h"
