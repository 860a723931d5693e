/* Rays against what geometry says of them: ambient occlusion, thickness, bent normals, and a
 * detailed mesh on a plain one. */
#include "kit/uv_kit.h"

#include <stdarg.h>

static char text[1 << 20];
static size_t used;
static int vertices;

static void begin(void) {
    used = 0;
    vertices = 0;
}
static void add(const char *format, ...) __attribute__((format(printf, 1, 2)));
static void add(const char *format, ...) {
    va_list args;
    va_start(args, format);
    used += (size_t)vsnprintf(text + used, sizeof text - used, format, args);
    va_end(args);
    REQUIRE(used < sizeof text);
}

/* A grid of quads over (s,t) of 0..1, whose normal is that of growing s x growing t. */
typedef void place_fn(double s, double t, double out[3]);
static void grid(int side, place_fn *place, bool flipped) {
    int first = vertices + 1;
    for (int j = 0; j <= side; j++)
        for (int i = 0; i <= side; i++) {
            double p[3];
            place((double)i / side, (double)j / side, p);
            add("v %.9g %.9g %.9g\n", p[0], p[1], p[2]);
            vertices++;
        }
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++) {
            int a = first + j * (side + 1) + i, b = a + 1, c = b + side + 1, d = a + side + 1;
            if (flipped)
                add("f %d %d %d %d\n", a, d, c, b);
            else
                add("f %d %d %d %d\n", a, b, c, d);
        }
}

static void on_floor(double s, double t, double out[3]) {
    out[0] = s;
    out[1] = t;
    out[2] = 0;
}
static void on_ceiling(double s, double t, double out[3]) {
    out[0] = s;
    out[1] = t;
    out[2] = 0.5;
}
static void on_wall_x(double s, double t, double out[3]) {
    out[0] = 0;
    out[1] = s;
    out[2] = t;
}
static void on_wall_y(double s, double t, double out[3]) {
    out[0] = t;
    out[1] = 0;
    out[2] = s;
}

/* One sixth of a ball around `ball`. */
static int sixth;
static double ball[4]; /* middle and radius */
static void on_ball(double s, double t, double out[3]) {
    double a = tan((s - 0.5) * 1.5707963267948966), b = tan((t - 0.5) * 1.5707963267948966);
    int axis = sixth / 2;
    double p[3], sign = sixth % 2 ? -1 : 1;
    p[axis] = sign;
    p[(axis + 1) % 3] = sign * a;
    p[(axis + 2) % 3] = b;
    double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    for (int k = 0; k < 3; k++)
        out[k] = ball[k] + ball[3] * p[k] / length;
}
static void add_ball(int side, double x, double y, double z, double radius, bool inwards) {
    ball[0] = x;
    ball[1] = y;
    ball[2] = z;
    ball[3] = radius;
    for (sixth = 0; sixth < 6; sixth++)
        grid(side, on_ball, inwards);
}

typedef struct setup {
    slv_mesh *mesh;
    slv_surface *surface;
} setup;

static setup finish(void) {
    static const slv_surface_params flat = {.scheme = SLV_SCHEME_BILINEAR};
    slv_env env = test_env();
    setup s = {0};
    MUST(slv_mesh_parse_obj(&env, "model", text, used, &s.mesh));
    MUST(slv_surface_create(&env, s.mesh, &flat, &s.surface));
    return s;
}

static void end(setup *s) {
    slv_surface_destroy(s->surface);
    slv_mesh_destroy(s->mesh);
}

/* The texel around (u,v) of a face whose textures are fine enough to be a point. */
static void at_point(const setup *s, slv_bake_rays params, uint32_t face, double u, double v,
                     float out[3]) {
    enum { LOG2 = 10 };
    slv_env env = test_env();
    slv_bake_source *source = NULL;
    uint8_t missed;
    const slv_rect rect = {(uint32_t)(u * (1 << LOG2)), (uint32_t)(v * (1 << LOG2)), 1, 1};
    params.samples = 1024;
    params.segments = 2;
    MUST(slv_bake_from_rays(&env, s->mesh, s->surface, &params, &source));
    MUST(slv_bake_evaluate(source, &env, face, (slv_res){LOG2, LOG2}, rect, out, &missed));
    CHECK(missed == SLV_BAKE_HIT);
    slv_bake_source_destroy(source);
}

