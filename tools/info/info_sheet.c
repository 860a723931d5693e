/* A picture of all faces of a .ptx, each in a cell. */
#include "info/info.h"

#include "command/ids.h"
#include "command/lists.h"

#include <stdlib.h>

/* 4096 x 8192 pixels of four floats are 512 MiB. */
enum { MAX_WIDTH = 4096, MAX_HEIGHT = 8192, LARGEST_CELL = 256, GAPS_FROM = 8 };

struct sheet {
    const slv_ptx *ptx; /* premultiplied */
    const slv_ptx_info *info;
    slv_ptx_reader *reader;
    value_ranges faces;       /* to be drawn */
    uint32_t cell, gap, log2; /* log2 of the longer side of a face's picture */
    uint32_t columns, rows, shown;
    uint32_t ncolors; /* channels that are drawn as colours */
    slv_image image;
    bool divided; /* the file wants colours that are not multiplied by alpha */
    bool decoded; /* and light, where the texture has sRGB */
    void *texels;
    float *values;
};

static uint64_t fitting(uint32_t pitch, uint32_t gap, uint32_t length) {
    return (length + gap) / pitch;
}

/* The largest cells, in powers of two, with which the sheet is about square and not too wide. */
static void lay_out(struct sheet *s, uint32_t cell, uint32_t smallest) {
    s->cell = cell ? cell : LARGEST_CELL;
    for (;;) {
        s->gap = s->cell >= GAPS_FROM ? 2 : 0;
        uint64_t widest = fitting(s->cell + s->gap, s->gap, MAX_WIDTH);
        if (cell || s->cell == 1 || s->cell / 2 < smallest || widest * widest >= s->faces.nfaces)
            break;
        s->cell /= 2;
    }
    uint64_t widest = fitting(s->cell + s->gap, s->gap, MAX_WIDTH),
             highest = fitting(s->cell + s->gap, s->gap, MAX_HEIGHT), columns = 1;
    while (columns < widest && columns * columns < s->faces.nfaces)
        columns++;
    uint64_t rows = (s->faces.nfaces + columns - 1) / columns;
    rows = rows > highest ? highest : rows;
    s->columns = (uint32_t)columns;
    s->rows = (uint32_t)(rows ? rows : 1);
    s->shown = (uint32_t)(s->faces.nfaces < columns * rows ? s->faces.nfaces : columns * rows);
    while (2u << s->log2 <= s->cell)
        s->log2++;
}

/* One pixel: the first channels besides alpha are grey, or red, green and blue. */
static void put(const struct sheet *s, uint32_t x, uint32_t y, const float *value) {
    float *pixel = s->image.pixels + ((size_t)y * s->image.width + x) * s->image.nchannels;
    uint32_t alpha = (uint32_t)s->info->alpha_channel, c = 0;
    bool has_alpha = s->image.nchannels % 2 == 0;
    for (uint32_t i = 0; i < s->info->nchannels && c < s->ncolors; i++)
        if (!has_alpha || i != alpha)
            pixel[c++] = value[i];
    if (has_alpha)
        pixel[s->image.nchannels - 1] = value[alpha];
}

/* A triangle's square of texels holds two at each place: below the diagonal of the place that of
 * its own, above it one from the other half of the square. */
static void draw_triangle(struct sheet *s, uint32_t left, uint32_t bottom, uint32_t log2,
                          uint32_t zoom) {
    uint32_t size = 1u << log2, n = s->info->nchannels, side = size * zoom;
    float *mean = s->values + (size_t)size * size * n;
    for (uint32_t y = 0; y < side; y++)
        for (uint32_t x = 0; x + y < side; x++) {
            uint32_t u = x / zoom, v = y / zoom;
            const float *even = s->values + ((size_t)v * size + u) * n, *odd = even;
            if (u + v + 1 < size)
                odd = s->values + ((size_t)(size - 1 - u) * size + size - 1 - v) * n;
            if (zoom == 1)
                for (uint32_t c = 0; c < n; c++)
                    mean[c] = 0.5f * (even[c] + odd[c]);
            bool above = x % zoom + y % zoom >= zoom;
            put(s, left + x, bottom - y, zoom == 1 ? mean : above ? odd : even);
        }
}

static void draw_quad(struct sheet *s, uint32_t left, uint32_t bottom, slv_res res,
                      const uint32_t zoom[2]) {
    uint32_t width = zoom[0] << res.u, height = zoom[1] << res.v;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            put(s, left + x, bottom - y,
                s->values + (((size_t)(y / zoom[1]) << res.u) + x / zoom[0]) * s->info->nchannels);
}

