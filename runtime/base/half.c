/* Half floats to floats and back, rounded half up in magnitude. */
#include "base/half.h"

#include <selvage/half.h>

float slv_half_to_float(uint16_t half) {
    return slvi_half_to_float(half);
}

uint16_t slv_half_from_float(float value) {
    return slvi_half_from_float(value);
}