static void expect_open(const char *what, const setup *s, uint32_t face, double u, double v,
                        double want) {
    float got[3];
    at_point(s, (slv_bake_rays){.kind = SLV_BAKE_AO}, face, u, v, got);
    CHECK_MSG(fabs((double)got[0] - want) <= 0.01 * want, "%s: %g, expected %g", what,
              (double)got[0], want);
}

/* Form factors of a small patch: of a rectangle across, seen from under one of its corners, and of
 * one that stands up, seen from beside its lower edge (Hamilton and Morgan 1952). */
static double across(double a, double b, double h) {
    double x = a / h, y = b / h, p = sqrt(1 + x * x), q = sqrt(1 + y * y);
    return (x / p * atan(y / p) + y / q * atan(x / q)) / 6.283185307179586;
}
static double standing(double b, double height, double c) {
    double far = sqrt(height * height + c * c);
    return (atan(b / c) - c / far * atan(b / far)) / 6.283185307179586;
}

static void occlusion(void) {
    double radius = 0.25, height = 0.5;
    begin();
    grid(1, on_floor, false);
    grid(1, on_ceiling, true);
    setup s = finish();
    expect_open("under a ceiling", &s, 0, 0.5, 0.5, 1 - 4 * across(0.5, 0.5, 0.5));
    expect_open("under a ceiling's side", &s, 0, 0.25, 0.5,
                1 - 2 * across(0.25, 0.5, 0.5) - 2 * across(0.75, 0.5, 0.5));
    end(&s);
    begin();
    grid(1, on_floor, false);
    grid(1, on_wall_x, false);
    grid(1, on_wall_y, false);
    s = finish();
    expect_open("in a corner", &s, 0, 0.3, 0.3,
                1 - 2 * (standing(0.3, 1, 0.3) + standing(0.7, 1, 0.3)));
    float bent[3];
    at_point(&s, (slv_bake_rays){.kind = SLV_BAKE_BENT_NORMAL}, 0, 0.1, 0.1, bent);
    CHECK_MSG(bent[0] > 0.2f && fabsf(bent[0] - bent[1]) < 0.03f && bent[2] > 0.5f, "%g %g %g",
              (double)bent[0], (double)bent[1], (double)bent[2]);
    /* what is far away may be left out */
    float open[3];
    at_point(&s, (slv_bake_rays){.distance = 0.2f}, 0, 0.5, 0.5, open);
    CHECK(open[0] == 1);
    end(&s);
    begin();
    grid(1, on_floor, false);
    add_ball(12, 0.5, 0.5, height, radius, false);
    s = finish();
    expect_open("under a ball", &s, 0, 0.5, 0.5, 1 - radius * radius / height / height);
    end(&s);
}

/* A ball is open outside, and closed inside for every ray, to its corners. */
static void balls(void) {
    slv_env env = test_env();
    for (int inwards = 0; inwards < 2; inwards++) {
        slv_bake_source *source = NULL;
        const slv_bake_rays rays = {.samples = 256, .segments = 2};
        float values[4];
        uint8_t missed[4];
        begin();
        add_ball(12, 3, -2, 5, 1, inwards);
        setup s = finish();
        MUST(slv_bake_from_rays(&env, s.mesh, s.surface, &rays, &source));
        for (uint32_t face = 0; face < slv_mesh_face_count(s.mesh); face += 23) {
            MUST(slv_bake_evaluate(source, &env, face, (slv_res){1, 1}, (slv_rect){0, 0, 2, 2},
                                   values, missed));
            for (int i = 0; i < 4; i++)
                CHECK_MSG(inwards ? values[i] == 0 : values[i] > 0.99f, "face %u: %g", face,
                          (double)values[i]);
        }
        slv_bake_source_destroy(source);
        if (!inwards) {
            float thick[3];
            begin();
            add_ball(24, 3, -2, 5, 1, false);
            end(&s);
            s = finish();
            at_point(&s, (slv_bake_rays){.kind = SLV_BAKE_THICKNESS}, 300, 0.5, 0.5, thick);
            CHECK_MSG(fabsf(thick[0] - 4.0f / 3) < 0.0133f, "%g", (double)thick[0]);
        }
        end(&s);
    }
    /* a box, at texels of all sizes: no ray leaves it */
    slv_bake_source *source = NULL;
    const slv_bake_rays rays = {.samples = 64, .segments = 2};
    float values[64];
    uint8_t missed[64];
    static const char room[] =
        "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
        "f 1 2 3 4\nf 8 7 6 5\nf 5 6 2 1\nf 7 8 4 3\nf 4 8 5 1\nf 6 7 3 2\n";
    begin();
    add("%s", room);
    setup s = finish();
    MUST(slv_bake_from_rays(&env, s.mesh, s.surface, &rays, &source));
    for (uint32_t face = 0; face < 6; face++)
        for (uint32_t k = 0; k < 2; k++) {
            const slv_rect rect = {k * 1016, k * 1016, 8, 8};
            MUST(slv_bake_evaluate(source, &env, face, (slv_res){10, 10}, rect, values, missed));
            for (int i = 0; i < 64; i++)
                CHECK_MSG(values[i] == 0, "face %u texel %d: %g", face, i, (double)values[i]);
        }
    slv_bake_source_destroy(source);
    end(&s);
}

