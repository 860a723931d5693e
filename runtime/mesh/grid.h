/* The grids of a tessellation under way, and where they meet. */
#ifndef SLV_MESH_GRID_H
#define SLV_MESH_GRID_H

#include "adjacency/edge.h"

#include <selvage/tessellation.h>

#include <math.h>

typedef struct slvi_grid_job {
    const slv_surface *surface;
    const slv_adjacency *adjacency;
    const slv_displacement *displacement; /* may be NULL */
    slv_env env;                          /* logs one at a time */
    slv_tessellation *out;
    float *spacing; /* per face: how fine a displacement is looked up; NULL: as its points are */
    float *offsets, *facing; /* 3 a vertex: how far a face would move it, and the normal then */
} slvi_grid_job;

static inline uint32_t slvi_vertex_at(const slv_tessellation *t, uint32_t face, float u, float v) {
    uint32_t n = t->segments[face];
    uint32_t x = (uint32_t)lrintf(u * (float)n), y = (uint32_t)lrintf(v * (float)n);
    return t->first[face] + y * (n + 1) + x;
}

static inline uint32_t slvi_corner_vertex(const slv_tessellation *t, uint32_t face,
                                          unsigned corner) {
    return slvi_vertex_at(t, face, (float)slvi_corner_u(corner), (float)slvi_corner_v(corner));
}

/* How many segments an edge has, the same from both its sides, in units of the face: as many as the
 * coarsest of the faces along it. */
uint32_t slvi_edge_segments(const slvi_grid_job *job, uint32_t face, unsigned edge);

/* Where on a whole quad's edge the corner of a sub-face lies, if it lies in the middle of one that
 * is there. */
bool slvi_t_corner_place(const slvi_grid_job *job, uint32_t face, unsigned corner,
                         slv_neighbour *quad, float uv[2]);

#endif
