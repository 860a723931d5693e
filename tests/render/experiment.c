/* compare over a whole orbit: rates, references, kinds of pixels, and a run that is stopped in the
 * middle and resumed, which must come to the same. */
#include "kit/command_kit.h"
#include "kit/cube_kit.h"

#include <selvage/camera.h>

#include <jansson.h>

#include <signal.h>
#include <time.h>

static kit_scratch scratch;
static kit_run run;
static char ptx[KIT_PATH];

#define ARGUMENTS(...) ((const char *const[]){__VA_ARGS__, NULL})
#define EXPERIMENT                                                                                 \
    "compare", ptx, "-q", "--size", "64x48", "--frames", "8", "--msaa", "8,1,4,1", "--accumulate", \
        "8", "--strategies", "clamp,traverse,discard", "--reference",                              \
        "supersampled,raycast,mitchell", "--reference-samples", "16", "--reference-frames", "2",   \
        "--tess", "4", "--quick"

static json_t *load_report(const char *folder) {
    char path[KIT_PATH], inside[KIT_PATH];
    json_error_t problem;
    kit_join(inside, scratch.folder, folder);
    json_t *root = json_load_file(kit_join(path, inside, "report.json"), 0, &problem);
    CHECK_MSG(root, "%s: line %d: %s", path, problem.line, problem.text);
    REQUIRE(root);
    return root;
}

static double number(const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    CHECK_MSG(json_is_number(value), "no number %s", key);
    return json_number_value(value);
}

static void check_csv(const char *name, int lines, const char *start) {
    char path[KIT_PATH], folder[KIT_PATH];
    kit_join(folder, scratch.folder, "whole");
    char *text = kit_read(kit_join(path, folder, name), NULL);
    CHECK_MSG(kit_lines(text) == lines, "%s: %d lines, expected %d", name, kit_lines(text), lines);
    CHECK_MSG(strncmp(text, start, strlen(start)) == 0, "%s begins with %.40s", name, text);
    CHECK_MSG(!strstr(text, "nan") && !strstr(text, "inf"), "%s has no number somewhere", name);
    free(text);
}

static void check_whole(void) {
    static const char *const labels[] = {"outline", "interior", "edge", "regular", "extraordinary"};
    static const char *const sources[] = {"raycast", "mitchell", "supersampled"};
    kit_selvage(&scratch, NULL, ARGUMENTS(EXPERIMENT, "-o", "whole"), &run);
    CHECK_MSG(run.code == 0 && kit_lines(run.err) == 0 && !run.out[0], "exit code %d: %s", run.code,
              run.err);
    REQUIRE(run.code == 0);
    json_t *root = load_report("whole");
    const json_t *reference = json_object_get(root, "reference");
    CHECK(number(reference, "frames") == 2);
    double all = 0;
    for (int i = 0; i < 5; i++) {
        double one = number(json_object_get(reference, "pixels"), labels[i]);
        CHECK_MSG(i == 3 ? one == 0 : one > 0, "%g pixels are %s", one, labels[i]);
        all += one;
    }
    CHECK(all == 2 * 64 * 48); /* a cube has vertices of three faces, none of four */
    for (size_t s = 0; s < 3; s++) {
        const json_t *row = json_array_get(json_object_get(root, "strategies"), s),
                     *rates = json_object_get(row, "rates");
        const uint32_t samples[] = {1, 4, 8};
        double before[3] = {1, 1, 1};
        REQUIRE(json_array_size(rates) == 3);
        for (size_t r = 0; r < 3; r++) {
            const json_t *rate = json_array_get(rates, r);
            CHECK(number(rate, "samples") == samples[r] && number(rate, "median_ms") > 0);
            CHECK(number(json_object_get(rate, "flicker"), "rms") > 0);
            for (int k = 0; k < 3; k++) {
                const json_t *errors = json_object_get(json_object_get(rate, "errors"), sources[k]);
                double rms = number(json_object_get(errors, "all"), "rms"), squares = 0;
                for (int i = 0; i < 5; i++) {
                    const json_t *part = json_object_get(errors, labels[i]);
                    if (json_is_number(json_object_get(part, "rms")))
                        squares += pow(number(part, "rms"), 2) * number(part, "pixels");
                }
                CHECK(fabs(sqrt(squares / all) - rms) < 1e-6);
                /* with more samples outlines alone make every strategy better; Mitchell's filter
                 * is another one than a box */
                CHECK_MSG(k > 0 || rms < before[k], "strategy %zu: %g at %u samples after %g", s,
                          rms, samples[r], before[k]);
                before[k] = rms;
            }
        }
    }
    const json_t *findings = json_object_get(root, "findings");
    CHECK(json_array_size(findings) == 7);
    CHECK(json_is_string(json_object_get(root, "advice")));
    json_decref(root);
    check_csv("table1.csv", 1 + 3 * 3, "strategy,samples,");
    check_csv("errors.csv", 1 + 3 * 3 * 3 * 5, "reference,strategy,samples,pixels_of,");
    check_csv("figure5_left.csv", 1 + 41, "distance,1x,4x,8x\n");
    for (int k = 0; k < 3; k++) {
        char name[64];
        snprintf(name, sizeof name, "figure5_right_%s.csv", sources[k]);
        check_csv(name, 1 + 41, "distance,clamp 1x,");
    }
    check_csv("frames.jsonl", 1 + 8, "{");
    check_csv("table1.tex", 11, "\\begin{tabular}{lrrrrrrr}\n");
    check_csv("table1.md", 2 + 3, "| strategy |");
}