/* ---- detail ---- */

static double bump_height;
static double bump_at(double x, double y) {
    double r = ((x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5)) / 0.09;
    return r < 1 ? bump_height * (1 - r) * (1 - r) : 0;
}
static void on_bump(double s, double t, double out[3]) {
    out[0] = s;
    out[1] = t;
    out[2] = bump_at(s, t);
}

static void bump(double height) {
    enum { SIDE = 32 };
    slv_env env = test_env();
    static float values[SIDE * SIDE];
    static uint8_t missed[SIDE * SIDE];
    slv_bake_source *source = NULL;
    double worst = 0;
    bump_height = height;
    begin();
    grid(1, on_floor, false);
    setup plain = finish();
    begin();
    grid(96, on_bump, false);
    setup detailed = finish();
    const slv_bake_detail params = {.front = 0.3f, .back = 0.3f};
    MUST(slv_bake_from_detail(&env, plain.mesh, plain.surface, detailed.mesh, &params, &source));
    MUST(slv_bake_evaluate(source, &env, 0, (slv_res){5, 5}, (slv_rect){0, 0, SIDE, SIDE}, values,
                           missed));
    for (int i = 0; i < SIDE * SIDE; i++) {
        double want = 0;
        for (int k = 0; k < 64; k++)
            want += bump_at((i % SIDE + (k % 8 + 0.5) / 8) / SIDE,
                            (i / SIDE + (k / 8 + 0.5) / 8) / SIDE) /
                    64;
        worst = fmax(worst, fabs((double)values[i] - want));
        CHECK(missed[i] == SLV_BAKE_HIT);
    }
    CHECK_MSG(worst < 0.01 * fabs(height), "%g of %g", worst, height);
    slv_bake_source_destroy(source);
    end(&plain);
    end(&detailed);
}

static const char box[] =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 1 5 8 4\nf 2 3 7 6\n";

