/* Rays of texels for any processor. */
#define SLVI_VARIANT_NAME portable
#include "rays/texel_rays_template.h"
