/* OpenEXR through OpenEXRCore, its C library. */
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
    const uint8_t *source;
    uint64_t size;
    int target; /* where it is written; errno of the first write that failed */
    int reason;
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

static int64_t on_read(exr_const_context_t context, void *user, void *buffer, uint64_t size,
                       uint64_t offset, exr_stream_error_func_ptr_t error) {
    const struct exr_stream *stream = user;
    (void)context;
    (void)error;
    if (offset > stream->size)
        return -1;
    if (size > stream->size - offset)
        size = stream->size - offset;
    memcpy(buffer, stream->source + offset, (size_t)size);
    return (int64_t)size;
}

static int64_t on_size(exr_const_context_t context, void *user) {
    const struct exr_stream *stream = user;
    (void)context;
    return (int64_t)stream->size;
}

static int64_t on_write(exr_const_context_t context, void *user, const void *buffer, uint64_t size,
                        uint64_t offset, exr_stream_error_func_ptr_t error) {
    struct exr_stream *stream = user;
    (void)context;
    (void)error;
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

/* The channels that are read, in the image's order; 0 if the file is of another kind. */
static uint32_t choose_channels(const exr_attr_chlist_t *list, const char *names[4]) {
    static const char *const kinds[] = {"RGBA", "RGB", "YA", "Y"};
    static const char *const letters[] = {"R", "G", "B", "A", "Y"};
    bool present[5] = {false};
    for (int i = 0; i < list->num_channels; i++) {
        const exr_attr_chlist_entry_t *entry = &list->entries[i];
        if (!strcmp(entry->name.str, "RY") || !strcmp(entry->name.str, "BY"))
            return 0; /* Y is then but a part of a colour */
        for (int letter = 0; letter < 5; letter++)
            if (!strcmp(entry->name.str, letters[letter])) {
                if (entry->pixel_type == EXR_PIXEL_UINT || entry->x_sampling != 1 ||
                    entry->y_sampling != 1)
                    return 0;
                present[letter] = true;
            }
    }
    for (int kind = 0; kind < 4; kind++) {
        uint32_t count = 0;
        for (const char *c = kinds[kind]; *c; c++)
            for (int letter = 0; letter < 5; letter++)
                if (*c == letters[letter][0] && present[letter])
                    names[count++] = letters[letter];
        if (count == strlen(kinds[kind]))
            return count;
    }
    return 0;
}

/* A part being decoded, one chunk at a time. Chunks are unpacked channel by channel in the file's
 * own type: the library's short cuts to interleaved floats have returned RGBA in reverse. */
struct exr_decode {
    const slv_env *env;
    const char *path;
    exr_const_context_t context;
    exr_decode_pipeline_t pipeline;
    bool started;
    slv_image *image;
    const char *names[4];
    uint8_t *planes;
    size_t plane_size, capacity;
    slv_result result; /* of a failure that has been logged already */
};

static bool reserve_planes(struct exr_decode *decode, const exr_chunk_info_t *chunk) {
    decode->plane_size = (size_t)chunk->width * (size_t)chunk->height * sizeof(float);
    size_t wanted = decode->plane_size * decode->image->nchannels;
    if (wanted <= decode->capacity)
        return true;
    slvi_free(decode->planes);
    decode->capacity = 0;
    decode->result = slvi_alloc(decode->env, decode->path, wanted, 1, &decode->planes);
    if (!decode->result)
        decode->capacity = wanted;
    return !decode->result;
}

static void store_plane(const uint8_t *plane, uint16_t type, const exr_chunk_info_t *chunk,
                        slv_image *image, uint32_t c, uint32_t x, uint32_t y) {
    const uint16_t *halves = (const uint16_t *)(const void *)plane;
    const float *floats = (const float *)(const void *)plane;
    for (int32_t j = 0; j < chunk->height; j++) {
        float *to =
            image->pixels + (((size_t)y + (size_t)j) * image->width + x) * image->nchannels + c;
        for (int32_t i = 0; i < chunk->width; i++, to += image->nchannels)
            *to = type == EXR_PIXEL_HALF ? slv_half_to_float(*halves++) : *floats++;
    }
}

/* Decodes one chunk whose first pixel is (x,y) of the image. */
static exr_result_t decode_chunk(struct exr_decode *decode, const exr_chunk_info_t *chunk,
                                 uint32_t x, uint32_t y) {
    exr_decode_pipeline_t *pipeline = &decode->pipeline;
    exr_result_t code = decode->started
                            ? exr_decoding_update(decode->context, 0, chunk, pipeline)
                            : exr_decoding_initialize(decode->context, 0, chunk, pipeline);
    if (code != EXR_ERR_SUCCESS)
        return code;
    if (!reserve_planes(decode, chunk))
        return EXR_ERR_OUT_OF_MEMORY;
    uint32_t n = decode->image->nchannels;
    uint16_t types[4] = {0};
    for (int i = 0; i < pipeline->channel_count; i++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[i];
        channel->decode_to_ptr = NULL;
        for (uint32_t c = 0; c < n; c++) {
            if (strcmp(channel->channel_name, decode->names[c]) != 0)
                continue;
            types[c] = channel->data_type;
            channel->decode_to_ptr = decode->planes + c * decode->plane_size;
            channel->user_data_type = channel->data_type;
            channel->user_bytes_per_element = channel->bytes_per_element;
            channel->user_pixel_stride = channel->bytes_per_element;
            channel->user_line_stride = chunk->width * channel->bytes_per_element;
        }
    }
    if (!decode->started &&
        (code = exr_decoding_choose_default_routines(decode->context, 0, pipeline)))
        return code;
    decode->started = true;
    if ((code = exr_decoding_run(decode->context, 0, pipeline)) != EXR_ERR_SUCCESS)
        return code;
    for (uint32_t c = 0; c < n; c++)
        store_plane(decode->planes + c * decode->plane_size, types[c], chunk, decode->image, c, x,
                    y);
    return EXR_ERR_SUCCESS;
}

static exr_result_t decode_scanlines(struct exr_decode *decode, int32_t top) {
    const slv_image *image = decode->image;
    int32_t lines = 0;
    exr_result_t code = exr_get_scanlines_per_chunk(decode->context, 0, &lines);
    if (code != EXR_ERR_SUCCESS || lines < 1)
        return code ? code : EXR_ERR_INVALID_ATTR;
    for (uint32_t y = 0; y < image->height; y += (uint32_t)lines) {
        exr_chunk_info_t chunk;
        uint32_t left = image->height - y;
        if ((code = exr_read_scanline_chunk_info(decode->context, 0, top + (int32_t)y, &chunk)))
            return code;
        if (chunk.height < 1 || (uint32_t)chunk.height > left ||
            (uint32_t)chunk.width != image->width)
            return EXR_ERR_BAD_CHUNK_LEADER;
        if ((code = decode_chunk(decode, &chunk, 0, y)) != EXR_ERR_SUCCESS)
            return code;
    }
    return EXR_ERR_SUCCESS;
}

static exr_result_t decode_tiles(struct exr_decode *decode) {
    const slv_image *image = decode->image;
    int32_t tile_width = 0, tile_height = 0;
    exr_result_t code = exr_get_tile_sizes(decode->context, 0, 0, 0, &tile_width, &tile_height);
    if (code != EXR_ERR_SUCCESS || tile_width < 1 || tile_height < 1)
        return code ? code : EXR_ERR_INVALID_ATTR;
    uint32_t w = (uint32_t)tile_width, h = (uint32_t)tile_height;
    for (uint32_t y = 0; y < image->height; y += h)
        for (uint32_t x = 0; x < image->width; x += w) {
            exr_chunk_info_t chunk;
            code = exr_read_tile_chunk_info(decode->context, 0, (int)(x / w), (int)(y / h), 0, 0,
                                            &chunk);
            if (code != EXR_ERR_SUCCESS)
                return code;
            if (chunk.width < 1 || chunk.height < 1 || (uint32_t)chunk.width > image->width - x ||
                (uint32_t)chunk.height > image->height - y)
                return EXR_ERR_BAD_CHUNK_LEADER;
            if ((code = decode_chunk(decode, &chunk, x, y)) != EXR_ERR_SUCCESS)
                return code;
        }
    return EXR_ERR_SUCCESS;
}

slv_result slvi_image_exr_decode(const slv_env *env, const char *path, const void *bytes,
                                 size_t size, slv_image *out) {
    struct exr_stream stream = {.source = bytes, .size = size};
    exr_context_initializer_t init = initializer(&stream);
    exr_context_t context = NULL;
    struct exr_decode decode = {
        .env = env, .path = path, .pipeline = EXR_DECODE_PIPELINE_INITIALIZER, .image = out};
    exr_storage_t storage;
    exr_attr_box2i_t window;
    const exr_attr_chlist_t *list = NULL;
    slv_result result = SLV_OK;
    init.read_fn = on_read;
    init.size_fn = on_size;
    if (exr_start_read(&context, path, &init) != EXR_ERR_SUCCESS ||
        exr_get_storage(context, 0, &storage) != EXR_ERR_SUCCESS ||
        exr_get_data_window(context, 0, &window) != EXR_ERR_SUCCESS ||
        exr_get_channels(context, 0, &list) != EXR_ERR_SUCCESS) {
        result = report(env, SLV_ERROR_FORMAT, path, &stream, "the header cannot be read");
        goto done;
    }
    uint32_t n = choose_channels(list, decode.names);
    if (!n || (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)) {
        result =
            slvi_fail(env, SLV_ERROR_UNSUPPORTED,
                      "%s: an EXR must have half or float channels R G B (A) or Y (A), in flat "
                      "scanlines or tiles",
                      path);
        goto done;
    }
    int64_t width = (int64_t)window.max.x - window.min.x + 1;
    int64_t height = (int64_t)window.max.y - window.min.y + 1;
    if (width < 1 || height < 1 || width > IMAGE_MAX_SIDE || height > IMAGE_MAX_SIDE) {
        result = slvi_fail(env, SLV_ERROR_LIMIT, "%s: %lld x %lld pixels", path, (long long)width,
                           (long long)height);
        goto done;
    }
    if ((result = slv_image_create(env, (uint32_t)width, (uint32_t)height, n, out)))
        goto done;
    decode.context = context;
    exr_result_t code = storage == EXR_STORAGE_TILED ? decode_tiles(&decode)
                                                     : decode_scanlines(&decode, window.min.y);
    if (decode.result)
        result = decode.result;
    else if (code != EXR_ERR_SUCCESS)
        result = report(env, SLV_ERROR_FORMAT, path, &stream, exr_get_default_error_message(code));
done:
    exr_decoding_destroy(context, &decode.pipeline);
    exr_finish(&context);
    current = stream.outer;
    slvi_free(decode.planes);
    if (result)
        slv_image_free(out);
    return result;
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

/* Packs `lines` rows of pixels, converted to the file's type, as one chunk. The
 * parameters are the state of the loop over chunks around it. */
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
    slv_output output;
    uint16_t *halves = NULL;
    compress_fn original = NULL;
    int32_t lines = 0;
    if (bits != 16 && bits != 32)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: EXR has 16 or 32 bits, not %u", path, bits);
    slv_result result = slvi_output_begin(env, path, false, &output);
    if (result)
        return result;
    init = initializer(&stream);
    stream.target = output.descriptor;
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
        result = report(env, SLV_ERROR_IO, path, &stream,
                        exr_get_default_error_message(code ? code : finished));
    if (!result)
        result = slvi_output_commit(&output, false);
    slvi_output_discard(&output);
    slvi_free(halves);
    return result;
}
