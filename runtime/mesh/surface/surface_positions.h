/* Where a surface has the vertices of its mesh: elsewhere than the mesh once it was moved. */
#ifndef SLV_MESH_SURFACE_POSITIONS_H
#define SLV_MESH_SURFACE_POSITIONS_H

#include <selvage/surface.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The box around them, infinite the other way round if there are none. */
void slvi_surface_bounds(const slv_surface *surface, float low[3], float high[3]);
/* The corners of a face of the control mesh, as slv_mesh_corners has them. */
void slvi_surface_corners(const slv_surface *surface, int32_t face, float out[12]);

#ifdef __cplusplus
}
#endif

#endif
