/* OpenEXR images written through OpenEXRCore, its C library. */
#include "base/file.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/output.h"
#include "image/image_file.h"

#include <selvage/half.h>

#include <errno.h>
#include <openexr.h>
#include <stdio.h>
#include <string.h>

/* What OpenEXRCore's callbacks reach. */
struct exr_stream {
    struct exr_stream *outer; /* one whose caller's callback began this one */
    int target;               /* where it is written; errno of the first write that failed */
    int reason;
    bool kept; /* not written there: for the header, which is written last, what becomes a stream's
                  is kept */
    const slv_env *env;
    uint8_t *bytes;
    uint64_t size, capacity;
    slv_result result; /* of a failure that has been logged */
    char message[256];
};

/* Whose callbacks run on this thread. OpenEXRCore reports some errors while it holds the context's
 * lock, which asking the context for its user data would wait for. */
static _Thread_local struct exr_stream *current;

static void on_error(exr_const_context_t context, exr_result_t code, const char *message) {
    (void)context;
    (void)code;
    /* the first of several messages is the one that says why */
    if (current && !current->message[0])
        snprintf(current->message, sizeof current->message, "%s", message);
}

/* Into memory, which grows. */
static int64_t keep(struct exr_stream *stream, const void *buffer, uint64_t size, uint64_t offset) {
    if (offset + size > stream->capacity) {
        uint64_t capacity = offset + size + stream->capacity / 2 + 4096;
        stream->result = slvi_grow(stream->env, "EXR image", capacity, 1, &stream->bytes);
        if (stream->result)
            return -1;
        memset(stream->bytes + stream->capacity, 0, (size_t)(capacity - stream->capacity));
        stream->capacity = capacity;
    }
    memcpy(stream->bytes + offset, buffer, (size_t)size);
    stream->size = offset + size > stream->size ? offset + size : stream->size;
    return (int64_t)size;
}

static int64_t on_write(exr_const_context_t context, void *user, const void *buffer, uint64_t size,
                        uint64_t offset, exr_stream_error_func_ptr_t error) {
    struct exr_stream *stream = user;
    (void)context;
    (void)error;
    if (stream->kept)
        return keep(stream, buffer, size, offset);
    if (slvi_write_at(NULL, "", stream->target, buffer, size, offset) == SLV_OK)
        return (int64_t)size;
    stream->reason = errno ? errno : EIO;
    return -1;
}

static exr_context_initializer_t initializer(struct exr_stream *stream) {
    exr_context_initializer_t init;
    memset(&init, 0, sizeof init);
    init.size = sizeof init;
    init.error_handler_fn = on_error;
    init.user_data = stream;
    stream->outer = current;
    current = stream;
    init.max_image_width = init.max_image_height = IMAGE_MAX_SIDE;
    init.max_tile_width = init.max_tile_height = IMAGE_MAX_SIDE;
    init.zip_level = -2; /* the library's default, as the next */
    init.dwa_quality = -1.0f;
    return init;
}

static slv_result report(const slv_env *env, slv_result result, const char *path,
                         const struct exr_stream *stream, const char *otherwise) {
    return slvi_fail(env, result, "%s: %s", path, stream->message[0] ? stream->message : otherwise);
}

static exr_result_t start_exr(exr_context_t *context, const char *path,
                              const exr_context_initializer_t *init, const slv_image *image,
                              const char *const *names, exr_pixel_type_t type) {
    int part;
    exr_result_t code = exr_start_write(context, path, EXR_WRITE_FILE_DIRECTLY, init);
    if (!code)
        code = exr_add_part(*context, "image", EXR_STORAGE_SCANLINE, &part);
    if (!code)
        code = exr_initialize_required_attr_simple(*context, 0, (int32_t)image->width,
                                                   (int32_t)image->height, EXR_COMPRESSION_ZIP);
    /* in the order that the file wants, which is the alphabet's */
    for (const char *letter = "ABGRY"; *letter; letter++)
        for (uint32_t c = 0; !code && c < image->nchannels; c++)
            if (names[c][0] == *letter)
                code = exr_add_channel(*context, 0, names[c], type, EXR_PERCEPTUALLY_LOGARITHMIC, 1,
                                       1);
    return code ? code : exr_write_header(*context);
}

typedef exr_result_t (*compress_fn)(exr_encode_pipeline_t *);

/* OpenEXRCore 3.1 keeps a compressed chunk that is just as long as the plain one, and readers take
 * a chunk of that length for plain: such a chunk is stored plain. */
static exr_result_t compress(exr_encode_pipeline_t *encoder) {
    compress_fn original = *(compress_fn *)encoder->encoding_user_data;
    exr_result_t code = original(encoder);
    if (!code && encoder->compressed_bytes == encoder->packed_bytes)
        memcpy(encoder->compressed_buffer, encoder->packed_buffer, encoder->packed_bytes);
    return code;
}

