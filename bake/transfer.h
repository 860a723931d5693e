/* The parts of a transfer. */
#ifndef SLV_BAKE_TRANSFER_H
#define SLV_BAKE_TRANSFER_H

#include <selvage/transfer.h>

/* The four corners of every face of a control mesh, 12 floats a face: of a sub-face its vertex, the
 * middles of two edges and the polygon's centre. For free(). */
slv_result transfer_corners(const slv_env *env, const slv_mesh *mesh, float **out);
float transfer_area(const float *corners);
/* Finds for every face of the target the face of the source with the same corners. Fills in source,
 * turn and flipped of those; the others get -1. */
slv_result transfer_match(const slv_env *env, uint32_t nsource, const float *source,
                          uint32_t ntarget, const float *target, float tolerance,
                          slv_transfer_face *faces);
/* Copies all texels of a matching face, turned. */
slv_result transfer_copy(const slv_env *env, const slv_texture *from,
                         const slv_transfer_face *match, slv_texture *to, uint32_t face);
slv_res transfer_turned(slv_res res, const slv_transfer_face *match);

#endif
