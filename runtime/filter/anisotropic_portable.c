/* The anisotropic filter for any processor. */
#define SLVI_VARIANT_NAME portable
#include "filter/anisotropic_template.h"
