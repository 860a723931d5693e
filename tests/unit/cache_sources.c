/* Sources in a cache: coarser than they are, changed face by face, and changed while many threads
 * look. */
#include "kit/filter_kit.h"

#include <pthread.h>
#include <stdatomic.h>

enum { MANY = 150, ROOM = 4 };

static const slv_filter_params all_params[] = {
    {.filter = SLV_FILTER_POINT, .nchannels = ROOM},
    {.filter = SLV_FILTER_BILINEAR, .nchannels = ROOM},
    {.filter = SLV_FILTER_BOX, .nchannels = ROOM},
    {.filter = SLV_FILTER_GAUSSIAN, .lerp = true, .nchannels = ROOM},
    {.filter = SLV_FILTER_BICUBIC, .sharpness = 0.4f, .nchannels = ROOM},
    {.filter = SLV_FILTER_BSPLINE, .no_edge_blend = true, .nchannels = ROOM},
    {.filter = SLV_FILTER_CATMULL_ROM, .blur = 0.1f, .nchannels = ROOM},
    {.filter = SLV_FILTER_MITCHELL, .lerp = true, .nchannels = ROOM},
    {.filter = SLV_FILTER_ANISOTROPIC, .nchannels = ROOM},
};
enum { PARAMS = sizeof all_params / sizeof *all_params };

/* How many lookups of all filters are not the same, bit for bit, in two files of two caches. */
static int different(slv_cache *a, slv_file_id in_a, slv_cache *b, slv_file_id in_b,
                     uint32_t nfaces, uint64_t seed) {
    int count = 0;
    for (int p = 0; p < PARAMS; p++) {
        slv_sampler *one = kit_sampler(a, &all_params[p]), *two = kit_sampler(b, &all_params[p]);
        uint64_t random = seed;
        for (int i = 0; i < MANY; i++) {
            float x[ROOM], y[ROOM];
            slv_lookup l = kit_lookup_any(in_a, nfaces, &random);
            slv_result result = slv_sample(one, &l, x);
            l.file = in_b;
            count += result || slv_sample(two, &l, y) || memcmp(x, y, sizeof x) != 0;
        }
        slv_sampler_destroy(one);
        slv_sampler_destroy(two);
    }
    return count;
}

static slv_file_id open_store(slv_cache *cache, const slv_texture *texture,
                              const slv_adjacency *adjacency) {
    slv_env env = test_env();
    slv_source source;
    slv_file_id id = 0;
    slv_result result = slv_texture_as_source(&env, texture, adjacency, NULL, &source);
    REQUIRE(result == SLV_OK);
    result = slv_cache_open_source(cache, &source, NULL, &id);
    REQUIRE(result == SLV_OK && id);
    return id;
}

/* A capped file is one that was painted at that resolution. */
static void test_cap(void) {
    uint64_t random = 3;
    char fine[1100], coarse[1100];
    slv_env env = test_env();
    kit k, low;
    kit_pentagons(&k, &random);
    kit_equal(&k, 6);
    kit_noise(&k, SLV_TYPE_U8, 3, &random);
    random = 3;
    kit_pentagons(&low, &random);
    for (uint32_t i = 0; i < low.nfaces; i++)
        low.res[i] = (slv_res){4, 4};
    kit_begin_texture(&low, SLV_TYPE_U8, 3);
    snprintf(fine, sizeof fine, "%s", scratch_path("fine.ptx"));
    snprintf(coarse, sizeof coarse, "%s", scratch_path("coarse.ptx"));
    kit_save(&k, fine, NULL);
    slv_ptx *ptx = NULL;
    REQUIRE(slv_ptx_open(&env, fine, &ptx) == SLV_OK);
    for (uint32_t i = 0; i < low.nfaces; i++) {
        uint8_t texels[3 * 256];
        CHECK(slv_ptx_read_face(ptx, i, (slv_res){4, 4}, texels) == SLV_OK);
        CHECK(slv_texture_set_face(low.texture, i, texels) == SLV_OK);
    }
    slv_ptx_close(ptx);
    kit_save(&low, coarse, NULL);
    slv_cache *cache = kit_cache(0, 0);
    slv_file_id is = 0, should = kit_open(cache, coarse), whole = kit_open(cache, fine), of_store;
    const slv_cache_open_params params = {.max_log2_res = 4};
    slv_source source;
    CHECK(slv_cache_open_with(cache, fine, &params, &is) == SLV_OK);
    CHECK(different(cache, is, cache, should, k.nfaces, 8) == 0);
    CHECK(different(cache, whole, cache, should, k.nfaces, 8) > MANY);
    CHECK(slv_texture_as_source(&env, k.texture, k.adjacency, NULL, &source) == SLV_OK);
    CHECK(slv_cache_open_source(cache, &source, &params, &of_store) == SLV_OK);
    CHECK(different(cache, of_store, cache, should, k.nfaces, 9) == 0);
    slv_cache_destroy(cache);
    unlink(fine);
    unlink(coarse);
    kit_free(&k);
    kit_free(&low);
}

