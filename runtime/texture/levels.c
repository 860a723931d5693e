/* Every level of every face, each a mean of the one above. */
#include "base/half.h"
#include "base/log.h"
#include "base/memory.h"
#include "texture/reduce.h"
#include "texture/texture_data.h"

#include <assert.h>
#include <string.h>

#define FACES_PER_RANGE 16

/* Sums of integers up to 4 * 65535 are exact, so this is the float mean, rounded to nearest and up
 * at a half. */
#define DEFINE_PAIRS(name, value_type, SUM2)                                                       \
    static void name##_pairs(const void *from, size_t step, size_t count, size_t nchannels,        \
                             void *to) {                                                           \
        const value_type *a = from, *b = a + step;                                                 \
        value_type *out = to;                                                                      \
        for (size_t i = 0; i < count; i++, a += 2 * nchannels, b += 2 * nchannels)                 \
            for (size_t c = 0; c < nchannels; c++)                                                 \
                *out++ = SUM2(a[c], b[c]);                                                         \
    }
#define DEFINE_QUADS(name, value_type, SUM4)                                                       \
    static void name##_quads(const void *from, size_t pitch, size_t count, size_t nchannels,       \
                             void *to) {                                                           \
        const value_type *a = from, *b = a + pitch;                                                \
        value_type *out = to;                                                                      \
        for (size_t i = 0; i < count; i++, a += 2 * nchannels, b += 2 * nchannels)                 \
            for (size_t c = 0; c < nchannels; c++)                                                 \
                *out++ = SUM4(a[c], a[nchannels + c], b[c], b[nchannels + c]);                     \
    }

#define INT2(type, a, b) ((type)(((uint32_t)(a) + (b) + 1) >> 1))
#define INT4(type, a, b, c, d) ((type)(((uint32_t)(a) + (b) + (c) + (d) + 2) >> 2))
#define U8_2(a, b) INT2(uint8_t, a, b)
#define U8_4(a, b, c, d) INT4(uint8_t, a, b, c, d)
#define U16_2(a, b) INT2(uint16_t, a, b)
#define U16_4(a, b, c, d) INT4(uint16_t, a, b, c, d)
#define FLOAT_2(a, b) (0.5f * ((a) + (b)))
#define FLOAT_4(a, b, c, d) (0.25f * (((a) + (b)) + ((c) + (d))))
#define HALF_2(a, b) slvi_half_from_float(FLOAT_2(slvi_half_to_float(a), slvi_half_to_float(b)))
#define HALF_4(a, b, c, d)                                                                         \
    slvi_half_from_float(FLOAT_4(slvi_half_to_float(a), slvi_half_to_float(b),                     \
                                 slvi_half_to_float(c), slvi_half_to_float(d)))

DEFINE_PAIRS(u8, uint8_t, U8_2)
DEFINE_PAIRS(u16, uint16_t, U16_2)
DEFINE_PAIRS(half, uint16_t, HALF_2)
DEFINE_PAIRS(float, float, FLOAT_2)
DEFINE_QUADS(u8, uint8_t, U8_4)
DEFINE_QUADS(u16, uint16_t, U16_4)
DEFINE_QUADS(half_each, uint16_t, HALF_4)
DEFINE_QUADS(float, float, FLOAT_4)

/* As floats in between, many of which are converted at once. */
static void half_quads(const void *from, size_t pitch, size_t count, size_t nchannels, void *to) {
    enum { VALUES = 512 };
    float rows[2 * VALUES], means[VALUES / 2];
    const uint16_t *at = from;
    uint16_t *out = to;
    size_t most = VALUES / 2 / nchannels;
    if (!most) {
        half_each_quads(from, pitch, count, nchannels, to);
        return;
    }
    for (size_t first = 0, n; first < count; first += n) {
        n = count - first < most ? count - first : most;
        size_t values = 2 * n * nchannels;
        slv_type_to_float(SLV_TYPE_HALF, at, values, rows);
        slv_type_to_float(SLV_TYPE_HALF, at + pitch, values, rows + VALUES);
        float_quads(rows, VALUES, n, nchannels, means);
        slv_type_from_float(SLV_TYPE_HALF, means, values / 2, out);
        at += values;
        out += values / 2;
    }
}

typedef void (*mean_fn)(const void *from, size_t step, size_t count, size_t nchannels, void *to);

