/* Lookups compiled for AVX2 and for any processor give the same bytes. */
#include "kit/filter_kit.h"

#include "filter/variants.h"

enum { MANY = 500 };

static uint64_t compared;

static void compare(const char *path) {
    static const slv_filter_params all[] = {
        {.filter = SLV_FILTER_POINT},
        {.filter = SLV_FILTER_BILINEAR},
        {.filter = SLV_FILTER_BOX, .blur = 0.1f},
        {.filter = SLV_FILTER_GAUSSIAN, .lerp = true},
        {.filter = SLV_FILTER_BICUBIC, .sharpness = 0.3f, .first_channel = 1},
        {.filter = SLV_FILTER_BSPLINE, .lerp = true},
        {.filter = SLV_FILTER_CATMULL_ROM, .no_edge_blend = true},
        {.filter = SLV_FILTER_MITCHELL, .width = 3},
        {.filter = SLV_FILTER_ANISOTROPIC},
    };
    static slv_lookup lookups[MANY];
    slv_cache *cache = kit_cache(0, 0);
    slv_file_id id = kit_open(cache, path);
    slv_ptx_info info;
    uint64_t random = 41;
    CHECK(slv_cache_get_info(cache, id, &info) == SLV_OK);
    for (int i = 0; info.nfaces && i < MANY; i++)
        lookups[i] = kit_lookup_any(id, info.nfaces, &random);
    for (size_t p = 0; info.nfaces && p < sizeof all / sizeof *all; p++) {
        size_t count = (size_t)MANY * info.nchannels;
        float *out[3] = {NULL, NULL, NULL};
        for (int way = 0; way < 3; way++) {
            slv_sampler *sampler = kit_sampler(cache, &all[p]);
            out[way] = calloc(count, sizeof **out);
            REQUIRE(out[way]);
            sampler->functions =
                way == 0 ? slvi_lookup_portable[all[p].filter] : slvi_lookup_avx2[all[p].filter];
            if (way < 2)
                CHECK(slv_sample_batch(sampler, lookups, MANY, out[way], info.nchannels, NULL) ==
                      SLV_OK);
            else
                for (int i = 0; i < MANY; i++)
                    CHECK(slv_sample(sampler, &lookups[i], out[way] + (size_t)i * info.nchannels) ==
                          SLV_OK);
            slv_sampler_destroy(sampler);
        }
        for (int way = 1; way < 3; way++)
            CHECK_MSG(memcmp(out[0], out[way], count * sizeof **out) == 0, "%s, %s: not the same",
                      path, slv_filter_name(all[p].filter));
        compared += count;
        for (int way = 0; way < 3; way++)
            free(out[way]);
    }
    slv_cache_destroy(cache);
}

int main(void) {
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("bmi2")) {
        fprintf(stderr, "this processor has no AVX2: nothing to compare\n");
        return 77;
    }
    CHECK(each_sample(compare) > 0 && compared > 0);
    return test_end();
}
