/* Coloured points, sorted for the search of those around a place. */
#ifndef SLV_BAKE_TREE_H
#define SLV_BAKE_TREE_H

#include <selvage/mesh.h>

typedef struct point_tree {
    uint32_t count;
    float *positions; /* 3 each */
    float *colors;    /* 4 each: light, multiplied by alpha */
    uint8_t *axes;    /* of a point in the middle of a range, the one along which it is split */
    float low[3], high[3];
} point_tree;

/* Of the vertices that have a colour, relative to `origin`; sRGB becomes light if `srgb`. */
slv_result slvi_point_tree_create(const slv_env *env, const slv_mesh *points,
                                  const double origin[3], bool srgb, point_tree *out);
void slvi_point_tree_free(point_tree *tree);

enum { POINT_NEAREST = 64 }; /* the most that a search counts */

/* How many of the `wanted` nearest lie within a distance of a place, and how far the last is. */
uint32_t slvi_point_tree_nearest(const point_tree *tree, const float at[3], uint32_t wanted,
                                 float within, float *distance);
/* Adds the colours of all points within a radius, each times (1 - d^2 / radius^2)^2, to `sum`.
 * Returns the weights' sum. */
double slvi_point_tree_gather(const point_tree *tree, const float at[3], float radius,
                              double sum[4]);

#endif
