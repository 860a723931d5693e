/* bench_bake [--json] [--smoke] [--large]
 *
 * How many texels a second and processor come out of each source of a bake, beside the bar of 20
 * million; with --large how much memory 4 GiB of output take, beside that of 512 MiB. What rays
 * cost beside Embree bench_occlusion says.
 */
#include "kit/bench_kit.h"

#include <selvage/bake.h>
#include <selvage/image.h>

#include <string.h>

enum { SIDE = 16 };
#define LEAST 20.0 /* million texels a second and core */

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

typedef struct settings {
    const slv_env *env;
    bool json, smoke;
    const char *folder;
    bench_bars bars;
} settings;

static void bench_images(settings *s, const slv_mesh *mesh, const slv_mesh *leaning) {
    static const struct {
        const char *name;
        uint32_t channels;
    } images[] = {{"bake.png", 3}, {"bake4.png", 4}, {"bake.exr", 3}};
    /* they repeat where they lean over the image's ends */
    const slv_bake_uv repeat = {.wrap = SLV_BAKE_WRAP_REPEAT};
    char path[300], out[300], what[100];
    snprintf(out, sizeof out, "%s/out.ptx", s->folder);
    for (size_t i = 0; i < sizeof images / sizeof *images; i++) {
        slv_bake_source *source = NULL, *turned = NULL;
        snprintf(path, sizeof path, "%s/%s", s->folder, images[i].name);
        make_image(s->env, path, s->smoke ? 128 : 2048, images[i].channels);
        bench_stop(slv_bake_from_uv(s->env, mesh, path, NULL, &source));
        bench_stop(slv_bake_from_uv(s->env, leaning, path, &repeat, &turned));
        for (int8_t shift = -1; shift < 2; shift++) {
            int8_t log2 = (int8_t)((s->smoke ? 3 : 7) + shift);
            const slv_res res = {log2, log2};
            snprintf(what, sizeof what, "%s, %.3g pixels a texel", images[i].name,
                     exp2((double)-shift));
            bench_bar(&s->bars, s->json, what, "Mtexel/s a core",
                      time_values(s->env, source, SIDE * SIDE, res), LEAST, false);
            bench_bar(&s->bars, s->json, "  coordinates that lean by 30 degrees", "Mtexel/s a core",
                      time_values(s->env, turned, SIDE * SIDE, res), LEAST, false);
            if (!shift)
                bench_report(s->json, "  with packing into a .ptx of noise", "Mtexel/s a core",
                             time_file(s->env, mesh, source, res, out));
        }
        slv_bake_source_destroy(source);
        slv_bake_source_destroy(turned);
    }
}

static void bench_patterns(settings *s, const slv_surface *surface) {
    /* a face of 64 x 64 texels is two units of the pattern long */
    static const struct {
        const char *name;
        slv_procedural pattern;
    } patterns[] = {
        {"stripes", {.frequency = 2}},
        {"stripes, bent", {.frequency = 2, .warp = 0.5f}},
        {"stripes, bent, with alpha", {.frequency = 2, .warp = 0.5f, .color0 = {1, 0, 0, 0.5f}}},
        {"cubes", {.pattern = SLV_PATTERN_CHECKER, .frequency = 2}},
        {"noise, 1 octave", {.pattern = SLV_PATTERN_NOISE, .frequency = 2, .octaves = 1}},
        {"noise, 4 octaves", {.pattern = SLV_PATTERN_NOISE, .frequency = 2}},
        {"noise, 4 octaves, with alpha",
         {.pattern = SLV_PATTERN_NOISE, .frequency = 2, .color0 = {1, 0, 0, 0.5f}}},
        {"colours of faces", {.pattern = SLV_PATTERN_FACE_COLOR}},
        {"positions", {.pattern = SLV_PATTERN_POSITION}},
    };
    const int8_t log2 = s->smoke ? 2 : 6;
    for (size_t i = 0; i < sizeof patterns / sizeof *patterns; i++) {
        slv_bake_source *source = NULL;
        bench_stop(slv_bake_from_pattern(s->env, surface, &patterns[i].pattern, &source));
        bench_bar(&s->bars, s->json, patterns[i].name, "Mtexel/s a core",
                  time_values(s->env, source, SIDE * SIDE, (slv_res){log2, log2}), LEAST, false);
        slv_bake_source_destroy(source);
    }
}

/* 4 GiB of four floats a texel, that agree where faces meet. */
static void bench_memory(settings *s, const slv_mesh *mesh, const slv_surface *surface) {
    const slv_procedural pattern = {.frequency = 0.3f, .color0 = {1, 0, 0, 0.5f}};
    const int8_t log2 = s->smoke ? 2 : 10;
    const slv_bake_job job = {
        .uniform = true, .res = {log2, log2}, .type_given = true, .type = SLV_TYPE_FLOAT};
    char out[300];
    slv_bake_source *source = NULL;
    slv_bake_report report;
    snprintf(out, sizeof out, "%s/large.ptx", s->folder);
    bench_stop(slv_bake_from_pattern(s->env, surface, &pattern, &source));
    bench_stop(slv_bake_save(s->env, mesh, source, &job, out, &report));
    bench_report(s->json, "output, unpacked", "MiB",
                 (double)report.texels * 4 * sizeof(float) / (1 << 20));
    bench_bar(&s->bars, s->json, "  memory at most", "MiB",
              (double)bench_status_bytes("VmHWM") / (1 << 20), 512, true);
    slv_bake_source_destroy(source);
}

int main(int argc, char **argv) {
    char folder[] = "/tmp/selvage_bench_XXXXXX", line[400];
    const slv_env env = {.log = bench_log, .threads = 1};
    settings s = {.env = &env, .folder = folder};
    const char *none = "";
    bool large = false;
    for (int i = 1; i < argc; i++)
        if (strcmp(argv[i], "--large") == 0) {
            large = true;
            argv[i--] = argv[--argc];
        }
    if (!bench_arguments(argc, argv, "--large", &none, &s.json, &s.smoke))
        return 2;
    if (!mkdtemp(folder))
        return 1;
    slv_mesh *mesh = make_mesh(&env, 0), *leaning = make_mesh(&env, 30);
    slv_surface *surface = NULL;
    bench_stop(slv_surface_create(&env, mesh, NULL, &surface));
    if (large || s.smoke)
        bench_memory(&s, mesh, surface);
    if (!large || s.smoke) {
        bench_images(&s, mesh, leaning);
        bench_patterns(&s, surface);
    }
    bench_bars_end(&s.bars, s.json);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    slv_mesh_destroy(leaning);
    snprintf(line, sizeof line, "rm -rf '%s'", folder);
    return system(line) != 0;
}
