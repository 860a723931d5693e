/* How sure a median is: the interval between two of the values that it is the median of. */
#ifndef SELVAGE_TOOLS_INTERVAL_H
#define SELVAGE_TOOLS_INTERVAL_H

#include <stdint.h>

/* A median, and the interval that holds the true one with a probability of interval_coverage. */
typedef struct interval {
    double median, low, high;
} interval;

/* Sorts the values, of which there is at least one. Nothing is assumed about how they are spread:
 * each lies above the true median as likely as below. */
interval interval_of(double *values, uint32_t count);
/* At least 0.95 where there are six values or more; of fewer the interval is all of them. */
double interval_coverage(uint32_t count);

#endif
