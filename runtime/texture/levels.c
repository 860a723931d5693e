/* Every level of every face, each a mean of the one above. */
#include "base/log.h"
#include "base/memory.h"
#include "texture/texture_data.h"

#include <selvage/half.h>

#include <assert.h>
#include <string.h>

#define FACES_PER_RANGE 16

/* Sums of integers up to 4 * 65535 are exact, so this is the float mean, rounded to nearest and up
 * at a half. */
#define DEFINE_MEANS(name, value_type, SUM2, SUM4)                                                 \
    static void name##_pairs(const void *from, size_t step, size_t count, size_t nchannels,        \
                             void *to) {                                                           \
        const value_type *a = from, *b = a + step;                                                 \
        value_type *out = to;                                                                      \
        for (size_t i = 0; i < count; i++, a += 2 * nchannels, b += 2 * nchannels)                 \
            for (size_t c = 0; c < nchannels; c++)                                                 \
                *out++ = SUM2(a[c], b[c]);                                                         \
    }                                                                                              \
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
#define HALF_2(a, b) slv_half_from_float(FLOAT_2(slv_half_to_float(a), slv_half_to_float(b)))
#define HALF_4(a, b, c, d)                                                                         \
    slv_half_from_float(FLOAT_4(slv_half_to_float(a), slv_half_to_float(b), slv_half_to_float(c),  \
                                slv_half_to_float(d)))

DEFINE_MEANS(u8, uint8_t, U8_2, U8_4)
DEFINE_MEANS(u16, uint16_t, U16_2, U16_4)
DEFINE_MEANS(half, uint16_t, HALF_2, HALF_4)
DEFINE_MEANS(float, float, FLOAT_2, FLOAT_4)

typedef void (*mean_fn)(const void *from, size_t step, size_t count, size_t nchannels, void *to);

static void reduce(const slv_levels *levels, slv_res from_res, const unsigned char *from,
                   unsigned char *to) {
    static const mean_fn pairs[] = {u8_pairs, u16_pairs, half_pairs, float_pairs};
    static const mean_fn quads[] = {u8_quads, u16_quads, half_quads, float_quads};
    size_t nchannels = levels->desc.nchannels;
    size_t width = (size_t)1 << from_res.u, height = (size_t)1 << from_res.v;
    size_t pitch = width * nchannels, pitch_bytes = width * levels->texel_size;
    slv_type type = levels->desc.type;
    /* A single row or column is a run of pairs either way. */
    if (height == 1 || width == 1) {
        pairs[type](from, nchannels, width * height / 2, nchannels, to);
        return;
    }
    for (size_t y = 0; y < height; y += 2, from += 2 * pitch_bytes, to += pitch_bytes / 2)
        quads[type](from, pitch, width / 2, nchannels, to);
}

struct fill {
    const slv_texture *texture;
    slv_levels *levels;
    bool borrowed; /* level 0 is the texture's */
};

static void repeat(unsigned char *to, const void *texel, size_t texel_size, size_t count) {
    memcpy(to, texel, texel_size);
    for (size_t filled = texel_size, total = texel_size * count; filled < total;) {
        size_t more = filled < total - filled ? filled : total - filled;
        memcpy(to + filled, to, more);
        filled += more;
    }
}

static slv_result fill_faces(void *user, uint64_t first, uint64_t end) {
    const struct fill *fill = user;
    slv_levels *levels = fill->levels;
    for (uint32_t face = (uint32_t)first; face < end; face++) {
        slv_res res = levels->res[face];
        unsigned char *const *at = levels->at + levels->first[face];
        const void *texels = slv_texture_texels(fill->texture, face);
        if (slv_texture_is_constant(fill->texture, face)) {
            repeat(at[0], texels, levels->texel_size, slv_res_texels(res));
            continue;
        }
        if (!fill->borrowed)
            memcpy(at[0], texels, slv_res_texels(res) * levels->texel_size);
        for (uint32_t level = 1; level < slv_res_level_count(res); level++)
            reduce(levels, slv_res_level(res, level - 1), at[level - 1], at[level]);
    }
    return SLV_OK;
}

