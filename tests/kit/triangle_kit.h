/* Meshes of triangles with textures of noise, and the textures of sub-faces that are made of them.
 */
#ifndef TRIANGLE_KIT_H
#define TRIANGLE_KIT_H

#include "kit/border_kit.h"
#include "kit/mesh_shapes.h"

#include <selvage/triangle.h>

enum { TRIANGLE_KINDS = 6 };

/* Closed ones with vertices of valence 3 to 8 and tori, and open ones. */
static inline shape triangle_shape(int kind, uint64_t *random) {
    static const int valences[] = {3, 5, 6, 8};
    int side = 3 + (int)(test_random(random) % 2);
    shape s;
    switch (kind % TRIANGLE_KINDS) {
    case 0:
        s = shape_tetrahedron();
        break;
    case 1:
        s = shape_fan(valences[test_random(random) % 4], 3);
        break;
    case 2:
        s = shape_cube();
        break;
    case 3:
        s = shape_grid(side, 3, true, true);
        break;
    case 4:
        s = shape_grid(side, side, false, false);
        break;
    default:
        s = shape_grid(3, side, true, false);
        break;
    }
    if (kind % TRIANGLE_KINDS > 1)
        shape_cut(&s, random, 8, kind % TRIANGLE_KINDS == 4 ? 1 : 0);
    shape_rotate_polygons(&s, random);
    return s;
}

/* Noise on triangles of 2^log2[] texels a side. */
static inline slv_texture *triangle_noise(uint32_t count, const int8_t *log2, slv_type type,
                                          uint32_t nchannels, uint64_t *random) {
    slv_env env = test_env();
    slv_texture *texture = NULL;
    slv_res *res = calloc(count, sizeof *res);
    REQUIRE(res);
    for (uint32_t f = 0; f < count; f++)
        res[f].u = res[f].v = log2[f];
    slv_texture_desc desc = {count, type, nchannels, SLV_NO_ALPHA, res, SLV_TEXTURE_LINEAR};
    MUST(slv_texture_create(&env, &desc, &texture));
    for (uint32_t f = 0; f < count; f++) {
        size_t n = kit_texels(res[f]) * nchannels;
        float *values = calloc(n, sizeof *values);
        void *texels = calloc(n, slv_type_size(type));
        REQUIRE(values && texels);
        for (size_t i = 0; i < n; i++)
            values[i] = (float)(test_random(random) % 4096) / 4095.0f;
        slv_type_from_float(type, values, n, texels);
        MUST(slv_texture_set_face(texture, f, texels));
        free(values);
        free(texels);
    }
    free(res);
    return texture;
}

/* The kit of a mesh's sub-faces with the texture that shows `triangles`. */
static inline kit triangle_kit(const shape *s, const slv_texture *triangles) {
    slv_env env = test_env();
    const slv_texture_desc *desc;
    kit k = {.mesh = shape_mesh(&env, s)};
    MUST(slv_mesh_adjacency(&env, k.mesh, &k.adjacency));
    MUST(slv_triangle_texture(&env, triangles, k.adjacency, SLV_TEXTURE_AUTO, &k.texture));
    desc = slv_texture_get_desc(k.texture);
    k.nfaces = desc->nfaces;
    k.type = desc->type;
    k.nchannels = desc->nchannels;
    k.res = calloc(k.nfaces, sizeof *k.res);
    REQUIRE(k.res && k.nfaces == slv_mesh_face_count(k.mesh));
    memcpy(k.res, desc->res, k.nfaces * sizeof *k.res);
    kit_end_texture(&k);
    return k;
}

#endif
