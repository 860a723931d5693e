/* How fast lookups are in more texels than the cache may hold.
 * bench_cache [--files N] [--limit MIB] [--ratio R] [--seconds S] [--folder PATH] [--json]
 * [--smoke]
 *
 * Lookups out of core: N (200) files that hold R (64) times as many texels as the cache may (256
 * MiB), scaled down where the disk has no room, looked up by two threads. `camera`: a window moves
 * over the faces of a file, and most of what it shows is seen again in the next frame, until there
 * is a cut. `random`: any texel of any face of any file.
 *
 * Rates are in millions a second that the threads were busy, for others may use the machine, and by
 * the clock on the wall. The cache is full, by random lookups, when the measurement begins. The
 * yardstick is the same pattern in the same cache over so few files that everything stays in
 * memory. Some of the lookups are compared with what the texture is known to be there. Memory is
 * what the operating system counts for the process above what it took before the cache was made. */
#include "kit/bench_kit.h"

#include <selvage/filter.h>
#include <selvage/ptx_writer.h>

#include <pthread.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

enum { LOG2 = 9, SIZE = 1 << LOG2, CHANNELS = 3, THREADS = 2, FRAME = 4096 };
#define FACE_BYTES ((uint64_t)SIZE * SIZE * CHANNELS)

struct options {
    uint32_t files;
    uint64_t limit, ratio;
    double seconds;
    const char *folder;
    bool json, smoke;
};

struct scene {
    slv_cache *cache;
    const slv_file_id *ids;
    uint32_t files, side; /* faces along a side of each file */
    double seconds;
    bool random;
};

struct result {
    double rate;      /* lookups a second of a processor, of all threads */
    double wall_rate; /* lookups a second */
    uint64_t lookups, checked, wrong;
    slv_cache_stats stats;
    uint64_t resident, peak; /* bytes */
};

/* Slopes along u and v that depend on the face, whole steps of 1/255 a few texels apart, so that
 * files are small but no face is constant: every filter gives the plane, to the rounding of texels.
 */
static void plane(uint32_t file, uint32_t face, float slope[2], float *at) {
    uint32_t state = (file * 4099 + face) * 2654435761u + 12345;
    bench_random(&state);
    slope[0] = 64 * bench_random_unit(&state);
    slope[1] = 64 * bench_random_unit(&state);
    *at = 100 * bench_random_unit(&state);
}

static void write_file(const slv_env *env, const char *path, uint32_t file, uint32_t side) {
    static uint8_t texels[FACE_BYTES];
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                    .type = SLV_TYPE_U8,
                                    .nchannels = CHANNELS,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = side * side,
                                    .compression = 1};
    slv_ptx_writer *writer;
    bench_stop(slv_ptx_writer_create(env, path, &params, &writer));
    for (uint32_t face = 0; face < side * side; face++) {
        slv_ptx_face info = {.res = {LOG2, LOG2},
                             .adjacency = bench_grid_adjacency(face, side, side * side)};
        float slope[2], at;
        plane(file, face, slope, &at);
        for (uint32_t v = 0; v < SIZE; v++)
            for (uint32_t u = 0; u < SIZE; u++) {
                float value =
                    at + slope[0] * ((float)u + 0.5f) / SIZE + slope[1] * ((float)v + 0.5f) / SIZE;
                memset(texels + ((size_t)v * SIZE + u) * CHANNELS, (int)(value + 0.5f), CHANNELS);
            }
        bench_stop(slv_ptx_writer_write_face(writer, face, &info, texels));
    }
    bench_stop(slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
}

struct worker {
    const struct scene *scene;
    uint32_t number;
    uint64_t lookups, checked, wrong, frame;
    uint32_t file;
    float left, below, footprint;
    double busy; /* seconds of a processor */
};

/* A frame of the camera: 64 by 64 pixels, tile by tile, a footprint apart. It sees from 64 texels
 * of a face to two faces and moves by an eighth of that from one frame to the next; after 32 frames
 * there is a cut to some other place of some file. */