/* Vectors to a leaning plane are across it, whichever way the face's u goes. */
static void vectors(void) {
    slv_env env = test_env();
    slv_mesh *plain, *plane;
    slv_surface *surface = NULL;
    float got[16 * 3];
    uint8_t missed[16];
    static const char turned[] = "v 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\nf 1 2 3 4\n",
                      leaning[] = "v -1 -1 -.1\nv 2 -1 .5\nv 2 2 .5\nv -1 2 -.1\nf 1 2 3 4\n";
    MUST(slv_mesh_parse_obj(&env, "m", turned, sizeof turned - 1, &plain));
    MUST(slv_mesh_parse_obj(&env, "m", leaning, sizeof leaning - 1, &plane));
    MUST(slv_surface_create(&env, plain, &(slv_surface_params){.scheme = SLV_SCHEME_BILINEAR},
                            &surface));
    for (int face = 0; face < 2; face++) {
        const slv_bake_detail params = {
            .front = 0.4f, .kind = face ? SLV_BAKE_FACE_VECTOR : SLV_BAKE_OBJECT_VECTOR};
        slv_bake_source *source = NULL;
        MUST(slv_bake_from_detail(&env, plain, surface, plane, &params, &source));
        CHECK(slv_bake_source_get_desc(source)->type == SLV_TYPE_FLOAT);
        MUST(slv_bake_evaluate(source, &env, 0, (slv_res){2, 2}, (slv_rect){0, 0, 4, 4}, got,
                               missed));
        for (int i = 0; i < 16; i++) {
            /* z = 0.1 + 0.2 x, where v goes against x */
            float x = 1 - ((float)(i / 4) + 0.5f) / 4, away = (0.1f + 0.2f * x) / 1.04f;
            const float object[3] = {-0.2f * away, 0, away}, own[3] = {0, 0.2f * away, away};
            for (int k = 0; k < 3; k++)
                CHECK_MSG(!missed[i] && fabsf(got[3 * i + k] - (face ? own : object)[k]) < 1e-5f,
                          "%d: texel %d: %g, not %g", face, i, (double)got[3 * i + k],
                          (double)(face ? own : object)[k]);
        }
        slv_bake_source_destroy(source);
    }
    slv_surface_destroy(surface);
    slv_mesh_destroy(plain);
    slv_mesh_destroy(plane);
}

/* A model onto itself: nothing is displaced, and normals are its own where they are not those of
 * rounded corners. */
static void itself(void) {
    slv_env env = test_env();
    float values[64 * 3], own[64 * 3];
    uint8_t missed[64];
    begin();
    add("%s", box);
    setup s = finish();
    for (int kind = 0; kind < 3; kind++) {
        slv_bake_source *source = NULL, *normals = NULL;
        const slv_bake_detail params = {.kind = (slv_bake_detail_kind)kind};
        MUST(slv_bake_from_detail(&env, s.mesh, s.surface, s.mesh, &params, &source));
        MUST(slv_bake_from_surface(&env, s.surface, SLV_BAKE_NORMAL, &normals));
        for (uint32_t face = 0; face < 6; face++) {
            const slv_rect rect = {0, 0, 8, 8};
            MUST(slv_bake_evaluate(normals, &env, face, (slv_res){3, 3}, rect, own, missed));
            MUST(slv_bake_evaluate(source, &env, face, (slv_res){3, 3}, rect, values, missed));
            for (int i = 0; i < 64; i++) {
                float along = values[3 * i] * own[3 * i] + values[3 * i + 1] * own[3 * i + 1] +
                              values[3 * i + 2] * own[3 * i + 2];
                CHECK(missed[i] == SLV_BAKE_HIT);
                if (kind == SLV_BAKE_DISPLACEMENT)
                    CHECK_MSG(fabsf(values[i]) < 1e-5f, "%g", (double)values[i]);
                else
                    CHECK_MSG((kind == SLV_BAKE_OBJECT_NORMAL ? along : values[3 * i + 2]) > 0.5f,
                              "%g", (double)along);
            }
        }
        slv_bake_source_destroy(source);
        slv_bake_source_destroy(normals);
    }
    end(&s);
}

static void on_half(double s, double t, double out[3]) {
    out[0] = 0.5 * s;
    out[1] = t;
    out[2] = 0.1;
}
static void on_quarter(double s, double t, double out[3]) {
    out[0] = 0.5 + 0.25 * s;
    out[1] = t;
    out[2] = 0.1;
}
static void on_far(double s, double t, double out[3]) {
    out[0] = 0.75 + 0.125 * s;
    out[1] = t;
    out[2] = 0.6;
}

