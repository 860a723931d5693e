/* One rule for colours in every verb: what a texture's 128 becomes in pictures, by its type, by
 * what the file says, and by --texture-encoding. */
#include "kit/tool_kit.h"

#include <selvage/image.h>

#define VIEW "--shading unlit --azimuth 0 --elevation 60 --size 48x48 -q"
#define LIGHT 0.2158f /* of 128 */

/* The first channel of a pixel in the middle of a face. */
static float shown(const char *name) {
    slv_env env = test_env();
    slv_image image = {0};
    REQUIRE(!slv_image_load(&env, tool_path(name), &image));
    const float *pixel =
        image.pixels + (image.height / 2 * image.width + image.width / 2) * image.nchannels;
    if (image.nchannels == 3) /* a sheet, between whose cells there is black */
        pixel = image.pixels + (image.width + 1) * 3;
    float value = pixel[0];
    if (strstr(name, ".png") && image.encoding == SLV_TEXTURE_LINEAR)
        slv_texels_encode(1, SLV_NO_ALPHA, &value, 1); /* what it says of itself */
    slv_image_free(&image);
    return value;
}

static void is(const char *name, float wanted) {
    float value = shown(name);
    CHECK_MSG(fabsf(value - wanted) < 0.002f, "%s: %g, expected %g", name, (double)value,
              (double)wanted);
}

#define BYTE(x) ((float)(x) / 255)

/* render, reference, info --sheet and convert of a file, with one --texture-encoding or none. */
static void check_pictures(const char *file, const char *options, float png, float value) {
    RUNS(0, "render %s %s " VIEW " -o r.png", file, options);
    is("r.png", png);
    RUNS(0, "reference %s %s " VIEW " -n 4 -o ref.exr", file, options);
    is("ref.exr", value);
    RUNS(0, "info %s %s --sheet s.png", file, options);
    is("s.png", png);
    RUNS(0, "convert %s %s faces.png", file, options);
    is("faces.png", png);
}

/* Those, the same as light, and back from the images. */
static void check_verbs(const char *file, const char *options, float png, float value) {
    check_pictures(file, options, png, value);
    RUNS(0, "render %s %s " VIEW " -o r.exr", file, options);
    is("r.exr", value);
    RUNS(0, "info %s %s --sheet s.exr", file, options);
    is("s.exr", value);
    RUNS(0, "convert faces.json back.ptx");
    LACKS("not used");
    RUNS(0, "diff %s back.ptx --texels --tolerance 0.003", file);
    RUNS(0, "convert %s %s faces.exr", file, options);
    is("faces.exr", value);
    RUNS(0, "convert faces.json back.ptx");
    RUNS(0, "diff %s back.ptx --texels --tolerance 0.0005", file);
}

static void check_default(const char *file, float png) {
    check_pictures(file, "", png, png == BYTE(188) ? BYTE(128) : LIGHT);
}

static void check_encodings(const char *file) {
    float linear = BYTE(188);
    check_verbs(file, "--texture-encoding srgb", BYTE(128), LIGHT);
    if (!test_brief())
        check_verbs(file, "--texture-encoding linear", linear, BYTE(128));
    check_verbs(file, "--texture-encoding data", BYTE(128), BYTE(128));
}

static void check_raw(void) {
    RUNS(0, "render u8.ptx --raw " VIEW " -o r.png");
    is("r.png", BYTE(128));
    RUNS(0, "render u8.ptx --raw --texture-encoding srgb " VIEW " -o r.png");
    is("r.png", LIGHT);
    RUNS(0, "info u8.ptx --encoding raw --sheet s.png");
    is("s.png", BYTE(128));
    RUNS(0, "info half.ptx --encoding raw --sheet s.png");
    is("s.png", BYTE(128));
}

