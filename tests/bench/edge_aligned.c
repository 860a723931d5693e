/* bench_edge_aligned [--threads N] [--json] [--smoke]
 *
 * What edge-aligned samples cost and lose, on a torus of 512 faces under patterns from smooth to
 * hard-edged, at one resolution and at mixed ones: time to convert, bytes against those of bordered
 * levels, the error of a texture that went forth and back, and that of the interpolated function;
 * the latter also as seen by the lookups of the ray-cast reference at random points. */
#include "kit/function_kit.h"

#include <selvage/edge_aligned.h>

static void value_at(const void *user, const slv_surface_point *at, float *rgb) {
    slv_edge_aligned_lookup(user, (uint32_t)at->face, 0, at->u, at->v, rgb);
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
    slv_texture_desc desc = {NFACES, type, 3, SLV_NO_ALPHA, res, SLV_TEXTURE_LINEAR};
    bench_stop(slv_texture_create(env, &desc, &texture));
    bench_stop(slv_bake_procedural(env, s->surface, pattern, NULL, texture));
    bench_stop(slv_levels_create(env, texture, &levels));
    double start = bench_seconds(CLOCK_MONOTONIC);
    bench_stop(slv_edge_aligned_create(env, levels, s->adjacency, &aligned));
    double seconds = bench_seconds(CLOCK_MONOTONIC) - start;
    bench_stop(slv_edge_aligned_measure(env, aligned, levels, s->adjacency, &error));
    double reference = against_reference(env, o, s, texture, value_at, aligned);
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
    options o = options_parse(argc, argv);
    slv_env env = {.log = bench_log, .threads = o.threads};
    bench_torus s = bench_torus_make(&env, AROUND, ACROSS);
    if (!o.json)
        puts("                            Msamples/s bytes borders  there and back   interpolated"
             "     reference\n"
             "                                       to texels        rms   max       rms   max"
             "        rms");
    for (size_t i = 0; i < PATTERNS; i++) {
        measure(&env, &o, &s, patterns[i].name, &patterns[i].pattern, SLV_TYPE_FLOAT, false);
        measure(&env, &o, &s, patterns[i].name, &patterns[i].pattern, SLV_TYPE_U8, false);
        measure(&env, &o, &s, patterns[i].name, &patterns[i].pattern, SLV_TYPE_FLOAT, true);
    }
    bench_torus_free(&s);
    return 0;
}
