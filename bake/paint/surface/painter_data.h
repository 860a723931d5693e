/* Inside an slv_painter: the memory that dabs are made in. */
#ifndef SLV_PAINT_PAINTER_DATA_H
#define SLV_PAINT_PAINTER_DATA_H

#include "surface/surface_data.h"

#include "base/parallel.h"

/* What is known of a vertex, if `round` is that of the painter. */
typedef struct slvi_front_vertex {
    double distance; /* along the surface */
    float x, y;      /* in the plane into which the surface around the dab's middle is unfolded */
    uint32_t round;
} slvi_front_vertex;

/* A crossing that is to be made: into a triangle over one of its edges. */
typedef struct slvi_crossing {
    uint32_t over; /* 4 * the triangle + its edge */
    uint32_t next; /* of the same bucket; SLVI_NONE: the last */
} slvi_crossing;

/* Crossings by their distance in equal parts of the reach, first in, first out: all that are nearly
 * as near are taken in the order in which they came. What this order changes is mended, since a
 * vertex that becomes nearer is gone on from anew. */
enum { SLVI_BUCKETS = 1024 };
typedef struct slvi_queue {
    slvi_crossing *list;
    uint64_t room;
    uint32_t used, unused; /* so many of the list; the first that is free */
    uint32_t first[SLVI_BUCKETS], last[SLVI_BUCKETS];
    uint32_t at;      /* the bucket that is being emptied */
    uint32_t waiting; /* crossings */
    float scale;      /* buckets for a unit of length */
} slvi_queue;

/* A face under a dab, and which of the touched cells lie in it. */
typedef struct slvi_part {
    uint32_t first, count; /* of the touched triangles */
    uint64_t texel;        /* where its coverage begins */
    bool covered;          /* some of it is more than 0 */
} slvi_part;

struct slvi_blur; /* canvas/blur.c */
struct slvi_mirrored;

struct slv_painter {
    slv_env env;
    const slv_paint_surface *surface;
    float size; /* the surface's extent */
    slvi_front_vertex *vertices;
    uint32_t *tri_round; /* per triangle: the round in which it was touched */
    uint32_t round;
    slvi_queue queue;
    uint32_t *touched; /* triangles */
    uint32_t ntouched;
    uint64_t touched_room;
    uint32_t *sorted; /* as they are sorted */
    uint64_t sorted_room;
    slv_patch *patches;
    slvi_part *parts;
    uint64_t patch_room;
    float *coverage;
    uint64_t coverage_room;
    float *texels; /* what is read of a canvas, and mixed */
    uint64_t texel_room;
    double *sums; /* of patches, for means; and where their texels begin */
    uint64_t sum_room;
    float *colors; /* SLV_PAINT_CHANNELS for each texel of all patches */
    uint64_t color_room;
    uint64_t *starts; /* where the texels of each patch that is laid begin */
    uint64_t start_room;
    struct slvi_mirrored *mirrored; /* canvas/symmetry.c */
    void (*end_mirrored)(struct slvi_mirrored *mirrored);
    struct slvi_blur *blur; /* of the canvas that was blurred last, or NULL; and what ends it */
    void (*end_blur)(struct slvi_blur *blur);
};

/* Makes room for `count` elements, and for more than that, so that it is seldom asked again. */
slv_result slvi_painter_grow(slv_painter *p, uint64_t count, uint64_t size, void *memory,
                             uint64_t *room);
static inline slv_result slvi_painter_room(slv_painter *p, uint64_t count, uint64_t size,
                                           void *memory, uint64_t *room) {
    return count <= *room ? SLV_OK : slvi_painter_grow(p, count, size, memory, room);
}

const slv_env *slvi_painter_env(const slv_painter *p);

/* How far a dab may reach into a face; `user` knows the dab. */
typedef struct slvi_reach {
    float least;        /* anywhere */
    const slv_res *res; /* NULL: the same everywhere */
    bool places;        /* of vertices are wanted, not only distances */
} slvi_reach;
float slvi_reach_into(const slv_painter *p, const slvi_reach *reach, uint32_t face);

/* Spreads from a place until all that is nearer than `reach` has been touched: distances and places
 * of vertices, and p->touched, of which none need be as near as that. */
slv_result slvi_painter_spread(slv_painter *p, slv_surface_point from, const float axis[3],
                               const slvi_reach *reach);

/* A triangle is touched in this round, and listed. */
static inline slv_result slvi_painter_touch(slv_painter *p, uint32_t tri) {
    slv_result result = slvi_painter_room(p, (uint64_t)p->ntouched + 1, sizeof *p->touched,
                                          &p->touched, &p->touched_room);
    if (result)
        return result;
    p->tri_round[tri] = p->round;
    p->touched[p->ntouched++] = tri;
    return SLV_OK;
}

/* A new round, in which nothing has been touched. */
void slvi_painter_begin_round(slv_painter *p);

/* The texels whose centres lie in a cell, number `local` of a face of n x n: x0..x1-1, y0..y1-1. */
typedef struct slvi_cell_texels {
    uint32_t x0, x1, y0, y1;
} slvi_cell_texels;
slvi_cell_texels slvi_find_cell_texels(uint32_t n, uint32_t local, slv_res res);

/* What falls off from the middle: see slv_dab. */
typedef struct slvi_profile {
    double radius2, inner2; /* squared: of all, and of what is within the rim */
    double hardness, slope; /* down to this at the inner radius; then per square to 0 */
    double radius, opacity;
} slvi_profile;
/* `edge` is the least width of the rim. Dabs that are thinner than the texels of a face are made as
 * wide as these, and paler. */
slvi_profile slvi_profile_make(double radius, double hardness, double edge, double texel);

static inline float slvi_profile_at(const slvi_profile *f, double square) {
    if (square >= f->radius2)
        return 0;
    double value = square <= f->inner2
                       ? 1 - (1 - f->hardness) * (f->inner2 > 0 ? square / f->inner2 : 0)
                       : f->slope * (f->radius2 - square);
    return (float)(value * f->opacity);
}

/* The texels of a triangle that may be covered; false if none is. */
typedef bool (*slvi_texels_fn)(const slv_painter *p, const void *user, uint32_t tri,
                               slvi_cell_texels *out);

/* Of the touched triangles, a patch for each face that encloses the texels which `fn` says; sorts
 * them, and makes room for their coverage. */
slv_result slvi_painter_gather(slv_painter *p, const slv_res *res, slvi_texels_fn fn,
                               const void *user, slv_patches *out);
/* Calls `fn` for all patches, on several threads if there is enough to do. */
slv_result slvi_painter_share(const slv_painter *p, const slv_patches *patches, slv_range_fn fn,
                              void *user);

/* Leaves patches out of which nothing is covered, once that is known of their parts. */
void slvi_painter_keep_covered(slv_painter *p, slv_patches *patches);

/* The longer side of a face's texels. */
static inline float slvi_texel_length(const slv_paint_surface *s, uint32_t face, slv_res res) {
    const float *sides = s->sides + 3 * (size_t)face;
    return fmaxf(ldexpf(sides[0], -res.u), ldexpf(sides[1], -res.v));
}

#endif
