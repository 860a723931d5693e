/* What the cache promises of memory, file handles, files that change, and files that are damaged.
 */
#include "kit/filter_kit.h"

#include <fcntl.h>
#include <pthread.h>
#include <selvage/ptx_writer.h>
#include <sys/stat.h>
#include <time.h>

enum { FILES = 12, LIMIT = 8 << 20, HANDLES = 3, THREADS = 4, FACES = 24, LOG2 = 7 };

static char paths[FILES][1100];

/* A strip of faces, each texel of which is face / 255 + `base` in all of four channels, but for
 * some that keep faces from being constant. */
static void write_strip(const char *path, uint32_t nfaces, int log2, float base) {
    slv_env env = test_env();
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                    .type = SLV_TYPE_FLOAT,
                                    .nchannels = 4,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = nfaces};
    slv_ptx_writer *writer = NULL;
    size_t count = (size_t)4 << 2 * log2;
    float *texels = malloc(count * sizeof *texels);
    REQUIRE(texels && slv_ptx_writer_create(&env, path, &params, &writer) == SLV_OK);
    for (uint32_t face = 0; face < nfaces; face++) {
        slv_ptx_face info = {
            .res = {(int8_t)log2, (int8_t)log2},
            .adjacency = {{-1, (int32_t)face + 1, -1, (int32_t)face - 1}, {0, 3, 0, 1}}};
        if (face + 1 == nfaces)
            info.adjacency.face[1] = -1;
        for (size_t i = 0; i < count; i++)
            texels[i] = (float)face / 255 + base;
        texels[0] = 99;
        REQUIRE(slv_ptx_writer_write_face(writer, face, &info, texels) == SLV_OK);
    }
    REQUIRE(slv_ptx_writer_finish(writer) == SLV_OK);
    slv_ptx_writer_destroy(writer);
    free(texels);
}

static float strip_value(uint32_t face, float base) {
    return (float)face / 255 + base;
}

/* A place away from the odd texel. */
static slv_lookup strip_lookup(slv_file_id id, uint32_t face) {
    return (slv_lookup){.file = id, .face = face, .u = 0.7f, .v = 0.7f, .uw1 = 0.01f, .vw2 = 0.01f};
}

static slv_result sample_strip(slv_sampler *sampler, slv_file_id id, uint32_t face, float *out) {
    slv_lookup l = strip_lookup(id, face);
    return slv_sample(sampler, &l, out);
}

static const slv_filter_params bilinear = {.filter = SLV_FILTER_BILINEAR, .nchannels = 4};

struct reader {
    slv_cache *cache;
    const slv_file_id *ids;
    uint64_t random;
    uint64_t lookups, wrong, over;
};

static void *read_all(void *user) {
    struct reader *r = user;
    slv_sampler *sampler;
    if (slv_sampler_create(r->cache, &bilinear, &sampler))
        return NULL;
    for (int i = 0; i < 600; i++) {
        uint32_t file = test_random(&r->random) % FILES, face = test_random(&r->random) % FACES;
        float out[4];
        slv_cache_stats stats;
        r->wrong += sample_strip(sampler, r->ids[file], face, out) != SLV_OK ||
                    fabsf(out[0] - strip_value(face, (float)file)) > 1e-5f;
        slv_cache_get_stats(r->cache, &stats);
        r->over +=
            stats.bytes > LIMIT || stats.peak_bytes > LIMIT || stats.handles > HANDLES + THREADS;
        r->lookups++;
    }
    slv_sampler_destroy(sampler);
    return NULL;
}

