/* The .ptx file (Ptex 1.4): reading, saving a store, and the format's own arithmetic. Writing face
 * by face, edits and rewriting are in ptx_writer.h. */
#ifndef SELVAGE_PTX_H
#define SELVAGE_PTX_H

#include <selvage/mesh.h>
#include <selvage/source.h>
#include <selvage/stream.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The enumerations have the values that the file has. */
typedef enum slv_ptx_mesh_type { SLV_PTX_TRIANGLE = 0, SLV_PTX_QUAD = 1 } slv_ptx_mesh_type;
typedef enum slv_meta_type {
    SLV_META_STRING = 0,
    SLV_META_INT8 = 1,
    SLV_META_INT16 = 2,
    SLV_META_INT32 = 3,
    SLV_META_FLOAT = 4,
    SLV_META_DOUBLE = 5
} slv_meta_type;

SLV_API const char *slv_ptx_mesh_type_name(slv_ptx_mesh_type type); /* triangle, quad */
SLV_API const char *slv_border_mode_name(slv_border_mode mode);     /* clamp, black, periodic */
SLV_API const char *slv_edge_filter_name(slv_edge_filter filter);   /* none, tanvec */
/* string, int8, int16, int32, float, double */
SLV_API const char *slv_meta_type_name(slv_meta_type type);

typedef struct slv_ptx_info {
    slv_ptx_mesh_type mesh_type;
    slv_type type;
    uint32_t nchannels;
    int32_t alpha_channel; /* SLV_NO_ALPHA or an index */
    uint32_t nfaces;
    uint32_t nlevels;            /* stored levels, 1 = no reductions */
    const uint32_t *level_faces; /* nlevels: how many faces each level stores. Owned by the file */
    const uint64_t
        *level_bytes; /* nlevels: bytes that each level takes in the file. Owned by the file */
    bool has_edits;   /* edits were appended after it was written */
    slv_border_mode border_u, border_v;
    slv_edge_filter edge_filter;
    uint32_t minor_version;
    uint32_t nmeta;
    uint64_t file_bytes;
    uint64_t reserved[4];
} slv_ptx_info;

typedef slv_source_face slv_ptx_face;

/* A metadata entry. `values` is `count` elements of the type, native byte order and aligned; a
 * string's count leaves out its terminating NUL, which is there. */
typedef struct slv_ptx_meta {
    const char *key;
    slv_meta_type type;
    uint32_t count;
    const void *values;
} slv_ptx_meta;

/* Zero means default. */
typedef struct slv_ptx_open_params {
    bool premultiply; /* see slv_ptx_read_face */
    bool lenient;     /* an edge that leads to a face which the file does not have is a boundary,
                         instead of SLV_ERROR_FORMAT: for repairs */
    const slv_stream_in
        *source; /* NULL: the path is opened; else it is a name for messages. Copied */
    /* Damage is gone on past as far as that makes sense: faces whose texels cannot be read are
     * filled from their finest stored reduction that can, or with their average; metadata and edits
     * that cannot be read are left out. Each is told in a warning, faces beyond a hundred in one
     * for all. The header and the face table have to be sound. */
    bool salvage;
    slv_progress progress; /* of slv_ptx_load_texture: faces; on any thread, one at a time */
    uint64_t reserved[2];
} slv_ptx_open_params;

/* An open file. Any number of threads may read it at once. */
typedef struct slv_ptx slv_ptx;

/* Whether a name ends as those of .ptx files do: in .ptx, or in .ptex as with OpenImageIO and XGen,
 * in any case and behind something else. Files of other names are read too. */
SLV_API bool slv_ptx_is_name(const char *path);

/* Reads the header, the list of levels, the small metadata and the list of edits. The face table,
 * the averages, the level tables and large metadata are read, and checked, when something first
 * needs them: any function that takes a file and returns a result may then say that they are
 * damaged. Every size that the file claims is checked before anything is allocated. */
SLV_NODISCARD SLV_API slv_result slv_ptx_open(const slv_env *env, const char *path, slv_ptx **out);
SLV_NODISCARD SLV_API slv_result slv_ptx_open_stream(const slv_env *env, const char *name,
                                                     const slv_stream_in *source, slv_ptx **out);
SLV_NODISCARD SLV_API slv_result slv_ptx_open_with(const slv_env *env, const char *path,
                                                   const slv_ptx_open_params *params,
                                                   slv_ptx **out);
