/* The calls of calls_kit.h about triangles. */
#ifndef CALLS_TRIANGLES_H
#define CALLS_TRIANGLES_H

#include "kit/calls_data.h"

#include <selvage/subface.h>
#include <selvage/surface.h>
#include <selvage/triangle.h>

static const int32_t calls_triangle_sizes[2] = {3, 3}, calls_triangle_verts[6] = {0, 1, 3, 1, 4, 3};

/* Two of the mesh's vertices' triangles, with a texture of two resolutions. */
static slv_result call_triangles(const slv_env *env) {
    const slv_mesh_view *whole = slv_mesh_get_view(calls.mesh);
    const slv_mesh_view view = {.nverts = whole->nverts,
                                .positions = whole->positions,
                                .npolys = 2,
                                .poly_sizes = calls_triangle_sizes,
                                .poly_verts = calls_triangle_verts};
    const slv_face_adjacency records[2] = {{{-1, 1, -1, -1}, {0, 2, 0, 0}},
                                           {{-1, -1, 0, -1}, {0, 0, 1, 0}}};
    const slv_surface_params loop = {.scheme = SLV_SCHEME_LOOP};
    const slv_res res[2] = {{3, 3}, {5, 5}};
    const slv_texture_desc desc = {2, SLV_TYPE_U8, 1, SLV_NO_ALPHA, res, SLV_TEXTURE_SRGB};
    unsigned char texels[32 * 32];
    float position[3];
    const slv_surface_point point = {4, 0.25f, 0.5f};
    const slv_surface_arrays arrays = {.positions = position};
    slv_mesh *mesh = NULL;
    slv_surface *surface = NULL;
    slv_adjacency *adjacency = NULL;
    slv_texture *triangles = NULL, *texture = NULL;
    slv_result result = slv_mesh_create(env, &view, &mesh);
    for (uint32_t i = 0; i < sizeof texels; i++)
        texels[i] = (unsigned char)(i * 37);
    if (!result && !(result = slv_surface_create(env, mesh, &loop, &surface)) &&
        !(result = slv_surface_evaluate(surface, 1, &point, &arrays)) &&
        !(result = slv_adjacency_create_triangles(env, 2, records, &adjacency)) &&
        !(result = slv_texture_create(env, &desc, &triangles)) &&
        !(result = slv_texture_set_face(triangles, 0, texels)) &&
        !(result = slv_texture_set_face(triangles, 1, texels)))
        result = slv_triangle_texture(env, triangles, adjacency, SLV_TEXTURE_AUTO, &texture);
    slv_texture_destroy(texture);
    slv_texture_destroy(triangles);
    slv_adjacency_destroy(adjacency);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    return result;
}

static slv_result call_mesh_cube(const slv_env *env) {
    static const char obj[] =
        "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
        "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    slv_mesh *mesh = NULL, *cube = NULL;
    slv_adjacency *adjacency = NULL;
    slv_result result = slv_mesh_parse_obj(env, "cube", obj, sizeof obj - 1, &mesh);
    if (!result && !(result = slv_mesh_adjacency(env, mesh, &adjacency)))
        result = slv_mesh_create_cube(env, adjacency, &cube);
    slv_mesh_destroy(mesh);
    slv_mesh_destroy(cube);
    slv_adjacency_destroy(adjacency);
    return result;
}

#endif