/* Removes what may differ from run to run. */
static void drop_times(json_t *value) {
    static const char *const keys[] = {"median_ms",      "min_ms",          "max_ms",  "time_ratio",
                                       "time_ratio_low", "time_ratio_high", "seconds", "others",
                                       "disturbed",      "points",          "advice",  "numbers",
                                       "judgement"};
    size_t index;
    json_t *item;
    const char *key;
    for (size_t k = 0; json_is_object(value) && k < sizeof keys / sizeof *keys; k++)
        json_object_del(value, keys[k]);
    if (json_is_object(value)) {
        json_object_foreach(value, key, item) drop_times(item);
    } else {
        json_array_foreach(value, index, item) drop_times(item);
    }
}

static int lines_so_far(const char *path) {
    FILE *stream = fopen(path, "rb");
    int count = 0;
    for (int c; stream && (c = fgetc(stream)) != EOF;)
        count += c == '\n';
    if (stream)
        fclose(stream);
    return count;
}

/* Starts the experiment and sends it a signal once some frames are done. Returns how it ended, 0 if
 * no frame was left to do, as where a busy machine let this process wait. */
static int start_and_stop(const char *folder, int which) {
    char program[KIT_PATH], log[KIT_PATH], inside[KIT_PATH], state[KIT_PATH];
    const char *const given[] = {kit_join(program, kit_variable("SELVAGE_BIN"), "selvage"),
                                 EXPERIMENT, "-o", folder, NULL};
    int status = 0;
    kit_join(state, kit_join(inside, scratch.folder, folder), "frames.jsonl");
    kit_join(log, scratch.logs, "stopped");
    pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        char *arguments[KIT_ARGUMENTS + 1] = {NULL};
        for (int i = 0; given[i]; i++)
            arguments[i] = strdup(given[i]);
        if (chdir(scratch.folder) == 0 && freopen(log, "w", stderr))
            execv(arguments[0], arguments);
        _exit(127);
    }
    for (int i = 0; i < 60000 && lines_so_far(state) < 2; i++)
        nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
    CHECK(kill(child, which) == 0);
    REQUIRE(waitpid(child, &status, 0) == child);
    kit_read_log(log, run.err);
    int done = lines_so_far(state),
        code = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    CHECK_MSG(done >= 9 || (done >= 2 && code != 0 && !kit_exists(inside, "report.json")),
              "%d lines were written before the signal, exit code %d", done, code);
    return done < 9 ? code : 0;
}

static int stop_in_the_middle(const char *folder, int which) {
    char path[KIT_PATH];
    int code = 0;
    for (int i = 0; i < 50 && code == 0; i++) {
        if (i)
            test_remove(kit_join(path, scratch.folder, folder));
        code = start_and_stop(folder, which);
    }
    return code;
}

