/* How a reference closes in on its limit as samples are added. */
#ifndef SELVAGE_TOOLS_CONVERGENCE_H
#define SELVAGE_TOOLS_CONVERGENCE_H

#include "command/cli.h"

#include <selvage/reference.h>

enum { CONVERGENCE_MAX = 11 };

typedef struct convergence_row {
    uint32_t samples;
    double seconds;
    double estimate; /* the picture's own, RMS; NaN with one sample */
    double measured; /* RMS of the difference to the last picture; NaN for that one */
} convergence_row;

typedef struct convergence {
    convergence_row rows[CONVERGENCE_MAX];
    uint32_t count;
} convergence;

/* The numbers of samples: 1, 4, 16, ... below `samples`, and that. */
convergence convergence_begin(uint32_t samples);
/* Root of the mean square over pixels and RGB; the pictures have one size. */
double convergence_distance(const slv_image *a, const slv_image *b);
/* The power of 1/N by which the estimated error falls, by least squares of logarithms; NaN if fewer
 * than two are known. */
double convergence_order(const convergence *c);

/* convergence.csv and convergence.svg. */
slv_result convergence_write(const slv_env *env, const char *folder, const convergence *c);

#endif
