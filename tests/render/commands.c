/* The selvage command as a user meets it: what goes wrong is said in exactly one line, with the
 * right exit code, and leaves nothing behind; what goes right leaves exactly what was asked for. */
#include "kit/bake_kit.h"
#include "kit/command_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/bake.h>
#include <selvage/image.h>
#include <selvage/ptx.h>

#include <jansson.h>

static kit_scratch scratch;
static kit_run run;
static char inputs[KIT_PATH]; /* a folder beside the one that commands run in */
static char cube_obj[KIT_PATH], cube_ptx[KIT_PATH], other_obj[KIT_PATH], turned_obj[KIT_PATH];

static const char vertices[] =
    "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n";

#define ARGUMENTS(...) ((const char *const[]){__VA_ARGS__, NULL})

static void write_mesh(char *path, const char *name, const char *faces) {
    char text[1024];
    int length = snprintf(text, sizeof text, "%s%s", vertices, faces);
    kit_write(kit_join(path, inputs, name), text, (size_t)length);
}

static void make_inputs(void) {
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    slv_texture *texture = NULL;
    const slv_res res[6] = {{5, 5}, {5, 4}, {4, 4}, {4, 5}, {5, 5}, {3, 3}};
    slv_texture_desc desc = {6, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res, SLV_TEXTURE_LINEAR};
    slv_procedural noise = {.pattern = SLV_PATTERN_NOISE, .frequency = 2, .face_tint = 0.5f};
    REQUIRE(mkdir(kit_join(inputs, scratch.root, "inputs"), 0777) == 0);
    write_mesh(cube_obj, "cube.obj",
               "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
    write_mesh(other_obj, "open.obj", "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\n");
    /* the same cube, its third face started at another corner */
    write_mesh(turned_obj, "turned.obj",
               "f 1 3 4 2\nf 5 6 8 7\nf 2 6 5 1\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
    kit_join(cube_ptx, inputs, "cube.ptx");
    REQUIRE(slv_mesh_load(&env, cube_obj, &mesh) == SLV_OK);
    REQUIRE(slv_mesh_adjacency(&env, mesh, &adjacency) == SLV_OK);
    REQUIRE(slv_surface_create(&env, mesh, NULL, &surface) == SLV_OK);
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    REQUIRE(slv_bake_procedural(&env, surface, &noise, NULL, texture) == SLV_OK);
    REQUIRE(slv_ptx_save(&env, cube_ptx, texture, adjacency,
                         &(slv_ptx_write_params){.mesh = mesh}) == SLV_OK);
    slv_texture_destroy(texture);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
}

/* One line that holds every word of `words` (separated by |), this exit code, and an empty folder.
 */
static void check_refused(int code, const char *words, const char *const *environment,
                          const char *const *arguments) {
    char line[256] = "";
    for (int i = 0; arguments[i]; i++) {
        const char *slash = strrchr(arguments[i], '/');
        size_t length = strlen(line);
        snprintf(line + length, sizeof line - length, " %s", slash ? slash + 1 : arguments[i]);
    }
    kit_selvage(&scratch, environment, arguments, &run);
    CHECK_MSG(run.code == code, "selvage%s: exit code %d, expected %d: %s", line, run.code, code,
              run.err);
    CHECK_MSG(kit_lines(run.err) == 1, "selvage%s: %d lines, expected 1: %s", line,
              kit_lines(run.err), run.err);
    CHECK_MSG(run.out[0] == 0, "selvage%s: prints %s", line, run.out);
    CHECK_MSG(kit_count_files(scratch.folder) == 0, "selvage%s: leaves something behind", line);
    test_remove(scratch.folder); /* so that the next is judged by what it does itself */
    REQUIRE(mkdir(scratch.folder, 0777) == 0);
    for (const char *word = words; *word;) {
        char one[128];
        size_t length = strcspn(word, "|");
        snprintf(one, sizeof one, "%.*s", (int)length, word);
        CHECK_MSG(strstr(run.err, one), "selvage%s: no '%s' in: %s", line, one, run.err);
        word += length + (word[length] == '|');
    }
}

static void check_usage(void) {
    char strategies[512] = "";
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        size_t used = strlen(strategies);
        snprintf(strategies + used, sizeof strategies - used, "%s|", slv_strategy_at(s)->name);
    }
    const char *const bad[][4] = {{"--tess", "3", "power of two", NULL},
                                  {"--tess", "0", "2 to 128", NULL},
                                  {"--tess", "256", "2 to 128", NULL},
                                  {"--msaa", "3", "1, 2, 4 or 8", NULL},
                                  {"--msaa", "0", "--msaa", NULL},
                                  {"--msaa", "-4", "--msaa", NULL},
                                  {"--msaa", "4x", "--msaa", NULL},
                                  {"--bits", "12", "8 or 16", NULL},
                                  {"--strategy", "best", strategies, NULL},
                                  {"--context", "glx", "auto|egl|osmesa", NULL},
                                  {"--size", "0x5", "--size", NULL},
                                  {"--size", "5x", "--size", NULL},
                                  {"--size", "99999", "16384", NULL},
                                  {"--fov", "nan", "--fov", NULL},
                                  {"--fov", "171", "170", NULL},
                                  {"--azimuth", "north", "--azimuth", NULL},
                                  {"--background", "1,2", "--background", NULL},
                                  {"--aniso", "17", "16", NULL},
                                  {"--colour", "red", "--colour", NULL},
                                  {"--strategi", "clamp", "did you mean '--strategy'", NULL},
                                  {"--strat", "clamp", "did you mean '--strategy'", NULL},
                                  {"--strategy", "traverze", "did you mean 'traverse'", NULL},
                                  {"--background", "blu", "did you mean 'blue'", NULL},
                                  {"--channels", "", "--channels", NULL}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        check_refused(2, bad[i][2], NULL,
                      ARGUMENTS("render", cube_ptx, "-o", "out.png", bad[i][0], bad[i][1]));
    check_refused(2, "unknown verb|rendr|did you mean 'render'", NULL,
                  ARGUMENTS("rendr", cube_ptx));
    check_refused(2, "unknown verb|merg|did you mean 'merge'", NULL, ARGUMENTS("help", "merg"));
    check_refused(2, "did you mean 'hybrid'", NULL,
                  ARGUMENTS("compare", cube_ptx, "--strategies", "clamp,hibrid"));
    check_refused(2, "FILE.ptx", NULL, ARGUMENTS("render"));
    check_refused(2, "FILE.ptx", NULL, ARGUMENTS("compare"));
    check_refused(2, "FILE", NULL, ARGUMENTS("info"));
    check_refused(2, "--sheet|.png", NULL, ARGUMENTS("info", cube_ptx, "more"));
    check_refused(2, "unexpected|there already", NULL, ARGUMENTS("info", cube_ptx, cube_obj));
    check_refused(2, "two names|a.png|b.png", NULL,
                  ARGUMENTS("render", cube_ptx, "a.png", "-o", "b.png"));
    check_refused(2, "unexpected|b.png", NULL, ARGUMENTS("render", cube_ptx, "a.png", "b.png"));
    check_refused(2, "--mesh needs", NULL, ARGUMENTS("render", cube_ptx, "--mesh"));
    check_refused(2, "takes no value", NULL, ARGUMENTS("render", cube_ptx, "--raw=yes"));
    check_refused(2, "best|clamp", NULL,
                  ARGUMENTS("compare", cube_ptx, "--strategies", "clamp,best"));
    check_refused(2, "--strategies", NULL, ARGUMENTS("compare", cube_ptx, "--strategies", ""));
    check_refused(2, "power of two", NULL, ARGUMENTS("compare", cube_ptx, "--tess", "5"));
    kit_selvage(&scratch, NULL, (const char *const[]){NULL}, &run);
    CHECK(run.code == 2 && strstr(run.err, "Usage") && !run.out[0]);
}

static void check_view(const char *text, const char *words) {
    char view[KIT_PATH];
    kit_write(kit_join(view, inputs, "bad_view.json"), text, strlen(text));
    check_refused(1, words, NULL, ARGUMENTS("render", cube_ptx, "--view", view, "-o", "out.png"));
}

static void check_inputs_refused(void) {
    char path[KIT_PATH], triangles[KIT_PATH], data[KIT_PATH];
    const char *verbs[] = {"render", "compare", "info"};
    kit_join(path, inputs, "missing.ptx");
    for (int v = 0; v < 3; v++)
        check_refused(1, "missing.ptx|No such file", NULL, ARGUMENTS(verbs[v], path));
    check_refused(1, "missing.obj|No such file", NULL,
                  ARGUMENTS("render", cube_ptx, "--mesh", kit_join(path, inputs, "missing.obj")));
    check_refused(1, "inputs|not a regular file", NULL, ARGUMENTS("render", inputs));
    kit_write(kit_join(path, inputs, "empty.ptx"), "", 0);
    check_refused(1, "empty.ptx", NULL, ARGUMENTS("render", path));

    check_refused(1, "6 faces|5", NULL, ARGUMENTS("render", cube_ptx, "--mesh", other_obj));
    check_refused(1, "face 0|edge", NULL, ARGUMENTS("render", cube_ptx, "--mesh", turned_obj));
    check_refused(1, "face 0|edge", NULL,
                  ARGUMENTS("compare", cube_ptx, "--mesh", turned_obj, "--quick"));
    kit_join(data, kit_variable("SELVAGE_TESTS"), "conformance/data");
    kit_join(triangles, data, "tri_tiled_u8_1.ptx");
    check_refused(1, "tri_tiled_u8_1.ptx|triangle", NULL,
                  ARGUMENTS("render", triangles, "--mesh", cube_obj));
    check_refused(1, "tri_tiled_u8_1.ptx|no geometry|--mesh FILE.obj", NULL,
                  ARGUMENTS("render", triangles));
    check_refused(1, "tri_tiled_u8_1.ptx|no geometry", NULL, ARGUMENTS("compare", triangles));
    kit_join(path, data, "const_u8_3.ptx");
    check_refused(1, "const_u8_3.ptx|no geometry|--mesh FILE.obj", NULL, ARGUMENTS("render", path));

    check_view("{", "bad_view.json");
    check_view("[]", "bad_view.json|object");
    check_view("{\"size\": [0, 5]}", "bad_view.json|size");
    check_view("{\"size\": \"big\"}", "bad_view.json|size");
    check_view("{\"fov\": 180}", "bad_view.json|fov");
    check_view("{\"fov\": \"wide\"}", "bad_view.json|fov");
    check_view("{\"world_to_camera\": [[1, 0], [0, 1]]}", "bad_view.json|world_to_camera");
    check_view("{\"world_to_camera\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]], \"projection\": "
               "\"fisheye\"}",
               "bad_view.json|projection");
    check_view("{\"world_to_camera\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]], \"projection\": "
               "\"orthographic\","
               " \"screen_window\": [1, -1, -1, 1]}",
               "bad_view.json|screen_window");
    check_view("{\"shading\": {\"model\": \"toon\"}}", "bad_view.json|toon");
    check_view("{\"boundary\": \"soft\"}", "bad_view.json|soft");
    check_view("{\"scheme\": \"lopp\"}", "bad_view.json|lopp");
    check_refused(1, "missing.json", NULL,
                  ARGUMENTS("render", cube_ptx, "--view", kit_join(path, inputs, "missing.json")));
    check_refused(2, "'3'|channels 0 to 2|r, g, b", NULL,
                  ARGUMENTS("render", cube_ptx, "--channels", "3", "-o", "out.png"));
    check_refused(2, "'a'|channels 0 to 2", NULL,
                  ARGUMENTS("render", cube_ptx, "--channels", "r,a", "-o", "out.png"));
    check_refused(2, "at most 4", NULL,
                  ARGUMENTS("render", cube_ptx, "--channels", "rgbrg", "-o", "out.png"));
    check_refused(1, "64 samples", NULL,
                  ARGUMENTS("render", cube_ptx, "--msaa", "64", "-o", "out.png"));
}

/* Damaged copies of a good file. */
static void check_damage(void) {
    size_t size;
    char path[KIT_PATH], *data = kit_read(cube_ptx, &size);
    kit_join(path, inputs, "damaged.ptx");
    /* the last 8 bytes of such a file are zeros that nothing needs */
    const size_t cuts[] = {3,   40,       63,       64,           70,         128,
                           200, size / 4, size / 2, size * 3 / 4, size - 200, size - 9};
    for (size_t i = 0; i < sizeof cuts / sizeof *cuts; i++) {
        kit_write(path, data, cuts[i]);
        check_refused(1, "damaged.ptx", NULL,
                      ARGUMENTS("render", path, "--mesh", cube_obj, "-o", "out.png"));
    }
    /* words of the header: magic, version, mesh type, data type, channels and levels, faces, sizes
     * of blocks */
    static const struct {
        size_t at;
        uint32_t value;
    } words[] = {{0, 0x21212121},  {4, 99},          {8, 7},           {12, 9},
                 {20, 0},          {24, 0x7fffffff}, {24, 0xffffffff}, {28, 0xfffffff0},
                 {32, 0xfffffff0}, {36, 0xfffffff0}, {40, 0xfffffff0}, {48, 0xfffffff0},
                 {52, 0xfffffff0}, {56, 0xfffffff0}, {60, 0xfffffff0}};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        char *copy = malloc(size);
        REQUIRE(copy);
        memcpy(copy, data, size);
        for (int b = 0; b < 4; b++)
            copy[words[i].at + (size_t)b] = (char)(words[i].value >> 8 * b);
        kit_write(path, copy, size);
        free(copy);
        check_refused(1, "damaged.ptx", NULL,
                      ARGUMENTS("render", path, "--mesh", cube_obj, "-o", "out.png"));
    }
    free(data);
}

static void check_outputs_refused(void) {
    char path[KIT_PATH], folder[KIT_PATH];
    check_refused(1, "nowhere/out.png", NULL,
                  ARGUMENTS("render", cube_ptx, "-o", "nowhere/out.png"));
    check_refused(1, "nowhere/out.exr", NULL,
                  ARGUMENTS("render", cube_ptx, "-o", "nowhere/out.exr"));
    check_refused(2, "inputs", NULL, ARGUMENTS("render", cube_ptx, "-o", inputs));
    REQUIRE(mkdir(kit_join(folder, inputs, "folder.png"), 0777) == 0);
    check_refused(1, "folder.png", NULL, ARGUMENTS("render", cube_ptx, "-o", folder));
    CHECK(kit_count_files(folder) == 0);
    check_refused(2, "/dev/full", NULL, ARGUMENTS("render", cube_ptx, "-o", "/dev/full"));
    check_refused(2, "out.jpg|.png", NULL, ARGUMENTS("render", cube_ptx, "-o", "out.jpg"));
    check_refused(1, "nowhere", NULL,
                  ARGUMENTS("compare", cube_ptx, "--quick", "--out", "nowhere/report"));
    check_refused(1, "cube.obj", NULL,
                  ARGUMENTS("compare", cube_ptx, "--quick", "--out", cube_obj));
    int before = kit_count_files(inputs);
    kit_join(path, cube_obj, "out.png");
    check_refused(1, "out.png", NULL, ARGUMENTS("render", cube_ptx, "-o", path));
    CHECK(kit_count_files(inputs) == before);
}

/* A machine without any OpenGL: EGL finds no driver, and what is called libOSMesa is no library. */
static void check_no_context(void) {
    static const char *const names[] = {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};
    static char library_path[KIT_PATH + 32];
    char folder[KIT_PATH], path[KIT_PATH];
    const char *environment[] = {"__EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent", library_path, NULL};
    REQUIRE(mkdir(kit_join(folder, scratch.root, "libraries"), 0777) == 0);
    for (int i = 0; i < 3; i++)
        kit_write(kit_join(path, folder, names[i]), "not a library", 13);
    snprintf(library_path, sizeof library_path, "LD_LIBRARY_PATH=%s", folder);
    check_refused(1, "no usable OpenGL context|EGL|OSMesa", environment,
                  ARGUMENTS("render", cube_ptx, "-o", "out.png"));
    check_refused(1, "no usable OpenGL context|EGL", environment,
                  ARGUMENTS("render", cube_ptx, "-o", "out.png", "--context", "egl"));
    check_refused(1, "no usable OpenGL context|OSMesa", environment,
                  ARGUMENTS("render", cube_ptx, "-o", "out.png", "--context", "osmesa"));
    check_refused(1, "no usable OpenGL context", environment,
                  ARGUMENTS("compare", cube_ptx, "--quick", "--quiet", "--out", "report"));
    /* what needs none works without */
    kit_selvage(&scratch, environment, ARGUMENTS("info", cube_ptx), &run);
    CHECK(run.code == 0 && strstr(run.out, "6"));
}

/* Runs a good render and loads its picture. */
static slv_image picture(const char *name, const char *const *arguments) {
    slv_env env = test_env();
    slv_image image = {0};
    char path[KIT_PATH];
    kit_selvage(&scratch, NULL, arguments, &run);
    CHECK_MSG(run.code == 0 && kit_lines(run.err) == 0, "%s: exit code %d: %s", name, run.code,
              run.err);
    CHECK_MSG(kit_count_files(scratch.folder) == 1, "%s: %d files", name,
              kit_count_files(scratch.folder));
    REQUIRE(slv_image_load(&env, kit_join(path, scratch.folder, name), &image) == SLV_OK);
    CHECK(unlink(path) == 0);
    return image;
}

static float largest_difference(const slv_image *a, const slv_image *b) {
    float largest = 0;
    REQUIRE(a->width == b->width && a->height == b->height && a->nchannels == b->nchannels);
    for (size_t i = 0; i < (size_t)a->width * a->height * a->nchannels; i++)
        largest = fmaxf(largest, fabsf(a->pixels[i] - b->pixels[i]));
    return largest;
}

static void check_pictures(void) {
    slv_image byte, word, half, whole, other;
    byte = picture("cube.png", ARGUMENTS("render", cube_ptx, "--raw"));
    CHECK(byte.width == 512 && byte.height == 512 && byte.nchannels == 4);
    CHECK(strstr(run.out, "cube.png") && strstr(run.out, "traverse"));
    word = picture("word.png",
                   ARGUMENTS("render", cube_ptx, "word.png", "--raw", "--bits", "16", "-q"));
    CHECK(run.out[0] == 0);
    half = picture("half.exr", ARGUMENTS("render", cube_ptx, "--out", "half.exr"));
    whole = picture("whole.exr", ARGUMENTS("render", cube_ptx, "--out=whole.exr", "--bits=32"));
    CHECK(largest_difference(&byte, &whole) <= 0.51f / 255 + 1e-3f &&
          largest_difference(&byte, &whole) > 0);
    CHECK(largest_difference(&word, &whole) <= 1e-3f); /* 8 and 16 bit are drawn in half */
    CHECK(largest_difference(&half, &whole) <= 1e-3f && largest_difference(&half, &whole) > 0);
    slv_image_free(&word);
    slv_image_free(&half);
    slv_image_free(&whole);

    other =
        picture("a.png", ARGUMENTS("render", cube_ptx, "-o", "a.png", "--raw", "--context", "egl"));
    CHECK(largest_difference(&byte, &other) <= 1.01f / 255);
    slv_image_free(&other);
    other = picture("a.png",
                    ARGUMENTS("render", cube_ptx, "-o", "a.png", "--raw", "--context", "osmesa"));
    CHECK(largest_difference(&byte, &other) <= 1.01f / 255);
    slv_image_free(&other);
    other = picture("a.png", ARGUMENTS("render", cube_ptx, "-o", "a.png", "--raw", "--mesh",
                                       cube_obj, "--threads", "1"));
    CHECK(largest_difference(&byte, &other) == 0);
    slv_image_free(&other);
    other = picture("a.png", ARGUMENTS("render", cube_ptx, "-o", "a.png", "--size", "64x32",
                                       "--background", "1,0,0", "--strategy", "discard", "--aniso",
                                       "16", "--azimuth", "200"));
    CHECK(other.width == 64 && other.height == 32 && fabsf(other.pixels[0] - 1) < 1e-3f &&
          other.pixels[1] == 0);
    slv_image_free(&other);
    /* a mesh that does not fit can be insisted on, and an output is replaced */
    char existing[KIT_PATH];
    kit_write(kit_join(existing, scratch.folder, "a.png"), "old", 3);
    other = picture("a.png", ARGUMENTS("render", cube_ptx, "-o", "a.png", "--mesh", turned_obj,
                                       "--adjacency", "mesh"));
    slv_image_free(&other);
    slv_image_free(&byte);
}

static json_t *parse_output(const char *what) {
    json_error_t error;
    json_t *root = json_loads(run.out, 0, &error);
    CHECK_MSG(run.code == 0 && kit_lines(run.err) == 0, "%s: exit code %d: %s", what, run.code,
              run.err);
    CHECK_MSG(root, "%s: line %d: %s", what, error.line, error.text);
    REQUIRE(root);
    return root;
}

static void check_info(void) {
    kit_selvage(&scratch, NULL, ARGUMENTS("info", cube_ptx), &run);
    CHECK(run.code == 0 && !run.err[0] && strstr(run.out, "cube.ptx") && strstr(run.out, "uint8"));
    kit_selvage(&scratch, NULL, ARGUMENTS("info", cube_ptx, "--list-faces", "--meta"), &run);
    CHECK(run.code == 0 && !run.err[0] && strstr(run.out, "PtexVertPositions"));
    kit_selvage(&scratch, NULL, ARGUMENTS("info", cube_obj), &run);
    CHECK(run.code == 0 && !run.err[0] && strstr(run.out, "cube.obj"));
    const char *files[] = {cube_ptx, cube_obj};
    for (int i = 0; i < 2; i++) {
        kit_selvage(&scratch, NULL, ARGUMENTS("info", files[i], "--json", "--list-faces"), &run);
        json_t *root = parse_output("info --json");
        const json_t *faces = json_object_get(root, "faces");
        CHECK(json_array_size(faces) == 6 || json_integer_value(faces) == 6);
        json_decref(root);
    }
    kit_selvage(&scratch, NULL, ARGUMENTS("--version"), &run);
    CHECK(run.code == 0 && strncmp(run.out, "selvage ", 8) == 0);
    CHECK(kit_count_files(scratch.folder) == 0);
}

/* What render says of its pictures is what they are. */
static void check_render_json(void) {
    static const char *const ways[][5] = {{"-o", "one.png", NULL},
                                          {"-o", "ids.exr", "--pass", "ids", NULL},
                                          {"-o", "round.png", "--turntable", "2", NULL}};
    for (size_t i = 0; i < 3; i++) {
        const char *const *w = ways[i];
        kit_selvage(&scratch, NULL,
                    ARGUMENTS("render", cube_ptx, "--json", "--size", "48x32", w[0], w[1], w[2],
                              w[2] ? w[3] : NULL),
                    &run);
        json_t *root = parse_output("render --json"), *pictures = json_object_get(root, "pictures");
        const bool ids = i == 1;
        CHECK(strcmp(json_string_value(json_object_get(root, "pass")), ids ? "ids" : "color") == 0);
        CHECK(json_is_string(json_object_get(root, "renderer")) == !ids);
        CHECK((json_integer_value(json_object_get(root, "gpu_bytes")) > 0) == !ids);
        CHECK(json_array_size(pictures) == (i == 2 ? 2 : 1));
        double seconds = 0;
        for (size_t k = 0; k < json_array_size(pictures); k++) {
            const json_t *picture = json_array_get(pictures, k);
            char path[KIT_PATH];
            slv_image image = {0};
            kit_join(path, scratch.folder, json_string_value(json_object_get(picture, "picture")));
            CHECK(slv_image_load(NULL, path, &image) == SLV_OK && image.width == 48 &&
                  json_integer_value(json_object_get(picture, "width")) == 48 &&
                  json_integer_value(json_object_get(picture, "height")) == image.height);
            CHECK((json_integer_value(json_object_get(picture, "triangles")) >= 12) == !ids);
            CHECK(json_is_false(json_object_get(picture, "empty")));
            seconds += json_number_value(json_object_get(picture, "seconds"));
            slv_image_free(&image);
        }
        CHECK(seconds > 0 && seconds <= json_number_value(json_object_get(root, "seconds")));
        json_decref(root);
    }
    test_remove(scratch.folder);
    REQUIRE(mkdir(scratch.folder, 0777) == 0);
}

static void check_report(void) {
    static const char *const names[] = {"clamp", "traverse", "discard"};
    static const char *const numbers[] = {
        "median_ms", "min_ms",       "max_ms", "time_ratio", "texel_bytes",
        "gpu_bytes", "memory_ratio", "pools",  "batches",    "widened_faces"};
    char path[KIT_PATH], file[64];
    json_error_t error;
    kit_selvage(&scratch, NULL,
                ARGUMENTS("compare", cube_ptx, "--mesh", cube_obj, "--quick", "--out", "report",
                          "--size", "160x96", "--frames", "2", "--strategies",
                          "clamp,traverse,discard", "--json"),
                &run);
    CHECK_MSG(run.code == 0 && kit_lines(run.err) == 0, "compare: exit code %d: %s", run.code,
              run.err);
    REQUIRE(run.code == 0 && kit_count_files(scratch.folder) == 1);
    char report[KIT_PATH];
    kit_join(report, scratch.folder, "report");
    json_t *root = json_load_file(kit_join(path, report, "report.json"), 0, &error);
    REQUIRE(root);
    json_t *said = parse_output("compare --json"), *name = json_object_get(said, "report");
    CHECK(name && strcmp(json_string_value(name), "report/report.html") == 0);
    json_object_del(said, "report");
    CHECK(json_object_size(said) == json_object_size(root) &&
          json_array_size(json_object_get(said, "strategies")) == 3);
    CHECK(json_equal(json_object_get(said, "advice"), json_object_get(root, "advice")));
    json_decref(said);
    CHECK(json_integer_value(json_object_get(root, "faces")) == 6);
    CHECK(json_is_string(json_object_get(json_object_get(root, "conditions"), "renderer")));
    CHECK(json_integer_value(json_object_get(json_object_get(root, "conditions"), "width")) == 160);
    CHECK(json_integer_value(json_object_get(json_object_get(root, "conditions"), "frames")) == 2);
    CHECK(json_array_size(json_object_get(root, "pairs")) == 3);
    CHECK(json_is_array(json_object_get(root, "spots")));
    const json_t *rows = json_object_get(root, "strategies");
    REQUIRE(json_array_size(rows) == 3);
    for (size_t s = 0; s < 3; s++) {
        const json_t *row = json_array_get(rows, s), *seams = json_object_get(row, "seams");
        CHECK(strcmp(json_string_value(json_object_get(row, "name")), names[s]) == 0);
        for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++)
            CHECK_MSG(json_is_number(json_object_get(row, numbers[n])), "report.json: no %s",
                      numbers[n]);
        CHECK(json_number_value(json_object_get(row, "median_ms")) > 0);
        CHECK(json_number_value(json_object_get(row, "memory_ratio")) > 1);
        CHECK(json_array_size(seams) > 1 &&
              json_is_number(json_object_get(json_array_get(seams, 0), "max")));
        snprintf(file, sizeof file, "view0_%s.png", names[s]);
        slv_image image = {0};
        CHECK(slv_image_load(NULL, kit_join(path, report, file), &image) == SLV_OK &&
              image.width == 160);
        slv_image_free(&image);
    }
    json_decref(root);
    CHECK(kit_exists(report, "difference_clamp_traverse.png"));
    size_t size;
    char *page = kit_read(kit_join(path, report, "report.html"), &size);
    CHECK(size > 10000 && strstr(page, "</html>") && strstr(page, "data:image/png;base64,"));
    CHECK(!strstr(page, "http://") && !strstr(page, "src=\"http")); /* needs no network */
    free(page);
    test_remove(report);
}

