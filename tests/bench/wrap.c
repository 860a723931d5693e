/* What coordinates that go round cost: frames of a torus with the method and one coordinate a
 * vertex, against plain mapping of the mesh with duplicated vertices, in turn. On software drivers
 * processor time counts, which other work on the machine touches least. */
#include "kit/bench_kit.h"
#include "kit/wrap_kit.h"

#include <string.h>

enum { MAX_FRAMES = 401, WAYS = 4, SIDE = 256 };

static const slv_env env = {.log = bench_log};

int main(int argc, char **argv) {
    static const char *const defines[WAYS] = {"#define TORUS\n#define PLAIN\n", "#define TORUS\n",
                                              "#define TORUS\n#define PLAIN\n#define GRADIENTS\n",
                                              "#define TORUS\n#define GRADIENTS\n"};
    static const float low[3] = {-1.3f, -0.5f, -1.3f}, high[3] = {1.3f, 0.5f, 1.3f};
    static double seconds[WAYS][MAX_FRAMES];
    double median[WAYS];
    uint32_t frames = 101, size = 512;
    bool json = false;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--smoke") == 0)
            frames = 3, size = 64;
        else if (strcmp(argv[i], "--json") == 0)
            json = true;
        else {
            fprintf(stderr, "usage: %s [--smoke] [--json]\n", BENCH_NAME);
            return 2;
        }
    }
    slv_gl *gl = NULL;
    bench_stop(slv_gl_create(&env, SLV_GL_AUTO, &gl));
    wrap_load(gl);
    wrap_mesh meshes[2] = {wrap_make(true, true, 128, 64, 0), wrap_make(true, false, 128, 64, 0)};
    wrap_buffers buffers[2] = {wrap_upload(&meshes[0]), wrap_upload(&meshes[1])};
    float *rgb = wrap_room(SIDE * SIDE, 3 * sizeof *rgb);
    uint32_t random = 5;
    for (uint32_t i = 0; i < 3 * SIDE * SIDE; i++)
        rgb[i] = bench_random_unit(&random);
    GLuint texture = wrap_texture(rgb, SIDE, SIDE), programs[WAYS];
    char *include = wrap_include();
    wrap_target target = wrap_target_make(gl, size, 4);
    for (int w = 0; w < WAYS; w++)
        programs[w] = wrap_program(include, defines[w]);
    bool software = slv_gl_get_info(gl)->software;
    clockid_t clock = software ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC;
    for (uint32_t f = 0; f < frames + 2; f++)
        for (int w = 0; w < WAYS; w++) {
            /* on hardware one frame is too short for a clock */
            uint32_t times = software ? 1 : 200;
            const slv_camera camera = slv_camera_orbit(low, high, (float)(7 * f), 35, 35, 1);
            wrap_api.Finish();
            double start = bench_seconds(clock);
            for (uint32_t i = 0; i < times; i++)
                wrap_draw(&target, programs[w], texture, &buffers[w & 1], &camera, 1);
            wrap_api.Finish();
            if (f > 1)
                seconds[w][f - 2] = (bench_seconds(clock) - start) / times;
        }
    for (int w = 0; w < WAYS; w++)
        median[w] = bench_median(seconds[w], frames);
    bench_report(json, "plain mapping, duplicated vertices", "ms", 1e3 * median[0]);
    bench_report(json, "one coordinate a vertex", "ms", 1e3 * median[1]);
    bench_report(json, "times plain mapping", "", median[1] / median[0]);
    bench_report(json, "explicit gradients, times plain ones", "", median[3] / median[2]);
    bench_report(json, "vertices of plain mapping", "", meshes[0].nverts);
    bench_report(json, "vertices with the method", "", meshes[1].nverts);
    wrap_target_free(&target);
    wrap_api.DeleteTextures(1, &texture);
    for (int w = 0; w < WAYS; w++)
        wrap_api.DeleteProgram(programs[w]);
    for (int i = 0; i < 2; i++) {
        wrap_discard(&buffers[i]);
        wrap_free(&meshes[i]);
    }
    free(include);
    free(rgb);
    slv_gl_destroy(gl);
    return 0;
}
