/* Inside an slv_paint_surface: welded triangles, and how they meet. */
#ifndef SLV_PAINT_SURFACE_DATA_H
#define SLV_PAINT_SURFACE_DATA_H

#include "adjacency/edge.h"

#include <selvage/paint.h>

#include <math.h>

#define SLVI_NONE UINT32_MAX

struct slvi_rays; /* hit.c */

/* A cell is a quadrilateral of a face's grid; its corners and edges are numbered as a face's. Its
 * triangles are 2 c (corners 0 1 2) and 2 c + 1 (corners 0 2 3), on both sides of the diagonal
 * along which the renderer splits it. */
typedef struct slvi_cell {
    uint32_t corners[4]; /* vertices */
    uint32_t across[4];  /* 4 * the cell beyond the edge + its edge, or SLVI_NONE */
    float lengths[5];    /* of its edges, and of its diagonal */
    uint32_t face;
} slvi_cell;

struct slv_paint_surface {
    slv_env env;
    slv_adjacency *adjacency;
    uint32_t nfaces, ncells, nverts;
    uint32_t *first;   /* nfaces + 1: cells of each face, v-major */
    uint8_t *segments; /* per face; 0: a hole */
    float *sides;      /* per face: mean length of a unit of u and of v, and the area */
    float *positions;  /* 3 per vertex */
    uint8_t *bent;     /* per vertex: straight lines past it do not meet again behind it */
    slvi_cell *cells;
    float low[3], high[3];
    struct slvi_rays *rays;
};

/* The corners of the cell at the three corners of its triangle, counter-clockwise. */
static inline unsigned slvi_tri_corner(uint32_t tri, unsigned k) {
    return tri & 1 ? (k ? k + 1 : 0) : k;
}

static inline uint32_t slvi_tri_vertex(const slv_paint_surface *s, uint32_t tri, unsigned k) {
    return s->cells[tri / 2].corners[slvi_tri_corner(tri, k)];
}

static inline const float *slvi_tri_point(const slv_paint_surface *s, uint32_t tri, unsigned k) {
    return s->positions + 3 * (size_t)slvi_tri_vertex(s, tri, k);
}

/* The length of edge k, from its corner k to the next. */
static inline double slvi_tri_length(const slv_paint_surface *s, uint32_t tri, unsigned k) {
    /* lower: edges 0 and 1 of the cell, then the diagonal; upper: the diagonal, then 2 and 3 */
    unsigned which = tri & 1 ? (k ? k + 1 : 4) : k == 2 ? 4 : k;
    return (double)s->cells[tri / 2].lengths[which];
}

/* The triangle across edge k (from its corner k to k + 1), and which of its edges that is; false at
 * a boundary. */
static inline bool slvi_tri_across(const slv_paint_surface *s, uint32_t tri, unsigned k,
                                   uint32_t *to, unsigned *edge) {
    /* lower: edges 0 and 1 of the cell, then the diagonal; upper: the diagonal, then 2 and 3 */
    if (tri & 1 ? k == 0 : k == 2) {
        *to = tri ^ 1;
        *edge = tri & 1 ? 2 : 0;
        return true;
    }
    uint32_t beyond = s->cells[tri / 2].across[tri & 1 ? k + 1 : k];
    if (beyond == SLVI_NONE)
        return false;
    unsigned e = beyond & 3;
    *to = 2 * (beyond >> 2) + (e >> 1);
    *edge = e < 2 ? e : e - 1;
    return true;
}

/* A point of a face as a triangle and the place in its cell. False for a hole or no face. */
bool slvi_surface_place(const slv_paint_surface *s, slv_surface_point point, uint32_t *tri,
                        double *x, double *y);
/* And back. */
slv_surface_point slvi_surface_point_of(const slv_paint_surface *s, uint32_t tri, double x,
                                        double y);
/* Of a place (x,y) in the cell, how much each corner of its triangle counts. */
static inline void slvi_tri_weights(uint32_t tri, double x, double y, double w[3]) {
    if (tri & 1) {
        w[0] = 1 - y, w[1] = x, w[2] = y - x;
    } else {
        w[0] = 1 - x, w[1] = x - y, w[2] = y;
    }
}

static inline double slvi_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void slvi_cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* False, and the vector as it was, if it has no length. */
static inline bool slvi_unit(double v[3]) {
    double length = sqrt(slvi_dot(v, v));
    if (!(length > 0) || !isfinite(length))
        return false;
    for (int k = 0; k < 3; k++)
        v[k] /= length;
    return true;
}

static inline double slvi_distance(const float *a, const float *b) {
    double d[3];
    for (int k = 0; k < 3; k++)
        d[k] = (double)a[k] - (double)b[k];
    return sqrt(slvi_dot(d, d));
}

/* How a triangle faces; some direction of length 1 if it has no extent. */
void slvi_tri_normal(const slv_paint_surface *s, uint32_t tri, double out[3]);
/* Two directions of the triangle's plane, at right angles: `axis` (or, if it is zero, along u)
 * projected, and a quarter turn counter-clockwise from it. */
void slvi_tri_frame(const slv_paint_surface *s, uint32_t tri, const float axis[3], double x[3],
                    double y[3]);

void slvi_rays_destroy(struct slvi_rays *rays);
slv_result slvi_rays_create(const slv_paint_surface *s, struct slvi_rays **out);

#endif
