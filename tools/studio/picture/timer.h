/* What a picture takes: of this thread, and of the GPU. Called with the context current. */
#ifndef SELVAGE_STUDIO_TIMER_H
#define SELVAGE_STUDIO_TIMER_H

#include <stdbool.h>

typedef struct studio_timer {
    unsigned queries[2]; /* when it began and ended; 0: none has yet */
    bool counts;         /* the driver has timers */
    double began, cpu;   /* seconds of this thread */
} studio_timer;

void studio_timer_begin(studio_timer *timer);
void studio_timer_end(studio_timer *timer);
void studio_timer_free(studio_timer *timer);
/* Of the last picture, which is waited for; `gpu` is below zero where the driver has no timers. */
void studio_timer_read(const studio_timer *timer, double *cpu, double *gpu);

#endif
