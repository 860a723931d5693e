/* Small topologies, random textures, and a bilinear lookup in a bordered level, for the tests of
 * borders. */
#ifndef BORDER_KIT_H
#define BORDER_KIT_H

#include "kit/edge_kit.h"
#include "kit/test.h"

#include <selvage/border.h>
#include <selvage/mesh.h>

enum { KIT_POLYS = 256, KIT_VERTS = 1024 };

typedef struct kit {
    uint32_t npolys, nverts, npoly_verts;
    int32_t sizes[KIT_POLYS], verts[KIT_POLYS * 8];
    slv_mesh *mesh;
    slv_adjacency *adjacency;
    uint32_t nfaces;
    slv_res *res;
    slv_texture *texture;
    slv_levels *levels;
    slv_type type;
    uint32_t nchannels;
} kit;

static inline void kit_poly(kit *k, int32_t size, const int32_t *verts, uint32_t turn) {
    REQUIRE(k->npolys < KIT_POLYS);
    k->sizes[k->npolys++] = size;
    for (int32_t i = 0; i < size; i++) {
        int32_t vert = verts[((uint32_t)i + turn) % (uint32_t)size];
        k->verts[k->npoly_verts++] = vert;
        if ((uint32_t)vert >= k->nverts)
            k->nverts = (uint32_t)vert + 1;
    }
}

static inline void kit_finish(kit *k) {
    static float positions[3 * KIT_VERTS];
    slv_env env = test_env();
    slv_result result;
    for (uint32_t i = 0; i < 3 * k->nverts; i++)
        positions[i] = (float)i;
    slv_mesh_view view = {.nverts = k->nverts,
                          .positions = positions,
                          .npolys = k->npolys,
                          .poly_sizes = k->sizes,
                          .poly_verts = k->verts};
    result = slv_mesh_create(&env, &view, &k->mesh);
    REQUIRE(result == SLV_OK);
    result = slv_mesh_adjacency(&env, k->mesh, &k->adjacency);
    REQUIRE(result == SLV_OK);
    k->nfaces = slv_mesh_face_count(k->mesh);
    k->res = calloc(k->nfaces, sizeof *k->res);
    REQUIRE(k->res);
}

/* A grid of quads, row by row, of which some percent are split into two triangles. turns[i] (may be
 * NULL) says at which of its corners quad i starts, 0 being the lower left. */
static inline void kit_grid(kit *k, int32_t nx, int32_t ny, bool torus, uint32_t split_percent,
                            uint64_t *random, uint32_t *turns) {
    memset(k, 0, sizeof *k);
    int32_t vx = torus ? nx : nx + 1, vy = torus ? ny : ny + 1;
    for (int32_t y = 0; y < ny; y++) {
        for (int32_t x = 0; x < nx; x++) {
            int32_t x1 = (x + 1) % vx, y1 = (y + 1) % vy;
            int32_t quad[4] = {y * vx + x, y * vx + x1, y1 * vx + x1, y1 * vx + x};
            uint32_t turn = random ? test_random(random) % 4 : 0;
            if (split_percent && test_random(random) % 100 < split_percent) {
                int32_t a[3] = {quad[0], quad[1], quad[2]}, b[3] = {quad[0], quad[2], quad[3]};
                kit_poly(k, 3, a, turn % 3);
                kit_poly(k, 3, b, turn % 3);
            } else {
                kit_poly(k, 4, quad, turn);
            }
            if (turns)
                turns[y * nx + x] = turn;
        }
    }
    kit_finish(k);
}

/* `count` quads around vertex 0; closed. */
static inline void kit_disc(kit *k, int32_t count, uint64_t *random) {
    memset(k, 0, sizeof *k);
    for (int32_t i = 0; i < count; i++) {
        int32_t quad[4] = {0, 1 + 2 * i, 2 + 2 * i, 1 + 2 * ((i + 1) % count)};
        kit_poly(k, 4, quad, test_random(random) % 4);
    }
    kit_finish(k);
}

