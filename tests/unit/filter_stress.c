/* Many threads on one small cache: every value is that of a cache that holds everything, whatever
 * is opened, closed, forgotten, read ahead or thrown away meanwhile.
 *
 * test_unit_filter_stress [SECONDS [SEED]] */
#include "kit/filter_kit.h"

#include "cache/cache_data.h"

#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

enum { FILES = 9, LOOKUPS = 160, PARAMS = 6, THREADS = 8, SLOTS = 7, ROOM = 5, GROUP = 24 };

static const slv_filter_params all_params[PARAMS] = {
    {.filter = SLV_FILTER_POINT, .nchannels = ROOM},
    {.filter = SLV_FILTER_BOX, .nchannels = ROOM},
    {.filter = SLV_FILTER_GAUSSIAN, .lerp = true, .nchannels = ROOM},
    {.filter = SLV_FILTER_BICUBIC, .sharpness = 0.7f, .nchannels = ROOM},
    {.filter = SLV_FILTER_BSPLINE, .blur = 0.2f, .nchannels = ROOM},
    {.filter = SLV_FILTER_ANISOTROPIC, .nchannels = ROOM},
};

static char paths[FILES][1100];
static uint32_t nfaces[FILES];
static slv_lookup lookups[FILES][LOOKUPS];
static float expected[FILES][PARAMS][LOOKUPS][ROOM];

struct shared {
    slv_cache *cache;
    _Atomic(uint64_t) slots[SLOTS]; /* id, and the file in the low 8 bits; or 0 */
    _Atomic(bool) stop;
    uint64_t seed;
};

struct worker {
    struct shared *shared;
    uint64_t random, lookups, closed, wrong, odd;
};

static void make_files(void) {
    uint64_t random = 7;
    for (int i = 0; i < FILES; i++) {
        kit k;
        const char *triangles = data_folder();
        if (i == FILES - 1 && triangles) {
            slv_ptx *ptx;
            slv_env env = test_env();
            snprintf(paths[i], sizeof paths[i], "%s/tri_closed_half_4.ptx", triangles);
            REQUIRE(slv_ptx_open(&env, paths[i], &ptx) == SLV_OK);
            nfaces[i] = slv_ptx_get_info(ptx)->nfaces;
            slv_ptx_close(ptx);
            continue;
        }
        char name[32];
        snprintf(name, sizeof name, "stress-%d.ptx", i);
        snprintf(paths[i], sizeof paths[i], "%s", scratch_path(name));
        if (i % 3 == 0)
            kit_pentagons(&k, &random);
        else if (i % 3 == 1)
            kit_grid(&k, 4, 4, true, 30, &random, NULL);
        else
            kit_cube(&k, &random);
        if (i % 2)
            kit_equal(&k, i == 5 ? 9 : 7);
        else
            kit_mixed(&k, i == 0 ? 4 : 8, &random);
        kit_rough(&k, (slv_type)(i % 4), 1 + (uint32_t)i % ROOM, &random);
        kit_save(&k, paths[i], NULL);
        nfaces[i] = k.nfaces;
        kit_free(&k);
    }
}

static void make_expected(void) {
    slv_cache *cache = kit_cache(UINT64_C(1) << 30, 100);
    uint64_t random = 11;
    for (int i = 0; i < FILES; i++) {
        slv_file_id id = kit_open(cache, paths[i]);
        for (int l = 0; l < LOOKUPS; l++)
            lookups[i][l] = kit_lookup_any(id, nfaces[i], &random);
        for (int p = 0; p < PARAMS; p++) {
            slv_sampler *sampler = kit_sampler(cache, &all_params[p]);
            for (int l = 0; l < LOOKUPS; l++) {
                slv_result result = slv_sample(sampler, &lookups[i][l], expected[i][p][l]);
                CHECK(result == SLV_OK);
            }
            slv_sampler_destroy(sampler);
        }
    }
    slv_cache_stats stats;
    slv_cache_get_stats(cache, &stats);
    CHECK(stats.evictions == 0 && stats.bytes > UINT64_C(9) << 20);
    slv_cache_destroy(cache);
}