static void test_limits(void) {
    slv_cache *cache = kit_cache(LIMIT, HANDLES);
    slv_file_id ids[FILES];
    struct reader readers[THREADS];
    pthread_t threads[THREADS];
    slv_cache_stats stats;
    for (int i = 0; i < FILES; i++)
        ids[i] = kit_open(cache, paths[i]);
    for (int i = 0; i < THREADS; i++) {
        readers[i] = (struct reader){.cache = cache, .ids = ids, .random = (uint64_t)i};
        REQUIRE(pthread_create(&threads[i], NULL, read_all, &readers[i]) == 0);
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        CHECK(readers[i].lookups == 600 && !readers[i].wrong && !readers[i].over);
    }
    slv_cache_get_stats(cache, &stats);
    CHECK(stats.peak_bytes <= LIMIT && stats.peak_bytes >= stats.bytes);
    CHECK(stats.handles <= HANDLES && stats.reopened > 0 && stats.evictions > 0);
    CHECK(stats.lookups == 600 * THREADS);
    CHECK_MSG(stats.hits + stats.misses == 600 * THREADS, "%llu hits, %llu misses",
              (unsigned long long)stats.hits, (unsigned long long)stats.misses);
    CHECK(stats.evictions <= stats.misses && stats.bytes_read > 0 && stats.files == FILES);
    slv_cache_destroy(cache);
}

static void test_counts(void) {
    slv_cache *cache = kit_cache(UINT64_C(64) << 20, 0);
    slv_file_id id = kit_open(cache, paths[0]);
    slv_sampler *sampler = kit_sampler(cache, &bilinear);
    slv_cache_stats stats, after;
    float out[4];
    for (int turn = 0; turn < 2; turn++)
        for (uint32_t face = 0; face < FACES; face++)
            CHECK(sample_strip(sampler, id, face, out) == SLV_OK);
    slv_cache_get_stats(cache, &stats);
    CHECK(stats.lookups == 2 * FACES && stats.misses == FACES && stats.hits == FACES);
    CHECK(stats.evictions == 0 && stats.reloaded == 0 && stats.reopened == 0 && stats.handles == 1);
    CHECK(slv_cache_invalidate(cache, id) == SLV_OK);
    CHECK(sample_strip(sampler, id, 3, out) == SLV_OK && out[1] == strip_value(3, 0));
    slv_cache_get_stats(cache, &after);
    CHECK(after.misses == stats.misses + 1 && after.reloaded == 1 && after.handles == 1);
    slv_sampler_destroy(sampler);
    slv_cache_get_stats(cache, &after);
    CHECK(after.lookups == 2 * FACES + 1 && after.hits == FACES);

    CHECK(slv_cache_invalidate(cache, 0) == SLV_OK);
    for (uint32_t face = 0; face < FACES; face++)
        CHECK(slv_cache_prefetch(cache, id, face) == SLV_OK);
    CHECK(slv_cache_prefetch(cache, id, FACES) == SLV_ERROR_ARGUMENT);
    slv_cache_wait(cache);
    slv_cache_get_stats(cache, &stats);
    sampler = kit_sampler(cache, &(slv_filter_params){.filter = SLV_FILTER_POINT});
    for (uint32_t face = 0; face < FACES; face++)
        CHECK(sample_strip(sampler, id, face, out) == SLV_OK && out[2] == strip_value(face, 0));
    slv_cache_get_stats(cache, &after);
    CHECK_MSG(after.bytes_read == stats.bytes_read && after.misses == stats.misses,
              "%llu read after prefetching", (unsigned long long)(after.misses - stats.misses));
    slv_sampler_destroy(sampler);
    slv_cache_destroy(cache);
}

/* Puts the bytes of `from` into the file that is there. */
static void overwrite(const char *from, const char *to) {
    size_t size = 0;
    uint8_t *bytes = read_whole(from, &size);
    int descriptor = open(to, O_WRONLY | O_TRUNC);
    REQUIRE(bytes && descriptor >= 0 && write(descriptor, bytes, size) == (ssize_t)size);
    close(descriptor);
    free(bytes);
}

/* Later than what the clock of files may not tell apart. */
static void let_time_pass(void) {
    nanosleep(&(struct timespec){0, 30000000}, NULL);
}

static int lines, mismatches;

