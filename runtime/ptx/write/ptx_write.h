/* A .ptx file being made, shared by the files that pack, keep and assemble it. */
#ifndef SLV_PTX_WRITE_H
#define SLV_PTX_WRITE_H

#include <selvage/ptx_writer.h>

#include "ptx/format/ptx_file.h"

#include "base/idle.h"
#include "base/memory.h"
#include "base/progress.h"

/* Levels that can be stored: the smallest has 4 texels a side, of 2^SLV_MAX_LOG2_RES. */
#define PTX_MAX_STORED_LEVELS SLV_MAX_LOG2_RES

/* Bytes that grow. */
typedef struct ptx_bytes {
    uint8_t *data;
    uint64_t size, capacity;
} ptx_bytes;

/* Room for `extra` more bytes. */
slv_result slvi_ptx_bytes_reserve(const slv_env *env, const char *path, ptx_bytes *bytes,
                                  uint64_t extra);
slv_result slvi_ptx_bytes_append(const slv_env *env, const char *path, ptx_bytes *bytes,
                                 const void *data, uint64_t size);
/* Appends `size` bytes as one zlib stream; *zipped is its length, at most `limit`. */
slv_result slvi_ptx_bytes_append_zip(const slv_env *env, const char *path,
                                     struct libdeflate_compressor *deflater, ptx_bytes *bytes,
                                     const void *data, uint64_t size, uint64_t limit,
                                     uint32_t *zipped);

/* ptx_deflate.c: zlib streams of differences. A deflater is released with slvi_free. */
struct ptx_deflater;
slv_result slvi_ptx_deflater_create(const slv_env *env, const char *path,
                                    struct ptx_deflater **out);
size_t slvi_ptx_deflate_bound(size_t size);
/* `row` bytes further things are much the same, and a texel takes `step`. Returns 0 if the bytes
 * are of a kind that a thorough search suits better; `out` has room for slvi_ptx_deflate_bound. */
size_t slvi_ptx_deflate(struct ptx_deflater *deflater, const uint8_t *in, size_t size, size_t row,
                        size_t step, uint8_t *out);

/* What one thread needs to pack faces. */
typedef struct ptx_packer {
    slvi_idle_link link;
    const slv_env *env;
    const char *path;
    struct libdeflate_compressor *deflater;
    struct ptx_deflater *own; /* NULL when a level was asked for */
    slv_type type;
    uint32_t nchannels;
    size_t pixel_size;
    ptx_bytes out, tiles, planes;
    ptx_bytes work[2]; /* reductions */
} ptx_packer;

/* Appends the block of an array of texels to packer->out; *header is its face data header. */
slv_result slvi_ptx_pack(ptx_packer *packer, uint32_t face, const void *texels, slv_res res,
                         uint32_t *header);
void slvi_ptx_packer_free(ptx_packer *packer);

/* ptx_spill.c: packed faces on their way: in memory, and past a budget in a file without a name. */
typedef struct ptx_spill {
    const char *path; /* of the target, beside which the file is made */
    pthread_mutex_t lock;
    uint64_t size, budget;
    uint8_t **chunks;
    int descriptor;
} ptx_spill;

slv_result slvi_ptx_spill_begin(ptx_spill *spill, const slv_env *env, const char *path,
                                uint64_t budget);
/* Keeps bytes; any thread. */
slv_result slvi_ptx_spill_append(ptx_spill *spill, const slv_env *env, const void *data,
                                 uint64_t size, uint64_t *position);
slv_result slvi_ptx_spill_read(const ptx_spill *spill, const slv_env *env, uint64_t position,
                               uint64_t size, void *out);
void slvi_ptx_spill_end(ptx_spill *spill);

/* Everything between the levels and the edits, and the sizes that the headers record. */
typedef struct ptx_meta_out {
    ptx_bytes bytes;
    uint32_t small_zipped, small_size, large_zipped, large_size;
    uint64_t large_data;
} ptx_meta_out;

/* An entry and what it points to. */
typedef struct ptx_kept_meta {
    slv_ptx_meta entry;
    void *memory;
} ptx_kept_meta;

