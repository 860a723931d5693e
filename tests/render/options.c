/* What options mean to pictures: colours, channels, views, and what is said of them. */
#include "kit/command_kit.h"
#include "kit/cube_kit.h"

#include <selvage/image.h>

static kit_scratch scratch;
static kit_run run;
static char ptx[KIT_PATH];

#define ARGUMENTS(...) ((const char *const[]){__VA_ARGS__, NULL})
#define SMALL "render", ptx, "--size", "24x16", "--msaa", "1", "--tess", "2"

/* The picture `name`, for slv_image_free. */
static slv_image load(const char *name) {
    char path[KIT_PATH];
    slv_image image = {0};
    REQUIRE(slv_image_load(NULL, kit_join(path, scratch.folder, name), &image) == SLV_OK);
    return image;
}

static void draw(const char *const *arguments, const char *warning) {
    kit_selvage(&scratch, NULL, arguments, &run);
    CHECK_MSG(run.code == 0, "exit code %d: %s", run.code, run.err);
    if (warning)
        CHECK_MSG(strstr(run.err, warning), "no '%s' in: %s", warning, run.err);
    else
        CHECK_MSG(!run.err[0], "%s", run.err);
    REQUIRE(run.code == 0);
}

/* The background of a picture, at its corner. */
static void check_colour(const char *word, const float expected[4]) {
    draw(ARGUMENTS(SMALL, "--background", word, "--bits", "32", "-o", "b.exr"), NULL);
    slv_image image = load("b.exr");
    for (int c = 0; c < 4; c++)
        CHECK_MSG(fabsf(image.pixels[c] - expected[c]) < 1e-4f, "%s: channel %d is %g, not %g",
                  word, c, (double)image.pixels[c], (double)expected[c]);
    slv_image_free(&image);
}

static void check_colours(void) {
    check_colour("red", (const float[]){1, 0, 0, 1});
    check_colour("none", (const float[]){0, 0, 0, 0});
    check_colour("1/2,0.25,0,0.5", (const float[]){0.25f, 0.125f, 0, 0.5f});
    check_colour("#ff8000", (const float[]){1, 0.215861f, 0, 1});
    check_colour("#0f0", (const float[]){0, 1, 0, 1});
}

/* The same list by names, numbers and ranges; and one channel shown as grey. */
static void check_channels(void) {
    static const char *const same[] = {"r,g,b", "rgb", "0-2", "R,1,b"};
    draw(ARGUMENTS(SMALL, "--shading", "unlit", "whole.exr"), NULL);
    slv_image whole = load("whole.exr");
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        draw(ARGUMENTS(SMALL, "--shading", "unlit", "--channels", same[i], "some.exr"), NULL);
        slv_image some = load("some.exr");
        CHECK_MSG(memcmp(whole.pixels, some.pixels, sizeof(float) * 4 * 24 * 16) == 0, "%s",
                  same[i]);
        slv_image_free(&some);
    }
    draw(ARGUMENTS(SMALL, "--shading", "unlit", "--channels", "b,g,r", "-o", "bgr.exr"), NULL);
    draw(ARGUMENTS(SMALL, "--shading", "unlit", "--channels", "g", "-o", "g.exr"), NULL);
    slv_image turned = load("bgr.exr"), grey = load("g.exr");
    bool differs = false;
    for (size_t i = 0; i < 4 * 24 * 16; i += 4) {
        const float *a = whole.pixels + i, *b = turned.pixels + i, *g = grey.pixels + i;
        CHECK(a[0] == b[2] && a[1] == b[1] && a[2] == b[0] && a[3] == b[3]);
        /* a driver decodes one channel more exactly than three */
        CHECK_MSG(g[1] == g[0] && g[2] == g[0] && fabsf(g[0] - a[1]) < 0.005f, "%g, not %g",
                  (double)g[0], (double)a[1]);
        differs |= a[0] != a[2];
    }
    CHECK(differs);
    slv_image_free(&whole);
    slv_image_free(&turned);
    slv_image_free(&grey);
}

/* Fields that nobody reads are named; what the command line says comes first; and a picture of
 * nothing does not pass for one of something. */