static void count_lines(void *user, slv_log_level level, const char *message) {
    (void)user;
    lines += level == SLV_LOG_ERROR;
    mismatches += strstr(message, "changed") != NULL;
}

/* in place or renamed over; with the handle open or given up; texels of it in memory or not */
static void test_changes(bool in_place, bool give_up, bool thrown_out) {
    char path[1100], other[1100];
    slv_env env = {.log = count_lines};
    slv_cache_params params = {.max_bytes = LIMIT, .max_files = 1};
    slv_cache *cache = NULL;
    snprintf(path, sizeof path, "%s", scratch_path("changes.ptx"));
    snprintf(other, sizeof other, "%s", scratch_path("changes-new.ptx"));
    write_strip(path, FACES, LOG2, 0.25f);
    write_strip(other, FACES, LOG2, 0.5f);
    let_time_pass();
    REQUIRE(slv_cache_create(&env, &params, &cache) == SLV_OK);
    slv_file_id id = kit_open(cache, path), another = kit_open(cache, paths[0]);
    slv_sampler *sampler = kit_sampler(cache, &bilinear);
    float out[4];
    for (uint32_t face = 0; face < FACES / 2; face++)
        CHECK(sample_strip(sampler, id, face, out) == SLV_OK && out[0] == strip_value(face, 0.25f));
    if (give_up)
        CHECK(sample_strip(sampler, another, 0, out) == SLV_OK);
    if (in_place)
        overwrite(other, path);
    else
        REQUIRE(rename(other, path) == 0);
    if (thrown_out)
        for (uint32_t i = 0; i < FACES; i++)
            CHECK(sample_strip(sampler, another, i, out) == SLV_OK);
    int changed = 0;
    lines = mismatches = 0;
    for (uint32_t face = 0; face < FACES; face++) {
        slv_result result = sample_strip(sampler, id, face, out);
        CHECK_MSG((result == SLV_OK && out[0] == strip_value(face, 0.25f)) ||
                      (result == SLV_ERROR_MISMATCH && out[0] == 0),
                  "face %u: %s, %g", face, slv_result_string(result), (double)out[0]);
        changed += result == SLV_ERROR_MISMATCH;
    }
    CHECK_MSG(lines == (changed > 0) && mismatches == lines, "%d errors, %d lines, %d that say why",
              changed, lines, mismatches);
    if (in_place || give_up)
        CHECK(changed > 0);
    CHECK(slv_cache_invalidate(cache, id) == SLV_OK);
    for (uint32_t face = 0; face < FACES; face++)
        CHECK(sample_strip(sampler, id, face, out) == SLV_OK && out[0] == strip_value(face, 0.5f));
    slv_sampler_destroy(sampler);
    slv_cache_destroy(cache);
    unlink(path);
    unlink(other);
}

/* Files that many lines of tables belong to. */
static void write_many_faces(const char *path, uint32_t nfaces, float value) {
    slv_env env = test_env();
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                    .type = SLV_TYPE_FLOAT,
                                    .nchannels = 1,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = nfaces};
    slv_ptx_writer *writer = NULL;
    float texels[4] = {value, value, value, value + 1};
    REQUIRE(slv_ptx_writer_create(&env, path, &params, &writer) == SLV_OK);
    slv_ptx_face info = {.res = {1, 1}, .adjacency = {{-1, -1, -1, -1}, {0, 0, 0, 0}}};
    for (uint32_t face = 0; face < nfaces; face++)
        REQUIRE(slv_ptx_writer_write_face(writer, face, &info, texels) == SLV_OK);
    REQUIRE(slv_ptx_writer_finish(writer) == SLV_OK);
    slv_ptx_writer_destroy(writer);
}

struct table_reader {
    slv_cache *cache;
    const slv_file_id *ids;
    int turn, done, wrong;
};

