/* Triangles among sub-faces. */
#ifndef SLV_ADJACENCY_TRIANGLE_H
#define SLV_ADJACENCY_TRIANGLE_H

#include <selvage/subface.h>

/* The triangle across an edge, and its edge, by the adjacency of their sub-faces. */
bool slvi_triangle_across(const slv_adjacency *subfaces, int32_t triangle, unsigned edge,
                          int32_t *to, unsigned *to_edge);

/* The record that a triangle-mesh .ptx has of a triangle. */
slv_face_adjacency slvi_triangle_record(const slv_adjacency *subfaces, int32_t triangle);

#endif