static void check_same(const char *folder) {
    static const char *const files[] = {"errors.csv",
                                        "figure5_left.csv",
                                        "figure5_right_raycast.csv",
                                        "figure5_right_mitchell.csv",
                                        "figure5_right_supersampled.csv",
                                        "view0_discard.png",
                                        "error_discard.png"};
    char whole[KIT_PATH], resumed[KIT_PATH], path[KIT_PATH];
    json_t *a = load_report("whole"), *b = load_report(folder);
    drop_times(a);
    drop_times(b);
    CHECK_MSG(json_equal(a, b), "%s: another report.json", folder);
    json_decref(a);
    json_decref(b);
    kit_join(whole, scratch.folder, "whole");
    kit_join(resumed, scratch.folder, folder);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        size_t one, two;
        char *x = kit_read(kit_join(path, whole, files[i]), &one);
        char *y = kit_read(kit_join(path, resumed, files[i]), &two);
        CHECK_MSG(one == two && memcmp(x, y, one) == 0, "%s: another %s", folder, files[i]);
        free(x);
        free(y);
    }
}

static void check_resume(void) {
    char folder[KIT_PATH], path[KIT_PATH];
    CHECK(stop_in_the_middle("stopped", SIGINT) == 1);
    CHECK_MSG(kit_lines(run.err) == 1 && strstr(run.err, "of 8 frames") &&
                  strstr(run.err, "--resume"),
              "interrupted, it says: %s", run.err);
    kit_join(folder, scratch.folder, "stopped");
    CHECK(kit_count_files(folder) == 1 && kit_count_files(scratch.folder) == 2);

    /* not with other options, and what is there stays as it is */
    int before = lines_so_far(kit_join(path, folder, "frames.jsonl"));
    kit_selvage(&scratch, NULL, ARGUMENTS(EXPERIMENT, "-o", "stopped", "--resume", "--dolly", "2"),
                &run);
    CHECK_MSG(run.code == 1 && kit_lines(run.err) == 1 && strstr(run.err, "'orbit'"), "%d: %s",
              run.code, run.err);
    CHECK(lines_so_far(path) == before);

    /* a line without an end is what a crash may leave */
    FILE *stream = fopen(path, "ab");
    REQUIRE(stream && fputs("{\"frame\":7,\"ms\":[[1.5,2", stream) >= 0 && fclose(stream) == 0);
    kit_selvage(&scratch, NULL, ARGUMENTS(EXPERIMENT, "-o", "stopped", "--resume"), &run);
    CHECK_MSG(run.code == 0 && kit_lines(run.err) == 0, "resumed: exit code %d: %s", run.code,
              run.err);
    REQUIRE(run.code == 0);
    check_same("stopped");

    CHECK(stop_in_the_middle("killed", SIGKILL) == 1000 + SIGKILL);
    kit_selvage(&scratch, NULL, ARGUMENTS(EXPERIMENT, "-o", "killed", "--resume"), &run);
    CHECK_MSG(run.code == 0 && kit_lines(run.err) == 0, "resumed: exit code %d: %s", run.code,
              run.err);
    REQUIRE(run.code == 0);
    check_same("killed");

    /* nothing is left to do: even the times are those of the first run */
    json_t *a = load_report("killed");
    kit_selvage(&scratch, NULL, ARGUMENTS(EXPERIMENT, "-o", "killed", "--resume"), &run);
    CHECK(run.code == 0);
    json_t *b = load_report("killed");
    CHECK(json_equal(json_object_get(a, "findings"), json_object_get(b, "findings")));
    CHECK(json_equal(json_object_get(a, "strategies"), json_object_get(b, "strategies")));
    json_decref(a);
    json_decref(b);

    kit_write(kit_join(path, folder, "frames.jsonl"), "{}\nnonsense\n", 12);
    kit_selvage(&scratch, NULL, ARGUMENTS(EXPERIMENT, "-o", "stopped", "--resume"), &run);
    CHECK_MSG(run.code == 1 && kit_lines(run.err) == 1 && strstr(run.err, "frames.jsonl"), "%s",
              run.err);
}

