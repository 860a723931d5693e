/* What the benchmarks of resampled textures share: patterns on a torus of 512 faces, and how far a
 * function is from that of the ray-cast reference. */
#ifndef FUNCTION_KIT_H
#define FUNCTION_KIT_H

#include "kit/bench_kit.h"

#include <selvage/bake.h>
#include <selvage/reference.h>

#include <string.h>

enum { AROUND = 32, ACROSS = 16, NFACES = AROUND * ACROSS, MAX_POINTS = 1 << 17 };

typedef struct options {
    uint32_t threads, points;
    int log2;
    bool json;
} options;

/* Exits on a wrong argument. */
static inline options options_parse(int argc, char **argv) {
    options o = {.points = MAX_POINTS, .log2 = 6};
    for (int i = 1; i < argc; i++) {
        if (!strcmp(argv[i], "--json"))
            o.json = true;
        else if (!strcmp(argv[i], "--smoke")) {
            o.points = 1 << 12;
            o.log2 = 3;
        } else if (!strcmp(argv[i], "--threads") && i + 1 < argc)
            o.threads = (uint32_t)atoi(argv[++i]);
        else {
            fprintf(stderr, "usage: " BENCH_NAME " [--threads N] [--json] [--smoke]\n");
            exit(2);
        }
    }
    return o;
}

/* From smooth to hard-edged. */
static const struct {
    const char *name;
    slv_procedural pattern;
} patterns[] = {{"position", {.pattern = SLV_PATTERN_POSITION, .frequency = 0.1f}},
                {"smooth noise", {.pattern = SLV_PATTERN_NOISE, .frequency = 4, .octaves = 3}},
                {"fine noise", {.pattern = SLV_PATTERN_NOISE, .frequency = 64, .octaves = 2}},
                {"checker", {.pattern = SLV_PATTERN_CHECKER, .frequency = 8}},
                {"face colours", {.pattern = SLV_PATTERN_FACE_COLOR}}};
enum { PATTERNS = sizeof patterns / sizeof *patterns };

/* The value of a function at a point, three channels. */
typedef void value_function(const void *user, const slv_surface_point *at, float *rgb);

/* The RMS of the difference from the reference's function over random points, as many on every
 * texel. */
static inline double against_reference(const slv_env *env, const options *o, const bench_torus *s,
                                       const slv_texture *texture, value_function *value_at,
                                       const void *user) {
    static slv_surface_point points[MAX_POINTS];
    static float rgb[3 * MAX_POINTS];
    const slv_reference_params params = {.segments = 2};
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    slv_reference *reference = NULL;
    uint32_t state = 1;
    double sum = 0, weights = 0;
    bench_stop(
        slv_reference_create(env, s->mesh, s->surface, texture, s->adjacency, &params, &reference));
    for (uint32_t i = 0; i < o->points; i++) {
        uint32_t r[2];
        for (int k = 0; k < 2; k++)
            r[k] = state = state * 1664525 + 1013904223;
        points[i] = (slv_surface_point){(int32_t)(i % NFACES), (float)(r[0] >> 8) / 16777216,
                                        (float)(r[1] >> 8) / 16777216};
    }
    bench_stop(slv_reference_lookup(reference, o->points, points, rgb));
    for (uint32_t i = 0; i < o->points; i++) {
        slv_res res = desc->res[points[i].face];
        double weight = ldexp(1, res.u + res.v);
        float value[3];
        value_at(user, &points[i], value);
        for (int c = 0; c < 3; c++) {
            double lost = (double)value[c] - (double)rgb[3 * i + (uint32_t)c];
            sum += weight * lost * lost;
            weights += weight;
        }
    }
    slv_reference_destroy(reference);
    return sqrt(sum / weights);
}

#endif
