/* The limit surface of a mesh, evaluated at any (face, u, v). Built on OpenSubdiv. */
#ifndef SELVAGE_SURFACE_H
#define SELVAGE_SURFACE_H

#include <selvage/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum slv_scheme {
    SLV_SCHEME_CATMARK = 0,
    SLV_SCHEME_BILINEAR, /* polygons as they are: triangles are flat */
    SLV_SCHEME_LOOP      /* of triangles only (Loop 1987) */
} slv_scheme;

/* catmark, bilinear, loop */
SLV_API const char *slv_scheme_name(slv_scheme scheme);
SLV_API bool slv_scheme_from_name(const char *name, slv_scheme *out);

/* Zero means default: Catmull-Clark, and the boundary rule of the mesh or else edge-and-corner. The
 * rule `none`, which leaves faces at a boundary without a limit, is taken as edge-and-corner with a
 * warning. */
typedef struct slv_surface_params {
    slv_scheme scheme;
    slv_boundary boundary;
    bool moves; /* slv_surface_move will be called: keeps 64 bytes more for each quad, 12 for each
                   vertex, and weights, 1 MiB at most, for each kind of polygon that is not regular:
                   those with the same topology and creases around them */
    uint64_t reserved[4];
} slv_surface_params;

/* An evaluator. Immutable but for slv_surface_move; any number of threads may evaluate at once.
 * Keeps what it needs of the mesh.
 *
 * Edges of more than two polygons, or of two that run the same way, are infinitely sharp, and so
 * are vertices where several fans of polygons meet. A polygon that has no limit (it names a vertex
 * twice, has more than 512 sides or as many polygons around a corner, or has sharp tags beside two
 * polygons that share several edges, which OpenSubdiv 3.5 does not survive) stays flat, bilinear
 * between its vertices; their number goes into one warning. The Loop scheme for a polygon of more
 * than three sides is SLV_ERROR_UNSUPPORTED. */
typedef struct slv_surface slv_surface;

typedef struct slv_surface_point {
    int32_t face;
    float u, v;
} slv_surface_point;

/* Gives the vertices of the mesh other positions, `nverts` times three floats, as an animated cage
 * has them: what follows from topology is kept, and only the limit's own points are weighed anew,
 * on env->threads threads of the surface's env. All results are then those of a surface of the
 * moved mesh, to the bit. No other thread may use the surface meanwhile. A surface made without
 * `moves`, another number of vertices, or a position that is no number is SLV_ERROR_ARGUMENT, and
 * then nothing has moved. `positions` is not kept. */
SLV_NODISCARD SLV_API slv_result slv_surface_move(slv_surface *surface, uint32_t nverts,
                                                  const float *positions);

/* Where results go; any pointer may be NULL. Positions and derivatives are in mesh units,
 * derivatives per unit of the face's own (u,v) (for sub-faces too), normals have unit length and
 * point to the side from which the face is counter-clockwise. Where the derivatives vanish, the
 * normal is taken from nearby, never NaN. */
typedef struct slv_surface_arrays {
    float *positions; /* 3 per point */
    float *du, *dv;   /* 3 per point */
    float *normals;   /* 3 per point */
} slv_surface_arrays;

SLV_NODISCARD SLV_API slv_result slv_surface_create(const slv_env *env, const slv_mesh *mesh,
                                                    const slv_surface_params *params,
                                                    slv_surface **out);
SLV_API void slv_surface_destroy(slv_surface *surface);
SLV_API uint32_t slv_surface_face_count(const slv_surface *surface);

/* Evaluates `count` points; those of one face should stand together. A face id out of range is
 * SLV_ERROR_ARGUMENT; (u,v) is clamped to the face. Holes evaluate like other faces. */
SLV_NODISCARD SLV_API slv_result slv_surface_evaluate(const slv_surface *surface, size_t count,
                                                      const slv_surface_point *points,
                                                      const slv_surface_arrays *out);

/* Evaluates a grid of (nu + 1) * (nv + 1) points of one face, corners included, v-major, u fastest.
 */
SLV_NODISCARD SLV_API slv_result slv_surface_evaluate_grid(const slv_surface *surface, int32_t face,
                                                           uint32_t nu, uint32_t nv,
                                                           const slv_surface_arrays *out);

/* OpenSubdiv's own face adjacency (Far::PtexIndices), face_count records, for comparison with ours;
 * it knows neither flipped neighbours nor holes. */
SLV_NODISCARD SLV_API slv_result slv_surface_osd_adjacency(const slv_surface *surface,
                                                           slv_face_adjacency *out);

#ifdef __cplusplus
}
#endif

#endif
