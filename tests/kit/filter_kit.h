/* Files, caches and lookups for the tests of filters. */
#ifndef SLV_FILTER_KIT_H
#define SLV_FILTER_KIT_H

#include "kit/border_kit.h"
#include "kit/ptx_kit.h"

#include <selvage/filter.h>

static inline void kit_save(const kit *k, const char *path, const slv_ptx_write_params *params) {
    slv_env env = test_env();
    slv_result result = slv_ptx_save(&env, path, k->texture, k->adjacency, params);
    REQUIRE(result == SLV_OK);
}

static inline float kit_unit(uint64_t *random) {
    return (float)test_random(random) / 2147483648.0f;
}

/* Noise that packs well, so that files are small and quickly read. */
static inline void kit_rough(kit *k, slv_type type, uint32_t nchannels, uint64_t *random) {
    kit_begin_texture(k, type, nchannels);
    for (uint32_t face = 0; face < k->nfaces; face++) {
        size_t count = kit_texels(k->res[face]) * nchannels;
        float *values = malloc(count * sizeof *values);
        REQUIRE(values);
        for (size_t i = 0; i < count; i++)
            values[i] = i >= 64 && test_random(random) % 8
                            ? values[i - 64]
                            : (float)(test_random(random) % 200) / 255.0f;
        kit_set(k, face, values);
        free(values);
    }
    kit_end_texture(k);
}

static inline slv_cache *kit_cache(uint64_t max_bytes, uint32_t max_files) {
    slv_env env = test_env();
    slv_cache_params params = {.max_bytes = max_bytes, .max_files = max_files};
    slv_cache *cache = NULL;
    slv_result result = slv_cache_create(&env, &params, &cache);
    REQUIRE(result == SLV_OK);
    return cache;
}

static inline slv_file_id kit_open(slv_cache *cache, const char *path) {
    slv_file_id id = 0;
    slv_result result = slv_cache_open(cache, path, &id);
    REQUIRE(result == SLV_OK && id);
    return id;
}

static inline slv_sampler *kit_sampler(slv_cache *cache, const slv_filter_params *params) {
    slv_sampler *sampler = NULL;
    slv_result result = slv_sampler_create(cache, params, &sampler);
    REQUIRE(result == SLV_OK);
    return sampler;
}

/* Mostly a few texels wide, sometimes as wide as the face or wider, and sometimes outside of it. */
static inline slv_lookup kit_lookup_any(slv_file_id file, uint32_t nfaces, uint64_t *random) {
    slv_lookup l = {.file = file, .face = test_random(random) % nfaces};
    float size = powf(2, -9 * kit_unit(random) + 1), outside = 1 + 0.25f * kit_unit(random);
    bool inside = test_random(random) % 4 != 0;
    l.u = inside ? kit_unit(random) : 0.5f + (kit_unit(random) - 0.5f) * outside;
    l.v = inside ? kit_unit(random) : 0.5f + (kit_unit(random) - 0.5f) * outside;
    l.uw1 = size * (kit_unit(random) - 0.25f);
    l.vw1 = size * (kit_unit(random) - 0.5f);
    l.uw2 = size * (kit_unit(random) - 0.5f);
    l.vw2 = size * (kit_unit(random) - 0.25f);
    return l;
}

#endif