static void check_views(void) {
    static const char away[] =
        "{\"wold_to_camera\": [], \"size\": [24, 16], \"world_to_camera\": "
        "[[1,0,0,0],[0,1,0,0],[0,0,1,-9],[0,0,0,1]], \"projection\": \"perspective\", "
        "\"screen_window\": [8, 9, 8, 9], \"shading\": {\"model\": \"unlit\", \"kd2\": 1}}";
    char path[KIT_PATH];
    kit_write(kit_join(path, scratch.root, "away.json"), away, sizeof away - 1);
    draw(ARGUMENTS("render", ptx, "--msaa", "1", "--view", path, "-o", "away.png"),
         "nothing of the surface is in view");
    CHECK_MSG(strstr(run.err, "'wold_to_camera' is not used; did you mean 'world_to_camera'?"),
              "%s", run.err);
    CHECK_MSG(strstr(run.err, "'kd2' is not used; did you mean 'kd'?"), "%s", run.err);
    CHECK_MSG(kit_lines(run.err) == 0, "%s", run.err);
    kit_selvage(&scratch, NULL,
                ARGUMENTS("reference", ptx, "--samples", "2", "--view", path, "-o", "away.exr"),
                &run);
    CHECK_MSG(run.code == 0 && strstr(run.err, "nothing of the surface is in view"), "%s", run.err);
    kit_selvage(&scratch, NULL,
                ARGUMENTS("compare", ptx, "--quick", "--quiet", "--frames", "2", "--size", "64x48",
                          "--strategies", "clamp", "--view", path, "-o", "report"),
                &run);
    CHECK_MSG(run.code == 0 && kit_lines(run.err) == 0 &&
                  strstr(run.err, "away.json: nothing of the surface is in view"),
              "%s", run.err);
    static const char *const wins[][2] = {
        {"--azimuth", "30"}, {"--elevation", "20"}, {"--fov", "35"}};
    for (size_t i = 0; i < 3; i++) {
        kit_selvage(&scratch, NULL,
                    ARGUMENTS("render", ptx, "--msaa", "1", "--view", path, wins[i][0], wins[i][1],
                              "-o", "near.png"),
                    &run);
        CHECK_MSG(run.code == 0 && !strstr(run.err, "in view"), "%s: %s", wins[i][0], run.err);
    }
}

#define QUAD "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n"
#define EYE "\"world_to_camera\": [[1,0,0,0],[0,1,0,0],[0,0,1,-5],[0,0,0,1]]"
#define TANGENT "0.41421356237309503" /* of half 45 degrees */

/* The same picture by views that say the same. */
static void check_same_view(const char *text, const char *warning, const char *other,
                            const char *more, const char *value) {
    char path[2][KIT_PATH];
    kit_write(kit_join(path[0], scratch.root, "one.json"), text, strlen(text));
    kit_write(kit_join(path[1], scratch.root, "two.json"), other, strlen(other));
    draw(ARGUMENTS(SMALL, "--view", path[0], "one.exr"), warning);
    draw(ARGUMENTS(SMALL, "--view", path[1], "two.exr", more, value), NULL);
    slv_image one = load("one.exr"), two = load("two.exr");
    float apart = 0, seen = 0;
    for (size_t i = 0; i < 4 * 24 * 16; i++) {
        apart = fmaxf(apart, fabsf(one.pixels[i] - two.pixels[i]));
        seen = fmaxf(seen, one.pixels[i]);
    }
    CHECK_MSG(apart < 1e-3f && seen > 0.5f, "%s is %g from %s", text, (double)apart, other);
    slv_image_free(&one);
    slv_image_free(&two);
}

/* The field of view scales the window, gives one where there is none, and is of an orbit where
 * there is no camera. */
static void check_fov(void) {
    check_same_view("{" EYE ", \"fov\": 45, \"projection\": \"perspective\", \"screen_window\": "
                    "[-1.5, 1.5, -1, 1]}",
                    NULL,
                    "{" EYE ", \"projection\": \"perspective\", \"screen_window\": "
                    "[-0.621320343559643, 0.621320343559643, -" TANGENT ", " TANGENT "]}",
                    NULL, NULL);
    check_same_view("{" EYE ", \"fov\": 45}", NULL,
                    "{" EYE ", \"projection\": \"perspective\", \"screen_window\": "
                    "[-0.621320343559643, 0.621320343559643, -" TANGENT ", " TANGENT "]}",
                    NULL, NULL);
    check_same_view("{\"fov\": 20}", NULL, "{}", "--fov", "20");
    check_same_view("{\"fov\": 20, \"projection\": \"orthographic\"}",
                    "'fov' is not used without perspective", "{}", "--fov", "0");
    check_same_view("{\"fov\": 20, \"screen_window\": [0, 1, 0, 1]}",
                    "'screen_window' is not used without world_to_camera", "{}", "--fov", "20");
    check_same_view("{\"shading\": {\"model\": \"headlight-cos2\", \"ka\": 1, \"kd\": 0}}", NULL,
                    "{}", "--shading", "unlit");
}

/* An image of one colour lights as that colour everywhere; what does not go with a light is
 * refused. */
