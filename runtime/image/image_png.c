/* PNG images, written and read through libpng. */
#include "image/image_file.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/srgb.h"

#include <png.h>
#include <stdio.h>
#include <string.h>

/* What libpng's callbacks reach; everything that changes between setjmp and longjmp lives here. */
struct png_stream {
    const slv_env *env;
    const char *path;
    uint8_t *data;
    const uint8_t *source;
    size_t size, capacity, at;
    uint8_t *rows;
    png_bytep *row_pointers;
    slv_result result; /* of a failure that has been logged already */
    slv_result memory; /* of an allocation that libpng was refused, not logged */
    char message[128];
};

static void on_error(png_structp png, png_const_charp message) {
    struct png_stream *stream = png_get_error_ptr(png);
    snprintf(stream->message, sizeof stream->message, "%s", message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message) {
    (void)png;
    (void)message;
}

/* It gets by without some of what it asks for, so that a refusal is told when it fails only. */
static png_voidp on_malloc(png_structp png, png_alloc_size_t size) {
    struct png_stream *stream = png_get_mem_ptr(png);
    slv_env quiet = slvi_env_or_default(stream->env);
    void *memory = NULL;
    quiet.log = NULL;
    slv_result result = slvi_alloc_plain(&quiet, stream->path, size, 1, &memory);
    stream->memory = result ? result : stream->memory;
    return memory;
}

static void on_free(png_structp png, png_voidp memory) {
    (void)png;
    slvi_free(memory);
}

static void on_write(png_structp png, png_bytep data, size_t size) {
    struct png_stream *stream = png_get_io_ptr(png);
    if (size > stream->capacity - stream->size) {
        uint8_t *grown = NULL;
        size_t capacity = stream->size + size + stream->capacity / 2 + 4096;
        stream->result = slvi_alloc(stream->env, stream->path, capacity, 1, &grown);
        if (stream->result)
            png_error(png, "no memory");
        if (stream->size)
            memcpy(grown, stream->data, stream->size);
        slvi_free(stream->data);
        stream->data = grown;
        stream->capacity = capacity;
    }
    memcpy(stream->data + stream->size, data, size);
    stream->size += size;
}

static void on_flush(png_structp png) {
    (void)png;
}

static void on_read(png_structp png, png_bytep data, size_t size) {
    struct png_stream *stream = png_get_io_ptr(png);
    if (size > stream->size - stream->at)
        png_error(png, "the file ends too early");
    memcpy(data, stream->source + stream->at, size);
    stream->at += size;
}

static slv_result report(struct png_stream *stream, slv_result otherwise) {
    if (stream->result)
        return stream->result;
    return slvi_fail(stream->env, stream->memory ? stream->memory : otherwise, "%s: %s",
                     stream->path, stream->message[0] ? stream->message : "no memory for it");
}

static uint32_t quantise(float x, float scale) {
    return x > 0.0f ? (uint32_t)((x < 1.0f ? x : 1.0f) * scale + 0.5f) : 0;
}

/* One row of pixels as PNG has them: big-endian, colour not multiplied by alpha. */
static void encode_row(const slv_image *image, const float *pixels, slv_image_encoding encoding,
                       uint32_t bits, uint8_t *out) {
    uint32_t n = image->nchannels;
    bool has_alpha = n == 2 || n == 4;
    float scale = bits == 16 ? 65535.0f : 255.0f;
    for (uint32_t x = 0; x < image->width; x++, pixels += n)
        for (uint32_t c = 0; c < n; c++) {
            float value = pixels[c];
            if (encoding == SLV_ENCODE_SRGB && !(has_alpha && c == n - 1)) {
                if (has_alpha && pixels[n - 1] > 0.0f)
                    value /= pixels[n - 1];
                value = slvi_srgb_from_linear(value);
            }
            uint32_t stored = quantise(value, scale);
            if (bits == 16)
                *out++ = (uint8_t)(stored >> 8);
            *out++ = (uint8_t)stored;
        }
}

static bool write_png(png_structp png, png_infop info, const slv_image *image,
                      const slv_image_params *params, uint32_t bits, struct png_stream *stream) {
    static const int colour_types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA,
                                       PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA};
    if (setjmp(png_jmpbuf(png)))
        return false;
    png_set_write_fn(png, stream, on_write, on_flush);
    png_set_user_limits(png, IMAGE_MAX_SIDE, IMAGE_MAX_SIDE);
    png_set_IHDR(png, info, image->width, image->height, (int)bits,
                 colour_types[image->nchannels - 1], PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (params->encoding == SLV_ENCODE_SRGB)
        png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    else if (params->encoding == SLV_ENCODE_LINEAR)
        png_set_gAMA_fixed(png, info, PNG_FP_1);
    png_write_info(png, info);
    for (uint32_t y = 0; y < image->height; y++) {
        encode_row(image, image->pixels + (size_t)y * image->width * image->nchannels,
                   params->encoding, bits, stream->rows);
        png_write_row(png, stream->rows);
        stream->result = slvi_image_progress(stream->env, stream->path, params, image, y + 1);
        if (stream->result)
            return false;
    }
    png_write_end(png, info);
    return true;
}

slv_result slvi_image_png_encode(const slv_env *env, const char *path, const slv_image *image,
                                 const slv_image_params *params, void **bytes, size_t *size) {
    struct png_stream stream = {.env = env, .path = path};
    uint32_t bits = params->bits ? params->bits : 8;
    png_infop info = NULL;
    if (bits != 8 && bits != 16)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: PNG has 8 or 16 bits, not %u", path, bits);
    png_structp png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, &stream, on_error,
                                                on_warning, &stream, on_malloc, on_free);
    if (png)
        info = png_create_info_struct(png);
    slv_result result =
        slvi_alloc(env, path, image->width, (uint64_t)image->nchannels * (bits / 8), &stream.rows);
    if (!result && !info)
        result = slvi_fail(env, SLV_ERROR_MEMORY, "%s: no memory to encode it", path);
    if (!result && !write_png(png, info, image, params, bits, &stream))
        result = report(&stream, SLV_ERROR_IO);
    if (!result) {
        *bytes = stream.data;
        *size = stream.size;
        stream.data = NULL;
    }
    png_destroy_write_struct(&png, &info);
    slvi_free(stream.rows);
    slvi_free(stream.data);
    return result;
}

