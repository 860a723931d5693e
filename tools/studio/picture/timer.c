/* Times of the processor and the GPU, side by side. */
#include "studio/picture/timer.h"

#include <epoxy/gl.h>
#include <time.h>

static double thread_time(void) {
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return (double)time.tv_sec + (double)time.tv_nsec * 1e-9;
}

void studio_timer_begin(studio_timer *t) {
    if (!t->queries[0]) {
        GLint bits = 0;
        glGetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
        t->counts = bits > 0;
        glCreateQueries(GL_TIMESTAMP, 2, t->queries);
    }
    glQueryCounter(t->queries[0], GL_TIMESTAMP);
    t->began = thread_time();
}

void studio_timer_end(studio_timer *t) {
    glQueryCounter(t->queries[1], GL_TIMESTAMP);
    t->cpu = thread_time() - t->began;
}

void studio_timer_free(studio_timer *t) {
    glDeleteQueries(2, t->queries);
    *t = (studio_timer){0};
}

void studio_timer_read(const studio_timer *t, double *cpu, double *gpu) {
    GLuint64 at[2] = {0};
    *cpu = t->cpu;
    *gpu = -1;
    if (!t->counts)
        return;
    for (int i = 0; i < 2; i++)
        glGetQueryObjectui64v(t->queries[i], GL_QUERY_RESULT, &at[i]);
    *gpu = (double)(at[1] - at[0]) * 1e-9;
}