/* Cameras beside the orbit do not change what is measured on it, and have figures of their own. */
static void check_views(void) {
    static const char near[] =
        "{\"world_to_camera\": [[1,0,0,0],[0,1,0,0],[0,0,1,-4],[0,0,0,1]], "
        "\"projection\": \"perspective\", \"screen_window\": [-0.2,0.2,-0.2,0.2]}",
                      none[] = "{\"size\": [64, 48]}";
    char path[KIT_PATH], folder[KIT_PATH];
    kit_write(kit_join(path, scratch.folder, "near.json"), near, sizeof near - 1);
    kit_write(kit_join(path, scratch.folder, "none.json"), none, sizeof none - 1);
    kit_selvage(&scratch, NULL,
                ARGUMENTS(EXPERIMENT, "-o", "views", "--view", "near.json", "--view", "near.json"),
                &run);
    CHECK_MSG(run.code == 0 && kit_lines(run.err) == 0, "views: exit code %d: %s", run.code,
              run.err);
    REQUIRE(run.code == 0);
    json_t *whole = load_report("whole"), *root = load_report("views");
    json_t *cameras = json_object_get(root, "cameras");
    CHECK(json_array_size(cameras) == 2 && json_array_size(json_object_get(whole, "cameras")) == 0);
    CHECK(json_is_string(json_object_get(root, "advice_for_cameras")) &&
          json_is_null(json_object_get(whole, "advice_for_cameras")));
    for (size_t c = 0; c < 2; c++) {
        const json_t *rows = json_object_get(json_array_get(cameras, c), "strategies");
        REQUIRE(json_array_size(rows) == 3);
        for (size_t k = 0; k < 3; k++) {
            const json_t *row = json_array_get(rows, k), *errors = json_object_get(row, "errors");
            CHECK(number(row, "ms") > 0 && number(row, "time_ratio") > 0);
            CHECK(number(json_object_get(errors, "all"), "pixels") == 64 * 48);
            CHECK(number(json_object_get(errors, "interior"), "pixels") > 100);
        }
    }
    drop_times(whole);
    drop_times(root);
    CHECK(json_equal(json_object_get(whole, "strategies"), json_object_get(root, "strategies")) &&
          json_equal(json_object_get(whole, "reference"), json_object_get(root, "reference")));
    json_decref(whole);
    json_decref(root);
    test_remove(kit_join(folder, scratch.folder, "views"));
    kit_selvage(&scratch, NULL, ARGUMENTS(EXPERIMENT, "-o", "views", "--view", "none.json"), &run);
    CHECK_MSG(run.code == 1 && kit_lines(run.err) == 1 && strstr(run.err, "no camera"), "%s",
              run.err);
    test_remove(kit_join(path, scratch.folder, "near.json"));
    test_remove(kit_join(path, scratch.folder, "none.json"));
}

static void refuse(int code, const char *word, const char *option, const char *value) {
    int before = kit_count_files(scratch.folder);
    kit_selvage(&scratch, NULL, ARGUMENTS("compare", ptx, "--quick", "-o", "new", option, value),
                &run);
    CHECK_MSG(run.code == code && kit_lines(run.err) == 1 && strstr(run.err, word),
              "%s %s: exit code %d: %s", option, value, run.code, run.err);
    CHECK_MSG(kit_count_files(scratch.folder) == before, "%s: leaves something behind", option);
}

static void check_left_out(void) {
    kit_selvage(&scratch, NULL,
                ARGUMENTS("compare", ptx, "--quick", "-o", "less", "--size", "48", "--frames", "1",
                          "--msaa", "1,64", "--strategies", "discard", "--reference", "none",
                          "--tess", "4"),
                &run);
    CHECK_MSG(run.code == 0 && strstr(run.out, "left out: 64"), "%d: %s%s", run.code, run.out,
              run.err);
    json_t *root = load_report("less");
    const json_t *row = json_array_get(json_object_get(root, "strategies"), 0);
    CHECK(json_array_size(json_object_get(row, "rates")) == 1);
    CHECK(json_is_null(json_object_get(root, "reference")) &&
          json_is_null(json_object_get(root, "advice")) &&
          json_is_null(json_object_get(root, "traverse_from_discard")));
    json_decref(root);
}

enum { SIDE = 3, TEXELS = 8, PIXELS = 100 };

