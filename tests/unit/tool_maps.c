/* compare with an image through texture coordinates beside per-face textures: what each row stores,
 * to the vertex and the byte; that plain interpolation fails at the map's end, the method does what
 * duplicated vertices do, and per-face textures show the same. */
#include "kit/mesh_shapes.h"
#include "kit/tool_kit.h"

#include <selvage/file.h>
#include <selvage/image.h>

#include <jansson.h>

enum { AROUND = 12, HIGH = 4, SIDE = 64 };

/* A tube, or a torus whose both coordinates go round, with one value a vertex or with `twice` as
 * many where the map ends. */
static void write_shape(const char *name, bool torus, bool twice) {
    FILE *file = fopen(tool_path(name), "w");
    REQUIRE(file);
    int width = AROUND + twice, high = torus ? 8 : HIGH, rows = torus ? high + twice : high + 1;
    for (int y = 0; y < rows; y++)
        for (int x = 0; x < width; x++) {
            double a = 6.283185307179586 * (x % AROUND) / AROUND,
                   b = 6.283185307179586 * (y % high) / high, r = torus ? 1 + 0.4 * cos(b) : 1;
            fprintf(file, "v %.9g %.9g %.9g\nvt %.9g %.9g\n", r * sin(a),
                    torus ? 0.4 * sin(b) : 0.5 * y - 1, r * cos(a), (double)x / AROUND,
                    (double)y / high);
        }
    for (int y = 0; y < high; y++)
        for (int x = 0; x < AROUND; x++) {
            int a = 1 + y * width + x, b = 1 + y * width + (x + 1) % width,
                d = 1 + (y + 1) % rows * width + x,
                c = 1 + (y + 1) % rows * width + (x + 1) % width;
            fprintf(file, "f %d/%d %d/%d %d/%d %d/%d\n", a, a, b, b, c, c, d, d);
        }
    REQUIRE(fclose(file) == 0);
}

/* Waves that go on over the ends of the image; brighter by `more`. */
static void write_image(const char *name, uint32_t nchannels, float more) {
    slv_env env = test_env();
    slv_image image;
    MUST(slv_image_create(&env, SIDE, SIDE, nchannels, &image));
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        for (uint32_t c = 0; c < nchannels; c++) {
            float u = ((float)(i % SIDE) + 0.5f) / SIDE, v = ((float)(i / SIDE) + 0.5f) / SIDE;
            image.pixels[nchannels * i + c] =
                c == 3 ? 1
                       : more + 0.4f +
                             0.3f * cosf(6.2831853f * (3 * u + (float)c / 3)) *
                                 cosf(6.2831853f * (float)(1 + c) * v);
        }
    MUST(slv_image_save(&env, tool_path(name), &image, NULL));
    slv_image_free(&image);
}

static double number(const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    CHECK_MSG(json_is_number(value), "no number %s", key);
    return json_number_value(value);
}

static double rms(const json_t *row, const char *place) {
    return number(json_object_get(json_object_get(row, "errors"), place), "rms");
}

static json_t *load_maps(const char *path) {
    json_error_t error;
    json_t *root = json_load_file(tool_path(path), 0, &error), *maps = NULL;
    REQUIRE(root);
    CHECK(json_object_get(root, "maps"));
    maps = json_incref(json_object_get(root, "maps"));
    const char *advice = json_string_value(json_object_get(root, "advice"));
    CHECK(!advice || !strncmp(advice, "clamp", 5) || !strncmp(advice, "traverse", 8));
    CHECK(json_array_size(json_object_get(root, "strategies")) == 2);
    json_decref(root);
    return maps;
}

static double outlines(const json_t *errors) {
    return number(json_object_get(errors, "outline"), "pixels");
}

/* Maps are held against the same frames of the orbit as strategies are. */
static void check_frames(const char *path) {
    json_error_t error;
    json_t *root = json_load_file(tool_path(path), 0, &error);
    REQUIRE(root);
    const json_t *strategy = json_array_get(json_object_get(root, "strategies"), 0),
                 *rate = json_array_get(json_object_get(strategy, "rates"), 0),
                 *row = json_array_get(json_object_get(json_object_get(root, "maps"), "rows"), 0);
    double there = outlines(json_object_get(json_object_get(rate, "errors"), "raycast")),
           here = outlines(json_object_get(row, "errors"));
    CHECK_MSG(here > 0 && here == there, "%g pixels of outlines, %g of strategies", here, there);
    json_decref(root);
}

