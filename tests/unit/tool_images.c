/* Images by texture coordinates: what OpenGL draws is what rays see, over quads and sub-faces;
 * tiles with gaps, faces on several tiles, and faces without any; and the two verbs that show them.
 */
#include "kit/mesh_shapes.h"
#include "kit/tool_kit.h"

#include <selvage/bake.h>
#include <selvage/gl_images.h>
#include <selvage/reference.h>

#include <sys/mman.h>
#include <sys/wait.h>

enum { SIZE = 96 };

typedef float image_fn(uint32_t channel, float u, float v);

/* Smooth, and another one in each channel, so that neither turns nor swaps go unseen. */
static float waves(uint32_t channel, float u, float v) {
    static const float k[3][2] = {{2, 1}, {-1, 3}, {1, -2}};
    return 0.5f + 0.4f * sinf(6.2831853f * (k[channel % 3][0] * u + k[channel % 3][1] * v));
}

static float low(uint32_t channel, float u, float v) {
    return 0.25f * waves(channel, u, v);
}

static void write_image(const char *name, uint32_t width, uint32_t height, image_fn *value) {
    const slv_image_params floats = {.bits = 32};
    slv_env env = test_env();
    slv_image image;
    MUST(slv_image_create(&env, width, height, 3, &image));
    for (uint32_t i = 0; i < width * height; i++)
        for (uint32_t c = 0; c < 3; c++)
            image.pixels[3 * i + c] = value(c, ((float)(i % width) + 0.5f) / (float)width,
                                            1 - ((float)(i / width) + 0.5f) / (float)height);
    MUST(slv_image_save(&env, tool_path(name), &image, &floats));
    slv_image_free(&image);
}

/* A box with a five-sided roof; each polygon has a place of its own in the image. */
static const char box[] =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "v 0 1.4 1\nvt .02 .02\nvt .3 .02\nvt .3 .3\nvt .02 .3\nvt .35 .05\nvt .6 .02\nvt .62 .3\n"
    "vt .5 .4\nvt .36 .3\nvt .7 .1\nvt .95 .1\nvt .9 .45\nvt .7 .4\nvt .05 .5\nvt .4 .5\nvt .4 .9\n"
    "vt .05 .95\nvt .5 .5\nvt .9 .55\nvt .7 .9\n"
    "f 1/1 4/4 3/3 2/2\nf 5/5 6/6 7/7 9/8 8/9\nf 1/10 2/11 6/12 5/13\nf 3/14 4/15 8/16 9/17\n"
    "f 3/18 9/20 7/19\nf 1/1 5/2 8/3 4/4\nf 2/10 3/11 7/12 6/13\n";
/* Five quads in a row: on tile 1001, over its border to 1002, on 1003, which has no file, without
 * texture coordinates, and on 1011. */
static const char quads[] =
    "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 4 0 0\nv 5 0 0\nv 0 1 0\nv 1 1 0\n"
    "v 2 1 0\nv 3 1 0\nv 4 1 0\nv 5 1 0\nvt .1 .1\nvt .6 .1\nvt .6 .9\n"
    "vt .1 .9\nvt 1.4 .1\nvt 1.4 .9\nvt 2.1 .2\nvt 2.9 .2\nvt 2.9 .8\n"
    "vt 2.1 .8\nvt 0 1\nvt 1 1\nvt 1 2\nvt 0 2\n"
    "f 1/1 2/2 8/3 7/4\nf 2/2 3/5 9/6 8/3\nf 3/7 4/8 10/9 9/10\nf 4 5 11 10\n"
    "f 5/11 6/12 12/13 11/14\n";

