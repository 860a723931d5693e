/* bench_edge_aligned [--threads N] [--json] [--smoke]
 *
 * What edge-aligned samples cost and lose, on a torus of 512 faces under patterns from smooth to
 * hard-edged, at one resolution and at mixed ones: time to convert, bytes against those of bordered
 * levels, the error of a texture that went forth and back, and that of the interpolated function;
 * the latter also as seen by the lookups of the ray-cast reference at random points. */
#include "bench_kit.h"

#include <selvage/bake.h>
#include <selvage/edge_aligned.h>
#include <selvage/reference.h>

#include <string.h>

enum { AROUND = 32, ACROSS = 16, NFACES = AROUND * ACROSS, MAX_POINTS = 1 << 17 };

typedef struct options {
    uint32_t threads, points;
    int log2;
    bool json;
} options;

/* The RMS of the difference from the reference's function over random points, as many on every
 * texel. */
static double against_reference(const slv_env *env, const options *o, const bench_torus *s,
                                const slv_texture *texture, const slv_edge_aligned *aligned) {
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
        slv_edge_aligned_lookup(aligned, (uint32_t)points[i].face, 0, points[i].u, points[i].v,
                                value);
        for (int c = 0; c < 3; c++) {
            double lost = (double)value[c] - (double)rgb[3 * i + (uint32_t)c];
            sum += weight * lost * lost;
            weights += weight;
        }
    }
    slv_reference_destroy(reference);
    return sqrt(sum / weights);
}

static uint64_t bordered_bytes(const slv_texture_desc *desc) {
    uint64_t texels = 0;
    for (uint32_t face = 0; face < desc->nfaces; face++)
        for (uint32_t level = 0; level < slv_res_level_count(desc->res[face]); level++) {
            slv_res res = slv_res_level(desc->res[face], level);
            texels += ((UINT64_C(1) << res.u) + 2) * ((UINT64_C(1) << res.v) + 2);
        }
    return texels * desc->nchannels * slv_type_size(desc->type);
}

static void measure(const slv_env *env, const options *o, const bench_torus *s, const char *name,
                    const slv_procedural *pattern, slv_type type, bool mixed) {
    static slv_res res[NFACES];
    slv_texture *texture = NULL;
    slv_levels *levels = NULL;
    slv_edge_aligned *aligned = NULL;
    slv_edge_aligned_error error;
    bench_res(NFACES, o->log2, mixed, res);
    slv_texture_desc desc = {NFACES, type, 3, SLV_NO_ALPHA, res};
    bench_stop(slv_texture_create(env, &desc, &texture));
    bench_stop(slv_bake_procedural(env, s->surface, pattern, NULL, texture));
    bench_stop(slv_levels_create(env, texture, &levels));
    double start = bench_seconds(CLOCK_MONOTONIC);
    bench_stop(slv_edge_aligned_create(env, levels, s->adjacency, &aligned));
    double seconds = bench_seconds(CLOCK_MONOTONIC) - start;
    bench_stop(slv_edge_aligned_measure(env, aligned, levels, s->adjacency, &error));
    double reference = against_reference(env, o, s, texture, aligned);
    double speed =
        (double)slv_edge_aligned_bytes(aligned) / (double)(3 * slv_type_size(type)) / 1e6 / seconds;
    double bytes = (double)slv_edge_aligned_bytes(aligned) / (double)slv_texture_bytes(texture);
    double bordered = (double)bordered_bytes(&desc) / (double)slv_texture_bytes(texture);
    if (o->json)
        printf("{\"pattern\": \"%s\", \"type\": \"%s\", \"mixed\": %s, \"msamples_s\": %.2f, "
               "\"bytes\": %.4f, \"bordered_bytes\": %.4f, \"round_trip_rms\": %.6f, "
               "\"round_trip_max\": %.6f, \"function_rms\": %.6f, \"function_max\": %.6f, "
               "\"reference_rms\": %.6f}\n",
               name, slv_type_name(type), mixed ? "true" : "false", speed, bytes, bordered,
               error.round_trip_rms, error.round_trip_max, error.function_rms, error.function_max,
               reference);
    else
        printf("%-14s %-6s %-5s %7.1f   %.3f %.3f   %.5f %.4f   %.5f %.4f   %.5f\n", name,
               slv_type_name(type), mixed ? "mixed" : "equal", speed, bytes, bordered,
               error.round_trip_rms, error.round_trip_max, error.function_rms, error.function_max,
               reference);
    slv_edge_aligned_destroy(aligned);
    slv_levels_destroy(levels);
    slv_texture_destroy(texture);
}

int main(int argc, char **argv) {
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
            fprintf(stderr, "usage: bench_edge_aligned [--threads N] [--json] [--smoke]\n");
            return 2;
        }
    }
    slv_env env = {.log = bench_log, .threads = o.threads};
    static const struct {
        const char *name;
        slv_procedural pattern;
    } rows[] = {{"position", {.pattern = SLV_PATTERN_POSITION, .frequency = 0.1f}},
                {"smooth noise", {.pattern = SLV_PATTERN_NOISE, .frequency = 4, .octaves = 3}},
                {"fine noise", {.pattern = SLV_PATTERN_NOISE, .frequency = 64, .octaves = 2}},
                {"checker", {.pattern = SLV_PATTERN_CHECKER, .frequency = 8}},
                {"face colours", {.pattern = SLV_PATTERN_FACE_COLOR}}};
    bench_torus s = bench_torus_make(&env, AROUND, ACROSS);
    if (!o.json)
        puts("                            Msamples/s bytes borders  there and back   interpolated"
             "     reference\n"
             "                                       to texels        rms   max       rms   max"
             "        rms");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        measure(&env, &o, &s, rows[i].name, &rows[i].pattern, SLV_TYPE_FLOAT, false);
        measure(&env, &o, &s, rows[i].name, &rows[i].pattern, SLV_TYPE_U8, false);
        measure(&env, &o, &s, rows[i].name, &rows[i].pattern, SLV_TYPE_FLOAT, true);
    }
    bench_torus_free(&s);
    return 0;
}
