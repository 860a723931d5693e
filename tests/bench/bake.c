/* How many texels a second and processor come out of each source of a bake. */
#include "kit/bench_kit.h"

#include <selvage/bake.h>
#include <selvage/image.h>

#include <string.h>

enum { SIDE = 16 };

/* A plane of faces over an image, whose coordinates go along its axes or lean by so many degrees.
 */
static slv_mesh *make_mesh(const slv_env *env, double lean) {
    const double c = cos(lean * 0.017453292519943295), s = sin(lean * 0.017453292519943295);
    static char text[SIDE * SIDE * 200];
    slv_mesh *mesh = NULL;
    size_t used = 0;
    for (int i = 0; i <= SIDE; i++)
        for (int j = 0; j <= SIDE; j++) {
            const double u = (double)j / SIDE - 0.5, v = (double)i / SIDE - 0.5;
            used += (size_t)snprintf(text + used, sizeof text - used, "v %d %d 0\nvt %g %g\n", j, i,
                                     0.5 + c * u - s * v, 0.5 + s * u + c * v);
        }
    for (int i = 0; i < SIDE; i++)
        for (int j = 0; j < SIDE; j++) {
            int a = i * (SIDE + 1) + j + 1, b = a + SIDE + 1;
            used += (size_t)snprintf(text + used, sizeof text - used, "f %d/%d %d/%d %d/%d %d/%d\n",
                                     a, a, a + 1, a + 1, b + 1, b + 1, b, b);
        }
    bench_stop(slv_mesh_parse_obj(env, "plane", text, used, &mesh));
    return mesh;
}

static void make_image(const slv_env *env, const char *path, uint32_t side, uint32_t n) {
    slv_image image;
    uint32_t state = 5;
    bench_stop(slv_image_create(env, side, side, n, &image));
    for (size_t i = 0; i < (size_t)side * side * n; i++)
        image.pixels[i] = bench_random_unit(&state);
    const slv_image_params params = {.encoding = SLV_ENCODE_RAW};
    bench_stop(slv_image_save(env, path, &image, &params));
    slv_image_free(&image);
}

/* Values alone, on one thread. */
static double time_once(const slv_env *env, const slv_bake_source *source, uint32_t nfaces,
                        slv_res res) {
    enum { ROWS = 32 };
    uint32_t width = 1u << res.u, height = 1u << res.v;
    float *values = malloc((size_t)width * ROWS * 4 * sizeof *values);
    uint8_t *misses = malloc((size_t)width * ROWS);
    uint64_t texels = 0;
    double before = bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
    for (uint32_t face = 0; face < nfaces; face++)
        for (uint32_t y = 0; y < height; y += ROWS) {
            const slv_rect rect = {0, y, width, height - y < ROWS ? height - y : ROWS};
            bench_stop(slv_bake_evaluate(source, env, face, res, rect, values, misses));
            texels += (uint64_t)rect.width * rect.height;
        }
    double seconds = bench_seconds(CLOCK_PROCESS_CPUTIME_ID) - before;
    free(values);
    free(misses);
    return (double)texels / seconds * 1e-6;
}

/* The best of some, since others use the processor's caches too. */
static double time_values(const slv_env *env, const slv_bake_source *source, uint32_t nfaces,
                          slv_res res) {
    enum { TIMES = 5 };
    double best = 0;
    for (int i = 0; i < TIMES; i++)
        best = fmax(best, time_once(env, source, nfaces, res));
    return best;
}

static double time_file(const slv_env *env, const slv_mesh *mesh, const slv_bake_source *source,
                        slv_res res, const char *path) {
    const slv_bake_job job = {.uniform = true, .res = res};
    slv_bake_report report;
    double before = bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
    bench_stop(slv_bake_save(env, mesh, source, &job, path, &report));
    return (double)report.texels / (bench_seconds(CLOCK_PROCESS_CPUTIME_ID) - before) * 1e-6;
}

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        uint32_t channels;
    } images[] = {{"bake.png", 3}, {"bake4.png", 4}, {"bake.exr", 3}};
    /* a face of 64 x 64 texels is two units of the pattern long */
    static const struct {
        const char *name;
        slv_procedural pattern;
    } patterns[] = {
        {"stripes", {.frequency = 2}},
        {"stripes, bent", {.frequency = 2, .warp = 0.5f}},
        {"cubes", {.pattern = SLV_PATTERN_CHECKER, .frequency = 2}},
        {"noise, 1 octave", {.pattern = SLV_PATTERN_NOISE, .frequency = 2, .octaves = 1}},
        {"noise, 4 octaves", {.pattern = SLV_PATTERN_NOISE, .frequency = 2}},
    };
    bool smoke = argc > 1 && strcmp(argv[1], "--smoke") == 0;
    uint32_t side = smoke ? 128 : 2048;
    char folder[] = "/tmp/selvage_bench_XXXXXX", path[300], out[300], what[100], line[400];
    slv_env env = {.log = bench_log, .threads = 1};
    if (!mkdtemp(folder))
        return 1;
    slv_mesh *mesh = make_mesh(&env, 0), *leaning = make_mesh(&env, 30);
    snprintf(out, sizeof out, "%s/out.ptx", folder);
    for (size_t i = 0; i < sizeof images / sizeof *images; i++) {
        slv_bake_source *source = NULL, *turned = NULL;
        snprintf(path, sizeof path, "%s/%s", folder, images[i].name);
        make_image(&env, path, side, images[i].channels);
        bench_stop(slv_bake_from_uv(&env, mesh, path, NULL, &source));
        bench_stop(slv_bake_from_uv(&env, leaning, path, NULL, &turned));
        for (int8_t shift = -1; shift < 2; shift++) {
            int8_t log2 = (int8_t)((smoke ? 3 : 7) + shift);
            const slv_res res = {log2, log2};
            snprintf(what, sizeof what, "%s, %.3g pixels a texel", images[i].name,
                     exp2((double)-shift));
            bench_report(false, what, "Mtexel/s a core",
                         time_values(&env, source, SIDE * SIDE, res));
            bench_report(false, "  coordinates that lean by 30 degrees", "Mtexel/s a core",
                         time_values(&env, turned, SIDE * SIDE, res));
            if (!shift)
                bench_report(false, "  with packing into a .ptx of noise", "Mtexel/s a core",
                             time_file(&env, mesh, source, res, out));
        }
        slv_bake_source_destroy(source);
        slv_bake_source_destroy(turned);
    }
    slv_surface *surface = NULL;
    slv_bake_source *source = NULL;
    bench_stop(slv_surface_create(&env, mesh, NULL, &surface));
    for (size_t i = 0; i < sizeof patterns / sizeof *patterns; i++) {
        const int8_t log2 = smoke ? 2 : 6;
        bench_stop(slv_bake_from_pattern(&env, surface, &patterns[i].pattern, &source));
        bench_report(false, patterns[i].name, "Mtexel/s a core",
                     time_values(&env, source, SIDE * SIDE, (slv_res){log2, log2}));
        slv_bake_source_destroy(source);
    }
    const slv_bake_rays rays = {.samples = 64};
    bench_stop(slv_bake_from_rays(&env, mesh, surface, &rays, &source));
    bench_report(false, "ambient occlusion of a plane", "Mray/s a core",
                 64 * time_values(&env, source, SIDE * SIDE, (slv_res){smoke ? 0 : 3, 3}));
    slv_bake_source_destroy(source);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    slv_mesh_destroy(leaning);
    snprintf(line, sizeof line, "rm -rf '%s'", folder);
    return system(line) != 0;
}