static void *read_tables(void *user) {
    struct table_reader *r = user;
    slv_filter_params params = {.filter = SLV_FILTER_POINT, .nchannels = 1};
    slv_sampler *sampler;
    if (slv_sampler_create(r->cache, &params, &sampler))
        return NULL;
    for (int i = 0; i < 60; i++) {
        int file = (i + r->turn) % 4;
        slv_lookup l = {.file = r->ids[file], .face = (uint32_t)i * 100, .u = 0.1f, .v = 0.1f};
        float out;
        r->wrong += slv_sample(sampler, &l, &out) != SLV_OK || out != (float)file;
        r->done++;
    }
    slv_sampler_destroy(sampler);
    return NULL;
}

static void test_tables(void) {
    slv_cache *cache = kit_cache(LIMIT, 2);
    slv_file_id ids[4], big;
    char path[4][1100];
    struct table_reader readers[THREADS];
    pthread_t threads[THREADS];
    slv_cache_stats stats;
    float out[4];
    for (int i = 0; i < 4; i++) {
        char name[32];
        snprintf(name, sizeof name, "tables-%d.ptx", i);
        snprintf(path[i], sizeof path[i], "%s", scratch_path(name));
        write_many_faces(path[i], 20000, (float)i);
        ids[i] = kit_open(cache, path[i]);
    }
    for (int i = 0; i < THREADS; i++) {
        readers[i] = (struct table_reader){cache, ids, i, 0, 0};
        REQUIRE(pthread_create(&threads[i], NULL, read_tables, &readers[i]) == 0);
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        CHECK_MSG(readers[i].done == 60 && !readers[i].wrong, "%d wrong: %s", readers[i].wrong,
                  test_last_log);
    }
    slv_cache_get_stats(cache, &stats);
    CHECK(stats.reloaded > 0);
    CHECK_MSG(stats.peak_bytes <= LIMIT, "peak of %llu bytes",
              (unsigned long long)stats.peak_bytes);

    const char *huge = scratch_path("huge.ptx");
    write_many_faces(huge, 90000, 5);
    big = kit_open(cache, huge);
    slv_sampler *sampler = kit_sampler(cache, &bilinear);
    for (int i = 0; i < 2; i++) {
        slv_lookup l = {.file = big, .face = 1, .u = 0.1f, .v = 0.1f};
        CHECK(slv_sample(sampler, &l, out) == SLV_ERROR_LIMIT);
        CHECK(strstr(test_last_log, "half of the cache") != NULL);
        l.file = ids[i];
        CHECK(slv_sample(sampler, &l, out) == SLV_OK);
    }
    slv_sampler_destroy(sampler);
    slv_cache_get_stats(cache, &stats);
    CHECK(stats.peak_bytes <= LIMIT);
    slv_cache_destroy(cache);
    for (int i = 0; i < 4; i++)
        unlink(path[i]);
    unlink(huge);
}

