/* OpenEXR files of random forms, written by OpenEXR's own library, and what slv_image_load makes of
 * them: the texels that were meant, or a line that says what is not read. */
#include "images/exr_writer.h"
#include "kit/test.h"

#include <selvage/half.h>
#include <selvage/image.h>

#include <unistd.h>

static uint64_t seed = 11;
static char path[512];

static uint32_t below(uint32_t bound) {
    return test_random(&seed) % bound;
}

/* Noise does not pack at all, few values and slopes do, and one value packs to almost nothing. */
static void fill(float *pixels, size_t count, const exr_form *form) {
    uint32_t kind = below(4), values = 1 + below(9);
    for (size_t i = 0; i < count; i++) {
        float value = kind == 0   ? (float)below(1 << 20) / (1 << 19) - 0.5f
                      : kind == 1 ? (float)below(values) / 8
                      : kind == 2 ? (float)i / (float)count
                                  : 0.375f;
        pixels[i] = form->floats ? value : slv_half_to_float(slv_half_from_float(value));
    }
}

static void random_window(int window[4], int most) {
    window[0] = (int)below(40) - 20;
    window[1] = (int)below(40) - 20;
    window[2] = window[0] + (int)below((uint32_t)most);
    window[3] = window[1] + (int)below((uint32_t)most);
}

static exr_form random_form(int round) {
    static const char *const kinds[] = {"RGBA", "RGB", "Y", "YA"};
    exr_form form = {.compression = round % EXR_COMPRESSIONS,
                     .floats = (int)below(2),
                     .channels = kinds[below(4)],
                     .layer = below(6) ? "" : "beauty.",
                     .extra = below(4) == 0};
    if (below(2)) {
        form.tile = 2 << below(5);
        form.levels = (int)below(3);
        form.line_order = (int)below(3);
    } else {
        form.line_order = (int)below(2);
    }
    if (!form.layer[0] && below(4) == 0)
        form.decoys = 1 + (int)below(2);
    random_window(form.data, 1 << below(7));
    if (below(2)) {
        memcpy(form.display, form.data, sizeof form.data);
        return form;
    }
    do
        random_window(form.display, 40);
    while (form.display[0] > form.data[2] || form.data[0] > form.display[2] ||
           form.display[1] > form.data[3] || form.data[1] > form.display[3]);
    return form;
}

static void compare(const exr_form *form, const float *pixels, const slv_image *image) {
    int width = form->display[2] - form->display[0] + 1;
    int height = form->display[3] - form->display[1] + 1;
    uint32_t n = (uint32_t)strlen(form->channels), wrong = 0;
    int stored = form->data[2] - form->data[0] + 1;
    REQUIRE((int)image->width == width && (int)image->height == height && image->nchannels == n);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            for (uint32_t c = 0; c < n; c++) {
                int there = x + form->display[0], down = y + form->display[1];
                bool inside = there >= form->data[0] && there <= form->data[2] &&
                              down >= form->data[1] && down <= form->data[3];
                size_t at =
                    inside ? (size_t)((down - form->data[1]) * stored + there - form->data[0]) : 0;
                float meant = inside ? pixels[at * n + c] : 0;
                wrong += image->pixels[((size_t)y * (size_t)width + (size_t)x) * n + c] != meant;
            }
    CHECK_MSG(!wrong,
              "%s, %s, tiles of %d, levels %d, order %d, %s%s, extra %d, part %d, display %d,%d "
              "%d,%d, data "
              "%d,%d %d,%d: %u values are wrong",
              exr_compression_name(form->compression), form->floats ? "float" : "half", form->tile,
              form->levels, form->line_order, form->layer, form->channels, form->extra,
              form->decoys, form->display[0], form->display[1], form->display[2], form->display[3],
              form->data[0], form->data[1], form->data[2], form->data[3], wrong);
}

static void check_form(const exr_form *form) {
    slv_env env = test_env();
    size_t count = (size_t)(form->data[2] - form->data[0] + 1) *
                   (size_t)(form->data[3] - form->data[1] + 1) * strlen(form->channels);
    float *meant = calloc(count, sizeof *meant), *stored = calloc(count, sizeof *stored);
    slv_image image;
    REQUIRE(meant && stored);
    fill(meant, count, form);
    REQUIRE(exr_write(path, form, meant));
    REQUIRE(exr_read(path, form, stored));
    /* what loses is close to what was meant, and is read as OpenEXR reads it */
    for (size_t i = 0; i < count; i++)
        CHECK(exr_is_lossy(form) ? fabsf(meant[i] - stored[i]) < 2.0f : meant[i] == stored[i]);
    REQUIRE(slv_image_load(&env, path, &image) == SLV_OK);
    compare(form, stored, &image);
    slv_image_free(&image);
    free(meant);
    free(stored);
}

/* All compressions with pictures so small that their chunks are stored plain. */
static void check_small(void) {
    for (int compression = 0; compression < EXR_COMPRESSIONS; compression++)
        for (int side = 1; side <= 16; side++)
            for (int floats = 0; floats < 2; floats++) {
                exr_form form = {.compression = compression,
                                 .floats = floats,
                                 .channels = side % 3 ? "RGB" : "Y",
                                 .layer = "",
                                 .display = {0, 0, side - 1, side - 1},
                                 .data = {0, 0, side - 1, side - 1}};
                check_form(&form);
            }
}

