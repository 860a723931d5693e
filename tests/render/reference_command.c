/* The verb reference and compare --reference as a user meets them. */
#include "kit/command_kit.h"
#include "kit/cube_kit.h"

#include <selvage/image.h>

#include <jansson.h>

static kit_scratch scratch;
static kit_run run;
static char ptx[KIT_PATH];

#define ARGUMENTS(...) ((const char *const[]){__VA_ARGS__, NULL})

static slv_image load(const char *name) {
    slv_image image = {0};
    char path[KIT_PATH];
    REQUIRE(slv_image_load(NULL, kit_join(path, scratch.folder, name), &image) == SLV_OK);
    return image;
}

static void succeed(const char *const *arguments) {
    kit_selvage(&scratch, NULL, arguments, &run);
    CHECK_MSG(run.code == 0 && kit_lines(run.err) == 0, "%s: exit code %d: %s", arguments[0],
              run.code, run.err);
    REQUIRE(run.code == 0);
}

static void refuse(int code, const char *word, const char *const *arguments) {
    int before = kit_count_files(scratch.folder);
    kit_selvage(&scratch, NULL, arguments, &run);
    CHECK_MSG(run.code == code, "%s: exit code %d, expected %d: %s", word, run.code, code, run.err);
    CHECK_MSG(kit_lines(run.err) == 1 && strstr(run.err, word), "no '%s' in: %s", word, run.err);
    CHECK_MSG(kit_count_files(scratch.folder) == before, "%s: leaves something behind", word);
}

static json_t *parse(const char *text) {
    json_error_t error;
    json_t *root = json_loads(text, 0, &error);
    CHECK_MSG(root, "line %d: %s", error.line, error.text);
    REQUIRE(root);
    return root;
}

static double number(const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    CHECK_MSG(json_is_number(value), "no number %s", key);
    return json_number_value(value);
}

static void check_pictures(void) {
    succeed(ARGUMENTS("reference", ptx, "--size", "40x30", "--samples", "128", "--quiet", "--error",
                      "error.exr"));
    CHECK(!run.out[0] && kit_count_files(scratch.folder) == 2);
    slv_image image = load("cube.exr"), error = load("error.exr");
    CHECK(image.width == 40 && image.height == 30 && image.nchannels == 4);
    CHECK(error.width == 40 && error.height == 30);
    float largest = 0;
    for (uint32_t i = 0; i < 40 * 30; i++)
        largest = fmaxf(largest, error.pixels[i * error.nchannels]);
    CHECK(largest > 0 && largest < 0.2f);

    /* the renderer's picture of the same view is near, and another seed's nearer */
    succeed(ARGUMENTS("render", ptx, "gl.exr", "--size", "40x30", "--bits", "32", "-q"));
    succeed(ARGUMENTS("reference", ptx, "-o", "other.exr", "--size", "40x30", "-n", "128", "-q",
                      "--seed", "5", "--bits", "16", "--threads", "1"));
    slv_image gl = load("gl.exr"), other = load("other.exr");
    double far[2] = {0, 0};
    for (uint32_t i = 0; i < 4 * 40 * 30; i++) {
        far[0] += pow((double)(image.pixels[i] - gl.pixels[i]), 2) / (4 * 40 * 30);
        far[1] += pow((double)(image.pixels[i] - other.pixels[i]), 2) / (4 * 40 * 30);
    }
    fprintf(stderr, "off by %.5f from the renderer's, by %.5f from another seed's\n", sqrt(far[0]),
            sqrt(far[1]));
    CHECK(sqrt(far[0]) < 0.04 && far[1] < far[0] / 4 && far[1] > 0);
    slv_image_free(&image);
    slv_image_free(&error);
    slv_image_free(&gl);
    slv_image_free(&other);
}

static void check_convergence(void) {
    char path[KIT_PATH], folder[KIT_PATH];
    succeed(ARGUMENTS("reference", ptx, "-o", "best.exr", "--size", "40x30", "--samples", "256",
                      "--filter", "mitchell", "--convergence", "study", "--json"));
    json_t *root = parse(run.out);
    const json_t *rows = json_object_get(root, "convergence");
    CHECK(number(root, "schema") == 1 && number(root, "samples") == 256);
    CHECK(!strcmp(json_string_value(json_object_get(root, "filter")), "mitchell"));
    CHECK(number(root, "estimated_rms") > 0 && number(root, "covered_pixels") > 100);
    CHECK(number(root, "order") > 0.45 && number(root, "order") < 1.6);
    REQUIRE(json_array_size(rows) == 5);
    for (size_t i = 0; i + 1 < 5; i++) {
        const json_t *row = json_array_get(rows, i), *next = json_array_get(rows, i + 1);
        CHECK(number(row, "samples") == pow(4, (double)i));
        CHECK(number(row, "measured_rms") > 0);
        if (i < 3)
            CHECK(number(next, "measured_rms") < number(row, "measured_rms"));
    }
    CHECK(json_is_null(json_object_get(json_array_get(rows, 0), "estimated_rms")));
    CHECK(json_is_null(json_object_get(json_array_get(rows, 4), "measured_rms")));
    json_decref(root);
    kit_join(folder, scratch.folder, "study");
    CHECK(kit_count_files(folder) == 2);
    char *csv = kit_read(kit_join(path, folder, "convergence.csv"), NULL);
    CHECK(kit_lines(csv) == 6 && strstr(csv, "samples,seconds,estimated_rms,measured_rms\n1,"));
    free(csv);
    char *svg = kit_read(kit_join(path, folder, "convergence.svg"), NULL);
    CHECK(strstr(svg, "<svg ") && strstr(svg, "</svg>") && strstr(svg, "256") &&
          !strstr(svg, "nan") && !strstr(svg, "inf"));
    free(svg);
    /* one sample has nothing to say of its own error */
    succeed(ARGUMENTS("reference", ptx, "-o", "best.exr", "--size", "8", "--samples", "1",
                      "--convergence", "study", "--json"));
    root = parse(run.out);
    CHECK(json_array_size(json_object_get(root, "convergence")) == 1);
    CHECK(json_is_null(json_object_get(root, "estimated_rms")));
    json_decref(root);
}