/* One face has no seams, and its pixels are not of every kind: what is not there is not a number,
 * and no report says so in those words. */
static void check_single_face(void) {
    static const char obj[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    static const char *const files[] = {"report.json", "report.html", "compression.csv"};
    const slv_res res = {0, 0};
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE, .frequency = 2};
    char ptx[KIT_PATH], report[KIT_PATH], path[KIT_PATH];
    bake_write(kit_join(ptx, scratch.root, "single.ptx"), obj, SLV_SCHEME_BILINEAR, 1, &res,
               &noise);
    kit_selvage(&scratch, NULL,
                ARGUMENTS("compare", ptx, "--quick", "--out", "report", "--size", "96x64",
                          "--frames", "2", "--tess", "2", "--compress", "--strategies",
                          "clamp,traverse,discard"),
                &run);
    CHECK_MSG(run.code == 0, "compare: exit code %d: %s", run.code, run.err);
    REQUIRE(run.code == 0);
    CHECK_MSG(!strstr(run.out, "nan") && strstr(run.out, "none"), "%s", run.out);
    kit_join(report, scratch.folder, "report");
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char *text = kit_read(kit_join(path, report, files[i]), NULL);
        CHECK_MSG(!strstr(text, "(nan") && !strstr(text, ">nan") && !strstr(text, ",nan"),
                  "%s: nan", files[i]);
        free(text);
    }
    char *csv = kit_read(kit_join(path, report, "compression.csv"), NULL);
    const char *row = strstr(csv, "\nclamp,");
    CHECK_MSG(row && strstr(row, ",,\n"), "seam jumps without seams: %s", csv);
    free(csv);
    test_remove(report);
}