/* What is stored: of rows in the order of the report. */
typedef struct stored {
    const char *name;
    int vertices, vertex_bytes, cut;
} stored;

static void check_stored(const json_t *maps, const stored *expected, size_t count) {
    const json_t *rows = json_object_get(maps, "rows");
    REQUIRE(json_array_size(rows) == count);
    for (size_t i = 0; i < count; i++) {
        const json_t *row = json_array_get(rows, i);
        const char *name = json_string_value(json_object_get(row, "name"));
        CHECK_MSG(strcmp(name, expected[i].name) == 0, "row %zu is %s", i, name);
        CHECK_MSG(number(row, "vertices") == expected[i].vertices &&
                      number(row, "vertex_bytes") ==
                          expected[i].vertices * expected[i].vertex_bytes &&
                      number(row, "cut_edges") == expected[i].cut,
                  "%s: %g vertices, %g bytes, %g edges", name, number(row, "vertices"),
                  number(row, "vertex_bytes"), number(row, "cut_edges"));
        CHECK(number(row, "median_ms") > 0 && number(row, "time_ratio") > 0);
        /* 64 x 64 and all levels, 4 bytes a pixel */
        if (strncmp(name, "uv", 2) == 0)
            CHECK_MSG(number(row, "gpu_bytes") == 5461 * 4 + 8, "%s: %g bytes", name,
                      number(row, "gpu_bytes"));
    }
}

static void check_errors(const json_t *maps, double plain) {
    const json_t *rows = json_object_get(maps, "rows");
    const json_t *twice = json_array_get(rows, 1), *method = json_array_get(rows, 2);
    const double as_good = rms(twice, "end");
    CHECK_MSG(rms(json_array_get(rows, 0), "end") > plain, "plain is %g off",
              rms(json_array_get(rows, 0), "end"));
    CHECK(number(json_array_get(rows, 0), "apart") > 0.2 && number(twice, "apart") == 0);
    CHECK_MSG(number(method, "apart") <= 1.0 / 255, "%g apart", number(method, "apart"));
    CHECK_MSG(as_good < 0.03 && fabs(rms(method, "end") - as_good) < 1e-3 &&
                  fabs(rms(method, "inside") - rms(twice, "inside")) < 1e-3,
              "method %g, twice %g", rms(method, "end"), as_good);
    for (size_t i = 3; i < json_array_size(rows); i++) {
        const json_t *row = json_array_get(rows, i);
        CHECK_MSG(rms(row, "end") < 0.03 && rms(row, "inside") < 0.02, "per face: %g, %g",
                  rms(row, "end"), rms(row, "inside"));
        CHECK(json_is_null(json_object_get(row, "apart")));
    }
}

static void check_files(void) {
    static const char *const pictures[] = {"rep/map_uv-plain.png", "rep/map_close_uv-wrapped.png",
                                           "rep/map_reference.png", "rep/map_clamp.png"};
    for (size_t i = 0; i < sizeof pictures / sizeof *pictures; i++)
        CHECK_MSG(access(tool_path(pictures[i]), R_OK) == 0, "%s is not there", pictures[i]);
    FILE *file = fopen(tool_path("rep/maps.csv"), "r");
    char line[400];
    int lines = 0;
    REQUIRE(file);
    while (fgets(line, sizeof line, file)) {
        int commas = 0;
        for (const char *at = line; *at; at++)
            commas += *at == ',';
        CHECK_MSG(commas == 12, "%d commas: %s", commas, line);
        lines++;
    }
    fclose(file);
    CHECK(lines == 6);
    slv_env env = test_env();
    size_t size;
    char *page = NULL;
    MUST(slv_text_load(&env, tool_path("rep/report.html"), &page, &size));
    CHECK(strstr(page, "id=\"maps\"") && strstr(page, "the short way (Tarini)") &&
          strstr(page, "no strategies") && strstr(page, "(4 faces)") && !strstr(page, "{{"));
    slv_free(page);
}

