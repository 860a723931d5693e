/* Pages that many items share: which class's cells lie where on which page of which array. */
#ifndef SLV_GL_SHEETS_H
#define SLV_GL_SHEETS_H

#include "gl/store/pools.h"

/* Cells of one class, side by side in rows. */
typedef struct slv_gl_grid {
    uint32_t class, columns, rows;
    uint32_t sheet, page, x, y;
} slv_gl_grid;

typedef struct slv_gl_plan {
    slv_gl_grid *grids; /* those of a class one after the other */
    uint32_t count, capacity;
} slv_gl_plan;

/* Items of a class, and the pool that a class has by itself, whose `columns` are set where its
 * items go on pages. */
typedef struct slv_gl_class {
    slv_gl_pool pool;
    uint32_t count;
} slv_gl_class;

/* Adds the sheets to `pools`. *out is to be freed on failure too. */
slv_result slvi_gl_sheets_plan(const slv_gl_source *source, slv_gl_class *classes,
                               uint32_t nclasses, slv_gl_pools *pools, slv_gl_plan *out);
void slvi_gl_plan_free(slv_gl_plan *plan);

#endif