static void misses(void) {
    slv_env env = test_env();
    float values[8];
    uint8_t missed[8];
    slv_bake_source *source = NULL;
    begin();
    grid(1, on_floor, false);
    setup plain = finish();
    begin();
    grid(1, on_half, false);
    grid(1, on_quarter, true);
    grid(1, on_far, false);
    setup other = finish();
    const slv_bake_detail params = {.front = 0.3f, .back = 0.3f};
    MUST(slv_bake_from_detail(&env, plain.mesh, plain.surface, other.mesh, &params, &source));
    MUST(slv_bake_evaluate(source, &env, 0, (slv_res){3, 3}, (slv_rect){0, 4, 8, 1}, values,
                           missed));
    static const uint8_t want[8] = {
        0, 0, 0, 0, SLV_BAKE_BACK_FACING, SLV_BAKE_BACK_FACING, SLV_BAKE_TOO_FAR, SLV_BAKE_NO_HIT};
    for (int i = 0; i < 8; i++)
        CHECK_MSG(missed[i] == want[i] && fabsf(values[i] - (i < 4 ? 0.1f : 0)) < 1e-6f,
                  "%d: %s, %g", i, slv_bake_miss_name((slv_bake_miss)missed[i]), (double)values[i]);
    slv_bake_source_destroy(source);
    end(&other);
    begin();
    add_ball(2, 100, 0, 0, 1, false);
    other = finish();
    CHECK(slv_bake_from_detail(&env, plain.mesh, plain.surface, other.mesh, &params, &source) ==
              SLV_ERROR_MISMATCH &&
          !source && strstr(test_last_log, "lies elsewhere"));
    end(&other);
    end(&plain);
}

static void surface_values(void) {
    slv_env env = test_env();
    float values[4 * 3];
    uint8_t missed[4];
    begin();
    grid(2, on_floor, false);
    setup s = finish();
    for (int kind = 0; kind < 4; kind++) {
        slv_bake_source *source = NULL;
        MUST(slv_bake_from_surface(&env, s.surface, (slv_bake_surface_kind)kind, &source));
        MUST(slv_bake_evaluate(source, &env, 3, (slv_res){1, 1}, (slv_rect){0, 0, 2, 2}, values,
                               missed));
        if (kind == SLV_BAKE_POSITION)
            CHECK(fabsf(values[0] - 0.625f) < 1e-6f && fabsf(values[10] - 0.875f) < 1e-6f);
        else if (kind == SLV_BAKE_NORMAL)
            CHECK(values[0] == 0 && values[2] == 1);
        else if (kind == SLV_BAKE_FACE_ID)
            CHECK(values[0] == 3 && values[3] == 3);
        else
            CHECK(fabsf(values[0] - 4) < 1e-4f);
        slv_bake_source_destroy(source);
    }
    end(&s);
}

static uint64_t steps, stop_after;
static bool step(void *user, uint64_t done, uint64_t total) {
    uint64_t *last = user;
    CHECK(done >= *last && done <= total);
    *last = done;
    return ++steps < stop_after;
}

/* Many rays are asked often whether to go on, within a row of texels too, and end with nothing
 * written; the parts make the same file as a whole. */
static void interrupts(void) {
    slv_env env = test_env();
    slv_bake_source *source = NULL, *few = NULL;
    uint64_t last = 0;
    begin();
    grid(1, on_floor, false);
    setup s = finish();
    const slv_bake_rays rays = {.samples = 1 << 14, .segments = 2}, cheap = {.segments = 2};
    slv_bake_job job = {.uniform = true, .res = {6, 2}, .progress = {step, &last}};
    MUST(slv_bake_from_rays(&env, s.mesh, s.surface, &rays, &source));
    MUST(slv_bake_from_rays(&env, s.mesh, s.surface, &cheap, &few));
    for (stop_after = 1; stop_after <= 2; stop_after++) {
        slv_bake_rays stopped = {.progress = {step, &last}};
        slv_bake_source *none = NULL;
        steps = 0;
        CHECK(slv_bake_from_rays(&env, s.mesh, s.surface, &stopped, &none) == SLV_ERROR_CANCELLED &&
              !none);
    }
    last = steps = 0;
    stop_after = 5;
    CHECK(slv_bake_save(&env, s.mesh, source, &job, tool_path("stopped.ptx"), NULL) ==
          SLV_ERROR_CANCELLED);
    CHECK(access(tool_path("stopped.ptx"), F_OK) != 0);
    stop_after = UINT64_MAX;
    last = steps = 0;
    MUST(slv_bake_save(&env, s.mesh, source, &job, tool_path("many.ptx"), NULL));
    CHECK_MSG(steps >= 16, "%llu", (unsigned long long)steps);
    last = 0;
    MUST(slv_bake_save(&env, s.mesh, few, &job, tool_path("few.ptx"), NULL));
    CHECK(uv_same_files("many.ptx", "few.ptx")); /* all is open */
    slv_bake_source_destroy(source);
    slv_bake_source_destroy(few);
    end(&s);
}

