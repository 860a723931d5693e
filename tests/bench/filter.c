/* bench_filter [--type uint8|half] [--faces N] [--runs N] [--seconds S] [--filter NAME] [--json]
 * [--smoke]
 *
 * Lookups per second on N (4096) faces of 64x64 texels of three channels, warm, all in memory: one
 * by one, in batches, in sorted batches; along rows of faces and at random places; with a footprint
 * of 1.5 and of 16 texels; with one thread and two. Medians of the runs.
 *
 * The yardstick, weighted sums of 4x4 texels of plain memory along rows and at random places, is
 * measured between the runs: `reference` is what the Ptex library 2.4 does one by one on a machine
 * with the same yardstick (its better figure of two runs, scaled), and the ratios are to that. */
#include "kit/bench_kit.h"

#include <selvage/filter.h>
#include <selvage/half.h>
#include <selvage/ptx_writer.h>

#include <pthread.h>
#include <string.h>

enum { LOG2 = 6, BLOCK = 4096, CHANNELS = 3 };

/* What the Ptex library was measured to do, millions a second, where the yardstick gave 18.9 along
 * rows and 4.5 at random: [footprint][random]. */
static const double reference[SLV_FILTER_COUNT][2][2] = {
    [SLV_FILTER_POINT] = {{29, 7.8}, {30, 7.5}},
    [SLV_FILTER_BILINEAR] = {{11.4, 3.9}, {17.3, 12.4}},
    [SLV_FILTER_BOX] = {{10.5, 3.6}, {16.6, 12.8}},
    [SLV_FILTER_GAUSSIAN] = {{6.4, 2.0}, {4.7, 4.5}},
    [SLV_FILTER_BICUBIC] = {{7.3, 2.2}, {6.6, 5.3}},
    [SLV_FILTER_BSPLINE] = {{7.1, 2.1}, {6.5, 4.0}},
    [SLV_FILTER_CATMULL_ROM] = {{7.1, 2.1}, {7.0, 5.4}},
    [SLV_FILTER_MITCHELL] = {{5.3, 2.0}, {6.8, 4.9}},
};
static const double yardstick_reference[2] = {18.9, 4.5};
static const float footprints[2] = {1.5f, 16};

enum { ONE, BATCH, SORTED, MODES };

struct options {
    slv_type type;
    uint32_t faces, runs;
    int filter; /* or -1 */
    double seconds;
    bool json;
};

/* A square grid of faces. */
static void write_file(const slv_env *env, const char *path, const struct options *o) {
    enum { SIZE = 1 << LOG2 };
    uint32_t side = 1, state = 1;
    while (side * side < o->faces)
        side++;
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                    .type = o->type,
                                    .nchannels = CHANNELS,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = o->faces};
    slv_ptx_writer *writer;
    static uint16_t texels[SIZE * SIZE * CHANNELS];
    bench_stop(slv_ptx_writer_create(env, path, &params, &writer));
    for (uint32_t face = 0; face < o->faces; face++) {
        slv_ptx_face info = {.res = {LOG2, LOG2},
                             .adjacency = bench_grid_adjacency(face, side, o->faces)};
        for (size_t i = 0; i < SIZE * SIZE * CHANNELS; i++) {
            uint32_t r = bench_random(&state);
            if (o->type == SLV_TYPE_U8)
                ((uint8_t *)texels)[i] = (uint8_t)(r >> 24);
            else
                texels[i] = slv_half_from_float((float)(r >> 8) * (1.0f / 16777216.0f));
        }
        bench_stop(slv_ptx_writer_write_face(writer, face, &info, texels));
    }
    bench_stop(slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
}

static void make_lookups(slv_file_id file, uint32_t faces, bool random, float footprint,
                         uint32_t seed, uint32_t count, slv_lookup *out) {
    const float size = 1 << LOG2, width = footprint / size;
    uint32_t state = seed * 2654435761u + 1;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t texel = i + seed * 977u;
        slv_lookup l = {.file = file, .uw1 = width, .vw2 = width};
        if (random) {
            l.face = bench_random(&state) % faces;
            l.u = bench_random_unit(&state);
            l.v = bench_random_unit(&state);
        } else {
            l.face = (texel >> (2 * LOG2)) % faces;
            l.u = ((float)(texel & 63) + 0.5f) / size;
            l.v = ((float)(texel >> 6 & 63) + 0.5f) / size;
        }
        out[i] = l;
    }
}

