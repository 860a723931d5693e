/* Lookups for any processor. */
#define SLVI_VARIANT_NAME portable
#include "filter/lookup_template.h"
