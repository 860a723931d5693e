/* The index beside exported images: all of a .ptx but its texels, as JSON. */
#ifndef SELVAGE_TOOLS_CONVERT_INDEX_H
#define SELVAGE_TOOLS_CONVERT_INDEX_H

#include "convert/convert.h"

enum { INDEX_GROUP = 4 }; /* channels that go into one image */
#define INDEX_KIND "faces"

/* How many images it takes to hold all channels. */
static inline uint32_t index_groups(uint32_t nchannels) {
    return (nchannels + INDEX_GROUP - 1) / INDEX_GROUP;
}
static inline uint32_t index_group_size(uint32_t nchannels, uint32_t group) {
    uint32_t left = nchannels - group * INDEX_GROUP;
    return left < INDEX_GROUP ? left : INDEX_GROUP;
}

/* The image of a group: the same name for the first, ".1", ".2" before the extension for others. */
void index_image_name(char *out, size_t size, const char *stem, uint32_t group, bool exr);
/* Half goes into EXR as it is; PNG holds 8 or 16 bits. */
slv_image_params index_image_params(slv_type type, bool exr);
/* Between a face's texels, row 0 at v=0, and a rectangle of an image, its top at v=1. */
void index_to_image(const float *values, slv_res res, uint32_t nchannels, uint32_t group,
                    slv_image *image, uint32_t x, uint32_t y);

/* Everything but the list of faces. NULL if there is no memory, or metadata cannot be read. */
json_t *index_create(const slv_ptx *ptx, const convert_plan *plan, bool meta);
json_t *index_face(const slv_ptx_face *face, unsigned nedges);
/* Writes atomically and releases; exit code. */
int index_write(const slv_env *env, const char *path, json_t *root);

/* Reading: what is wrong is said in one line, naming the face. */
slv_result index_read_params(const slv_env *env, const char *path, const json_t *root,
                             slv_ptx_writer_params *out);
slv_result index_read_face(const slv_env *env, const char *path, const json_t *item, uint32_t face,
                           const slv_ptx_writer_params *params, slv_ptx_face *out);
slv_result index_read_meta(const slv_env *env, const char *path, const json_t *root,
                           slv_ptx_writer *writer);

#endif