static void check_refused(void) {
    static const char *const words[EXR_ODD_COUNT] = {[EXR_DEEP] = "deep",
                                                     [EXR_DEEP_TILES] = "deep",
                                                     [EXR_UINT] = "channel R holds integers",
                                                     [EXR_SUBSAMPLED] =
                                                         "channel R is subsampled (2 x 2)",
                                                     [EXR_CHROMA] = "luminance and chroma",
                                                     [EXR_TWO_LAYERS] = "has 2 layers (a, b)",
                                                     [EXR_NO_COLOUR] = "this has U, V"};
    slv_env env = test_env();
    slv_image image;
    for (int kind = 0; kind < EXR_ODD_COUNT; kind++) {
        REQUIRE(exr_write_odd(path, kind));
        CHECK(slv_image_load(&env, path, &image) == SLV_ERROR_UNSUPPORTED && !image.pixels);
        CHECK_MSG(strstr(test_last_log, words[kind]) && strstr(test_last_log, path), "kind %d: %s",
                  kind, test_last_log);
    }
    /* the components of vectors and coordinates, which no picture has */
    static const char *const letters[] = {"XYZ", "XY", "YZ", "ZY", "YXA", "RGY", "UVY", "YRA"};
    static const char *const layers[] = {"", "ViewLayer.Normal."};
    static const float zeros[16 * 3];
    for (int i = 0; i < 16; i++) {
        const exr_form form = {.channels = letters[i / 2],
                               .layer = layers[i % 2],
                               .display = {0, 0, 3, 3},
                               .data = {0, 0, 3, 3}};
        char name[64];
        snprintf(name, sizeof name, "%sY", layers[i % 2]);
        REQUIRE(exr_write(path, &form, zeros));
        CHECK(slv_image_load(&env, path, &image) == SLV_ERROR_UNSUPPORTED && !image.pixels);
        CHECK_MSG(strstr(test_last_log, "this has") && strstr(test_last_log, name), "%s: %s",
                  letters[i / 2], test_last_log);
    }
    static const exr_form apart = {
        .channels = "Y", .layer = "", .display = {0, 0, 3, 3}, .data = {4, 0, 7, 3}};
    REQUIRE(exr_write(path, &apart, zeros));
    CHECK(slv_image_load(&env, path, &image) == SLV_ERROR_UNSUPPORTED);
    CHECK(strstr(test_last_log, "outside of the display window"));
}

/* A file that ends too early, at whatever byte, is not an image. */
static void check_cut(void) {
    slv_env env = test_env();
    for (int compression = 0; compression < EXR_COMPRESSIONS; compression++) {
        exr_form form = {.compression = compression,
                         .channels = "RGBA",
                         .layer = "",
                         .tile = compression % 2 ? 8 : 0,
                         .display = {0, 0, 19, 39},
                         .data = {0, 0, 19, 39}};
        static float pixels[20 * 40 * 4];
        static char bytes[1 << 16];
        fill(pixels, 20 * 40 * 4, &form);
        REQUIRE(exr_write(path, &form, pixels));
        FILE *file = fopen(path, "rb");
        REQUIRE(file);
        size_t size = fread(bytes, 1, sizeof bytes, file);
        fclose(file);
        for (int round = 0; round < 20; round++) {
            slv_image image;
            size_t cut = round < 10 ? size - 1 - (size_t)round : 8 + below((uint32_t)size - 9);
            REQUIRE((file = fopen(path, "wb")) && fwrite(bytes, 1, cut, file) == cut);
            fclose(file);
            slv_result result = slv_image_load(&env, path, &image);
            CHECK_MSG(result == SLV_ERROR_FORMAT && !image.pixels, "%s, %zu of %zu bytes: %s",
                      exr_compression_name(compression), cut, size, slv_result_string(result));
        }
    }
}

/* Bits that are wrong, most of them in the header: an image or a line that says why not, and no
 * more memory than is allowed. */
static void check_spoilt(void) {
    slv_env env = test_env();
    uint32_t read = 0, rounds = test_effort(600);
    env.max_bytes = UINT64_C(64) << 20;
    for (uint32_t round = 0; round < rounds; round++) {
        static float pixels[32 * 32 * 4];
        static char bytes[1 << 17];
        exr_form form = random_form((int)round);
        slv_image image;
        form.data[2] = form.data[0] + (int)below(32);
        form.data[3] = form.data[1] + (int)below(32);
        memcpy(form.display, form.data, sizeof form.data);
        fill(pixels, sizeof pixels / sizeof *pixels, &form);
        REQUIRE(exr_write(path, &form, pixels));
        FILE *file = fopen(path, "rb");
        REQUIRE(file);
        size_t size = fread(bytes, 1, sizeof bytes, file);
        fclose(file);
        for (uint32_t flips = 1 + below(4); flips; flips--)
            bytes[below((uint32_t)(below(3) && size > 400 ? 400 : size))] ^= (char)(1 << below(8));
        REQUIRE((file = fopen(path, "wb")) && fwrite(bytes, 1, size, file) == size);
        fclose(file);
        test_last_log[0] = 0;
        slv_result result = slv_image_load(&env, path, &image);
        CHECK_MSG(!result == !!image.pixels && (!result || test_last_log[0]), "round %u: %s, %s",
                  round, slv_result_string(result), test_last_log);
        CHECK(!strchr(test_last_log, '\n'));
        read += result == SLV_OK;
        slv_image_free(&image);
    }
    CHECK(read > 0 && read < rounds);
}

int main(void) {
    snprintf(path, sizeof path, "%s/selvage_exr_XXXXXX", test_parent());
    int made = mkstemp(path);
    REQUIRE(made >= 0);
    close(made);
    int rounds = (int)test_effort(250);
    for (int round = 0; round < rounds; round++) {
        exr_form form = random_form(round);
        check_form(&form);
    }
    check_small();
    check_refused();
    check_cut();
    check_spoilt();
    remove(path);
    return test_end();
}