static inline void kit_cube(kit *k, uint64_t *random) {
    static const int32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                        {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    memset(k, 0, sizeof *k);
    for (int i = 0; i < 6; i++)
        kit_poly(k, 4, quads[i], test_random(random) % 4);
    kit_finish(k);
}

/* A pentagon with a quad on each side and another pentagon beyond: sub-faces of both next to whole
 * quads. */
static inline void kit_pentagons(kit *k, uint64_t *random) {
    memset(k, 0, sizeof *k);
    int32_t low[5], high[5];
    for (int32_t i = 0; i < 5; i++) {
        low[i] = i;
        high[i] = 5 + 4 - i;
    }
    kit_poly(k, 5, low, test_random(random) % 5);
    for (int32_t i = 0; i < 5; i++) {
        int32_t j = (i + 1) % 5, quad[4] = {j, i, 5 + i, 5 + j};
        kit_poly(k, 4, quad, test_random(random) % 4);
    }
    kit_poly(k, 5, high, test_random(random) % 5);
    kit_finish(k);
}

static inline bool kit_sub(const kit *k, uint32_t face) {
    return slv_adjacency_is_subface(k->adjacency, (int32_t)face);
}

/* Whole faces 2^r, sub-faces half of that, so that all texels are equally long. */
static inline void kit_equal(kit *k, int r) {
    for (uint32_t face = 0; face < k->nfaces; face++)
        k->res[face].u = k->res[face].v = (int8_t)(kit_sub(k, face) ? r - 1 : r);
}

static inline void kit_mixed(kit *k, int most, uint64_t *random) {
    for (uint32_t face = 0; face < k->nfaces; face++)
        k->res[face].u = k->res[face].v = (int8_t)(test_random(random) % (uint32_t)(most + 1));
}

static inline size_t kit_texels(slv_res res) {
    return (size_t)1 << (res.u + res.v);
}

static inline void kit_begin_texture(kit *k, slv_type type, uint32_t nchannels) {
    slv_env env = test_env();
    slv_result result;
    slv_texture_desc desc = {k->nfaces, type, nchannels, SLV_NO_ALPHA, k->res, SLV_TEXTURE_LINEAR};
    slv_texture_destroy(k->texture);
    slv_levels_destroy(k->levels);
    k->texture = NULL;
    k->levels = NULL;
    k->type = type;
    k->nchannels = nchannels;
    result = slv_texture_create(&env, &desc, &k->texture);
    REQUIRE(result == SLV_OK);
}

static inline void kit_set(kit *k, uint32_t face, const float *values) {
    size_t count = kit_texels(k->res[face]) * k->nchannels;
    slv_result result;
    void *texels = malloc(count * slv_type_size(k->type));
    REQUIRE(texels);
    slv_type_from_float(k->type, values, count, texels);
    result = slv_texture_set_face(k->texture, face, texels);
    REQUIRE(result == SLV_OK);
    free(texels);
}

static inline void kit_end_texture(kit *k) {
    slv_env env = test_env();
    slv_result result;
    result = slv_levels_create(&env, k->texture, &k->levels);
    REQUIRE(result == SLV_OK);
}

static inline void kit_noise(kit *k, slv_type type, uint32_t nchannels, uint64_t *random) {
    kit_begin_texture(k, type, nchannels);
    for (uint32_t face = 0; face < k->nfaces; face++) {
        size_t count = kit_texels(k->res[face]) * nchannels;
        float *values = malloc(count * sizeof *values);
        REQUIRE(values);
        for (size_t i = 0; i < count; i++)
            values[i] = (float)(test_random(random) % 4096) / 4095.0f;
        kit_set(k, face, values);
        free(values);
    }
    kit_end_texture(k);
}

static inline void kit_free(kit *k) {
    slv_levels_destroy(k->levels);
    slv_texture_destroy(k->texture);
    slv_adjacency_destroy(k->adjacency);
    slv_mesh_destroy(k->mesh);
    free(k->res);
    memset(k, 0, sizeof *k);
}

/* A bordered level. */
typedef struct kit_level {
    slv_res res;
    uint32_t bu, bv, nchannels;
    float *values;
    bool out_of_range;
} kit_level;

static inline size_t kit_level_size(const kit_level *level) {
    return (((size_t)1 << level->res.u) + 2 * level->bu) *
           (((size_t)1 << level->res.v) + 2 * level->bv) * level->nchannels;
}

static inline kit_level kit_build(const kit *k, uint32_t face, uint32_t level, uint32_t bu,
                                  uint32_t bv) {
    kit_level out = {.res = slv_res_level(k->res[face], level), .nchannels = k->nchannels};
    uint32_t width = 1u << out.res.u, height = 1u << out.res.v;
    out.bu = bu < width ? bu : width;
    out.bv = bv < height ? bv : height;
    out.values = malloc(kit_level_size(&out) * sizeof *out.values);
    REQUIRE(out.values);
    slv_result result = slv_border_build(k->levels, k->adjacency, face, level, out.bu, out.bv,
                                         out.values, &out.out_of_range);
    REQUIRE(result == SLV_OK);
    return out;
}

/* (x,y) may lie in the border. */
static inline const float *kit_texel(const kit_level *level, int32_t x, int32_t y) {
    size_t pitch = ((size_t)1 << level->res.u) + 2 * level->bu;
    return level->values +
           ((size_t)(y + (int32_t)level->bv) * pitch + (size_t)(x + (int32_t)level->bu)) *
               level->nchannels;
}

static inline float kit_lookup(const kit_level *level, double u, double v, uint32_t channel) {
    double x = u * (double)(1 << level->res.u) - 0.5, y = v * (double)(1 << level->res.v) - 0.5;
    int32_t x0 = (int32_t)floor(x), y0 = (int32_t)floor(y);
    /* On the far edge itself the cell is still the one that straddles it. */
    x0 = x0 > (1 << level->res.u) - 1 ? (1 << level->res.u) - 1 : x0;
    y0 = y0 > (1 << level->res.v) - 1 ? (1 << level->res.v) - 1 : y0;
    double fx = x - x0, fy = y - y0;
    return (float)((1 - fy) * ((1 - fx) * (double)kit_texel(level, x0, y0)[channel] +
                               fx * (double)kit_texel(level, x0 + 1, y0)[channel]) +
                   fy * ((1 - fx) * (double)kit_texel(level, x0, y0 + 1)[channel] +
                         fx * (double)kit_texel(level, x0 + 1, y0 + 1)[channel]));
}

#endif
