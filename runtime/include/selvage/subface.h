/* Triangles as faces: three sub-faces each, as an n-gon of a control mesh is n. Sub-face k of
 * triangle f is face 3f + k, and lies as adjacency.h says. */
#ifndef SELVAGE_SUBFACE_H
#define SELVAGE_SUBFACE_H

#include <selvage/adjacency.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The adjacency of the 3 * ntriangles sub-faces of triangles whose records (edges 0 to 2: v = 0,
 * u + v = 1, u = 0) a triangle-mesh .ptx has. Links are cut as slv_adjacency_create does. */
SLV_NODISCARD SLV_API slv_result slv_adjacency_create_triangles(const slv_env *env,
                                                                uint32_t ntriangles,
                                                                const slv_face_adjacency *triangles,
                                                                slv_adjacency **out);

/* Where the point (s,t) of a triangle's sub-face 0 to 2 lies in the triangle's own barycentric
 * coordinates, in which its vertices are (0,0), (1,0) and (0,1); and back, to the sub-face of the
 * nearest vertex, which is returned. Sub-faces are bilinear between their corners. */
SLV_API void slv_triangle_from_subface(unsigned sub, float s, float t, float *u, float *v);
SLV_API unsigned slv_triangle_to_subface(float u, float v, float *s, float *t);

#ifdef __cplusplus
}
#endif

#endif
