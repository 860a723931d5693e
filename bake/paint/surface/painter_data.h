/* Inside an slv_painter: the memory that dabs are made in. */
#ifndef SLV_PAINT_PAINTER_DATA_H
#define SLV_PAINT_PAINTER_DATA_H

#include "surface/surface_data.h"

/* What is known of a vertex, if `round` is that of the painter. */
typedef struct slvi_front_vertex {
    double distance; /* along the surface */
    float x, y;      /* in the plane into which the surface around the dab's middle is unfolded */
    uint32_t round;
} slvi_front_vertex;

/* A crossing that is to be made: over an edge of a triangle, the nearest first. */
typedef struct slvi_crossing {
    float key;
    uint32_t side; /* 4 * the triangle + its edge */
} slvi_crossing;

/* A face under a dab, and which of the touched cells lie in it. */
typedef struct slvi_part {
    uint32_t first, count; /* of the triangles */
    uint64_t texel;        /* where its coverage begins */
} slvi_part;

struct slv_painter {
    slv_env env;
    const slv_paint_surface *surface;
    slvi_front_vertex *vertices;
    uint32_t *tri_round; /* per triangle: the round in which it was touched */
    uint32_t round;
    slvi_crossing *heap;
    uint32_t nheap;
    uint64_t heap_room;
    uint32_t *touched; /* triangles */
    uint32_t ntouched;
    uint64_t touched_room;
    slv_patch *patches;
    slvi_part *parts;
    uint64_t patch_room;
    float *coverage;
    uint64_t coverage_room;
    float *texels; /* what is read of a canvas, and mixed */
    uint64_t texel_room;
    double *sums; /* of patches, for means; and where their texels begin */
    uint64_t sum_room;
};

/* Makes room for `count` elements, and for more than that, so that it is seldom asked again. */
slv_result slvi_painter_room(slv_painter *p, uint64_t count, uint64_t size, void *memory,
                             uint64_t *room);

/* How far a dab may reach into a face; `user` knows the dab. */
typedef struct slvi_reach {
    float least;        /* anywhere */
    const slv_res *res; /* NULL: the same everywhere */
} slvi_reach;
float slvi_reach_into(const slv_painter *p, const slvi_reach *reach, uint32_t face);

/* Spreads from a place until all that is nearer than `reach` has been touched: distances and places
 * of vertices, and p->touched, of which none need be as near as that. */
slv_result slvi_painter_spread(slv_painter *p, slv_surface_point from, const float axis[3],
                               const slvi_reach *reach);

/* Sorts numbers, without memory of its own. */
void slvi_sort_numbers(uint32_t *list, uint32_t count);

/* The longer side of a face's texels. */
static inline float slvi_texel_length(const slv_paint_surface *s, uint32_t face, slv_res res) {
    const float *sides = s->sides + 3 * (size_t)face;
    return fmaxf(ldexpf(sides[0], -res.u), ldexpf(sides[1], -res.v));
}

#endif