/* Every option that help shows is one that the verb takes: without a value, or without a file to
 * work on, something else is wrong with the line. */
static void check_options_taken(const char *verb, const char *help) {
    int count = 0;
    for (const char *at = help; (at = strstr(at, "\n  --")); count++) {
        char option[64];
        at += 3;
        snprintf(option, sizeof option, "%.*s", (int)strcspn(at, " \n"), at);
        if (strcmp(option, "--help") == 0 || test_skip((uint32_t)count, 3))
            continue;
        kit_selvage(&scratch, NULL, ARGUMENTS(verb, option), &run);
        CHECK_MSG(run.code == 2 && !strstr(run.err, "unknown option"),
                  "selvage %s --help shows %s, which gives %d: %s", verb, option, run.code,
                  run.err);
    }
    CHECK_MSG(count > 1, "selvage %s --help shows %d options", verb, count);
}

/* Every option in the examples of a verb is one that its help shows. */
static void check_examples(const char *verb, const char *help) {
    const char *end = strstr(help, "\nExamples:\n");
    char line[80], option[64];
    for (const char *at = end; at && (at = strstr(at, " --"));) {
        snprintf(option, sizeof option, "%.*s", (int)strcspn(at + 1, " =\n\\"), at + 1);
        snprintf(line, sizeof line, "\n  %s ", option);
        at += strlen(option);
        const char *shown = strstr(help, line);
        CHECK_MSG(shown && shown < end, "selvage %s: an example has %s", verb, option);
    }
}