/* Bytes of the values in the file, a string's NUL included. */
uint64_t slvi_ptx_meta_size(const slv_ptx_meta *meta);
slv_result slvi_ptx_meta_check(const slv_env *env, const char *path, const slv_ptx_meta *meta);
slv_result slvi_ptx_meta_pack(const slv_env *env, const char *path,
                              struct libdeflate_compressor *deflater, const ptx_kept_meta *meta,
                              uint32_t nmeta, ptx_meta_out *out);
/* All entries in the layout of small ones, not zipped. */
slv_result slvi_ptx_meta_pack_edit(const slv_env *env, const char *path, const ptx_kept_meta *meta,
                                   uint32_t nmeta, ptx_bytes *out);

/* ptx_seams.c: faces that wait for their neighbours, to agree with them. */
typedef struct ptx_seams {
    int descriptor; /* a nameless file of their levels */
    uint64_t size;
    uint64_t *positions; /* of a face's levels there; unused of constant faces */
} ptx_seams;

struct slv_ptx_writer {
    slv_env env; /* its log is serialised */
    slv_parallel_log *log;
    char *path;
    slv_ptx_writer_params params;
    slv_stream_out output; /* without `write`: the path */
    char *spill_path;      /* beside which packed faces wait */
    int compression;
    size_t pixel_size;
    bool finished;
    _Atomic(bool) failed;
    uint8_t *records;    /* PTX_FACE_INFO_SIZE a face */
    uint8_t *constants;  /* pixel_size a face */
    uint8_t *given;      /* whether a face was */
    uint64_t *positions; /* of a face's blocks, level after level, in the spill */
    uint32_t *headers[PTX_MAX_STORED_LEVELS]; /* by face */
    slvi_steps steps; /* a step is a face packed here, or one put into the finished file */
    ptx_spill spill;
    ptx_seams seams;
    pthread_mutex_t lock; /* of seams.size */
    slvi_idle packers;
    ptx_kept_meta *meta;
    uint32_t nmeta, meta_capacity;
    slv_ptx_face *links; /* adjacency and flags in place of those given with faces, or NULL */
    /* where edits go: the file itself, and the offset behind its last edit; -1 for a new file */
    int edited;
    uint64_t edit_position, edit_end;
};

/* ptx_assemble.c, ptx_append.c */
slv_result slvi_ptx_writer_assemble(slv_ptx_writer *writer);
slv_result slvi_ptx_writer_append(slv_ptx_writer *writer);
/* ptx_writer.c: as slv_ptx_writer_params_like, but for no_reductions, which edits do not have. */
slv_ptx_writer_params slvi_ptx_writer_params_of_header(const slv_ptx *ptx);
/* For both kinds. `path` is resolved. */
slv_result slvi_ptx_writer_begin(const slv_env *env, const char *path,
                                 const slv_ptx_writer_params *params, slv_ptx_writer **out);
/* ptx_packers.c: scratch memory for packing, and back. */
slv_result slvi_ptx_writer_take(slv_ptx_writer *writer, const slv_env *env, ptx_packer **out);
void slvi_ptx_writer_give(slv_ptx_writer *writer, ptx_packer *packer);
/* ptx_seams.c. A face's texels are kept with their reductions, and nothing packed. */
slv_result slvi_ptx_seams_begin(slv_ptx_writer *writer);
slv_result slvi_ptx_seams_keep(slv_ptx_writer *writer, ptx_packer *packer, uint32_t face,
                               slv_res res, const void *texels);
slv_result slvi_ptx_seams_pack(slv_ptx_writer *writer);
void slvi_ptx_seams_end(slv_ptx_writer *writer);
/* slv_ptx_writer_write_face with an environment of the caller's. */
slv_result slvi_ptx_writer_put(slv_ptx_writer *writer, const slv_env *env, uint32_t face,
                               const slv_ptx_face *info, const void *texels);
/* ptx_save.c: slv_ptx_rewrite, with a mesh (which may be NULL) in place of the file's own. */
slv_result slvi_ptx_copy(const slv_env *env, const slv_ptx *ptx, const slv_mesh *mesh,
                         const char *path, const slv_ptx_writer_params *params);
/* ptx_writer_mesh.c: metadata of any key; the mesh as metadata. */
slv_result slvi_ptx_writer_keep_meta(slv_ptx_writer *writer, const slv_ptx_meta *meta);
slv_result slvi_ptx_writer_set_geometry(slv_ptx_writer *writer, const slv_mesh *mesh);

#endif
