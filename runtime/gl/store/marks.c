/* Lists without duplicates. */
#include "gl/store/marks.h"

#include "base/memory.h"

#include <string.h>

slv_result slvi_gl_marks_begin(const slv_env *env, uint32_t count, slv_gl_marks *marks) {
    slv_result result =
        slvi_alloc(env, "stale items", count, sizeof *marks->listed, &marks->listed);
    return result ? result : slvi_alloc(env, "stale items", count, 1, &marks->is_listed);
}

void slvi_gl_marks_add(slv_gl_marks *marks, uint32_t number) {
    if (!marks->is_listed[number])
        marks->listed[marks->count++] = number;
    marks->is_listed[number] = true;
}

void slvi_gl_marks_clear(slv_gl_marks *marks) {
    for (uint32_t i = 0; i < marks->count; i++)
        marks->is_listed[marks->listed[i]] = false;
    marks->count = 0;
}

void slvi_gl_marks_end(slv_gl_marks *marks) {
    slvi_free(marks->listed);
    slvi_free(marks->is_listed);
    memset(marks, 0, sizeof *marks);
}
