/* Spheres, cylinders and tori as other programs export them: with columns of vertices at the ends
 * of a turn twice, poles and rims of caps in many copies, computed from 0 and from a whole turn, so
 * that they are not equal to the bit. Welding takes exactly the copies, and moves nothing. */
#include "kit/mesh_shapes.h"
#include "kit/tool_kit.h"

#include <selvage/mesh.h>

#define TURN 6.283185307179586

/* How numbers are written and computed. */
typedef struct style {
    const char *name, *number;
    bool shared;   /* vertices once, and texture coordinates with indices of their own */
    bool single;   /* angles in single precision */
    double offset; /* of the mesh */
    double scale;
} style;

static const style styles[] = {
    {"web engine", "%.17g", false, false, 0, 1}, {"game engine", "%.9g", false, true, 0, 1},
    {"six digits", "%.6f", false, false, 0, 2},  {"far away", "%.9g", false, false, 1000, 3},
    {"tiny", "%.9g", false, false, 0, 1e-6},     {"huge", "%.9g", false, false, 0, 1e6},
    {"modeller", "%.6f", true, false, 0, 2},
};

typedef struct output {
    FILE *file;
    const style *how;
    int count;
} output;

static double cosine(const output *o, double turn) {
    return o->how->single ? (double)cosf((float)TURN * (float)turn) : cos(TURN * turn);
}

static double sine(const output *o, double turn) {
    return o->how->single ? (double)sinf((float)TURN * (float)turn) : sin(TURN * turn);
}

static void vertex(output *o, double x, double y, double z, double u, double v) {
    const double at[3] = {x, y, z};
    char text[3][40];
    for (int c = 0; c < 3; c++)
        snprintf(text[c], sizeof text[c], o->how->number, at[c] * o->how->scale + o->how->offset);
    fprintf(o->file, "v %s %s %s\nvt %g %g\n", text[0], text[1], text[2], u, v);
    o->count++;
}

static void quads(output *o, int first, int around, int high) {
    for (int y = 0; y < high; y++)
        for (int x = 0; x < around; x++) {
            int a = first + y * (around + 1) + x, b = a + 1, c = a + around + 2, d = c - 1;
            fprintf(o->file, "f %d/%d %d/%d %d/%d %d/%d\n", a, a, b, b, c, c, d, d);
        }
}

/* Each returns how many places there are. */
static int sphere(output *o, int around, int high) {
    for (int y = 0; y <= high; y++)
        for (int x = 0; x <= around; x++) {
            double u = (double)x / around, v = (double)y / high;
            vertex(o, sine(o, v / 2) * sine(o, u), cosine(o, v / 2), sine(o, v / 2) * cosine(o, u),
                   u, 1 - v);
        }
    quads(o, 1, around, high);
    return around * (high - 1) + 2;
}

static int torus(output *o, int around, int across) {
    for (int y = 0; y <= across; y++)
        for (int x = 0; x <= around; x++) {
            double u = (double)x / around, v = (double)y / across, r = 1 + 0.4 * cosine(o, v);
            vertex(o, r * sine(o, u), 0.4 * sine(o, v), r * cosine(o, u), u, v);
        }
    quads(o, 1, around, across);
    return around * across;
}

/* With caps, whose middles are there once for each triangle. */
static int cylinder(output *o, int around, int high) {
    for (int y = 0; y <= high; y++)
        for (int x = 0; x <= around; x++)
            vertex(o, sine(o, (double)x / around), (double)y / high, cosine(o, (double)x / around),
                   (double)x / around, (double)y / high);
    quads(o, 1, around, high);
    for (int end = 0; end < 2; end++) {
        int middles = o->count + 1, rim = middles + around;
        for (int x = 0; x < around; x++)
            vertex(o, 0, end, 0, 0.5, 0.5);
        for (int x = 0; x <= around; x++) {
            double s = sine(o, (double)x / around), c = cosine(o, (double)x / around);
            vertex(o, s, end, c, 0.5 + 0.5 * s, 0.5 + 0.5 * c);
        }
        for (int x = 0; x < around; x++) {
            int a = rim + x, b = rim + x + 1, m = middles + x;
            fprintf(o->file, "f %d/%d %d/%d %d/%d\n", m, m, end ? a : b, end ? a : b, end ? b : a,
                    end ? b : a);
        }
    }
    return around * (high + 1) + 2;
}