/* A detailed mesh says its normals itself, flat ones of a cube here; without, they are smooth. */
static void own_normals(void) {
    static const char corners[] = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\n"
                                  "v -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n",
                      flat[] = "vn 0 0 -1\nvn 0 0 1\nvn 0 -1 0\nvn 1 0 0\nvn 0 1 0\nvn -1 0 0\n";
    static const int faces[6][4] = {{4, 3, 2, 1}, {5, 6, 7, 8}, {1, 2, 6, 5},
                                    {2, 3, 7, 6}, {3, 4, 8, 7}, {4, 1, 5, 8}};
    static const float want[6][3] = {{0, 0, -1}, {0, 0, 1}, {0, -1, 0},
                                     {1, 0, 0},  {0, 1, 0}, {-1, 0, 0}};
    for (int given = 0; given < 2; given++) {
        char cube[1024];
        size_t size = (size_t)snprintf(cube, sizeof cube, "%s%s", corners, flat);
        for (int f = 0; f < 6; f++) {
            size += (size_t)snprintf(cube + size, sizeof cube - size, "f");
            for (int c = 0; c < 4; c++)
                size += (size_t)snprintf(cube + size, sizeof cube - size, given ? " %d//%d" : " %d",
                                         faces[f][c], f + 1);
            size += (size_t)snprintf(cube + size, sizeof cube - size, "\n");
        }
        tool_write_file("cube.obj", cube, size);
        RUNS(0, "bake cube.obj --detail cube.obj --detail-kind object-normal --scheme bilinear "
                "--size 4 --type float --reductions plain -o cube.ptx -q");
        slv_ptx *ptx = tool_open("cube.ptx");
        for (uint32_t face = 0; face < 6; face++) {
            float texels[4 * 4 * 3], most = 0;
            MUST(slv_ptx_read_face(ptx, face, (slv_res){2, 2}, texels));
            for (int i = 0; i < 4 * 4 * 3; i++)
                most = fmaxf(most, fabsf(texels[i] - want[face][i % 3]));
            CHECK_MSG(given ? most < 1e-5f : most > 0.3f, "%d: face %u is %g off", given, face,
                      (double)most);
        }
        slv_ptx_close(ptx);
    }
}

static void files(void) {
    begin();
    add_ball(3, 0, 0, 0, 1, false);
    grid(2, on_floor, false);
    tool_write_file("model.obj", text, used);
    RUNS(0, "bake model.obj --rays ao --samples 16 --size 8 -o one.ptx --threads 1");
    HAS("uint8");
    RUNS(0, "bake model.obj --rays ao --samples 16 --size 8 -o four.ptx --threads 4 --quiet");
    CHECK(uv_same_files("one.ptx", "four.ptx"));
    /* on another mesh: each of its texels is made once, not for each that looks at it */
    RUNS(0, "bake model.obj --from model.obj --by rays --rays ao --samples 1 --size 2 -o one.ptx "
            "--threads 1 --max-miss 1");
    RUNS(0, "bake model.obj --from model.obj --by rays --rays ao --samples 1 --size 2 -o four.ptx "
            "--threads 4 --max-miss 1");
    CHECK(uv_same_files("one.ptx", "four.ptx"));
    RUNS(0, "bake model.obj --surface position --size 4 -o p.ptx --json");
    HAS("\"type\": \"float\"");
    HAS("\"encoding\": \"data\"");
    RUNS(0, "bake model.obj --detail model.obj --size 4 --scheme bilinear -o d.ptx");
    RUNS(0, "check d.ptx");
    RUNS(1, "bake model.obj --detail missing.obj --size 4 -o none.ptx");
    RUNS(2, "bake model.obj --detail model.obj --rays ao -o none.ptx");
    RUNS(2, "bake model.obj --rays everything -o none.ptx");
    RUNS(2, "bake model.obj --detail model.obj --front -1 -o none.ptx");
}

int main(void) {
    tool_begin();
    occlusion();
    balls();
    bump(0.1);
    bump(-0.1);
    vectors();
    itself();
    misses();
    surface_values();
    interrupts();
    own_normals();
    files();
    tool_end();
    return test_end();
}
