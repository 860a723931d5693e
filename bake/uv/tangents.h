/* Tangent frames of meshes with texture coordinates, as MikkTSpace defines them. */
#ifndef SLV_BAKE_UV_TANGENTS_H
#define SLV_BAKE_UV_TANGENTS_H

#include <selvage/mesh.h>

/* Frames at the corners of polygons (Mikkelsen 2008, Simulation of Wrinkled Surfaces Revisited,
 * section 4): normals are those of the mesh, or where it has none smooth ones, means by angle of
 * the polygons around a vertex. Triangles around a vertex whose positions, normals and coordinates
 * there are one, which hang together by edges and whose coordinates turn the same way, share one
 * tangent: the mean of theirs, each projected to the vertex and weighted by its angle there. Quads
 * are split along the diagonal that is shorter in coordinates, other polygons into a fan. */
typedef struct slvi_tangents slvi_tangents;

slv_result slvi_tangents_create(const slv_env *env, const slv_mesh *mesh, slvi_tangents **out);
void slvi_tangents_destroy(slvi_tangents *tangents);

/* Turns a direction from the mesh's axes into the frame at a place of a polygon: tangent,
 * bitangent, normal. As shaders have it, the three are interpolated over a triangle and not
 * normalised, so that a shader gets `direction` back; the result is of length 1. */
void slvi_tangents_turn(const slvi_tangents *tangents, int32_t poly, const float place[2],
                        float direction[3]);

#endif
