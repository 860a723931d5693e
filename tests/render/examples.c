/* The programs of docs/examples, as a stranger would run them. */
#include "kit/bake_kit.h"
#include "kit/command_kit.h"

#include <selvage/gl_strategy.h>

#include <selvage/image.h>

static kit_scratch scratch;
static kit_run run;

static void run_example(const char *name, const char *const *arguments) {
    char program[KIT_PATH];
    const char *argv[8] = {kit_join(program, kit_variable("SELVAGE_BIN"), name)};
    for (int i = 0; arguments[i]; i++)
        argv[i + 1] = arguments[i];
    kit_run_program(&scratch, NULL, argv, &run);
}

/* A closed shape with a pentagon on either side. */
static const char prism[] =
    "v 1 0 -0.6\nv 0.31 0.95 -0.6\nv -0.81 0.59 -0.6\nv -0.81 -0.59 -0.6\nv 0.31 -0.95 -0.6\n"
    "v 1 0 0.6\nv 0.31 0.95 0.6\nv -0.81 0.59 0.6\nv -0.81 -0.59 0.6\nv 0.31 -0.95 0.6\n"
    "f 5 4 3 2 1\nf 6 7 8 9 10\nf 1 2 7 6\nf 2 3 8 7\nf 3 4 9 8\nf 4 5 10 9\nf 5 1 6 10\n";

static void write_prism(const char *path) {
    FILE *stream = fopen(path, "w");
    REQUIRE(stream && fputs(prism, stream) >= 0 && fclose(stream) == 0);
}

/* Coloured by position. */
static void make_texture(const char *path) {
    const slv_procedural position = {
        .pattern = SLV_PATTERN_POSITION, .frequency = 0.5f, .offset = {-1, -1, -1}};
    slv_res res[15];
    for (int f = 0; f < 15; f++)
        res[f] = f < 10 ? (slv_res){3, 3} : (slv_res){4, 5};
    bake_write(path, prism, SLV_SCHEME_CATMARK, 15, res, &position);
}

/* Red grows to the right and green upwards, as the positions do. */
static void check_picture(const char *path, const char *name) {
    slv_env env = test_env();
    slv_image image = {0};
    uint32_t covered = 0;
    double sums[2][2][2] = {{{0}}}; /* channel, half of the picture, sum and count */
    REQUIRE(slv_image_load(&env, path, &image) == SLV_OK);
    REQUIRE(image.width == 512 && image.height == 512 && image.nchannels == 4);
    for (uint32_t y = 0; y < 512; y++) {
        for (uint32_t x = 0; x < 512; x++) {
            const float *pixel = image.pixels + ((size_t)y * 512 + x) * 4;
            if (pixel[3] < 1)
                continue;
            covered++;
            double *half[2] = {sums[0][x >= 256], sums[1][y < 256]};
            for (int c = 0; c < 2; c++) {
                half[c][0] += (double)pixel[c];
                half[c][1]++;
            }
        }
    }
    CHECK_MSG(covered > 512 * 512 / 8 && covered < 512 * 512 * 9 / 10, "%s: %u pixels are covered",
              name, covered);
    for (int c = 0; c < 2; c++) {
        double low = sums[c][0][0] / sums[c][0][1], high = sums[c][1][0] / sums[c][1][1];
        CHECK_MSG(high > low + 0.1, "%s: channel %d goes from %.2f to %.2f", name, c, low, high);
    }
    slv_image_free(&image);
}

/* How many pixels are red: painted and shining. */
static double reddest(const char *path) {
    slv_env env = test_env();
    slv_image image = {0};
    double count = 0;
    REQUIRE(slv_image_load(&env, path, &image) == SLV_OK);
    for (size_t i = 0; i < (size_t)image.width * image.height; i++)
        count += image.pixels[4 * i] > 0.9f && image.pixels[4 * i + 1] < 0.6f &&
                 image.pixels[4 * i + 2] < 0.6f && image.pixels[4 * i + 3] > 0.9f;
    slv_image_free(&image);
    return count;
}

/* Painted or not. */
static void check_viewer(const char *ptx) {
    char png[KIT_PATH];
    for (int frames = 0; frames <= 8; frames += 8) {
        static double reddish[2];
        const char *number = frames ? "8" : "0";
        unsigned long long bytes = 1;
        int shown = -1;
        kit_join(png, scratch.folder, "viewer.png");
        run_example("example_viewer", (const char *const[]){ptx, png, number, NULL});
        CHECK_MSG(run.code == 0 && !run.err[0] &&
                      sscanf(run.out, "%d frames, %llu bytes", &shown, &bytes) == 2 &&
                      shown == frames && (bytes > 0) == (frames > 0),
                  "viewer says: %s%s", run.out, run.err);
        reddish[frames > 0] = reddest(png);
        CHECK_MSG(!frames || reddish[1] > reddish[0] + 500, "%g pixels are red, before %g",
                  reddish[1], reddish[0]);
    }
}

