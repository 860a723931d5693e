/* Rows of patterns for any processor. */
#define SLVI_VARIANT_NAME portable
#define LANES 4
#include "procedural/row_template.h"
