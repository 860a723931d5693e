/* Lookups for processors with AVX2 and BMI2. */
#define SLVI_VARIANT_NAME avx2
#include "filter/lookup_template.h"
