/* An index of images of any bytes. The images that a good one names lie beside it: keep_N.png of
 * N x N texels in RGB, and keep_a.exr of 4 x 4 in RGBA. */
#include "kit/fuzz_kit.h"

#include <selvage/exchange.h>
#include <selvage/image.h>

static void write_images(const slv_env *env) {
    static bool written;
    slv_image_params raw = {.encoding = SLV_ENCODE_RAW};
    for (uint32_t side = 1; side <= 8 && !written; side *= 2) {
        slv_image image;
        char name[32];
        snprintf(name, sizeof name, "keep_%u.png", side);
        FUZZ_REQUIRE(!slv_image_create(env, side, side, 3, &image), "no image");
        for (uint32_t i = 0; i < side * side * 3; i++)
            image.pixels[i] = (float)(i % 7) / 7;
        FUZZ_REQUIRE(!slv_image_save(env, fuzz_path(name), &image, &raw), "no image");
        slv_image_free(&image);
    }
    slv_image image;
    if (!written) {
        FUZZ_REQUIRE(!slv_image_create(env, 4, 4, 4, &image), "no image");
        FUZZ_REQUIRE(!slv_image_save(env, fuzz_path("keep_a.exr"), &image, &raw), "no image");
        slv_image_free(&image);
    }
    written = true;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    const slv_exchange_params params = {.scale_log2 = size & 1 ? -1 : 0};
    slv_env env = fuzz_env();
    slv_exchange *source = NULL;
    slv_ptx *ptx = NULL;
    char index[300], out[300];
    write_images(&env);
    snprintf(index, sizeof index, "%s", fuzz_path("index.json"));
    snprintf(out, sizeof out, "%s", fuzz_path("out.ptx"));
    fuzz_write("index.json", data, size);
    bool written = !FUZZ_CALL(slv_exchange_open(&env, index, &source)) &&
                   !FUZZ_CALL(slv_exchange_to_ptx(&env, source, &params, out, NULL));
    slv_exchange_close(source);
    if (written) {
        slv_texture *texture = NULL;
        FUZZ_REQUIRE(!FUZZ_CALL(slv_ptx_open(&env, out, &ptx)) &&
                         !FUZZ_CALL(slv_ptx_load_tables(ptx)) &&
                         !FUZZ_CALL(slv_ptx_load_texture(&env, ptx, &texture)),
                     "not readable: %s", fuzz_last);
        slv_texture_destroy(texture);
        slv_ptx_close(ptx);
    }
    fuzz_clear(1 + written);
    return 0;
}
