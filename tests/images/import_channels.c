/* Pictures that another program saved with other channels or depths than they were exported with:
 * what they become in a texture of one to four channels, and what is said of alpha. */
#include "kit/tool_kit.h"

#include <selvage/image.h>
#include <selvage/texture.h>

enum { SIDE = 16, FACE = 3 };

static uint64_t seed = 21;

/* A picture of `have` channels; colours are grey where `grey`, alpha is 1 where `opaque`. Values
 * are such that every type holds them. */
static slv_image picture(uint32_t have, bool grey, bool opaque) {
    slv_env env = test_env();
    slv_image image;
    REQUIRE(!slv_image_create(&env, SIDE, SIDE, have, &image));
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        for (uint32_t c = 0; c < have; c++) {
            bool alpha = have % 2 == 0 && c == have - 1;
            float value = (float)(test_random(&seed) % 256) / 255;
            image.pixels[i * have + c] = alpha && opaque       ? 1
                                         : !alpha && c && grey ? image.pixels[i * have]
                                                               : value;
        }
    return image;
}

static float wanted(const slv_image *image, uint32_t needed, uint32_t pixel, uint32_t c) {
    const float *from = image->pixels + pixel * image->nchannels;
    if (needed % 2 == 0 && c == needed - 1)
        return image->nchannels % 2 == 0 ? from[image->nchannels - 1] : 1;
    return image->nchannels < 3 ? from[0] : from[c];
}

static void check_texels(slv_type type, uint32_t needed, const slv_image *image, const char *what) {
    static uint8_t texels[SIDE * SIDE * 16];
    static float values[SIDE * SIDE * 4];
    uint32_t wrong = 0;
    slv_ptx *ptx = tool_open("back.ptx");
    REQUIRE(!slv_ptx_read_face(ptx, FACE, (slv_res){4, 4}, texels));
    slv_ptx_close(ptx);
    slv_type_to_float(type, texels, SIDE * SIDE * needed, values);
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++)
            for (uint32_t c = 0; c < needed; c++) {
                float value = values[((SIDE - 1 - y) * SIDE + x) * needed + c];
                wrong += fabsf(value - wanted(image, needed, y * SIDE + x, c)) > 0.0005f;
            }
    CHECK_MSG(!wrong, "%s of %u channels for %s of %u: %u values are wrong", what, image->nchannels,
              slv_type_name(type), needed, wrong);
}

static void check_pair(slv_type type, uint32_t needed, uint32_t have, const char *name,
                       uint32_t bits) {
    slv_env env = test_env();
    slv_image_params params = {.encoding = SLV_ENCODE_RAW, .bits = bits};
    for (int opaque = 0; opaque < 2; opaque++) {
        slv_image image = picture(have, needed < 3, opaque);
        REQUIRE(!slv_image_save(&env, tool_path(name), &image, &params));
        RUNS(0, "convert faces back.ptx");
        check_texels(type, needed, &image, name);
        if (have % 2 == 0 && needed % 2 && !opaque)
            HAS("its alpha is not 1 everywhere and is lost");
        else
            LACKS("is lost");
        if (have % 2 && needed % 2 == 0)
            HAS("has no alpha, and the texture has: it becomes 1");
        else
            LACKS("has no alpha");
        slv_image_free(&image);
    }
    if (have < 3 || needed > 2)
        return;
    slv_image image = picture(have, false, false);
    REQUIRE(!slv_image_save(&env, tool_path(name), &image, &params));
    remove(tool_path("back.ptx"));
    RUNS(1, "convert faces back.ptx");
    HAS(name);
    HAS("has a colour");
    CHECK(access(tool_path("back.ptx"), F_OK) != 0);
    slv_image_free(&image);
}

static void check_type(slv_type type) {
    bool exr = type == SLV_TYPE_HALF || type == SLV_TYPE_FLOAT;
    for (uint32_t needed = 1; needed <= 4; needed++) {
        tool_write_noise("original.ptx", type, needed,
                         needed % 2 ? SLV_NO_ALPHA : (int32_t)needed - 1, 4);
        RUNS(0, "convert original.ptx faces");
        for (uint32_t have = 1; have <= 4; have++)
            for (uint32_t bits = exr ? 16 : 8; bits <= (exr ? 32u : 16u); bits *= 2) {
                if (test_skip(needed + have + bits / (exr ? 32 : 16), 2))
                    continue;
                check_pair(type, needed, have,
                           exr ? "faces/face_000003.exr" : "faces/face_000003.png", bits);
            }
    }
}

/* Files of one ending get another, in the index too. */
static void rename_all(const char *index, const char *from, const char *to) {
    char line[1024];
    snprintf(line, sizeof line,
             "cd $(dirname '%s') && for f in *.%s; do mv $f ${f%%.%s}.%s; done && "
             "sed -i 's/[.]%s\"/.%s\"/g' $(basename '%s')",
             tool_path(index), from, from, to, from, to, index);
    CHECK(system(line) == 0);
}

/* Pictures under the name of the other format are what their bytes say, colours included: of a
 * folder, and of a sheet. */
static void check_name(slv_type type, const char *format, const char *other, const char *close) {
    tool_write_noise("original.ptx", type, 4, 3, 5);
    RUNS(0, "convert original.ptx as_%s --format %s", format, format);
    RUNS(0, "convert as_%s plain.ptx", format);
    RUNS(0, "diff original.ptx plain.ptx --tolerance %s", close);
    char index[64];
    snprintf(index, sizeof index, "as_%s/index.json", format);
    rename_all(index, format, other);
    RUNS(0, "convert as_%s renamed.ptx", format);
    RUNS(0, "diff plain.ptx renamed.ptx");
    RUNS(0, "convert original.ptx sheet.%s", format);
    RUNS(0, "convert sheet.json plain.ptx");
    rename_all("sheet.json", format, other);
    RUNS(0, "convert sheet.json renamed.ptx");
    RUNS(0, "diff plain.ptx renamed.ptx");
}

int main(void) {
    tool_begin();
    check_type(SLV_TYPE_U8);
    check_type(SLV_TYPE_HALF);
    check_name(SLV_TYPE_U8, "exr", "png", "0.004");
    check_name(SLV_TYPE_U8, "png", "exr", "0");
    check_name(SLV_TYPE_HALF, "exr", "png", "0");
    check_name(SLV_TYPE_HALF, "png", "exr", "0.004");
    tool_end();
    return test_end();
}