static void make_frame(const struct scene *s, struct worker *w, uint32_t *state, slv_lookup *out) {
    if (w->frame++ % 32 == 0) {
        w->footprint = powf(2, 4 * bench_random_unit(state)) / SIZE;
        w->file = bench_random(state) % s->files;
        w->left = (float)s->side * bench_random_unit(state);
        w->below = (float)s->side * bench_random_unit(state);
    }
    float footprint = w->footprint, left = w->left, below = w->below;
    uint32_t file = w->file;
    w->left += 8 * footprint;
    for (uint32_t i = 0; i < FRAME; i++) {
        if (s->random) {
            uint32_t face = bench_random(state) % (s->side * s->side);
            out[i] = (slv_lookup){.file = s->ids[bench_random(state) % s->files],
                                  .face = face,
                                  .u = bench_random_unit(state),
                                  .v = bench_random_unit(state)};
            out[i].uw1 = out[i].vw2 = powf(2, 6 * bench_random_unit(state)) / SIZE;
            continue;
        }
        uint32_t tile = i / 256, x = tile % 4 * 16 + i % 16, y = tile / 4 * 16 + i / 16 % 16;
        float u = left + (float)x * footprint, v = below + (float)y * footprint;
        uint32_t column = (uint32_t)u % s->side, line = (uint32_t)v % s->side;
        out[i] = (slv_lookup){.file = s->ids[file],
                              .face = line * s->side + column,
                              .u = u - floorf(u),
                              .v = v - floorf(v),
                              .uw1 = footprint,
                              .vw2 = footprint};
    }
}

static void check(struct worker *w, const slv_lookup *l, const float *out) {
    const struct scene *s = w->scene;
    float slope[2], at, margin = 6 * l->uw1 + 4.0f / SIZE;
    uint32_t file = 0;
    if (l->u < margin || l->u > 1 - margin || l->v < margin || l->v > 1 - margin)
        return;
    while (s->ids[file] != l->file)
        file++;
    plane(file, l->face, slope, &at);
    /* each reduction rounds once more */
    float levels = log2f(l->uw1 * SIZE) + 1, allowed = (0.6f + 0.75f * fmaxf(levels, 0)) / 255;
    float expected = (at + slope[0] * l->u + slope[1] * l->v) / 255;
    w->checked++;
    for (int c = 0; c < CHANNELS; c++)
        if (!(fabsf(out[c] - expected) <= allowed)) {
            w->wrong++;
            break;
        }
}

static void *work(void *user) {
    struct worker *w = user;
    const struct scene *s = w->scene;
    slv_filter_params params = {.filter = SLV_FILTER_BSPLINE, .nchannels = CHANNELS};
    slv_sampler *sampler;
    slv_lookup *lookups = malloc(FRAME * sizeof *lookups);
    float *out = malloc(FRAME * CHANNELS * sizeof *out);
    uint32_t state = w->number * 977 + 1;
    if (!lookups || !out)
        bench_stop(SLV_ERROR_MEMORY);
    bench_stop(slv_sampler_create(s->cache, &params, &sampler));
    double end = bench_seconds(CLOCK_MONOTONIC) + s->seconds;
    while (bench_seconds(CLOCK_MONOTONIC) < end) {
        make_frame(s, w, &state, lookups);
        bench_stop(slv_sample_batch(sampler, lookups, FRAME, out, CHANNELS, NULL));
        for (uint32_t i = bench_random(&state) % 61; i < FRAME; i += 61)
            check(w, &lookups[i], out + (size_t)i * CHANNELS);
        w->lookups += FRAME;
    }
    w->busy = bench_seconds(CLOCK_THREAD_CPUTIME_ID);
    slv_sampler_destroy(sampler);
    free(lookups);
    free(out);
    return NULL;
}

static void run_threads(const struct scene *s, uint32_t run, struct result *out) {
    pthread_t threads[THREADS];
    struct worker workers[THREADS];
    double start = bench_seconds(CLOCK_MONOTONIC);
    for (uint32_t i = 0; i < THREADS; i++) {
        workers[i] = (struct worker){.scene = s, .number = run * THREADS + i};
        if (pthread_create(&threads[i], NULL, work, &workers[i]))
            bench_stop(SLV_ERROR_MEMORY);
    }
    for (uint32_t i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        out->lookups += workers[i].lookups;
        out->checked += workers[i].checked;
        out->wrong += workers[i].wrong;
        out->rate += (double)workers[i].lookups / workers[i].busy;
    }
    out->wall_rate = (double)out->lookups / (bench_seconds(CLOCK_MONOTONIC) - start);
}

