/* Which tiles a mesh needs, and reading them. */
#include "uv/tiles.h"

#include "base/log.h"
#include "base/memory.h"

#include <selvage/image.h>

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { NAME_ROOM = 4096, LISTED = 24 };

/* The lowest and highest texture coordinate of a face. */
static void bounds_of(const float *corners, float low[2], float high[2]) {
    for (int axis = 0; axis < 2; axis++) {
        low[axis] = high[axis] = corners[axis];
        for (int c = 1; c < 4; c++) {
            low[axis] = fminf(low[axis], corners[2 * c + axis]);
            high[axis] = fmaxf(high[axis], corners[2 * c + axis]);
        }
    }
}

static int32_t cell_within(float x, int32_t most) {
    return x > 0 ? x < (float)most ? (int32_t)x : most : 0;
}

/* How many faces lie in each cell: differences first, summed up at the end, so that a face costs
 * the same however far it reaches. */
static void count_cells(const float *corners, uint32_t nfaces, int32_t *count) {
    enum { STRIDE = UV_CELLS_U + 1 };
    for (uint32_t face = 0; face < nfaces; face++) {
        float low[2], high[2];
        if (isnan(corners[8 * (size_t)face]))
            continue;
        bounds_of(corners + 8 * (size_t)face, low, high);
        if (high[0] < 0 || high[1] < 0)
            continue;
        int32_t u0 = cell_within(floorf(low[0]), UV_CELLS_U),
                v0 = cell_within(floorf(low[1]), UV_CELLS_V);
        /* a face that ends on a border has nothing beyond it */
        int32_t u1 = cell_within(fmaxf(ceilf(high[0]), floorf(low[0]) + 1), UV_CELLS_U),
                v1 = cell_within(fmaxf(ceilf(high[1]), floorf(low[1]) + 1), UV_CELLS_V);
        count[v0 * STRIDE + u0]++;
        count[v0 * STRIDE + u1]--;
        count[v1 * STRIDE + u0]--;
        count[v1 * STRIDE + u1]++;
    }
    for (int32_t v = 0; v <= UV_CELLS_V; v++)
        for (int32_t u = 1; u < STRIDE; u++)
            count[v * STRIDE + u] += count[v * STRIDE + u - 1];
    for (int32_t v = 1; v <= UV_CELLS_V; v++)
        for (int32_t u = 0; u < STRIDE; u++)
            count[v * STRIDE + u] += count[(v - 1) * STRIDE + u];
}

slv_result slvi_uv_count_cells(const slv_env *env, const float *corners, uint32_t nfaces,
                               int32_t **out) {
    int32_t *count = NULL;
    slv_result result =
        slvi_alloc(env, "cells", (UV_CELLS_U + 1) * (UV_CELLS_V + 1), sizeof *count, &count);
    if (result)
        return result;
    count_cells(corners, nfaces, count);
    for (int32_t cell = 0; cell < UV_CELLS_U * UV_CELLS_V; cell++)
        count[cell] = count[cell / UV_CELLS_U * (UV_CELLS_U + 1) + cell % UV_CELLS_U];
    *out = count;
    return SLV_OK;
}

slv_result slvi_uv_tile_name(const slv_env *env, const char *path, int32_t cell, char *out,
                             size_t room) {
    const char *mark = strstr(path, SLV_BAKE_UDIM);
    if (snprintf(out, room, "%.*s%d%s", (int)(mark - path), path, UV_FIRST_TILE + cell,
                 mark + strlen(SLV_BAKE_UDIM)) >= (int)room)
        return slvi_fail(env, SLV_ERROR_IO, "%s: the name is too long", path);
    return SLV_OK;
}

/* One list for all files: texels of a wider type hold those of others. */
static int rank_of(slv_type type) {
    static const int ranks[] = {
        [SLV_TYPE_U8] = 0, [SLV_TYPE_U16] = 1, [SLV_TYPE_HALF] = 1, [SLV_TYPE_FLOAT] = 2};
    return ranks[type];
}