static bool read_png_header(png_structp png, png_infop info, struct png_stream *stream) {
    if (setjmp(png_jmpbuf(png)))
        return false;
    png_set_read_fn(png, stream, on_read);
    png_set_user_limits(png, IMAGE_MAX_SIDE, IMAGE_MAX_SIDE);
    /* comments and profiles are of no use here, and libpng reserves what their lengths claim */
    static const png_byte colour_chunks[] = "gAMA\0sRGB";
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_AS_DEFAULT, colour_chunks, 2);
    png_set_chunk_malloc_max(png, 1 << 24);
    png_read_info(png, info);
    png_set_expand(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    return true;
}

/* By what most files have and programs go by; the curves of other gammas are taken for sRGB's. */
static void find_encoding(png_structp png, png_infop info, slv_image *image) {
    png_fixed_point gamma = 0;
    int intent;
    bool srgb = png_get_sRGB(png, info, &intent) != 0,
         some = png_get_gAMA_fixed(png, info, &gamma) != 0;
    bool linear = !srgb && some && gamma > PNG_FP_1 * 95 / 100 && gamma < PNG_FP_1 * 105 / 100;
    image->encoding = linear ? SLV_TEXTURE_LINEAR : SLV_TEXTURE_SRGB;
    image->encoding_is_assumed = !srgb && !some;
}

/* A chunk before the pixels, or NULL; its length. */
static const uint8_t *find_chunk(const struct png_stream *stream, const char *name,
                                 uint32_t *length) {
    for (size_t at = 8; stream->size - at >= 12;) {
        const uint8_t *chunk = stream->source + at;
        *length = png_get_uint_32(chunk);
        if (*length > stream->size - at - 12 || memcmp(chunk + 4, "IDAT", 4) == 0)
            return NULL;
        if (memcmp(chunk + 4, name, 4) == 0)
            return chunk + 8;
        at += 12 + (size_t)*length;
    }
    return NULL;
}

/* Whether primaries are sRGB's, to the precision that programs write them with. */
static bool are_srgb(const uint8_t *chromaticities) {
    static const int32_t srgb[8] = {31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000};
    for (int i = 0; i < 8; i++) {
        int64_t off = (int64_t)png_get_uint_32(chromaticities + 4 * i) - srgb[i];
        if (off < -200 || off > 200)
            return false;
    }
    return true;
}

/* Colours are taken for those of sRGB's primaries, along its curve or as light. A file that says
 * otherwise is named. */
