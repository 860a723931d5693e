/* Texels and pixels without a value. */
#ifndef SLV_BAKE_HOLES_H
#define SLV_BAKE_HOLES_H

#include <selvage/texture.h>

/* Gives those whose `missed` is not zero the mean of the nearest that have a value, where there are
 * any (pull and push: Gortler et al. 1996, section 3.4.2, with weights of 0 and 1). Rows of `width`
 * of 1 to 4 channels. */
slv_result slvi_holes_fill(const slv_env *env, uint32_t nchannels, uint32_t width, uint32_t height,
                           const uint8_t *missed, float *values);

#endif
