/* Places on faces of one size, most of them close to edges and corners, and what lookups on the CPU
 * give there: what strategies are held against. */
#ifndef SLV_TEST_POINT_KIT_H
#define SLV_TEST_POINT_KIT_H

#include "kit/border_kit.h"
#include "kit/edge_kit.h"
#include "kit/ptx_kit.h"

#include <selvage/filter.h>

enum { POINTS = 1024, LOG2_SIDE = 3 };

typedef struct points {
    int32_t faces[POINTS];
    float uv[2 * POINTS], dx[2 * POINTS], dy[2 * POINTS];
    float expected[4 * POINTS];
} points;

static inline float points_uniform(uint64_t *random) {
    return (float)(test_random(random) % 4096) / 4096;
}

/* `level`: how many texels wide the footprints are, as a power of two; 0: as good as none. */
static inline void points_place(const kit *k, int level, uint64_t *random, points *p) {
    for (int i = 0; i < POINTS; i++) {
        float width = level ? ldexpf(1, level - LOG2_SIDE) : 1e-3f;
        p->faces[i] = (int32_t)(test_random(random) % k->nfaces);
        for (int c = 0; c < 2; c++) {
            float at = points_uniform(random), near = at * at * 0.25f;
            p->uv[2 * i + c] = i % 2 ? at : test_random(random) % 2 ? near : 1 - near;
            p->uv[2 * i + c] = fminf(p->uv[2 * i + c], 0.999f);
        }
        p->dx[2 * i] = p->dy[2 * i + 1] = width;
        p->dx[2 * i + 1] = p->dy[2 * i] = 0;
    }
}

/* Bilinear lookups in the kit's texture, written as a file of that kind. */
static inline void points_look_up(const kit *k, const slv_ptx_write_params *how, points *p) {
    slv_env env = test_env();
    const char *path = scratch_path("points.ptx");
    slv_cache *cache = NULL;
    slv_sampler *sampler = NULL;
    slv_file_id file;
    const slv_filter_params bilinear = {.filter = SLV_FILTER_BILINEAR};
    REQUIRE(slv_ptx_save(&env, path, k->texture, k->adjacency, how) == SLV_OK);
    REQUIRE(slv_cache_create(&env, NULL, &cache) == SLV_OK);
    REQUIRE(slv_cache_open(cache, path, &file) == SLV_OK);
    REQUIRE(slv_sampler_create(cache, &bilinear, &sampler) == SLV_OK);
    for (int i = 0; i < POINTS; i++) {
        slv_lookup lookup = {.file = file,
                             .face = (uint32_t)p->faces[i],
                             .u = p->uv[2 * i],
                             .v = p->uv[2 * i + 1],
                             .uw1 = p->dx[2 * i],
                             .vw2 = p->dx[2 * i]};
        REQUIRE(slv_sample(sampler, &lookup, p->expected + 4 * i) == SLV_OK);
    }
    slv_sampler_destroy(sampler);
    slv_cache_destroy(cache);
    remove(path);
}

#endif