static slv_result draw_face(struct sheet *s, uint32_t face, uint32_t cell) {
    slv_ptx_face info;
    slv_result result = slv_ptx_get_face(s->ptx, face, &info);
    if (result)
        return result;
    int longer = info.res.u > info.res.v ? info.res.u : info.res.v, shift = longer - (int)s->log2;
    /* the picture's sides, and the texels that are read for it */
    int u = info.res.u - shift > 0 ? info.res.u - shift : 0,
        v = info.res.v - shift > 0 ? info.res.v - shift : 0;
    slv_res res = {(int8_t)(u < info.res.u ? u : info.res.u),
                   (int8_t)(v < info.res.v ? v : info.res.v)};
    if (info.flags & SLV_FACE_CONSTANT)
        res = (slv_res){0, 0};
    if ((result = slv_ptx_reader_read(s->reader, face, res, s->texels)))
        return result;
    size_t count = (size_t)1 << (res.u + res.v);
    slv_type_to_float(s->info->type, s->texels, count * s->info->nchannels, s->values);
    uint32_t nchannels = s->info->nchannels;
    int32_t alpha = s->info->alpha_channel;
    if (alpha >= 0 && (s->divided || s->decoded))
        slv_ptx_unmultiply(SLV_TYPE_FLOAT, nchannels, alpha, s->values, count);
    if (s->decoded)
        slv_texels_decode(nchannels, alpha, s->values, count);
    if (alpha >= 0 && s->decoded && !s->divided)
        slv_ptx_premultiply(SLV_TYPE_FLOAT, nchannels, alpha, s->values, count);
    uint32_t pitch = s->cell + s->gap, left = cell % s->columns * pitch,
             bottom = cell / s->columns * pitch + s->cell - 1;
    left += (s->cell - (1u << u)) / 2;
    bottom -= (s->cell - (1u << v)) / 2;
    const uint32_t zoom[2] = {1u << (u - res.u), 1u << (v - res.v)};
    if (s->info->mesh_type == SLV_PTX_TRIANGLE)
        draw_triangle(s, left, bottom, (uint32_t)res.u, zoom[0]);
    else
        draw_quad(s, left, bottom, res, zoom);
    return SLV_OK;
}

static slv_result draw(const slv_env *env, struct sheet *s, cli_progress *progress) {
    uint64_t count = (UINT64_C(1) << (2 * s->log2)) + 1;
    uint32_t cell = 0, n = s->info->nchannels;
    bool has_alpha = s->info->alpha_channel >= 0 && n > 1;
    s->ncolors = n - has_alpha == 1 ? 1 : 3;
    if (count > SIZE_MAX / sizeof *s->values / n)
        return output_fail(env, SLV_ERROR_LIMIT, "%s: %u channels are too many for cells of %u",
                           slv_ptx_name(s->ptx), n, s->cell);
    s->texels = malloc((size_t)count * n * slv_type_size(s->info->type));
    s->values = malloc((size_t)count * n * sizeof *s->values);
    if (!s->texels || !s->values)
        return output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for cells of %u pixels",
                           slv_ptx_name(s->ptx), s->cell);
    slv_result result = slv_ptx_reader_create(env, s->ptx, &s->reader);
    if (!result)
        result = slv_image_create(env, s->columns * (s->cell + s->gap) - s->gap,
                                  s->rows * (s->cell + s->gap) - s->gap, s->ncolors + has_alpha,
                                  &s->image);
    progress->total = s->shown ? s->shown : 1;
    for (uint32_t i = 0; i < s->faces.count && !result; i++)
        for (uint32_t face = s->faces.list[i].first; !result && cell < s->shown; face++) {
            result = draw_face(s, face, cell++);
            cli_progress_step(progress);
            if (face == s->faces.list[i].last)
                break;
        }
    return result;
}

/* The cell that the number of the last face that is drawn fits into. */
static uint32_t smallest_cell(const struct sheet *s) {
    uint32_t width, height, last = 0;
    for (uint32_t i = 0; i < s->faces.count; i++)
        last = s->faces.list[i].last > last ? s->faces.list[i].last : last;
    ids_number_size(last, 1, &width, &height);
    return width > height ? width : height;
}

