/* bench_reference [--samples N] [--threads N] [--runs N] [--json] [--smoke]
 *
 * Ray-casts a torus of 2048 faces with 64 x 64 texels each, and makes lookups at random points of
 * it: millions of samples and of lookups a second, medians of the runs. */
#include "kit/bench_kit.h"

#include <selvage/bake.h>
#include <selvage/reference.h>

#include <string.h>

enum { AROUND = 64, ACROSS = 32, NFACES = AROUND * ACROSS, MAX_RUNS = 64 };

typedef struct options {
    uint32_t samples, threads, runs, size, lookups;
    int log2;
    bool json;
} options;

static slv_reference *make_reference(const slv_env *env, const options *o) {
    static slv_res res[NFACES];
    const slv_procedural noise = {
        .pattern = SLV_PATTERN_NOISE, .frequency = 4, .octaves = 3, .face_tint = 0.3f};
    const slv_reference_params params = {.segments = 8};
    bench_torus torus = bench_torus_make(env, AROUND, ACROSS);
    slv_texture *texture = NULL;
    slv_reference *reference = NULL;
    bench_res(NFACES, o->log2, false, res);
    slv_texture_desc desc = {NFACES, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res, SLV_TEXTURE_LINEAR};
    bench_stop(slv_texture_create(env, &desc, &texture));
    bench_stop(slv_bake_procedural(env, torus.surface, &noise, NULL, texture));
    double start = bench_seconds(CLOCK_MONOTONIC);
    bench_stop(slv_reference_create(env, torus.mesh, torus.surface, texture, torus.adjacency,
                                    &params, &reference));
    bench_report(o->json, "create", "ms", 1e3 * (bench_seconds(CLOCK_MONOTONIC) - start));
    slv_texture_destroy(texture);
    bench_torus_free(&torus);
    return reference;
}

static void render_speed(const slv_env *env, const options *o, const slv_reference *reference,
                         const char *what, float distance, slv_pixel_filter filter,
                         slv_shading shading) {
    const float low[3] = {-3, -1, -3}, high[3] = {3, 1, 3};
    double speeds[MAX_RUNS];
    slv_reference_frame frame = {.camera = slv_camera_orbit(low, high, 30, 35, 35, 1),
                                 .width = o->size,
                                 .height = o->size,
                                 .filter = filter,
                                 .shading = shading,
                                 .samples = o->samples};
    for (int i = 0; i < 4; i++)
        frame.camera.window[i] *= distance;
    for (uint32_t run = 0; run < o->runs; run++) {
        slv_image image;
        slv_reference_stats stats;
        double start = bench_seconds(CLOCK_MONOTONIC);
        bench_stop(slv_reference_render(reference, env, &frame, &image, NULL, &stats));
        speeds[run] = (double)stats.samples / 1e6 / (bench_seconds(CLOCK_MONOTONIC) - start);
        slv_image_free(&image);
    }
    bench_report(o->json, what, "Msamples/s", bench_median(speeds, o->runs));
}

static void lookup_speed(const options *o, const slv_reference *reference) {
    slv_surface_point *points = malloc(o->lookups * sizeof *points);
    float *rgb = malloc(o->lookups * 3 * sizeof *rgb);
    double speeds[MAX_RUNS];
    uint32_t state = 1;
    if (!points || !rgb)
        bench_stop(SLV_ERROR_MEMORY);
    for (uint32_t i = 0; i < o->lookups; i++) {
        uint32_t r[3];
        for (int k = 0; k < 3; k++)
            r[k] = state = state * 1664525 + 1013904223;
        points[i] =
            (slv_surface_point){(int32_t)((r[0] >> 8) % NFACES), (float)(r[1] >> 8) / 16777216,
                                (float)(r[2] >> 8) / 16777216};
    }
    for (uint32_t run = 0; run < o->runs; run++) {
        double start = bench_seconds(CLOCK_MONOTONIC);
        bench_stop(slv_reference_lookup(reference, o->lookups, points, rgb));
        speeds[run] = o->lookups / 1e6 / (bench_seconds(CLOCK_MONOTONIC) - start);
    }
    bench_report(o->json, "random lookups, one thread", "Mlookups/s",
                 bench_median(speeds, o->runs));
    free(points);
    free(rgb);
}

int main(int argc, char **argv) {
    options o = {.samples = 64, .runs = 5, .size = 512, .lookups = 1 << 20, .log2 = 6};
    for (int i = 1; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : "0";
        if (!strcmp(argv[i], "--json"))
            o.json = true;
        else if (!strcmp(argv[i], "--smoke")) {
            o.samples = 4;
            o.runs = 1;
            o.size = 64;
            o.lookups = 1 << 12;
            o.log2 = 3;
        } else if (!strcmp(argv[i], "--samples"))
            o.samples = (uint32_t)atoi(value), i++;
        else if (!strcmp(argv[i], "--threads"))
            o.threads = (uint32_t)atoi(value), i++;
        else if (!strcmp(argv[i], "--runs"))
            o.runs = (uint32_t)atoi(value), i++;
        else {
            fprintf(stderr, "usage: bench_reference [--samples N] [--threads N] [--runs N] "
                            "[--json] [--smoke]\n");
            return 2;
        }
    }
    if (o.runs < 1 || o.runs > MAX_RUNS)
        return 2;
    slv_env env = {.log = bench_log, .threads = o.threads}, one = {.log = bench_log, .threads = 1};
    slv_reference *reference = make_reference(&env, &o);
    render_speed(&one, &o, reference, "box, lit, one thread", 1, SLV_PIXEL_BOX,
                 SLV_SHADE_HEADLIGHT);
    render_speed(&env, &o, reference, "box, lit", 1, SLV_PIXEL_BOX, SLV_SHADE_HEADLIGHT);
    render_speed(&env, &o, reference, "box, lit, from far away", 8, SLV_PIXEL_BOX,
                 SLV_SHADE_HEADLIGHT);
    render_speed(&env, &o, reference, "box, unlit", 1, SLV_PIXEL_BOX, SLV_SHADE_UNLIT);
    render_speed(&env, &o, reference, "mitchell, lit", 1, SLV_PIXEL_MITCHELL, SLV_SHADE_HEADLIGHT);
    lookup_speed(&o, reference);
    slv_reference_destroy(reference);
    return 0;
}
