/* Numbered pictures: meshes that move, turntables, and view files with several cameras, drawn and
 * cast; each picture is the one that is made of its mesh and camera alone. */
#include "kit/mesh_shapes.h"
#include "kit/tool_kit.h"

#include <selvage/image.h>

static void write_text(const char *name, const char *text) {
    FILE *file = fopen(tool_path(name), "w");
    REQUIRE(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

/* A bent strip of quads with texture coordinates; `extra` makes the last polygon another one. */
static void write_strip(const char *name, double bend, bool extra) {
    enum { N = 6 };
    FILE *file = fopen(tool_path(name), "w");
    REQUIRE(file);
    for (int i = 0; i <= N; i++)
        for (int k = 0; k < 2; k++)
            fprintf(file, "v %g %d %g\nvt %g %d\n", i - 3.0, k, bend * sin(i), (double)i / N, k);
    for (int i = 0; i < N; i++) {
        int a = 2 * i + 1, b = a + 2, c = a + 3, d = a + 1;
        if (extra && i == N - 1)
            fprintf(file, "f %d/%d %d/%d %d/%d %d/%d\n", b, b, c, c, d, d, a, a);
        else
            fprintf(file, "f %d/%d %d/%d %d/%d %d/%d\n", a, a, b, b, c, c, d, d);
    }
    REQUIRE(fclose(file) == 0);
}

static void same(const char *a, const char *b, float most) {
    slv_env env = test_env();
    slv_image one = {0}, two = {0};
    MUST(slv_image_load(&env, tool_path(a), &one));
    MUST(slv_image_load(&env, tool_path(b), &two));
    size_t count = (size_t)one.width * one.height * one.nchannels, off = 0, shown = 0;
    REQUIRE(one.width == two.width && one.height == two.height && one.nchannels == two.nchannels);
    for (size_t i = 0; i < count; i++) {
        off += !(fabsf(one.pixels[i] - two.pixels[i]) <= most);
        shown += one.pixels[i] != 0;
    }
    /* where a silhouette goes through a sample of a pixel, rounding may choose */
    CHECK_MSG(off <= (most > 0 ? count / 200 : 0) && shown > 100, "%s and %s: %zu values differ", a,
              b, off);
    slv_image_free(&one);
    slv_image_free(&two);
}

#define LOOK                                                                                       \
    "\"size\": [48, 32], \"projection\": \"perspective\", \"screen_window\": [-1.5, 1.5, -1, 1]"
#define FRONT "\"world_to_camera\": [[1,0,0,0],[0,1,0,-0.5],[0,0,1,-4],[0,0,0,1]]"
#define SIDE "\"world_to_camera\": [[0.6,0,-0.8,0],[0,1,0,-0.5],[0.8,0,0.6,-5],[0,0,0,1]]"

static void moving(const char *verb, const char *how) {
    char line[200];
    CHECK_MSG(tool("%s base.obj --uv i.exr --view one.json --frames 'm.##.obj' -q %s -o p.exr",
                   verb, how) == 0,
              "%s", tool_out);
    for (int i = 8; i < 11; i++) {
        CHECK(tool("%s m.%02d.obj --uv i.exr --view one.json -q %s -o own.exr", verb, i, how) == 0);
        snprintf(line, sizeof line, "p.%04d.exr", i);
        same(line, "own.exr", 0);
    }
    CHECK(access(tool_path("p.0007.exr"), F_OK) != 0 && access(tool_path("p.exr"), F_OK) != 0);
    CHECK(tool("%s base.obj --uv i.exr --view one.json --frames m.09.obj -q %s -o 'q#.exr'", verb,
               how) == 0);
    same("q1.exr", "p.0009.exr", 0);
}

/* Long sequences take a while to read before there is a first picture. */
static void told_of(const char *verb, const char *how) {
    for (int i = 1; i <= 12; i++) {
        char name[32];
        snprintf(name, sizeof name, "many.%02d.obj", i);
        write_strip(name, 0.1 * i, false);
    }
    CHECK(tool("%s base.obj --uv i.exr --size 8 --frames 'many.##.obj' -q --progress %s -o w.exr",
               verb, how) == 0);
    CHECK_MSG(strstr(tool_out, "reading meshes: 50%"), "%s", tool_out);
    CHECK(tool("%s base.obj --uv i.exr --size 8 --frames 'many.##.obj' -q %s -o w.exr", verb,
               how) == 0);
    CHECK_MSG(!strstr(tool_out, "reading"), "%s", tool_out);
}

static void cameras(const char *verb, const char *how) {
    write_text("two.json", "{" LOOK ", \"cameras\": [{" FRONT "}, {" SIDE "}]}");
    write_text("side.json", "{" LOOK ", " SIDE "}");
    CHECK_MSG(tool("%s base.obj --uv i.exr --view two.json %s -q -o 'c##.exr'", verb, how) == 0,
              "%s", tool_out);
    CHECK(tool("%s base.obj --uv i.exr --view one.json %s -q -o one.exr", verb, how) == 0);
    CHECK(tool("%s base.obj --uv i.exr --view side.json %s -q -o side.exr", verb, how) == 0);
    same("c01.exr", "one.exr", 0);
    same("c02.exr", "side.exr", 0);
    /* half way round a strip that looks alike from both sides the camera is as far away */
    CHECK(tool("%s base.obj --uv i.exr --turntable 2 --size 48 --azimuth 20 %s -q -o t.exr", verb,
               how) == 0);
    CHECK(tool("%s base.obj --uv i.exr --size 48 --azimuth 200 %s -q -o half.exr", verb, how) == 0);
    same("t.0002.exr", "half.exr", 2e-3f);
}

static void refused(void) {
    write_strip("m.10.obj", 1, true);
    CHECK(tool("render base.obj --uv i.exr --view one.json --frames 'm.##.obj' -o r.exr") == 1);
    CHECK_MSG(strstr(tool_out, "m.10.obj: polygon 6 has other vertices"), "%s", tool_out);
    /* nothing is drawn of those before it */
    CHECK(access(tool_path("r.0008.exr"), F_OK) != 0);
    CHECK(tool("render base.obj --uv i.exr --frames 'none.##.obj' -o r.exr") == 1);
    CHECK_MSG(strstr(tool_out, "none.##.obj: there is no such file"), "%s", tool_out);
    write_text("m.11.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
    CHECK(tool("render base.obj --uv i.exr --frames m.11.obj -o s.exr") == 1);
    CHECK_MSG(strstr(tool_out, "m.11.obj: 3 vertices and 1 polygons, the mesh has 14 and 6"), "%s",
              tool_out);
    CHECK(tool("render base.obj --uv i.exr --frames m.09.obj --turntable 3 -o s.exr") == 2);
    CHECK(tool("render base.obj --uv i.exr --turntable 0 -o s.exr") == 2);
    CHECK(tool("reference base.obj --uv i.exr --turntable 2 --json -o s.exr") == 2);
    write_text("bad.json", "{" LOOK ", \"cameras\": [{" FRONT "}, {\"fov\": 3}]}");
    CHECK(tool("render base.obj --uv i.exr --view bad.json -o s.exr") == 1);
    CHECK_MSG(strstr(tool_out, "camera 2 has no world_to_camera"), "%s", tool_out);
    write_text("bad.json", "{" LOOK ", \"cameras\": 3}");
    CHECK(tool("render base.obj --uv i.exr --view bad.json -o s.exr") == 1);
    CHECK(access(tool_path("s.exr"), F_OK) != 0 && access(tool_path("s.0001.exr"), F_OK) != 0);
}

/* Numbers that are not there, and those that are written otherwise, are named; the rest is drawn.
 */
static void gaps(void) {
    static const char *const names[] = {"g.0002.obj", "g.0003.obj", "g.0007.obj",
                                        "g.0009.obj", "g.4.obj",    "g.05.obj"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        write_strip(names[i], 0.1 * (double)i, false);
    RUNS(0,
         "render base.obj --uv i.exr --view one.json --frames 'g.####.obj' --bits 32 -q -o g.exr");
    HAS("g.####.obj: 4 numbers between 2 and 9 are missing, and have no picture: the first gap is "
        "4 "
        "to 6");
    HAS("2 files have numbers of another width, and are left out: the first is g.05.obj");
    CHECK(access(tool_path("g.0009.exr"), F_OK) == 0 && access(tool_path("g.0004.exr"), F_OK) != 0);
    RUNS(0, "render g.0007.obj --uv i.exr --view one.json --bits 32 -q -o own.exr");
    same("g.0007.exr", "own.exr", 0);
    RUNS(0, "render base.obj --uv i.exr --view one.json --frames 'm.##.obj' -q -o n.exr");
    LACKS("missing");
    LACKS("width");
    RUNS(1, "render base.obj --uv i.exr --frames 'g.#####.obj' -q -o n.exr");
    HAS("g.#####.obj: there is no such file (but g.0002.obj is there)");
}

int main(void) {
    slv_env env = test_env();
    slv_image image;
    tool_begin();
    MUST(slv_image_create(&env, 16, 8, 3, &image));
    for (uint32_t i = 0; i < 3 * 16 * 8; i++)
        image.pixels[i] = 0.2f + 0.6f * (float)(i * 37 % 101) / 101;
    MUST(slv_image_save(&env, tool_path("i.exr"), &image, NULL));
    slv_image_free(&image);
    write_text("one.json", "{" LOOK ", " FRONT "}");
    write_strip("base.obj", 0.3, false);
    for (int i = 8; i < 11; i++) {
        char name[32];
        snprintf(name, sizeof name, "m.%02d.obj", i);
        write_strip(name, 0.2 * (i - 6), false);
    }
    write_strip("m.x1.obj", 1, true); /* no number */
    moving("render", "--bits 32");
    moving("reference", "-n 4");
    told_of("render", "--bits 32");
    told_of("reference", "-n 4");
    cameras("render", "--bits 32");
    cameras("reference", "-n 4");
    gaps();
    refused();
    tool_end();
    return test_end();
}