/* A checked ball under a white sky: dark and light squares, and nothing brighter than the sky. */
static void check_traced(const char *path) {
    slv_env env = test_env();
    slv_image image = {0};
    uint32_t sky = 0, dark = 0, light = 0;
    REQUIRE(slv_image_load(&env, path, &image) == SLV_OK);
    REQUIRE(image.width == 128 && image.height == 128 && image.nchannels == 3);
    for (uint32_t i = 0; i < 128 * 128; i++) {
        const float *pixel = image.pixels + 3 * (size_t)i;
        sky += pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1;
        dark += pixel[0] < 0.52f; /* 0.2, as sRGB */
        light += pixel[0] > 0.7f && pixel[0] < 0.97f;
    }
    CHECK_MSG(sky > 8000 && sky < 15000 && dark > 700 && light > 700,
              "%u pixels of sky, %u dark, %u light", sky, dark, light);
    slv_image_free(&image);
}

int main(void) {
    char ptx[KIT_PATH], missing[KIT_PATH], png[KIT_PATH];
    kit_scratch_make(&scratch);
    make_texture(kit_join(ptx, scratch.folder, "prism.ptx"));
    kit_join(missing, scratch.folder, "missing.ptx");

    run_example("example_hello", (const char *const[]){ptx, NULL});
    CHECK_MSG(run.code == 0 && !run.err[0], "hello ended with %d: %s", run.code, run.err);
    CHECK_MSG(strcmp(run.out, "15 faces, 3 channels of uint8\n") == 0, "hello says: %s", run.out);
    run_example("example_hello", (const char *const[]){missing, NULL});
    CHECK(run.code == 1 && !run.out[0]);

    double means[3] = {-1, -2, -3};
    run_example("example_sample", (const char *const[]){ptx, NULL});
    CHECK_MSG(run.code == 0 && !run.err[0], "sample ended with %d: %s", run.code, run.err);
    CHECK_MSG(sscanf(run.out, "one by one %lf batched %lf sorted %lf 15 faces, 45 lookups",
                     &means[0], &means[1], &means[2]) == 3 &&
                  means[0] > 0.3 && means[0] < 0.7 && means[0] == means[1] &&
                  means[0] == means[2] && strstr(run.out, "15 faces, 45 lookups, "),
              "sample says: %s", run.out);
    run_example("example_sample", (const char *const[]){missing, NULL});
    CHECK(run.code == 1 && !run.out[0] && kit_lines(run.err) == 1);

    float blue[2] = {0, 0};
    run_example("example_source", (const char *const[]){NULL});
    CHECK_MSG(run.code == 0 && !run.err[0] &&
                  sscanf(run.out, "%*f %*f %f %*f %*f %f", &blue[0], &blue[1]) == 2 &&
                  blue[0] > 0 && blue[1] > 0 && blue[1] != blue[0],
              "source says: %s%s", run.out, run.err);

    char cube[KIT_PATH];
    kit_join(cube, kit_variable("SELVAGE_TESTS"), "../assets/cube.obj");
    kit_join(png, scratch.folder, "traced.png");
    run_example("example_trace", (const char *const[]){cube, png, NULL});
    CHECK_MSG(run.code == 0 && !run.err[0], "trace ended with %d: %s", run.code, run.err);
    check_traced(png);
    run_example("example_trace", (const char *const[]){missing, png, NULL});
    CHECK(run.code == 1 && kit_lines(run.err) == 1);

    char obj[KIT_PATH], painted[KIT_PATH];
    float apart = 1;
    kit_join(obj, scratch.folder, "prism.obj");
    write_prism(obj);
    kit_join(painted, scratch.folder, "painted.ptx");
    run_example("example_paint", (const char *const[]){obj, painted, NULL});
    CHECK_MSG(run.code == 0 && !run.err[0] && strstr(run.out, " dabs, ") &&
                  sscanf(strstr(run.out, "edges"), "edges differ by %f", &apart) == 1 &&
                  apart < 0.1f,
              "paint says: %s%s", run.out, run.err);
    run_example("example_hello", (const char *const[]){painted, NULL});
    CHECK(run.code == 0 && strstr(run.out, "15 faces"));

    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        const char *strategy = slv_strategy_at(s)->name;
        if (test_skip(s, 3))
            continue;
        kit_join(png, scratch.folder, strategy);
        strcat(png, ".png");
        run_example("example_sample_in_your_shader",
                    (const char *const[]){ptx, png, strategy, NULL});
        CHECK_MSG(run.code == 0 && !run.err[0], "%s ended with %d: %s", strategy, run.code,
                  run.err);
        check_picture(png, strategy);
    }
    check_viewer(ptx);
    run_example("example_sample_in_your_shader", (const char *const[]){missing, png, NULL});
    CHECK(run.code == 1 && kit_lines(run.err) == 1);
    run_example("example_sample_in_your_shader", (const char *const[]){ptx, png, "wrong", NULL});
    CHECK(run.code == 2 && kit_lines(run.err) == 1);
    test_remove(scratch.root);
    return test_end();
}
