/* Intervals of medians from order statistics. */
#include "compare/engine/interval.h"

#include <math.h>
#include <stdlib.h>

/* The probability that exactly `k` of `count` values lie below the true median. */
static double chance(uint32_t count, uint32_t k) {
    return exp(lgamma(count + 1.0) - lgamma(k + 1.0) - lgamma(count - k + 1.0) - count * log(2.0));
}

/* How many values to leave out at either end, and the probability that the median is among them. */
static uint32_t trimmed(uint32_t count, double *missed) {
    uint32_t trim = 0;
    *missed = 2 * chance(count, 0);
    while (2 * (trim + 1) < count) {
        double more = *missed + 2 * chance(count, trim + 1);
        if (more > 0.05)
            break;
        *missed = more;
        trim++;
    }
    return trim;
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

interval interval_of(double *values, uint32_t count) {
    double missed;
    uint32_t trim = trimmed(count, &missed), half = count / 2;
    qsort(values, count, sizeof *values, by_value);
    return (interval){.median = count % 2 ? values[half] : (values[half - 1] + values[half]) / 2,
                      .low = values[trim],
                      .high = values[count - 1 - trim]};
}

double interval_coverage(uint32_t count) {
    double missed;
    trimmed(count, &missed);
    return fmax(0, 1 - missed);
}