/* Which kind each pixel is can be told by hand where all is flat and seen from above. */
static void check_kinds(void) {
    static const char *const labels[] = {"outline", "interior", "edge", "regular", "extraordinary"};
    const float low[3] = {0, 0, 0}, high[3] = {SIDE, 0, SIDE};
    const slv_camera camera = slv_camera_orbit(low, high, 0, 90, 0, 1);
    const double size = (double)(camera.window[1] - camera.window[0]) / PIXELS;
    const double reach = size / 2 + 0.5 / TEXELS; /* texels are larger than pixels */
    uint32_t expected[5] = {0};
    char grid[KIT_PATH];
    REQUIRE(size < 1.0 / TEXELS);
    for (int i = 0; i < PIXELS * PIXELS; i++) {
        double at[2] = {SIDE / 2.0 + size * (i % PIXELS + 0.5 - PIXELS / 2),
                        SIDE / 2.0 + size * (i / PIXELS + 0.5 - PIXELS / 2)};
        int inner = 0, outer = 0; /* edges within reach, shared and boundary */
        bool outside = false;
        for (int k = 0; k < 2; k++) {
            double line = round(at[k]);
            outside |= at[k] - size / 2 < 0 || at[k] + size / 2 > SIDE;
            if (fabs(at[k] - line) < reach)
                line > 0 && line < SIDE ? inner++ : outer++;
        }
        expected[outside ? 0 : inner + outer == 2 && inner ? 3 : inner ? 2 : 1]++;
    }
    kit_selvage(&scratch, NULL,
                ARGUMENTS("compare",
                          (bake_write_grid(kit_join(grid, scratch.root, "grid.ptx"), SIDE), grid),
                          "-q", "--quick", "--scheme", "bilinear", "--size", "100", "--frames", "1",
                          "--orbit", "0", "--azimuth", "0", "--elevation", "90", "--tilt", "0",
                          "--dolly", "1", "--fov", "0", "--msaa", "1", "--tess", "2",
                          "--strategies", "clamp,traverse", "--reference-samples", "16", "-o",
                          "grid"),
                &run);
    CHECK_MSG(run.code == 0, "%d: %s", run.code, run.err);
    REQUIRE(run.code == 0);
    json_t *root = load_report("grid");
    const json_t *pixels = json_object_get(json_object_get(root, "reference"), "pixels");
    for (int k = 0; k < 5; k++)
        CHECK_MSG(number(pixels, labels[k]) == expected[k], "%g pixels are %s, expected %u",
                  number(pixels, labels[k]), labels[k], expected[k]);
    const json_t *rows = json_object_get(root, "strategies");
    const json_t *errors[2];
    for (size_t s = 0; s < 2; s++)
        errors[s] = json_object_get(
            json_object_get(json_array_get(json_object_get(json_array_get(rows, s), "rates"), 0),
                            "errors"),
            "raycast");
    double interior[2], seams[2];
    for (size_t s = 0; s < 2; s++) {
        interior[s] = number(json_object_get(errors[s], "interior"), "rms");
        seams[s] = number(json_object_get(errors[s], "seams"), "rms");
    }
    CHECK_MSG(interior[0] < 0.003 && interior[1] < 0.003, "inside %g and %g", interior[0],
              interior[1]); /* software clamps in 8 bits */
    CHECK_MSG(seams[0] > 2 * seams[1], "at seams %g and %g", seams[0], seams[1]);
    json_decref(root);
}

