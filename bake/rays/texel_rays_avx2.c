/* Rays of texels for processors with AVX2. */
#define SLVI_VARIANT_NAME avx2
#include "rays/texel_rays_template.h"
