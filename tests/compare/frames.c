/* Frames of the demo scene, for frames.sh, which compiles this against either of two builds: so it
 * keeps to calls that there have been since the first of them. Prints the processor time of the
 * whole process for a frame with each strategy, in milliseconds, the median of some frames of an
 * orbit. */
#include <selvage/gl_renderer.h>
#include <selvage/ptx.h>

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { WIDTH = 960, HEIGHT = 540, FRAMES = 5 };

static void log_line(void *user, slv_log_level level, const char *message) {
    (void)user;
    if (level != SLV_LOG_INFO)
        fprintf(stderr, "frames: %s\n", message);
}

static const slv_env env = {.log = log_line};

static void need(slv_result result) {
    if (result)
        exit(1);
}

static double processor_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static slv_camera camera_at(const slv_mesh_stats *stats, float turn) {
    return slv_camera_orbit(stats->bounds_min, stats->bounds_max, 30 + 360 * turn, 20, 35,
                            (float)WIDTH / HEIGHT);
}

int main(int argc, char **argv) {
    if (argc != 5) {
        fputs("usage: frames SCENE.OBJ SCENE.PTX MSAA ANISOTROPY\n", stderr);
        return 2;
    }
    slv_mesh *mesh = NULL;
    slv_ptx *ptx = NULL;
    slv_texture *texels = NULL;
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    slv_gl *gl = NULL;
    slv_gl_renderer *renderer = NULL;
    slv_mesh_stats stats;
    need(slv_mesh_load(&env, argv[1], &mesh));
    need(slv_ptx_open(&env, argv[2], &ptx));
    need(slv_ptx_load_texture(&env, ptx, &texels));
    need(slv_mesh_adjacency(&env, mesh, &adjacency));
    need(slv_mesh_get_stats(&env, mesh, &stats));
    need(slv_surface_create(&env, mesh, NULL, &surface));
    need(slv_gl_create(&env, SLV_GL_AUTO, &gl));
    slv_camera first = camera_at(&stats, 0);
    uint32_t segments = slv_tessellation_for(mesh, &first, WIDTH, HEIGHT);
    need(slv_gl_renderer_create(gl, &env, mesh, surface, segments, &renderer));
    for (uint32_t k = 0; k < slv_strategy_count(); k++) {
        const slv_strategy *strategy = slv_strategy_at(k);
        slv_gl_texture_params params = {
            .strategies = &strategy, .nstrategies = 1, .anisotropy = (uint32_t)atoi(argv[4])};
        slv_gl_texture *texture = NULL;
        double times[FRAMES];
        need(slv_gl_texture_create(gl, &env, texels, adjacency, &params, &texture));
        for (int i = -1; i < FRAMES; i++) { /* the first compiles shaders */
            slv_frame frame = {.width = WIDTH,
                               .height = HEIGHT,
                               .msaa = (uint32_t)atoi(argv[3]),
                               .strategy = strategy,
                               .camera = camera_at(&stats, (float)i / FRAMES)};
            double seconds, before = processor_ms();
            need(slv_gl_renderer_draw(renderer, &env, texture, &frame, NULL, &seconds));
            if (i >= 0)
                times[i] = processor_ms() - before;
        }
        qsort(times, FRAMES, sizeof *times, compare);
        printf("%s %.3f\n", strategy->name, times[FRAMES / 2]);
        slv_gl_texture_destroy(texture);
    }
    slv_gl_renderer_destroy(renderer);
    slv_gl_destroy(gl);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_texture_destroy(texels);
    slv_ptx_close(ptx);
    slv_mesh_destroy(mesh);
    return 0;
}