/* Memory and errors of textures in blocks, against the numbers of the same run without. */
static void check_compressed(void) {
    char folder[KIT_PATH], path[KIT_PATH], whole[KIT_PATH];
    kit_selvage(&scratch, NULL,
                ARGUMENTS("compare", ptx, "--quick", "-o", "blocks", "--size", "96x64", "--frames",
                          "1", "--msaa", "4", "--aniso", "4", "--reference-samples", "16", "--tess",
                          "4", "--compress"),
                &run);
    CHECK_MSG(run.code == 0 && strstr(run.out, "in blocks"), "%d: %s%s", run.code, run.out,
              run.err);
    REQUIRE(run.code == 0);
    json_t *root = load_report("blocks");
    const json_t *rows = json_object_get(root, "strategies");
    size_t n = json_array_size(rows);
    REQUIRE(n > 4);
    for (size_t s = 0; s < n; s++) {
        const json_t *row = json_array_get(rows, s), *blocks = json_object_get(row, "compressed");
        const char *name = json_string_value(json_object_get(row, "name"));
        REQUIRE(json_is_object(blocks) && name);
        double psnr = number(blocks, "psnr"), error = number(blocks, "reference_psnr"),
               plain = number(blocks, "uncompressed_reference_psnr"),
               rms = number(blocks, "texel_rms");
        CHECK_MSG(number(blocks, "gpu_bytes") < number(row, "gpu_bytes") / 2, "%s: %g bytes of %g",
                  name, number(blocks, "gpu_bytes"), number(row, "gpu_bytes"));
        CHECK(fabs(number(blocks, "memory_ratio") * number(row, "texel_bytes") -
                   number(blocks, "gpu_bytes")) < 1);
        CHECK_MSG(rms > 0 && rms < 0.1 && number(blocks, "texel_max") > rms, "%s: %g", name, rms);
        /* a view averages, so its pixels are closer than texels, but not by much */
        CHECK_MSG(psnr > -20 * log10(rms) - 6 && psnr < -20 * log10(rms) + 20,
                  "%s: %g dB, texels are off by %g", name, psnr, rms);
        CHECK_MSG(error < plain + 0.5 && error > 15, "%s: %g dB, uncompressed %g", name, error,
                  plain);
        if (strcmp(name, "traverse") == 0)
            CHECK_MSG(number(blocks, "seam_max") < 1.0 / 255, "%g", number(blocks, "seam_max"));
        if (strcmp(name, "clamp") == 0)
            CHECK(number(blocks, "seam_max") > 0.05);
    }
    json_decref(root);
    kit_join(folder, scratch.folder, "blocks");
    char *csv = kit_read(kit_join(path, folder, "compression.csv"), NULL);
    CHECK(kit_lines(csv) == 1 + (int)n && strncmp(csv, "strategy,gpu_bytes,", 19) == 0);
    CHECK(!strstr(csv, "nan") && !strstr(csv, "inf"));
    free(csv);
    char *page = kit_read(kit_join(path, folder, "report.html"), NULL);
    CHECK(strstr(page, "Compressed in blocks"));
    free(page);

    CHECK(json_is_null(json_object_get(
        json_array_get(json_object_get(root = load_report("less"), "strategies"), 0),
        "compressed")));
    json_decref(root);
    kit_join(folder, scratch.folder, "less");
    CHECK(!kit_exists(folder, "compression.csv"));

    kit_join(whole, scratch.root, "float.ptx");
    kit_selvage(&scratch, NULL, ARGUMENTS("convert", ptx, whole, "--type", "float", "-q"), &run);
    REQUIRE(run.code == 0);
    int before = kit_count_files(scratch.folder);
    kit_selvage(&scratch, NULL, ARGUMENTS("compare", whole, "--quick", "--compress", "-o", "new"),
                &run);
    CHECK_MSG(run.code == 1 && kit_lines(run.err) == 1 && strstr(run.err, "float"), "%d: %s",
              run.code, run.err);
    CHECK(kit_count_files(scratch.folder) == before);
}

int main(void) {
    kit_load_driver();
    kit_scratch_make(&scratch);
    cube_write(kit_join(ptx, scratch.root, "cube.ptx"));
    refuse(2, "--msaa", "--msaa", "3");
    refuse(2, "--msaa", "--msaa", "1,,2");
    refuse(2, "--msaa", "--msaa", "4,");
    refuse(2, "--msaa", "--msaa", "128");
    refuse(2, "power of two", "--accumulate", "3");
    refuse(2, "raycast,mitchell,supersampled", "--reference", "rays");
    refuse(2, "--dolly", "--dolly", "0.5");
    refuse(2, "borders|traverse", "--strategies", "clamp,best");
    refuse(1, "64 samples", "--msaa", "64");
    check_left_out();
    check_compressed();
    check_kinds();
    test_remove(scratch.folder);
    REQUIRE(mkdir(scratch.folder, 0777) == 0);
    check_whole();
    check_resume();
    check_views();
    test_remove(scratch.root);
    return test_end();
}
