/* The limit surface as triangles: one grid per face, identical vertices where grids meet. What the
 * renderer draws, and what the reference casts its rays at. */
#ifndef SELVAGE_TESSELLATION_H
#define SELVAGE_TESSELLATION_H

#include <selvage/camera.h>
#include <selvage/surface.h>

#ifdef __cplusplus
extern "C" {
#endif

/* 32 bytes. */
typedef struct slv_vertex {
    float position[3], normal[3];
    uint16_t uv[2]; /* half floats, exact */
    int32_t face;
} slv_vertex;

/* A face with n segments has (n + 1) * (n + 1) vertices from first[face] on, v-major, u fastest.
 * Where an edge has fewer segments than its face, which is so where the face beyond has, the
 * vertices in between are copies of the next ones that both faces have. */
typedef struct slv_tessellation {
    uint32_t nfaces;
    slv_vertex *vertices; /* first[nfaces] */
    uint32_t *first;      /* per face, and one past the last: its first vertex */
    uint16_t *segments;   /* per face; 0 for holes, which have no vertices */
    uint16_t *edges;      /* four per face: segments along each edge; 0 if its ends are one point */
    float bounds_min[3], bounds_max[3];
} slv_tessellation;

/* Which way points are moved. */
typedef enum slv_displacement_space {
    SLV_DISPLACE_NORMAL = 0, /* one number: along the unit normal of the limit, outwards */
    SLV_DISPLACE_OBJECT,     /* three: along the axes of the mesh */
    SLV_DISPLACE_TANGENT     /* three: along the unit vector of growing u, along normal x that, and
                                along the unit normal, all of the limit */
} slv_displacement_space;

SLV_API const char *slv_displacement_space_name(slv_displacement_space space); /* normal, object,
                                                                                  tangent */
SLV_API bool slv_displacement_space_from_name(const char *name, slv_displacement_space *out);

/* What moves the points of a surface, in mesh units: any function of (face, u, v), to be filled by
 * whoever has one; slv_displacement_open (displacement.h) makes one of a texture. */
typedef struct slv_displacement {
    slv_displacement_space space;
    /* Writes one or three floats for each of `count` points of a face, (u,v) each. `spacing` is how
     * far apart they are, in units of the face: what is finer need not show. Called by any number
     * of threads at once; must give the same values each time. */
    slv_result (*evaluate)(void *user, int32_t face, float spacing, size_t count, const float *uv,
                           float *out);
    /* How many segments along its edges show all that there is on a face; NULL: nobody knows. */
    uint32_t (*detail)(void *user, int32_t face);
    void *user;
    uint64_t reserved[4];
} slv_displacement;

/* Moves the flat faces of a cube (slv_mesh_create_cube, SLV_SCHEME_BILINEAR) onto the unit sphere
 * around its middle: (u,v) of a face is then what lookups in cube maps have. The mesh must outlive
 * it. */
SLV_API slv_displacement slv_sphere_displacement(const slv_mesh *cube);

/* How far points may be from where they belong in a picture, in pixels, and unit normals from
 * what they are; those of a moved surface, which change from texel to texel, more. */
#define SLV_TESSELLATION_PIXELS 0.125f
#define SLV_TESSELLATION_TURN 0.025f
#define SLV_TESSELLATION_TURN_MOVED 0.035f

/* Zero means default. */
typedef struct slv_tessellation_params {
    /* Of every face, a power of two, 2 to 128. 0: of each face as many as a picture needs, 1 to
     * 256, which may differ between neighbours, and as few as can be where it is not in view;
     * vertices of faces smaller than a pixel are drawn together. Then `camera`, `width` and
     * `height` are needed. */
    uint32_t segments;
    const slv_displacement *displacement; /* NULL: the limit surface itself */
    const slv_camera *camera;
    uint32_t width, height;
    float pixels; /* most that a point may be off; 0 means SLV_TESSELLATION_PIXELS */
    uint64_t reserved[4];
} slv_tessellation_params;

/* How many segments a face edge should have, a power of two from 2 to 64: at most about 3 pixels
 * each on the largest face of the mesh seen by `camera` at this size, but no more than two cells
 * for each pixel of the picture in all. */
SLV_API uint32_t slv_tessellation_for(const slv_mesh *mesh, const slv_camera *camera,
                                      uint32_t width, uint32_t height);

/* Tessellates every face into segments * segments quads (sub-faces into half as many each way, so
 * that vertices meet), with the vertices of edges that `adjacency` shares made identical: no
 * cracks. Holes are left out. `segments` is a power of two, 2 to 128. The same bytes with any
 * number of threads. slv_tessellation_free releases what is in `out`. */
SLV_NODISCARD SLV_API slv_result slv_tessellate(const slv_env *env, const slv_mesh *mesh,
                                                const slv_surface *surface,
                                                const slv_adjacency *adjacency, uint32_t segments,
                                                slv_tessellation *out);
/* The same with all that there is to say. Where faces of different segments meet, both draw the
 * edge with those of the coarser: there are no cracks and no vertices within the other's sides.
 * What a face needs is found by trying its points against straight pieces, seen by the camera. With
 * a displacement the surface stays closed: points of an edge or a vertex move by one amount, the
 * mean over the faces that meet there, whatever their resolutions, so that they are the same to the
 * bit on all sides. Normals are those of the moved surface, from differences of the displacement
 * over half a segment to both sides, and one at each such point where the limit is smooth. A point
 * moved further than 1e18 is SLV_ERROR_LIMIT. */
SLV_NODISCARD SLV_API slv_result slv_tessellate_with(const slv_env *env, const slv_mesh *mesh,
                                                     const slv_surface *surface,
                                                     const slv_adjacency *adjacency,
                                                     const slv_tessellation_params *params,
                                                     slv_tessellation *out);
/* Frees the arrays and zeroes the struct. */
SLV_API void slv_tessellation_free(slv_tessellation *tessellation);

/* Six indices for each cell of a face's grid, two triangles on both sides of its diagonal from
 * lowest to highest (u,v), without those that have no area; returns how many were written (NULL
 * only counts). */
SLV_API uint32_t slv_tessellation_indices(const slv_tessellation *tessellation, uint32_t face,
                                          uint32_t *out);

#ifdef __cplusplus
}
#endif

#endif
