/* Meshes far from zero, of which floats would keep little: positions are made relative to a point
 * among them. */
#include "mesh/mesh_data.h"

#include <math.h>

/* How many times its size a mesh may be away: the floats of nearer ones are as good as needed, and
 * stay as they are. */
#define FAR_AWAY 64.0f

bool slvi_mesh_find_origin(const float *positions, const int32_t *verts, uint64_t nsides,
                           double origin[3]) {
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    float size = 0, away = 0;
    origin[0] = origin[1] = origin[2] = 0;
    /* a vertex that no polygon has may lie anywhere */
    for (uint64_t side = 0; side < nsides; side++)
        for (int c = 0; c < 3; c++) {
            float x = positions[3 * (verts ? (size_t)verts[side] : (size_t)side) + (size_t)c];
            low[c] = fminf(low[c], x);
            high[c] = fmaxf(high[c], x);
        }
    for (int c = 0; nsides && c < 3; c++) {
        size = fmaxf(size, high[c] - low[c]);
        away = fmaxf(away, fabsf(0.5f * low[c] + 0.5f * high[c]));
    }
    if (!(away > FAR_AWAY * size))
        return false;
    /* a float, so that what floats tell of such positions is kept to the bit */
    for (int c = 0; c < 3; c++)
        origin[c] = (double)(0.5f * low[c] + 0.5f * high[c]);
    return true;
}

void slvi_mesh_shift(float *positions, const float *rests, uint64_t nverts,
                     const double origin[3]) {
    for (uint64_t i = 0; i < 3 * nverts; i++) {
        double rest = rests ? (double)rests[i] : 0;
        positions[i] = (float)((double)positions[i] - origin[i % 3] + rest);
    }
}

bool slvi_mesh_is_far(const slv_mesh_view *view) {
    return view->origin[0] != 0 || view->origin[1] != 0 || view->origin[2] != 0;
}
