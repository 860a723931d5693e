/* bench_minified [FILE.ptx] [--json] [--smoke]
 *
 * The seam jump of lookups at footprints of 2 to 16 texels, for each strategy that looks beyond a
 * face: of a quad .ptx as it is, with levels that agree at full resolution too, and of these looked
 * up in even levels, without and with anisotropy; or of a torus of 128 faces under noise, of one
 * resolution and of mixed ones, if no file is named. */
#include "kit/bench_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/bake.h>
#include <selvage/gl_texture.h>
#include <selvage/ptx.h>
#include <selvage/seamless.h>

#include <string.h>

enum { AROUND = 16, ACROSS = 8, NFACES = AROUND * ACROSS, LAST_LEVEL = 4 };

static const slv_env env = {.log = bench_log};

static void print_row(const char *name, const char *strategy, const slv_gl_seam *seams, bool json) {
    if (json)
        printf("{\"texture\":\"%s\",\"strategy\":\"%s\"", name, strategy);
    else
        printf("%-20s %-13s", name, strategy);
    for (uint32_t level = 1; level <= LAST_LEVEL; level++)
        if (json)
            printf(",\"max_%u\":%.3f,\"equal_max_%u\":%.3f,\"mean_%u\":%.3f", 1u << level,
                   255 * (double)seams[level].max, 1u << level,
                   255 * (double)seams[level].equal_max, 1u << level,
                   255 * (double)seams[level].mean);
        else
            printf("  %6.2f %6.2f %5.2f", 255 * (double)seams[level].max,
                   255 * (double)seams[level].equal_max, 255 * (double)seams[level].mean);
    puts(json ? "}" : "");
}

static void report(slv_gl *gl, const slv_texture *texture, const slv_adjacency *adjacency,
                   const char *name, bool even, uint32_t anisotropy, bool json) {
    static const char *const strategies[] = {"clamp", "borders", "edge-aligned", "traverse",
                                             "htex"};
    const slv_gl_texture_params uploaded = {KIT_ALL, .even_levels = even, .anisotropy = anisotropy};
    slv_gl_texture *made = NULL;
    bench_stop(slv_gl_texture_create(gl, &env, texture, adjacency, &uploaded, &made));
    for (size_t s = 0; s < sizeof strategies / sizeof *strategies; s++) {
        slv_gl_seam seams[LAST_LEVEL + 1];
        for (uint32_t level = 1; level <= LAST_LEVEL; level++) {
            const slv_gl_seam_params params = {.level = level};
            bench_stop(slv_gl_texture_seam_jump(made, &env, slv_strategy_find(strategies[s]),
                                                adjacency, &params, &seams[level]));
        }
        print_row(name, strategies[s], seams, json);
    }
    slv_gl_texture_destroy(made);
}

/* The same with full resolution that agrees across edges. */
static void agree(const slv_texture *from, const slv_adjacency *adjacency, slv_texture **out) {
    const slv_texture_desc *desc = slv_texture_get_desc(from);
    slv_levels *levels = NULL;
    bench_stop(slv_levels_create_seamless(&env, from, adjacency, 0, &levels));
    bench_stop(slv_texture_create(&env, desc, out));
    for (uint32_t face = 0; face < desc->nfaces; face++)
        bench_stop(slv_texture_set_face(*out, face, slv_levels_texels(levels, face, 0)));
    slv_levels_destroy(levels);
}

static void report_both(slv_gl *gl, const slv_texture *texture, const slv_adjacency *adjacency,
                        const char *name, bool json) {
    slv_texture *agreed = NULL;
    char named[64];
    report(gl, texture, adjacency, name, false, 1, json);
    agree(texture, adjacency, &agreed);
    snprintf(named, sizeof named, "%s, agreeing", name);
    report(gl, agreed, adjacency, named, false, 1, json);
    for (uint32_t anisotropy = 1; anisotropy <= 16; anisotropy *= 16) {
        snprintf(named, sizeof named, "%s, even, %ux", name, anisotropy);
        report(gl, agreed, adjacency, named, true, anisotropy, json);
    }
    slv_texture_destroy(agreed);
}

static void report_file(slv_gl *gl, const char *path, bool json) {
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL;
    slv_adjacency *adjacency = NULL;
    bench_stop(slv_ptx_open(&env, path, &ptx));
    bench_stop(slv_ptx_load_texture(&env, ptx, &texture));
    bench_stop(slv_ptx_load_adjacency(&env, ptx, &adjacency));
    report_both(gl, texture, adjacency, "file", json);
    slv_texture_destroy(texture);
    slv_adjacency_destroy(adjacency);
    slv_ptx_close(ptx);
}

static void report_torus(slv_gl *gl, int log2, bool json) {
    static slv_res res[NFACES];
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE, .frequency = 2, .octaves = 3};
    const slv_texture_desc desc = {NFACES, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res, SLV_TEXTURE_LINEAR};
    bench_torus torus = bench_torus_make(&env, AROUND, ACROSS);
    for (int mixed = 0; mixed < 2; mixed++) {
        slv_texture *texture = NULL;
        bench_res(NFACES, log2, mixed, res);
        bench_stop(slv_texture_create(&env, &desc, &texture));
        bench_stop(slv_bake_procedural(&env, torus.surface, &noise, NULL, texture));
        report_both(gl, texture, torus.adjacency, mixed ? "mixed" : "equal", json);
        slv_texture_destroy(texture);
    }
    bench_torus_free(&torus);
}

int main(int argc, char **argv) {
    bool json = false, smoke = false;
    const char *path = NULL;
    if (!bench_arguments(argc, argv, "FILE.ptx", &path, &json, &smoke))
        return 2;
    slv_gl *gl = NULL;
    bench_stop(slv_gl_create(&env, SLV_GL_AUTO, &gl));
    if (!json)
        puts("largest jump in 1/255, that between texels of one size, mean; at 2, 4, 8, 16 texels");
    if (path)
        report_file(gl, path, json);
    else
        report_torus(gl, smoke ? 3 : 6, json);
    slv_gl_destroy(gl);
    return 0;
}
