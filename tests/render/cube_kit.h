/* A cube whose six faces have textures of different sizes, as a .ptx with its mesh inside. */
#ifndef CUBE_KIT_H
#define CUBE_KIT_H

#include "test.h"

#include <selvage/bake.h>
#include <selvage/ptx.h>

static inline void cube_write(const char *path) {
    static const char obj[] =
        "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
        "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    const slv_res res[6] = {{5, 5}, {5, 4}, {4, 4}, {4, 5}, {5, 5}, {3, 3}};
    const slv_texture_desc desc = {6, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res};
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE, .frequency = 2, .face_tint = 0.5f};
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    slv_texture *texture = NULL;
    REQUIRE(slv_mesh_parse_obj(&env, "cube", obj, strlen(obj), &mesh) == SLV_OK);
    REQUIRE(slv_mesh_adjacency(&env, mesh, &adjacency) == SLV_OK);
    REQUIRE(slv_surface_create(&env, mesh, NULL, &surface) == SLV_OK);
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    REQUIRE(slv_bake_procedural(&env, surface, &noise, NULL, texture) == SLV_OK);
    REQUIRE(slv_ptx_save(&env, path, texture, adjacency, &(slv_ptx_write_params){.mesh = mesh}) ==
            SLV_OK);
    slv_texture_destroy(texture);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
}

#endif
