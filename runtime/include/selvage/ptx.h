/* The .ptx file (Ptex 1.4): reading, and writing of new files. */
#ifndef SELVAGE_PTX_H
#define SELVAGE_PTX_H

#include <selvage/mesh.h>
#include <selvage/texture.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The enumerations have the values that the file has. */
typedef enum slv_ptx_mesh_type { SLV_PTX_TRIANGLE = 0, SLV_PTX_QUAD = 1 } slv_ptx_mesh_type;
typedef enum slv_border_mode { SLV_BORDER_CLAMP = 0, SLV_BORDER_BLACK = 1, SLV_BORDER_PERIODIC = 2 } slv_border_mode;
typedef enum slv_edge_filter { SLV_EDGE_FILTER_NONE = 0, SLV_EDGE_FILTER_TANVEC = 1 } slv_edge_filter;
typedef enum slv_meta_type {
    SLV_META_STRING = 0,
    SLV_META_INT8 = 1,
    SLV_META_INT16 = 2,
    SLV_META_INT32 = 3,
    SLV_META_FLOAT = 4,
    SLV_META_DOUBLE = 5
} slv_meta_type;

typedef struct slv_ptx_info {
    slv_ptx_mesh_type mesh_type;
    slv_type type;
    uint32_t nchannels;
    int32_t alpha_channel; /* SLV_NO_ALPHA or an index */
    uint32_t nfaces;
    uint32_t nlevels;            /* stored levels, 1 = no reductions */
    const uint32_t *level_faces; /* nlevels: how many faces each level stores. Owned by the file */
    bool has_edits;              /* edits were appended after it was written */
    slv_border_mode border_u, border_v;
    slv_edge_filter edge_filter;
    uint32_t minor_version;
    uint32_t nmeta;
    uint64_t file_bytes;
} slv_ptx_info;

typedef struct slv_ptx_face {
    slv_res res;
    uint8_t flags; /* SLV_FACE_... */
    slv_face_adjacency adjacency;
} slv_ptx_face;

/* A metadata entry. `values` is `count` elements of the type, native byte order and aligned; a string's count leaves out its
 * terminating NUL, which is there. */
typedef struct slv_ptx_meta {
    const char *key;
    slv_meta_type type;
    uint32_t count;
    const void *values;
} slv_ptx_meta;

/* Where bytes come from, when not from a path. `read` returns 0 on success and is called from several threads at once. */
typedef struct slv_ptx_source {
    int (*read)(void *user, uint64_t offset, void *buffer, size_t size);
    void (*close)(void *user); /* may be NULL; called once, also when opening fails */
    void *user;
    uint64_t size;
} slv_ptx_source;

/* An open file. Any number of threads may read it at once. */
typedef struct slv_ptx slv_ptx;

/* Reads the header, face table, level tables and metadata; no texels. Every size that the file claims is checked before
 * anything is allocated. */
SLV_API slv_result slv_ptx_open(const slv_env *env, const char *path, slv_ptx **out);
SLV_API slv_result slv_ptx_open_source(const slv_env *env, const char *name, const slv_ptx_source *source,
                                       slv_ptx **out);
SLV_API void slv_ptx_close(slv_ptx *ptx);

SLV_API const slv_ptx_info *slv_ptx_get_info(const slv_ptx *ptx);
SLV_API const char *slv_ptx_name(const slv_ptx *ptx); /* the path, for messages */
SLV_API slv_result slv_ptx_get_face(const slv_ptx *ptx, uint32_t face, slv_ptx_face *out);

/* Reads all texels of a face at resolution `res`, no finer than the face's: the stored texels, a stored reduction, or one
 * computed as the format prescribes. Constant faces are filled out; 1x1 of any face is the stored average. `out` has
 * room for 2^u * 2^v * nchannels values, tightly packed, v-major, row 0 at v=0. */
SLV_API slv_result slv_ptx_read_face(const slv_ptx *ptx, uint32_t face, slv_res res, void *out);

/* Metadata by index, in the order of the file, or by key (NULL if there is none). Owned by the file. */
SLV_API const slv_ptx_meta *slv_ptx_get_meta(const slv_ptx *ptx, uint32_t index);
SLV_API const slv_ptx_meta *slv_ptx_find_meta(const slv_ptx *ptx, const char *key);

/* All faces at full resolution as a store, read in parallel. */
SLV_API slv_result slv_ptx_load_texture(const slv_env *env, const slv_ptx *ptx, slv_texture **out);
/* The file's own adjacency. Triangle files are SLV_ERROR_UNSUPPORTED. */
SLV_API slv_result slv_ptx_load_adjacency(const slv_env *env, const slv_ptx *ptx, slv_adjacency **out);
/* The control mesh in PtexFaceVertCounts, PtexFaceVertIndices and PtexVertPositions. SLV_ERROR_UNSUPPORTED if they
 * are not there, SLV_ERROR_MISMATCH if they contradict each other or the file's number of faces. */
SLV_API slv_result slv_ptx_load_mesh(const slv_env *env, const slv_ptx *ptx, slv_mesh **out);

/* Whether a mesh is the one that the file was painted on: mesh type, face count, sub-face flags, adjacency. SLV_ERROR_MISMATCH, with
 * the first face and edge that differ in the message. A file without any adjacency matches by its face count; edges of
 * holes may be either; of two sub-faces across an edge either may be named. */
SLV_API slv_result slv_ptx_match_mesh(const slv_env *env, const slv_ptx *ptx, const slv_mesh *mesh);

/* What to write. Zero means default. */
typedef struct slv_ptx_write_params {
    slv_border_mode border_u, border_v;
    slv_edge_filter edge_filter;
    bool no_reductions;
    int compression; /* libdeflate's 1..12; 0 means 6 */
    const slv_mesh *mesh; /* if given, its geometry is written as metadata */
    uint32_t nmeta;
    const slv_ptx_meta *meta;
} slv_ptx_write_params;

/* Writes a quad file: constant faces detected, reductions and averages made as the format prescribes. Atomic: the path holds
 * the old file or the complete new one. `adjacency` may be NULL (all boundaries). */
SLV_API slv_result slv_ptx_save(const slv_env *env, const char *path, const slv_texture *texture,
                                const slv_adjacency *adjacency, const slv_ptx_write_params *params);

#ifdef __cplusplus
}
#endif

#endif
