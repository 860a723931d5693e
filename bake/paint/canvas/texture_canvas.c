/* A store as a canvas. */
#include <selvage/canvas.h>

enum { CHUNK = 16384 };

static slv_result describe(void *user, slv_canvas_desc *out) {
    const slv_texture_desc *desc = slv_texture_get_desc(user);
    *out = (slv_canvas_desc){desc->nfaces, desc->nchannels, desc->alpha_channel, desc->res};
    return SLV_OK;
}

static slv_result read_rect(void *user, uint32_t face, slv_rect rect, float *out) {
    const slv_texture_desc *desc = slv_texture_get_desc(user);
    const unsigned char *texels = slv_texture_texels(user, face);
    size_t size = slv_type_size(desc->type) * desc->nchannels;
    bool constant = slv_texture_is_constant(user, face);
    for (uint32_t y = rect.y; y < rect.y + rect.height; y++)
        if (constant) {
            for (uint32_t x = 0; x < rect.width; x++, out += desc->nchannels)
                slv_type_to_float(desc->type, texels, desc->nchannels, out);
        } else {
            slv_type_to_float(desc->type,
                              texels + (((size_t)y << desc->res[face].u) + rect.x) * size,
                              (size_t)rect.width * desc->nchannels, out);
            out += (size_t)rect.width * desc->nchannels;
        }
    return SLV_OK;
}

/* In pieces that fit the stack: texels of more channels than that are not painted on. */
static slv_result write_rect(void *user, uint32_t face, slv_rect rect, const float *texels) {
    const slv_texture_desc *desc = slv_texture_get_desc(user);
    size_t size = slv_type_size(desc->type) * desc->nchannels;
    float aligned[CHUNK / sizeof(float)];
    uint32_t fit = size ? (uint32_t)(sizeof aligned / size) : 0;
    if (!fit)
        return SLV_ERROR_UNSUPPORTED;
    uint32_t width = rect.width < fit ? rect.width : fit, rows = fit / (width ? width : 1);
    rows = width < rect.width ? 1 : rows;
    for (uint32_t y = 0; y < rect.height; y += rows)
        for (uint32_t x = 0; x < rect.width; x += width) {
            slv_rect piece = {rect.x + x, rect.y + y,
                              rect.width - x < width ? rect.width - x : width,
                              rect.height - y < rows ? rect.height - y : rows};
            slv_type_from_float(desc->type, texels + ((size_t)y * rect.width + x) * desc->nchannels,
                                (size_t)piece.width * piece.height * desc->nchannels, aligned);
            slv_result result = slv_texture_set_rect(user, face, piece, aligned);
            if (result)
                return result;
        }
    return SLV_OK;
}

slv_canvas slv_texture_as_canvas(slv_texture *texture) {
    static const slv_canvas_fns fns = {
        .describe = describe, .read = read_rect, .write = write_rect};
    return (slv_canvas){&fns, texture};
}