SLV_API void slv_ptx_close(slv_ptx *ptx);
/* Reads and checks all that opening put off, texels excepted. */
SLV_NODISCARD SLV_API slv_result slv_ptx_load_tables(const slv_ptx *ptx);
/* About how many bytes of memory the tables and the metadata hold now, and how many once everything
 * has been read. */
SLV_API uint64_t slv_ptx_table_bytes(const slv_ptx *ptx);
SLV_API uint64_t slv_ptx_full_table_bytes(const slv_ptx *ptx);

/* Of a file opened for salvage: how many faces were filled so far and how many other parts left
 * out, and whether a face was. */
SLV_API uint64_t slv_ptx_salvaged_count(const slv_ptx *ptx);
SLV_API bool slv_ptx_is_salvaged(const slv_ptx *ptx, uint32_t face);

SLV_API const slv_ptx_info *slv_ptx_get_info(const slv_ptx *ptx);
SLV_API const char *slv_ptx_name(const slv_ptx *ptx); /* the path, for messages */
SLV_NODISCARD SLV_API slv_result slv_ptx_get_face(const slv_ptx *ptx, uint32_t face,
                                                  slv_ptx_face *out);

/* One texel of the file's type for each face, tightly packed: the value of a constant face, of
 * others the stored average; premultiplied if the file was opened so. Owned by the file. NULL if
 * they cannot be read (the log says why). */
SLV_API const void *slv_ptx_get_averages(const slv_ptx *ptx);
/* The same, with what went wrong. */
SLV_NODISCARD SLV_API slv_result slv_ptx_load_averages(const slv_ptx *ptx, const void **out);

/* How a face is stored at a level. */
typedef enum slv_ptx_encoding {
    SLV_PTX_CONSTANT = 0,
    SLV_PTX_ZIPPED = 1,
    SLV_PTX_DIFF_ZIPPED = 2,
    SLV_PTX_TILED = 3
} slv_ptx_encoding;

/* constant, zipped, diff-zipped, tiled */
SLV_API const char *slv_ptx_encoding_name(slv_ptx_encoding encoding);

typedef struct slv_ptx_block {
    bool stored; /* false, and the rest zero: the face is constant, or the level lacks it */
    slv_ptx_encoding encoding;
    slv_res res;
    uint32_t bytes;
    uint64_t position; /* in the file */
    uint64_t reserved[4];
} slv_ptx_block;

SLV_NODISCARD SLV_API slv_result slv_ptx_get_block(const slv_ptx *ptx, uint32_t face,
                                                   uint32_t level, slv_ptx_block *out);

/* Reads all texels of a face at resolution `res`, no finer than the face's: the stored texels, a
 * stored reduction, or one computed as the format prescribes. Constant faces are filled out; 1x1 of
 * any face is the stored average. `out` has room for 2^u * 2^v * nchannels values, tightly packed,
 * v-major, row 0 at v=0.
 *
 * In a file with alpha, texels at full resolution and averages are as painted while stored
 * reductions are premultiplied: so is the format. Opened with `premultiply`, everything is
 * premultiplied. */
SLV_NODISCARD SLV_API slv_result slv_ptx_read_face(const slv_ptx *ptx, uint32_t face, slv_res res,
                                                   void *out);

/* Reads many faces one after the other: the same as slv_ptx_read_face, but buffers and the
 * decompressor are kept. For one thread at a time; each thread has its own. The file must outlive
 * it. */
typedef struct slv_ptx_reader slv_ptx_reader;
SLV_NODISCARD SLV_API slv_result slv_ptx_reader_create(const slv_env *env, const slv_ptx *ptx,
                                                       slv_ptx_reader **out);
SLV_API void slv_ptx_reader_destroy(slv_ptx_reader *reader);
SLV_NODISCARD SLV_API slv_result slv_ptx_reader_read(slv_ptx_reader *reader, uint32_t face,
                                                     slv_res res, void *out);