static void measure(const struct options *o, const char *const *paths, uint32_t files,
                    uint32_t side, bool random, bool full, struct result *out) {
    slv_env env = {.log = bench_log};
    slv_cache_params params = {.max_bytes = o->limit};
    slv_cache *cache;
    slv_file_id *ids = calloc(files, sizeof *ids);
    memset(out, 0, sizeof *out);
    uint64_t before = bench_status_bytes("VmRSS");
    /* so that the peak is that of this cache */
    FILE *reset = fopen("/proc/self/clear_refs", "w");
    if (reset) {
        fputs("5", reset);
        fclose(reset);
    }
    bench_stop(slv_cache_create(&env, &params, &cache));
    for (uint32_t i = 0; i < files; i++)
        bench_stop(slv_cache_open(cache, paths[i], &ids[i]));
    struct scene scene = {cache, ids, files, side, o->seconds, random};
    if (full) {
        struct result ignored = {0};
        scene.random = true;
        run_threads(&scene, 0, &ignored);
        scene.random = random;
    }
    for (uint32_t face = 0; !full && face < side * side * files; face++) {
        bench_stop(slv_cache_prefetch(cache, ids[face % files], face / files));
        if (face % 1024 == 1023)
            slv_cache_wait(cache);
    }
    slv_cache_wait(cache);
    slv_cache_stats first;
    slv_cache_get_stats(cache, &first);
    run_threads(&scene, 1, out);
    slv_cache_get_stats(cache, &out->stats);
    out->stats.hits -= first.hits;
    out->stats.misses -= first.misses;
    out->stats.evictions -= first.evictions;
    out->stats.reloaded -= first.reloaded;
    out->stats.bytes_read -= first.bytes_read;
    out->resident = bench_status_bytes("VmRSS");
    out->peak = bench_status_bytes("VmHWM");
    out->resident -= out->resident < before ? out->resident : before;
    out->peak -= out->peak < before ? out->peak : before;
    slv_cache_destroy(cache);
    free(ids);
}

static void print(const struct options *o, const char *name, const struct result *r) {
    const slv_cache_stats *s = &r->stats;
    if (o->json)
        printf("{\"pattern\":\"%s\",\"lookups_per_second\":%.0f,\"by_wall_clock\":%.0f,\"checked\":"
               "%llu,\"wrong\":%llu,"
               "\"hits\":%llu,\"misses\":%llu,\"evictions\":%llu,\"reloaded\":%llu,"
               "\"bytes_read\":%llu,\"limit\":%llu,\"bytes\":%llu,\"resident\":%llu,"
               "\"resident_peak\":%llu}\n",
               name, r->rate, r->wall_rate, (unsigned long long)r->checked,
               (unsigned long long)r->wrong, (unsigned long long)s->hits,
               (unsigned long long)s->misses, (unsigned long long)s->evictions,
               (unsigned long long)s->reloaded, (unsigned long long)s->bytes_read,
               (unsigned long long)o->limit, (unsigned long long)s->bytes,
               (unsigned long long)r->resident, (unsigned long long)r->peak);
    else
        printf("%-13s %8.3f %8.3f %9llu %6llu %11llu %9llu %9llu %7llu %7.0f %7.0f %7.0f\n", name,
               r->rate / 1e6, r->wall_rate / 1e6, (unsigned long long)r->checked,
               (unsigned long long)r->wrong, (unsigned long long)s->hits,
               (unsigned long long)s->misses, (unsigned long long)s->evictions,
               (unsigned long long)s->reloaded, (double)s->bytes_read / 1048576,
               (double)r->resident / 1048576, (double)r->peak / 1048576);
    fflush(stdout);
}

