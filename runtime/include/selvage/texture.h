/* The per-face store: every face's own power-of-two texture, its reductions and its borders. */
#ifndef SELVAGE_TEXTURE_H
#define SELVAGE_TEXTURE_H

#include <selvage/adjacency.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Texel types; the values are those of the .ptx file. Integers stand for 0..1, half and float for
 * themselves. */
typedef enum slv_type {
    SLV_TYPE_U8 = 0,
    SLV_TYPE_U16 = 1,
    SLV_TYPE_HALF = 2,
    SLV_TYPE_FLOAT = 3
} slv_type;

/* What the values of colours stand for; alpha is never encoded. */
typedef enum slv_texture_encoding {
    SLV_TEXTURE_AUTO = 0, /* what the texture says of itself, else by type: integers are SRGB, half
                             and float LINEAR */
    SLV_TEXTURE_LINEAR,   /* light */
    SLV_TEXTURE_SRGB,     /* light through the sRGB curve (IEC 61966-2-1), which is undone before
                             anything     is averaged */
    SLV_TEXTURE_DATA      /* no light but numbers, taken as they stand; pictures show them so */
} slv_texture_encoding;

SLV_API const char *slv_texture_encoding_name(slv_texture_encoding encoding); /* auto, linear, srgb,
                                                                                 data */
SLV_API bool slv_texture_encoding_from_name(const char *name, slv_texture_encoding *out);
/* SRGB of integers, LINEAR of half and float. */
SLV_API slv_texture_encoding slv_type_encoding(slv_type type);
/* Undoes or applies the sRGB curve in `count` texels, but in channel `alpha` (SLV_NO_ALPHA: none).
 * What lies outside of 0..1 goes on along the curve's ends. */
SLV_API void slv_texels_decode(uint32_t nchannels, int32_t alpha, float *values, uint64_t count);
SLV_API void slv_texels_encode(uint32_t nchannels, int32_t alpha, float *values, uint64_t count);

/* log2 of width (u) and height (v). */
typedef struct slv_res {
    int8_t u, v;
} slv_res;

#define SLV_MAX_LOG2_RES 16

/* Texels x..x+width-1, y..y+height-1 of a face. */
typedef struct slv_rect {
    uint32_t x, y, width, height;
} slv_rect;

SLV_API size_t slv_type_size(slv_type type);
SLV_API const char *slv_type_name(slv_type type); /* uint8, uint16, half, float */
SLV_API bool slv_type_from_name(const char *name, slv_type *out);

/* The log2 of the side of a face: of a power of two from 1 to 2^SLV_MAX_LOG2_RES; -1 of all else.
 */
SLV_API int slv_res_log2(uint64_t texels);
/* Level `level` of a chain that halves each axis until it is 1, as OpenGL's mipmaps do. */
SLV_API slv_res slv_res_level(slv_res res, uint32_t level);
/* 1 + the larger of the two: how many levels that chain has, the last being 1x1. */
SLV_API uint32_t slv_res_level_count(slv_res res);
/* The same of even levels, of which there are as many: the longer side is halved alone until both
 * are one, and then both. Their texels are as long in u as in v, as far as the face has texels so
 * short, which is what faces of any shapes can have in common along an edge. Those of a square are
 * the plain ones. */
SLV_API slv_res slv_res_even_level(slv_res res, uint32_t level);

/* Reads `count` values as floats, integers divided by their maximum; and back: integers are clamped
 * to 0..1 and rounded to nearest (NaN becomes 0), halves as slv_half_from_float. */
SLV_API void slv_type_to_float(slv_type type, const void *values, size_t count, float *out);
SLV_API void slv_type_from_float(slv_type type, const float *values, size_t count, void *out);

typedef struct slv_texture_desc {
    uint32_t nfaces;
    slv_type type;
    uint32_t nchannels;    /* 1.. */
    int32_t alpha_channel; /* SLV_NO_ALPHA, or the index of the channel that holds coverage of the
                              paint */
    const slv_res *res;    /* nfaces; copied */
    slv_texture_encoding encoding; /* of the colours; default: by type */
} slv_texture_desc;

#define SLV_NO_ALPHA (-1)

/* The store. One thread may change it while no other looks; after that any number may read. Texels
 * are v-major rows, u fastest, channels interleaved, native byte order; row 0 is v=0. */
typedef struct slv_texture slv_texture;

/* All texels start as zero. A constant face costs one texel until it is written in full. */
SLV_NODISCARD SLV_API slv_result slv_texture_create(const slv_env *env,
                                                    const slv_texture_desc *desc,
                                                    slv_texture **out);
SLV_API void slv_texture_destroy(slv_texture *texture);

/* The description, `res` included. Owned by the texture. */
SLV_API const slv_texture_desc *slv_texture_get_desc(const slv_texture *texture);
/* Bytes of all texels as if no face were constant. */
SLV_API uint64_t slv_texture_bytes(const slv_texture *texture);

/* Sets all texels of a face from a tightly packed array, or from one texel. The face becomes
 * constant, keeping its resolution, when every texel is bitwise the same. Different faces may be
 * set from different threads at once. */
SLV_NODISCARD SLV_API slv_result slv_texture_set_face(slv_texture *texture, uint32_t face,
                                                      const void *texels);
SLV_NODISCARD SLV_API slv_result slv_texture_set_constant(slv_texture *texture, uint32_t face,
                                                          const void *texel);

/* Sets the texels of a rectangle from a tightly packed array; else the same. */
SLV_NODISCARD SLV_API slv_result slv_texture_set_rect(slv_texture *texture, uint32_t face,
                                                      slv_rect rect, const void *texels);

