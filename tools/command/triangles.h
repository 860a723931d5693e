/* Textures of triangles, as the surfaces of this library have them. */
#ifndef SELVAGE_TOOLS_TRIANGLES_H
#define SELVAGE_TOOLS_TRIANGLES_H

#include <selvage/bake.h>

/* The texture of a triangle-mesh file's sub-faces, for a mesh of triangles, which it must fit. */
slv_result triangles_load(const slv_env *env, const slv_ptx *ptx, const slv_mesh *mesh,
                          const slv_adjacency *adjacency, slv_texture_encoding encoding,
                          slv_texture **out);

#endif