#define COMPARE                                                                                    \
    "compare %s.ptx --mesh %s.obj --uv waves.png --scheme bilinear --strategies clamp,traverse "   \
    "--msaa 4 --quick --frames 2 --reference-samples 16 --size 120x90 "

static void rounds(void) {
    static const stored tube[] = {{"uv-plain", 60, 32, 0},
                                  {"uv-duplicated", 65, 32, 4},
                                  {"uv-wrapped", 60, 32, 0},
                                  {"clamp", 60, 24, 84},
                                  {"traverse", 60, 24, 84}};
    static const stored torus[] = {{"uv-plain", 96, 32, 0},
                                   {"uv-duplicated", 117, 32, 20},
                                   {"uv-wrapped", 96, 32, 0},
                                   {"clamp", 96, 24, 192},
                                   {"traverse", 96, 24, 192}};
    write_shape("tube.obj", false, false);
    write_shape("torus.obj", true, false);
    CHECK(tool("bake tube.obj --uv waves.png --round u --scheme bilinear --size 32 -q -o "
               "tube.ptx") == 0);
    CHECK(tool("bake torus.obj --uv waves.png --round both --scheme bilinear --size 32 -q -o "
               "torus.ptx") == 0);
    CHECK_MSG(tool(COMPARE "--round u --azimuth 0 --orbit 40 --frames 3 -o rep", "tube", "tube") ==
                  0,
              "%s", tool_out);
    CHECK(strstr(tool_out, "beside maps") && strstr(tool_out, "uv-wrapped"));
    CHECK_MSG(!strstr(tool_out, "away from"), "%s", tool_out);
    check_frames("rep/report.json");
    json_t *maps = load_maps("rep/report.json");
    check_stored(maps, tube, 5);
    check_errors(maps, 0.15);
    CHECK(number(maps, "faces_over_end") == 4);
    json_decref(maps);
    check_files();
    CHECK_MSG(tool(COMPARE "--round both --azimuth 0 --orbit 40 -q -o rep2", "torus", "torus") == 0,
              "%s", tool_out);
    maps = load_maps("rep2/report.json");
    check_stored(maps, torus, 5);
    check_errors(maps, 0.1);
    CHECK(number(maps, "faces_over_end") == 8 + 12 - 1);
    json_decref(maps);
}

/* The tube with a texture coordinate for each corner of each face, off by a millionth or two. */
static void write_rounded(void) {
    FILE *file = fopen(tool_path("rounded.obj"), "w");
    REQUIRE(file);
    for (int y = 0; y <= HIGH; y++)
        for (int x = 0; x < AROUND; x++)
            fprintf(file, "v %.9g %.9g %.9g\n", sin(6.283185307179586 * x / AROUND), 0.5 * y - 1,
                    cos(6.283185307179586 * x / AROUND));
    for (int i = 0; i < 4 * AROUND * HIGH; i++) {
        int x = i / 4 % AROUND + (i % 4 == 1 || i % 4 == 2), y = i / 4 / AROUND + i % 4 / 2;
        fprintf(file, "vt %.6f %.6f\n", fmod((double)x / AROUND, 1) + 1e-6 * (i % 3 - 1),
                (double)y / HIGH + 1e-6 * (i * 7 % 5 - 2));
    }
    for (int i = 0; i < AROUND * HIGH; i++) {
        int x = i % AROUND, y = i / AROUND, a = 1 + y * AROUND + x,
            b = 1 + y * AROUND + (x + 1) % AROUND;
        fprintf(file, "f %d/%d %d/%d %d/%d %d/%d\n", a, 4 * i + 1, b, 4 * i + 2, b + AROUND,
                4 * i + 3, a + AROUND, 4 * i + 4);
    }
    REQUIRE(fclose(file) == 0);
}