struct work {
    slv_cache *cache;
    slv_filter filter;
    const slv_lookup *lookups;
    uint32_t count;
    int mode;
    double seconds;
    double rate; /* out: millions a second */
    float check;
};

static void *run(void *user) {
    struct work *w = user;
    slv_filter_params params = {.filter = w->filter, .sharpness = 0.5f};
    slv_sampler *sampler;
    static _Thread_local float out[BLOCK * CHANNELS];
    void *workspace = malloc(slv_sample_workspace(BLOCK));
    bench_stop(slv_sampler_create(w->cache, &params, &sampler));
    double start = bench_seconds(CLOCK_THREAD_CPUTIME_ID), end = start + w->seconds, t = start;
    uint64_t done = 0;
    uint32_t at = 0;
    while (t < end) {
        const slv_lookup *l = w->lookups + at;
        if (w->mode == ONE)
            for (uint32_t i = 0; i < BLOCK; i++)
                bench_stop(slv_sample(sampler, &l[i], out + i * CHANNELS));
        else if (w->mode == BATCH)
            bench_stop(slv_sample_batch(sampler, l, BLOCK, out, CHANNELS, NULL));
        else
            bench_stop(slv_sample_sorted(sampler, l, BLOCK, out, CHANNELS, NULL, workspace));
        w->check += out[0];
        done += BLOCK;
        at = (at + BLOCK) % w->count;
        t = bench_seconds(CLOCK_THREAD_CPUTIME_ID);
    }
    w->rate = (double)done / (t - start) / 1e6;
    slv_sampler_destroy(sampler);
    free(workspace);
    return NULL;
}

/* 4x4 weighted sums of three interleaved bytes, from 48 MiB: millions a second. Compiled as where
 * the reference was measured. */
#if defined(__GNUC__) && !defined(__clang__)
__attribute__((optimize("O2")))
#endif
static double
yardstick(bool random, double seconds) {
    enum { BYTES = 48 << 20, TAPS = 1 << 16 };
    static uint8_t *texels;
    static uint32_t at[TAPS];
    static volatile float sink;
    uint32_t state = 99;
    if (!texels) {
        texels = malloc(BYTES);
        for (uint32_t i = 0; texels && i < BYTES; i++)
            texels[i] = (uint8_t)bench_random(&state);
    }
    if (!texels)
        bench_stop(SLV_ERROR_MEMORY);
    for (uint32_t i = 0; i < TAPS; i++)
        at[i] = (random ? bench_random(&state) : i * 3) % (BYTES - 4096);
    static const float w[4] = {0.1f, 0.4f, 0.3f, 0.2f};
    float sum[3] = {0};
    uint64_t done = 0;
    double start = bench_seconds(CLOCK_THREAD_CPUTIME_ID), t = start;
    while (t < start + seconds) {
        for (uint32_t i = 0; i < TAPS; i++) {
            const uint8_t *p = texels + at[i];
            for (int y = 0; y < 4; y++)
                for (int x = 0; x < 4; x++)
                    for (int c = 0; c < 3; c++)
                        sum[c] += w[y] * w[x] * (float)p[y * 192 + x * 3 + c];
        }
        done += TAPS;
        t = bench_seconds(CLOCK_THREAD_CPUTIME_ID);
    }
    sink = sum[0] + sum[1] + sum[2];
    (void)sink;
    return (double)done / (t - start) / 1e6;
}

