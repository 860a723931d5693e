/* bench_htex [--threads N] [--json] [--smoke]
 *
 * What the squares of half-edges cost and lose, on a torus of 512 faces under patterns from smooth
 * to hard-edged, at one resolution, at mixed ones and on oblong faces: time to convert, bytes
 * against those of the texture, the error at the centres of texels and everywhere; the latter also
 * as seen by the lookups of the ray-cast reference at random points. */
#include <selvage/bake.h>
#include <selvage/htex.h>
#include <selvage/reference.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { AROUND = 32, ACROSS = 16, NFACES = AROUND * ACROSS, MAX_POINTS = 1 << 17 };

typedef enum shapes { EQUAL, MIXED, OBLONG } shapes;
static const char *const shape_names[] = {"equal", "mixed", "oblong"};

typedef struct options {
    uint32_t threads, points;
    int log2;
    bool json;
} options;

typedef struct scene {
    slv_mesh *mesh;
    slv_adjacency *adjacency;
    slv_surface *surface;
} scene;

static void log_line(void *user, slv_log_level level, const char *message) {
    (void)user;
    if (level == SLV_LOG_ERROR)
        fprintf(stderr, "bench_htex: %s\n", message);
}

static void stop(slv_result result) {
    if (result) {
        fprintf(stderr, "bench_htex: %s\n", slv_result_string(result));
        exit(1);
    }
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static scene make_torus(const slv_env *env) {
    static float positions[NFACES * 3];
    static int32_t sizes[NFACES], verts[NFACES * 4];
    scene s = {0};
    for (int i = 0; i < NFACES; i++) {
        int a = i % AROUND, b = i / AROUND, a1 = (a + 1) % AROUND, b1 = (b + 1) % ACROSS;
        float p = 6.2831853f * (float)a / AROUND, q = 6.2831853f * (float)b / ACROSS;
        positions[3 * i] = (2 + cosf(q)) * cosf(p);
        positions[3 * i + 1] = sinf(q);
        positions[3 * i + 2] = -(2 + cosf(q)) * sinf(p);
        sizes[i] = 4;
        verts[4 * i] = i;
        verts[4 * i + 1] = b * AROUND + a1;
        verts[4 * i + 2] = b1 * AROUND + a1;
        verts[4 * i + 3] = b1 * AROUND + a;
    }
    slv_mesh_view view = {.nverts = NFACES,
                          .positions = positions,
                          .npolys = NFACES,
                          .poly_sizes = sizes,
                          .poly_verts = verts};
    stop(slv_mesh_create(env, &view, &s.mesh));
    stop(slv_mesh_adjacency(env, s.mesh, &s.adjacency));
    stop(slv_surface_create(env, s.mesh, NULL, &s.surface));
    return s;
}

/* The RMS of the difference from the reference's function over random points, as many on every
 * texel. */
static double against_reference(const slv_env *env, const options *o, const scene *s,
                                const slv_texture *texture, const slv_htex *htex) {
    static slv_surface_point points[MAX_POINTS];
    static float rgb[3 * MAX_POINTS];
    const slv_reference_params params = {.segments = 2};
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    slv_reference *reference = NULL;
    uint32_t state = 1;
    double sum = 0, weights = 0;
    stop(
        slv_reference_create(env, s->mesh, s->surface, texture, s->adjacency, &params, &reference));
    for (uint32_t i = 0; i < o->points; i++) {
        uint32_t r[2];
        for (int k = 0; k < 2; k++)
            r[k] = state = state * 1664525 + 1013904223;
        points[i] = (slv_surface_point){(int32_t)(i % NFACES), (float)(r[0] >> 8) / 16777216,
                                        (float)(r[1] >> 8) / 16777216};
    }
    stop(slv_reference_lookup(reference, o->points, points, rgb));
    for (uint32_t i = 0; i < o->points; i++) {
        slv_res res = desc->res[points[i].face];
        double weight = ldexp(1, res.u + res.v);
        float value[3];
        slv_htex_lookup(htex, (uint32_t)points[i].face, points[i].u, points[i].v, 0, value);
        for (int c = 0; c < 3; c++) {
            double lost = (double)value[c] - (double)rgb[3 * i + (uint32_t)c];
            sum += weight * lost * lost;
            weights += weight;
        }
    }
    slv_reference_destroy(reference);
    return sqrt(sum / weights);
}

static void measure(const slv_env *env, const options *o, const scene *s, const char *name,
                    const slv_procedural *pattern, slv_type type, shapes shape) {
    static slv_res res[NFACES];
    uint32_t state = 7;
    slv_texture *texture = NULL;
    slv_levels *levels = NULL;
    slv_htex *htex = NULL;
    slv_htex_error error;
    for (int i = 0; i < NFACES; i++) {
        state = state * 1664525 + 1013904223;
        int8_t log2 = (int8_t)(o->log2 - (shape == MIXED ? (int)(state >> 24) % 3 : 0));
        int8_t flat = shape == OBLONG ? 1 : 0;
        res[i] = (slv_res){(int8_t)(log2 + flat), (int8_t)(log2 - flat)};
    }
    slv_texture_desc desc = {NFACES, type, 3, SLV_NO_ALPHA, res};
    stop(slv_texture_create(env, &desc, &texture));
    stop(slv_bake_procedural(env, s->surface, pattern, NULL, texture));
    stop(slv_levels_create(env, texture, &levels));
    double start = now();
    stop(slv_htex_create(env, levels, s->adjacency, &htex));
    double seconds = now() - start;
    stop(slv_htex_measure(env, htex, levels, s->adjacency, &error));
    double reference = against_reference(env, o, s, texture, htex);
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
            fprintf(stderr, "usage: bench_htex [--threads N] [--json] [--smoke]\n");
            return 2;
        }
    }
    slv_env env = {.log = log_line, .threads = o.threads};
    static const struct {
        const char *name;
        slv_procedural pattern;
    } rows[] = {{"position", {.pattern = SLV_PATTERN_POSITION, .frequency = 0.1f}},
                {"smooth noise", {.pattern = SLV_PATTERN_NOISE, .frequency = 4, .octaves = 3}},
                {"fine noise", {.pattern = SLV_PATTERN_NOISE, .frequency = 64, .octaves = 2}},
                {"checker", {.pattern = SLV_PATTERN_CHECKER, .frequency = 8}},
                {"face colours", {.pattern = SLV_PATTERN_FACE_COLOR}}};
    scene s = make_torus(&env);
    if (!o.json)
        puts("                             Mtexels/s  bytes    at texels'         everywhere   "
             "    reference\n"
             "                                       to texels centres: rms, max   rms, max");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        measure(&env, &o, &s, rows[i].name, &rows[i].pattern, SLV_TYPE_FLOAT, EQUAL);
        measure(&env, &o, &s, rows[i].name, &rows[i].pattern, SLV_TYPE_U8, EQUAL);
        measure(&env, &o, &s, rows[i].name, &rows[i].pattern, SLV_TYPE_FLOAT, MIXED);
        measure(&env, &o, &s, rows[i].name, &rows[i].pattern, SLV_TYPE_FLOAT, OBLONG);
    }
    slv_surface_destroy(s.surface);
    slv_adjacency_destroy(s.adjacency);
    slv_mesh_destroy(s.mesh);
    return 0;
}
