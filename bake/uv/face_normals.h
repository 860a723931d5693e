/* Normals in the frames of faces, as a source of normals along the mesh's axes. */
#ifndef SLV_BAKE_UV_FACE_NORMALS_H
#define SLV_BAKE_UV_FACE_NORMALS_H

#include <selvage/source.h>
#include <selvage/surface.h>

/* Each texel turned out of the frame that the surface has in its middle: along growing u, along
 * normal x that, along the normal. Of three channels of half or float. Takes `inner`, also if it
 * fails; the surface must outlive the source. */
slv_result slvi_uv_face_normals(const slv_env *env, const slv_surface *surface, slv_source *inner,
                                slv_source *out);

#endif