static void measure(const struct options *o, slv_cache *cache, slv_file_id file,
                    slv_filter filter) {
    uint32_t count = 64 * BLOCK;
    slv_lookup *lookups = malloc(2 * (size_t)count * sizeof *lookups);
    if (!lookups)
        bench_stop(SLV_ERROR_MEMORY);
    for (int wide = 0; wide < 2; wide++)
        for (int random = 0; random < 2; random++) {
            double rates[MODES][64], pairs[64], sticks[64], one = 0, values[MODES];
            for (uint32_t t = 0; t < 2; t++)
                make_lookups(file, o->faces, random, footprints[wide], t + 1, count,
                             lookups + t * (size_t)count);
            for (uint32_t r = 0; r < o->runs; r++) {
                for (int m = 0; m < MODES; m++) {
                    struct work w = {cache, filter, lookups, count, m, o->seconds, 0, 0};
                    run(&w);
                    rates[m][r] = w.rate;
                }
                struct work w[2];
                pthread_t threads[2];
                for (int t = 0; t < 2; t++) {
                    w[t] = (struct work){
                        cache, filter, lookups + (size_t)t * count, count, BATCH, o->seconds, 0, 0};
                    if (pthread_create(&threads[t], NULL, run, &w[t]))
                        bench_stop(SLV_ERROR_MEMORY);
                }
                for (int t = 0; t < 2; t++)
                    pthread_join(threads[t], NULL);
                pairs[r] = (w[0].rate + w[1].rate) / rates[BATCH][r];
                sticks[r] = yardstick(random, o->seconds / 2);
            }
            for (int m = 0; m < MODES; m++)
                values[m] = bench_median(rates[m], o->runs);
            one = reference[filter][wide][random] * bench_median(sticks, o->runs) /
                  yardstick_reference[random];
            double two = bench_median(pairs, o->runs);
            if (o->json)
                printf("{\"filter\":\"%s\",\"footprint\":%g,\"random\":%s,\"reference\":%.3f,"
                       "\"one\":%.3f,\"batch\":%.3f,\"sorted\":%.3f,\"two_threads\":%.3f}\n",
                       slv_filter_name(filter), (double)footprints[wide], random ? "true" : "false",
                       one, values[ONE], values[BATCH], values[SORTED], two);
            else {
                printf("%-11s %4.1f %-8s %9.2f", slv_filter_name(filter), (double)footprints[wide],
                       random ? "random" : "rows", one);
                for (int m = 0; m < MODES; m++)
                    if (one > 0)
                        printf(" %8.2f %5.2fx", values[m], values[m] / one);
                    else
                        printf(" %8.2f      -", values[m]);
                printf(" %7.2fx\n", two);
            }
            fflush(stdout);
        }
    free(lookups);
}

int main(int argc, char **argv) {
    struct options o = {SLV_TYPE_U8, 4096, 5, -1, 0.1, false};
    for (int i = 1; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : "";
        slv_filter filter;
        if (strcmp(argv[i], "--smoke") == 0)
            o.faces = 64, o.runs = 1, o.seconds = 0.001;
        else if (strcmp(argv[i], "--json") == 0)
            o.json = true;
        else if (strcmp(argv[i], "--type") == 0 && ++i)
            o.type = strcmp(value, "half") == 0 ? SLV_TYPE_HALF : SLV_TYPE_U8;
        else if (strcmp(argv[i], "--faces") == 0 && ++i)
            o.faces = (uint32_t)strtoul(value, NULL, 10);
        else if (strcmp(argv[i], "--runs") == 0 && ++i)
            o.runs = (uint32_t)strtoul(value, NULL, 10);
        else if (strcmp(argv[i], "--seconds") == 0 && ++i)
            o.seconds = strtod(value, NULL);
        else if (strcmp(argv[i], "--filter") == 0 && slv_filter_from_name(value, &filter) && ++i)
            o.filter = (int)filter;
        else {
            fprintf(stderr, "usage: bench_filter [--type uint8|half] [--faces N] [--runs N] "
                            "[--seconds S] [--filter NAME] [--json] [--smoke]\n");
            return 2;
        }
    }
    if (!o.faces || !o.runs || o.runs > 64)
        return 2;
    slv_env env = {.log = bench_log};
    char path[64];
    bench_temporary(path);
    write_file(&env, path, &o);
    slv_cache *cache;
    slv_file_id file;
    bench_stop(slv_cache_create(&env, NULL, &cache));
    bench_stop(slv_cache_open(cache, path, &file));
    for (uint32_t face = 0; face < o.faces; face++) {
        bench_stop(slv_cache_prefetch(cache, file, face));
        if (face % 2048 == 2047)
            slv_cache_wait(cache);
    }
    slv_cache_wait(cache);
    if (!o.json)
        printf("%u faces of 64x64 %s RGB, millions of lookups a second\n"
               "filter      size pattern  reference      one           batch          sorted      "
               "two threads\n",
               o.faces, slv_type_name(o.type));
    for (int filter = 0; filter < SLV_FILTER_COUNT; filter++)
        if (o.filter < 0 || o.filter == filter)
            measure(&o, cache, file, (slv_filter)filter);
    slv_cache_destroy(cache);
    unlink(path);
    return 0;
}
