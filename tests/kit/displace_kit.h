/* Displacements for tests: random texels of random resolutions on any mesh, and whether what comes
 * of them is closed. */
#ifndef SLV_TEST_DISPLACE_KIT_H
#define SLV_TEST_DISPLACE_KIT_H

#include "kit/mesh_shapes.h"

#include <selvage/displacement.h>

typedef struct displaced {
    slv_mesh *mesh;
    slv_adjacency *adjacency;
    slv_surface *surface;
    slv_texture *texture;
    slv_cache *cache;
    slv_displacement displacement;
} displaced;

/* Three channels of noise in -1..1 for a mesh, which is taken. */
static inline displaced displaced_make(slv_mesh *mesh, slv_scheme scheme, int max_log2,
                                       const slv_displacement_params *params, uint64_t *random) {
    slv_env env = test_env();
    displaced d = {.mesh = mesh};
    uint32_t nfaces = slv_mesh_face_count(mesh);
    slv_res *res = calloc(nfaces + 1, sizeof *res);
    float *texels = calloc((size_t)3 << 2 * max_log2, sizeof *texels);
    REQUIRE(res && texels);
    for (uint32_t f = 0; f < nfaces; f++)
        res[f] = (slv_res){(int8_t)(test_random(random) % (uint32_t)(max_log2 + 1)),
                           (int8_t)(test_random(random) % (uint32_t)(max_log2 + 1))};
    const slv_texture_desc desc = {nfaces, SLV_TYPE_FLOAT, 3, SLV_NO_ALPHA, res, SLV_TEXTURE_DATA};
    const slv_surface_params surface = {.scheme = scheme};
    slv_source source;
    slv_file_id file;
    MUST(slv_mesh_adjacency(&env, mesh, &d.adjacency));
    MUST(slv_surface_create(&env, mesh, &surface, &d.surface));
    MUST(slv_texture_create(&env, &desc, &d.texture));
    for (uint32_t f = 0; f < nfaces; f++) {
        for (size_t i = 0; i < (size_t)3 << (res[f].u + res[f].v); i++)
            texels[i] = (float)(test_random(random) % 2001) / 1000 - 1;
        MUST(slv_texture_set_face(d.texture, f, texels));
    }
    MUST(slv_cache_create(&env, NULL, &d.cache));
    MUST(slv_texture_as_source(&env, d.texture, d.adjacency, NULL, &source));
    MUST(slv_cache_open_source(d.cache, &source, NULL, &file));
    MUST(slv_displacement_open(d.cache, file, params, &d.displacement));
    free(res);
    free(texels);
    return d;
}

static inline void displaced_free(displaced *d) {
    slv_displacement_close(&d->displacement);
    slv_cache_destroy(d->cache);
    slv_texture_destroy(d->texture);
    slv_surface_destroy(d->surface);
    slv_adjacency_destroy(d->adjacency);
    slv_mesh_destroy(d->mesh);
}

/* A side of a triangle, its ends in one order, and which way it is walked along. */
typedef struct displaced_side {
    float ends[6];
    int way;
} displaced_side;

static inline int displaced_compare(const void *a, const void *b) {
    return memcmp(((const displaced_side *)a)->ends, ((const displaced_side *)b)->ends,
                  sizeof(float) * 6);
}

static inline void displaced_add_side(displaced_side *to, const slv_vertex *a,
                                      const slv_vertex *b) {
    int order = memcmp(a->position, b->position, sizeof a->position);
    memcpy(to->ends, order < 0 ? a->position : b->position, sizeof a->position);
    memcpy(to->ends + 3, order < 0 ? b->position : a->position, sizeof a->position);
    to->way = order < 0 ? 1 : order > 0 ? -1 : 0;
}

/* How many sides of triangles have no other that runs the other way between the very same
 * positions: all that borders on nothing. */
static inline uint32_t displaced_open_sides(const slv_tessellation *t) {
    uint32_t count = 0, nindices = 0, open = 0, at = 0;
    for (uint32_t f = 0; f < t->nfaces; f++)
        nindices += slv_tessellation_indices(t, f, NULL);
    uint32_t *indices = calloc(nindices + 1, sizeof *indices);
    displaced_side *sides = calloc(nindices + 1, sizeof *sides);
    REQUIRE(indices && sides);
    for (uint32_t f = 0; f < t->nfaces; f++)
        at += slv_tessellation_indices(t, f, indices + at);
    for (uint32_t i = 0; i < nindices; i += 3)
        for (uint32_t k = 0; k < 3; k++)
            displaced_add_side(&sides[count++], t->vertices + indices[i + k],
                               t->vertices + indices[i + (k + 1) % 3]);
    qsort(sides, count, sizeof *sides, displaced_compare);
    for (uint32_t i = 0, end; i < count; i = end) {
        int sum = 0;
        for (end = i; end < count && displaced_compare(sides + i, sides + end) == 0; end++)
            sum += sides[end].way;
        open += (uint32_t)abs(sum);
    }
    free(indices);
    free(sides);
    return open;
}

/* How many segments lie along a face's edge, told by how many of its points differ. */
static inline uint32_t displaced_edge_segments(const slv_tessellation *t, uint32_t face,
                                               unsigned edge) {
    uint32_t n = t->segments[face], count = 0;
    const slv_vertex *v = t->vertices + t->first[face], *before = NULL;
    for (uint32_t k = 0; k <= n; k++) {
        uint32_t x = edge == 1 ? n : edge == 3 ? 0 : k, y = edge == 2 ? n : edge == 0 ? 0 : k;
        const slv_vertex *here = v + y * (n + 1) + x;
        count += before && memcmp(before->position, here->position, sizeof here->position) != 0;
        before = here;
    }
    return count;
}

/* Where a face has no neighbour at all, its own sides are the only ones. */
static inline uint32_t displaced_boundary(const displaced *d, const slv_tessellation *t) {
    uint32_t count = 0;
    for (uint32_t f = 0; f < t->nfaces; f++)
        for (unsigned e = 0; e < 4 && t->segments[f]; e++) {
            slv_neighbour other[2];
            if (!slv_adjacency_neighbours(d->adjacency, (int32_t)f, e, other))
                count += displaced_edge_segments(t, f, e);
        }
    return count;
}

#endif
