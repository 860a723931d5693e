/* A picture of every face that differs. */
#include "diff/diff.h"

#include <selvage/folder.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One channel stays grey; of more, the first three are red, green and blue, and the rest lightens
 * all of them. */
static void paint(const float *values, uint32_t channels, uint64_t count, float scale,
                  slv_image *image) {
    uint64_t height = image->height, width = image->width;
    for (uint64_t i = 0; i < count; i++) {
        /* row 0 of a face is v=0, of a picture the top */
        float *pixel =
            image->pixels + ((height - 1 - i / width) * width + i % width) * image->nchannels;
        float rest = 0;
        for (uint32_t c = 3; c < channels; c++)
            rest = values[i * channels + c] > rest ? values[i * channels + c] : rest;
        for (uint32_t c = 0; c < image->nchannels; c++) {
            float value = c < channels ? values[i * channels + c] : 0;
            pixel[c] = (value > rest ? value : rest) * scale;
        }
    }
}

static slv_result save_face(const slv_env *env, const struct diff *d, uint32_t face,
                            const char *folder) {
    const slv_face_diff *diff = &d->faces[face];
    uint32_t na = slv_ptx_get_info(d->files[0])->nchannels,
             nb = slv_ptx_get_info(d->files[1])->nchannels, channels = na < nb ? na : nb;
    uint64_t count = UINT64_C(1) << (diff->compared.u + diff->compared.v);
    slv_image_params params = {.encoding = SLV_ENCODE_RAW, .bits = d->format ? 32 : 16};
    slv_image image = {0};
    char path[1400];
    snprintf(path, sizeof path, "%s/face_%06u.%s", folder, face, d->format ? "exr" : "png");
    float *values = count <= SIZE_MAX / sizeof *values / channels
                        ? malloc((size_t)count * channels * sizeof *values)
                        : NULL;
    slv_result result =
        values ? SLV_OK
               : output_fail(env, SLV_ERROR_MEMORY, "face %u: no memory for its differences", face);
    if (result ||
        (result = slv_ptx_diff_texels(env, d->files[0], d->files[1], face, diff, values)) ||
        (result = slv_image_create(env, 1u << diff->compared.u, 1u << diff->compared.v,
                                   channels == 1 ? 1 : 3, &image)))
        goto done;
    paint(values, channels, count, d->format || !isfinite(d->largest) ? 1 : 1 / d->largest, &image);
    result = slv_image_save(env, path, &image, &params);
done:
    slv_image_free(&image);
    free(values);
    return result;
}

int diff_save_images(const slv_env *env, const struct diff *d) {
    slv_folder *folder;
    slv_result result = slv_folder_begin(env, d->images, &folder);
    if (result)
        return EXIT_FAILED;
    cli_catch_interrupts();
    for (uint32_t face = 0; face < d->nfaces && !result; face++)
        if (cli_interrupted())
            result = output_fail(env, SLV_ERROR_CANCELLED, "%s: interrupted", d->images);
        else if (d->faces[face].what & SLV_DIFF_TEXELS)
            result = save_face(env, d, face, slv_folder_path(folder));
    return slv_folder_end(folder, NULL, result) ? EXIT_FAILED : EXIT_OK;
}
