/* Reads a texture of triangles and makes that of sub-faces of it. */
#include "command/triangles.h"
#include "command/scene.h"

slv_result triangles_load(const slv_env *env, const slv_ptx *ptx, const slv_mesh *mesh,
                          const slv_adjacency *adjacency, slv_texture_encoding encoding,
                          slv_texture **out) {
    slv_texture *triangles = NULL;
    slv_result result = slv_ptx_match_mesh(env, ptx, mesh);
    *out = NULL;
    if (!result && !(result = scene_check_memory(env, ptx, NULL)) &&
        !(result = slv_ptx_load_texture_at(env, ptx, NULL, &triangles)))
        result = slv_triangle_texture(env, triangles, adjacency, encoding, out);
    slv_texture_destroy(triangles);
    return result;
}