/* Fills a rectangle of a level from the level above, which has twice as many texels along one axis
 * or both. */
static void reduce(const slv_levels *levels, slv_res from_res, slv_res to_res,
                   const unsigned char *from, slv_rect rect, unsigned char *to) {
    static const mean_fn pairs[] = {u8_pairs, u16_pairs, half_pairs, float_pairs};
    static const mean_fn quads[] = {u8_quads, u16_quads, half_quads, float_quads};
    size_t nchannels = levels->desc.nchannels, size = levels->texel_size;
    size_t row = nchannels << from_res.u;
    bool u = to_res.u < from_res.u, v = to_res.v < from_res.v;
    slv_type type = levels->desc.type;
    for (size_t y = rect.y; y < (size_t)rect.y + rect.height; y++) {
        const unsigned char *at = from + (((y << v) << from_res.u) + ((size_t)rect.x << u)) * size;
        unsigned char *out = to + ((y << to_res.u) + rect.x) * size;
        if (u && v)
            quads[type](at, row, rect.width, nchannels, out);
        else if (u)
            pairs[type](at, nchannels, rect.width, nchannels, out);
        else /* two rows are a pair of texels with very many channels */
            pairs[type](at, row, 1, rect.width * nchannels, out);
    }
}

/* The texels of the next level that depend on a rectangle of one. */
static slv_rect reduced(slv_rect rect, slv_res from, slv_res to) {
    bool u = to.u < from.u, v = to.v < from.v;
    uint32_t x = rect.x >> u, y = rect.y >> v;
    return (slv_rect){x, y, ((rect.x + rect.width - 1) >> u) - x + 1,
                      ((rect.y + rect.height - 1) >> v) - y + 1};
}

static slv_rect whole(slv_res res) {
    return (slv_rect){0, 0, 1u << res.u, 1u << res.v};
}

static size_t texels_in(const slv_levels *levels, uint32_t face, slvi_level_room room) {
    slv_res res = levels->res[face];
    size_t full = slv_res_texels(res), rest = 0;
    if (room == SLVI_ROOM_RUN)
        return full;
    for (uint32_t level = 1; level < slv_res_level_count(res); level++)
        rest += slv_res_texels(slvi_level_res(levels, face, level));
    return room == SLVI_ROOM_ALL ? full + rest : rest;
}

/* What a face takes as its texels are now: level 0 of one that is not constant may be the
 * texture's own. */
static slvi_level_room needed(const slv_levels *levels, const slv_texture *texture, uint32_t face) {
    if (slv_texture_is_constant(texture, face))
        return SLVI_ROOM_RUN;
    return levels->borrowed ? SLVI_ROOM_REST : SLVI_ROOM_ALL;
}

/* Points to where each level of a face is. */
static void point(const slv_levels *levels, const slv_texture *texture, uint32_t face) {
    unsigned char **at = levels->at + levels->first[face], *next = levels->own[face];
    bool constant = slv_texture_is_constant(texture, face);
    for (uint32_t level = 0; level < slv_res_level_count(levels->res[face]); level++) {
        if (!level && levels->borrowed && !constant) { /* never written to */
            at[level] = (unsigned char *)(uintptr_t)slv_texture_texels(texture, face);
            continue;
        }
        at[level] = next;
        if (!constant)
            next += slv_res_texels(slvi_level_res(levels, face, level)) * levels->texel_size;
    }
}

/* Fills what depends on a rectangle of level 0, where `point` says. */
static void fill_face(const slv_levels *levels, const slv_texture *texture, uint32_t face,
                      slv_rect rect) {
    slv_res res = levels->res[face];
    unsigned char *const *at = levels->at + levels->first[face];
    const unsigned char *texels = slv_texture_texels(texture, face);
    size_t size = levels->texel_size;
    if (slv_texture_is_constant(texture, face)) {
        slvi_fill_texels(at[0], texels, size, slv_res_texels(res));
        return;
    }
    for (size_t y = rect.y; !levels->borrowed && y < (size_t)rect.y + rect.height; y++) {
        size_t first = ((y << res.u) + rect.x) * size;
        memcpy(at[0] + first, texels + first, rect.width * size);
    }
    for (uint32_t level = 1; level < slv_res_level_count(res); level++) {
        slv_res above = slvi_level_res(levels, face, level - 1);
        slv_res below = slvi_level_res(levels, face, level);
        rect = reduced(rect, above, below);
        reduce(levels, above, below, at[level - 1], rect, at[level]);
    }
}

