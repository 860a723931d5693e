/* One face's grid by itself: its limit, and how a displacement would move it. */
#ifndef SLV_MESH_FACE_GRID_H
#define SLV_MESH_FACE_GRID_H

#include "mesh/grid.h"
#include "mesh/surface/surface_units.h"

/* Room for the points of one face, and what was found of them, 3 floats each. */
typedef struct slvi_face_grid {
    slv_surface_arrays limit;
    float *uv, *values;      /* what a displacement is asked, and its answers */
    float *offsets, *facing; /* how far points move, and the unit normals then */
    float *middles, *along;  /* on the way there: answers between points, and tangents */
} slvi_face_grid;

/* For `points`, with a displacement or without. slvi_face_grid_free is due after a failure too. */
slv_result slvi_face_grid_make(const slv_env *env, uint64_t points, bool displaced,
                               slvi_face_grid *out);
void slvi_face_grid_free(slvi_face_grid *grid);

/* Fills (n + 1) * (n + 1) points. Offsets are in space, and zero lengths have a normal, too. */
slv_result slvi_face_grid_evaluate(const slvi_grid_job *job, uint32_t face, uint32_t n,
                                   slvi_face_grid *grid);
/* The same of all faces of a unit of the surface, all of n segments. */
slv_result slvi_face_grids_evaluate(const slvi_grid_job *job, uint32_t unit, uint32_t n,
                                    slvi_face_grid grids[SLVI_UNIT_FACES]);

/* False, and nothing changed, if there is no direction. */
static inline bool slvi_normalise(const float v[3], float out[3]) {
    double squares = 0;
    for (int c = 0; c < 3; c++)
        squares += (double)v[c] * (double)v[c];
    if (!(squares > 1e-60) || !isfinite(squares))
        return false;
    double length = sqrt(squares);
    for (int c = 0; c < 3; c++)
        out[c] = (float)((double)v[c] / length);
    return true;
}

#endif
