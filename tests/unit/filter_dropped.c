/* What a lookup knows of a file may be thrown away whenever it waits for texels: here that happens
 * at the first read, the second, and so on. */
#include "kit/filter_kit.h"

#include "cache/cache_data.h"

#include <pthread.h>
#include <sched.h>
#include <sys/syscall.h>

enum { MANY = 60, READS = 10 };

static slv_cache *cache;
static slv_file_id id;
static _Atomic(int) reads_left; /* until the file is forgotten; -1: never */
static _Atomic(bool) wanted, stop;
static _Atomic(uint64_t) times, refused;

/* In the place of the C library's. */
SLV_API ssize_t pread(int descriptor, void *buffer, size_t size, off_t offset) {
    if (atomic_load(&reads_left) >= 0 && atomic_fetch_sub(&reads_left, 1) == 0) {
        atomic_store(&wanted, true);
        while (cache_find_tables(&cache->view, id))
            sched_yield();
    }
    return syscall(SYS_pread64, descriptor, buffer, size, offset);
}

static void *forget(void *user) {
    (void)user;
    while (!atomic_load(&stop)) {
        if (!atomic_exchange(&wanted, false)) {
            sched_yield();
            continue;
        }
        /* the test's own counters are of the main thread alone */
        atomic_fetch_add(&refused, slv_cache_invalidate(cache, id) != SLV_OK);
        atomic_fetch_add(&times, 1);
    }
    return NULL;
}

static void try_all(const slv_lookup *lookups, const slv_filter_params *params) {
    slv_sampler *sampler = kit_sampler(cache, params);
    for (int i = 0; i < MANY; i++) {
        float expected[3], out[3];
        atomic_store(&reads_left, -1);
        CHECK(slv_sample(sampler, &lookups[i], expected) == SLV_OK);
        for (int n = 0; n < READS; n++) {
            /* reads of tables do not count: only what is linked can be forgotten */
            slv_lookup point = {.file = id, .uw1 = 4, .vw2 = 4};
            CHECK(slv_cache_invalidate(cache, id) == SLV_OK);
            CHECK(slv_sample(sampler, &point, out) == SLV_OK);
            atomic_store(&reads_left, n);
            CHECK(slv_sample(sampler, &lookups[i], out) == SLV_OK);
            CHECK(memcmp(out, expected, sizeof out) == 0);
        }
    }
    atomic_store(&reads_left, -1);
    slv_sampler_destroy(sampler);
}

int main(void) {
    static slv_lookup lookups[MANY];
    static const slv_filter_params params[] = {
        {.filter = SLV_FILTER_POINT, .nchannels = 3},
        {.filter = SLV_FILTER_GAUSSIAN, .lerp = true, .nchannels = 3},
        {.filter = SLV_FILTER_BSPLINE, .nchannels = 3},
        {.filter = SLV_FILTER_ANISOTROPIC, .nchannels = 3},
    };
    const char *triangles = data_folder();
    pthread_t thread;
    atomic_store(&reads_left, -1);
    for (int shape = 0; shape < 3; shape++) {
        uint64_t random = 61;
        uint32_t nfaces;
        char path[1100];
        kit k;
        cache = kit_cache(0, 0);
        if (shape == 2) {
            slv_ptx_info info;
            if (!triangles)
                continue;
            snprintf(path, sizeof path, "%s/tri_closed_half_4.ptx", triangles);
            id = kit_open(cache, path);
            CHECK(slv_cache_get_info(cache, id, &info) == SLV_OK);
            nfaces = info.nfaces;
        } else {
            snprintf(path, sizeof path, "%s", scratch_path("dropped.ptx"));
            if (shape)
                kit_grid(&k, 4, 4, true, 30, &random, NULL);
            else
                kit_pentagons(&k, &random);
            kit_equal(&k, 4);
            kit_noise(&k, SLV_TYPE_U8, 3, &random);
            kit_save(&k, path, NULL);
            id = kit_open(cache, path);
            nfaces = k.nfaces;
            kit_free(&k);
        }
        for (int i = 0; i < MANY; i++) {
            slv_lookup l = {.file = id, .face = (uint32_t)i % nfaces};
            l.u = kit_unit(&random);
            l.v = kit_unit(&random);
            l.uw1 = powf(2, -6 * kit_unit(&random));
            l.vw2 = powf(2, -6 * kit_unit(&random));
            lookups[i] = l;
        }
        atomic_store(&stop, false);
        REQUIRE(pthread_create(&thread, NULL, forget, NULL) == 0);
        for (size_t p = 0; p < sizeof params / sizeof *params; p++)
            try_all(lookups, &params[p]);
        atomic_store(&stop, true);
        pthread_join(thread, NULL);
        slv_cache_destroy(cache);
        if (shape < 2)
            unlink(path);
    }
    CHECK_MSG(refused == 0, "not forgotten %llu times", (unsigned long long)refused);
    CHECK_MSG(times > MANY, "only forgotten %llu times", (unsigned long long)times);
    return test_end();
}