static void check_light(void) {
    static const char *const wrong[][5] = {
        {"--shading", "image", NULL, NULL, "--light IMAGE does"},
        {"--light-turn", "30", NULL, NULL, "--light names one"},
        {"--light", "white.exr", "--shading", "unlit", "--light is of --shading image"}};
    char path[KIT_PATH];
    slv_env env = test_env();
    slv_image white;
    REQUIRE(slv_image_create(&env, 8, 4, 3, &white) == SLV_OK);
    for (size_t i = 0; i < 3 * 8 * 4; i++)
        white.pixels[i] = 1;
    REQUIRE(slv_image_save(&env, kit_join(path, scratch.root, "white.exr"), &white, NULL) ==
            SLV_OK);
    slv_image_free(&white);
    check_same_view("{\"shading\": {\"model\": \"image\", \"light\": \"white.exr\"}}", NULL, "{}",
                    "--shading", "unlit");
    check_same_view("{\"shading\": {\"model\": \"image\", \"light\": \"white.exr\", \"turn\": 90}}",
                    NULL, "{}", "--light", path);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        kit_selvage(&scratch, NULL,
                    ARGUMENTS("render", ptx, "-o", "no.png", wrong[i][0], wrong[i][1], wrong[i][2],
                              wrong[i][3]),
                    &run);
        CHECK_MSG(run.code == 2 && strstr(run.err, wrong[i][4]), "%d: %s", run.code, run.err);
    }
}

/* Fields that cannot be meant are refused, each by a line that says why. */
static void check_refused_fields(void) {
    static const char *const fields[][2] = {
        {"\"size\": [32.5, 32]", "size is not two whole numbers"},
        {"\"fov\": 45, \"world_to_camera\": "
         "[[1,0,0,0],[0,1,0,0],[0,0,1,-5],[0,0,0,1],[0,0,0,1]]",
         "world_to_camera is not four rows of four numbers"},
        {"\"fov\": 45, \"world_to_camera\": [[1,0,0,0],[0,1,0,0],[0,0,1,-5]]",
         "world_to_camera is not four rows of four numbers"},
        {"\"size\": [32, 32], \"size\": [16, 16]", "duplicate object key near '\"size\"'"},
        {"\"shading\": \"unlit\"", "shading is not an object, such as {\"model\": \"unlit\"}"},
        {"\"shading\": {\"ka\": 1}", "shading: model is not one of the words"},
        {"\"shading\": {\"model\": \"unlti\"}", "unknown shading model 'unlti'"},
        {"\"shading\": {\"model\": \"image\"}", "light is not the name of an image"},
        {"\"shading\": {\"model\": \"image\", \"light\": \"a.exr\", \"turn\": \"x\"}",
         "turn is not"},
        {"\"alpha\": \"mask\"", "alpha is not an object, such as {\"mode\": \"mask\"}"},
        {"\"alpha\": {\"mode\": \"masc\"}", "alpha: unknown mode 'masc', expected"},
        {"\"alpha\": {\"mode\": 1}", "alpha: mode is not one of the words"},
        {"\"alpha\": {\"premultiplied\": 1}", "alpha: premultiplied is neither true nor false"}};
    char path[KIT_PATH], text[256];
    kit_join(path, scratch.root, "refused.json");
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        int length = snprintf(text, sizeof text, "{%s}", fields[i][0]);
        kit_write(path, text, (size_t)length);
        kit_selvage(&scratch, NULL, ARGUMENTS("render", ptx, "--view", path, "-o", "no.png"), &run);
        CHECK_MSG(run.code == 1 && strstr(run.err, fields[i][1]) && kit_lines(run.err) == 1,
                  "%s: %d: %s", text, run.code, run.err);
    }
}

