/* The anisotropic filter for processors with AVX2 and BMI2. */
#define SLVI_VARIANT_NAME avx2
#include "filter/anisotropic_template.h"