static void write_text(const char *name, const char *text) {
    FILE *file = fopen(tool_path(name), "w");
    REQUIRE(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

static slv_image load(const char *name) {
    slv_env env = test_env();
    slv_image image = {0};
    MUST(slv_image_load(&env, tool_path(name), &image));
    return image;
}

/* What two pictures differ by where no pixel near one is background, or marked; in dB of a range of
 * 1. */
static double psnr_inside(const slv_image *a, const slv_image *b, const uint8_t *marks,
                          uint32_t *count) {
    double squares = 0;
    int w = (int)a->width, h = (int)a->height;
    *count = 0;
    REQUIRE(a->width == b->width && a->height == b->height && a->nchannels == 4 &&
            b->nchannels == 4);
    for (int y = 2; y < h - 2; y++)
        for (int x = 2; x < w - 2; x++) {
            bool inside = true;
            for (int k = 0; k < 25; k++) {
                int near = (y + k / 5 - 2) * w + x + k % 5 - 2;
                inside &= b->pixels[4 * near + 3] > 0.99f && !(marks && marks[near]);
            }
            if (!inside)
                continue;
            ++*count;
            for (int c = 0; c < 3; c++) {
                double d =
                    (double)a->pixels[4 * (y * w + x) + c] - (double)b->pixels[4 * (y * w + x) + c];
                squares += d * d;
            }
        }
    return -10 * log10(squares / (3.0 * (double)(*count ? *count : 1)));
}

/* A picture of each verb with the same options, and how near they are. */
static void compare(const char *options, const uint8_t *marks, double least) {
    uint32_t count;
    CHECK_MSG(tool("render %s --msaa 4 --aniso 16 --bits 32 -q -o gl.exr", options) == 0, "%s",
              tool_out);
    CHECK_MSG(tool("reference %s --samples 64 -q -o rays.exr", options) == 0, "%s", tool_out);
    slv_image gl = load("gl.exr"), rays = load("rays.exr");
    double near = psnr_inside(&gl, &rays, marks, &count);
    CHECK_MSG(near >= least && count > SIZE, "%s: %.1f dB in %u pixels", options, near, count);
    slv_image_free(&gl);
    slv_image_free(&rays);
}

static void pixel_at(const slv_image *image, float x, float y, float rgba[4]) {
    size_t at =
        (size_t)(y * (float)image->height) * image->width + (size_t)(x * (float)image->width);
    memcpy(rgba, image->pixels + 4 * at, 4 * sizeof *rgba);
}

/* In the middle of each quad of the row there is what its tile has there. */
static void check_tiles(const char *picture) {
    static const float uv[3][3] = {{0, 0.35f, 0.5f}, {1, 1.0f, 0.5f}, {4, 0.5f, 1.5f}};
    slv_image image = load(picture);
    float none[3], rgba[4];
    slv_bake_miss_color(SLV_BAKE_NO_TILE, none);
    for (int i = 0; i < 2; i++) {
        pixel_at(&image, (2.5f + (float)i) / 5, 0.5f, rgba);
        for (int c = 0; c < 3; c++) {
            float light =
                none[c] <= 0.04045f ? none[c] / 12.92f : powf((none[c] + 0.055f) / 1.055f, 2.4f);
            CHECK_MSG(fabsf(rgba[c] - light) < 2e-3f, "%s: quad %d channel %d: %g, not %g", picture,
                      2 + i, c, (double)rgba[c], (double)light);
        }
    }
    for (int i = 0; i < 3; i++) {
        float x = (uv[i][0] + 0.5f) / 5, at = uv[i][1];
        /* a little beside the border of tiles, on either side */
        for (int side = -1; side < 2; side += 2) {
            float s = at + 0.8f * 0.25f * (float)side * (i == 1);
            image_fn *value = i == 1 && side > 0 ? low : waves;
            pixel_at(&image, x + (i == 1 ? 0.05f * (float)side : 0), 0.5f, rgba);
            for (int c = 0; c < 3; c++) {
                float want = value((uint32_t)c, s, uv[i][2]);
                CHECK_MSG(fabsf(rgba[c] - want) < 0.15f, "%s: quad %g channel %d: %g, not %g",
                          picture, (double)uv[i][0], c, (double)rgba[c], (double)want);
            }
        }
    }
    slv_image_free(&image);
}

static void tiles(void) {
    static const char look[] =
        "{\"world_to_camera\": [[1,0,0,0],[0,1,0,0],[0,0,1,-3],[0,0,0,1]],"
        "\"projection\": \"orthographic\", \"screen_window\": [0, 5, 0, 1],"
        "\"size\": [200, 40], \"shading\": {\"model\": \"unlit\"}, \"scheme\": \"bilinear\"}";
    write_text("row.obj", quads);
    write_text("row.json", look);
    write_image("t.1001.exr", 64, 64, waves);
    write_image("t.1002.exr", 32, 32, low);
    write_image("t.1011.exr", 48, 30, waves);
    CHECK_MSG(tool("render row.obj --uv t.UDIM.exr -o x.png") == 1, "%s", tool_out);
    CHECK(tool("render row.obj --uv 't.<UDIM>.exr' --view row.json -o t.1001.exr") == 1);
    CHECK_MSG(strstr(tool_out, "is one of t.<UDIM>.exr, and would be lost"), "%s", tool_out);
    CHECK(tool("render row.obj --uv 't.<UDIM>.exr' --view row.json --bits 32 -o gl.exr") == 0);
    CHECK_MSG(strstr(tool_out, "1003") && !strstr(strstr(tool_out, "1003") + 1, "1003"), "%s",
              tool_out);
    CHECK_MSG(strstr(tool_out, " 3 images by texture coordinates"), "%s", tool_out);
    check_tiles("gl.exr");
    CHECK(tool("reference row.obj --uv 't.<UDIM>.exr' --view row.json -q -o rays.exr") == 0);
    check_tiles("rays.exr");
}

/* Levels are means over areas: a grey of all pixels is all that is left of an image from far away,
 * whatever its sides. */
static void far_away(void) {
    static const char look[] =
        "{\"world_to_camera\": [[1,0,0,0],[0,1,0,0],[0,0,1,-3],[0,0,0,1]],"
        "\"projection\": \"orthographic\", \"screen_window\": [-100, 100, -100, 100],"
        "\"size\": [25, 25], \"shading\": {\"model\": \"unlit\"}, \"scheme\": \"bilinear\"}";
    const slv_image_params floats = {.bits = 32};
    slv_env env = test_env();
    slv_image image;
    double mean = 0;
    write_text("far.json", look);
    write_text("far.obj", "v -100 -100 0\nv 100 -100 0\nv 100 100 0\nv -100 100 0\nvt 0 0\n"
                          "vt 100 0\nvt 100 100\nvt 0 100\nf 1/1 2/2 3/3 4/4\n");
    MUST(slv_image_create(&env, 37, 21, 1, &image));
    for (uint32_t i = 0; i < 37 * 21; i++)
        mean += (double)(image.pixels[i] = (i * 7919u % 101u) / 100.0f) / (37 * 21);
    MUST(slv_image_save(&env, tool_path("noise.exr"), &image, &floats));
    slv_image_free(&image);
    CHECK_MSG(tool("render far.obj --uv noise.exr --view far.json --bits 32 -q -o far.exr") == 0,
              "%s", tool_out);
    image = load("far.exr");
    for (uint32_t i = 0; i < 25 * 25; i++)
        CHECK_MSG(fabs((double)image.pixels[4 * i] - mean) < 1e-3, "pixel %u: %g, not %g", i,
                  (double)image.pixels[4 * i], mean);
    slv_image_free(&image);
}

/* A tube of 12 sides with one coordinate a vertex, or with the column of vertices at its seam
 * twice; of quads, or of triangles. */
static void write_tube(const char *name, bool twice, bool triangles) {
    enum { AROUND = 12, HIGH = 4 };
    FILE *file = fopen(tool_path(name), "w");
    REQUIRE(file);
    for (int y = 0; y <= HIGH; y++)
        for (int x = 0; x < AROUND + twice; x++)
            fprintf(file, "v %.9g %.9g %.9g\nvt %.9g %.9g\n",
                    sin(6.283185307 * (x % AROUND) / AROUND), 0.5 * y - 1,
                    cos(6.283185307 * (x % AROUND) / AROUND), (double)x / AROUND, (double)y / HIGH);
    for (int y = 0; y < HIGH; y++)
        for (int x = 0; x < AROUND; x++) {
            int row = AROUND + twice, a = 1 + y * row + x, b = 1 + y * row + (x + 1) % row;
            int c = b + row, d = a + row;
            fprintf(file,
                    triangles ? "f %d/%d %d/%d %d/%d\nf %d/%d %d/%d %d/%d\n"
                              : "f %d/%d %d/%d %d/%d %d/%d\n",
                    a, a, b, b, c, c, triangles ? a : d, triangles ? a : d, c, c, d, d);
        }
    REQUIRE(fclose(file) == 0);
}

/* How far two pictures are apart in their most different pixel. */
static float apart_most(const char *one, const char *other) {
    slv_image a = load(one), b = load(other);
    float apart = 0;
    REQUIRE(a.width == b.width && a.height == b.height);
    for (uint32_t i = 0; i < 4 * a.width * a.height; i++)
        apart = fmaxf(apart, fabsf(a.pixels[i] - b.pixels[i]));
    slv_image_free(&a);
    slv_image_free(&b);
    return apart;
}

static double near_rays(const char *options) {
    uint32_t count;
    CHECK_MSG(tool("render %s --msaa 4 --aniso 16 --bits 32 -q -o gl.exr", options) == 0, "%s",
              tool_out);
    slv_image gl = load("gl.exr"), rays = load("rays.exr");
    double near = psnr_inside(&gl, &rays, NULL, &count);
    CHECK(count > SIZE);
    slv_image_free(&gl);
    slv_image_free(&rays);
    return near;
}

/* Coordinates with one value a vertex, wherever the seam is looked at from: as the mesh with
 * duplicated vertices, which interpolation without the method is far from. What duplicates there
 * are is gone from the mesh that wrap writes. */
static void rounds(void) {
    write_tube("once.obj", false, false);
    write_tube("twice.obj", true, false);
    for (int azimuth = 0; azimuth < 360; azimuth += 360 / (int)test_effort(3)) {
        char options[256];
        snprintf(
            options, sizeof options,
            "--uv waves.exr --scheme bilinear --shading unlit --tess 16 --size 96 --azimuth %d",
            azimuth);
        CHECK(tool("reference once.obj %s --round u --samples 64 -q -o rays.exr", options) == 0);
        char line[300];
        snprintf(line, sizeof line, "once.obj --round u %s", options);
        double method = near_rays(line);
        CHECK(tool("render once.obj %s --round u --aniso 16 --bits 32 -q -o a.exr", options) == 0);
        CHECK(tool("render twice.obj --round u %s --aniso 16 --bits 32 -q -o b.exr", options) == 0);
        float apart = apart_most("a.exr", "b.exr");
        CHECK_MSG(method > 40 && apart <= 1.0f / 255, "%d degrees: %.1f dB, %g apart", azimuth,
                  method, (double)apart);
    }
    CHECK(tool("reference once.obj --round u --uv waves.exr --scheme bilinear --size 96 --azimuth "
               "0 --samples 64 -q -o rays.exr") == 0);
    double plain = near_rays("once.obj --uv waves.exr --scheme bilinear --size 96 --azimuth 0");
    CHECK_MSG(plain < 30, "plain interpolation: %.1f dB", plain);
    CHECK(tool("wrap twice.obj back.obj") == 0);
    CHECK_MSG(strstr(tool_out, "60 vertices of 65, 5 duplicates welded") &&
                  strstr(tool_out, "4 polygons go over the end of u, 0 over that of v"),
              "%s", tool_out);
    CHECK_MSG(!strstr(tool_out, "single value") && !strstr(tool_out, "half"), "%s", tool_out);
    double back = near_rays("back.obj --round u --uv waves.exr --scheme bilinear --size 96 "
                            "--azimuth 0");
    CHECK_MSG(back > 40, "welded: %.1f dB", back);
    CHECK(tool("wrap back.obj again.obj --map cylinder") == 0);
    CHECK_MSG(strstr(tool_out, "60 vertices of 60, 0 duplicates"), "%s", tool_out);
}

/* The middles of sides and of sub-faces that lie over the end of the map go the short way, too; and
 * what is baked is what is drawn. */
static void parts_go_round(void) {
    static const char line[] = "--uv waves.exr --scheme bilinear --shading unlit --tess 16 --size "
                               "96 --azimuth 0 --aniso 16 --bits 32 -q";
    write_tube("once.obj", false, true);
    write_tube("twice.obj", true, true);
    CHECK(tool("render twice.obj %s --round u -o twice.exr", line) == 0);
    CHECK(tool("render once.obj %s --round u -o once.exr", line) == 0);
    CHECK(tool("render once.obj %s -o plain.exr", line) == 0);
    float method = apart_most("once.exr", "twice.exr"),
          plain = apart_most("plain.exr", "twice.exr");
    CHECK_MSG(method <= 1.0f / 255 && plain > 0.2f, "%g apart, plain %g", (double)method,
              (double)plain);
    for (int triangles = 0; triangles < 2; triangles++) {
        write_tube("once.obj", false, triangles);
        write_tube("twice.obj", true, triangles);
        CHECK(tool("bake once.obj --uv waves.exr --round u --wrap repeat --size 16 --reductions "
                   "plain -q -o once.ptx") == 0);
        CHECK(tool("bake twice.obj --uv waves.exr --wrap repeat --size 16 --reductions plain -q -o "
                   "twice.ptx") == 0);
        CHECK_MSG(tool("diff once.ptx twice.ptx --texels --tolerance 1e-5") == 0, "%s", tool_out);
        /* v, which does not go round, ends by itself where nothing else was asked for */
        CHECK(tool("bake once.obj --uv waves.exr --round u --size 16 --reductions plain -q -o "
                   "ends.ptx") == 0);
        CHECK_MSG(tool("diff ends.ptx twice.ptx --texels --tolerance 1e-5") == 1, "%s", tool_out);
        CHECK(tool("bake once.obj --uv waves.exr --size 16 --reductions plain -q -o plain.ptx") ==
              0);
        CHECK_MSG(tool("diff plain.ptx twice.ptx --texels --tolerance 0.1") == 1, "%s", tool_out);
    }
    /* four rows of a fourth of the map each are told well; of two rows each has half of it */
    CHECK(tool("render once.obj --uv waves.exr --round both --size 16 -q -o y.png") == 0);
    CHECK_MSG(!strstr(tool_out, "half of the map"), "%s", tool_out);
    write_text("half.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nvt 0 0\n"
                           "vt .25 0\nvt .25 1\nvt 0 1\nvt .75 0\nvt .75 1\n"
                           "f 1/1 2/2 3/3 4/4\nf 2/2 5/5 6/6 3/3\n");
    CHECK(tool("render half.obj --uv waves.exr --round u --size 16 -q -o y.png") == 0);
    CHECK_MSG(strstr(tool_out, "1 of 2 faces span half of the map") &&
                  strstr(tool_out, "the first is face 1"),
              "%s", tool_out);
    CHECK(tool("bake once.obj --pattern noise --round u -o none.ptx") == 2);
    CHECK(tool("render once.obj --uv 't.<UDIM>.exr' --round u -o x.png") == 1);
    CHECK_MSG(strstr(tool_out, "one image"), "%s", tool_out);
}

/* A ball of the kind that other programs write, with a seam and poles in many copies; and what the
 * method cannot do is named. */
static void limits(void) {
    enum { AROUND = 8, HIGH = 6 };
    FILE *file = fopen(tool_path("ball.obj"), "w");
    REQUIRE(file);
    for (int y = 0; y <= HIGH; y++)
        for (int x = 0; x <= AROUND; x++) {
            double a = 6.283185307 * (x % AROUND) / AROUND, r = sin(3.1415926536 * y / HIGH);
            r = y % HIGH ? r : 0;
            fprintf(file, "v %.9g %.9g %.9g\nvt %.9g %.9g\n", r * sin(a),
                    cos(3.1415926536 * y / HIGH), r * cos(a), (double)x / AROUND,
                    1 - (double)y / HIGH);
        }
    for (int y = 0; y < HIGH; y++)
        for (int x = 0; x < AROUND; x++) {
            int row = AROUND + 1, a = 1 + y * row + x;
            fprintf(file, "f %d/%d %d/%d %d/%d %d/%d\n", a, a, a + row, a + row, a + row + 1,
                    a + row + 1, a + 1, a + 1);
        }
    REQUIRE(fclose(file) == 0);
    CHECK(tool("wrap ball.obj joined.obj") == 0);
    CHECK_MSG(strstr(tool_out, "42 vertices of 63, 21 duplicates welded") &&
                  strstr(tool_out, "2 vertices have no single value") &&
                  !strstr(tool_out, "stay beside"),
              "%s", tool_out);
    /* three sides: each spans a third, and each half of two of them more */
    write_text("prism.obj", "v 0 0 1\nv 1 0 -1\nv -1 0 -1\nv 0 1 1\nv 1 1 -1\nv -1 1 -1\n"
                            "vt 0 0\nvt .6 0\nvt 1 0\nvt 0 1\nvt .6 1\nvt 1 1\n"
                            "f 1/1 2/2 5/5 4/4\nf 2/2 3/3 6/6 5/5\n");
    CHECK(tool("wrap prism.obj out.obj --map keep") == 0);
    CHECK_MSG(!strstr(tool_out, "half of the map"), "%s", tool_out);
    write_text("flat.obj", "v -1 0 1\nv 1 0 1\nv 1 1 1\nv -1 1 1\nv -1 0 -1\nv 1 0 -1\n"
                           "v 1 1 -1\nv -1 1 -1\nf 1 2 3 4\nf 6 5 8 7\n");
    CHECK(tool("wrap flat.obj out.obj --map cylinder") == 0);
    CHECK(tool("wrap flat.obj out.png") == 2);
    /* three sheets at one edge stay three */
    write_text("sheets.obj", "v 0 0 0\nv 0 1 0\nv 1 1 0\nv 1 0 0\nv 0 0 0\nv 0 1 0\nv -1 1 0\n"
                             "v -1 0 0\nv 0 0 0\nv 0 1 0\nv 0 1 1\nv 0 0 1\nf 1 2 3 4\n"
                             "f 6 5 8 7\nf 9 10 11 12\n");
    CHECK(tool("wrap sheets.obj out.obj") == 0);
    CHECK_MSG(strstr(tool_out, "12 vertices of 12") && strstr(tool_out, "4 vertices stay beside"),
              "%s", tool_out);
}

/* Faces that nothing of an image can be on are drawn in one colour, and named by each verb. */
static void lacking(void) {
    static const char compare[] =
        "compare some.ptx --mesh some.obj --uv waves.exr --strategies clamp --quick --frames 1 "
        "--size 48x48 --reference none -q -o some";
    const char *const verbs[] = {
        "render some.obj --uv waves.exr --size 16 -q -o y.png",
        "reference some.obj --uv waves.exr --size 16 -n 4 -q -o y.exr",
        "bake some.obj --uv waves.exr --size 4 --max-miss 1 -q -o some.ptx", compare,
        "unbake some.ptx u.png --mesh some.obj --size 16 -q"};
    write_text("some.obj",
               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nv 3 0 0\nv 3 1 0\n"
               "vt 0 0\nvt .2 0\nvt .2 1\nvt 0 1\nvt 1e30 0\n"
               "f 1/1 2/2 3/3 4/4\nf 2 5 6 3\nf 5/1 7/5 8/3 6/4\n");
    for (size_t i = 0; i < sizeof verbs / sizeof *verbs; i++) {
        CHECK_MSG(tool("%s", verbs[i]) == 0, "%s: %s", verbs[i], tool_out);
        if (i < 4)
            CHECK_MSG(strstr(tool_out, "1 of 3 faces have no texture coordinates") &&
                          strstr(tool_out, "the first is face 1") &&
                          strstr(tool_out, "1 of 3 faces have texture coordinates (vt) beyond") &&
                          strstr(tool_out, "the first is face 2"),
                      "%s: %s", verbs[i], tool_out);
        else
            CHECK_MSG(strstr(tool_out, "2 faces have no texture coordinates"), "%s", tool_out);
    }
    CHECK(tool("render box.obj --uv waves.exr --size 16 -q -o y.png") == 0);
    CHECK_MSG(!strstr(tool_out, "texture coordinates"), "%s", tool_out);
}

static void refused(void) {
    write_text("bare.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
    CHECK(tool("render bare.obj --uv t.1001.exr -o x.png") == 1);
    CHECK_MSG(strstr(tool_out, "texture coordinates"), "%s", tool_out);
    CHECK(tool("render box.obj --uv missing.exr -o x.png") == 1);
    CHECK(tool("render box.obj --uv waves.exr --mesh box.obj -o x.png") == 2);
    CHECK(tool("render box.obj --uv waves.exr --compress -o x.png") == 2);
    CHECK(access(tool_path("x.png"), F_OK) != 0);
}

/* Marks pixels where the surface ends before other parts of it: silhouettes too, for which rays and
 * the samples of a pixel are not the same. */
static void mark_folds(const char *obj, const char *png, uint32_t side, float azimuth,
                       uint8_t *marks) {
    slv_env env = test_env();
    slv_uv_images images;
    slv_mesh *mesh;
    slv_bake_source *source;
    slv_surface *surface;
    slv_adjacency *adjacency;
    slv_reference *reference;
    slv_reference_hit *hits = calloc((size_t)side * side, sizeof *hits);
    float low[3], high[3];
    MUST(slv_mesh_load(&env, obj, &mesh));
    MUST(slv_bake_from_uv(&env, mesh, png, NULL, &source));
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    REQUIRE(hits && slv_bake_source_images(source, &images));
    const slv_reference_params params = {.segments = 8, .images = &images};
    for (uint32_t i = 0; i < 3 * view->nverts; i++) {
        low[i % 3] = i < 3 ? view->positions[i] : fminf(low[i % 3], view->positions[i]);
        high[i % 3] = i < 3 ? view->positions[i] : fmaxf(high[i % 3], view->positions[i]);
    }
    const slv_camera camera = slv_camera_orbit(low, high, azimuth, 20, 35, 1);
    MUST(slv_surface_create(&env, mesh, NULL, &surface));
    MUST(slv_mesh_adjacency(&env, mesh, &adjacency));
    MUST(slv_reference_create(&env, mesh, surface, NULL, adjacency, &params, &reference));
    MUST(slv_reference_trace(reference, &env, &camera, side, side, hits));
    for (uint32_t i = side; i < side * side; i++) {
        float right = fabsf(hits[i].depth - hits[i - 1].depth),
              down = fabsf(hits[i].depth - hits[i - side].depth);
        marks[i] = fmaxf(right, down) > 0.03f * (high[1] - low[1]);
    }
    slv_reference_destroy(reference);
    slv_adjacency_destroy(adjacency);
    slv_surface_destroy(surface);
    slv_bake_source_destroy(source);
    slv_mesh_destroy(mesh);
    free(hits);
}

/* A real model and its texture, from several sides. Rays leave threads behind that a fork would
 * miss, so that those of this test are cast in one of their own. */
static void cow(const char *samples) {
    enum { SIDE = 512 };
    char options[640], obj[256], png[256];
    uint8_t *marks =
        mmap(NULL, (size_t)SIDE * SIDE, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    REQUIRE(marks != MAP_FAILED);
    snprintf(obj, sizeof obj, "%s/spot/spot_control_mesh.obj", samples);
    snprintf(png, sizeof png, "%s/spot/spot_texture.png", samples);
    for (uint32_t i = 0; i < test_effort(1); i++) {
        uint32_t azimuth = (150 + 237 * i) % 360;
        int status = 1;
        pid_t child = fork();
        if (child == 0) {
            mark_folds(obj, png, SIDE, (float)azimuth, marks);
            _exit(test_failures != 0);
        }
        REQUIRE(waitpid(child, &status, 0) == child && status == 0);
        snprintf(options, sizeof options, "%s --uv %s --size %d --azimuth %u", obj, png, SIDE,
                 azimuth);
        compare(options, marks, 45);
    }
    munmap(marks, (size_t)SIDE * SIDE);
}

int main(void) {
    const char *samples = getenv("SELVAGE_SAMPLES");
    tool_begin();
    write_text("box.obj", box);
    write_image("waves.exr", 64, 64, waves);
    compare("box.obj --uv waves.exr --size 96 --azimuth 30 --tess 16", NULL, 40);
    compare("box.obj --uv waves.exr --size 96 --azimuth 200 --shading unlit --scheme bilinear",
            NULL, 45);
    tiles();
    far_away();
    rounds();
    parts_go_round();
    limits();
    lacking();
    refused();
    CHECK(tool("render box.obj --uv waves.exr --pass ids -q -o ids.exr") == 0);
    if (samples && *samples)
        cow(samples);
    tool_end();
    return test_end();
}