static void tell_of_space(png_structp png, png_infop info, const struct png_stream *stream) {
    uint32_t length;
    int intent;
    const uint8_t *chunk = find_chunk(stream, "cICP", &length);
    char space[112] = "";
    if (chunk && length == 4) {
        if (chunk[0] != 1 || chunk[1] != 13)
            snprintf(space, sizeof space, "cICP: primaries %u, transfer %u", chunk[0], chunk[1]);
    } else if (png_get_sRGB(png, info, &intent)) {
        return;
    } else if ((chunk = find_chunk(stream, "iCCP", &length))) {
        char name[80] = "";
        for (uint32_t i = 0; i < length && i < 79 && chunk[i]; i++)
            name[i] = chunk[i] >= ' ' && chunk[i] < 127 ? (char)chunk[i] : '?';
        if (!strstr(name, "sRGB"))
            snprintf(space, sizeof space, "iCCP: profile '%s'", name);
    } else if ((chunk = find_chunk(stream, "cHRM", &length)) && length == 32 && !are_srgb(chunk)) {
        snprintf(space, sizeof space, "cHRM: other primaries");
    }
    if (space[0])
        slvi_logf(stream->env, SLV_LOG_WARNING,
                  "%s: its colours are of another space (%s), which is not converted: they are "
                  "taken for sRGB's",
                  stream->path, space);
}

static bool read_png_rows(png_structp png, struct png_stream *stream) {
    if (setjmp(png_jmpbuf(png)))
        return false;
    png_read_image(png, stream->row_pointers);
    png_read_end(png, NULL);
    return true;
}

static slv_result decode(png_structp png, png_infop info, struct png_stream *stream,
                         slv_image *out) {
    if (!read_png_header(png, info, stream))
        return report(stream, SLV_ERROR_FORMAT);
    uint32_t width = png_get_image_width(png, info), height = png_get_image_height(png, info);
    uint32_t n = png_get_channels(png, info), bits = png_get_bit_depth(png, info);
    uint64_t row = png_get_rowbytes(png, info), values = (uint64_t)width * n;
    /* deflate packs at most 1032 to 1; low depths and palettes expand by up to 8 and 4 */
    if (row * height / (1032 * 32) > stream->size)
        return slvi_fail(stream->env, SLV_ERROR_FORMAT,
                         "%s: claims %u x %u pixels in a file of %zu bytes", stream->path, width,
                         height, stream->size);
    if (row != values * (bits / 8) || (bits != 8 && bits != 16))
        return slvi_fail(stream->env, SLV_ERROR_UNSUPPORTED, "%s: an unusual kind of PNG",
                         stream->path);
    slv_result result;
    if ((result = slvi_alloc(stream->env, stream->path, height, row, &stream->rows)) ||
        (result = slvi_alloc(stream->env, stream->path, height, sizeof *stream->row_pointers,
                             &stream->row_pointers)) ||
        (result = slv_image_create(stream->env, width, height, n, out)))
        return result;
    find_encoding(png, info, out);
    tell_of_space(png, info, stream);
    out->type = bits == 8 ? SLV_TYPE_U8 : SLV_TYPE_U16;
    for (uint32_t y = 0; y < height; y++)
        stream->row_pointers[y] = stream->rows + y * row;
    if (!read_png_rows(png, stream))
        return report(stream, SLV_ERROR_FORMAT);
    const uint8_t *from = stream->rows;
    for (uint64_t i = 0; i < values * height; i++)
        if (bits == 8)
            out->pixels[i] = (float)from[i] / 255.0f;
        else
            out->pixels[i] = (float)(from[2 * i] << 8 | from[2 * i + 1]) / 65535.0f;
    return SLV_OK;
}

slv_result slvi_image_png_decode(const slv_env *env, const char *path, const void *bytes,
                                 size_t size, slv_image *out) {
    struct png_stream stream = {.env = env, .path = path, .source = bytes, .size = size};
    slv_result result;
    png_infop info = NULL;
    png_structp png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, &stream, on_error, on_warning,
                                               &stream, on_malloc, on_free);
    if (png)
        info = png_create_info_struct(png);
    if (info)
        result = decode(png, info, &stream, out);
    else
        result = slvi_fail(env, SLV_ERROR_MEMORY, "%s: no memory to decode it", path);
    if (result)
        slv_image_free(out);
    png_destroy_read_struct(&png, &info, NULL);
    slvi_free(stream.rows);
    slvi_free(stream.row_pointers);
    return result;
}