static void look(struct worker *w, slv_sampler **samplers, void *workspace) {
    struct shared *s = w->shared;
    slv_lookup group[GROUP];
    uint64_t before[GROUP], slot[GROUP];
    int which[GROUP], p = (int)(test_random(&w->random) % PARAMS);
    float out[GROUP][ROOM];
    slv_result results[GROUP];
    size_t n = 1 + test_random(&w->random) % GROUP;
    int mode = (int)(test_random(&w->random) % 3);
    for (size_t i = 0; i < n; i++) {
        do {
            slot[i] = test_random(&w->random) % SLOTS;
            before[i] = atomic_load(&s->slots[slot[i]]);
        } while (!before[i]);
        which[i] = (int)(test_random(&w->random) % LOOKUPS);
        group[i] = lookups[before[i] & 255][which[i]];
        group[i].file = (slv_file_id)(before[i] >> 8);
    }
    memset(out, 0x7f, sizeof out);
    if (mode == 0)
        for (size_t i = 0; i < n; i++)
            results[i] = slv_sample(samplers[p], &group[i], out[i]);
    else if (mode == 1)
        test_ignore(slv_sample_batch(samplers[p], group, n, out[0], ROOM, results));
    else
        test_ignore(slv_sample_sorted(samplers[p], group, n, out[0], ROOM, results, workspace));
    for (size_t i = 0; i < n; i++) {
        static const float zeros[ROOM];
        bool closed = results[i] == SLV_ERROR_ARGUMENT;
        const float *right = closed ? zeros : expected[before[i] & 255][p][which[i]];
        w->wrong += memcmp(out[i], right, sizeof out[i]) != 0;
        w->odd += results[i] && (!closed || atomic_load(&s->slots[slot[i]]) == before[i]);
        w->closed += closed;
    }
    w->lookups += n;
}

static void swap_file(struct worker *w, slv_sampler *sampler) {
    struct shared *s = w->shared;
    uint32_t slot = test_random(&w->random) % SLOTS, file = test_random(&w->random) % FILES;
    uint64_t held = atomic_exchange(&s->slots[slot], 0);
    slv_lookup l = lookups[0][0];
    float out[ROOM];
    slv_file_id id;
    if (!held)
        return;
    l.file = (slv_file_id)(held >> 8);
    w->odd += slv_cache_close(s->cache, l.file) != SLV_OK;
    w->odd += slv_cache_close(s->cache, l.file) != SLV_ERROR_ARGUMENT;
    w->odd += slv_sample(sampler, &l, out) != SLV_ERROR_ARGUMENT;
    w->odd += slv_cache_open(s->cache, paths[file], &id) != SLV_OK;
    atomic_store(&s->slots[slot], (uint64_t)id << 8 | file);
}

static void *work(void *user) {
    struct worker *w = user;
    struct shared *s = w->shared;
    slv_sampler *samplers[PARAMS];
    void *workspace = malloc(slv_sample_workspace(GROUP));
    for (int p = 0; p < PARAMS; p++)
        w->odd += slv_sampler_create(s->cache, &all_params[p], &samplers[p]) != SLV_OK;
    while (!atomic_load(&s->stop)) {
        uint64_t held = atomic_load(&s->slots[test_random(&w->random) % SLOTS]);
        slv_file_id id = (slv_file_id)(held >> 8);
        uint32_t dice = test_random(&w->random) % 256;
        if (dice < 16) {
            test_ignore(
                slv_cache_prefetch(s->cache, id, test_random(&w->random) % nfaces[held & 255]));
        } else if (dice < 20) {
            test_ignore(slv_cache_invalidate(s->cache, id));
        } else if (dice == 20) {
            CHECK(!slv_cache_invalidate(s->cache, 0));
        } else if (dice < 26) {
            swap_file(w, samplers[0]);
        } else if (dice == 26) {
            slv_cache_wait(s->cache);
        } else if (dice < 30) {
            slv_cache_stats stats;
            slv_cache_get_stats(s->cache, &stats);
            w->odd += stats.bytes > UINT64_C(8) << 20 || stats.handles > 3 + THREADS + 1;
        } else if (dice == 30) {
            int p = (int)(test_random(&w->random) % PARAMS);
            slv_sampler_destroy(samplers[p]);
            w->odd += slv_sampler_create(s->cache, &all_params[p], &samplers[p]) != SLV_OK;
        } else {
            look(w, samplers, workspace);
        }
    }
    for (int p = 0; p < PARAMS; p++)
        slv_sampler_destroy(samplers[p]);
    free(workspace);
    return NULL;
}