/* What each value of a type of one or two bytes stands for. */
static slv_result make_table(const slv_env *env, const uv_tile *tile, bool decode, float **out) {
    uint32_t count = tile->type == SLV_TYPE_U8 ? 256 : 65536;
    uint8_t narrow[256];
    uint16_t *wide = NULL;
    slv_result result = slvi_alloc_plain(env, "bake: curve", count, sizeof **out, out);
    if (!result && count > 256)
        result = slvi_alloc_plain(env, "bake: curve", count, sizeof *wide, &wide);
    if (result)
        return result;
    for (uint32_t i = 0; i < count; i++)
        if (count > 256)
            wide[i] = (uint16_t)i;
        else
            narrow[i] = (uint8_t)i;
    slv_type_to_float(tile->type, wide ? (void *)wide : narrow, count, *out);
    if (decode)
        slv_texels_decode(1, SLV_NO_ALPHA, *out, count);
    slvi_free(wide);
    return SLV_OK;
}

/* Pixels as the file had them: of a PNG with a quarter of the memory that floats take. */
static slv_result keep(const slv_env *env, const char *path, const uv_set *set,
                       slv_texture_encoding encoding, slv_image *image, uv_tile *tile) {
    uint64_t count = (uint64_t)image->width * image->height;
    bool decode = encoding == SLV_TEXTURE_SRGB;
    slv_result result = SLV_OK;
    *tile = (uv_tile){.type = image->type, .width = image->width, .height = image->height};
    tile->straight = set->alpha >= 0 && rank_of(image->type) < 2 && image->type != SLV_TYPE_HALF;
    if (image->type == SLV_TYPE_FLOAT) {
        if (decode)
            slv_texels_decode(set->nchannels, set->alpha, image->pixels, count);
        tile->pixels = image->pixels;
        image->pixels = NULL;
        return SLV_OK;
    }
    if ((result = slvi_alloc_plain(env, path, count * set->nchannels, slv_type_size(image->type),
                                   &tile->pixels)) ||
        (result = make_table(env, tile, decode, &tile->colors)) ||
        (result = make_table(env, tile, false, &tile->alphas)))
        return result;
    slv_type_from_float(image->type, image->pixels, (size_t)(count * set->nchannels), tile->pixels);
    return SLV_OK;
}

static slv_result load_tile(const slv_env *env, const char *path, const slv_bake_uv *params,
                            bool first, uv_set *set, uint32_t index) {
    slv_image image;
    slv_result result = slv_image_load(env, path, &image);
    if (result)
        return result;
    slv_texture_encoding encoding = params->encoding ? params->encoding : image.encoding;
    if (first) {
        set->nchannels = image.nchannels;
        set->alpha = image.nchannels % 2 == 0 ? (int32_t)image.nchannels - 1 : SLV_NO_ALPHA;
        set->encoding = encoding;
        set->type = image.type;
    }
    if (set->nchannels != image.nchannels)
        result = slvi_fail(env, SLV_ERROR_MISMATCH, "%s: has %u channels, the tile before it %u",
                           path, image.nchannels, set->nchannels);
    /* without one that holds both */
    if (rank_of(image.type) == rank_of(set->type) && image.type != set->type)
        set->type = SLV_TYPE_FLOAT;
    else if (rank_of(image.type) > rank_of(set->type))
        set->type = image.type;
    set->list[index].width = image.width;
    set->list[index].height = image.height;
    if (!result)
        result = keep(env, path, set, encoding, &image, &set->tiles[index]);
    slv_image_free(&image);
    return result;
}

static slv_result reserve(const slv_env *env, uint32_t count, uv_set *set) {
    slv_result result = slvi_alloc(env, "bake: tiles", count, sizeof *set->tiles, &set->tiles);
    set->ntiles = result ? 0 : count;
    return result ? result : slvi_alloc(env, "bake: tiles", count, sizeof *set->list, &set->list);
}

static void warn_of_repeats(const slv_env *env, const char *path, const float *corners,
                            uint32_t nfaces, uv_set *set) {
    float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (uint32_t face = 0; face < nfaces; face++) {
        float own_low[2], own_high[2];
        if (isnan(corners[8 * (size_t)face]))
            continue;
        bounds_of(corners + 8 * (size_t)face, own_low, own_high);
        for (int axis = 0; axis < 2; axis++) {
            low[axis] = fminf(low[axis], own_low[axis]);
            high[axis] = fmaxf(high[axis], own_high[axis]);
        }
    }
    bool leaves = low[0] < 0 || low[1] < 0 || high[0] > 1 || high[1] > 1;
    if (set->wrap != SLV_BAKE_WRAP_AUTO)
        return;
    set->wrap = leaves ? SLV_BAKE_WRAP_REPEAT : SLV_BAKE_WRAP_CLAMP;
    if (leaves)
        slvi_logf(env, SLV_LOG_WARNING,
                  "%s: texture coordinates leave 0..1 (u %g to %g, v %g to %g), where the image is "
                  "repeated; a set of tiles is named with " SLV_BAKE_UDIM
                  " in place of their number",
                  path, (double)low[0], (double)high[0], (double)low[1], (double)high[1]);
}

