/* The index beside exported images: all of a .ptx but its texels, as JSON. */
#ifndef SLV_BAKE_EXCHANGE_INDEX_H
#define SLV_BAKE_EXCHANGE_INDEX_H

#include "exchange/exchange_data.h"

#include <selvage/image.h>

enum { SLVI_INDEX_GROUP = 4 }; /* channels that go into one image */
#define SLVI_INDEX_KIND "faces"

/* The names of an enumeration, which are the words of the index. */
typedef const char *slvi_index_names(int value);
slvi_index_names slvi_index_border, slvi_index_filter, slvi_index_meta, slvi_index_mesh,
    slvi_index_type;
/* Which value a word is; -1: none, or no word. */
int slvi_index_value(slvi_index_names *names, const json_t *word);

/* How many images it takes to hold all channels. */
static inline uint32_t slvi_index_groups(uint32_t nchannels) {
    return (nchannels + SLVI_INDEX_GROUP - 1) / SLVI_INDEX_GROUP;
}
static inline uint32_t slvi_index_group_size(uint32_t nchannels, uint32_t group) {
    uint32_t left = nchannels - group * SLVI_INDEX_GROUP;
    return left < SLVI_INDEX_GROUP ? left : SLVI_INDEX_GROUP;
}

/* The image of a group: the same name for the first, ".1", ".2" before the extension (with its dot)
 * for others. */
void slvi_index_image_name(char *out, size_t size, const char *stem, uint32_t group,
                           const char *extension);
/* What colours are in the pictures, where they are any: sRGB in a PNG, but light where 16 bits of
 * light would be rounded; light in an EXR. */
slv_texture_encoding slvi_index_pictures(const slvi_exchange_plan *plan, bool exr);
/* Half goes into EXR as it is; PNG holds 8 or 16 bits, and 16 of sRGB hold 8 of light. */
slv_image_params slvi_index_image_params(const slvi_exchange_plan *plan, bool exr);
/* Between a face's texels, row 0 at v=0, and a rectangle of an image, its top at v=1. */
void slvi_index_to_image(const float *values, slv_res res, uint32_t nchannels, uint32_t group,
                         slv_image *image, uint32_t x, uint32_t y);

/* Text that need not be UTF-8; what is not becomes U+FFFD. */
json_t *slvi_index_text(const slv_env *env, const char *text);
/* Everything but the list of faces. */
slv_result slvi_index_create(const slv_env *env, const slv_ptx *ptx, const slvi_exchange_plan *plan,
                             bool meta, json_t **out);
slv_result slvi_index_no_memory(const slv_env *env, const slvi_exchange_plan *plan);
json_t *slvi_index_face(const slv_ptx_face *face, unsigned nedges);
/* Writes atomically and releases. */
slv_result slvi_index_write(const slv_env *env, const char *path, json_t *root);
/* SLV_OK if there is no file of that name, or an index, which may be written anew. */
slv_result slvi_index_may_be(const slv_env *env, const char *path);

/* Reading: what is wrong is said in one line, naming the face. */
slv_result slvi_index_open(const slv_env *env, const char *path, slv_exchange *source);
slv_result slvi_index_read_face(const slv_env *env, const char *path, const json_t *item,
                                uint32_t face, const slv_ptx_writer_params *params,
                                slv_ptx_face *out);
slv_result slvi_index_read_meta(const slv_env *env, const char *path, const json_t *root,
                                slv_ptx_writer *writer);

#endif
