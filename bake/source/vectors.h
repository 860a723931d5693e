/* Vectors of three floats. */
#ifndef SLV_BAKE_VECTORS_H
#define SLV_BAKE_VECTORS_H

#include <math.h>

static inline float slvi_dot(const float *a, const float *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void slvi_normalise(float v[3]) {
    float length = sqrtf(slvi_dot(v, v));
    for (int k = 0; k < 3; k++)
        v[k] = length > 0 ? v[k] / length : 0;
}

#endif
