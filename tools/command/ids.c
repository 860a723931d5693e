/* Draws face numbers. */
#include "command/ids.h"

#include "command/output.h"

#include <selvage/reference.h>

#include <stdio.h>
#include <stdlib.h>

/* Three dots wide and five high, from the top: the highest bit is the upper left one. */
static const uint16_t digits[10] = {0x7B6F, 0x2C97, 0x73E7, 0x73CF, 0x5BC9,
                                    0x79CF, 0x79EF, 0x7249, 0x7BEF, 0x7BCF};
enum { DOTS_WIDE = 3, DOTS_HIGH = 5 };

void ids_number_size(uint32_t number, uint32_t zoom, uint32_t *width, uint32_t *height) {
    char text[16];
    int length = snprintf(text, sizeof text, "%u", number);
    *width = zoom * ((DOTS_WIDE + 1) * (uint32_t)length + 1);
    *height = zoom * (DOTS_HIGH + 2);
}

static void put(slv_image *image, uint32_t x, uint32_t y, float value) {
    uint32_t n = image->nchannels;
    float *pixel = image->pixels + ((size_t)y * image->width + x) * n;
    for (uint32_t c = 0; c < n; c++)
        pixel[c] = n % 2 == 0 && c == n - 1 ? 1 : value;
}

void ids_number_draw(slv_image *image, uint32_t number, uint32_t left, uint32_t top,
                     uint32_t zoom) {
    char text[16];
    uint32_t width, height;
    snprintf(text, sizeof text, "%u", number);
    ids_number_size(number, zoom, &width, &height);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            uint32_t dx = x / zoom, dy = y / zoom, at = (dx - 1) % (DOTS_WIDE + 1);
            bool inside = dx && dy && dy <= DOTS_HIGH && at < DOTS_WIDE;
            uint32_t bit = inside ? 14 - (DOTS_WIDE * (dy - 1) + at) : 0;
            bool white = inside && digits[text[(dx - 1) / (DOTS_WIDE + 1)] - '0'] >> bit & 1;
            put(image, left + x, top + y, white ? 1 : 0);
        }
}

slv_result ids_draw(const slv_env *env, const scene_shot *shot, bool exr, slv_image *out) {
    const slv_reference_params params = {.tessellation = &shot->tessellation,
                                         .images = shot->scene.uv ? &shot->scene.images : NULL};
    size_t npixels = (size_t)shot->width * shot->height;
    slv_reference_hit *hits = calloc(npixels, sizeof *hits);
    slv_reference *reference = NULL;
    slv_result result =
        hits ? slv_reference_create(env, shot->scene.mesh, shot->scene.surface, shot->scene.texture,
                                    shot->scene.adjacency, &params, &reference)
             : output_fail(env, SLV_ERROR_MEMORY, "no memory for %u x %u pixels", shot->width,
                           shot->height);
    if (!result)
        result =
            slv_reference_trace(reference, env, &shot->camera, shot->width, shot->height, hits);
    if (!result)
        result = slv_image_create(env, shot->width, shot->height, exr ? 1 : 4, out);
    for (size_t i = 0; i < npixels && !result; i++) {
        int32_t face = scene_file_face(&shot->scene, hits[i].face);
        if (exr) {
            out->pixels[i] = (float)face;
            continue;
        }
        uint32_t code = ((uint32_t)(face + 1) * (uint32_t)IDS_FACTOR) & 0xFFFFFF;
        for (int c = 0; c < 3; c++)
            out->pixels[4 * i + (size_t)c] = (float)(code >> 8 * c & 255) / 255;
        out->pixels[4 * i + 3] = face >= 0;
    }
    slv_reference_destroy(reference);
    free(hits);
    return result;
}
