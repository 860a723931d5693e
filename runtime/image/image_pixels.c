/* Pixels in memory, and how far the writing of them is. */
#include "base/memory.h"
#include "base/names.h"
#include "base/progress.h"
#include "image/image_file.h"

#include <string.h>

slv_result slvi_image_check_size(const slv_env *env, uint32_t width, uint32_t height,
                                 uint32_t nchannels) {
    if (width < 1 || height < 1 || width > IMAGE_MAX_SIDE || height > IMAGE_MAX_SIDE ||
        nchannels < 1 || nchannels > 4)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "an image of %u x %u pixels with %u channels; 1 to %d pixels and 1 to 4 "
                         "channels are possible",
                         width, height, nchannels, IMAGE_MAX_SIDE);
    return SLV_OK;
}

const char *slv_image_encoding_name(slv_image_encoding encoding) {
    static const char *const names[] = {"srgb", "raw", "linear"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)encoding);
}

slv_result slv_image_create(const slv_env *env, uint32_t width, uint32_t height, uint32_t nchannels,
                            slv_image *out) {
    memset(out, 0, sizeof *out);
    slv_result result = slvi_image_check_size(env, width, height, nchannels);
    if (!result)
        result = slvi_alloc(env, "image", (uint64_t)width * height, nchannels * sizeof(float),
                            &out->pixels);
    if (!result) {
        out->width = width;
        out->height = height;
        out->nchannels = nchannels;
    }
    return result;
}

void slv_image_free(slv_image *image) {
    if (!image)
        return;
    slvi_free(image->pixels);
    memset(image, 0, sizeof *image);
}

slv_result slvi_image_progress(const slv_env *env, const char *path, const slv_image_params *params,
                               const slv_image *image, uint32_t rows) {
    return slvi_progress(&params->progress, env, path, rows, image->height);
}

slv_result slvi_image_put(const slv_env *env, const char *path, const slv_stream_out *output,
                          const void *bytes, size_t size) {
    if (size && output->write(output->user, bytes, size) != 0)
        return slvi_fail(env, SLV_ERROR_IO, "%s: could not be written", path);
    return SLV_OK;
}
