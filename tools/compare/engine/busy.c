/* What other programs took of the processors, from /proc/stat and this process's own times. */
#include "compare/engine/busy.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

bool busy_parse(const char *text, double *ticks) {
    /* user nice system idle iowait irq softirq steal; guests are in user already */
    unsigned long long t[8] = {0};
    int count = sscanf(text, "cpu %llu %llu %llu %llu %llu %llu %llu %llu", &t[0], &t[1], &t[2],
                       &t[3], &t[4], &t[5], &t[6], &t[7]);
    *ticks =
        (double)t[0] + (double)t[1] + (double)t[2] + (double)t[5] + (double)t[6] + (double)t[7];
    return count >= 4;
}

static double seconds_of(struct timeval time) {
    return (double)time.tv_sec + (double)time.tv_usec * 1e-6;
}

busy_sample busy_now(void) {
    char line[512] = "";
    double ticks = 0;
    struct timespec clock;
    struct rusage own;
    FILE *stream = fopen("/proc/stat", "re");
    bool known = stream && fgets(line, sizeof line, stream) && busy_parse(line, &ticks);
    if (stream)
        fclose(stream);
    clock_gettime(CLOCK_MONOTONIC, &clock);
    getrusage(RUSAGE_SELF, &own);
    return (busy_sample){.clock = (double)clock.tv_sec + (double)clock.tv_nsec * 1e-9,
                         .all = known ? ticks / (double)sysconf(_SC_CLK_TCK) : (double)NAN,
                         .own = seconds_of(own.ru_utime) + seconds_of(own.ru_stime)};
}

double busy_others(const busy_sample *from, const busy_sample *to) {
    double spent = to->clock - from->clock, others = (to->all - from->all) - (to->own - from->own);
    return spent > 0 && others > 0 ? others / spent : 0; /* NaN is not above 0 */
}
