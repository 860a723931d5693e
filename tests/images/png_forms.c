/* PNG files of every colour type, depth, interlacing and transparency, written by libpng, and what
 * slv_image_load makes of them: the values that were meant. */
#include "kit/test.h"

#include <selvage/image.h>

#include <png.h>
#include <unistd.h>

enum { MAX_SIDE = 19 };

typedef struct png_form {
    int colour, bits; /* as PNG has them */
    bool interlaced, transparent, gamma;
    uint32_t width, height;
} png_form;

static uint64_t seed = 5;
static char path[512];

static uint32_t raw_channels(const png_form *form) {
    static const uint32_t channels[] = {1, 0, 3, 1, 2, 0, 4};
    return channels[form->colour];
}

static uint32_t meant_channels(const png_form *form) {
    uint32_t n = form->colour == PNG_COLOR_TYPE_PALETTE ? 3 : raw_channels(form);
    return n + form->transparent;
}

static void pack(const png_form *form, const uint16_t *values, uint8_t *rows, size_t row_size) {
    uint32_t n = raw_channels(form);
    memset(rows, 0, row_size * form->height);
    for (uint32_t y = 0; y < form->height; y++)
        for (uint32_t i = 0; i < form->width * n; i++) {
            uint16_t value = values[y * form->width * n + i];
            uint8_t *row = rows + y * row_size;
            if (form->bits == 16) {
                row[2 * i] = (uint8_t)(value >> 8);
                row[2 * i + 1] = (uint8_t)value;
            } else {
                uint32_t bit = i * (uint32_t)form->bits;
                row[bit / 8] |= (uint8_t)(value << (8 - (uint32_t)form->bits - bit % 8));
            }
        }
}