struct fill {
    const slv_texture *texture;
    slv_levels *levels;
};

static slv_result fill_faces(void *user, uint64_t first, uint64_t end) {
    const struct fill *fill = user;
    for (uint32_t face = (uint32_t)first; face < end; face++)
        fill_face(fill->levels, fill->texture, face, whole(fill->levels->res[face]));
    return SLV_OK;
}

/* Where every level goes: `own` is first counted from 0, so that memory can be asked for. */
static slv_result lay_out(slv_levels *levels, const slv_texture *texture, uint64_t *bytes) {
    size_t next = 0;
    *bytes = 0;
    for (uint32_t face = 0; face < levels->desc.nfaces; face++) {
        slvi_level_room room = needed(levels, texture, face);
        uint64_t texels = texels_in(levels, face, room);
        levels->first[face] = next;
        levels->room[face] = (uint8_t)room;
        levels->most[face] = (uint8_t)slv_res_level_count(levels->res[face]);
        next += levels->most[face];
        if (texels > (UINT64_MAX - *bytes) / levels->texel_size)
            return slvi_fail(&levels->env, SLV_ERROR_LIMIT, "levels: more than 2^64 bytes");
        *bytes += texels * levels->texel_size;
    }
    levels->first[levels->desc.nfaces] = next;
    return SLV_OK;
}

static void point_all(const slv_levels *levels, const slv_texture *texture) {
    unsigned char *next = levels->texels;
    for (uint32_t face = 0; face < levels->desc.nfaces; face++) {
        levels->own[face] = next;
        next += texels_in(levels, face, levels->room[face]) * levels->texel_size;
        point(levels, texture, face);
    }
}

static slv_result create(const slv_env *env, const slv_texture *texture, bool borrowed, bool even,
                         slv_levels **out) {
    slv_levels *levels = NULL;
    *out = NULL;
    if (!texture)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "levels: no texture");
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    slv_result result = slvi_alloc(env, "levels", 1, sizeof *levels, &levels);
    if (result)
        return result;
    levels->desc = *desc;
    levels->texel_size = slv_type_size(desc->type) * desc->nchannels;
    levels->borrowed = borrowed;
    levels->even = even;
    uint64_t nlevels = 0, bytes = 0, n = desc->nfaces;
    for (uint32_t face = 0; face < desc->nfaces; face++)
        nlevels += slv_res_level_count(desc->res[face]);
    if ((result = slvi_parallel_env_begin(env, &levels->log, &levels->env)) ||
        (result = slvi_alloc(env, "level resolutions", n, sizeof *levels->res, &levels->res)) ||
        (result = slvi_alloc(env, "level table", n + 1, sizeof *levels->first, &levels->first)) ||
        (result = slvi_alloc(env, "level table", n, 1, &levels->room)) ||
        (result = slvi_alloc(env, "level table", n, 1, &levels->most)) ||
        (result = slvi_alloc(env, "level table", n, sizeof *levels->own, &levels->own)) ||
        (result = slvi_alloc(env, "level table", nlevels, sizeof *levels->at, &levels->at)))
        goto done;
    if (n)
        memcpy(levels->res, desc->res, n * sizeof *levels->res);
    levels->desc.res = levels->res;
    struct fill fill = {texture, levels};
    if ((result = lay_out(levels, texture, &bytes)) ||
        (result = slvi_alloc_plain(env, "level texels", bytes, 1, &levels->texels)))
        goto done;
    levels->nbytes = bytes;
    levels->nat = nlevels;
    point_all(levels, texture);
    if ((result = slvi_parallel_for(env, n, FACES_PER_RANGE, fill_faces, &fill)))
        goto done;
    *out = levels;
    levels = NULL;
done:
    slv_levels_destroy(levels);
    return result;
}

/* Whether a face's room is in the one piece that all faces began with. */
static bool is_first_room(const slv_levels *levels, uint32_t face) {
    uintptr_t at = (uintptr_t)levels->own[face], first = (uintptr_t)levels->texels;
    return at >= first && at <= first + levels->nbytes;
}

/* Another resolution: another place for a face's row of levels if it is longer than ever, and no
 * room yet. */