static void stress(double seconds, uint64_t seed, bool fences) {
    struct shared s = {.cache = kit_cache(UINT64_C(8) << 20, 3), .seed = seed};
    struct worker workers[THREADS];
    pthread_t threads[THREADS];
    uint64_t lookups_done = 0, closed = 0;
    if (fences)
        s.cache->view.fences = true;
    for (uint32_t i = 0; i < SLOTS; i++)
        atomic_store(&s.slots[i], (uint64_t)kit_open(s.cache, paths[i % FILES]) << 8 | i % FILES);
    for (uint64_t i = 0; i < THREADS; i++) {
        workers[i] = (struct worker){.shared = &s, .random = seed * 1000 + i};
        REQUIRE(pthread_create(&threads[i], NULL, work, &workers[i]) == 0);
    }
    struct timespec time = {(time_t)seconds, (long)((seconds - floor(seconds)) * 1e9)};
    nanosleep(&time, NULL);
    atomic_store(&s.stop, true);
    for (int i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        CHECK_MSG(!workers[i].wrong, "%llu of %llu values are wrong",
                  (unsigned long long)workers[i].wrong, (unsigned long long)workers[i].lookups);
        CHECK_MSG(!workers[i].odd, "%llu results are not what they should be: %s",
                  (unsigned long long)workers[i].odd, test_last_log);
        lookups_done += workers[i].lookups;
        closed += workers[i].closed;
    }
    slv_cache_stats stats;
    slv_cache_get_stats(s.cache, &stats);
    fprintf(stderr,
            "seed %llu%s: %llu lookups, %llu in closed files, %llu misses, %llu evictions, "
            "%llu reloads, %llu handles reopened\n",
            (unsigned long long)seed, fences ? ", fences" : "", (unsigned long long)lookups_done,
            (unsigned long long)closed, (unsigned long long)stats.misses,
            (unsigned long long)stats.evictions, (unsigned long long)stats.reloaded,
            (unsigned long long)stats.reopened);
    CHECK(stats.peak_bytes <= UINT64_C(8) << 20 && stats.handles <= 3);
    CHECK(lookups_done > 0 && stats.files == SLOTS);
    slv_cache_destroy(s.cache);
}

struct share {
    slv_cache *cache;
    const slv_lookup *lookups;
    float (*out)[ROOM];
    size_t count;
    slv_result result; /* looked at when the thread has ended: the kit counts on one thread */
};

static void *sample_share(void *user) {
    struct share *share = user;
    slv_sampler *sampler;
    if ((share->result = slv_sampler_create(share->cache, &all_params[2], &sampler)))
        return NULL;
    share->result =
        slv_sample_batch(sampler, share->lookups, share->count, share->out[0], ROOM, NULL);
    slv_sampler_destroy(sampler);
    return NULL;
}

static void test_thread_counts(void) {
    enum { COUNT = FILES * LOOKUPS };
    static slv_lookup all[COUNT];
    static float out[2][COUNT][ROOM];
    for (int i = 0; i < COUNT; i++)
        all[i] = lookups[i % FILES][i / FILES];
    for (int turn = 0; turn < 2; turn++) {
        slv_cache *cache = kit_cache(UINT64_C(8) << 20, 2);
        size_t count = turn ? THREADS : 1;
        pthread_t threads[THREADS];
        struct share shares[THREADS];
        for (int i = 0; i < FILES; i++) {
            slv_file_id id = kit_open(cache, paths[i]);
            for (int l = i; l < COUNT; l += FILES)
                all[l].file = id;
        }
        for (size_t i = 0; i < count; i++) {
            size_t first = COUNT * i / count, end = COUNT * (i + 1) / count;
            shares[i] = (struct share){cache, all + first, out[turn] + first, end - first, SLV_OK};
            REQUIRE(pthread_create(&threads[i], NULL, sample_share, &shares[i]) == 0);
        }
        for (size_t i = 0; i < count; i++) {
            pthread_join(threads[i], NULL);
            CHECK(shares[i].result == SLV_OK);
        }
        slv_cache_destroy(cache);
    }
    CHECK(memcmp(out[0], out[1], sizeof out[0]) == 0);
    for (int i = 0; i < COUNT; i++)
        CHECK(memcmp(out[0][i], expected[i % FILES][2][i / FILES], sizeof out[0][i]) == 0);
}

int main(int argc, char **argv) {
    double seconds = argc > 1 ? strtod(argv[1], NULL) : TEST_SANITIZED ? 2 : 0.4 * test_effort(1);
    uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    make_files();
    make_expected();
    test_thread_counts();
    stress(seconds, seed, false);
    stress(seconds, seed, true);
    for (int i = 0; i < FILES; i++)
        if (strstr(paths[i], "stress-"))
            unlink(paths[i]);
    return test_end();
}
