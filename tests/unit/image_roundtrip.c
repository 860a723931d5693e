/* Images written, read back and compared, and what is said of those that cannot be. */
#include "kit/folder_kit.h"

#include <selvage/half.h>
#include <selvage/image.h>

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

static uint64_t seed = 3;

static int files_in_folder(void) {
    int count = 0;
    DIR *dir = opendir(test_folder);
    struct dirent *entry;
    while (dir && (entry = readdir(dir)))
        count += entry->d_name[0] != '.';
    if (dir)
        closedir(dir);
    return count;
}

static slv_image random_image(uint32_t width, uint32_t height, uint32_t nchannels, float scale) {
    slv_env env = test_env();
    slv_image image;
    REQUIRE(slv_image_create(&env, width, height, nchannels, &image) == SLV_OK);
    for (uint32_t i = 0; i < width * height * nchannels; i++)
        image.pixels[i] = (float)(test_random(&seed) % 65536) / 65535.0f * scale;
    return image;
}

static float srgb(float x) {
    return x <= 0.0031308f ? 12.92f * x : 1.055f * powf(x, 1.0f / 2.4f) - 0.055f;
}

static float wanted_png(const slv_image *image, uint32_t i, slv_image_encoding encoding) {
    uint32_t n = image->nchannels, c = i % n;
    float value = image->pixels[i], alpha = n % 2 ? 1.0f : image->pixels[i - c + n - 1];
    if (encoding == SLV_ENCODE_SRGB && (n % 2 || c != n - 1))
        value = srgb(alpha > 0.0f ? value / alpha : value);
    return value < 0.0f ? 0.0f : value > 1.0f ? 1.0f : value;
}

struct rows {
    uint64_t done, calls;
};

static bool count_rows(void *user, uint64_t done, uint64_t total) {
    struct rows *rows = user;
    CHECK(done > rows->done && done <= total);
    rows->done = done;
    rows->calls++;
    return true;
}

static void png_round_trip(uint32_t width, uint32_t height, uint32_t n, uint32_t bits,
                           slv_image_encoding encoding) {
    slv_env env = test_env();
    slv_image image = random_image(width, height, n, 1.1f), back;
    struct rows rows = {0};
    slv_image_params params = {.encoding = encoding, .bits = bits, .progress = {count_rows, &rows}};
    const char *path = test_path("x.PNG");
    REQUIRE(slv_image_save(&env, path, &image, &params) == SLV_OK);
    CHECK(rows.done == height && rows.calls == height);
    params.progress.report = NULL;
    REQUIRE(slv_image_load(&env, path, &back) == SLV_OK);
    CHECK(back.width == width && back.height == height && back.nchannels == n);
    float step = bits == 16 ? 65535.0f : 255.0f;
    for (uint32_t i = 0; i < width * height * n; i++)
        CHECK_MSG(fabsf(back.pixels[i] - wanted_png(&image, i, encoding)) < 0.51f / step,
                  "%u channels, %u bits: %g gave %g", n, bits, (double)image.pixels[i],
                  (double)back.pixels[i]);
    void *bytes = NULL;
    size_t size = 0;
    struct stat status;
    REQUIRE(slv_image_encode_png(&env, &image, &params, &bytes, &size) == SLV_OK);
    CHECK(stat(path, &status) == 0 && (size_t)status.st_size == size);
    slv_free(bytes);
    slv_image_free(&image);
    slv_image_free(&back);
    CHECK(!back.pixels && !back.width);
    remove(path);
}

static void exr_round_trip(uint32_t width, uint32_t height, uint32_t n, uint32_t bits) {
    slv_env env = test_env();
    slv_image image = random_image(width, height, n, 3.0f), back;
    struct rows rows = {0};
    slv_image_params params = {
        .encoding = SLV_ENCODE_SRGB, .bits = bits, .progress = {count_rows, &rows}};
    image.pixels[0] = -2.5f;
    const char *path = test_path("x.exr");
    REQUIRE(slv_image_save(&env, path, &image, &params) == SLV_OK);
    CHECK(rows.done == height && rows.calls > 0);
    REQUIRE(slv_image_load(&env, path, &back) == SLV_OK);
    CHECK(back.width == width && back.height == height && back.nchannels == n);
    for (uint32_t i = 0; i < width * height * n; i++) {
        float wanted = image.pixels[i];
        if (bits != 32)
            wanted = slv_half_to_float(slv_half_from_float(wanted));
        CHECK_MSG(back.pixels[i] == wanted, "%u channels, %u bits, value %u: %g gave %g", n, bits,
                  i, (double)wanted, (double)back.pixels[i]);
    }
    slv_image_free(&image);
    slv_image_free(&back);
    remove(path);
}

