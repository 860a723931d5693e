/* From one file to another: a .ptx changed on its way, a .ptx as images and back, several as one.
 */
#ifndef SELVAGE_EXCHANGE_H
#define SELVAGE_EXCHANGE_H

#include <selvage/ptx_writer.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What is to be exchanged: a .ptx, or images with the index that an export wrote beside them. */
typedef struct slv_exchange slv_exchange;

/* Whether a name stands for images and not for a .ptx: that of a folder, or of an index, .json or
 * .json.gz. */
SLV_API bool slv_exchange_is_index(const char *path);
/* Opens a .ptx, an index (its name ends in .json), or a folder with an index.json in it. */
SLV_NODISCARD SLV_API slv_result slv_exchange_open(const slv_env *env, const char *path,
                                                   slv_exchange **out);
/* The same of a .ptx that is open already, and outlives it. */
SLV_NODISCARD SLV_API slv_result slv_exchange_open_ptx(const slv_env *env, const slv_ptx *ptx,
                                                       slv_exchange **out);
SLV_API void slv_exchange_close(slv_exchange *source);
/* What the source is. */
SLV_API const slv_ptx_writer_params *slv_exchange_get_params(const slv_exchange *source);

/* A channel of the result: one of the source's, or a value. */
typedef struct slv_exchange_channel {
    int32_t source; /* -1: `value` */
    float value;
} slv_exchange_channel;

typedef struct slv_exchange_face_res {
    uint32_t face;
    slv_res res;
} slv_exchange_face_res;

/* What the result has of its own. */
enum {
    SLV_EXCHANGE_TYPE = 1 << 0,
    SLV_EXCHANGE_ALPHA = 1 << 1,
    SLV_EXCHANGE_BORDER_U = 1 << 2,
    SLV_EXCHANGE_BORDER_V = 1 << 3,
    SLV_EXCHANGE_EDGE_FILTER = 1 << 4,
    SLV_EXCHANGE_REDUCTIONS = 1 << 5,
    SLV_EXCHANGE_MAX_RES = 1 << 6
};

typedef enum slv_exchange_images {
    SLV_EXCHANGE_BY_TYPE = 0, /* EXR for half and float, else PNG */
    SLV_EXCHANGE_PNG,
    SLV_EXCHANGE_EXR
} slv_exchange_images;

SLV_API const char *slv_exchange_images_name(slv_exchange_images images); /* by-type, png, exr */

/* Zero means default: all as the source has it. */
typedef struct slv_exchange_params {
    unsigned
        changes; /* which of the next seven count, SLV_EXCHANGE_TYPE | ...; else the source's */
    slv_type type;
    int32_t alpha_channel; /* of the result, or SLV_NO_ALPHA; else alpha stays with its channel */
    slv_border_mode border_u, border_v;
    slv_edge_filter edge_filter;
    bool no_reductions;
    slv_res max_res; /* no face larger */

    slv_res min_res; /* no face smaller */
    int scale_log2;  /* every face 2^scale_log2 times as wide and high, before min and max */
    const slv_exchange_face_res *face_res; /* sizes of single faces, in place of all that */
    uint32_t nface_res;
    const slv_exchange_channel *channels; /* default: those of the source */
    uint32_t nchannels;
    bool premultiply, unmultiply; /* colours by alpha; not both */

    /* What the source's colours are; default: what the .ptx or the index says. A PNG has them as
     * sRGB, an EXR as light: they are encoded and decoded on their way, but for SLV_TEXTURE_DATA.
     * Between two .ptx files values stay as they are, and metadata says what they are where the
     * type does not (slv_ptx_get_encoding). */
    slv_texture_encoding encoding;
    bool no_meta;                /* leave metadata out, but for that */
    int compression;             /* of a .ptx, as in slv_ptx_writer_params */
    const slv_mesh *mesh;        /* of a .ptx: its geometry and adjacency go inside */
    slv_exchange_images images;  /* of a folder */
    slv_progress progress;       /* faces */
    slv_progress sheet_progress; /* of a sheet, afterwards: rows of an image, and of the next */
    /* Of a .ptx only these faces, in the order of their numbers, neighbours that are left out
     * becoming boundary; NULL means all. Geometry inside goes along with them, unless a polygon of
     * several faces is torn apart, of which a warning tells. `face_res` has the source's numbers.
     */
    const uint32_t *faces;
    uint32_t nfaces;
    slv_ptx_seams seams;  /* of a .ptx of quads that has reductions */
    uint64_t reserved[5]; /* zero; for what later versions add */
} slv_exchange_params;