/* Its lines are many since it is a list: of options, and of one report after the other. */
int main(int argc, char **argv) {
    struct options o = {200, UINT64_C(256) << 20, 64, 10, "/tmp", false, false};
    for (int i = 1; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : "";
        if (strcmp(argv[i], "--smoke") == 0)
            o = (struct options){20, UINT64_C(8) << 20, 6, 0.2, o.folder, o.json, true};
        else if (strcmp(argv[i], "--json") == 0)
            o.json = true;
        else if (strcmp(argv[i], "--files") == 0 && ++i)
            o.files = (uint32_t)strtoul(value, NULL, 10);
        else if (strcmp(argv[i], "--limit") == 0 && ++i)
            o.limit = strtoull(value, NULL, 10) << 20;
        else if (strcmp(argv[i], "--ratio") == 0 && ++i)
            o.ratio = strtoull(value, NULL, 10);
        else if (strcmp(argv[i], "--seconds") == 0 && ++i)
            o.seconds = strtod(value, NULL);
        else if (strcmp(argv[i], "--folder") == 0 && ++i)
            o.folder = value;
        else {
            fprintf(stderr, "usage: bench_cache [--files N] [--limit MIB] [--ratio R] "
                            "[--seconds S] [--folder PATH] [--json] [--smoke]\n");
            return 2;
        }
    }
    if (!o.files || o.limit < UINT64_C(8) << 20 || !o.ratio)
        return 2;
    slv_env env = {.log = bench_log};
    struct statvfs disk;
    char folder[1024];
    uint32_t side = 2;
    while ((uint64_t)side * side * FACE_BYTES * o.files < o.limit * o.ratio)
        side++;
    /* a fifth of the texels is more than the files take */
    while (side > 2 && statvfs(o.folder, &disk) == 0 &&
           (uint64_t)side * side * FACE_BYTES * o.files / 5 >
               (uint64_t)disk.f_bavail * disk.f_frsize / 2)
        side--;
    uint64_t texels = (uint64_t)side * side * FACE_BYTES * o.files;
    if (texels < o.limit * o.ratio)
        fprintf(stderr, "bench_cache: the disk has no room for more than %.1f times the limit\n",
                (double)texels / (double)o.limit);
    snprintf(folder, sizeof folder, "%s/bench_cache_XXXXXX", o.folder);
    if (!mkdtemp(folder))
        bench_stop(SLV_ERROR_IO);
    char **paths = calloc(o.files, sizeof *paths);
    uint64_t stored = 0;
    for (uint32_t i = 0; i < o.files; i++) {
        char path[1100];
        struct stat status;
        snprintf(path, sizeof path, "%s/%u.ptx", folder, i);
        paths[i] = strdup(path);
        write_file(&env, path, i, side);
        if (stat(path, &status) == 0)
            stored += (uint64_t)status.st_size;
    }
    if (!o.json)
        printf("%u files of %u faces of 512x512 RGB: %.0f MiB of texels, %.0f MiB on disk; limit "
               "%.0f MiB\n"
               "pattern       M/s busy M/s wall   checked  wrong        hits    misses evictions "
               "reloads "
               "MiB rd resident peak\n",
               o.files, side * side, (double)texels / 1048576, (double)stored / 1048576,
               (double)o.limit / 1048576);
    /* files whose faces fill half of the cache, reductions included */
    uint32_t few = (uint32_t)(o.limit / (FACE_BYTES * side * side * 2));
    few = few < 1 ? 1 : few > o.files ? o.files : few;
    bool failed = false;
    for (int random = 0; random < 2; random++) {
        const char *names[2][2] = {{"camera", "camera, few"}, {"random", "random, few"}};
        struct result all, warm;
        measure(&o, (const char *const *)paths, few, side, random, false, &warm);
        print(&o, names[random][1], &warm);
        measure(&o, (const char *const *)paths, o.files, side, random, true, &all);
        print(&o, names[random][0], &all);
        if (!o.json)
            printf("%.2f of what it is in memory; memory at most %.2f of the limit\n",
                   all.rate / warm.rate, (double)all.peak / (double)o.limit);
        failed |= all.wrong || warm.wrong || !all.lookups || (!all.checked && !o.smoke);
    }
    for (uint32_t i = 0; i < o.files; i++) {
        unlink(paths[i]);
        free(paths[i]);
    }
    rmdir(folder);
    free(paths);
    return failed;
}