/* Now and then a chunk compresses to just the length that it had: small pictures of few values, and
 * many of them. */
static void exr_of_any_length(void) {
    slv_env env = test_env();
    uint64_t random = 9;
    const char *path = test_path("length.exr");
    for (int round = 0; round < 1500; round++) {
        uint32_t width = 1u << test_random(&random) % 6, height = 1u << test_random(&random) % 6;
        uint32_t values = 1u << test_random(&random) % 11;
        slv_image_params params = {.encoding = SLV_ENCODE_SRGB, .bits = round % 2 ? 16 : 32};
        slv_image image, back;
        REQUIRE(slv_image_create(&env, width, height, 1, &image) == SLV_OK);
        for (uint32_t i = 0; i < width * height; i++)
            image.pixels[i] = (float)(test_random(&random) % values) / 16;
        REQUIRE(slv_image_save(&env, path, &image, &params) == SLV_OK);
        REQUIRE(slv_image_load(&env, path, &back) == SLV_OK);
        CHECK_MSG(memcmp(image.pixels, back.pixels, width * height * sizeof(float)) == 0,
                  "%u x %u of %u values came back changed", width, height, values);
        slv_image_free(&image);
        slv_image_free(&back);
    }
    remove(path);
}

static slv_result load_bytes(const void *bytes, size_t size, slv_image *out) {
    slv_env env = test_env();
    const char *path = test_path("bytes");
    FILE *stream = fopen(path, "wb");
    size_t written = stream ? fwrite(bytes, 1, size, stream) : 0;
    REQUIRE(stream && written == size);
    fclose(stream);
    slv_result result = slv_image_load(&env, path, out);
    remove(path);
    return result;
}