/* What a view says of alpha is what options say, and these come first. */
static void check_alpha(void) {
    static const char *const same[][3] = {
        {"{\"alpha\": {\"mode\": \"mask\"}}", "--alpha", "mask"},
        {"{\"alpha\": {\"mode\": \"ignore\"}}", "--alpha", "ignore"},
        {"{\"alpha\": {\"premultiplied\": true}}", "--premultiplied", NULL}};
    char mesh[KIT_PATH], path[KIT_PATH], texture[KIT_PATH];
    kit_write(kit_join(mesh, scratch.root, "quad.obj"), QUAD, sizeof QUAD - 1);
    kit_join(texture, scratch.root, "alpha.ptx");
    kit_join(path, scratch.root, "alpha.json");
    kit_selvage(&scratch, NULL,
                ARGUMENTS("new", mesh, "-o", texture, "--channels", "4", "--alpha", "3", "--fill",
                          "0.7,0.4,0.2,0.6", "--size", "1x1"),
                &run);
    REQUIRE(run.code == 0);
    for (size_t i = 0; i < 3; i++) {
        float apart = 0;
        kit_write(path, same[i][0], strlen(same[i][0]));
        draw(ARGUMENTS("render", texture, "-m", mesh, "--size", "24x16", "--view", path, "one.exr"),
             NULL);
        draw(ARGUMENTS("render", texture, "-m", mesh, "--size", "24x16", "two.exr", same[i][1],
                       same[i][2]),
             NULL);
        draw(ARGUMENTS("render", texture, "-m", mesh, "--size", "24x16", "three.exr", "--view",
                       path, i == 2 ? "--premultiplied=no" : "--alpha=blend"),
             NULL);
        draw(ARGUMENTS("render", texture, "-m", mesh, "--size", "24x16", "four.exr"), NULL);
        slv_image pictures[4] = {load("one.exr"), load("two.exr"), load("three.exr"),
                                 load("four.exr")};
        for (size_t k = 0; k < 4 * 24 * 16; k++) {
            CHECK(pictures[0].pixels[k] == pictures[1].pixels[k]);
            CHECK(pictures[2].pixels[k] == pictures[3].pixels[k]);
            apart = fmaxf(apart, fabsf(pictures[0].pixels[k] - pictures[2].pixels[k]));
        }
        CHECK_MSG(apart > 0.1f, "%s: as without", same[i][0]);
        for (int k = 0; k < 4; k++)
            slv_image_free(&pictures[k]);
    }
    /* where nothing has any it is told, unless nobody asked */
    draw(ARGUMENTS(SMALL, "five.exr", "--alpha", "mask"),
         "has no alpha, so that --alpha mask changes nothing");
    draw(ARGUMENTS("render", texture, "-m", mesh, "--size", "24x16", "--channels", "rgb",
                   "five.exr", "--alpha", "mask"),
         "has no alpha, so that --alpha mask changes nothing");
    draw(ARGUMENTS(SMALL, "five.exr", "--alpha", "ignore"), NULL);
    draw(ARGUMENTS(SMALL, "five.exr"), NULL);
}

/* A group that is not there is answered with the nearest that is. */
static void check_focus(void) {
    static const char cube[] =
        "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
        "g creature\nf 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\ng ground\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    char path[KIT_PATH];
    kit_write(kit_join(path, scratch.root, "groups.obj"), cube, sizeof cube - 1);
    kit_selvage(&scratch, NULL,
                ARGUMENTS("render", ptx, "--mesh", path, "--focus", "creatur", "-o", "f.png"),
                &run);
    CHECK_MSG(run.code == 1 && strstr(run.err, "no group 'creatur' to focus on; did you mean "
                                               "'creature'?"),
              "%d: %s", run.code, run.err);
}

/* Even levels are what a file is looked up in whose reductions agree, unless it is said otherwise.
 */
static void check_even_levels(void) {
    static const char *const files[] = {"cube.ptx", "seamless.ptx"};
    char from[2][KIT_PATH];
    kit_join(from[0], scratch.root, files[0]);
    kit_join(from[1], scratch.root, files[1]);
    draw(ARGUMENTS("convert", from[0], from[1], "--reductions", "seamless", "--quiet"), NULL);
    for (int i = 0; i < 2; i++) {
        draw(ARGUMENTS("render", from[i], "--size", "12x12", "-q", "by_itself.exr"), NULL);
        draw(ARGUMENTS("render", from[i], "--size", "12x12", "-q", "e.exr", "--even-levels"), NULL);
        draw(ARGUMENTS("render", from[i], "--size", "12x12", "-q", "p.exr", "--even-levels", "no"),
             NULL);
        slv_image by_itself = load("by_itself.exr"), even = load("e.exr"), plain = load("p.exr");
        size_t size = sizeof(float) * 4 * 12 * 12;
        CHECK_MSG(memcmp(even.pixels, plain.pixels, size) != 0, "%s", files[i]);
        CHECK_MSG(memcmp(by_itself.pixels, i ? even.pixels : plain.pixels, size) == 0, "%s",
                  files[i]);
        slv_image_free(&by_itself);
        slv_image_free(&even);
        slv_image_free(&plain);
    }
}

/* Nothing is said of progress where nobody watches, unless somebody asks. */
static void check_progress(void) {
    kit_selvage(&scratch, NULL, ARGUMENTS("reference", ptx, "--size", "64", "-o", "p.exr"), &run);
    CHECK_MSG(run.code == 0 && !run.err[0], "%s", run.err);
    kit_selvage(&scratch, NULL,
                ARGUMENTS("reference", ptx, "--size", "64", "-o", "p.exr", "--progress"), &run);
    CHECK_MSG(run.code == 0 && strstr(run.err, "samples per pixel"), "%s", run.err);
}

int main(void) {
    kit_load_driver();
    kit_scratch_make(&scratch);
    cube_write(kit_join(ptx, scratch.root, "cube.ptx"));
    check_colours();
    check_channels();
    check_views();
    check_fov();
    check_light();
    check_refused_fields();
    check_alpha();
    check_focus();
    check_even_levels();
    check_progress();
    test_remove(scratch.root);
    return test_end();
}
