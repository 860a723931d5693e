/* bench_surface_move [MESH.obj] [--segments N] [--runs N] [--json] [--smoke]
 *
 * What a frame of an animated cage costs: the surface moved, against made afresh, each with and
 * without the vertices of a tessellation, of 2, 4 and 8 segments if none are named. Processor time
 * of one thread, medians, in turn. */
#include "kit/bench_kit.h"

#include <selvage/tessellation.h>

#include <string.h>

enum { MAX_RUNS = 201 };

static slv_env env = {.log = bench_log, .threads = 1};

static double tessellate(const slv_mesh *mesh, const slv_surface *surface,
                         const slv_adjacency *adjacency, uint32_t segments) {
    slv_tessellation vertices;
    double start = bench_seconds(CLOCK_THREAD_CPUTIME_ID);
    bench_stop(slv_tessellate(&env, mesh, surface, adjacency, segments, &vertices));
    start = bench_seconds(CLOCK_THREAD_CPUTIME_ID) - start;
    slv_tessellation_free(&vertices);
    return start;
}

/* `surface` moves. */
static void measure(const bench_torus *torus, uint32_t segments, uint32_t runs, bool json) {
    static double move[MAX_RUNS], moved[MAX_RUNS], make[MAX_RUNS], made[MAX_RUNS];
    const slv_mesh_view *view = slv_mesh_get_view(torus->mesh);
    for (uint32_t r = 0; r < runs; r++) {
        slv_surface *afresh;
        double start = bench_seconds(CLOCK_THREAD_CPUTIME_ID);
        bench_stop(slv_surface_move(torus->surface, view->nverts, view->positions));
        move[r] = bench_seconds(CLOCK_THREAD_CPUTIME_ID) - start;
        moved[r] = tessellate(torus->mesh, torus->surface, torus->adjacency, segments);
        start = bench_seconds(CLOCK_THREAD_CPUTIME_ID);
        bench_stop(slv_surface_create(&env, torus->mesh, NULL, &afresh));
        make[r] = bench_seconds(CLOCK_THREAD_CPUTIME_ID) - start;
        made[r] = tessellate(torus->mesh, afresh, torus->adjacency, segments);
        slv_surface_destroy(afresh);
    }
    const double moving = bench_median(move, runs), making = bench_median(make, runs),
                 moved_all = moving + bench_median(moved, runs);
    bench_report(json, "segments", "", segments);
    bench_report(json, "surface afresh", "ms", 1e3 * making);
    bench_report(json, "surface moved", "ms", 1e3 * moving);
    bench_report(json, "vertices of one afresh", "ms", 1e3 * bench_median(made, runs));
    bench_report(json, "vertices of one moved", "ms", 1e3 * (moved_all - moving));
    bench_report(json, "afresh by moved", "times", making / moving);
    bench_report(json, "both with vertices", "times",
                 (making + bench_median(made, runs)) / moved_all);
    bench_report(json, "moved with vertices, afresh without", "times", making / moved_all);
}

int main(int argc, char **argv) {
    const char *path = NULL;
    uint32_t segments = 0, runs = 31;
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
    const slv_surface_params params = {.moves = true};
    bench_stop(slv_surface_create(&env, torus.mesh, &params, &torus.surface));
    for (uint32_t n = segments ? segments : 2; n <= (segments ? segments : 8); n *= 2)
        measure(&torus, n, runs, json);
    bench_torus_free(&torus);
    return 0;
}
