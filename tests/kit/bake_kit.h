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

enum { BAKE_GRID_MOST = 8 };

/* A texture of noise on a flat grid of side * side faces of 8x8 texels, on y = 0, from 0 to side,
 * with its geometry; u of a face goes along z, v along x. */
static inline void bake_write_grid(const char *path, int side) {
    char obj[8192] = "";
    size_t length = 0;
    slv_res res[BAKE_GRID_MOST * BAKE_GRID_MOST];
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE, .frequency = 2, .face_tint = 0.5f};
    REQUIRE(side <= BAKE_GRID_MOST);
    for (int i = 0; i < (side + 1) * (side + 1); i++)
        length += (size_t)snprintf(obj + length, sizeof obj - length, "v %d 0 %d\n", i % (side + 1),
                                   i / (side + 1));
    for (int i = 0; i < side * side; i++) {
        int a = 1 + i / side * (side + 1) + i % side;
        res[i] = (slv_res){3, 3};
        length += (size_t)snprintf(obj + length, sizeof obj - length, "f %d %d %d %d\n", a,
                                   a + side + 1, a + side + 2, a + 1);
    }
    bake_write(path, obj, SLV_SCHEME_BILINEAR, (uint32_t)(side * side), res, &noise);
}

#endif
