/* Pictures that other programs saved with other channels than they were exported with. */
#include "exchange/import.h"

#include <stdio.h>
#include <string.h>

void slvi_import_note(slvi_import_loss *loss, const char *path) {
    if (loss->count++ == 0)
        snprintf(loss->first, sizeof loss->first, "%s", path);
}

static slv_result check_grey(const slv_env *env, const char *path, const slv_image *image,
                             uint32_t needed) {
    const float *pixel = image->pixels;
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x++, pixel += image->nchannels)
            if (memcmp(pixel, pixel + 1, sizeof *pixel) || memcmp(pixel, pixel + 2, sizeof *pixel))
                return slvi_fail(env, SLV_ERROR_MISMATCH,
                                 "%s: has a colour (R G B %g %g %g at pixel %u,%u), where the "
                                 "texture is grey%s",
                                 path, (double)pixel[0], (double)pixel[1], (double)pixel[2], x, y,
                                 needed == 2 ? " with alpha" : "");
    return SLV_OK;
}

slv_result slvi_import_fit(const slv_env *env, const char *path, uint32_t needed, slv_image *image,
                           slvi_import_loss *dropped, slvi_import_loss *added) {
    uint32_t have = image->nchannels, colours = needed < 3 ? 1 : 3, own_colours = have < 3 ? 1 : 3;
    bool alpha = have % 2 == 0, wanted = needed % 2 == 0, lost = false;
    slv_image fitted;
    slv_result result;
    if (have == needed)
        return SLV_OK;
    if ((own_colours > colours && (result = check_grey(env, path, image, needed))) ||
        (result = slv_image_create(env, image->width, image->height, needed, &fitted)))
        return result;
    const float *from = image->pixels;
    float *to = fitted.pixels;
    for (size_t i = (size_t)image->width * image->height; i-- > 0; from += have, to += needed) {
        for (uint32_t c = 0; c < colours; c++)
            to[c] = from[own_colours == 1 ? 0 : c];
        if (wanted)
            to[needed - 1] = alpha ? from[have - 1] : 1.0f;
        lost |= alpha && !wanted && from[have - 1] != 1.0f;
    }
    if (lost)
        slvi_import_note(dropped, path);
    if (wanted && !alpha)
        slvi_import_note(added, path);
    fitted.encoding = image->encoding;
    fitted.encoding_is_assumed = image->encoding_is_assumed;
    slv_image_free(image);
    *image = fitted;
    return SLV_OK;
}

static void warn(const slv_env *env, const slvi_import_loss *loss, const char *what) {
    if (loss->count > 1)
        slvi_logf(env, SLV_LOG_WARNING, "%s: %s; so it is with %llu images in all", loss->first,
                  what, (unsigned long long)loss->count);
    else if (loss->count)
        slvi_logf(env, SLV_LOG_WARNING, "%s: %s", loss->first, what);
}

void slvi_import_warn(const slv_env *env, const slvi_import_loss *dropped,
                      const slvi_import_loss *added, const slvi_import_loss *unsaid) {
    warn(env, dropped, "its alpha is not 1 everywhere and is lost, since the texture has none");
    warn(env, added, "has no alpha, and the texture has: it becomes 1");
    warn(env, unsaid,
         "does not say any more that its numbers are light (gAMA), which the index says: they are "
         "taken as they stand");
}