static void test_damage(void) {
    char path[1100];
    slv_env env = {.log = count_lines};
    slv_cache *cache = NULL;
    slv_ptx *ptx = NULL;
    slv_ptx_block block, coarse;
    float out[4];
    snprintf(path, sizeof path, "%s", scratch_path("damage.ptx"));
    write_strip(path, FACES, LOG2, 0.25f);
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    REQUIRE(slv_ptx_get_block(ptx, 5, 0, &block) == SLV_OK && block.stored);
    REQUIRE(slv_ptx_get_block(ptx, 5, 4, &coarse) == SLV_OK && coarse.stored);
    slv_ptx_close(ptx);
    int descriptor = open(path, O_WRONLY);
    REQUIRE(descriptor >= 0 && pwrite(descriptor, "selvage", 7, (off_t)block.position) == 7);
    REQUIRE(pwrite(descriptor, "selvage", 7, (off_t)coarse.position) == 7);
    close(descriptor);
    REQUIRE(slv_cache_create(&env, &(slv_cache_params){.max_bytes = LIMIT}, &cache) == SLV_OK);
    slv_file_id id = kit_open(cache, path);
    slv_sampler *sampler = kit_sampler(cache, &bilinear);
    for (int turn = 0; turn < 200; turn++)
        for (uint32_t face = 4; face < 7; face++) {
            lines = 0;
            slv_result result = sample_strip(sampler, id, face, out);
            if (face == 5)
                CHECK(result == SLV_ERROR_FORMAT && lines == (turn == 0) && out[0] == 0);
            else
                CHECK(result == SLV_OK && lines == 0 && out[0] == strip_value(face, 0.25f));
        }
    /* a neighbour that cannot be read is one error, and at most one line, for a lookup across the
     * edge */
    for (int width = 1; width < 512; width *= 2) {
        slv_lookup l = {.file = id, .face = 4, .u = 0.999f, .v = 0.5f};
        l.uw1 = l.vw2 = 1.5f / (float)width;
        lines = 0;
        slv_result result = slv_sample(sampler, &l, out);
        CHECK_MSG(result ? result == SLV_ERROR_FORMAT && lines <= 1 && out[0] == 0 : lines == 0,
                  "footprint 1.5/%d: %s and %d lines", width, slv_result_string(result), lines);
        lines = 0;
        CHECK(slv_sample(sampler, &l, out) == result && lines == 0);
    }
    lines = 0;
    CHECK(slv_cache_invalidate_face(cache, id, 4, NULL) == SLV_OK);
    CHECK(sample_strip(sampler, id, 5, out) == SLV_ERROR_FORMAT && lines == 0);
    CHECK(slv_cache_invalidate_face(cache, id, 5, NULL) == SLV_OK);
    CHECK(sample_strip(sampler, id, 5, out) == SLV_ERROR_FORMAT && lines == 1);
    CHECK(slv_cache_prefetch(cache, id, 5) == SLV_OK && slv_cache_prefetch(cache, id, 6) == SLV_OK);
    slv_cache_wait(cache);
    slv_cache_stats stats;
    slv_cache_get_stats(cache, &stats);
    CHECK(stats.peak_bytes <= LIMIT && stats.handles == 1);

    REQUIRE(unlink(path) == 0);
    CHECK(slv_cache_invalidate(cache, id) == SLV_OK);
    lines = 0;
    for (int turn = 0; turn < 10; turn++)
        CHECK(sample_strip(sampler, id, 4, out) == SLV_ERROR_IO && lines == 1);
    CHECK(slv_cache_open(cache, path, &id) == SLV_ERROR_IO && id == 0);
    slv_sampler_destroy(sampler);
    slv_cache_destroy(cache);
}

/* A file whose face table does not unpack: one line, however often and in whatever way it is asked
 * for, until it is invalidated; and all is well once it is whole again. */
