/* What the files of this folder share. */
#ifndef SLV_IMAGE_FILE_H
#define SLV_IMAGE_FILE_H

#include <selvage/image.h>

#include "base/log.h"

#define IMAGE_MAX_SIDE 131072 /* pixels; keeps row lengths in 32 bits */

/* image_pixels.c */
slv_result slvi_image_check_size(const slv_env *env, uint32_t width, uint32_t height,
                                 uint32_t nchannels);
slv_result slvi_image_progress(const slv_env *env, const char *path, const slv_image_params *params,
                               const slv_image *image, uint32_t rows);

/* image_png.c, image_exr.c */
/* From the bytes of a whole file. */
slv_result slvi_image_png_decode(const slv_env *env, const char *path, const void *bytes,
                                 size_t size, slv_image *out);
slv_result slvi_image_exr_decode(const slv_env *env, const char *path, const void *bytes,
                                 size_t size, slv_image *out);
/* `path` only names the image in messages. */
slv_result slvi_image_png_encode(const slv_env *env, const char *path, const slv_image *image,
                                 const slv_image_params *params, void **bytes, size_t *size);
/* To the path, or to the output of the parameters. */
slv_result slvi_image_exr_save(const slv_env *env, const char *path, const slv_image *image,
                               const slv_image_params *params);
slv_result slvi_image_put(const slv_env *env, const char *path, const slv_stream_out *output,
                          const void *bytes, size_t size);

#endif
