/* A pattern on a mesh, as a .ptx with its mesh inside. */
#ifndef BAKE_KIT_H
#define BAKE_KIT_H

#include "kit/test.h"

#include <selvage/bake.h>
#include <selvage/ptx.h>

/* One byte per channel, three channels; `res` and `nfaces` must be those of the mesh's faces. */
static inline void bake_write(const char *path, const char *obj, slv_scheme scheme, uint32_t nfaces,
                              const slv_res *res, const slv_procedural *pattern) {
    const slv_texture_desc desc = {nfaces, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res, SLV_TEXTURE_AUTO};
    const slv_surface_params params = {.scheme = scheme};
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    slv_texture *texture = NULL;
    REQUIRE(slv_mesh_parse_obj(&env, "mesh", obj, strlen(obj), &mesh) == SLV_OK);
    REQUIRE(slv_mesh_face_count(mesh) == nfaces);
    REQUIRE(slv_mesh_adjacency(&env, mesh, &adjacency) == SLV_OK);
    REQUIRE(slv_surface_create(&env, mesh, &params, &surface) == SLV_OK);
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    REQUIRE(slv_bake_procedural(&env, surface, pattern, NULL, texture) == SLV_OK);
    REQUIRE(slv_ptx_save(&env, path, texture, adjacency, &(slv_ptx_write_params){.mesh = mesh}) ==
            SLV_OK);
    slv_texture_destroy(texture);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
}

#endif
