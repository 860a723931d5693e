/* The command `selvage info --sheet`: every face is where it should be, the right way up. */
#include "kit/tool_kit.h"

#include <selvage/image.h>

static slv_ptx_writer *begin(const char *name, slv_ptx_mesh_type mesh_type, slv_type type,
                             uint32_t nchannels, int32_t alpha, uint32_t nfaces) {
    slv_env env = test_env();
    slv_ptx_writer_params params = {.mesh_type = mesh_type,
                                    .type = type,
                                    .nchannels = nchannels,
                                    .alpha_channel = alpha,
                                    .nfaces = nfaces};
    slv_ptx_writer *writer = NULL;
    REQUIRE(!slv_ptx_writer_create(&env, tool_path(name), &params, &writer));
    return writer;
}

static void put(slv_ptx_writer *writer, uint32_t face, slv_res res, const void *texels) {
    slv_ptx_face info = {.res = res, .adjacency = {{-1, -1, -1, -1}, {0}}};
    REQUIRE(!slv_ptx_writer_write_face(writer, face, &info, texels));
}

static void end(slv_ptx_writer *writer) {
    REQUIRE(!slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
}

static slv_image load(const char *name) {
    slv_env env = test_env();
    slv_image image = {0};
    REQUIRE(!slv_image_load(&env, tool_path(name), &image));
    return image;
}

static bool pixel_is(const slv_image *image, uint32_t x, uint32_t y, float r, float g, float b,
                     float a) {
    const float *p = image->pixels + ((size_t)y * image->width + x) * image->nchannels;
    const float expected[4] = {r, image->nchannels == 2 ? a : g, b, a};
    bool same = x < image->width && y < image->height;
    for (uint32_t c = 0; c < image->nchannels && same; c++)
        same = fabsf(p[c] - expected[c]) < 0.003f;
    return same;
}

#define PIXEL(image, x, y, r, g, b, a)                                                             \
    CHECK_MSG(                                                                                     \
        pixel_is(&(image), x, y, r, g, b, a), "pixel %d,%d: %g %g %g", x, y,                       \
        (double)(image).pixels[((y) * (int)(image).width + (x)) * (int)(image).nchannels],         \
        (double)(image).pixels[((y) * (int)(image).width + (x)) * (int)(image).nchannels + 1],     \
        (double)(image).pixels[((y) * (int)(image).width + (x)) * (int)(image).nchannels + 2])

/* Face 0 is 2x2 in four colours, face 1 wide, face 2 constant, face 3 large. */
static void check_quads(void) {
    static const uint8_t four[] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
    static uint8_t flat[3 * 32 * 32];
    static uint8_t wide[3 * 16 * 4], large[3 * 256 * 256];
    slv_ptx_writer *writer = begin("quads.ptx", SLV_PTX_QUAD, SLV_TYPE_U8, 3, SLV_NO_ALPHA, 4);
    memset(wide, 255, sizeof wide);
    wide[0] = 254;
    for (int i = 0; i < 3 * 32 * 32; i++)
        flat[i] = (uint8_t)(10 + i % 3 * 10);
    for (int i = 0; i < 256 * 256; i++)
        large[3 * i] = (uint8_t)(i / 256 < 128 ? 255 * (i % 2) : 0);
    put(writer, 0, (slv_res){1, 1}, four);
    put(writer, 1, (slv_res){4, 2}, wide);
    put(writer, 2, (slv_res){5, 5}, flat);
    put(writer, 3, (slv_res){8, 8}, large);
    end(writer);
    RUNS(0, "info quads.ptx --sheet quads.png --cell 16");
    HAS("quads.png: 34 x 34 pixels, 2 x 2 cells of 16");
    slv_image image = load("quads.png");
    REQUIRE(image.width == 34 && image.height == 34 && image.nchannels == 3);
    /* v goes up: the first texel is at the bottom left */
    PIXEL(image, 0, 15, 1, 0, 0, 1);
    PIXEL(image, 15, 15, 0, 1, 0, 1);
    PIXEL(image, 0, 0, 0, 0, 1, 1);
    PIXEL(image, 15, 0, 1, 1, 1, 1);
    PIXEL(image, 16, 0, 0, 0, 0, 1);
    /* a quarter as high as wide, in the middle of its cell */
    PIXEL(image, 18, 5, 0, 0, 0, 1);
    PIXEL(image, 19, 6, 1, 1, 1, 1);
    PIXEL(image, 33, 9, 1, 1, 1, 1);
    PIXEL(image, 18, 10, 0, 0, 0, 1);
    PIXEL(image, 7, 25, 10 / 255.0f, 20 / 255.0f, 30 / 255.0f, 1);
    /* stripes of one texel become their mean, in the lower half */
    PIXEL(image, 20, 33, 127 / 255.0f, 0, 0, 1);
    PIXEL(image, 20, 18, 0, 0, 0, 1);
    slv_image_free(&image);
    RUNS(0, "info quads.ptx --sheet some.png --cell 2 --sheet-faces 2-3,0 --json");
    HAS("\"shown\": 3");
    HAS("\"columns\": 2");
    image = load("some.png");
    CHECK(image.width == 4 && image.height == 4);
    PIXEL(image, 0, 0, 10 / 255.0f, 20 / 255.0f, 30 / 255.0f, 1);
    PIXEL(image, 0, 3, 1, 0, 0, 1);
    slv_image_free(&image);
    RUNS(0, "info quads.ptx --sheet auto.exr");
    HAS("514 x 514 pixels, 2 x 2 cells of 256");
    image = load("auto.exr");
    PIXEL(image, 259, 513, 1, 0, 0, 1);
    PIXEL(image, 258, 513, 0, 0, 0, 1);
    slv_image_free(&image);
}

static void check_alpha(void) {
    static const float texels[2 * 4] = {0.5f, 0.25f, 1, 0.5f, 0, 0, 0, 0};
    slv_ptx_writer *writer = begin("alpha.ptx", SLV_PTX_QUAD, SLV_TYPE_FLOAT, 4, 3, 1);
    put(writer, 0, (slv_res){1, 0}, texels);
    end(writer);
    RUNS(0, "info alpha.ptx --sheet alpha.exr --cell 4");
    slv_image image = load("alpha.exr");
    PIXEL(image, 0, 1, 0.25f, 0.125f, 0.5f, 0.5f);
    PIXEL(image, 3, 2, 0, 0, 0, 0);
    slv_image_free(&image);
    RUNS(0, "info alpha.ptx --sheet raw.png --cell 4 --encoding raw");
    image = load("raw.png");
    PIXEL(image, 0, 1, 0.5f, 0.25f, 1, 0.5f);
    slv_image_free(&image);
    RUNS(0, "info alpha.ptx --sheet srgb.png --cell 4");
    image = load("srgb.png");
    PIXEL(image, 0, 1, 0.735f, 0.537f, 1, 0.5f);
    slv_image_free(&image);
    static const uint16_t two[] = {65535, 32768};
    writer = begin("two.ptx", SLV_PTX_QUAD, SLV_TYPE_U16, 2, 0, 1);
    put(writer, 0, (slv_res){0, 0}, two);
    end(writer);
    RUNS(0, "info two.ptx --sheet two.png --cell 1");
    image = load("two.png");
    CHECK(image.nchannels == 2);
    PIXEL(image, 0, 0, 0.5f, 0, 0, 1);
    slv_image_free(&image);
}

/* The even texels of a triangle are white, the odd ones black. */
static void check_triangles(void) {
    uint8_t texels[16];
    slv_ptx_writer *writer = begin("tri.ptx", SLV_PTX_TRIANGLE, SLV_TYPE_U8, 1, SLV_NO_ALPHA, 2);
    for (int i = 0; i < 16; i++)
        texels[i] = i % 4 + i / 4 < 4 ? 255 : 0;
    put(writer, 0, (slv_res){2, 2}, texels);
    memset(texels, 77, sizeof texels);
    put(writer, 1, (slv_res){2, 2}, texels);
    end(writer);
    RUNS(0, "info tri.ptx --sheet tri.png --cell 32");
    slv_image image = load("tri.png");
    CHECK(image.nchannels == 1 && image.width == 66 && image.height == 32);
    PIXEL(image, 0, 31, 1, 0, 0, 1);
    PIXEL(image, 7, 24, 0, 0, 0, 1);
    PIXEL(image, 30, 31, 1, 0, 0, 1);
    PIXEL(image, 16, 8, 0, 0, 0, 1);
    PIXEL(image, 34, 31, 77 / 255.0f, 0, 0, 1);
    PIXEL(image, 64, 31, 77 / 255.0f, 0, 0, 1);
    PIXEL(image, 64, 2, 0, 0, 0, 1);
    slv_image_free(&image);
    RUNS(0, "info tri.ptx --sheet tri.png --cell 4");
    image = load("tri.png");
    PIXEL(image, 0, 3, 127.5f / 255, 0, 0, 1);
    PIXEL(image, 3, 3, 1, 0, 0, 1);
    slv_image_free(&image);
}

static void check_many(void) {
    slv_ptx_writer *writer = begin("many.ptx", SLV_PTX_QUAD, SLV_TYPE_U8, 1, SLV_NO_ALPHA, 100000);
    for (uint32_t face = 0; face < 100000; face++) {
        uint8_t value = (uint8_t)(face % 251);
        put(writer, face, (slv_res){3, 3}, (uint8_t[64]){value, 0});
    }
    end(writer);
    RUNS(0, "info many.ptx --sheet many.png");
    HAS("3168 x 3158 pixels, 317 x 316 cells of 8");
    LACKS("left out");
    RUNS(0, "info many.ptx --sheet many.png --cell 1000 --sheet-faces 5-99999 --progress");
    HAS("99963 of 99995 faces are left out");
    HAS("sheet: 100%");
    HAS("writing: 100%");
    HAS("4 x 8 cells of 1000");
}

static void check_usage(void) {
    RUNS(2, "info quads.ptx --sheet quads.jpg");
    RUNS(2, "info quads.ptx --cell 4");
    RUNS(2, "info quads.ptx --sheet x.png --cell 5000");
    RUNS(2, "info quads.ptx --sheet x.png --sheet-faces 4");
    HAS("--sheet-faces: '4': the file has faces 0 to 3");
    RUNS(2, "info quads.ptx --sheet x.png --sheet-faces 1,0-11");
    HAS("--sheet-faces: '1,0-11': the file has faces 0 to 3");
    RUNS(2, "info quads.ptx --sheet x.png --sheet-faces 0-99999999999999999999");
    HAS("the file has faces 0 to 3");
    RUNS(2, "info quads.ptx --sheet x.png --sheet-faces 3-2");
    HAS("--sheet-faces: '3-2' is not a list such as 0-99,250");
    RUNS(2, "info quads.ptx --sheet x.png --sheet-faces 1,");
    RUNS(2, "info quads.ptx --sheet x.png --sheet-faces -1");
    RUNS(1, "info quads.ptx --sheet nowhere/x.png");
    tool_write_file("mesh.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", 32);
    RUNS(2, "info mesh.obj --sheet x.png");
    CHECK(access(tool_path("x.png"), F_OK) != 0);
}

int main(void) {
    tool_begin();
    check_quads();
    check_alpha();
    check_triangles();
    check_many();
    check_usage();
    tool_end();
    return test_end();
}
