/* Faces of a surface that are quick to evaluate together: those of one that moves whose polygons
 * have the same topology around them. */
#ifndef SLV_MESH_SURFACE_UNITS_H
#define SLV_MESH_SURFACE_UNITS_H

#include <selvage/surface.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SLVI_UNIT_FACES 4

/* Each face is in one unit. */
uint32_t slvi_surface_unit_count(const slv_surface *surface);
/* Returns how many faces there are. */
uint32_t slvi_surface_unit(const slv_surface *surface, uint32_t unit,
                           int32_t faces[SLVI_UNIT_FACES]);
/* Grids of n * n segments of all faces of a unit: what slv_surface_evaluate_grid finds for each,
 * to the bit. */
slv_result slvi_surface_evaluate_unit(const slv_surface *surface, uint32_t unit, uint32_t n,
                                      const slv_surface_arrays out[SLVI_UNIT_FACES]);

#ifdef __cplusplus
}
#endif

#endif
