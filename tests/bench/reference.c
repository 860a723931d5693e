/* bench_reference [--samples N] [--threads N] [--runs N] [--json] [--smoke]
 *
 * Ray-casts a torus of 2048 faces with 64 x 64 texels each, and makes lookups at random points of
 * it: millions of samples and of lookups a second, medians of the runs. */
#include <selvage/bake.h>
#include <selvage/reference.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { AROUND = 64, ACROSS = 32, NFACES = AROUND * ACROSS, MAX_RUNS = 64 };

typedef struct options {
    uint32_t samples, threads, runs, size, lookups;
    int log2;
    bool json;
} options;

static void log_line(void *user, slv_log_level level, const char *message) {
    (void)user;
    if (level == SLV_LOG_ERROR)
        fprintf(stderr, "bench_reference: %s\n", message);
}

static void stop(slv_result result) {
    if (result) {
        fprintf(stderr, "bench_reference: %s\n", slv_result_string(result));
        exit(1);
    }
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, uint32_t count) {
    qsort(values, count, sizeof *values, by_value);
    return values[count / 2];
}

static void report(const options *o, const char *what, const char *unit, double value) {
    if (o->json)
        printf("{\"what\": \"%s\", \"unit\": \"%s\", \"value\": %.3f}\n", what, unit, value);
    else
        printf("%-40s %10.2f %s\n", what, value, unit);
    fflush(stdout);
}

static slv_mesh *make_torus(const slv_env *env) {
    static float positions[NFACES * 3];
    static int32_t sizes[NFACES], verts[NFACES * 4];
    slv_mesh *mesh = NULL;
    for (int i = 0; i < NFACES; i++) {
        int a = i % AROUND, b = i / AROUND, a1 = (a + 1) % AROUND, b1 = (b + 1) % ACROSS;
        float s = 6.2831853f * (float)a / AROUND, t = 6.2831853f * (float)b / ACROSS;
        positions[3 * i] = (2 + cosf(t)) * cosf(s);
        positions[3 * i + 1] = sinf(t);
        positions[3 * i + 2] = -(2 + cosf(t)) * sinf(s);
        sizes[i] = 4;
        verts[4 * i] = i;
        verts[4 * i + 1] = b * AROUND + a1;
        verts[4 * i + 2] = b1 * AROUND + a1;
        verts[4 * i + 3] = b1 * AROUND + a;
    }
    slv_mesh_view view = {.nverts = NFACES,
                          .positions = positions,
                          .npolys = NFACES,
                          .poly_sizes = sizes,
                          .poly_verts = verts};
    stop(slv_mesh_create(env, &view, &mesh));
    return mesh;
}

static slv_reference *make_reference(const slv_env *env, const options *o) {
    static slv_res res[NFACES];
    const slv_procedural noise = {
        .pattern = SLV_PATTERN_NOISE, .frequency = 4, .octaves = 3, .face_tint = 0.3f};
    const slv_reference_params params = {.segments = 8};
    slv_mesh *mesh = make_torus(env);
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    slv_texture *texture = NULL;
    slv_reference *reference = NULL;
    for (int i = 0; i < NFACES; i++)
        res[i] = (slv_res){(int8_t)o->log2, (int8_t)o->log2};
    slv_texture_desc desc = {NFACES, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res};
    stop(slv_mesh_adjacency(env, mesh, &adjacency));
    stop(slv_surface_create(env, mesh, NULL, &surface));
    stop(slv_texture_create(env, &desc, &texture));
    stop(slv_bake_procedural(env, surface, &noise, NULL, texture));
    double start = now();
    stop(slv_reference_create(env, mesh, surface, texture, adjacency, &params, &reference));
    report(o, "create", "ms", 1e3 * (now() - start));
    slv_texture_destroy(texture);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
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
        double start = now();
        stop(slv_reference_render(reference, env, &frame, &image, NULL, &stats));
        speeds[run] = (double)stats.samples / 1e6 / (now() - start);
        slv_image_free(&image);
    }
    report(o, what, "Msamples/s", median(speeds, o->runs));
}

static void lookup_speed(const options *o, const slv_reference *reference) {
    slv_surface_point *points = malloc(o->lookups * sizeof *points);
    float *rgb = malloc(o->lookups * 3 * sizeof *rgb);
    double speeds[MAX_RUNS];
    uint32_t state = 1;
    if (!points || !rgb)
        stop(SLV_ERROR_MEMORY);
    for (uint32_t i = 0; i < o->lookups; i++) {
        uint32_t r[3];
        for (int k = 0; k < 3; k++)
            r[k] = state = state * 1664525 + 1013904223;
        points[i] =
            (slv_surface_point){(int32_t)((r[0] >> 8) % NFACES), (float)(r[1] >> 8) / 16777216,
                                (float)(r[2] >> 8) / 16777216};
    }
    for (uint32_t run = 0; run < o->runs; run++) {
        double start = now();
        stop(slv_reference_lookup(reference, o->lookups, points, rgb));
        speeds[run] = o->lookups / 1e6 / (now() - start);
    }
    report(o, "random lookups, one thread", "Mlookups/s", median(speeds, o->runs));
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
    slv_env env = {.log = log_line, .threads = o.threads}, one = {.log = log_line, .threads = 1};
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