/* Bytes of a face's level that are this object's. All levels of a constant face are one run of
 * equal texels, so they share one. */
static uint64_t own_bytes(const slv_levels *levels, const struct fill *fill, uint32_t face,
                          uint32_t level) {
    bool constant = slv_texture_is_constant(fill->texture, face);
    if (constant ? level > 0 : fill->borrowed && level == 0)
        return 0;
    return (uint64_t)levels->texel_size * slv_res_texels(slv_res_level(levels->res[face], level));
}

static slv_result count_bytes(const struct fill *fill, uint64_t *bytes) {
    const slv_levels *levels = fill->levels;
    *bytes = 0;
    for (uint32_t face = 0; face < levels->desc.nfaces; face++) {
        for (uint32_t level = 0; level < slv_res_level_count(levels->res[face]); level++) {
            uint64_t size = own_bytes(levels, fill, face, level);
            if (size > UINT64_MAX - *bytes)
                return slvi_fail(&levels->env, SLV_ERROR_LIMIT, "levels: more than 2^64 bytes");
            *bytes += size;
        }
    }
    return SLV_OK;
}

/* Where every level goes. */
static void lay_out(const struct fill *fill) {
    slv_levels *levels = fill->levels;
    unsigned char *free_from = levels->texels;
    size_t next = 0;
    for (uint32_t face = 0; face < levels->desc.nfaces; face++) {
        bool constant = slv_texture_is_constant(fill->texture, face);
        levels->first[face] = next;
        for (uint32_t level = 0; level < slv_res_level_count(levels->res[face]); level++) {
            unsigned char **at = &levels->at[next++];
            if (constant && level)
                *at = at[-1];
            else if (fill->borrowed && !constant && !level) /* never written to */
                *at = (unsigned char *)(uintptr_t)slv_texture_texels(fill->texture, face);
            else
                *at = free_from;
            free_from += own_bytes(levels, fill, face, level);
        }
    }
    levels->first[levels->desc.nfaces] = next;
}

static slv_result create(const slv_env *env, const slv_texture *texture, bool borrowed,
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
    uint64_t nlevels = 0, bytes = 0;
    for (uint32_t face = 0; face < desc->nfaces; face++)
        nlevels += slv_res_level_count(desc->res[face]);
    if ((result = slvi_parallel_env_begin(env, &levels->log, &levels->env)) ||
        (result = slvi_alloc(env, "level resolutions", desc->nfaces, sizeof *levels->res,
                             &levels->res)) ||
        (result = slvi_alloc(env, "level table", desc->nfaces + (uint64_t)1, sizeof *levels->first,
                             &levels->first)) ||
        (result = slvi_alloc(env, "level table", nlevels, sizeof *levels->at, &levels->at)))
        goto done;
    if (desc->nfaces)
        memcpy(levels->res, desc->res, desc->nfaces * sizeof *levels->res);
    levels->desc.res = levels->res;
    struct fill fill = {texture, levels, borrowed};
    if ((result = count_bytes(&fill, &bytes)) ||
        (result = slvi_alloc_plain(env, "level texels", bytes, 1, &levels->texels)))
        goto done;
    lay_out(&fill);
    if ((result = slvi_parallel_for(env, desc->nfaces, FACES_PER_RANGE, fill_faces, &fill)))
        goto done;
    *out = levels;
    levels = NULL;
done:
    slv_levels_destroy(levels);
    return result;
}

static slv_result create_within(const slv_env *env, const slv_texture *texture, bool borrowed,
                                slv_levels **out) {
    slv_env own;
    slv_result result = slvi_budget_begin(env, &own);
    if (result)
        *out = NULL;
    else
        result = create(&own, texture, borrowed, out);
    slvi_budget_end(&own);
    return result;
}

slv_result slv_levels_create(const slv_env *env, const slv_texture *texture, slv_levels **out) {
    return create_within(env, texture, false, out);
}

slv_result slv_levels_create_over(const slv_env *env, const slv_texture *texture,
                                  slv_levels **out) {
    return create_within(env, texture, true, out);
}

void slv_levels_destroy(slv_levels *levels) {
    if (!levels)
        return;
    slvi_free(levels->texels);
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