/* Packs `lines` rows of pixels, converted to the file's type, as one chunk. Its
 * parameters are many since it is the body of a loop over chunks, cut off for its length. */
static exr_result_t encode_chunk(exr_context_t context, exr_encode_pipeline_t *encoder, bool first,
                                 const slv_image *image, const char *const *names, uint32_t y,
                                 const uint8_t *pixels, size_t value_size, compress_fn *original) {
    exr_chunk_info_t chunk;
    exr_result_t code = exr_write_scanline_chunk_info(context, 0, (int)y, &chunk);
    if (!code)
        code = first ? exr_encoding_initialize(context, 0, &chunk, encoder)
                     : exr_encoding_update(context, 0, &chunk, encoder);
    if (code)
        return code;
    uint32_t n = image->nchannels;
    for (int i = 0; i < encoder->channel_count; i++)
        for (uint32_t c = 0; c < n; c++) {
            exr_coding_channel_info_t *channel = &encoder->channels[i];
            if (strcmp(channel->channel_name, names[c]) != 0)
                continue;
            channel->encode_from_ptr = pixels + c * value_size;
            channel->user_bytes_per_element = (int16_t)value_size;
            channel->user_data_type = value_size == 2 ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
            channel->user_pixel_stride = (int32_t)(n * value_size);
            channel->user_line_stride = (int32_t)(image->width * n * value_size);
        }
    if (first) {
        if ((code = exr_encoding_choose_default_routines(context, 0, encoder)) != 0)
            return code;
        *original = encoder->compress_fn;
        encoder->encoding_user_data = original;
        encoder->compress_fn = *original ? compress : NULL;
    }
    return exr_encoding_run(context, 0, encoder);
}

slv_result slvi_image_exr_save(const slv_env *env, const char *path, const slv_image *image,
                               const slv_image_params *params) {
    static const char *const grey[] = {"Y", "A"}, *const colour[] = {"R", "G", "B", "A"};
    const char *const *names = image->nchannels < 3 ? grey : colour;
    uint32_t bits = params->bits ? params->bits : 16;
    struct exr_stream stream = {0};
    exr_context_initializer_t init;
    exr_context_t context = NULL;
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    slv_output output = {.path = NULL};
    uint16_t *halves = NULL;
    compress_fn original = NULL;
    int32_t lines = 0;
    if (bits != 16 && bits != 32)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: EXR has 16 or 32 bits, not %u", path, bits);
    slv_result result = params->output ? SLV_OK : slvi_output_begin(env, path, false, &output);
    if (result)
        return result;
    init = initializer(&stream);
    stream.env = env;
    stream.target = output.descriptor;
    stream.kept = params->output != NULL;
    init.write_fn = on_write;
    exr_result_t code = start_exr(&context, path, &init, image, names,
                                  bits == 16 ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT);
    if (!code)
        code = exr_get_scanlines_per_chunk(context, 0, &lines);
    size_t row = (size_t)image->width * image->nchannels;
    if (!code && bits == 16)
        result = slvi_alloc(env, path, row * (uint32_t)lines, sizeof *halves, &halves);
    for (uint32_t y = 0; !code && !result && y < image->height; y += (uint32_t)lines) {
        const float *pixels = image->pixels + y * row;
        uint32_t left = image->height - y;
        size_t count = row * (left < (uint32_t)lines ? left : (uint32_t)lines);
        for (size_t i = 0; halves && i < count; i++)
            halves[i] = slv_half_from_float(pixels[i]);
        code = encode_chunk(context, &encoder, y == 0, image, names, y,
                            halves ? (const uint8_t *)halves : (const uint8_t *)pixels, bits / 8,
                            &original);
        if (!code)
            result = slvi_image_progress(env, path, params, image,
                                         y + (left < (uint32_t)lines ? left : (uint32_t)lines));
    }
    exr_encoding_destroy(context, &encoder);
    exr_result_t finished = exr_finish(&context);
    current = stream.outer;
    if (!result && stream.reason)
        result = slvi_fail(env, slvi_io_error(stream.reason), "%s: write failed: %s", path,
                           strerror(stream.reason));
    else if (!result && (code || finished))
        result = stream.result ? stream.result
                               : report(env, SLV_ERROR_IO, path, &stream,
                                        exr_get_default_error_message(code ? code : finished));
    if (!result)
        result = params->output
                     ? slvi_image_put(env, path, params->output, stream.bytes, (size_t)stream.size)
                     : slvi_output_commit(&output, false);
    slvi_output_discard(&output);
    slvi_free(stream.bytes);
    slvi_free(halves);
    return result;
}
