/* bench_htex [--threads N] [--json] [--smoke]
 *
 * What the squares of half-edges cost and lose, on a torus of 512 faces under patterns from smooth
 * to hard-edged, at one resolution, at mixed ones and on oblong faces: time to convert, bytes
 * against those of the texture, the error at the centres of texels and everywhere; the latter also
 * as seen by the lookups of the ray-cast reference at random points. */
#include "kit/function_kit.h"

#include <selvage/htex.h>

typedef enum shapes { EQUAL, MIXED, OBLONG } shapes;
static const char *const shape_names[] = {"equal", "mixed", "oblong"};

static void value_at(const void *user, const slv_surface_point *at, float *rgb) {
    slv_htex_lookup(user, (uint32_t)at->face, at->u, at->v, 0, rgb);
}

static void measure(const slv_env *env, const options *o, const bench_torus *s, const char *name,
                    const slv_procedural *pattern, slv_type type, shapes shape) {
    static slv_res res[NFACES];
    slv_texture *texture = NULL;
    slv_levels *levels = NULL;
    slv_htex *htex = NULL;
    slv_htex_error error;
    bench_res(NFACES, o->log2, shape == MIXED, res);
    for (int i = 0; shape == OBLONG && i < NFACES; i++)
        res[i] = (slv_res){(int8_t)(res[i].u + 1), (int8_t)(res[i].v - 1)};
    slv_texture_desc desc = {NFACES, type, 3, SLV_NO_ALPHA, res, SLV_TEXTURE_LINEAR};
    bench_stop(slv_texture_create(env, &desc, &texture));
    bench_stop(slv_bake_procedural(env, s->surface, pattern, NULL, texture));
    bench_stop(slv_levels_create(env, texture, &levels));
    double start = bench_seconds(CLOCK_MONOTONIC);
    bench_stop(slv_htex_create(env, levels, s->adjacency, &htex));
    double seconds = bench_seconds(CLOCK_MONOTONIC) - start;
    bench_stop(slv_htex_measure(env, htex, levels, s->adjacency, &error));
    double reference = against_reference(env, o, s, texture, value_at, htex);
    double speed = (double)slv_htex_bytes(htex) / (double)(3 * slv_type_size(type)) / 1e6 / seconds;
    double bytes = (double)slv_htex_bytes(htex) / (double)slv_texture_bytes(texture);
    if (o->json)
        printf("{\"pattern\": \"%s\", \"type\": \"%s\", \"shapes\": \"%s\", \"mtexels_s\": %.2f, "
               "\"bytes\": %.4f, \"texel_rms\": %.6f, "
               "\"texel_max\": %.6f, \"function_rms\": %.6f, \"function_max\": %.6f, "
               "\"reference_rms\": %.6f}\n",
               name, slv_type_name(type), shape_names[shape], speed, bytes, error.texel_rms,
               error.texel_max, error.function_rms, error.function_max, reference);
    else
        printf("%-14s %-6s %-6s %7.1f   %.3f   %.5f %.4f   %.5f %.4f   %.5f\n", name,
               slv_type_name(type), shape_names[shape], speed, bytes, error.texel_rms,
               error.texel_max, error.function_rms, error.function_max, reference);
    slv_htex_destroy(htex);
    slv_levels_destroy(levels);
    slv_texture_destroy(texture);
}

int main(int argc, char **argv) {
    options o = options_parse(argc, argv);
    slv_env env = {.log = bench_log, .threads = o.threads};
    bench_torus s = bench_torus_make(&env, AROUND, ACROSS);
    if (!o.json)
        puts("                             Mtexels/s  bytes    at texels'         everywhere   "
             "    reference\n"
             "                                       to texels centres: rms, max   rms, max");
    for (size_t i = 0; i < PATTERNS; i++) {
        measure(&env, &o, &s, patterns[i].name, &patterns[i].pattern, SLV_TYPE_FLOAT, EQUAL);
        measure(&env, &o, &s, patterns[i].name, &patterns[i].pattern, SLV_TYPE_U8, EQUAL);
        measure(&env, &o, &s, patterns[i].name, &patterns[i].pattern, SLV_TYPE_FLOAT, MIXED);
        measure(&env, &o, &s, patterns[i].name, &patterns[i].pattern, SLV_TYPE_FLOAT, OBLONG);
    }
    bench_torus_free(&s);
    return 0;
}