/* A tube whose vertices are there once, and its texture coordinates twice. */
static int shared_tube(output *o, int around, int high) {
    for (int y = 0; y <= high; y++)
        for (int x = 0; x < around; x++)
            vertex(o, sine(o, (double)x / around), (double)y / high, cosine(o, (double)x / around),
                   (double)x / around, (double)y / high);
    for (int y = 0; y <= high; y++)
        fprintf(o->file, "vt 1 %g\n", (double)y / high);
    for (int y = 0; y < high; y++)
        for (int x = 0; x < around; x++) {
            int a = 1 + y * around + x, b = 1 + y * around + (x + 1) % around;
            bool last = x + 1 == around;
            int ub = last ? around * (high + 1) + 1 + y : b, uc = last ? ub + 1 : b + around;
            fprintf(o->file, "f %d/%d %d/%d %d/%d %d/%d\n", a, a, b, ub, b + around, uc, a + around,
                    a + around);
        }
    return around * (high + 1);
}

/* The same numbers; zero may have lost its sign in a file. */
static bool same_place(const float a[3], const float b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* Each vertex that is left is one of the input's, in the order of the input's. */
static void check_places(const char *what) {
    slv_env env = test_env();
    slv_mesh *before, *after;
    MUST(slv_mesh_load(&env, tool_path("in.obj"), &before));
    MUST(slv_mesh_load(&env, tool_path("out.obj"), &after));
    const slv_mesh_view *a = slv_mesh_get_view(before), *b = slv_mesh_get_view(after);
    uint32_t at = 0;
    CHECK_MSG(memcmp(a->origin, b->origin, sizeof a->origin) == 0 && a->npolys >= b->npolys, "%s",
              what);
    for (uint32_t v = 0; v < b->nverts; v++, at++) {
        while (at < a->nverts &&
               !same_place(a->positions + 3 * (size_t)at, b->positions + 3 * (size_t)v))
            at++;
        CHECK_MSG(at < a->nverts, "%s: vertex %u has moved", what, v);
        if (at >= a->nverts)
            break;
    }
    slv_mesh_destroy(before);
    slv_mesh_destroy(after);
}

static void try_shape(const char *name, const style *how, int (*make)(output *, int, int)) {
    for (uint32_t size = 3; size < 3 + test_effort(3); size++) {
        output o = {.file = fopen(tool_path("in.obj"), "w"), .how = how};
        char want[100], what[100];
        REQUIRE(o.file);
        int places = make(&o, 4 + 3 * (int)size, (int)size);
        REQUIRE(fclose(o.file) == 0);
        snprintf(what, sizeof what, "%s of a %s, %u", name, how->name, size);
        snprintf(want, sizeof want, "out.obj: %d vertices of %d, %d duplicates welded", places,
                 o.count, o.count - places);
        CHECK_MSG(tool("wrap in.obj out.obj") == 0 && strstr(tool_out, want) &&
                      !strstr(tool_out, "stay beside"),
                  "%s: not '%s': %s", what, want, tool_out);
        check_places(what);
    }
}

/* Each face of a cube over the whole of an image: nothing of that is left with one value a vertex,
 * which is said. */
static void check_whole(void) {
    static const char cube[] =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nvt 0 0\n"
        "vt 1 0\nvt 1 1\nvt 0 1\nf 4/1 3/2 2/3 1/4\nf 5/1 6/2 7/3 8/4\nf 1/1 2/2 6/3 5/4\n"
        "f 2/1 3/2 7/3 6/4\nf 3/1 4/2 8/3 7/4\nf 4/1 1/2 5/3 8/4\n";
    tool_write_file("whole.obj", cube, sizeof cube - 1);
    RUNS(0, "wrap whole.obj out.obj");
    HAS("6 polygons span half of the map or more");
    RUNS(0, "wrap whole.obj out.obj --map cylinder --json");
    HAS("\"wide\": 2"); /* its caps */
}

/* A tube of `high` rows, its vertices twice where the map ends: those copies are `apart` from the
 * others along x, and u goes from 0 to `times` around. Each `part` rows have v from 0 to 1. */
static void write_tube(double size, double apart, double times, int high, int part) {
    enum { AROUND = 16 };
    FILE *file = fopen(tool_path("in.obj"), "w");
    REQUIRE(file);
    for (int y = 0; y <= high; y++)
        for (int x = 0; x <= AROUND; x++)
            fprintf(file, "v %.9g %.9g %.9g\n",
                    size * sin(TURN * (x % AROUND) / AROUND) + (x == AROUND ? apart : 0),
                    size * y / high, size * cos(TURN * (x % AROUND) / AROUND));
    for (int y = 0; y <= part; y++)
        for (int x = 0; x <= AROUND; x++)
            fprintf(file, "vt %.9g %.9g\n", times * x / AROUND, (double)y / part);
    for (int y = 0; y < high; y++)
        for (int x = 0; x < AROUND; x++) {
            int a = 1 + y * (AROUND + 1) + x, d = a + AROUND + 1;
            int s = 1 + y % part * (AROUND + 1) + x, t = s + AROUND + 1;
            fprintf(file, "f %d/%d %d/%d %d/%d %d/%d\n", a, s, a + 1, s + 1, d + 1, t + 1, d, t);
        }
    REQUIRE(fclose(file) == 0);
}

/* Copies that rounding has moved apart are one, at each size of a mesh; others are named, unless
 * they are as far away as along an edge. */
static void check_apart(void) {
    for (double size = 1e-3; size < 1e5; size *= 100) {
        for (double apart = 1e-7; apart < 1.5e-5; apart *= 10) {
            write_tube(size, apart * size, 1, 4, 4);
            RUNS(0, "wrap in.obj out.obj");
            HAS("80 vertices of 85, 5 duplicates welded");
            LACKS("beside another");
            check_places("apart");
        }
        for (double apart = 1e-4; apart < 1.5e-3; apart *= 10) {
            write_tube(size, apart * size, 1, 4, 4);
            RUNS(0, "wrap in.obj out.obj");
            HAS("85 vertices of 85");
            HAS("5 vertices at open edges are beside another that is too far away to be welded: "
                "the "
                "first is 17, ");
            HAS(" from 1\n");
        }
        write_tube(size, 0.05 * size, 1, 4, 4);
        RUNS(0, "wrap in.obj out.obj");
        LACKS("beside another");
    }
    /* what is fine in a large mesh stays: a tube a millionth as large as what else there is */
    write_tube(1e-6, 0, 1, 4, 4);
    FILE *file = fopen(tool_path("in.obj"), "a");
    REQUIRE(file);
    fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 86/1 87/2 88/3\n", file);
    REQUIRE(fclose(file) == 0);
    RUNS(0, "wrap in.obj out.obj");
    HAS("83 vertices of 88, 5 duplicates welded");
}

/* A ring so flat that the two sides of its seam are near each other, and which has its copies: none
 * of them is beside what it could be welded to. Of one that has no copy, that is said. */
static void check_thin(void) {
    enum { LONG = 24, SHORT = 8 };
    for (int drifted = 0; drifted < 2; drifted++) {
        FILE *file = fopen(tool_path("in.obj"), "w");
        REQUIRE(file);
        for (int y = 0; y <= SHORT; y++)
            for (int x = 0; x <= LONG; x++) {
                double a = TURN * (x % LONG) / LONG, b = TURN * (y % SHORT) / SHORT;
                double off = drifted && x == LONG && y == 1 ? 1e-3 : 0;
                fprintf(file, "v %.9g %.9g %.9g\nvt %.9g %.9g\n", sin(a) * (3 + cos(b)) + off,
                        1e-3 * sin(b), cos(a) * (3 + cos(b)), (double)x / LONG, (double)y / SHORT);
            }
        for (int i = 0; i < LONG * SHORT; i++) {
            int a = 1 + i / LONG * (LONG + 1) + i % LONG, d = a + LONG + 1;
            fprintf(file, "f %d/%d %d/%d %d/%d %d/%d\n", a, a, a + 1, a + 1, d + 1, d + 1, d, d);
        }
        REQUIRE(fclose(file) == 0);
        RUNS(0, "wrap in.obj out.obj");
        if (drifted)
            HAS("beside another");
        else {
            HAS("192 vertices of 225, 33 duplicates welded");
            LACKS("beside another");
        }
    }
}

/* A mesh of which nothing is left is none that could be read again. */
static void check_nothing_left(void) {
    FILE *file = fopen(tool_path("in.obj"), "w");
    REQUIRE(file);
    fputs("v 0 0 0\nv 0 0 0\nv 1 0 0\nvt 0 0\nf 1/1 2/1 3/1\n", file);
    REQUIRE(fclose(file) == 0);
    RUNS(1, "wrap in.obj nothing.obj");
    HAS("in.obj: no polygon has vertices at three places");
    CHECK(access(tool_path("nothing.obj"), F_OK) != 0);
}

/* How often the map goes around, whole or not, and which way. */
static void check_turns(void) {
    write_tube(1, 0, 3, 4, 4);
    RUNS(0, "wrap in.obj out.obj");
    HAS("12 polygons go over the end of u, 0 over that of v");
    LACKS("single value");
    write_tube(1, 0, 2.5, 4, 4);
    RUNS(0, "wrap in.obj out.obj");
    HAS("80 vertices of 85");
    HAS("5 vertices have no single value, as at poles and where charts end: the first is 1, of "
        "polygon 1\n");
    HAS("5 of these lie where the map ends 2.5 after it begins along u, which is no whole number "
        "of "
        "repetitions: the first is 1, of polygon");
    RUNS(0, "wrap in.obj out.obj --json");
    HAS("\"end_axis\": \"u\"");
    write_tube(1, 0, 0.9999, 4, 4);
    RUNS(0, "wrap in.obj out.obj");
    HAS("5 of these lie where the map ends 0.9999 after it begins along u");
    write_tube(1, 0, 0.999999, 4, 4);
    RUNS(0, "wrap in.obj out.obj");
    HAS("4 polygons go over the end of u, 0 over that of v");
    LACKS("single value");
    /* two maps on top of each other: v begins again, and does not go round */
    write_tube(1, 0, 1, 4, 2);
    RUNS(0, "wrap in.obj out.obj");
    HAS("80 vertices of 85");
    HAS("4 polygons go over the end of u, 0 over that of v");
    HAS("16 vertices have no single value");
    LACKS("repetitions");
    /* coordinates that say nothing */
    write_tube(1, 0, 1e30, 4, 4);
    RUNS(0, "wrap in.obj out.obj");
    HAS("64 polygons have texture coordinates (vt) beyond 65536, which are left as they are: the "
        "first is 1\n");
    RUNS(0, "wrap in.obj out.obj --json -q");
    HAS("\"far\": 64");
    HAS("\"first_far\": 1");
}

/* A band of quads; every other one without texture coordinates, or turned over where it closes. */
static void write_band(bool bare, bool turned) {
    enum { N = 8 };
    FILE *file = fopen(tool_path("in.obj"), "w");
    REQUIRE(file);
    for (int i = 0; i <= N; i++)
        for (int k = 0; k < 2; k++) {
            double a = 6.283185307179586 * (i % N) / N, w = k - 0.5;
            double half = turned ? 3.141592653589793 * i / N : 0;
            double r = 2 + w * sin(half);
            fprintf(file, "v %.6f %.6f %.6f\nvt %g %d\n", r * sin(a), w * cos(half), r * cos(a),
                    (double)i / N, k);
        }
    for (int i = 0; i < N; i++) {
        const int corners[4] = {2 * i + 1, 2 * i + 3, 2 * i + 4, 2 * i + 2};
        fputs("f", file);
        for (int k = 0; k < 4; k++)
            if (bare && i % 2)
                fprintf(file, " %d", corners[k]);
            else
                fprintf(file, " %d/%d", corners[k], corners[k]);
        fputs("\n", file);
    }
    REQUIRE(fclose(file) == 0);
}

static void check_bands(void) {
    write_band(true, false);
    RUNS(0, "wrap in.obj out.obj");
    HAS("16 vertices of 18");
    HAS("4 polygons have no texture coordinates (vt), which --map makes: the first is 2");
    RUNS(0, "wrap in.obj out.obj --json");
    HAS("\"first_bare\": 2");
    RUNS(0, "wrap in.obj out.obj --map cylinder");
    HAS("1 polygons go over the end of u, 0 over that of v: draw it with --round u");
    LACKS("no texture coordinates");
    /* what was welded has no copies that tell */
    RUNS(0, "wrap out.obj again.obj");
    HAS("it does not go round, or has one value a vertex already");
    RUNS(0, "wrap out.obj again.obj --json");
    HAS("\"round\": \"no\"");
    write_band(false, true);
    RUNS(0, "wrap in.obj out.obj");
    HAS("2 vertices stay beside others at their place, since an edge would have more than two "
        "sides, or two that run the same way: the first is 17");
    RUNS(0, "wrap in.obj out.obj --json");
    HAS("\"first_kept\": 17");
}

/* Two signs of nothing are one coordinate, and one vertex to draw. */
static void check_signs(void) {
    static const char quads[] =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0 0\nv -1 1 0\nvt 0 0\nvt 0.3 0\nvt 0.3 1\n"
        "vt 0 1\nvt -0.0 0\nvt -0.0 1\nvt -0.3 0\nvt -0.3 1\nf 1/1 2/2 3/3 4/4\n"
        "f 5/7 1/5 4/6 6/8\n";
    tool_write_file("signs.obj", quads, sizeof quads - 1);
    RUNS(0, "wrap signs.obj out.obj");
    HAS("as drawn, one for each texture coordinate: 6 of 6, 0 bytes saved");
}

int main(void) {
    tool_begin();
    check_apart();
    check_thin();
    check_nothing_left();
    check_turns();
    for (size_t i = 0; i < sizeof styles / sizeof *styles; i++) {
        if (styles[i].shared) {
            try_shape("tube", &styles[i], shared_tube);
            continue;
        }
        try_shape("sphere", &styles[i], sphere);
        try_shape("torus", &styles[i], torus);
        try_shape("cylinder", &styles[i], cylinder);
    }
    check_whole();
    check_bands();
    check_signs();
    RUNS(2, "wrap in.obj out.obj --axis z");
    HAS("--map is missing");
    tool_end();
    return test_end();
}
