/* Images in files: PNG (8 and 16 bit) and OpenEXR (half and float). */
#ifndef SELVAGE_IMAGE_H
#define SELVAGE_IMAGE_H

#include <selvage/stream.h>
#include <selvage/texture.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Pixels in memory: float, row 0 at the top, channels interleaved. 1 channel is grey, 2 grey and
 * alpha, 3 RGB, 4 RGBA with colour multiplied by alpha. Values are linear unless said otherwise. */
typedef struct slv_image {
    uint32_t width, height, nchannels;
    float *pixels;                 /* width * height * nchannels; slv_image_free releases it */
    slv_texture_encoding encoding; /* of the colours of a file that was read, whatever its name:
                                      LINEAR of OpenEXR and of a PNG that says so (gAMA of 1), SRGB
                                      of other PNGs. AUTO of other images; writers do not look at
                                      it */
    bool encoding_is_assumed;      /* the PNG has neither gAMA nor sRGB */
    slv_type type; /* of a file that was read: the smallest that holds its values as they stood */
} slv_image;

typedef enum slv_image_encoding {
    SLV_ENCODE_SRGB =
        0, /* PNG: colour divided by alpha, then the sRGB curve. EXR: linear, multiplied by alpha */
    SLV_ENCODE_RAW, /* PNG: each value as it stands, times 255 (or 65535). EXR: the same as above */
    SLV_ENCODE_LINEAR /* the same, and a PNG says that its colours are light (gAMA of 1) */
} slv_image_encoding;

SLV_API const char *slv_image_encoding_name(slv_image_encoding encoding); /* srgb, raw, linear */

typedef struct slv_image_params {
    slv_image_encoding encoding;
    uint32_t bits;         /* PNG: 8 (default) or 16. EXR: 16 (half, default) or 32 (float) */
    slv_progress progress; /* rows */
    const slv_stream_out *output; /* NULL: the path is written; else it is a name, which says by
                                 its extension what is written */
    uint64_t reserved[4];
} slv_image_params;

SLV_NODISCARD SLV_API slv_result slv_image_create(const slv_env *env, uint32_t width,
                                                  uint32_t height, uint32_t nchannels,
                                                  slv_image *out);
SLV_API void slv_image_free(slv_image *image); /* frees the pixels and zeroes the struct */

/* By a name's ending, .png or .exr in any case behind something else, which format is written to
 * it. What is read is told by its first bytes. */
typedef enum slv_image_format {
    SLV_IMAGE_NONE = 0, /* the name of no picture */
    SLV_IMAGE_PNG,
    SLV_IMAGE_EXR
} slv_image_format;
SLV_API const char *slv_image_format_name(slv_image_format format); /* none, png, exr */
SLV_API slv_image_format slv_image_format_of_name(const char *path);

/* Writes what slv_image_format_of_name says. Atomic: beside, then rename. */
SLV_NODISCARD SLV_API slv_result slv_image_save(const slv_env *env, const char *path,
                                                const slv_image *image,
                                                const slv_image_params *params);
/* PNG bytes in memory, for embedding; `*bytes` is released with slv_free. */
SLV_NODISCARD SLV_API slv_result slv_image_encode_png(const slv_env *env, const slv_image *image,
                                                      const slv_image_params *params, void **bytes,
                                                      size_t *size);

/* Reads what the first bytes say that it is: a PNG (values / 255 or / 65535 as they stand, alpha
 * not multiplied in; palettes and low depths expanded) or an OpenEXR file: the channels R G B A or
 * Y A, half or float, of the first part that has them, else of the only layer that has them
 * (beauty.R ...), in scanlines or tiles, of which the full resolution is read, of any compression.
 * An OpenEXR image is the display window: what the data window has beyond it is left out, and what
 * it does not cover is zero. Other files are SLV_ERROR_UNSUPPORTED, and a line says why: deep
 * pixels, subsampled channels, luminance and chroma, integers (uint), several layers, a data window
 * outside of the display window. */
SLV_NODISCARD SLV_API slv_result slv_image_load(const slv_env *env, const char *path,
                                                slv_image *out);
/* The same from a stream; `name` is for messages. */
SLV_NODISCARD SLV_API slv_result slv_image_load_stream(const slv_env *env, const char *name,
                                                       const slv_stream_in *input, slv_image *out);

#ifdef __cplusplus
}
#endif

#endif