/* The same, with texels that `fill` puts where they are to be: all of the rectangle's, the first at
 * `texels`, rows `pitch` texels apart. */
typedef void (*slv_fill_rect)(void *user, void *texels, size_t pitch);
SLV_NODISCARD SLV_API slv_result slv_texture_fill_rect(slv_texture *texture, uint32_t face,
                                                       slv_rect rect, slv_fill_rect fill,
                                                       void *user);

/* Gives a face another resolution, and all its texels from a tightly packed array. Nobody else may
 * use the texture meanwhile, and it must not be open as a source (source.h), whose faces keep their
 * resolution; a texture on the GPU follows (gl_live.h). If it fails the face is as it was. */
SLV_NODISCARD SLV_API slv_result slv_texture_set_resolution(slv_texture *texture, uint32_t face,
                                                            slv_res res, const void *texels);

SLV_API bool slv_texture_is_constant(const slv_texture *texture, uint32_t face);
/* A constant face: one texel. Any other: all of them. Owned by the texture. */
SLV_API const void *slv_texture_texels(const slv_texture *texture, uint32_t face);
/* One texel as `nchannels` floats, constant or not; (x,y) must lie inside. */
SLV_API void slv_texture_fetch(const slv_texture *texture, uint32_t face, uint32_t x, uint32_t y,
                               float *out);

/* What the colours of a texture are, where `wanted` says so, else the description, else the type:
 * never SLV_TEXTURE_AUTO. */
SLV_API slv_texture_encoding slv_texture_get_encoding(const slv_texture *texture,
                                                      slv_texture_encoding wanted);
/* A copy of a texture whose colours are light: SLV_TYPE_HALF of 8 bits, which loses nothing, else
 * SLV_TYPE_FLOAT; or NULL where they are to be taken as they stand, which is so for anything but
 * SLV_TEXTURE_SRGB. On env->threads threads. */
SLV_NODISCARD SLV_API slv_result slv_texture_decode(const slv_env *env, const slv_texture *texture,
                                                    slv_texture_encoding wanted, slv_texture **out);
/* A copy of a texture with its numbers as they are, in a type with a sign: SLV_TYPE_HALF of 8 bits,
 * SLV_TYPE_FLOAT of 16; or NULL where the type has one. On env->threads threads. */
SLV_NODISCARD SLV_API slv_result slv_texture_widen(const slv_env *env, const slv_texture *texture,
                                                   slv_texture **out);
/* Brings a rectangle of a face of either copy up to date. */
SLV_NODISCARD SLV_API slv_result slv_texture_decode_rect(const slv_env *env,
                                                         const slv_texture *texture, uint32_t face,
                                                         slv_rect rect, slv_texture *decoded);

/* A copy of a texture whose colours are multiplied by its alpha, as light: that of SLV_TEXTURE_SRGB
 * is decoded for it and encoded again. In .ptx files alpha covers the channels before it, or, if it
 * is channel 0, those behind it, and colours are as painted; drawn with alpha they must be
 * multiplied, so that what is painted where nothing shows does not show at the rim. Of the type of
 * the texture, rounded. A texture without alpha is SLV_ERROR_ARGUMENT. On env->threads threads. */
SLV_NODISCARD SLV_API slv_result slv_texture_premultiply(const slv_env *env,
                                                         const slv_texture *texture,
                                                         slv_texture_encoding wanted,
                                                         slv_texture **out);

/* Every level of every face, down to 1x1: a 2x2 mean (2x1 where an axis is at 1) of the level
 * above, computed in float and rounded once a level. A snapshot: it follows later changes of the
 * texture where slv_levels_update is told of them; else immutable. */
typedef struct slv_levels slv_levels;

SLV_NODISCARD SLV_API slv_result slv_levels_create(const slv_env *env, const slv_texture *texture,
                                                   slv_levels **out);
/* The same without a copy of level 0, which is most of it: of faces that are not constant it is the
 * texture's own, so the texture must neither change nor go before the levels do. */
SLV_NODISCARD SLV_API slv_result slv_levels_create_over(const slv_env *env,
                                                        const slv_texture *texture,
                                                        slv_levels **out);
/* The same of even levels (slv_res_even_level), for forms that are made of them. */
SLV_NODISCARD SLV_API slv_result slv_levels_create_even(const slv_env *env,
                                                        const slv_texture *texture,
                                                        slv_levels **out);
/* After texels of a rectangle of a face were changed, or the face became constant or ceased to be:
 * the levels become those that would be made afresh, in time that goes with the rectangle. A face
 * may have got another resolution; the rectangle is then all of it.
 * `texture` is the one that they were made from. Nobody else may use the levels meanwhile. Memory
 * is taken only the first time that a face becomes constant, or ceases to be, or for another
 * resolution; if there is none, the
 * face is not to be read until a call succeeds. */
SLV_NODISCARD SLV_API slv_result slv_levels_update(slv_levels *levels, const slv_texture *texture,
                                                   uint32_t face, slv_rect rect);
SLV_API void slv_levels_destroy(slv_levels *levels);
/* The texels of a level, in the texture's type and tightly packed. Owned by the levels. */
SLV_API const void *slv_levels_texels(const slv_levels *levels, uint32_t face, uint32_t level);
SLV_API uint32_t slv_levels_count(const slv_levels *levels, uint32_t face);
SLV_API const slv_texture_desc *slv_levels_get_desc(const slv_levels *levels);

#ifdef __cplusplus
}
#endif

#endif