static void test_broken_tables(void) {
    char path[1100];
    slv_env env = {.log = count_lines};
    slv_cache *cache = NULL;
    slv_lookup lookups[50];
    slv_result results[50];
    float out[50][4];
    size_t size = 0;
    snprintf(path, sizeof path, "%s", scratch_path("tables-broken.ptx"));
    write_strip(path, FACES, 3, 0.25f);
    uint8_t *bytes = read_whole(path, &size);
    REQUIRE(bytes && size > 200);
    int descriptor = open(path, O_WRONLY);
    REQUIRE(descriptor >= 0 && pwrite(descriptor, "selvage", 7, 64 + 40) == 7);
    REQUIRE(slv_cache_create(&env, &(slv_cache_params){.max_bytes = LIMIT}, &cache) == SLV_OK);
    slv_file_id id = kit_open(cache, path);
    slv_sampler *sampler = kit_sampler(cache, &bilinear);
    for (int turn = 0; turn < 2; turn++) {
        lines = 0;
        for (int i = 0; i < 1000; i++) {
            slv_result result = sample_strip(sampler, id, (uint32_t)i % FACES, out[0]);
            CHECK(result == SLV_ERROR_FORMAT && out[0][0] == 0);
        }
        for (uint32_t i = 0; i < 50; i++)
            lookups[i] = strip_lookup(id, i % FACES);
        CHECK(slv_sample_batch(sampler, lookups, 50, out[0], 4, results) == SLV_ERROR_FORMAT);
        for (int i = 0; i < 50; i++)
            CHECK(results[i] == SLV_ERROR_FORMAT);
        CHECK(slv_cache_prefetch(cache, id, 1) == SLV_OK);
        slv_cache_wait(cache);
        CHECK_MSG(lines == 1, "%d lines for a file that cannot be read", lines);
        CHECK(slv_cache_invalidate(cache, id) == SLV_OK);
    }
    lines = 0;
    CHECK(sample_strip(sampler, id, 0, out[0]) == SLV_ERROR_FORMAT && lines == 1);
    REQUIRE(pwrite(descriptor, bytes, size, 0) == (ssize_t)size);
    close(descriptor);
    CHECK(slv_cache_refresh(cache, id) == SLV_OK);
    CHECK(sample_strip(sampler, id, 3, out[0]) == SLV_OK && out[0][0] == strip_value(3, 0.25f));
    CHECK(slv_cache_refresh(cache, 0) == SLV_OK && lines == 1);
    slv_sampler_destroy(sampler);
    slv_cache_destroy(cache);
    free(bytes);
    unlink(path);
}

/* A file renamed over another is seen when the cache is told to look. */
static void test_refresh(void) {
    char path[1100], other[1100];
    slv_cache *cache = kit_cache(LIMIT, 0);
    slv_cache_stats stats, after;
    float out[4];
    snprintf(path, sizeof path, "%s", scratch_path("refresh.ptx"));
    snprintf(other, sizeof other, "%s", scratch_path("refresh-new.ptx"));
    write_strip(path, FACES, 3, 0.25f);
    write_strip(other, FACES, 3, 0.5f);
    slv_file_id id = kit_open(cache, path);
    slv_sampler *sampler = kit_sampler(cache, &bilinear);
    CHECK(sample_strip(sampler, id, 3, out) == SLV_OK && out[0] == strip_value(3, 0.25f));
    slv_cache_get_stats(cache, &stats);
    CHECK(slv_cache_refresh(cache, id) == SLV_OK);
    CHECK(sample_strip(sampler, id, 3, out) == SLV_OK && out[0] == strip_value(3, 0.25f));
    slv_cache_get_stats(cache, &after);
    CHECK(after.misses == stats.misses && after.reloaded == 0);
    REQUIRE(rename(other, path) == 0);
    CHECK(slv_cache_refresh(cache, 0) == SLV_OK);
    CHECK(sample_strip(sampler, id, 3, out) == SLV_OK && out[0] == strip_value(3, 0.5f));
    CHECK(slv_cache_refresh(cache, id + 1) == SLV_ERROR_ARGUMENT);
    CHECK(slv_cache_invalidate_face(cache, id, FACES, NULL) == SLV_ERROR_ARGUMENT);
    CHECK(slv_cache_invalidate_face(cache, id, 0, &(slv_rect){0, 0, 9, 1}) == SLV_ERROR_ARGUMENT);
    slv_sampler_destroy(sampler);
    slv_cache_destroy(cache);
    unlink(path);
}

int main(void) {
    for (int i = 0; i < FILES; i++) {
        char name[32];
        snprintf(name, sizeof name, "limits-%d.ptx", i);
        snprintf(paths[i], sizeof paths[i], "%s", scratch_path(name));
        write_strip(paths[i], FACES, LOG2, (float)i);
    }
    test_limits();
    test_counts();
    for (int i = 0; i < 8; i++)
        test_changes(i & 1, i & 2, i & 4);
    test_tables();
    test_damage();
    test_broken_tables();
    test_refresh();
    for (int i = 0; i < FILES; i++)
        unlink(paths[i]);
    return test_end();
}