/* What compare holds its pictures against is this verb's picture. */
static void check_compare(void) {
    static const char *const parts[] = {"all", "inside", "seams"};
    char folder[KIT_PATH], path[KIT_PATH];
    json_error_t problem;
    succeed(ARGUMENTS("compare", ptx, "--quick", "--out", "report", "--size", "96x64", "--frames",
                      "2", "--strategies", "clamp,traverse", "--quiet", "--reference", "raycast",
                      "--reference-samples", "32", "--msaa", "4"));
    kit_join(folder, scratch.folder, "report");
    json_t *root = json_load_file(kit_join(path, folder, "report.json"), 0, &problem);
    REQUIRE(root);
    const json_t *reference = json_object_get(root, "reference"),
                 *rows = json_object_get(root, "strategies");
    CHECK(number(reference, "samples") == 32 && number(reference, "frames") == 2);
    CHECK(number(json_object_get(reference, "estimated_rms"), "raycast") > 0);
    double rms[2][3];
    for (size_t s = 0; s < 2; s++) {
        const json_t *rate = json_array_get(json_object_get(json_array_get(rows, s), "rates"), 0);
        const json_t *errors = json_object_get(json_object_get(rate, "errors"), "raycast"),
                     *curve = json_object_get(errors, "curve");
        REQUIRE(json_array_size(curve) == 41);
        for (size_t i = 1; i < 41; i++) {
            const json_t *a = json_array_get(curve, i - 1), *b = json_array_get(curve, i);
            CHECK(json_number_value(json_array_get(a, 0)) <
                  json_number_value(json_array_get(b, 0)));
            CHECK(json_number_value(json_array_get(a, 1)) >=
                  json_number_value(json_array_get(b, 1)));
        }
        for (size_t k = 0; k < 3; k++) {
            const json_t *error = json_object_get(errors, parts[k]);
            rms[s][k] = number(error, "rms");
            CHECK(number(error, "max") >= rms[s][k] && rms[s][k] > 0);
            CHECK(number(error, "pixels") <= 2 * 96 * 64);
            CHECK(number(error, "share_over_1_255") >= number(error, "share_over_4_255") &&
                  number(error, "share_over_4_255") >= number(error, "share_over_16_255"));
        }
    }
    fprintf(stderr, "at seams: clamp is off by %.5f, traverse by %.5f\n", rms[0][2], rms[1][2]);
    CHECK(rms[1][2] < rms[0][2] * 0.9 && rms[1][1] < rms[0][1] * 0.95);
    json_decref(root);
    CHECK(kit_exists(folder, "view0_reference.png"));
    char *page = kit_read(kit_join(path, folder, "report.html"), NULL);
    CHECK(strstr(page, "ray-cast") && strstr(page, "<svg ") && strstr(page, ">reference</option>"));
    CHECK(!strstr(page, ">nan") && !strstr(page, "{{"));
    free(page);
}

int main(void) {
    kit_scratch_make(&scratch);
    cube_write(kit_join(ptx, scratch.root, "cube.ptx"));
    check_pictures();
    check_convergence();
    check_compare();
    refuse(2, ".exr", ARGUMENTS("reference", ptx, "-o", "out.png"));
    refuse(2, ".exr", ARGUMENTS("reference", ptx, "--error", "error.png"));
    refuse(2, "--samples", ARGUMENTS("reference", ptx, "--samples", "0"));
    refuse(2, "box|mitchell", ARGUMENTS("reference", ptx, "--filter", "gauss"));
    refuse(2, "power of two", ARGUMENTS("reference", ptx, "--tess", "3"));
    refuse(2, "16 or 32", ARGUMENTS("reference", ptx, "--bits", "24"));
    refuse(2, "170", ARGUMENTS("reference", ptx, "--fov", "175"));
    refuse(2, "levels", ARGUMENTS("reference", ptx, "--shading", "levels", "-q"));
    refuse(1, "missing.json", ARGUMENTS("reference", ptx, "--view", "missing.json"));
    refuse(1, "nowhere/", ARGUMENTS("reference", ptx, "-q", "--convergence", "nowhere/study"));
    refuse(1, "nowhere/", ARGUMENTS("reference", ptx, "-q", "--size", "8", "-o", "nowhere/a.exr"));
    refuse(2, "levels", ARGUMENTS("compare", ptx, "--reference", "raycast", "--shading", "levels"));
    test_remove(scratch.root);
    return test_end();
}