/* A store that is painted on: what the cache shows is the old until it is told, and then what one
 * that was opened afresh shows. */
static void test_painting(slv_type type, uint32_t nchannels, uint64_t seed) {
    slv_cache *cache = kit_cache(0, 0);
    uint64_t random = seed;
    kit k;
    kit_pentagons(&k, &random);
    for (uint32_t face = 0; face < k.nfaces; face++)
        k.res[face] = (slv_res){(int8_t)(test_random(&random) % 8),
                                (int8_t)(test_random(&random) % (face == 3 ? 11 : 6))};
    kit_begin_texture(&k, type, nchannels); /* all is constant at first */
    slv_file_id id = open_store(cache, k.texture, k.adjacency);
    for (int turn = 0; turn < 12; turn++) {
        float values[4096];
        uint8_t texels[4096 * sizeof(float)];
        for (int dabs = 0; dabs < 1 + turn % 3; dabs++) {
            uint32_t face = test_random(&random) % k.nfaces;
            uint32_t width = 1u << k.res[face].u, height = 1u << k.res[face].v;
            slv_rect rect = {test_random(&random) % width, test_random(&random) % height, 1, 1};
            rect.width += test_random(&random) % (width - rect.x);
            rect.height += test_random(&random) % (height - rect.y);
            while (rect.width * rect.height * nchannels > 4096)
                rect.height /= 2;
            for (uint32_t i = 0; i < rect.width * rect.height * nchannels; i++)
                values[i] = turn % 4 == 3 ? 0 : (float)(test_random(&random) % 256) / 255;
            slv_type_from_float(type, values, rect.width * rect.height * nchannels, texels);
            CHECK(slv_texture_set_rect(k.texture, face, rect, texels) == SLV_OK);
        }
        slv_cache *fresh = kit_cache(0, 0);
        slv_file_id now = open_store(fresh, k.texture, k.adjacency);
        CHECK(slv_cache_refresh(cache, id) == SLV_OK);
        CHECK_MSG(different(cache, id, fresh, now, k.nfaces, seed + (uint64_t)turn) == 0,
                  "turn %d of %s: something old was kept", turn, slv_type_name(type));
        slv_cache_destroy(fresh);
    }
    slv_cache_destroy(cache);
    kit_free(&k);
}

/* Every texel of a strip of faces is the number of times that it was changed. */
enum { LIVE_FACES = 6 };
typedef struct live {
    _Atomic(uint64_t) version, closed;
    slv_cache *cache;
    slv_file_id file;
    _Atomic(uint64_t) seen; /* what lookups that begin now must at least show */
    _Atomic(bool) stop;
} live;

static slv_res live_res(uint32_t face) {
    static const slv_res res[LIVE_FACES] = {{8, 8}, {3, 3}, {5, 2}, {8, 8}, {4, 4}, {0, 0}};
    return res[face];
}

static slv_result live_describe(void *user, slv_source_desc *out) {
    (void)user;
    *out = (slv_source_desc){.name = "live",
                             .nfaces = LIVE_FACES,
                             .type = SLV_TYPE_FLOAT,
                             .nchannels = 1,
                             .alpha_channel = SLV_NO_ALPHA};
    return SLV_OK;
}

static slv_result live_face(void *user, uint32_t face, slv_source_face *out) {
    live *l = user;
    if (face >= LIVE_FACES)
        return SLV_ERROR_ARGUMENT;
    *out = (slv_source_face){
        .res = live_res(face),
        .adjacency = {{-1, (int32_t)face + 1, -1, (int32_t)face - 1}, {0, 3, 0, 1}}};
    if (face + 1 == LIVE_FACES)
        out->adjacency.face[1] = SLV_BOUNDARY;
    if (atomic_load(&l->version) % 3 == 0)
        out->flags = SLV_FACE_CONSTANT | SLV_FACE_NEIGHBOURS_CONSTANT;
    else if (atomic_load(&l->version) % 3 == 1 && face % 2)
        out->flags = SLV_FACE_CONSTANT;
    return SLV_OK;
}

static slv_result live_read(void *user, uint32_t face, slv_res res, slv_rect rect, void *out) {
    live *l = user;
    (void)face;
    (void)res;
    for (uint32_t i = 0; i < rect.width * rect.height; i++)
        ((float *)out)[i] = (float)atomic_load(&l->version);
    return SLV_OK;
}

static uint64_t live_version(void *user) {
    return atomic_load(&((live *)user)->version);
}

static slv_result live_changed(void *user, uint64_t since, slv_visit_rect visit, void *visitor) {
    slv_result result = SLV_OK;
    (void)user;
    (void)since;
    for (uint32_t face = 0; !result && face < LIVE_FACES; face++) {
        uint32_t width = 1u << live_res(face).u, height = 1u << live_res(face).v;
        result = visit(visitor, face, (slv_rect){0, 0, (width + 1) / 2, height});
        if (!result && width > 1)
            result = visit(visitor, face, (slv_rect){width / 2, 0, width / 2, height});
    }
    return result;
}