static void check_verb_help(const char *verb) {
    kit_selvage(&scratch, NULL, ARGUMENTS(verb, "--help"), &run);
    CHECK(run.code == 0 && !run.err[0] && strstr(run.out, "Usage") && strstr(run.out, "Examples"));
    char *help = strdup(run.out);
    REQUIRE(help);
    for (const char *line = help; *line; line += strcspn(line, "\n") + 1)
        CHECK_MSG(strcspn(line, "\n") <= 80, "selvage %s --help: %.*s", verb,
                  (int)strcspn(line, "\n"), line);
    CHECK(strstr(help, "\nExit codes: 0 "));
    check_options_taken(verb, help);
    check_examples(verb, help);
    free(help);
    kit_selvage(&scratch, NULL, ARGUMENTS(verb, "-h"), &run);
    CHECK(run.code == 0);
    kit_selvage(&scratch, NULL, ARGUMENTS("help", verb), &run);
    CHECK(run.code == 0 && !run.err[0] && strstr(run.out, "Usage"));
}

static void check_help(void) {
    static const char title[] = "Verbs:\n";
    int count = 0;
    kit_selvage(&scratch, NULL, ARGUMENTS("--help"), &run);
    CHECK(run.code == 0 && !run.err[0]);
    const char *found = strstr(run.out, title);
    REQUIRE(found);
    for (const char *line = run.out; *line; line += strcspn(line, "\n") + 1)
        CHECK_MSG(strcspn(line, "\n") <= 80, "selvage --help: %.*s", (int)strcspn(line, "\n"),
                  line);
    char *list = strdup(found + sizeof title - 1);
    REQUIRE(list);
    for (const char *line = list; strncmp(line, "  ", 2) == 0; count++) {
        char verb[32];
        snprintf(verb, sizeof verb, "%.*s", (int)strcspn(line + 2, " \n"), line + 2);
        check_verb_help(verb);
        line += strcspn(line, "\n") + 1;
    }
    CHECK_MSG(count >= 3, "%d verbs", count);
    free(list);
}

int main(void) {
    kit_scratch_make(&scratch);
    make_inputs();
    check_help();
    check_usage();
    check_inputs_refused();
    check_damage();
    check_outputs_refused();
    check_no_context();
    check_info();
    check_pictures();
    check_render_json();
    check_report();
    check_single_face();
    test_remove(scratch.root);
    return test_end();
}
