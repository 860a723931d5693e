/* IEEE 754 binary16 ("half") conversion. */
#ifndef SELVAGE_HALF_H
#define SELVAGE_HALF_H

#include <selvage/result.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Exact for every half, NaN payloads included. */
SLV_API float slv_half_to_float(uint16_t half);

/* Rounds half up in magnitude (not to even), as .ptx writers do: too large becomes infinity, -0
 * becomes 0, below 2^-14 is rounded to a multiple of 2^-24. Of a NaN the top ten
 * mantissa bits are kept; where those are zero it becomes infinity, as there. */
SLV_API uint16_t slv_half_from_float(float value);

#ifdef __cplusplus
}
#endif

#endif