static void write_png(const png_form *form, uint8_t *rows, size_t row_size,
                      const png_color *colours, const uint8_t *alphas, const png_color_16 *key) {
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    png_bytep pointers[MAX_SIDE];
    FILE *file = fopen(path, "wb");
    REQUIRE(info && file);
    for (uint32_t y = 0; y < form->height; y++)
        pointers[y] = rows + y * row_size;
    png_init_io(png, file);
    png_set_IHDR(png, info, form->width, form->height, form->bits, form->colour,
                 form->interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (form->gamma)
        png_set_gAMA(png, info, 0.45455);
    if (form->colour == PNG_COLOR_TYPE_PALETTE)
        png_set_PLTE(png, info, colours, 1 << form->bits);
    if (form->transparent)
        png_set_tRNS(png, info, alphas,
                     form->colour == PNG_COLOR_TYPE_PALETTE ? 1 << form->bits : 0, key);
    png_write_info(png, info);
    png_write_image(png, pointers);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    fclose(file);
}

/* What the pixel at `raw` stands for. */
static void meant(const png_form *form, const uint16_t *raw, const png_color *colours,
                  const uint8_t *alphas, const png_color_16 *key, float out[4]) {
    uint32_t n = raw_channels(form), most = (1u << form->bits) - 1;
    if (form->colour == PNG_COLOR_TYPE_PALETTE) {
        png_color colour = colours[raw[0]];
        out[0] = (float)colour.red / 255;
        out[1] = (float)colour.green / 255;
        out[2] = (float)colour.blue / 255;
        out[3] = (float)alphas[raw[0]] / 255;
        return;
    }
    for (uint32_t c = 0; c < n; c++)
        out[c] = (float)raw[c] / (float)most;
    bool is_key = n == 1 ? raw[0] == key->gray
                         : raw[0] == key->red && raw[1] == key->green && raw[2] == key->blue;
    if (form->transparent)
        out[n] = is_key ? 0.0f : 1.0f;
}

static void check_form(const png_form *form) {
    static uint16_t values[MAX_SIDE * MAX_SIDE * 4];
    static uint8_t rows[MAX_SIDE * MAX_SIDE * 8];
    png_color colours[256];
    uint8_t alphas[256];
    slv_env env = test_env();
    slv_image image;
    uint32_t n = raw_channels(form), count = form->width * form->height, wrong = 0;
    for (uint32_t i = 0; i < 256; i++) {
        colours[i] = (png_color){(uint8_t)test_random(&seed), (uint8_t)test_random(&seed),
                                 (uint8_t)test_random(&seed)};
        alphas[i] = (uint8_t)test_random(&seed);
    }
    for (uint32_t i = 0; i < count * n; i++)
        values[i] = (uint16_t)(test_random(&seed) & ((1u << form->bits) - 1));
    png_color_16 key = {.gray = values[0], .red = values[0], .green = values[1], .blue = values[2]};
    size_t row_size = (form->width * n * (uint32_t)form->bits + 7) / 8;
    pack(form, values, rows, row_size);
    write_png(form, rows, row_size, colours, alphas, &key);
    REQUIRE(slv_image_load(&env, path, &image) == SLV_OK);
    REQUIRE(image.width == form->width && image.height == form->height &&
            image.nchannels == meant_channels(form));
    for (uint32_t i = 0; i < count; i++) {
        float wanted[4];
        meant(form, values + i * n, colours, alphas, &key, wanted);
        for (uint32_t c = 0; c < image.nchannels; c++)
            wrong += fabsf(image.pixels[i * image.nchannels + c] - wanted[c]) > 1e-7f;
    }
    CHECK_MSG(!wrong,
              "colour type %d, %d bits, interlaced %d, tRNS %d, %u x %u: %u values are wrong",
              form->colour, form->bits, form->interlaced, form->transparent, form->width,
              form->height, wrong);
    slv_image_free(&image);
}

/* Colour spaces that are not converted are named, each by what says so. */
static void check_space(const char *what, const char *warning) {
    static const double p3[8] = {0.3127, 0.329, 0.68, 0.32, 0.265, 0.69, 0.15, 0.06},
                        srgb[8] = {0.3127, 0.329, 0.64, 0.33, 0.3, 0.6, 0.15, 0.06};
    const double *xy = strstr(what, "P3") ? p3 : srgb;
    static png_byte pixel[3] = {10, 20, 30}, bt2100[4] = {9, 16, 0, 1};
    png_bytep row = pixel;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    FILE *file = fopen(path, "wb");
    slv_env env = test_env();
    slv_image image = {0};
    REQUIRE(info && file);
    png_init_io(png, file);
    png_set_IHDR(png, info, 1, 1, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info); /* chunks that the library would not write are written by hand */
    if (strstr(what, "cHRM")) {
        png_byte chunk[32];
        for (int i = 0; i < 8; i++)
            png_save_uint_32(chunk + 4 * i, (png_uint_32)(xy[i] * 100000 + 0.5));
        png_write_chunk(png, (png_const_bytep) "cHRM", chunk, sizeof chunk);
    }
    if (strstr(what, "cICP"))
        png_write_chunk(png, (png_const_bytep) "cICP", bt2100, sizeof bt2100);
    if (strstr(what, "iCCP"))
        png_write_chunk(png, (png_const_bytep) "iCCP",
                        (png_const_bytep)(strstr(what, "P3") ? "Display P3\0\0x" : "my sRGB\0\0x"),
                        strstr(what, "P3") ? 13 : 10);
    png_write_row(png, row);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    fclose(file);
    test_last_log[0] = 0;
    REQUIRE(slv_image_load(&env, path, &image) == SLV_OK);
    CHECK_MSG(warning ? strstr(test_last_log, warning) != NULL : !test_last_log[0], "%s: '%s'",
              what, test_last_log);
    slv_image_free(&image);
}

static void check_spaces(void) {
    check_space("cHRM of sRGB", NULL);
    check_space("cHRM of P3", "cHRM: other primaries");
    check_space("iCCP of sRGB", NULL);
    check_space("iCCP of P3", "iCCP: profile 'Display P3'");
    check_space("cICP", "cICP: primaries 9, transfer 16");
    check_space("nothing", NULL);
}

int main(void) {
    static const struct {
        int colour, bits[6];
    } types[] = {{PNG_COLOR_TYPE_GRAY, {1, 2, 4, 8, 16}},
                 {PNG_COLOR_TYPE_RGB, {8, 16}},
                 {PNG_COLOR_TYPE_PALETTE, {1, 2, 4, 8}},
                 {PNG_COLOR_TYPE_GRAY_ALPHA, {8, 16}},
                 {PNG_COLOR_TYPE_RGB_ALPHA, {8, 16}}};
    snprintf(path, sizeof path, "%s/selvage_png_XXXXXX", test_parent());
    int made = mkstemp(path);
    REQUIRE(made >= 0);
    close(made);
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        for (const int *bits = types[i].bits; *bits; bits++)
            for (unsigned flags = 0; flags < 8; flags++) {
                png_form form = {.colour = types[i].colour,
                                 .bits = *bits,
                                 .interlaced = flags & 1,
                                 .transparent = flags & 2,
                                 .gamma = flags & 4};
                if (form.transparent && form.colour & PNG_COLOR_MASK_ALPHA)
                    continue;
                for (uint32_t round = 0; round < test_effort(10); round++) {
                    form.width = 1 + test_random(&seed) % MAX_SIDE;
                    form.height = 1 + test_random(&seed) % MAX_SIDE;
                    check_form(&form);
                }
            }
    check_spaces();
    remove(path);
    return test_end();
}
