/* Images as files: which format a name or the first bytes mean. */
#include "base/file.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/names.h"
#include "base/output.h"
#include "image/image_file.h"

#include <string.h>

const char *slv_image_format_name(slv_image_format format) {
    static const char *const names[] = {"none", "png", "exr"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)format);
}

slv_image_format slv_image_format_of_name(const char *path) {
    if (slvi_name_ends(path, ".png"))
        return SLV_IMAGE_PNG;
    return slvi_name_ends(path, ".exr") ? SLV_IMAGE_EXR : SLV_IMAGE_NONE;
}

static slv_result check_image(const slv_env *env, const slv_image *image,
                              const slv_image_params *params) {
    slv_result result = slvi_image_check_size(env, image->width, image->height, image->nchannels);
    if (!result && !image->pixels)
        result = slvi_fail(env, SLV_ERROR_ARGUMENT, "an image without pixels");
    if (!result && (unsigned)params->encoding > SLV_ENCODE_LINEAR)
        result = slvi_fail(env, SLV_ERROR_ARGUMENT, "unknown image encoding %d", params->encoding);
    return result;
}

static slv_result save(const slv_env *env, const char *path, const slv_image *image,
                       const slv_image_params *params) {
    static const slv_image_params defaults = {0};
    void *bytes = NULL;
    size_t size = 0;
    if (!params)
        params = &defaults;
    slv_result result = check_image(env, image, params);
    if (result)
        return result;
    slv_image_format format = slv_image_format_of_name(path);
    if (format == SLV_IMAGE_EXR)
        return slvi_image_exr_save(env, path, image, params);
    if (format != SLV_IMAGE_PNG)
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED, "%s: images are written as .png or .exr",
                         path);
    if (!(result = slvi_image_png_encode(env, path, image, params, &bytes, &size)))
        result = params->output ? slvi_image_put(env, path, params->output, bytes, size)
                                : slvi_output_write(env, path, bytes, size);
    slvi_free(bytes);
    return result;
}

slv_result slv_image_save(const slv_env *env, const char *path, const slv_image *image,
                          const slv_image_params *params) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, save(&own, path, image, params));
}

static slv_result encode_png(const slv_env *env, const slv_image *image,
                             const slv_image_params *params, void **bytes, size_t *size) {
    static const slv_image_params defaults = {0};
    *bytes = NULL;
    *size = 0;
    if (!params)
        params = &defaults;
    slv_result result = check_image(env, image, params);
    return result ? result : slvi_image_png_encode(env, "PNG image", image, params, bytes, size);
}

slv_result slv_image_encode_png(const slv_env *env, const slv_image *image,
                                const slv_image_params *params, void **bytes, size_t *size) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, encode_png(&own, image, params, bytes, size));
}

static slv_result decode(const slv_env *env, const char *path, const void *bytes, size_t size,
                         slv_image *out) {
    bool png = size >= 4 && !memcmp(bytes, "\x89PNG", 4);
    if (!png && (size < 4 || memcmp(bytes, "\x76\x2f\x31\x01", 4)))
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED, "%s: is neither a PNG nor an OpenEXR image",
                         path);
    slv_result result = png ? slvi_image_png_decode(env, path, bytes, size, out)
                            : slvi_image_exr_decode(env, path, bytes, size, out);
    if (!result && !png)
        out->encoding = SLV_TEXTURE_LINEAR;
    return result;
}

static slv_result load(const slv_env *env, const char *path, slv_image *out) {
    char *bytes = NULL;
    size_t size = 0;
    memset(out, 0, sizeof *out);
    slv_result result = slvi_file_read(env, path, &bytes, &size);
    if (!result)
        result = decode(env, path, bytes, size, out);
    slvi_free(bytes);
    return result;
}

slv_result slv_image_load(const slv_env *env, const char *path, slv_image *out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, load(&own, path, out));
}

static slv_result load_stream(const slv_env *env, const char *name, const slv_stream_in *input,
                              slv_image *out) {
    char *bytes = NULL;
    memset(out, 0, sizeof *out);
    slv_result result = slvi_alloc_plain(env, name, input->size, 1, &bytes);
    if (!result && input->size && input->read(input->user, 0, bytes, (size_t)input->size) != 0)
        result = slvi_fail(env, SLV_ERROR_IO, "%s: could not be read", name);
    if (input->close)
        input->close(input->user);
    if (!result)
        result = decode(env, name, bytes, (size_t)input->size, out);
    slvi_free(bytes);
    return result;
}

slv_result slv_image_load_stream(const slv_env *env, const char *name, const slv_stream_in *input,
                                 slv_image *out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, load_stream(&own, name, input, out));
}
