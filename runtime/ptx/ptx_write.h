/* A .ptx file being made, shared by the ptx_save*.c files. */
#ifndef SLV_PTX_WRITE_H
#define SLV_PTX_WRITE_H

#include "ptx/ptx_file.h"

/* Bytes that grow. */
typedef struct ptx_bytes {
    uint8_t *data;
    uint64_t size, capacity;
} ptx_bytes;

/* Room for `extra` more bytes. */
slv_result ptx_bytes_reserve(const slv_env *env, const char *path, ptx_bytes *bytes,
                             uint64_t extra);
slv_result ptx_bytes_append(const slv_env *env, const char *path, ptx_bytes *bytes,
                            const void *data, uint64_t size);
/* Appends `size` bytes as one zlib stream; *zipped is its length, at most `limit`. */
slv_result ptx_bytes_append_zip(const slv_env *env, const char *path,
                                struct libdeflate_compressor *deflater, ptx_bytes *bytes,
                                const void *data, uint64_t size, uint64_t limit, uint32_t *zipped);

/* What one thread needs to pack faces. */
typedef struct ptx_packer {
    const slv_env *env;
    const char *path;
    struct libdeflate_compressor *deflater;
    slv_type type;
    uint32_t nchannels;
    size_t pixel_size;
    ptx_bytes out, tiles, planes;
    ptx_bytes work; /* a reduction */
} ptx_packer;

/* Appends the block of an array of texels to packer->out; *header is its face data header. */
slv_result ptx_pack(ptx_packer *packer, uint32_t face, const void *texels, slv_res res,
                    uint32_t *header);
void ptx_packer_free(ptx_packer *packer);

/* Sets the flag of constant faces among whose neighbours nothing but their value is found. */
void ptx_flag_neighbourhoods(slv_ptx_face *faces, uint32_t nfaces, const uint8_t *constants,
                             size_t pixel_size, bool borders_clamp);

/* Everything between the levels and the edits, and the sizes that the headers record. */
typedef struct ptx_meta_out {
    ptx_bytes bytes;
    uint32_t small_zipped, small_size, large_zipped, large_size;
    uint64_t large_data;
} ptx_meta_out;

slv_result ptx_meta_pack(const slv_env *env, const char *path,
                         struct libdeflate_compressor *deflater, const slv_ptx_write_params *params,
                         ptx_meta_out *out);

#endif