/* One line of those that are not there. */
static slv_result tell_missing(const slv_env *env, const char *path, const uv_set *set) {
    char numbers[LISTED * 8] = "";
    size_t used = 0;
    uint32_t missing = 0, faces = 0;
    for (uint32_t i = 0; i < set->ntiles; i++) {
        if (set->tiles[i].pixels)
            continue;
        if (missing < LISTED)
            used += (size_t)snprintf(numbers + used, sizeof numbers - used, "%s%u",
                                     missing ? ", " : "", set->list[i].number);
        missing++;
        faces += set->list[i].faces;
    }
    if (missing && missing == set->ntiles)
        return slvi_fail(env, SLV_ERROR_IO,
                         "%s: none of the tiles that the texture coordinates need is there: %s%s",
                         path, numbers, missing > LISTED ? ", ..." : "");
    if (missing)
        slvi_logf(env, SLV_LOG_WARNING,
                  "%s: %u of %u tiles that the texture coordinates need are not there, for %u "
                  "faces: %s%s",
                  path, missing, set->ntiles, faces, numbers, missing > LISTED ? ", ..." : "");
    return SLV_OK;
}

static slv_result load_set(const slv_env *env, const char *path, const slv_bake_uv *params,
                           const int32_t *count, uv_set *set) {
    uint32_t needed = 0, index = 0;
    bool first = true;
    slv_result result = slvi_alloc_plain(env, "bake: cells", UV_CELLS_U * UV_CELLS_V,
                                         sizeof *set->cells, &set->cells);
    for (int32_t cell = 0; cell < UV_CELLS_U * UV_CELLS_V; cell++)
        needed += count[cell] > 0;
    if (!result && !needed)
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "%s: no face has texture coordinates where tiles are (u 0 to 10, v from "
                         "0)",
                         path);
    if (result || (result = reserve(env, needed, set)))
        return result;
    for (int32_t cell = 0; !result && cell < UV_CELLS_U * UV_CELLS_V; cell++) {
        int32_t faces = count[cell];
        char name[NAME_ROOM];
        set->cells[cell] = -1;
        if (faces <= 0)
            continue;
        set->cells[cell] = (int32_t)index;
        set->list[index] =
            (slv_bake_tile){.number = UV_FIRST_TILE + (uint32_t)cell, .faces = (uint32_t)faces};
        if ((result = slvi_uv_tile_name(env, path, cell, name, sizeof name)))
            break;
        if (access(name, F_OK) == 0) {
            result = load_tile(env, name, params, first, set, index);
            first = false;
        }
        index++;
    }
    return result ? result : tell_missing(env, path, set);
}

slv_result slvi_uv_set_load(const slv_env *env, const char *path, const slv_bake_uv *params,
                            const float *corners, uint32_t nfaces, uv_set *out) {
    int32_t *count = NULL;
    slv_result result;
    *out = (uv_set){.udim = strstr(path, SLV_BAKE_UDIM) != NULL, .wrap = params->wrap};
    if (!out->udim) {
        if ((result = reserve(env, 1, out)))
            return result;
        for (uint32_t face = 0; face < nfaces; face++)
            out->list[0].faces += !isnan(corners[8 * (size_t)face]);
        warn_of_repeats(env, path, corners, nfaces, out);
        return load_tile(env, path, params, true, out, 0);
    }
    if (!(result = slvi_uv_count_cells(env, corners, nfaces, &count)))
        result = load_set(env, path, params, count, out);
    slvi_free(count);
    return result;
}

void slvi_uv_set_free(uv_set *set) {
    for (uint32_t i = 0; set->tiles && i < set->ntiles; i++) {
        slvi_free(set->tiles[i].pixels);
        slvi_free(set->tiles[i].colors);
        slvi_free(set->tiles[i].alphas);
    }
    slvi_free(set->tiles);
    slvi_free(set->list);
    slvi_free(set->cells);
}
