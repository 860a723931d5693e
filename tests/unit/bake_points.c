/* Clouds of coloured points on a surface: what is linear comes out so, dense clouds as the mean
 * over a texel, and what has no points near is missed. */
#include "kit/uv_kit.h"

static const char square[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

/* `side` x `side` points over -margin..1 + margin, of which `left_out` says which there are not. */
static void write_cloud(const char *name, int side, double margin, double shift, double limit,
                        double (*value)(double x, double y)) {
    FILE *stream = fopen(tool_path(name), "w");
    int count = 0;
    REQUIRE(stream);
    for (int pass = 0; pass < 2; pass++) {
        if (pass)
            fprintf(stream,
                    "ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\nproperty double "
                    "y\nproperty double z\nproperty float red\nproperty float green\nproperty "
                    "float blue\nend_header\n",
                    count);
        for (int i = 0; i < side * side; i++) {
            double x = -margin + (1 + 2 * margin) * (i % side + 0.5) / side,
                   y = -margin + (1 + 2 * margin) * (i / side + 0.5) / side;
            if (x > limit)
                continue;
            count += !pass;
            if (pass)
                fprintf(stream, "%.17g %.17g %g %.9g %.9g 0.25\n", x + shift, y + shift, 0.001,
                        value(x, y), 1 - value(x, y));
        }
    }
    fclose(stream);
}

static double ramp(double x, double y) {
    return 0.2 + 0.4 * x + 0.1 * y;
}
/* Finer than texels, with a mean of its own in each quarter. */
static double dots(double x, double y) {
    (void)x, (void)y;
    static uint64_t state = 5;
    return (x > 0.5) * 0.5 + (y > 0.5) * 0.25 + 0.2 * ((double)(test_random(&state) % 1000) / 1000);
}

static void evaluate(const slv_mesh *mesh, const char *cloud, const slv_bake_points *params,
                     slv_res res, float *values, uint8_t *misses) {
    slv_env env = test_env();
    slv_mesh *points = NULL;
    slv_surface *surface = NULL;
    slv_bake_source *source = NULL;
    MUST(slv_surface_create(&env, mesh, &(slv_surface_params){.scheme = SLV_SCHEME_BILINEAR},
                            &surface));
    MUST(slv_mesh_load_points(&env, tool_path(cloud), &points));
    CHECK(slv_mesh_face_count(points) == 0);
    MUST(slv_bake_from_points(&env, mesh, surface, points, params, &source));
    CHECK(slv_bake_source_get_desc(source)->nchannels == 3);
    MUST(slv_bake_evaluate(source, &env, 0, res, (slv_rect){0, 0, 1u << res.u, 1u << res.v}, values,
                           misses));
    slv_bake_source_destroy(source);
    slv_surface_destroy(surface);
    slv_mesh_destroy(points);
}

static void linear(void) {
    slv_mesh *mesh = uv_parse(square);
    float values[16 * 8 * 3];
    uint8_t misses[16 * 8];
    write_cloud("ramp.ply", 100, 0.1, 0, 9, ramp);
    for (uint32_t count = 0; count < 30; count += 13) {
        evaluate(mesh, "ramp.ply", &(slv_bake_points){.count = count}, (slv_res){4, 3}, values,
                 misses);
        for (int i = 0; i < 16 * 8; i++) {
            double want = ramp((i % 16 + 0.5) / 16, (i / 16 + 0.5) / 8);
            CHECK_MSG(!misses[i] && fabs((double)values[3 * i] - want) < 2e-3 &&
                          fabs((double)values[3 * i + 1] - 1 + want) < 2e-3 &&
                          fabsf(values[3 * i + 2] - 0.25f) < 1e-6f,
                      "texel %d: %g, not %g", i, (double)values[3 * i], want);
        }
    }
    slv_mesh_destroy(mesh);
}

/* 120 x 120 points a face of 2 x 2 texels: of thousands in a texel none may weigh too much. */
static void dense(void) {
    slv_mesh *mesh = uv_parse(square);
    float values[4 * 3];
    uint8_t misses[4];
    write_cloud("dots.ply", 120, 0, 0, 9, dots);
    evaluate(mesh, "dots.ply", NULL, (slv_res){1, 1}, values, misses);
    for (int i = 0; i < 4; i++) {
        double want = 0.1 + (i % 2) * 0.5 + (i / 2) * 0.25;
        CHECK_MSG(!misses[i] && fabs((double)values[3 * i] - want) < 0.06, "texel %d: %g, not %g",
                  i, (double)values[3 * i], want);
    }
    slv_mesh_destroy(mesh);
}

/* Points over the left half: what is further than the distance from them is missed. */
static void misses(void) {
    slv_env env = test_env();
    slv_mesh *mesh = uv_parse(square);
    float values[32 * 3];
    uint8_t missed[32];
    write_cloud("half.ply", 64, 0, 0, 0.5, ramp);
    evaluate(mesh, "half.ply", &(slv_bake_points){.distance = 0.1f}, (slv_res){5, 0}, values,
             missed);
    for (int i = 0; i < 32; i++)
        CHECK_MSG(missed[i] == (i < 19 ? SLV_BAKE_HIT : SLV_BAKE_TOO_FAR), "texel %d: %d", i,
                  missed[i]);
    slv_mesh_destroy(mesh);
    /* far from zero, where floats tell nothing apart, and elsewhere */
    mesh = uv_parse("v 5000000 5000000 0\nv 5000001 5000000 0\nv 5000001 5000001 0\n"
                    "v 5000000 5000001 0\nf 1 2 3 4\n");
    write_cloud("away.ply", 64, 0.1, 5e6, 9, ramp);
    evaluate(mesh, "away.ply", &(slv_bake_points){.distance = 0.1f}, (slv_res){3, 0}, values,
             missed);
    for (int i = 0; i < 8; i++)
        CHECK(!missed[i] && fabs((double)values[3 * i] - ramp((i + 0.5) / 8, 0.5)) < 4e-3);
    slv_mesh *points = NULL;
    slv_surface *surface = NULL;
    slv_bake_source *source = NULL;
    MUST(slv_surface_create(&env, mesh, NULL, &surface));
    MUST(slv_mesh_load_points(&env, tool_path("half.ply"), &points));
    CHECK(slv_bake_from_points(&env, mesh, surface, points, NULL, &source) == SLV_ERROR_MISMATCH);
    CHECK_MSG(strstr(test_last_log, "elsewhere"), "%s", test_last_log);
    slv_mesh_destroy(points);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
}

static void verb(void) {
    static const char bare[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    tool_write_file("m.obj", square, sizeof square - 1);
    RUNS(0, "bake m.obj --points ramp.ply --size 16 --threads 1 -o a.ptx");
    RUNS(0, "bake m.obj --points ramp.ply --size 16 --threads 3 -o b.ptx");
    CHECK(uv_same_files("a.ptx", "b.ptx"));
    RUNS(1, "bake m.obj --points half.ply --size 16 -o c.ptx --miss-map map.ptx");
    HAS("too-far");
    tool_write_file("bare.obj", bare, sizeof bare - 1);
    RUNS(1, "bake m.obj --points bare.obj -o none.ptx");
    HAS("no colours");
    RUNS(1, "info bare.obj");
    RUNS(1, "bake bare.obj --pattern noise -o none.ptx");
    HAS("holds no polygons");
    CHECK(access(tool_path("none.ptx"), F_OK) != 0);
}

int main(void) {
    tool_begin();
    linear();
    dense();
    misses();
    verb();
    tool_end();
    return test_end();
}
