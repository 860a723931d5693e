/* An image of any bytes, PNG or OpenEXR: read, and what comes out written again. */
#include "kit/fuzz_kit.h"

#include <selvage/image.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    slv_env env = fuzz_env();
    slv_image image, again;
    int files = 1;
    fuzz_write("in", data, size);
    if (!FUZZ_CALL(slv_image_load(&env, fuzz_path("in"), &image))) {
        float sum = 0;
        size_t count = (size_t)image.width * image.height * image.nchannels;
        for (size_t i = 0; i < count; i++)
            sum += image.pixels[i];
        FUZZ_REQUIRE(image.width && image.height && image.nchannels >= 1 && image.nchannels <= 4,
                     "an image of %u x %u x %u, sum %g", image.width, image.height, image.nchannels,
                     (double)sum);
        const char *name = size & 1 ? "out.png" : "out.exr";
        slv_image_params params = {.encoding = SLV_ENCODE_RAW, .bits = size & 1 ? 16 : 32};
        if (count <= FUZZ_MAX_WRITTEN) {
            FUZZ_REQUIRE(!FUZZ_CALL(slv_image_save(&env, fuzz_path(name), &image, &params)) &&
                             !FUZZ_CALL(slv_image_load(&env, fuzz_path(name), &again)),
                         "not written or not read: %s", fuzz_last);
            FUZZ_REQUIRE(again.width == image.width && again.height == image.height &&
                             again.nchannels == image.nchannels,
                         "another size");
            slv_image_free(&again);
            files++;
        }
        slv_image_free(&image);
    } else {
        FUZZ_REQUIRE(!image.pixels, "pixels after a failure");
    }
    fuzz_clear(files);
    return 0;
}
