/* Numbers below a bound that are listed once each. */
#ifndef SLV_GL_MARKS_H
#define SLV_GL_MARKS_H

#include <selvage/result.h>

typedef struct slv_gl_marks {
    uint32_t *listed, count;
    uint8_t *is_listed; /* per number */
} slv_gl_marks;

/* For numbers 0..count-1. Ended also if it fails; ending zeroes is fine. */
slv_result slvi_gl_marks_begin(const slv_env *env, uint32_t count, slv_gl_marks *marks);
void slvi_gl_marks_add(slv_gl_marks *marks, uint32_t number);
void slvi_gl_marks_clear(slv_gl_marks *marks);
void slvi_gl_marks_end(slv_gl_marks *marks);

#endif