/* 2 x 2 pixels in a 2-bit palette whose last entry is transparent, and 3 x 1 pixels of one bit. */
static void small_kinds(void) {
    static const uint8_t palette[] = {
        0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
        0x44, 0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x02, 0x03, 0x00, 0x00,
        0x00, 0x0f, 0xd8, 0xe5, 0xb7, 0x00, 0x00, 0x00, 0x0c, 0x50, 0x4c, 0x54, 0x45, 0xff,
        0x00, 0x00, 0x00, 0xff, 0x00, 0x00, 0x00, 0xff, 0x33, 0x66, 0x99, 0x67, 0xe7, 0xfa,
        0xec, 0x00, 0x00, 0x00, 0x04, 0x74, 0x52, 0x4e, 0x53, 0xff, 0xff, 0xff, 0x33, 0xff,
        0xfa, 0xc8, 0xe2, 0x00, 0x00, 0x00, 0x0c, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63,
        0x10, 0x60, 0xd8, 0x00, 0x00, 0x00, 0xe4, 0x00, 0xc1, 0x19, 0x55, 0x3b, 0xfb, 0x00,
        0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
    static const uint8_t bitmap[] = {
        0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
        0x44, 0x52, 0x00, 0x00, 0x00, 0x03, 0x00, 0x00, 0x00, 0x01, 0x01, 0x00, 0x00, 0x00,
        0x00, 0x33, 0x9b, 0x29, 0x19, 0x00, 0x00, 0x00, 0x0a, 0x49, 0x44, 0x41, 0x54, 0x78,
        0xda, 0x63, 0x58, 0x00, 0x00, 0x00, 0xa2, 0x00, 0xa1, 0x71, 0x05, 0xcb, 0x41, 0x00,
        0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
    slv_image image;
    REQUIRE(load_bytes(palette, sizeof palette, &image) == SLV_OK);
    CHECK(image.width == 2 && image.height == 2 && image.nchannels == 4);
    CHECK(image.pixels[0] == 1.0f && image.pixels[5] == 1.0f && image.pixels[10] == 1.0f);
    CHECK(image.pixels[12] == 51 / 255.0f && image.pixels[14] == 153 / 255.0f &&
          image.pixels[15] == 51 / 255.0f);
    slv_image_free(&image);
    REQUIRE(load_bytes(bitmap, sizeof bitmap, &image) == SLV_OK);
    CHECK(image.nchannels == 1 && image.pixels[0] == 1.0f && image.pixels[1] == 0.0f &&
          image.pixels[2] == 1.0f);
    slv_image_free(&image);
}

/* Cut and spoilt files: an image or a message, and no more memory than the file can ask for. */
static void spoilt(const char *name, uint32_t bits) {
    slv_env env = test_env();
    slv_image image = random_image(19, 37, 4, 1.0f), back;
    slv_image_params params = {.encoding = SLV_ENCODE_RAW, .bits = bits};
    const char *path = test_path(name);
    REQUIRE(slv_image_save(&env, path, &image, &params) == SLV_OK);
    slv_image_free(&image);
    FILE *stream = fopen(path, "rb");
    REQUIRE(stream != NULL);
    static uint8_t bytes[1 << 16], copy[1 << 16];
    size_t size = fread(bytes, 1, sizeof bytes, stream);
    fclose(stream);
    remove(path);
    for (int round = 0; round < 400; round++) {
        size_t length = round % 2 ? size : 8 + test_random(&seed) % (size - 8);
        memcpy(copy, bytes, size);
        for (int i = 0; i < round % 4; i++)
            copy[8 + test_random(&seed) % (round % 3 ? size - 8 : 300)] ^=
                (uint8_t)(1u << test_random(&seed) % 8);
        test_last_log[0] = 0;
        slv_result result = load_bytes(copy, length, &back);
        CHECK(!result == !test_last_log[0] && !result == !!back.pixels);
        slv_image_free(&back);
    }
}

static void refusals(void) {
    slv_env env = test_env();
    slv_image image = random_image(2, 2, 3, 1.0f), back;
    slv_image_params params = {.encoding = SLV_ENCODE_SRGB, .bits = 12};
    CHECK(slv_image_save(&env, test_path("x.png"), &image, &params) == SLV_ERROR_ARGUMENT);
    CHECK(slv_image_save(&env, test_path("x.exr"), &image, &params) == SLV_ERROR_ARGUMENT);
    CHECK(slv_image_save(&env, test_path("x.jpg"), &image, NULL) == SLV_ERROR_UNSUPPORTED);
    CHECK(strstr(test_last_log, "x.jpg"));
    CHECK(slv_image_save(&env, "/nowhere/x.exr", &image, NULL) == SLV_ERROR_IO);
    CHECK(strstr(test_last_log, "/nowhere/x.exr"));
    CHECK(slv_image_save(&env, "/nowhere/x.png", &image, NULL) == SLV_ERROR_IO);
    CHECK(slv_image_load(&env, "/nowhere/x.png", &back) == SLV_ERROR_IO);
    CHECK(load_bytes("GIF89a", 6, &back) == SLV_ERROR_UNSUPPORTED && !back.pixels);
    slv_image_free(&image);
    CHECK(slv_image_create(&env, 0, 1, 3, &image) == SLV_ERROR_ARGUMENT);
    CHECK(slv_image_create(&env, 1, 1, 5, &image) == SLV_ERROR_ARGUMENT);
    env.max_bytes = 1000;
    CHECK(slv_image_create(&env, 100, 100, 1, &image) == SLV_ERROR_LIMIT && !image.pixels);
    slv_image_free(NULL);
}

int main(void) {
    test_folder_begin();
    for (uint32_t n = 1; n <= 4; n++) {
        for (uint32_t bits = 8; bits <= 16; bits += 8) {
            png_round_trip(7, 5, n, bits, SLV_ENCODE_SRGB);
            png_round_trip(7, 5, n, bits, SLV_ENCODE_RAW);
        }
        exr_round_trip(1, 1, n, 16);
        exr_round_trip(33, 40, n, 0);
        exr_round_trip(33, 40, n, 32);
        exr_round_trip(5, 16, n, 32);
    }
    exr_of_any_length();
    small_kinds();
    spoilt("s.png", 8);
    spoilt("s.exr", 16);
    refusals();
    CHECK_MSG(files_in_folder() == 0, "something was left in %s", test_folder);
    test_folder_end();
    return test_end();
}