/* A tile of what slv_ptx_reader_read gives: the 2^size.u * 2^size.v texels from (x, y) on, tightly
 * packed, bit for bit the same. `size` is no larger than `res`, and in triangle files square; x and
 * y are multiples of the tile's width and height.
 *
 * Tiles need not be those of the file; only those of the file that the answer is made of are
 * unpacked, and a last one is kept for neighbouring requests. A reduction that the file does not
 * store is made of blocks of finer texels, never of the whole finer level. So the reader holds
 * about half a MiB and the file's table of tiles (4 bytes each) however large the face is, unless
 * texels have thousands of channels; on top of that the unpacked block while it reads one that the
 * file stores without tiles, which other software may write at any size. Such a block is kept only
 * up to 256 KiB, so each call for a part of a larger one unpacks it again. */
SLV_NODISCARD SLV_API slv_result slv_ptx_reader_read_tile(slv_ptx_reader *reader, uint32_t face,
                                                          slv_res res, slv_res size, uint32_t x,
                                                          uint32_t y, void *out);

/* The file as a source, which must outlive it: any resolution, as slv_ptx_read_face gives it, of a
 * content that never changes. */
SLV_NODISCARD SLV_API slv_result slv_ptx_as_source(const slv_env *env, const slv_ptx *ptx,
                                                   slv_source *out);

/* Calls `visit` with every face at full resolution, on env->threads threads. A face with
 * SLV_FACE_CONSTANT in its flags comes as one texel. `texels` is the visitor's to change, until it
 * returns. A result other than SLV_OK ends the visit and is returned: log through `env` before
 * that, each failing call one line; only the line of the lowest face is passed on. */
typedef slv_result (*slv_ptx_visit_fn)(void *user, const slv_env *env, uint32_t face,
                                       const slv_ptx_face *info, void *texels);
SLV_NODISCARD SLV_API slv_result slv_ptx_visit_faces(const slv_env *env, const slv_ptx *ptx,
                                                     slv_ptx_visit_fn visit, void *user);
/* The same of some faces: `faces` has `nfaces` numbers, each less than the file's and larger than
 * the one before. */
SLV_NODISCARD SLV_API slv_result slv_ptx_visit_some_faces(const slv_env *env, const slv_ptx *ptx,
                                                          const uint32_t *faces, uint32_t nfaces,
                                                          slv_ptx_visit_fn visit, void *user);

/* Metadata by index, in the order of the file, or by key. NULL if there is none, or if a large
 * value cannot be read (the log says why). Owned by the file. */
SLV_API const slv_ptx_meta *slv_ptx_get_meta(const slv_ptx *ptx, uint32_t index);
SLV_API const slv_ptx_meta *slv_ptx_find_meta(const slv_ptx *ptx, const char *key);
/* The same as slv_ptx_get_meta, with what went wrong; SLV_ERROR_ARGUMENT for an index beyond the
 * last. */
SLV_NODISCARD SLV_API slv_result slv_ptx_load_meta(const slv_ptx *ptx, uint32_t index,
                                                   const slv_ptx_meta **out);

/* Text metadata that says what the colours of a file are, linear, srgb or data, where that is not
 * what its type says; slv_ptx_save writes it. */
#define SLV_PTX_ENCODING_KEY "TextureEncoding"
/* "seamless" where reductions agree along edges (slv_ptx_seams); the command's verbs that draw look
 * such files up in even levels (even_levels of gl_texture.h). Written by the writer alone: given to
 * slv_ptx_writer_set_meta it is left out. */
#define SLV_PTX_REDUCTIONS_KEY "TextureReductions"
/* What the colours of a file are, never SLV_TEXTURE_AUTO: what this metadata says, or the colour
 * space that other programs note (ColorSpace, oiio:ColorSpace); else data if its edge filter is for
 * vectors; else what its type says. */
SLV_NODISCARD SLV_API slv_result slv_ptx_get_encoding(const slv_ptx *ptx,
                                                      slv_texture_encoding *out);

/* All faces at full resolution as a store, read in parallel. */
SLV_NODISCARD SLV_API slv_result slv_ptx_load_texture(const slv_env *env, const slv_ptx *ptx,
                                                      slv_texture **out);
/* The same with faces at other resolutions, none finer than the face's own: reductions, as painted.
 * `res` has one for each face; NULL: their own. No more is read, nor in memory, than that takes. */
SLV_NODISCARD SLV_API slv_result slv_ptx_load_texture_at(const slv_env *env, const slv_ptx *ptx,
                                                         const slv_res *res, slv_texture **out);
/* The file's own adjacency; of triangles that of their sub-faces (selvage/subface.h). */
SLV_NODISCARD SLV_API slv_result slv_ptx_load_adjacency(const slv_env *env, const slv_ptx *ptx,
                                                        slv_adjacency **out);