/* Grey with alpha is grey, as sheets have it, and not red and green. */
static void check_grey(void) {
    RUNS(0, "convert u8.ptx grey.ptx --channels 0,=1 --alpha 1");
    RUNS(0, "convert grey.ptx rgba.ptx --channels 0,0,0,1 --alpha 3");
    static const char *const strategies[] = {"clamp", "borders", "traverse", "discard", "htex"};
    for (uint32_t i = 0; i < sizeof strategies / sizeof *strategies; i++) {
        if (test_skip(i, 4))
            continue;
        slv_env env = test_env();
        slv_image images[2];
        static const char *const names[] = {"grey", "rgba"};
        for (int k = 0; k < 2; k++) {
            RUNS(0, "render %s.ptx -s %s " VIEW " -o %s.png", names[k], strategies[i], names[k]);
            char file[16];
            snprintf(file, sizeof file, "%s.png", names[k]);
            is(file, BYTE(128));
            REQUIRE(!slv_image_load(&env, tool_path(file), &images[k]));
        }
        size_t count = (size_t)images[0].width * images[0].height * images[0].nchannels;
        CHECK_MSG(memcmp(images[0].pixels, images[1].pixels, count * sizeof(float)) == 0, "%s",
                  strategies[i]);
        slv_image_free(&images[0]);
        slv_image_free(&images[1]);
    }
}

/* Lookups are numbers unless light is asked for. */
static void check_sample(void) {
    const char *line = "box 0 0 0 1 0 0 1 0 0.5 0.5 0.2 0 0 0.2\n";
    tool_write_file("q.txt", line, strlen(line));
    RUNS(0, "sample u8.ptx -i q.txt");
    HAS("-> 0.50196");
    RUNS(0, "sample u8.ptx -i q.txt --texture-encoding srgb");
    HAS("-> 0.2158");
    RUNS(0, "sample u8.ptx -i q.txt --texture-encoding auto");
    HAS("-> 0.2158");
    RUNS(0, "sample half.ptx -i q.txt --texture-encoding auto");
    HAS("-> 0.50");
}

/* A texture of bytes that becomes half is sRGB still, and says so; back, it need not. */
static void check_notes(void) {
    RUNS(0, "convert u8.ptx noted.ptx --type half");
    RUNS(0, "info noted.ptx --meta");
    HAS("TextureEncoding");
    HAS("srgb");
    check_default("noted.ptx", BYTE(128));
    RUNS(0, "convert noted.ptx back.ptx --type uint8");
    RUNS(0, "diff u8.ptx back.ptx");
    RUNS(0, "convert half.ptx noted.ptx --type uint16");
    check_default("noted.ptx", BYTE(188));
    RUNS(0, "convert u8.ptx noted.ptx --texture-encoding linear");
    check_default("noted.ptx", BYTE(188));
    RUNS(0, "convert u8.ptx faces --texture-encoding data");
    RUNS(0, "convert faces noted.ptx");
    check_pictures("noted.ptx", "", BYTE(128), BYTE(128));
    RUNS(2, "render u8.ptx --texture-encoding rec709 -o r.png");
    HAS("--texture-encoding");
}

int main(void) {
    tool_begin();
    tool_write_noise("noise.ptx", SLV_TYPE_U8, 3, SLV_NO_ALPHA, 3);
    RUNS(0, "convert noise.ptx u8.ptx --channels =0.5019608,=0.5019608,=0.5019608");
    RUNS(0, "convert u8.ptx u16.ptx --type uint16");
    RUNS(0, "convert u8.ptx half.ptx --type half --texture-encoding linear");
    RUNS(0, "convert u8.ptx float.ptx --type float --texture-encoding linear");
    check_default("u8.ptx", BYTE(128));
    check_default("half.ptx", BYTE(188));
    check_encodings("u8.ptx");
    if (!test_brief()) {
        check_default("u16.ptx", BYTE(128));
        check_default("float.ptx", BYTE(188));
        check_encodings("half.ptx");
    }
    check_raw();
    check_grey();
    check_sample();
    check_notes();
    tool_end();
    return test_end();
}