/* What was done. */
typedef struct slv_exchange_stats {
    uint64_t faces, resized, texels;
    uint64_t clipped;            /* values that the new type could not hold; a warning says so */
    slv_ptx_writer_params wrote; /* what the result is */
    uint64_t reserved[8];
} slv_exchange_stats;

/* Each writes its result whole or not at all, on env->threads threads, the same bytes with any
 * number of them; a face is in memory as floats meanwhile. Faces are resampled as slv_ptx_resize
 * has it, colours multiplied by alpha. `params` and `stats` may be NULL. Parameters that do not fit
 * the source are SLV_ERROR_ARGUMENT.
 *
 * A .ptx from either kind of source. */
SLV_NODISCARD SLV_API slv_result slv_exchange_to_ptx(const slv_env *env, const slv_exchange *source,
                                                     const slv_exchange_params *params,
                                                     const char *path, slv_exchange_stats *stats);
/* Of a .ptx an image a face (face_000012.png; of more than four channels also face_000012.1.png,
 * ...), and index.json with all that images do not hold; into a new folder, or among what an
 * existing one has. Constant faces are images of one texel. From images: SLV_ERROR_UNSUPPORTED. */
SLV_NODISCARD SLV_API slv_result slv_exchange_to_folder(const slv_env *env,
                                                        const slv_exchange *source,
                                                        const slv_exchange_params *params,
                                                        const char *folder,
                                                        slv_exchange_stats *stats);
/* The same as one image of all faces, .png or .exr, and an index that says where each lies:
 * NAME.json beside NAME.png. A file of that name that is no index is not written over:
 * SLV_ERROR_IO. */
SLV_NODISCARD SLV_API slv_result slv_exchange_to_sheet(const slv_env *env,
                                                       const slv_exchange *source,
                                                       const slv_exchange_params *params,
                                                       const char *path, slv_exchange_stats *stats);

/* Zero means default. */
typedef struct slv_merge_params {
    unsigned changes; /* SLV_EXCHANGE_TYPE, SLV_EXCHANGE_REDUCTIONS: which of the next two count */
    slv_type type;    /* else one that holds the values of all */
    bool no_reductions; /* else as the first file */
    int compression;
    slv_progress progress; /* faces of all files */
    uint64_t reserved[8];
} slv_merge_params;

/* Joins .ptx files into one, the faces of each after those of the one before. They must have the
 * same kind of faces, number of channels and alpha channel (SLV_ERROR_MISMATCH); border modes and
 * edge filter are the first file's. Geometry becomes one if all have it (`*geometry`, which
 * may be NULL), and is kept for slv_split under names as KEY.2 otherwise; other metadata once if it
 * is equal, else under names of its own, KEY.2 for that of the second file. `first_faces` (may be
 * NULL) has room for `npaths`: where each file's faces begin. What each file had of its own is
 * recorded under SLV_PARTS_KEY. `params` and `stats` may be NULL.
 */
#define SLV_PARTS_KEY "SelvageParts"
SLV_NODISCARD SLV_API slv_result slv_merge(const slv_env *env, const char *const *paths,
                                           uint32_t npaths, const slv_merge_params *params,
                                           const char *out, uint32_t *first_faces, bool *geometry,
                                           slv_exchange_stats *stats);

/* Zero means default. */
typedef struct slv_split_params {
    const uint32_t *at; /* where parts begin, the first 0, each larger than the one before; NULL: as
                           the record of slv_merge has it, else SLV_ERROR_UNSUPPORTED */
    uint32_t nparts;
    int compression;
    slv_progress progress; /* faces of all parts */
    /* Called for each part that is written, before it appears. */
    void (*each)(void *user, const char *name, uint32_t first_face, uint32_t nfaces);
    void *user;
    uint64_t reserved[6];
} slv_split_params;

/* The inverse of slv_merge: the parts of a .ptx as files of a folder, all of them or none. With the
 * record of a merge they have their old names, data types, border modes, edge filter, metadata and
 * geometry again, otherwise the names part_0000.ptx and so on and what the file has. Geometry is
 * left out as slv_exchange_params.faces has it. `params` and `stats` may be NULL. */
SLV_NODISCARD SLV_API slv_result slv_split(const slv_env *env, const slv_ptx *ptx,
                                           const slv_split_params *params, const char *folder,
                                           slv_exchange_stats *stats);

#ifdef __cplusplus
}
#endif

#endif
