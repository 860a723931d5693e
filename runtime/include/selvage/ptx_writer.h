/* Writing .ptx files: new ones, edits of existing ones, and clean copies. */
#ifndef SELVAGE_PTX_WRITER_H
#define SELVAGE_PTX_WRITER_H

#include <selvage/ptx.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the whole file is. */
typedef struct slv_ptx_writer_params {
    slv_ptx_mesh_type mesh_type;
    slv_type type;
    uint32_t nchannels;    /* 1..65535 */
    int32_t alpha_channel; /* SLV_NO_ALPHA or an index */
    uint32_t nfaces;
    slv_border_mode border_u, border_v;
    slv_edge_filter edge_filter;
    bool no_reductions;
    int compression; /* libdeflate's 1..12; 0: quick, and about as small as zlib's default level */
    bool sync; /* wait for the disk before the new file replaces the old one, for power cuts */
    uint64_t memory; /* bytes of packed texels kept before they go to a nameless file beside the
                        target; 0: 128 MiB */
    slv_progress progress; /* of slv_ptx_writer_finish, or slv_ptx_rewrite: faces, once when they
                              are packed and once when they are written */
    const slv_stream_out *output; /* NULL: the path is written; else it is a name for messages,
                                 and slv_ptx_writer_finish writes there. Copied. Not for edits */
    slv_ptx_seams seams;          /* of new files of quads. Anything but plain is done by
                                     slv_ptx_writer_finish, which knows all faces: until then their texels
                                     wait in a nameless file, unpacked, with all their reductions */
    uint64_t reserved[3];
} slv_ptx_writer_params;

/* The same kind of file as an open one: all of the above down to no_reductions. Reads
 * the face table of a file without reductions; damage there is logged. */
SLV_API slv_ptx_writer_params slv_ptx_writer_params_like(const slv_ptx *ptx);

/* A file being written. Nothing is seen of it before slv_ptx_writer_finish, which puts it in the
 * place of whatever `path` names: at any moment, also when the process is killed or the disk is
 * full, the path is the old file or the complete new one. What a killed writer leaves beside the
 * path is removed by the next one that finishes there. */
typedef struct slv_ptx_writer slv_ptx_writer;

SLV_NODISCARD SLV_API slv_result slv_ptx_writer_create(const slv_env *env, const char *path,
                                                       const slv_ptx_writer_params *params,
                                                       slv_ptx_writer **out);
/* A writer that appends edits to the file at `path`: only what is given to it changes. Edited faces
 * have no stored reductions until the file is rewritten with slv_ptx_rewrite. Readers that have the
 * file open keep what they see. One edit at a time: SLV_ERROR_IO while another process edits the
 * file. `compression`, `sync`, `memory` and
 * `progress` of the params count, and params may be NULL. */
SLV_NODISCARD SLV_API slv_result slv_ptx_writer_edit(const slv_env *env, const char *path,
                                                     const slv_ptx_writer_params *params,
                                                     slv_ptx_writer **out);
/* Abandons what has not been finished: the path stays as it was. */
SLV_API void slv_ptx_writer_destroy(slv_ptx_writer *writer);

/* Packs a face and keeps it; faces come in any order, and different ones from several threads at
 * once. `texels` are 2^u * 2^v, or one where info->flags has SLV_FACE_CONSTANT; of the flags only
 * that and SLV_FACE_SUBFACE count. A face all of whose texels are bitwise the same becomes constant
 * by itself; with SLV_PTX_SEAMS_ALL only if no reduction differs so as to agree with a neighbour's,
 * since constant faces store none. Reductions and averages are made here. A face given again
 * replaces the first. Faces never given (in a new file) are 1x1, zero, and without neighbours. */
SLV_NODISCARD SLV_API slv_result slv_ptx_writer_write_face(slv_ptx_writer *writer, uint32_t face,
                                                           const slv_ptx_face *info,
                                                           const void *texels);
/* Adds a metadata entry, or replaces the one of that key. Copied. Not while another thread uses the
 * writer, as with all below. */
SLV_NODISCARD SLV_API slv_result slv_ptx_writer_set_meta(slv_ptx_writer *writer,
                                                         const slv_ptx_meta *meta);
/* Adjacency and sub-face flags of all faces, in place of what write_face is told. Copied. For new
 * quad files. */
SLV_NODISCARD SLV_API slv_result slv_ptx_writer_set_adjacency(slv_ptx_writer *writer,
                                                              const slv_adjacency *adjacency);
/* The control mesh, as metadata, and for new files the adjacency that follows from it. In a
 * triangle file each polygon is a triangle and a face. */
SLV_NODISCARD SLV_API slv_result slv_ptx_writer_set_mesh(slv_ptx_writer *writer,
                                                         const slv_mesh *mesh);
/* Completes the file. After it, whatever it returns, the writer can only be destroyed. */
SLV_NODISCARD SLV_API slv_result slv_ptx_writer_finish(slv_ptx_writer *writer);

/* Writes all that an open file holds, edits applied, as a new file: reductions, averages and flags
 * are made anew. `path` may be the file's own. `params` is for compression, sync, memory, output,
 * progress and no_reductions (which also counts if the file has none), or NULL. */
SLV_NODISCARD SLV_API slv_result slv_ptx_rewrite(const slv_env *env, const slv_ptx *ptx,
                                                 const char *path,
                                                 const slv_ptx_writer_params *params);

#ifdef __cplusplus
}
#endif

#endif