/* The control mesh in PtexFaceVertCounts, PtexFaceVertIndices and PtexVertPositions.
 * SLV_ERROR_UNSUPPORTED if they are not there, SLV_ERROR_MISMATCH if they contradict each other or
 * the file's number of faces. */
SLV_NODISCARD SLV_API slv_result slv_ptx_load_mesh(const slv_env *env, const slv_ptx *ptx,
                                                   slv_mesh **out);
/* The same for those who can do without: that there is none, or none of use (SLV_ERROR_UNSUPPORTED,
 * _MISMATCH or _FORMAT), is SLV_OK, *out NULL and no line in the log; `*why` (may be NULL) says
 * which. What keeps it from being read is an error as ever. */
SLV_NODISCARD SLV_API slv_result slv_ptx_find_mesh(const slv_env *env, const slv_ptx *ptx,
                                                   slv_mesh **out, slv_result *why);

/* Whether a mesh is the one that the file was painted on: mesh type, face count, sub-face flags,
 * adjacency. SLV_ERROR_MISMATCH, with the first face and edge that differ in the message. A file
 * without any adjacency matches by its face count; edges of holes may be either; of two sub-faces
 * across an edge either may be named. Triangles belong to a mesh of as many. */
SLV_NODISCARD SLV_API slv_result slv_ptx_match_mesh(const slv_env *env, const slv_ptx *ptx,
                                                    const slv_mesh *mesh);

/* Whether faces agree where they meet (seamless.h), for readers that know nothing of neighbours. */
typedef enum slv_ptx_seams {
    SLV_PTX_SEAMS_PLAIN = 0,  /* reductions are the format's own, of each face alone */
    SLV_PTX_SEAMS_REDUCTIONS, /* reductions agree; full resolution stays as it is */
    SLV_PTX_SEAMS_ALL         /* full resolution, too */
} slv_ptx_seams;
SLV_API const char *slv_ptx_seams_name(slv_ptx_seams seams); /* plain, seamless, all */

/* What to write with slv_ptx_save. Zero means default. */
typedef struct slv_ptx_write_params {
    slv_border_mode border_u, border_v;
    slv_edge_filter edge_filter;
    bool no_reductions;
    int compression; /* libdeflate's 1..12; 0: quick, and about as small as zlib's default level */
    const slv_mesh *mesh; /* if given, its geometry is written as metadata */
    uint32_t nmeta;
    const slv_ptx_meta *meta;
    slv_progress progress; /* faces, once when they are packed and once when they are written */
    const slv_stream_out *output; /* NULL: the path is written; else it is a name for messages */
    slv_ptx_seams seams;
    uint64_t reserved[3];
} slv_ptx_write_params;

/* Writes a store as a quad file, on env->threads threads: constant faces detected, reductions and
 * averages made as the format prescribes. Atomic: the path holds the old file or the complete new
 * one. `adjacency` may be NULL (all boundaries). */
SLV_NODISCARD SLV_API slv_result slv_ptx_save(const slv_env *env, const char *path,
                                              const slv_texture *texture,
                                              const slv_adjacency *adjacency,
                                              const slv_ptx_write_params *params);

/* The arithmetic of the format, bit for bit. Texels are tightly packed. */

/* The next stored reduction: both sides halved. `res` is that of `texels`, both of its sides at
 * least 1; `out` must not overlap. */
SLV_API void slv_ptx_reduce(slv_ptx_mesh_type mesh_type, slv_type type, uint32_t nchannels,
                            slv_res res, const void *texels, void *out);
/* The mean of `count` texels; a file's averages are those of the last stored reduction. */
SLV_API void slv_ptx_average(slv_type type, uint32_t nchannels, const void *texels, uint64_t count,
                             void *out);
/* Multiplies by alpha, or divides where alpha is not zero, the channels that it covers: those
 * before it, or, if it is channel 0, those behind it. Nothing happens with SLV_NO_ALPHA. */
SLV_API void slv_ptx_premultiply(slv_type type, uint32_t nchannels, int32_t alpha_channel,
                                 void *texels, uint64_t count);
SLV_API void slv_ptx_unmultiply(slv_type type, uint32_t nchannels, int32_t alpha_channel,
                                void *texels, uint64_t count);

#ifdef __cplusplus
}
#endif

#endif
