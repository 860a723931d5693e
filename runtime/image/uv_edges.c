/* Where texture coordinates go on from face to face. */
#include <selvage/uv_images.h>

#include "adjacency/edge.h"

#include <math.h>

static float bilinear(const float *corners, int axis, float u, float v) {
    return (corners[axis] * (1 - u) + corners[2 + axis] * u) * (1 - v) +
           (corners[6 + axis] * (1 - u) + corners[4 + axis] * u) * v;
}

bool slv_uv_continues(const float *corners, unsigned edge, const slv_neighbour *next,
                      const float *others, bool round_u, bool round_v) {
    const bool round[2] = {round_u, round_v};
    for (int end = 0; end < 2; end++) {
        float t = end ? next->t1 : next->t0, u, v;
        unsigned to = slvi_edge_next(edge);
        float eu = (float)slvi_corner_u(edge) +
                   ((float)slvi_corner_u(to) - (float)slvi_corner_u(edge)) * t;
        float ev = (float)slvi_corner_v(edge) +
                   ((float)slvi_corner_v(to) - (float)slvi_corner_v(edge)) * t;
        slv_affine_apply(&next->map, eu, ev, &u, &v);
        for (int axis = 0; axis < 2; axis++) {
            float apart = bilinear(others, axis, u, v) - bilinear(corners, axis, eu, ev);
            if (!(fabsf(round[axis] ? apart - rintf(apart) : apart) <= 1e-4f))
                return false;
        }
    }
    return true;
}