/* A mesh as other programs write it has the same rows; without --round there is one of it. */
static void others(void) {
    static const stored twice[] = {
        {"uv", 65, 32, 0}, {"clamp", 65, 24, 80}, {"traverse", 65, 24, 80}};
    static const stored welded[] = {{"uv-plain", 60, 32, 0},
                                    {"uv-duplicated", 65, 32, 4},
                                    {"uv-wrapped", 60, 32, 0},
                                    {"clamp", 60, 24, 84},
                                    {"traverse", 60, 24, 84}};
    write_shape("twice.obj", false, true);
    write_rounded();
    CHECK(tool("wrap twice.obj welded.obj -q") == 0);
    CHECK(tool("bake twice.obj --uv waves.png --scheme bilinear --size 32 -q -o twice.ptx") == 0);
    CHECK(tool("bake welded.obj --uv waves.png --round u --scheme bilinear --size 32 -q -o "
               "welded.ptx") == 0);
    CHECK_MSG(tool(COMPARE "--reference none -q -o rep3", "twice", "twice") == 0, "%s", tool_out);
    json_t *maps = load_maps("rep3/report.json");
    check_stored(maps, twice, 3);
    CHECK(number(maps, "reference_frames") == 0);
    json_decref(maps);
    CHECK_MSG(tool(COMPARE "--round u --reference none -q -o rep4", "welded", "welded") == 0, "%s",
              tool_out);
    maps = load_maps("rep4/report.json");
    check_stored(maps, welded, 5);
    json_decref(maps);
    LACKS("selvage wrap");
    /* without welding nothing goes round, which is said */
    RUNS(0, COMPARE "--round u --reference none -q -o rep6", "twice", "twice");
    HAS("twice.obj: 5 of its vertices lie where others do");
    HAS("until 'selvage wrap' has joined them");
    /* coordinates that rounding has moved are counted as those that it has not */
    RUNS(0, "bake rounded.obj --uv waves.png --round u --scheme bilinear --size 32 -q -o "
            "rounded.ptx");
    RUNS(0, COMPARE "--round u --reference none -q -o rep7", "rounded", "rounded");
    maps = load_maps("rep7/report.json");
    check_stored(maps, welded, 5);
    json_decref(maps);
}

static void refused(void) {
    static const struct {
        int code;
        const char *options, *says;
    } cases[] = {
        {2, "compare tube.ptx --uv waves.png -o no", "--mesh"},
        {2, "compare tube.ptx --mesh tube.obj --round u -o no", "--uv"},
        {1, "compare tube.ptx --mesh tube.obj --uv none.png -o no", "none.png"},
        {1, "compare tube.ptx --mesh bare.obj --uv waves.png -o no", "texture coordinates"},
        {1, "compare tube.ptx --mesh tube.obj --uv alpha.png -o no", "has alpha"},
        {1, "compare tube.ptx --mesh tube.obj --uv 'w.<UDIM>.png' --round u -o no", "one image"},
        {1, "compare data.ptx --mesh tube.obj --uv waves.png -o no", "--texture-encoding"},
        {2, "render tube.obj --uv waves.png -s clamp -o no", "--strategy"},
    };
    write_image("alpha.png", 4, 0);
    FILE *from = fopen(tool_path("tube.obj"), "r"), *to = fopen(tool_path("bare.obj"), "w");
    char line[200];
    REQUIRE(from && to);
    while (fgets(line, sizeof line, from)) {
        int at[4];
        if (sscanf(line, "f %d/%*d %d/%*d %d/%*d %d/%*d", at, at + 1, at + 2, at + 3) == 4)
            fprintf(to, "f %d %d %d %d\n", at[0], at[1], at[2], at[3]);
        else if (line[1] == ' ')
            fputs(line, to);
    }
    fclose(from);
    fclose(to);
    CHECK(tool("bake tube.obj --surface position --size 4 -q -o data.ptx") == 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        int code = tool("%s", cases[i].options);
        CHECK_MSG(code == cases[i].code && strstr(tool_out, cases[i].says), "%s: %d: %s",
                  cases[i].options, code, tool_out);
        CHECK(access(tool_path("no"), F_OK) != 0);
    }
    /* a texture of something else is told of, and compared */
    CHECK(tool("new tube.obj other.ptx --fill '#000000' --size 4 -q") == 0);
    CHECK_MSG(tool(COMPARE "--round u --frames 1 -q -o rep5", "other", "tube") == 0, "%s",
              tool_out);
    CHECK_MSG(strstr(tool_out, "away from waves.png inside faces"), "%s", tool_out);
}

int main(void) {
    tool_begin();
    write_image("waves.png", 3, 0);
    rounds();
    others();
    refused();
    tool_end();
    return test_end();
}
