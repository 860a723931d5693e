/* Things that threads take for a while and give back: whoever comes next has what was used last. */
#ifndef SLV_BASE_IDLE_H
#define SLV_BASE_IDLE_H

#include <pthread.h>
#include <stddef.h>

/* What such a thing begins with. */
typedef struct slvi_idle_link {
    struct slvi_idle_link *next;
} slvi_idle_link;

typedef struct slvi_idle {
    pthread_mutex_t lock;
    slvi_idle_link *first;
} slvi_idle;

static inline void slvi_idle_begin(slvi_idle *idle) {
    pthread_mutex_init(&idle->lock, NULL);
    idle->first = NULL;
}

/* NULL if there is none: who takes makes one then. */
static inline void *slvi_idle_take(slvi_idle *idle) {
    pthread_mutex_lock(&idle->lock);
    slvi_idle_link *link = idle->first;
    if (link)
        idle->first = link->next;
    pthread_mutex_unlock(&idle->lock);
    return link;
}

static inline void slvi_idle_give(slvi_idle *idle, void *thing) {
    slvi_idle_link *link = thing;
    pthread_mutex_lock(&idle->lock);
    link->next = idle->first;
    idle->first = link;
    pthread_mutex_unlock(&idle->lock);
}

/* Once all were taken to be released. */
static inline void slvi_idle_end(slvi_idle *idle) {
    pthread_mutex_destroy(&idle->lock);
}

#endif