/* Each face's number in the upper left of its cell. Returns how many do not fit. */
static uint32_t write_ids(struct sheet *s) {
    uint32_t pitch = s->cell + s->gap, cell = 0, left_out = 0;
    for (uint32_t i = 0; i < s->faces.count; i++)
        for (uint64_t face = s->faces.list[i].first;
             face <= s->faces.list[i].last && cell < s->shown; face++, cell++) {
            uint32_t zoom = s->cell / 64 + 1, width, height;
            do {
                ids_number_size((uint32_t)face, zoom, &width, &height);
            } while ((width > s->cell || height > s->cell) && --zoom);
            if (zoom)
                ids_number_draw(&s->image, (uint32_t)face, cell % s->columns * pitch,
                                cell / s->columns * pitch, zoom);
            left_out += !zoom;
        }
    return left_out;
}

/* How the picture is written, and whether colours become light before it: in a PNG sRGB stays what
 * it is. */
static slv_image_params choose_params(struct sheet *s, const info_options *options,
                                      slv_texture_encoding encoding, bool exr) {
    bool raw = options->encoding_given && options->encoding == SLV_ENCODE_RAW;
    if (options->texture_encoding)
        encoding = (slv_texture_encoding)options->texture_encoding;
    else if (raw)
        encoding = SLV_TEXTURE_DATA;
    bool as_it_is = raw || (encoding == SLV_TEXTURE_DATA && !options->encoding_given);
    s->decoded = encoding == SLV_TEXTURE_SRGB && (exr || raw);
    if (encoding == SLV_TEXTURE_SRGB && !s->decoded)
        as_it_is = true;
    slv_image_params params = {.encoding = as_it_is ? SLV_ENCODE_RAW : SLV_ENCODE_SRGB};
    params.bits = exr ? (s->info->type == SLV_TYPE_FLOAT || s->info->type == SLV_TYPE_U16 ? 32 : 16)
                      : (s->info->type == SLV_TYPE_U16 ? 16 : 8);
    s->divided = !exr && as_it_is && s->info->alpha_channel >= 0;
    return params;
}

int info_sheet(const cli_command *command, const slv_env *env, const info_options *options,
               const char *path, info_sheet_layout *out) {
    bool exr = slv_image_format_of_name(options->sheet) == SLV_IMAGE_EXR;
    struct sheet s = {0};
    slv_ptx *ptx = NULL;
    slv_ptx_open_params params = {.premultiply = true};
    cli_progress progress = cli_progress_fleeting("sheet", options->progress, options->json);
    int code = EXIT_FAILED;
    slv_texture_encoding encoding;
    if (output_check(env, options->sheet, &path, 1) ||
        slv_ptx_open_with(env, path, &params, &ptx) || slv_ptx_load_tables(ptx) ||
        slv_ptx_get_encoding(ptx, &encoding))
        goto done;
    s.ptx = ptx;
    s.info = slv_ptx_get_info(ptx);
    if ((code =
             value_faces(command, "--sheet-faces", options->sheet_faces, s.info->nfaces, &s.faces)))
        goto done;
    code = EXIT_FAILED;
    lay_out(&s, options->cell, options->ids ? smallest_cell(&s) : 1);
    slv_image_params image = choose_params(&s, options, encoding, exr);
    if (draw(env, &s, &progress))
        goto done;
    cli_progress_end(&progress);
    uint32_t unnumbered = options->ids ? write_ids(&s) : 0;
    if (unnumbered)
        cli_warning("%s: %u numbers do not fit into cells of %u pixels (--cell)", options->sheet,
                    unnumbered, s.cell);
    if (output_image(env, options->sheet, &s.image, image, options->progress, options->json))
        goto done;
    if (s.shown < s.faces.nfaces)
        cli_warning("%s: %llu of %llu faces are left out: smaller cells (--cell) or fewer faces "
                    "(--sheet-faces) fit",
                    options->sheet, (unsigned long long)(s.faces.nfaces - s.shown),
                    (unsigned long long)s.faces.nfaces);
    *out = (info_sheet_layout){.columns = s.columns,
                               .rows = s.rows,
                               .cell = s.cell,
                               .gap = s.gap,
                               .width = s.image.width,
                               .height = s.image.height,
                               .shown = s.shown,
                               .faces = s.faces.nfaces};
    code = EXIT_OK;
done:
    cli_progress_end(&progress);
    slv_image_free(&s.image);
    slv_ptx_reader_destroy(s.reader);
    slv_ptx_close(ptx);
    free(s.faces.list);
    free(s.texels);
    free(s.values);
    return code;
}
