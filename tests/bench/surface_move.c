/* bench_surface_move [MESH.obj] [--segments N] [--runs N] [--json] [--smoke]
 *
 * What a frame of an animated cage costs: the surface moved, against made afresh, each with and
 * without the vertices of a tessellation. Processor time of one thread, medians, in turn. */
#include "kit/bench_kit.h"

#include <selvage/tessellation.h>

#include <string.h>

enum { MAX_RUNS = 201, WAYS = 3 };

static slv_env env = {.log = bench_log, .threads = 1};

int main(int argc, char **argv) {
    static double seconds[WAYS][MAX_RUNS];
    const char *path = NULL;
    uint32_t segments = 4, runs = 31;
    bool json = false, smoke = false;
    bench_torus torus = {0};
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--smoke") == 0)
            smoke = true, runs = 3;
        else if (strcmp(argv[i], "--json") == 0)
            json = true;
        else if (strcmp(argv[i], "--segments") == 0 && i + 1 < argc)
            segments = (uint32_t)strtoul(argv[++i], NULL, 10);
        else if (strcmp(argv[i], "--runs") == 0 && i + 1 < argc)
            runs = (uint32_t)strtoul(argv[++i], NULL, 10);
        else
            path = argv[i];
    }
    runs = runs > MAX_RUNS ? MAX_RUNS : runs ? runs : 1;
    if (path) {
        bench_stop(slv_mesh_load(&env, path, &torus.mesh));
        bench_stop(slv_mesh_adjacency(&env, torus.mesh, &torus.adjacency));
    } else {
        torus = bench_torus_make(&env, smoke ? 8 : 60, smoke ? 6 : 40);
        slv_surface_destroy(torus.surface);
    }
    const slv_mesh_view *view = slv_mesh_get_view(torus.mesh);
    const slv_surface_params params = {.moves = true};
    bench_stop(slv_surface_create(&env, torus.mesh, &params, &torus.surface));
    for (uint32_t r = 0; r < runs; r++) {
        slv_tessellation vertices;
        slv_surface *afresh;
        double start = bench_seconds(CLOCK_THREAD_CPUTIME_ID);
        bench_stop(slv_surface_move(torus.surface, view->nverts, view->positions));
        seconds[0][r] = bench_seconds(CLOCK_THREAD_CPUTIME_ID) - start;
        start = bench_seconds(CLOCK_THREAD_CPUTIME_ID);
        bench_stop(
            slv_tessellate(&env, torus.mesh, torus.surface, torus.adjacency, segments, &vertices));
        seconds[1][r] = bench_seconds(CLOCK_THREAD_CPUTIME_ID) - start;
        slv_tessellation_free(&vertices);
        start = bench_seconds(CLOCK_THREAD_CPUTIME_ID);
        bench_stop(slv_surface_create(&env, torus.mesh, NULL, &afresh));
        seconds[2][r] = bench_seconds(CLOCK_THREAD_CPUTIME_ID) - start;
        slv_surface_destroy(afresh);
    }
    double move = bench_median(seconds[0], runs), divide = bench_median(seconds[1], runs),
           make = bench_median(seconds[2], runs);
    bench_report(json, "surface afresh", "ms", 1e3 * make);
    bench_report(json, "surface moved", "ms", 1e3 * move);
    bench_report(json, "vertices of it", "ms", 1e3 * divide);
    bench_report(json, "afresh by moved", "times", make / move);
    bench_report(json, "afresh by moved with vertices", "times", make / (move + divide));
    bench_torus_free(&torus);
    return 0;
}
