/* Rows of patterns for processors with AVX-512. */
#define SLVI_VARIANT_NAME avx512
#define LANES 16
#include "procedural/row_template.h"
