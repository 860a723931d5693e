/* How much of the processors other programs took, so that a report can say when its times are not
 * to be trusted. */
#ifndef SELVAGE_TOOLS_BUSY_H
#define SELVAGE_TOOLS_BUSY_H

#include <stdbool.h>

/* Seconds so far: of the clock, of all processors, and of this process on them. */
typedef struct busy_sample {
    double clock, all, own;
} busy_sample;

/* Time of processors from the first line of /proc/stat, in ticks; false if it is no such text. */
bool busy_parse(const char *text, double *ticks);
/* `all` is NaN where the system does not say. */
busy_sample busy_now(void);
/* Processors that others took between the two, 1.5 of them for instance; 0 if it is not known. */
double busy_others(const busy_sample *from, const busy_sample *to);

#endif