static void live_close(void *user) {
    atomic_fetch_add(&((live *)user)->closed, 1);
}

static const slv_source_fns live_fns = {.describe = live_describe,
                                        .face = live_face,
                                        .read = live_read,
                                        .version = live_version,
                                        .changed = live_changed,
                                        .close = live_close};

typedef struct looker {
    live *live;
    uint64_t random, lookups, old, early, failed;
} looker;

static void *look(void *user) {
    looker *w = user;
    slv_sampler *samplers[PARAMS];
    for (int p = 0; p < PARAMS; p++) {
        slv_filter_params params = all_params[p];
        /* old and new texels mixed with weights below 0 would be neither */
        bool negative = params.filter == SLV_FILTER_BICUBIC ||
                        params.filter == SLV_FILTER_CATMULL_ROM ||
                        params.filter == SLV_FILTER_MITCHELL;
        if (negative)
            params.filter = SLV_FILTER_BSPLINE;
        if (slv_sampler_create(w->live->cache, &params, &samplers[p]))
            return NULL;
    }
    while (!atomic_load(&w->live->stop)) {
        slv_lookup l = kit_lookup_any(w->live->file, LIVE_FACES, &w->random);
        float out[ROOM] = {0};
        float least = (float)atomic_load(&w->live->seen);
        slv_result result = slv_sample(samplers[test_random(&w->random) % PARAMS], &l, out);
        float most = (float)atomic_load(&w->live->version);
        w->failed += result != SLV_OK;
        w->old += !result && out[0] < least * 0.9999f;
        w->early += !result && out[0] > most * 1.0001f;
        w->lookups++;
    }
    for (int p = 0; p < PARAMS; p++)
        slv_sampler_destroy(samplers[p]);
    return NULL;
}

/* Hits take no lock, and are right whatever is forgotten meanwhile. */
static void test_live(bool whole_faces) {
    enum { LOOKERS = 4 };
    live l = {.version = 1, .seen = 1};
    const slv_source source = {&live_fns, &l};
    looker lookers[LOOKERS];
    pthread_t threads[LOOKERS];
    l.cache = kit_cache(UINT64_C(8) << 20, 0);
    CHECK(slv_cache_open_source(l.cache, &source, NULL, &l.file) == SLV_OK);
    for (int i = 0; i < LOOKERS; i++) {
        lookers[i] = (looker){.live = &l, .random = (uint64_t)i};
        REQUIRE(pthread_create(&threads[i], NULL, look, &lookers[i]) == 0);
    }
    for (int i = 0; i < (TEST_SANITIZED ? 300 : 1500); i++) {
        slv_result result = SLV_OK;
        uint64_t now = atomic_fetch_add(&l.version, 1) + 1;
        for (uint32_t face = 0; whole_faces && !result && face < LIVE_FACES; face++)
            result = slv_cache_invalidate_face(l.cache, l.file, face, NULL);
        if (!whole_faces)
            result = slv_cache_refresh(l.cache, l.file);
        CHECK(result == SLV_OK);
        atomic_store(&l.seen, now);
        if (i % 4 == 0)
            usleep(500);
    }
    atomic_store(&l.stop, true);
    for (int i = 0; i < LOOKERS; i++) {
        looker *w = &lookers[i];
        pthread_join(threads[i], NULL);
        CHECK_MSG(w->lookups && !w->old && !w->early && !w->failed,
                  "of %llu lookups %llu show what was forgotten, %llu what is not yet, %llu fail",
                  (unsigned long long)w->lookups, (unsigned long long)w->old,
                  (unsigned long long)w->early, (unsigned long long)w->failed);
    }
    CHECK(l.closed == 0);
    if (whole_faces)
        CHECK(slv_cache_close(l.cache, l.file) == SLV_OK && l.closed == 1);
    slv_cache_destroy(l.cache);
    CHECK(l.closed == 1);
}

static slv_result refuse(void *user, slv_source_desc *out) {
    (void)user;
    memset(out, 0, sizeof *out);
    return SLV_ERROR_IO;
}

static void test_refused(void) {
    static const slv_source_fns fns = {.describe = refuse, .close = live_close};
    slv_cache *cache = kit_cache(0, 0);
    live l = {.version = 1};
    slv_file_id id = 7;
    CHECK(slv_cache_open_source(cache, &(slv_source){&fns, &l}, NULL, &id) == SLV_ERROR_IO);
    CHECK(id == 0 && l.closed == 1);
    slv_cache_destroy(cache);
}

int main(void) {
    test_cap();
    for (int type = 0; type < 4; type++)
        test_painting((slv_type)type, 1 + (uint32_t)type, 20 + (uint64_t)type);
    test_live(false);
    test_live(true);
    test_refused();
    return test_end();
}