static slv_result resize(slv_levels *levels, uint32_t face, slv_res res) {
    size_t has = slv_res_level_count(res);
    if (has > levels->most[face]) {
        slv_result result = slvi_grow(&levels->env, "level table", levels->nat + has,
                                      sizeof *levels->at, &levels->at);
        if (result)
            return result;
        levels->first[face] = levels->nat;
        levels->most[face] = (uint8_t)has;
        levels->nat += has;
    }
    levels->res[face] = res;
    levels->room[face] = SLVI_ROOM_NONE;
    return SLV_OK;
}

slv_result slv_levels_update(slv_levels *levels, const slv_texture *texture, uint32_t face,
                             slv_rect rect) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    if (levels->fixed)
        return slvi_fail(&levels->env, SLV_ERROR_UNSUPPORTED,
                         "levels: those that agree where faces meet are made anew, not updated");
    if (desc->nfaces != levels->desc.nfaces || desc->type != levels->desc.type ||
        desc->nchannels != levels->desc.nchannels)
        return slvi_fail(&levels->env, SLV_ERROR_MISMATCH, "levels: not made from this texture");
    if (face >= levels->desc.nfaces || !slvi_rect_is_within(rect, desc->res[face]))
        return slvi_fail(&levels->env, SLV_ERROR_ARGUMENT, "levels: face %u has no such texels",
                         (unsigned)face);
    slv_res res = desc->res[face];
    bool resized = res.u != levels->res[face].u || res.v != levels->res[face].v;
    slv_result result = resized ? resize(levels, face, res) : SLV_OK;
    if (result)
        return result;
    slvi_level_room room = needed(levels, texture, face);
    resized = levels->room[face] == SLVI_ROOM_NONE;
    if (room > levels->room[face]) {
        unsigned char *own = NULL;
        result = slvi_alloc_plain(&levels->env, "levels of a face", texels_in(levels, face, room),
                                  levels->texel_size, &own);
        if (result)
            return result;
        if (!is_first_room(levels, face))
            slvi_free(levels->own[face]);
        levels->own[face] = own;
        levels->room[face] = (uint8_t)room;
    }
    /* All levels but a constant face's first lie apart: where they are says which it was. */
    unsigned char *const *at = levels->at + levels->first[face];
    bool constant = slv_texture_is_constant(texture, face);
    bool all = resized || constant || slv_res_level_count(res) < 2 || at[0] == at[1];
    point(levels, texture, face);
    fill_face(levels, texture, face, all ? whole(res) : rect);
    return SLV_OK;
}

static slv_result create_within(const slv_env *env, const slv_texture *texture, bool borrowed,
                                bool even, slv_levels **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, create(&own, texture, borrowed, even, out));
}

slv_result slv_levels_create(const slv_env *env, const slv_texture *texture, slv_levels **out) {
    return create_within(env, texture, false, false, out);
}

void slv_levels_set_edge_filter(slv_levels *levels, slv_edge_filter filter) {
    levels->vectors = filter == SLV_EDGE_FILTER_TANVEC && levels->desc.nchannels > 1;
}

slv_result slv_levels_create_over(const slv_env *env, const slv_texture *texture,
                                  slv_levels **out) {
    return create_within(env, texture, true, false, out);
}

slv_result slv_levels_create_even(const slv_env *env, const slv_texture *texture,
                                  slv_levels **out) {
    return create_within(env, texture, true, true, out);
}

void slv_levels_destroy(slv_levels *levels) {
    if (!levels)
        return;
    for (uint32_t face = 0; levels->own && levels->texels && face < levels->desc.nfaces; face++)
        if (!is_first_room(levels, face))
            slvi_free(levels->own[face]);
    slvi_free(levels->texels);
    slvi_free(levels->kind);
    slvi_free(levels->own);
    slvi_free(levels->room);
    slvi_free(levels->most);
    slvi_free(levels->at);
    slvi_free(levels->first);
    slvi_free(levels->res);
    slvi_parallel_env_end(levels->log);
    slvi_free(levels);
}

const void *slv_levels_texels(const slv_levels *levels, uint32_t face, uint32_t level) {
    assert(face < levels->desc.nfaces && level < slv_levels_count(levels, face));
    return levels->at[levels->first[face] + level];
}

uint32_t slv_levels_count(const slv_levels *levels, uint32_t face) {
    assert(face < levels->desc.nfaces);
    return slv_res_level_count(levels->res[face]);
}

const slv_texture_desc *slv_levels_get_desc(const slv_levels *levels) {
    return &levels->desc;
}
