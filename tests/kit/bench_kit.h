/* What the benchmarks share. BENCH_NAME, which the build defines, is the program's name. */
#ifndef BENCH_KIT_H
#define BENCH_KIT_H

#include <selvage/ptx.h>
#include <selvage/surface.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static inline void bench_log(void *user, slv_log_level level, const char *message) {
    (void)user;
    if (level != SLV_LOG_INFO)
        fprintf(stderr, BENCH_NAME ": %s\n", message);
}

static inline void bench_stop(slv_result result) {
    if (result) {
        fprintf(stderr, BENCH_NAME ": %s\n", slv_result_string(result));
        exit(1);
    }
}

/* CLOCK_MONOTONIC, or CLOCK_THREAD_CPUTIME_ID where others may use the machine. */
static inline double bench_seconds(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* A line such as VmRSS of what the operating system says, in bytes. */
static inline uint64_t bench_status_bytes(const char *name) {
    FILE *file = fopen("/proc/self/status", "r");
    char line[256];
    unsigned long long kib = 0;
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, name, strlen(name)) == 0)
            sscanf(line + strlen(name), ": %llu", &kib);
    if (file)
        fclose(file);
    return kib << 10;
}

static inline int bench_compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sorts the values. */
static inline double bench_median(double *values, uint32_t count) {
    qsort(values, count, sizeof *values, bench_compare);
    return values[count / 2];
}

static inline uint32_t bench_random(uint32_t *state) {
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

static inline float bench_random_unit(uint32_t *state) {
    return (float)(bench_random(state) >> 8) * (1.0f / 16777216.0f);
}

static inline void bench_report(bool json, const char *what, const char *unit, double value) {
    if (json)
        printf("{\"what\": \"%s\", \"unit\": \"%s\", \"value\": %.3f}\n", what, unit, value);
    else
        printf("%-40s %10.2f %s\n", what, value, unit);
    fflush(stdout);
}

/* Bars that were asked for, and those that hold. */
typedef struct bench_bars {
    uint32_t asked, held;
} bench_bars;

/* A value that is to be at least a bar, or at most. */
static inline void bench_bar(bench_bars *bars, bool json, const char *what, const char *unit,
                             double value, double bar, bool at_most) {
    const bool holds = at_most ? value <= bar : value >= bar;
    bars->asked++;
    bars->held += holds;
    if (json)
        printf("{\"what\": \"%s\", \"unit\": \"%s\", \"value\": %.3f, \"%s\": %g, \"holds\": %s}\n",
               what, unit, value, at_most ? "most" : "least", bar, holds ? "true" : "false");
    else
        printf("%-40s %10.2f %-16s %s of %s %g\n", what, value, unit, holds ? "pass" : "MISS",
               at_most ? "at most" : "at least", bar);
    fflush(stdout);
}

/* How many hold, and on what. */
static inline void bench_bars_end(const bench_bars *bars, bool json) {
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    if (json)
        printf("{\"bars\": %u, \"hold\": %u, \"processors\": %ld}\n", bars->asked, bars->held,
               processors);
    else
        printf("%u of %u bars hold on this machine of %ld processors\n", bars->held, bars->asked,
               processors);
}

/* Makes an empty file; `path` has room for 64 bytes. */
static inline void bench_temporary(char *path) {
    snprintf(path, 64, "/tmp/" BENCH_NAME "_XXXXXX");
    int descriptor = mkstemp(path);
    if (descriptor < 0)
        bench_stop(SLV_ERROR_IO);
    close(descriptor);
}

/* Who lies beside a face in rows of `columns` faces, `nfaces` in all. */
static inline slv_face_adjacency bench_grid_adjacency(uint32_t face, uint32_t columns,
                                                      uint32_t nfaces) {
    uint32_t x = face % columns;
    slv_face_adjacency a = {{SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY}, {2, 3, 0, 1}};
    if (face >= columns)
        a.face[0] = (int32_t)(face - columns);
    if (x + 1 < columns && face + 1 < nfaces)
        a.face[1] = (int32_t)(face + 1);
    if (face + columns < nfaces)
        a.face[2] = (int32_t)(face + columns);
    if (x)
        a.face[3] = (int32_t)(face - 1);
    return a;
}

typedef struct bench_torus {
    slv_mesh *mesh;
    slv_adjacency *adjacency;
    slv_surface *surface;
} bench_torus;

static inline bench_torus bench_torus_make(const slv_env *env, uint32_t around, uint32_t across) {
    uint32_t nfaces = around * across;
    float *positions = malloc(nfaces * 3 * sizeof *positions);
    int32_t *sizes = malloc(nfaces * sizeof *sizes), *verts = malloc(nfaces * 4 * sizeof *verts);
    bench_torus torus = {0};
    if (!positions || !sizes || !verts)
        bench_stop(SLV_ERROR_MEMORY);
    for (uint32_t i = 0; i < nfaces; i++) {
        uint32_t a = i % around, b = i / around, a1 = (a + 1) % around, b1 = (b + 1) % across;
        float p = 6.2831853f * (float)a / (float)around, q = 6.2831853f * (float)b / (float)across;
        positions[3 * i] = (2 + cosf(q)) * cosf(p);
        positions[3 * i + 1] = sinf(q);
        positions[3 * i + 2] = -(2 + cosf(q)) * sinf(p);
        sizes[i] = 4;
        verts[4 * i] = (int32_t)i;
        verts[4 * i + 1] = (int32_t)(b * around + a1);
        verts[4 * i + 2] = (int32_t)(b1 * around + a1);
        verts[4 * i + 3] = (int32_t)(b1 * around + a);
    }
    slv_mesh_view view = {.nverts = nfaces,
                          .positions = positions,
                          .npolys = nfaces,
                          .poly_sizes = sizes,
                          .poly_verts = verts};
    bench_stop(slv_mesh_create(env, &view, &torus.mesh));
    bench_stop(slv_mesh_adjacency(env, torus.mesh, &torus.adjacency));
    bench_stop(slv_surface_create(env, torus.mesh, NULL, &torus.surface));
    free(positions);
    free(sizes);
    free(verts);
    return torus;
}

static inline void bench_torus_free(bench_torus *torus) {
    slv_surface_destroy(torus->surface);
    slv_adjacency_destroy(torus->adjacency);
    slv_mesh_destroy(torus->mesh);
}

/* Sides of 2^log2 texels; of a half and a quarter of that too, if `mixed`. */
static inline void bench_res(uint32_t nfaces, int log2, bool mixed, slv_res *out) {
    uint32_t state = 7;
    for (uint32_t i = 0; i < nfaces; i++) {
        state = state * 1664525 + 1013904223;
        int8_t own = (int8_t)(log2 - (mixed ? (int)(state >> 24) % 3 : 0));
        out[i] = (slv_res){own, own};
    }
}

/* One file at most, and two flags; says what is expected where there is anything else. */
static inline bool bench_arguments(int argc, char **argv, const char *file, const char **path,
                                   bool *json, bool *smoke) {
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--json") == 0) {
            *json = true;
        } else if (strcmp(argv[i], "--smoke") == 0) {
            *smoke = true;
        } else if (argv[i][0] != '-' && !*path) {
            *path = argv[i];
        } else {
            fprintf(stderr, "usage: %s [%s] [--json] [--smoke]\n", argv[0], file);
            return false;
        }
    }
    return true;
}

#endif
