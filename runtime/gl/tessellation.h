/* The limit surface as triangles: one grid per face, identical vertices where grids meet. */
#ifndef SLV_GL_TESSELLATION_H
#define SLV_GL_TESSELLATION_H

#include <selvage/mesh.h>
#include <selvage/surface.h>

typedef struct slv_vertex {
    float position[3], normal[3];
    uint16_t uv[2]; /* half */
    int32_t face;
} slv_vertex;

typedef struct slv_tessellation {
    uint32_t nfaces;
    slv_vertex *vertices;
    uint32_t *first;   /* per face, and one past the last: its first vertex */
    uint8_t *segments; /* per face; 0 for holes, which have no vertices */
    float bounds_min[3], bounds_max[3];
} slv_tessellation;

slv_result slv_tessellate(const slv_env *env, const slv_mesh *mesh, const slv_surface *surface,
                          const slv_adjacency *adjacency, uint32_t segments, slv_tessellation *out);
void slv_tessellation_free(slv_tessellation *tessellation);

/* Six indices for each cell of a face's grid; returns how many were written (NULL only counts). */
uint32_t slv_tessellation_indices(const slv_tessellation *tessellation, uint32_t face,
                                  uint32_t *out);

#endif
